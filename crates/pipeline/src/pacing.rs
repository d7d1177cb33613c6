//! The stages that run in order for the whole plate: from the parts' paths to
//! moves with their speeds.
//!
//! In: layers of all parts from below, as paths. Out: their moves with their
//! speeds, and pictures. The parts of a layer are printed one after the other, on
//! a short way through their places, and those of the next layer on the same way
//! back. A part that stands in several places has one path, which is moved to each
//! place. A layer knows nothing of those below it but where the last one has ended.

use super::SliceError;
use super::job::{Base, Job};
use super::part::Passed;
use glam::DVec2;
use isoslice_base::limits;
use isoslice_base::timings::{Stage, Timings};
use isoslice_base::units::Mm;
use isoslice_layer::adhesion::{BedPlan, Skirt, keep_on_bed};
use isoslice_path::order::{begin_near, course};
use isoslice_path::pace::rates::{Rater, Site};
use isoslice_path::pace::{PacePlan, PacedLayer, Pacer, RatedStretch, Stretch};
use isoslice_path::travel::{
    LayerPath, Move, Travel, between_parts, over_parts,
};
use isoslice_plate::Plate;
use isoslice_preview::Pictures;
use isoslice_settings::layers::LayerSpan;
use rayon::ThreadPool;
use std::ops::Range;

/// Rates of the parts, and of what belongs to no part.
pub(super) struct Rates<'a> {
    pub parts: Vec<Rater<'a>>,
    pub plate: Rater<'a>,
}

impl<'a> Rates<'a> {
    /// The rates of a plate, whose parts have these bases. `pace` is the
    /// plate's own plan.
    ///
    /// # Errors
    /// If a setting is no valid expression, or if there is no part.
    pub(super) fn new(
        plate: &'a Plate,
        pace: &'a PacePlan,
        bases: &'a [Base<'a>],
    ) -> Result<Rates<'a>, SliceError> {
        let of = |pace: &'a PacePlan, base: &'a Base<'a>| {
            Rater::new(pace, &base.part.model, &base.around)
        };
        let of_part = |base: &'a Base<'a>| {
            of(&base.plans.pace, base)
                .map_err(|e| SliceError::of(plate, base.part, e.into()))
        };
        let first = bases.first().ok_or(SliceError::NoParts)?;
        Ok(Rates {
            parts: bases.iter().map(of_part).collect::<Result<_, _>>()?,
            plate: of(pace, first)?,
        })
    }
}

