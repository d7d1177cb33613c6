//! The stages that run in order for the whole plate: from the parts' paths to
//! the text.
//!
//! In: layers of all parts from below. Out: their G-code and pictures. The
//! parts of a layer are printed one after the other, on a short way that begins
//! where the layer below has ended. A part that stands in several places has
//! one path, which is moved to each place. What one layer passes to the next is
//! forgotten at the beginning of every block: see [`Exit::restart`].

use super::job::{Base, Job};
use super::layer::Ready;
use super::part::{PartDone, PartExit, Passed};
use super::supply::plate::OnPlate;
use super::{BLOCK, Options, SliceError};
use crate::adhesion::{Skirt, keep_on_bed};
use crate::bead::Role;
use crate::gcode::{Totals, Writer};
use crate::layers::LayerSpan;
use crate::limits;
use crate::order::{begin_near, in_turn};
use crate::pace::rates::{Rater, Site};
use crate::pace::{PacedLayer, PacedMove, Pacer, Stretch};
use crate::plate::Plate;
use crate::preview::Pictures;
use crate::report::{self, RoleSum};
use crate::settings::Settings;
use crate::timings::{Stage, Timings};
use crate::travel::{LayerPath, Move, Travel, between_parts, over_parts};
use crate::units::{Mm, Mm3};
use glam::DVec2;
use std::collections::BTreeMap;
use std::io;
use std::ops::Range;

/// Rates of the parts, and of what belongs to no part.
pub(super) struct Rates<'a> {
    pub parts: Vec<Rater<'a>>,
    pub plate: Rater<'a>,
}

impl<'a> Rates<'a> {
    /// The rates of a plate, whose parts have these bases.
    ///
    /// # Errors
    /// If a setting is no valid expression, or if there is no part.
    pub(super) fn new(
        plate: &'a Plate,
        bases: &'a [Base<'a>],
    ) -> Result<Rates<'a>, SliceError> {
        let of = |settings: &'a Settings, base: &'a Base<'a>| {
            Rater::new(settings, &base.part.model, &base.around)
        };
        let of_part = |base: &'a Base<'a>| {
            of(&base.part.settings, base)
                .map_err(|e| plate.named(base.part, e.into()))
        };
        let first = bases.first().ok_or(SliceError::NoParts)?;
        Ok(Rates {
            parts: bases.iter().map(of_part).collect::<Result<_, _>>()?,
            plate: of(&plate.settings, first)?,
        })
    }
}

/// The stages that run in order.
pub(super) struct Exit<'a, 'w> {
    /// The settings of the whole plate.
    settings: &'a Settings,
    options: &'a Options<'a>,
    pictures: Option<Pictures>,
    parts: Vec<PartExit<'a>>,
    rates: &'a Rates<'a>,
    /// For each place on the plate the part that stands there, and how far it
    /// is from where the model was placed.
    places: Vec<(usize, DVec2)>,
    /// The skirt round several parts; a single part has its own.
    skirt: Option<Skirt>,
    /// The place printed last; none if that is forgotten.
    last: Option<usize>,
    /// Where the head is, on the bed; none if that is forgotten.
    at: Option<DVec2>,
    pacer: Pacer<'a>,
    writer: Writer<'a, &'w mut dyn io::Write>,
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
    timings: &'a Timings,
    printing: usize,
    slowed: usize,
    /// Volume extruded at each place.
    extruded: Vec<Mm3>,
    /// What the beads of each role amount to.
    roles: BTreeMap<&'static str, RoleSum>,
    warnings: Vec<String>,
    figures: report::RunFigures,
}

/// The results of a plate.
pub(super) struct Done {
    /// The results of each part.
    pub parts: Vec<PartDone>,
    /// The number of moves that print, and how many of them had to be slowed.
    pub printing: usize,
    pub slowed: usize,
    /// Volume extruded at each place.
    pub extruded: Vec<Mm3>,
    /// What the beads of each role amount to.
    pub roles: BTreeMap<&'static str, RoleSum>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// What the print takes: time and filament.
    pub totals: Totals,
    /// The measured accuracy.
    pub figures: report::RunFigures,
}

impl<'a, 'w> Exit<'a, 'w> {
    /// An exit for writing a job. The layers of the same block before the job's
    /// have to be given, too.
    pub(super) fn new(
        job: &'a Job<'a>,
        parts: Vec<PartExit<'a>>,
        rates: &'a Rates<'a>,
        skirt: Option<Skirt>,
        options: &'a Options<'a>,
        pictures: Option<Pictures>,
        writer: Writer<'a, &'w mut dyn io::Write>,
    ) -> Self {
        let settings = &job.plate.settings;
        let places = job.plate.shifts();
        let layers = job.extent.layers.clone();
        Exit {
            settings,
            options,
            pictures,
            parts,
            rates,
            extruded: vec![0.0; places.len()],
            places,
            skirt,
            last: None,
            at: None,
            pacer: Pacer::new(settings),
            writer,
            next: job.extent.made.start,
            turn: None,
            before: 0,
            finished: 0.0,
            clear: None,
            layers,
            timings: job.stopwatch(),
            printing: 0,
            slowed: 0,
            roles: BTreeMap::new(),
            warnings: Vec::new(),
            figures: report::RunFigures::default(),
        }
    }

    /// Takes the next layer.
    pub(super) fn layer(&mut self, ready: OnPlate) -> Result<(), SliceError> {
        let Some(span) = ready.first().map(|(_, ready)| ready.layer.span)
        else {
            return Ok(());
        };
        let index = span.index;
        if index > 0 && index.is_multiple_of(BLOCK) {
            self.restart(&span);
        }
        let written = self.layers.contains(&index);
        let mut passed: Vec<Option<Passed>> = Vec::new();
        passed.resize_with(self.parts.len(), || None);
        for (k, ready) in ready {
            passed[k] = Some(self.pass(k, ready)?);
        }
        self.print(span, written, &|part| passed[part].as_ref())
    }

