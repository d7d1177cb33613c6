//! What is counted of a part's layers, in their order.

use super::follow::Follow;
use super::job::Planned;
use super::part::Counted;
use super::plans::Plans;
use super::supported::Supported;
use super::tally::Tally;
use glam::DVec2;
use isoslice_base::timings::{Stage, Timings};
use isoslice_held::overhangs::foot::Foot;
use isoslice_held::overhangs::{self, Hanging};
use isoslice_layer::infill::told::InfillCount;
use isoslice_planar::Area;
use isoslice_plate::Part;
use isoslice_settings::BrimPlace;
use std::ops::Range;

/// The sums of a part.
pub(super) struct PartSums<'a> {
    part: &'a Part,
    plans: &'a Plans,
    /// The layers to be written.
    layers: Range<usize>,
    /// Number of the part's layers, and of those of its raft.
    layer_count: usize,
    raft_layers: usize,
    /// The pads on which the part stands, unless there are none.
    pads: Option<&'a Area>,
    timings: &'a Timings,
    beads: usize,
    infill: InfillCount,
    tally: Tally,
    hanging: overhangs::Tracker,
    foot: Option<Foot>,
    warnings: Vec<String>,
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

impl<'a> PartSums<'a> {
    /// The sums of a part, of whose layers `layers` are written.
    pub(super) fn new(planned: &'a Planned<'a>, layers: Range<usize>) -> Self {
        let Planned {
            part,
            stages,
            spans,
            top,
        } = planned;
        let highest = spans.last().map_or(0.0, |span| span.top);
        let is_last = layers.end >= spans.len();
        let bare = if is_last { [highest, *top] } else { [0.0; 2] };
        PartSums {
            part,
            plans: stages.plans,
            layers,
            layer_count: spans.len(),
            raft_layers: stages.plans.raft.layers,
            pads: stages.support().map(Supported::pads),
            timings: &stages.timings,
            beads: 0,
            infill: InfillCount::default(),
            tally: Tally::over(bare),
            hanging: overhangs::Tracker::default(),
            foot: None,
            warnings: Vec::new(),
        }
    }

    /// Takes the next layer.
    pub(super) fn add(&mut self, counted: Counted) {
        let layer = &counted.layer;
        let index = layer.span.index;
        let written = self.layers.contains(&index);
        let first = self.part.places.first().map_or(DVec2::ZERO, |p| p.shift);
        let follow = Follow {
            offset: self.part.model.offset.truncate() + first,
            count: self.layer_count,
            written,
            plan: &self.plans.overhangs,
        };
        let tracker = &mut self.hanging;
        self.timings.time(Stage::Hang, || {
            follow.layer(tracker, layer, counted.look.as_ref());
        });
        if !written {
            return;
        }
        self.warnings.extend(counted.warnings);
        if index == self.raft_layers {
            let none = Area::EMPTY;
            let pads = self.pads.unwrap_or(&none);
            let (outline, height) = (layer.area(), layer.span.height());
            let mut brim = self.plans.adhesion.brim;
            if self.raft_layers > 0 {
                brim.place = BrimPlace::None;
            }
            self.foot = Foot::new(outline, pads, height, &brim);
        }
        self.infill.add(counted.infill);
        self.tally.support += counted.support;
        self.beads += counted.beads;
        if index >= self.raft_layers {
            // What begins above an empty first layer stands on supports.
            let on_pads = index == self.raft_layers && counted.supported;
            let empty = counted.beads == 0 && !on_pads;
            self.tally.add(layer, counted.gap, empty);
        }
    }

    /// The results of the part.
    pub(super) fn finish(mut self) -> PartDone {
        let whole = self.layers == (0..self.layer_count);
        let told = self.infill.warnings(&self.plans.infill, whole);
        self.warnings.extend(told);
        PartDone {
            beads: self.beads,
            tally: self.tally,
            warnings: self.warnings,
            hanging: self.hanging.finish(),
            foot: self.foot,
        }
    }
}