/// The stages that give a plate's moves their speeds.
pub(super) struct Pacing<'a> {
    /// The bed of the whole plate, and whether travels may hop.
    bed: BedPlan,
    hops: bool,
    pictures: Option<Pictures>,
    rates: &'a Rates<'a>,
    /// For each place on the plate the part that stands there, and how far it
    /// is from where the model was placed.
    places: Vec<(usize, DVec2)>,
    /// The places, in the order in which every second layer visits them. The
    /// others visit them the other way round.
    course: Vec<usize>,
    /// The skirt round several parts; a single part has its own.
    skirt: Option<Skirt>,
    /// The place printed last, and where the head is on the bed; none if the layer
    /// before has printed nothing.
    last: Option<usize>,
    at: Option<DVec2>,
    pacer: Pacer<'a>,
    /// The layers to be written.
    layers: Range<usize>,
    /// The layer that comes next.
    next: usize,
    /// Where parts are printed one by one: which of the places has its turn, how
    /// many layers were printed before, how high the finished parts are, and how
    /// high the head is to be on its way to the next one.
    turn: Option<usize>,
    before: usize,
    finished: Mm,
    clear: Option<Mm>,
    pool: &'a ThreadPool,
    timings: &'a Timings,
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl<'a> Pacing<'a> {
    /// The stages for a job.
    pub(super) fn new(
        job: &'a Job<'a>,
        rates: &'a Rates<'a>,
        skirt: Option<Skirt>,
        pictures: Option<Pictures>,
        pool: &'a ThreadPool,
    ) -> Self {
        let settings = &job.plate.settings;
        let places = job.plate.shifts();
        let stands = |&(part, shift): &(usize, DVec2)| {
            job.parts[part].part.model.offset.truncate() + shift
        };
        let stands: Vec<DVec2> = places.iter().map(stands).collect();
        Pacing {
            bed: BedPlan::of(settings),
            hops: settings.retract.z_hop > 0.0,
            pictures,
            rates,
            places,
            course: course(&stands),
            skirt,
            last: None,
            at: None,
            pacer: Pacer::new(rates.plate.plan),
            layers: job.extent.layers.clone(),
            next: job.extent.made.start,
            turn: None,
            before: 0,
            finished: 0.0,
            clear: None,
            pool,
            timings: job.stopwatch(),
            warnings: Vec::new(),
        }
    }

    /// Begins with the part in a place, which is finished before the next one
    /// begins. The one before was as high as `below`.
    pub(super) fn begin(&mut self, place: usize, below: Mm) {
        self.finished = self.finished.max(below);
        self.clear = self.turn.map(|_| Plate::clear_of(self.finished));
        self.turn = Some(place);
        self.before = self.next;
        self.last = None;
    }

    /// Gives the moves of the next layer their speeds. `passed` has the path of
    /// each part that is in the layer.
    pub(super) fn layer<'p>(
        &mut self,
        span: LayerSpan,
        passed: &dyn Fn(usize) -> Option<&'p Passed>,
    ) -> Result<PacedLayer, SliceError>
    where
        'a: 'p,
    {
        let stretches = self.stretches(&span, passed);
        limits::go_on()?;
        let prints = |step: &Move| matches!(step, Move::Print(_));
        let empty = !stretches.iter().any(|s| s.moves.iter().any(prints));
        let written = self.turn.is_some() || self.layers.contains(&span.index);
        if written && let Some(pictures) = &self.pictures {
            let moves = stretches.iter().flat_map(|s| s.moves.clone());
            let moves = moves.collect();
            // Pictures count all layers of the file.
            let index = self.before + span.index;
            let span = LayerSpan { index, ..span };
            pictures.draw(&LayerPath { span, moves }).map_err(|e| {
                SliceError::Picture(pictures.folder().to_owned(), e)
            })?;
        }
        let timings = self.timings;
        let rated = |stretch: Stretch<'a, 'p>| stretch.rated(&span, timings);
        let stretches = stretches.into_iter();
        let rated: Result<Vec<RatedStretch<'a>>, _> =
            self.pool.install(|| stretches.map(rated).collect());
        let rated = rated?;
        let mut paced = timings.time(Stage::Pace, || {
            self.pacer.layer(span, rated, &self.rates.plate)
        })?;
        paced.before = self.before;
        self.next += 1;
        if empty && self.turn.is_none() {
            // A run that begins with the next layer does not know where the head
            // was either.
            (self.last, self.at) = (None, None);
            self.pacer.forget(span.top);
        }
        Ok(paced)
    }

    /// The layer's moves in print order: the skirt's, and those of each place.
    fn stretches<'p>(
        &mut self,
        span: &LayerSpan,
        passed: &dyn Fn(usize) -> Option<&'p Passed>,
    ) -> Vec<Stretch<'a, 'p>>
    where
        'a: 'p,
    {
        let rates = self.rates;
        let mut stretches = Vec::new();
        if let Some(moves) = self.skirt_moves(span) {
            stretches.push(Stretch {
                place: None,
                moves,
                rater: &rates.plate,
                site: Site::default(),
            });
        }
        // The head does not go to places where nothing is printed. A single
        // part's moves are taken as they are.
        let alone = self.places.len() == 1;
        let mut course = self.course.clone();
        if !span.index.is_multiple_of(2) {
            course.reverse();
        }
        let mut there = Vec::new();
        for place in course {
            let (part, shift) = self.places[place];
            if self.turn.is_some_and(|turn| turn != place) {
                continue;
            }
            let Some(passed) = passed(part) else {
                continue;
            };
            let ends = match passed.path.ends() {
                Some((from, to)) => [from + shift, to + shift],
                None if alone => [DVec2::ZERO; 2],
                None => continue,
            };
            there.push((place, part, shift, passed, ends));
        }
        let hop = self.hops;
        for (place, part, shift, passed, [from, to]) in there {
            let mut moves = passed.path.moved(shift);
            // A part goes on where it ended, but not if another part was
            // printed last.
            let goes_on = match &self.last {
                Some(last) => *last == place,
                None => self.at.is_none(),
            };
            if !alone && !goes_on {
                let prints = |step: &Move| matches!(step, Move::Print(_));
                let first = moves.iter().position(prints).unwrap_or(0);
                let travel = match self.clear.take() {
                    Some(clear) => over_parts(from, clear),
                    None => between_parts(from, hop),
                };
                moves.splice(..first, [Move::Travel(travel)]);
            }
            if !alone {
                self.at = Some(to);
                self.last = Some(place);
            }
            stretches.push(Stretch {
                place: Some(place),
                moves,
                rater: &rates.parts[part],
                site: passed.site(shift),
            });
        }
        stretches
    }

    /// The skirt round all parts in a layer, if it has one.
    fn skirt_moves(&mut self, span: &LayerSpan) -> Option<Vec<Move>> {
        // A finished part would be in the way of another's skirt.
        let skirt = self.skirt.as_ref().filter(|_| self.before == 0)?;
        let mut loops = skirt.beads(span.index, span.height());
        let off_bed = keep_on_bed(&mut loops, DVec2::ZERO, self.bed);
        if span.index == 0 && self.layers.contains(&0) {
            self.warnings.extend(off_bed);
        }
        let hop = self.hops;
        let mut moves = Vec::new();
        for mut bead in loops {
            // Above a layer that has the skirt alone it begins where it is laid
            // out, not near the end of any layer below.
            let near = self.last.is_some() || !moves.is_empty();
            if let Some(at) = self.at.filter(|_| near) {
                begin_near(&mut bead.stroke, at);
            }
            let Some(&to) = bead.stroke.points.first() else {
                continue;
            };
            let travel = match (self.at, moves.is_empty()) {
                (None, _) => Travel::straight(to, span.index > 0),
                (Some(_), true) => between_parts(to, hop),
                // From loop to loop the way is a line's width.
                (Some(_), false) => Travel::straight(to, false),
            };
            moves.push(Move::Travel(travel));
            moves.push(Move::Print(bead));
            self.at = Some(to);
            self.last = None;
        }
        (!moves.is_empty()).then_some(moves)
    }
}