    /// Makes the path of a part's next layer.
    pub(super) fn pass(
        &mut self,
        part: usize,
        ready: Ready,
    ) -> Result<Passed, SliceError> {
        let layer = self.parts[part].layer(ready)?;
        if let Some(figures) = &layer.figures {
            self.figures.add(figures, self.options.report);
        }
        Ok(layer)
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

    /// Prints the next layer of the part whose turn it is.
    pub(super) fn print_turn(
        &mut self,
        part: usize,
        passed: &Passed,
    ) -> Result<(), SliceError> {
        let span = passed.path.span;
        self.print(span, true, &|k| (k == part).then_some(passed))
    }

    /// Prints a layer, of which the path of each part is known, if that is in
    /// it.
    fn print<'p>(
        &mut self,
        span: LayerSpan,
        written: bool,
        passed: &dyn Fn(usize) -> Option<&'p Passed>,
    ) -> Result<(), SliceError>
    where
        'a: 'p,
    {
        let stretches = self.stretches(&span, passed);
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
        let mut paced = self.timings.time(Stage::Pace, || {
            self.pacer.layer(span, stretches, &self.rates.plate)
        })?;
        paced.before = self.before;
        if written {
            self.printing += paced.printing;
            self.slowed += paced.slowed;
            self.count(&paced);
            for (role, amount) in &paced.amounts {
                let sum = self.roles.entry(role.name()).or_default();
                sum.length_mm += amount.length;
                sum.filament_mm += amount.filament;
                sum.time_s += amount.time;
            }
        }
        self.timings.time(Stage::Gcode, || {
            if written {
                self.writer.layer(&paced)
            } else {
                self.writer.rehearse(&paced)
            }
        })?;
        limits::made(paced.moves.len());
        self.next += 1;
        if written {
            let done = self.next - self.layers.start;
            limits::layers_done(done, self.layers.len());
            (self.options.on_layer)(done, self.layers.len());
        }
        Ok(())
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
        let mut there = Vec::new();
        let mut ways = Vec::new();
        for (place, &(part, shift)) in self.places.iter().enumerate() {
            if self.turn.is_some_and(|turn| turn != place) {
                continue;
            }
            let Some(passed) = passed(part) else {
                continue;
            };
            match passed.path.ends() {
                Some((from, to)) => ways.push((from + shift, to + shift)),
                None if alone => ways.push((DVec2::ZERO, DVec2::ZERO)),
                None => continue,
            }
            there.push((place, part, shift, passed));
        }
        for k in in_turn(&ways, self.at) {
            let (place, part, shift, passed) = there[k];
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
                    Some(clear) => over_parts(ways[k].0, clear),
                    None => between_parts(ways[k].0, self.settings),
                };
                moves.splice(..first, [Move::Travel(travel)]);
            }
            if !alone {
                self.at = Some(ways[k].1);
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
        let off_bed = keep_on_bed(&mut loops, DVec2::ZERO, self.settings);
        if span.index == 0 {
            self.warnings.extend(off_bed);
        }
        let mut moves = Vec::new();
        for mut bead in loops {
            if let Some(at) = self.at {
                begin_near(&mut bead, at);
            }
            let Some(&to) = bead.points.first() else {
                continue;
            };
            let travel = match (self.at, moves.is_empty()) {
                (None, _) => Travel::straight(to, span.index >= BLOCK),
                (Some(_), true) => between_parts(to, self.settings),
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

    /// Adds up what is extruded at each place.
    fn count(&mut self, paced: &PacedLayer) {
        for part in &paced.parts {
            let Some(place) = part.place else { continue };
            let volume = paced.moves[part.moves.clone()].iter().map(volume);
            self.extruded[place] += volume.sum::<Mm3>();
        }
    }

    /// Forgets what the layers below have passed on, so that what follows
    /// depends on nothing but the plate. This costs a travel from wherever the
    /// head is.
    fn restart(&mut self, span: &LayerSpan) {
        let heads = self.parts.iter_mut().map(|part| part.restart(span));
        let heads: Vec<Option<DVec2>> = heads.collect();
        let alone = self.places.len() == 1;
        let place = heads.first().copied().flatten().filter(|_| alone);
        self.last = None;
        self.at = None;
        self.pacer.restart(place, span.bottom);
        self.writer.restart();
    }

    /// Ends the file.
    pub(super) fn finish(self) -> Result<Done, SliceError> {
        Ok(Done {
            parts: self.parts.into_iter().map(PartExit::finish).collect(),
            printing: self.printing,
            slowed: self.slowed,
            extruded: self.extruded,
            warnings: self.warnings,
            roles: self.roles,
            totals: self.writer.finish()?,
            figures: self.figures,
        })
    }
}

/// Volume that a step extrudes for the part or its supports.
fn volume(step: &PacedMove) -> Mm3 {
    match step {
        PacedMove::Print {
            bead, turns, flow, ..
        } if bead.role != Role::Skirt => {
            let along = |(i, (a, b)): (usize, (DVec2, DVec2))| {
                let turn = turns.get(i).copied().flatten();
                let length = turn.map_or(a.distance(b), |t| t.length(a));
                length
                    * if bead.levels.is_empty() {
                        bead.area()
                    } else {
                        bead.area_along(i)
                    }
            };
            flow * bead.segments().enumerate().map(along).sum::<Mm3>()
        }
        _ => 0.0,
    }
}
