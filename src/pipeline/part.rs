//! The first stages that run in order for each part: from a layer's beads to
//! their order.
//!
//! In: layers of a part from below. Out: their beads, in order, and where the
//! head comes from. What one layer of the part passes to the next is kept here,
//! and forgotten at the beginning of every block: see [`PartOrder::restart`].
//! `ways` makes paths of them.

use super::follow::Follow;
use super::job::Planned;
use super::layer::{Filled, Layer};
use super::plans::Plans;
use super::supported::Supported;
use crate::plate::Part;
use glam::DVec2;
use isoslice_base::timings::{Stage, Timings};
use isoslice_held::overhangs::foot::Foot;
use isoslice_held::overhangs::{self, Hanging, LayerOverhang};
use isoslice_layer::adhesion::{keep_on_bed, without_ears};
use isoslice_layer::infill::standing;
use isoslice_layer::seam::Guide;
use isoslice_layer::seam::ending::{Ended, cut, endings};
use isoslice_layer::walls::Support;
use isoslice_path::order::{self, Head, linked, order};
use isoslice_path::spiral::Spiral;
use isoslice_planar::{Area, Solid};
use isoslice_settings::Settings;
use isoslice_settings::layers::LayerSpan;
use std::ops::Range;
use std::sync::Arc;

/// The stages of one part up to the order of its beads.
pub(super) struct PartOrder<'a> {
    part: &'a Part,
    settings: &'a Settings,
    plans: &'a Plans,
    /// Way from the model's coordinates to the bed's.
    offset: DVec2,
    /// The climbing wall, if there is one.
    spiral: Option<&'a Spiral>,
    head: Head,
    /// Where seams come from that follow one another.
    guide: Option<Guide>,
    /// Number of beads of the infill that are left out, since they stand on
    /// nothing.
    left_out: usize,
    /// The layers to be written.
    layers: Range<usize>,
    /// Number of the part's layers.
    layer_count: usize,
    timings: &'a Timings,
    warnings: Vec<String>,
    hanging: overhangs::Tracker,
    /// The pads on which the part stands, unless there are none.
    pads: Option<&'a Area>,
    /// What the part stands on, if its first layer is written.
    foot: Option<Foot>,
}

/// A layer of a part whose beads are in order.
pub(super) struct Ordered {
    pub beads: Vec<Ended>,
    /// Where the head comes from, if that is known.
    pub from: Option<DVec2>,
    /// What the layer stands on, if its outline differs from the layer's.
    pub stands_on: Option<Arc<Solid<'static>>>,
    /// The layer, without its beads.
    pub filled: Filled,
}

impl<'a> PartOrder<'a> {
    /// The stages for a part, of whose layers `layers` are written.
    pub(super) fn new(planned: &'a Planned<'a>, layers: Range<usize>) -> Self {
        let Planned {
            part,
            stages,
            spans,
        } = planned;
        PartOrder {
            part,
            settings: &part.settings,
            plans: stages.plans,
            offset: part.model.offset.truncate(),
            spiral: stages.spiral.as_ref(),
            head: Head::default(),
            guide: stages.guide.clone(),
            left_out: 0,
            layers,
            layer_count: spans.len(),
            timings: &stages.timings,
            warnings: Vec::new(),
            hanging: overhangs::Tracker::default(),
            pads: stages.support().map(Supported::pads),
            foot: None,
        }
    }

