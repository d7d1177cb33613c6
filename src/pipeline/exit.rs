//! What is done in order: from a layer's beads to its text.
//!
//! In: layers from below. Out: their G-code and pictures. Everything that one
//! layer hands to the next passes through here, and is forgotten at the
//! beginning of every block: see [`Exit::restart`].

use super::layer::{Filled, Layer, Ready};
use super::tally::Tally;
use super::{BLOCK, Options, SliceError};
use crate::adhesion::keep_on_bed;
use crate::gcode::{Totals, Writer};
use crate::hang::foot::Foot;
use crate::hang::{self, Hanging, Look};
use crate::infill::standing::Standing;
use crate::layers::LayerSpan;
use crate::limits;
use crate::order::{Head, linked, order};
use crate::pace::Pacer;
use crate::preview::Pictures;
use crate::region::wall_depths;
use crate::relief::{Relief, Site};
use crate::report;
use crate::seam::ending::{Ended, cut, endings};
use crate::settings::Settings;
use crate::spiral::Spiral;
use crate::timings::{Stage, Timings};
use crate::travel::{Ground, Move, connect};
use crate::walls::Support;
use glam::DVec2;
use std::io;
use std::ops::Range;

/// The stages that run in order.
pub(super) struct Exit<'a, 'w> {
    settings: &'a Settings,
    options: &'a Options<'a>,
    pictures: Option<Pictures>,
    /// From the model's coordinates to the bed's.
    offset: DVec2,
    /// The climbing wall, if there is one.
    spiral: Option<&'a Spiral<'a>>,
    /// What lets beads follow the surface, if they are to.
    relief: Option<Relief<'a>>,
    head: Head,
    /// For infill that may stand on nothing.
    standing: Option<Standing>,
    pacer: Pacer<'a>,
    writer: Writer<'a, &'w mut dyn io::Write>,
    /// The layers to be written.
    layers: Range<usize>,
    /// How many the part has.
    layer_count: usize,
    /// The one that comes next.
    next: usize,
    timings: &'a Timings,
    beads: usize,
    tally: Tally,
    warnings: Vec<String>,
    hanging: hang::Tracker,
    /// What the part stands on, if the first layer is written.
    foot: Option<Foot>,
    figures: report::RunFigures,
}

/// What came of it.
pub(super) struct Done {
    /// Beads of the part printed: a skirt alone is nothing.
    pub beads: usize,
    /// What was counted.
    pub tally: Tally,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// What hangs.
    pub hanging: Hanging,
    /// What the part stands on, if that is written.
    pub foot: Option<Foot>,
    /// What the print takes.
    pub totals: Totals,
    /// How far it is off.
    pub figures: report::RunFigures,
}

