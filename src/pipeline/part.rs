//! The stages that run in order for each part: from a layer's beads to its
//! path.
//!
//! In: layers of a part from below. Out: their paths, as if the part stood
//! alone where its model was placed. What one layer of the part passes to the
//! next is kept here, and forgotten at the beginning of every block: see
//! [`PartExit::restart`].

use super::hanging::Follow;
use super::job::Planned;
use super::layer::{Filled, Layer, Ready};
use super::tally::Tally;
use super::{BLOCK, SliceError};
use crate::adhesion::{keep_on_bed, without_ears};
use crate::bead::Level;
use crate::hang::foot::Foot;
use crate::hang::{self, Hanging, Look};
use crate::infill::standing::Standing;
use crate::layers::LayerSpan;
use crate::order::{self, Head, linked, order};
use crate::pace::rates;
use crate::plane::Solid;
use crate::plate::Part;
use crate::region::wall_depths;
use crate::relief::{Relief, Side, Site};
use crate::report::LayerFigures;
use crate::seam::ending::{Ended, cut, endings};
use crate::settings::Settings;
use crate::spiral::Spiral;
use crate::timings::{Stage, Timings};
use crate::travel::{Ground, LayerPath, Move, connect};
use crate::walls::{Beside, Interlock, Reach, Support};
use glam::DVec2;
use std::ops::Range;
use std::sync::Arc;

/// The stages of one part that run in order.
pub(super) struct PartExit<'a> {
    part: &'a Part,
    settings: &'a Settings,
    /// Way from the model's coordinates to the bed's.
    offset: DVec2,
    /// The climbing wall, if there is one.
    spiral: Option<&'a Spiral<'a>>,
    /// What lets beads follow the surface, if they have to.
    relief: Option<Relief<'a>>,
    head: Head,
    /// The check of infill that may stand on nothing.
    standing: Option<Standing>,
    /// The layers to be written.
    layers: Range<usize>,
    /// Number of the part's layers.
    layer_count: usize,
    timings: &'a Timings,
    beads: usize,
    tally: Tally,
    warnings: Vec<String>,
    hanging: hang::Tracker,
    /// What the part stands on, if its first layer is written.
    foot: Option<Foot>,
}

/// A layer of a part after these stages.
pub(super) struct Passed {
    /// The layer's moves, where the model was placed.
    pub path: LayerPath,
    /// The outline to print.
    pub outline: Arc<Solid<'static>>,
    /// What holds the layer, if that matters: the layer below, if its outline
    /// differs, and supports.
    below: Option<Arc<Solid<'static>>>,
    held: Option<Solid<'static>>,
    /// The layer's accuracy, if it was measured.
    pub figures: Option<LayerFigures>,
}

impl Passed {
    /// Where the layer's beads are in a place that is `shift` away from where
    /// the model was placed.
    pub(super) fn site(&self, shift: DVec2) -> rates::Site<'_> {
        let held = self.held.as_ref().map(Solid::grid);
        let below = self.below.as_ref();
        rates::Site {
            solid: Some(self.outline.grid()),
            reach: below.map(|below| Reach::new(below.grid(), held)),
            shift,
        }
    }
}

/// The results of a part.
pub(super) struct PartDone {
    /// Number of the part's beads. A skirt alone has none.
    pub beads: usize,
    /// What was counted.
    pub tally: Tally,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// What hangs in the part.
    pub hanging: Hanging,
    /// What the part stands on, if its first layer is written.
    pub foot: Option<Foot>,
}

impl<'a> PartExit<'a> {
    /// The stages for a part, of whose layers `layers` are written.
    pub(super) fn new(
        planned: &'a Planned<'a>,
        layers: Range<usize>,
        relief: Option<Relief<'a>>,
    ) -> Self {
        let Planned {
            part,
            stages,
            spans,
        } = planned;
        PartExit {
            part,
            settings: &part.settings,
            offset: part.model.offset.truncate(),
            spiral: stages.spiral.as_ref(),
            relief,
            head: Head::default(),
            standing: Standing::new(&part.settings),
            layers,
            layer_count: spans.len(),
            timings: &stages.timings,
            beads: 0,
            tally: Tally::default(),
            warnings: Vec::new(),
            hanging: hang::Tracker::default(),
            foot: None,
        }
    }

