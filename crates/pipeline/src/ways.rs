//! From a layer's beads in order to its path.
//!
//! In: a layer of a part with its beads in order, and where the layer below ends.
//! Out: its path, as if the part stood alone where its model was placed, and what
//! is counted of it.

use super::SliceError;
use super::layer::Filled;
use super::part::{Counted, PartPaths, Passed};
use super::supported::Top;
use glam::DVec2;
use isoslice_base::timings::Stage;
use isoslice_layer::seam::ending::Ended;
use isoslice_layer::view::{LayerFace, LayerView};
use isoslice_layer::walls::Interlock;
use isoslice_path::travel::{Ground, Move, connect};
use isoslice_path::z_contouring::Site;
use isoslice_planar::Solid;
use isoslice_planar::bead::Plane;

impl PartPaths<'_> {
    /// Makes the path of a layer whose `beads` are in order. `warnings` are those of
    /// its order. `from` is where the layer below ends, if it prints anything.
    pub(super) fn path(
        &self,
        mut filled: Filled,
        beads: Vec<Ended>,
        warnings: Vec<String>,
        from: Option<DVec2>,
    ) -> Result<(Passed, Counted), SliceError> {
        let view = filled.view();
        let span = filled.layer.span;
        let beads = if self.plans.interlocked {
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
        drop(view);
        let all = beads.iter().map(|ended| &ended.bead);
        let counted = Counted::new(&mut filled, all, warnings);
        let path = self.timings.time(Stage::Travel, || {
            let (_, border) = self.plans.walls.depths(span.height());
            let ground = Ground {
                view: &filled.view(),
                sparse: &filled.sparse,
                border,
            };
            let (offset, plan) = (self.offset, &self.plans.travel);
            let mut path = connect(beads, ground, from, offset, plan);
            // If the head's place is unknown, the way may lead over anything.
            if from.is_none()
                && span.index > 0
                && let Some(Move::Travel(travel)) = path.moves.first_mut()
            {
                travel.retract = true;
                travel.hop = true;
            }
            path
        });
        let below = self.stands_on(&filled).cloned();
        let passed = Passed {
            path,
            below: below.filter(|_| self.plans.by_reach),
            held: filled.held,
            outline: filled.layer.outline,
        };
        Ok((passed, counted))
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
                    risen: None,
                });
                let here = LayerFace {
                    span: top.span,
                    risen: None,
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
        if view.here.span.index <= self.plans.raft.layers {
            view.below = vec![view.here];
        }
        let site = Site {
            view: &view,
            under_support: under_support.map(Solid::grid),
        };
        Ok(z_contouring.apply(beads, site)?)
    }
}
