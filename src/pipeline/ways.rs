//! The stages that run in order for each part: from beads in order to a path.
//!
//! In: layers of a part from below, with their beads in order. Out: their
//! paths, as if the part stood alone where its model was placed. Nothing but
//! counts passes from one layer to the next.

use super::job::Planned;
use super::part::{Ordered, PartOrder};
use super::plans::Plans;
use super::supported::Top;
use super::tally::Tally;
use super::{BLOCK, SliceError};
use glam::DVec2;
use isoslice_base::timings::{Stage, Timings};
use isoslice_held::overhangs::Hanging;
use isoslice_held::overhangs::foot::Foot;
use isoslice_layer::seam::ending::Ended;
use isoslice_layer::view::{LayerFace, LayerView};
use isoslice_layer::walls::{Interlock, Reach};
use isoslice_path::pace::rates;
use isoslice_path::travel::{Ground, LayerPath, Move, connect};
use isoslice_path::z_contouring::{Site, ZContouring};
use isoslice_planar::Solid;
use isoslice_planar::bead::Plane;
use isoslice_settings::Settings;
use std::ops::Range;
use std::sync::Arc;

/// The stages of one part that make its paths.
pub(super) struct PartTravel<'a> {
    settings: &'a Settings,
    plans: &'a Plans,
    /// Way from the model's coordinates to the bed's.
    offset: DVec2,
    /// What lets beads follow the surface, if they have to.
    z_contouring: Option<ZContouring<'a>>,
    /// What lets tops of supports follow the undersides above them, if they have
    /// to.
    under: Option<ZContouring<'a>>,
    /// The layers to be written.
    layers: Range<usize>,
    timings: &'a Timings,
    /// Number of the part's beads.
    beads: usize,
    tally: Tally,
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

impl<'a> PartTravel<'a> {
    /// The stages for a part, of whose layers `layers` are written.
    pub(super) fn new(
        planned: &'a Planned<'a>,
        layers: Range<usize>,
        [z_contouring, under]: [Option<ZContouring<'a>>; 2],
    ) -> Self {
        let part = planned.part;
        PartTravel {
            settings: &part.settings,
            plans: planned.stages.plans,
            offset: part.model.offset.truncate(),
            z_contouring,
            under,
            layers,
            timings: &planned.stages.timings,
            beads: 0,
            tally: Tally::default(),
        }
    }

    /// Takes the next layer.
    pub(super) fn layer(
        &mut self,
        ordered: Ordered,
    ) -> Result<Passed, SliceError> {
        let Ordered {
            beads,
            from,
            stands_on,
            filled,
        } = ordered;
        let (layer, view) = (&filled.layer, filled.view());
        let index = layer.span.index;
        let written = self.layers.contains(&index);
        let beads = if self.settings.interlocks() {
            self.timings
                .time(Stage::Walls, || self.interlocked(beads, &view))
        } else {
            beads
        };
        let beads = self.timings.time(Stage::ZContouring, || {
            let under_support = filled.under_support.as_ref();
            let beads = self.on_surface(beads, &view, under_support)?;
            match &filled.support_top {
                Some(top) => self.support_below(beads, top, view.here),
                None => Ok(beads),
            }
        })?;
        let path = self.timings.time(Stage::Travel, || {
            let (_, border) = self.plans.walls.depths(layer.span.height());
            if written {
                let of_part = beads.iter().filter(|b| b.bead.role.is_part());
                let count = of_part.count();
                let beads = beads.iter().map(|b| &b.bead);
                let mut support =
                    beads.filter(|b| b.role.is_support()).peekable();
                let first = index == self.settings.raft_layers();
                let on_pads = first && support.peek().is_some();
                self.tally.support +=
                    support.map(|b| b.area() * b.stroke.length()).sum::<f64>();
                self.beads += count;
                if index >= self.settings.raft_layers() {
                    // What begins above an empty first layer stands on supports.
                    self.tally.add(layer, filled.gap, count == 0 && !on_pads);
                }
            }
            let mut path = connect(
                beads,
                Ground {
                    view: &view,
                    sparse: &filled.sparse,
                    border,
                },
                from,
                self.offset,
                &self.plans.travel,
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
            below: stands_on.filter(|_| self.settings.by_reach()),
            held: filled.held,
            outline: filled.layer.outline,
        })
    }

    /// The results of the part, of which `order` has made the beads' order.
    pub(super) fn finish(self, order: PartOrder<'_>) -> PartDone {
        let (warnings, hanging, foot) = order.finish();
        PartDone {
            beads: self.beads,
            tally: self.tally,
            warnings,
            hanging,
            foot,
        }
    }

    /// A layer's beads. Walls that lie half a layer lower are in their places.
    fn interlocked(
        &self,
        beads: Vec<Ended>,
        view: &LayerView<'_>,
    ) -> Vec<Ended> {
        let interlock = Interlock(view);
        let mut out = Vec::with_capacity(beads.len());
        for Ended { bead, wipe } in beads {
            let placed = interlock.placed(bead, self.plans.resolution);
            let any = !placed.is_empty();
            out.extend(placed.into_iter().map(Ended::from));
            if let Some(last) = out.last_mut().filter(|_| any) {
                last.wipe = wipe;
            }
        }
        out
    }

    /// The beads of a layer, of which those of supports end at their own `top`,
    /// and below the underside above them if they have to follow that.
    fn support_below(
        &self,
        beads: Vec<Ended>,
        top: &Top,
        layer: LayerFace<'_>,
    ) -> Result<Vec<Ended>, SliceError> {
        let mut beads = match &self.under {
            None => beads,
            Some(under) => {
                let above = top.above.as_ref().map(|(span, area)| LayerFace {
                    span: *span,
                    outline: area,
                    rough: area,
                    top: area,
                });
                let here = LayerFace {
                    span: top.span,
                    ..layer
                };
                let view = LayerView {
                    here,
                    above: above.into_iter().collect(),
                    // Their undersides stay as they are.
                    below: vec![here],
                };
                let site = Site {
                    view: &view,
                    under_support: None,
                };
                under.apply(beads, site)?
            }
        };
        let rise = top.span.top - layer.span.top;
        if rise != 0.0 {
            let all = beads.iter_mut().map(|ended| &mut ended.bead);
            for bead in all.filter(|bead| bead.role.is_support()) {
                bead.plane = Plane::Supports(rise);
                bead.stroke.rise_by(rise);
            }
        }
        Ok(beads)
    }

    /// A layer's beads, moved onto the surfaces above and below them if they
    /// have to follow these. Supports may stand on the layer.
    fn on_surface(
        &self,
        beads: Vec<Ended>,
        view: &LayerView<'_>,
        under_support: Option<&Solid<'_>>,
    ) -> Result<Vec<Ended>, SliceError> {
        let Some(z_contouring) = self.z_contouring.as_ref() else {
            return Ok(beads);
        };
        let mut view = view.clone();
        // The bed and a raft are flat.
        if view.here.span.index <= self.settings.raft_layers() {
            view.below = vec![view.here];
        }
        let site = Site {
            view: &view,
            under_support: under_support.map(Solid::grid),
        };
        Ok(z_contouring.apply(beads, site)?)
    }
}