    /// Takes the next layer.
    pub(super) fn layer(&mut self, ready: Ready) -> Result<Passed, SliceError> {
        let (layer, above) = (&ready.layer, ready.above.as_ref());
        let below = ready.below.as_ref();
        let Filled {
            mut beads,
            sparse,
            gap,
            look,
            figures,
            support: supported,
            support_rise,
            held,
            under_support,
            areas: _,
        } = ready.filled;
        let index = layer.span.index;
        if index == 0 {
            let without = without_ears(&beads.skirt, self.settings);
            self.warnings.extend(without);
        }
        // A loop that leaves the bed in one place is left out in all, so that
        // equal parts stay equal.
        for place in &self.part.places {
            if beads.skirt.is_empty() {
                break;
            }
            let offset = self.offset + place.shift;
            let off_bed = keep_on_bed(&mut beads.skirt, offset, self.settings);
            for warning in off_bed {
                if index == 0 && !self.warnings.contains(&warning) {
                    self.warnings.push(warning);
                }
            }
        }
        let written = self.layers.contains(&index);
        if let Some(standing) = &mut self.standing {
            let infill = std::mem::take(&mut beads.infill);
            if index == self.settings.raft_layers() {
                // All infill of the layer counts as standing on what is below
                // it.
                standing.forget();
            }
            beads.infill = self.timings.time(Stage::Infill, || {
                standing.kept(infill, beads.shell(), written)
            });
        }
        self.follow_hanging(layer, look.as_ref(), written);
        let from = self.head.at;
        let solid = layer.outline.grid();
        let turns = std::mem::take(&mut beads.turns);
        let climbs = !turns.is_empty();
        // A climbing wall leans on the turn below. A raft holds what is on it.
        let on_raft = index == self.settings.raft_layers();
        let below = below.filter(|_| !climbs && !on_raft);
        let below = below.filter(|below| !layer.same_outline(below));
        let below: Option<Arc<Solid<'static>>> =
            below.map(|below| below.top().clone());
        let support = self.timings.time(Stage::Travel, || {
            let below = below.as_deref()?;
            Support::new(below, &layer.outline, self.settings)
        });
        let support = support.as_ref();
        let ended = self.timings.time(Stage::Order, || {
            let context = order::Context {
                number: index,
                outline: layer.area(),
                support,
            };
            let beads = order(beads, context, &mut self.head, self.settings);
            let beads = linked(beads, solid, self.settings);
            let first = index == self.settings.raft_layers();
            let mut ended = endings(beads, solid, first, self.settings);
            ended.extend(turns.into_iter().map(Ended::from));
            ended
        });
        self.head.at = ended.last().and_then(Ended::end).or(from);
        let beads = self.timings.time(Stage::Travel, || match support {
            Some(support) => cut(ended, support),
            None => ended,
        });
        let beads = if self.settings.interlocks() {
            self.timings.time(Stage::Walls, || {
                self.interlocked(beads, layer, ready.below.as_ref(), above)
            })
        } else {
            beads
        };
        let mut beads = self.timings.time(Stage::Skin, || {
            let beside = [ready.below.as_ref(), above];
            self.on_surface(beads, layer, beside, under_support.as_ref())
        })?;
        if support_rise != 0.0 {
            let all = beads.iter_mut().map(|ended| &mut ended.bead);
            for bead in all.filter(|bead| bead.role.is_support()) {
                let rise = support_rise;
                let level = Level { rise, extra: 0.0 };
                bead.levels = vec![level; bead.points.len()];
            }
        }
        let path = self.timings.time(Stage::Travel, || {
            let (_, border) = wall_depths(layer.span.height(), self.settings);
            if written {
                let of_part = beads.iter().filter(|b| b.bead.role.is_part());
                let count = of_part.count();
                let support = beads.iter().map(|b| &b.bead);
                let support = support.filter(|b| b.role.is_support());
                self.tally.support +=
                    support.map(|b| b.area() * b.length()).sum::<f64>();
                self.beads += count;
                if index >= self.settings.raft_layers() {
                    self.tally.add(layer, gap, count == 0);
                }
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
            // If the head's place is unknown, the way may lead over anything.
            if from.is_none()
                && index >= BLOCK
                && let Some(Move::Travel(travel)) = path.moves.first_mut()
            {
                travel.retract = true;
                travel.hop = true;
            }
            path
        });
        Ok(Passed {
            path,
            below: below.filter(|_| self.settings.by_reach()),
            held,
            outline: layer.outline.clone(),
            figures,
        })
    }

    /// A layer's beads. Walls that lie half a layer lower are in their places.
    fn interlocked(
        &self,
        beads: Vec<Ended>,
        layer: &Layer,
        below: Option<&Layer>,
        above: Option<&Layer>,
    ) -> Vec<Ended> {
        fn beside<'l>(layer: &Layer, other: &'l Layer) -> Beside<'l> {
            let same = layer.same_outline(other);
            Beside {
                height: other.span.height(),
                outline: (!same).then(|| other.outline.grid()),
            }
        }
        let interlock = Interlock {
            outline: layer.outline.grid(),
            below: below.map(|below| beside(layer, below)),
            above: above.map(|above| beside(layer, above)),
        };
        let mut out = Vec::with_capacity(beads.len());
        for Ended { bead, wipe } in beads {
            let placed = interlock.placed(bead, self.settings);
            let any = !placed.is_empty();
            out.extend(placed.into_iter().map(Ended::from));
            if let Some(last) = out.last_mut().filter(|_| any) {
                last.wipe = wipe;
            }
        }
        out
    }

    /// A layer's beads, moved onto the surfaces above and below them if they
    /// have to follow these. `under_support` is where supports stand on the
    /// layer.
    fn on_surface(
        &self,
        beads: Vec<Ended>,
        layer: &Layer,
        [below, above]: [Option<&Layer>; 2],
        under_support: Option<&Solid<'static>>,
    ) -> Result<Vec<Ended>, SliceError> {
        let Some(relief) = self.relief.as_ref() else {
            return Ok(beads);
        };
        fn side<'l>(layer: &Layer, other: Option<&'l Layer>) -> Side<'l> {
            let Some(other) = other else {
                return Side::Open;
            };
            if layer.same_outline(other) {
                Side::Closed
            } else {
                Side::Layer(other.span.height(), other.outline.grid())
            }
        }
        // The bed and a raft are flat.
        let flat = layer.span.index <= self.settings.raft_layers();
        let site = Site {
            span: layer.span,
            above: side(layer, above),
            below: if flat {
                Side::Closed
            } else {
                side(layer, below)
            },
            under_support: under_support.map(Solid::grid),
        };
        Ok(relief.apply(beads, site)?)
    }

    /// Follows what hangs to this layer.
    fn follow_hanging(
        &mut self,
        layer: &Layer,
        look: Option<&Look>,
        written: bool,
    ) {
        let first = self.part.places.first().map_or(DVec2::ZERO, |p| p.shift);
        let span = layer.span;
        let follow = Follow {
            offset: self.offset + first,
            count: self.layer_count,
            written,
            settings: self.settings,
        };
        let tracker = &mut self.hanging;
        self.timings
            .time(Stage::Hang, || follow.layer(tracker, layer, look));
        if span.index == 0 && written && self.settings.raft_layers() == 0 {
            self.foot = Foot::new(layer.area(), span.height(), self.settings);
        }
    }

    /// Forgets what the layers below have passed on, so that what follows
    /// depends on nothing but the part. Returns where the head is, on the bed,
    /// if the part knows it all the same.
    pub(super) fn restart(&mut self, span: &LayerSpan) -> Option<DVec2> {
        // A climbing wall begins where the turn below ends.
        let at = self.spiral.and_then(|spiral| spiral.start(span.index));
        self.head = Head {
            at,
            ..Head::default()
        };
        self.standing.iter_mut().for_each(Standing::forget);
        at.map(|at| at + self.offset)
    }

    /// The results of the part.
    pub(super) fn finish(mut self) -> PartDone {
        let standing = self.standing.as_ref();
        self.warnings.extend(standing.and_then(Standing::warning));
        PartDone {
            beads: self.beads,
            tally: self.tally,
            warnings: self.warnings,
            hanging: self.hanging.finish().0,
            foot: self.foot,
        }
    }
}