    /// Takes the next layer.
    pub(super) fn layer(&mut self, mut filled: Filled) -> Ordered {
        let mut beads = std::mem::take(&mut filled.beads);
        let look = filled.look.take();
        let Filled {
            layer,
            below,
            above,
            ..
        } = &filled;
        let index = layer.span.index;
        if index == 0 {
            let without = without_ears(&beads.skirt, &self.plans.adhesion.brim);
            self.warnings.extend(without);
        }
        // A loop that leaves the bed in one place is left out in all, so that
        // equal parts stay equal.
        for place in &self.part.places {
            if beads.skirt.is_empty() {
                break;
            }
            let offset = self.offset + place.shift;
            let bed = self.plans.adhesion.bed;
            let off_bed = keep_on_bed(&mut beads.skirt, offset, bed);
            for warning in off_bed {
                if index == 0 && !self.warnings.contains(&warning) {
                    self.warnings.push(warning);
                }
            }
        }
        let written = self.layers.contains(&index);
        if written {
            self.left_out += filled.left_out;
        }
        self.follow_hanging(layer, look.as_ref(), written);
        let from = self.head.at;
        let solid = layer.outline.grid();
        let turns = std::mem::take(&mut beads.turns);
        let climbs = !turns.is_empty();
        // A climbing wall leans on the turn below. A raft holds what is on it.
        let on_raft = index == self.settings.raft_layers();
        let below = below.as_ref().filter(|_| !climbs && !on_raft);
        let ground = below.and_then(|below| layer.ground(below));
        let below = below.filter(|below| !layer.same_outline(below));
        let stands_on = below.map(|below| below.top().clone());
        let support = self.timings.time(Stage::Travel, || {
            let below = stands_on.as_deref()?;
            let share = self.settings.overhang_share;
            Support::new(below, &layer.outline, share, &self.plans.walls)
        });
        let support = support.as_ref();
        if let Some(guide) = self.guide.as_mut().filter(|_| !climbs) {
            if guide.looks_at(index) {
                layer.guide(guide, ground, above.as_ref());
            }
            if self.head.seams.is_empty() {
                self.head.seams = guide.seams(&layer.span);
            }
        }
        let ended = self.timings.time(Stage::Order, || {
            let context = order::Context {
                here: layer.face(),
                support,
                ground,
            };
            let beads =
                order(beads, context, &mut self.head, &self.plans.order);
            let beads = linked(beads, solid, &self.plans.order);
            let first = index == self.settings.raft_layers();
            let mut ended = endings(beads, solid, first, &self.plans.ending);
            ended.extend(turns.into_iter().map(Ended::from));
            ended
        });
        self.head.at = ended.last().and_then(Ended::end).or(from);
        let beads = self.timings.time(Stage::Travel, || match support {
            Some(support) => cut(ended, support),
            None => ended,
        });
        Ordered {
            beads,
            from,
            stands_on,
            filled,
        }
    }

    /// Follows what hangs to this layer.
    fn follow_hanging(
        &mut self,
        layer: &Layer,
        look: Option<&LayerOverhang>,
        written: bool,
    ) {
        let first = self.part.places.first().map_or(DVec2::ZERO, |p| p.shift);
        let span = layer.span;
        let follow = Follow {
            offset: self.offset + first,
            count: self.layer_count,
            written,
            plan: &self.plans.overhangs,
        };
        let tracker = &mut self.hanging;
        self.timings
            .time(Stage::Hang, || follow.layer(tracker, layer, look));
        if span.index == 0 && written && self.settings.raft_layers() == 0 {
            let none = Area::EMPTY;
            let pads = self.pads.unwrap_or(&none);
            let (outline, height) = (layer.area(), span.height());
            self.foot =
                Foot::new(outline, pads, height, &self.plans.adhesion.brim);
        }
    }

    /// Forgets what the layers below have passed on, so that what follows
    /// depends on nothing but the part. Returns where the head is, on the bed,
    /// if the part knows it all the same and stands in one place.
    pub(super) fn restart(&mut self, span: &LayerSpan) -> Option<DVec2> {
        // A climbing wall begins where the turn below ends.
        let at = self.spiral.and_then(|spiral| spiral.start(span.index));
        self.head = Head {
            at,
            ..Head::default()
        };
        match *self.part.places {
            [ref place] => at.map(|at| at + self.offset + place.shift),
            _ => None,
        }
    }

    /// What the user should know, what hangs in the part, and what it stands on.
    pub(super) fn finish(mut self) -> (Vec<String>, Hanging, Option<Foot>) {
        let warning = standing::warning(self.left_out, &self.plans.infill);
        self.warnings.extend(warning);
        (self.warnings, self.hanging.finish(), self.foot)
    }
}