impl<'a, 'w> Exit<'a, 'w> {
    /// For writing `layers` of a part's `layer_count`; those of the same block
    /// before them have to be given, too.
    #[expect(
        clippy::too_many_arguments,
        reason = "each is a part that the caller has made, and is used once"
    )]
    pub(super) fn new(
        timings: &'a Timings,
        offset: DVec2,
        layers: Range<usize>,
        layer_count: usize,
        options: &'a Options<'a>,
        pictures: Option<Pictures>,
        writer: Writer<'a, &'w mut dyn io::Write>,
        pacer: Pacer<'a>,
        spiral: Option<&'a Spiral<'a>>,
        relief: Option<Relief<'a>>,
    ) -> Self {
        Exit {
            settings: pacer.settings(),
            options,
            pictures,
            offset,
            spiral,
            relief,
            head: Head::default(),
            standing: Standing::new(pacer.settings()),
            pacer,
            writer,
            next: layers.start - layers.start % BLOCK,
            layers,
            layer_count,
            timings,
            beads: 0,
            tally: Tally::default(),
            warnings: Vec::new(),
            hanging: hang::Tracker::default(),
            foot: None,
            figures: report::RunFigures::default(),
        }
    }

    /// Takes the next layer.
    pub(super) fn layer(&mut self, ready: Ready) -> Result<(), SliceError> {
        let (layer, above) = (&ready.layer, ready.above.as_ref());
        let below = ready.below.as_ref();
        let Filled {
            mut beads,
            sparse,
            gap,
            look,
            figures,
            support: supported,
            areas: _,
        } = ready.filled;
        let index = layer.span.index;
        if index > 0 && index.is_multiple_of(BLOCK) {
            self.restart(&layer.span);
        }
        let off_bed = keep_on_bed(&mut beads.skirt, self.offset, self.settings);
        if index == 0 {
            self.warnings.extend(off_bed);
        }
        let written = self.layers.contains(&index);
        if let Some(standing) = &mut self.standing {
            let infill = std::mem::take(&mut beads.infill);
            beads.infill = self.timings.time(Stage::Infill, || {
                standing.kept(infill, beads.shell(), written)
            });
        }
        self.follow_hanging(layer, look.as_ref(), written);
        let from = self.head.at;
        let solid = layer.outline.grid();
        let turn = beads.turn.take();
        let turns = turn.is_some();
        let ended = self.timings.time(Stage::Order, || {
            let beads =
                order(beads, layer.area(), &mut self.head, self.settings);
            let beads = linked(beads, solid, self.settings);
            let mut ended = endings(beads, solid, self.settings);
            ended.extend(turn.map(Ended::from));
            ended
        });
        self.head.at = ended.last().and_then(Ended::end).or(from);
        let beads = self.timings.time(Stage::Travel, || {
            let below = below.filter(|below| !layer.same_outline(below));
            let below = below.map(|below| below.top(self.settings));
            let support = below
                .as_deref()
                .and_then(|b| Support::new(b, &layer.outline, self.settings));
            match &support {
                Some(support) if !turns => cut(ended, support),
                _ => ended,
            }
        });
        let beads = self
            .timings
            .time(Stage::Skin, || self.on_surface(beads, layer, above))?;
        let path = self.timings.time(Stage::Travel, || {
            // By the layer's own height. Walls are shared by layers whose
            // heights are the same but for rounding, and that decides between
            // ways that are equally long: a range of layers would differ.
            let (_, border) = wall_depths(layer.span.height(), self.settings);
            if written {
                let of_part = beads.iter().filter(|b| b.bead.role.is_part());
                let count = of_part.count();
                let support = beads.iter().map(|b| &b.bead);
                let support = support.filter(|b| b.role.is_support());
                self.tally.support +=
                    support.map(|b| b.area() * b.length()).sum::<f64>();
                self.beads += count;
                self.tally.add(layer, gap, count == 0);
            }
            let mut path = connect(
                layer.span,
                beads,
                Ground {
                    outline: &layer.outline,
                    sparse: &sparse,
                    support: supported.as_ref(),
                    border,
                    above: above.map(Layer::area),
                },
                from,
                self.offset,
                self.settings,
            );
            // From an unknown place the way may lead over anything.
            if from.is_none()
                && index >= BLOCK
                && let Some(Move::Travel(travel)) = path.moves.first_mut()
            {
                travel.retract = true;
                travel.hop = true;
            }
            path
        });
        if written && let Some(pictures) = &self.pictures {
            pictures.draw(&path).map_err(|e| {
                SliceError::Picture(pictures.folder().to_owned(), e)
            })?;
        }
        let paced = self
            .timings
            .time(Stage::Pace, || self.pacer.layer(path, Some(solid)))?;
        if written {
            self.tally.printing += paced.printing;
            self.tally.slowed += paced.slowed;
        }
        self.timings.time(Stage::Gcode, || match written {
            true => self.writer.layer(&paced),
            false => self.writer.rehearse(&paced),
        })?;
        if let Some(figures) = figures {
            self.figures.add(&figures, self.options.report);
        }
        self.next += 1;
        if written {
            let done = self.next - self.layers.start;
            limits::layers_done(done, self.layers.len());
            (self.options.on_layer)(done, self.layers.len());
        }
        Ok(())
    }

    /// A layer's beads on the surface above them, if they are to follow it.
    fn on_surface(
        &self,
        beads: Vec<Ended>,
        layer: &Layer,
        above: Option<&Layer>,
    ) -> Result<Vec<Ended>, SliceError> {
        let covered = above.is_some_and(|above| layer.same_outline(above));
        let Some(relief) = self.relief.as_ref().filter(|_| !covered) else {
            return Ok(beads);
        };
        let site = Site {
            span: layer.span,
            above: above.map(|a| (a.span.height(), a.outline.grid())),
        };
        Ok(relief.apply(beads, site)?)
    }

    /// Follows what hangs.
    fn follow_hanging(
        &mut self,
        layer: &Layer,
        look: Option<&Look>,
        written: bool,
    ) {
        let (offset, span) = (self.offset, layer.span);
        let place = |p: DVec2| (p + offset).extend(span.bottom);
        let tracker = &mut self.hanging;
        self.timings.time(Stage::Hang, || match look {
            Some(look) => {
                tracker.layer(look, layer.outline.grid(), written, place)
            }
            None => tracker.same(span.height(), written, self.settings),
        });
        // With the block, or with the part.
        let next = span.index + 1;
        if next.is_multiple_of(BLOCK) || next == self.layer_count {
            tracker.restart(written, self.settings);
        }
        if span.index == 0 && written {
            self.foot = Foot::new(layer.area(), span.height(), self.settings);
        }
    }

    /// Forgets what the layers below have left, so that what follows depends
    /// on nothing but the part. It costs a travel from wherever the head is.
    fn restart(&mut self, span: &LayerSpan) {
        // A climbing wall goes on where the turn below ends.
        let at = self.spiral.and_then(|spiral| spiral.start(span.index));
        self.head = Head {
            at,
            ..Head::default()
        };
        self.standing.iter_mut().for_each(Standing::forget);
        let place = at.map(|at| at + self.offset);
        self.pacer.restart(place, span.bottom);
        self.writer.restart();
    }

    /// Ends the file.
    pub(super) fn finish(mut self) -> Result<Done, SliceError> {
        let standing = self.standing.as_ref();
        self.warnings.extend(standing.and_then(Standing::warning));
        Ok(Done {
            beads: self.beads,
            tally: self.tally,
            warnings: self.warnings,
            hanging: self.hanging.finish(),
            foot: self.foot,
            totals: self.writer.finish()?,
            figures: self.figures,
        })
    }
}
