//! The supports of a part, layer by layer.

use super::plans::{Plans, RaftPlan, SupportFillPlan};
use super::posts::Posts;
use glam::{DVec2, DVec3};
use isoslice_base::units::{Mm, Mm2, Percent};
use isoslice_held::support::{Plan, Slice, SupportPlan};
use isoslice_layer::infill::{self, Infill, InfillError, InfillPlan};
use isoslice_layer::walls::WallPlan;
use isoslice_model::expressions::Surroundings;
use isoslice_planar::bead::{Bead, Role};
use isoslice_planar::clip::union;
use isoslice_planar::{Area, Solid};
use isoslice_settings::Infill::Pattern;
use isoslice_settings::LineDensity;
use isoslice_settings::layers::LayerSpan;

/// A gap beside supports that is wider than this, mm, may be why something has
/// none.
const WIDE: Mm = 1.0;

/// Area from which on something that hangs without a support is reported, mm².
const UNHELD: Mm2 = 1.0;

/// The top of a layer's supports.
pub(super) struct Top {
    /// From where to where the supports reach.
    pub span: LayerSpan,
    /// Heights and area of the supports that lie on them, if there are any and
    /// these supports follow the underside above.
    pub above: Option<(LayerSpan, Solid<'static>)>,
}

/// The supports of a part.
pub(super) struct Supported<'a> {
    plan: Plan,
    asked: SupportPlan,
    fill: SupportFillPlan,
    raft: RaftPlan,
    body: SupportFill<'a>,
    interface: SupportFill<'a>,
}

impl<'a> Supported<'a> {
    /// The supports of a plan, filled as settings ask.
    pub(super) fn new(
        plan: Plan,
        fills: &Fills<'_, 'a>,
    ) -> Result<Supported<'a>, InfillError> {
        let Plans {
            support_fill: fill,
            raft,
            support: asked,
            ..
        } = fills.plans;
        let width = asked.width;
        let density = match fill.interface_density {
            LineDensity::Spacing(apart) => {
                (100.0 * fill.side_by_side / apart).clamp(1.0, 100.0)
            }
            LineDensity::Share(share) => share,
        };
        let body = fills.lines(width, fill.density);
        let interface = InfillPlan {
            pattern: Pattern(fill.interface_pattern),
            angle: fill.interface_angle.unwrap_or(body.angle),
            ..fills.lines(width, density)
        };
        Ok(Supported {
            plan,
            asked: asked.clone(),
            fill: *fill,
            raft: *raft,
            body: fills.fill(body, Role::Support)?,
            interface: fills.fill(interface, Role::SupportInterface)?,
        })
    }

    /// What the user should know of the plan. `offset` leads from the model's
    /// coordinates to the bed's.
    pub(super) fn warnings(&self, offset: DVec2) -> Vec<String> {
        let place = |worst: DVec3| {
            let at = worst + offset.extend(self.raft.height);
            format!(
                "x = {:.1}, y = {:.1}, z = {:.1} on the bed",
                at.x, at.y, at.z
            )
        };
        let mut all = Vec::new();
        let Plan {
            unheld,
            unmet,
            enclosed,
            idle,
            forbidden,
            ..
        } = self.plan;
        if unheld.area > UNHELD {
            all.push(format!(
                "{:.1} mm² that need supports get none, the largest of it at \
                 {}: {}",
                unheld.area,
                place(unheld.worst),
                self.why(unheld.worst.z),
            ));
        }
        if unmet.area > UNHELD {
            all.push(format!(
                "{:.1} mm² for which support.where asks for supports get none, \
                 the largest of it at {}: either no support reaches it from \
                 below, or the face is so steep that support.xy_gap leaves no \
                 room beside it",
                unmet.area,
                place(unmet.worst),
            ));
        }
        if enclosed.volume > 0.0 {
            all.push(format!(
                "supports of {:.1} mm³ stand in closed cavities of the part, \
                 where nobody can take them out, the largest of them at {}: \
                 give the cavity a hole that they fit through, turn the part, \
                 or leave them out by support.where",
                enclosed.volume,
                place(enclosed.worst),
            ));
        }
        if forbidden {
            all.push(
                "support.where is negative under every face that needs a \
                 support, so none is printed: let it be 0 where the angle is \
                 to decide; x and y count from the model's origin, z is the \
                 height above the bed, d is next to 0 at an underside"
                    .to_owned(),
            );
        }
        if idle {
            all.push(
                "support.where has no effect: it is neither positive nor \
                 negative on any underside of the part; x and y count from \
                 the model's origin, z is the height above the bed"
                    .to_owned(),
            );
        }
        let (air, nozzle) = (self.asked.gap_top, self.fill.nozzle);
        if air > nozzle && unheld.area <= UNHELD {
            all.push(format!(
                "support.z_gap = {air} mm is more than the nozzle's diameter of \
                 {nozzle} mm: what is above supports sags that far before it \
                 lies on them; about the height of a layer is usual"
            ));
        }
        let beside = self.fill.side_by_side;
        if let LineDensity::Spacing(apart) = self.fill.interface_density
            && self.asked.interface_layers > 0
            && apart < beside
        {
            all.push(format!(
                "support.interface_density = \"{apart} mm\" is less than the \
                 {beside:.3} mm that lines of infill_width = {:.3} mm need, so \
                 these lie side by side; raise it, or lower infill_width",
                self.asked.width,
            ));
        }
        all
    }

    /// Why a face at this height above the supports' bed gets no support, and
    /// what to do.
    fn why(&self, height: Mm) -> String {
        let SupportPlan {
            gap_top,
            xy_gap,
            on_part,
            ..
        } = &self.asked;
        if height < gap_top + self.fill.first_layer {
            return format!(
                "support.z_gap = {gap_top} mm leaves no room for one below it; \
                 lower that"
            );
        }
        let next = if *xy_gap > WIDE {
            "lower support.xy_gap, which keeps supports that far from the part"
        } else if *on_part {
            "turn the part, open what is around it, or lower support.xy_gap"
        } else {
            "supports = auto may stand on the part"
        };
        format!("no support reaches it from below; {next}")
    }

    /// The sparse and the dense area in a layer, if there is one.
    pub(super) fn slice(&self, layer: usize) -> Option<&Slice> {
        self.plan.slice(layer.checked_sub(self.raft.layers)?)
    }

    /// Where a layer has supports.
    pub(super) fn area(&self, layer: usize) -> Option<Area> {
        self.slice(layer).map(Slice::area)
    }

    /// The area of the supports that hold a layer. Their tops are a gap below
    /// it.
    pub(super) fn under(&self, layer: usize) -> Option<Area> {
        let layer = layer.checked_sub(self.raft.layers)?;
        self.plan.under(layer)
    }

    /// What in the first layer holds the part without a gap.
    pub(super) fn pads(&self) -> &Area {
        self.plan.pads()
    }

    /// Where supports stand on a layer: their bottoms are a gap above.
    pub(super) fn on_top(&self, span: &LayerSpan) -> Option<Area> {
        let layer = span.index.checked_sub(self.raft.layers)?;
        let heights = &self.plan.heights;
        let above = (layer + 1..heights.spans().len())
            .map(|j| (j, heights.stands_on(j)))
            .take_while(|(_, on)| on.is_none_or(|on| on <= layer));
        let standing = above.filter(|(_, on)| *on == Some(layer));
        let slices = standing.filter_map(|(j, _)| self.plan.slice(j));
        slices.map(Slice::area).reduce(|a, b| union(&a, &b))
    }

    /// From where to where the supports of a layer reach, if it can have some.
    fn span(&self, span: &LayerSpan) -> Option<LayerSpan> {
        let layer = span.index.checked_sub(self.raft.layers)?;
        let heights = &self.plan.heights;
        let own = heights.span(layer)?;
        Some(if own == heights.spans()[layer] {
            *span
        } else {
            LayerSpan {
                index: span.index,
                bottom: own.bottom + self.raft.height,
                top: own.top + self.raft.height,
            }
        })
    }

    /// What all supports fill: from where to where above the bed, or above the
    /// air over a raft, and the area.
    pub(super) fn slabs(&self) -> impl Iterator<Item = (LayerSpan, Area)> + '_ {
        let heights = &self.plan.heights;
        (0..heights.spans().len()).filter_map(|layer| {
            Some((heights.span(layer)?, self.plan.slice(layer)?.area()))
        })
    }

    /// The top of a layer's supports, if the layer can have some. `follows` is
    /// true if it follows the underside above.
    pub(super) fn top(&self, span: &LayerSpan, follows: bool) -> Option<Top> {
        let own = self.span(span)?;
        let above = || {
            let heights = &self.plan.heights;
            let layer = span.index - self.raft.layers;
            let mut higher = layer + 1..heights.spans().len();
            let (j, next) = higher.find_map(|j| Some((j, heights.span(j)?)))?;
            let area = self.plan.slice(j)?.area();
            Some((next, Solid::new(area)))
        };
        Some(Top {
            span: own,
            above: follows.then(above).flatten(),
        })
    }

    /// The beads of a layer's supports.
    pub(super) fn beads(
        &self,
        span: &LayerSpan,
    ) -> Result<Vec<Bead>, InfillError> {
        let Some(slice) = self.slice(span.index) else {
            return Ok(Vec::new());
        };
        let Some(own) = self.span(span) else {
            return Ok(Vec::new());
        };
        let mut beads = self.interface.beads(&slice.interface, &own)?;
        beads.extend(self.body.beads(&slice.body, &own)?);
        for bead in &mut beads {
            let standing = || {
                let from = bead.stroke.points.first();
                from.is_some_and(|p| slice.standing.contains(*p))
            };
            let deeper = match span.index == self.raft.layers {
                // Supports stand on the raft, so they reach down to it.
                true => self.raft.gap,
                false if slice.deeper != 0.0 && standing() => slice.deeper,
                false => 0.0,
            };
            if deeper != 0.0 {
                // Lines of the usual width are wide enough for that height.
                // Lines that fit into a thin place may not be.
                let most = self.fill.flattest * bead.stroke.width;
                bead.height = (bead.height + deeper).min(most);
            }
        }
        Ok(beads)
    }
}

/// What fills of supports and of a raft have in common.
pub(super) struct Fills<'p, 'a> {
    pub plans: &'p Plans,
    pub around: &'a Surroundings<'a>,
    pub site: infill::Site,
}

impl<'a> Fills<'_, 'a> {
    /// Parallel lines of a width and a density.
    pub(super) fn lines(&self, width: Mm, density: Percent) -> InfillPlan {
        self.plans.infill.lines(width, density)
    }

    /// A fill in one wall of lines as wide, for beads of a role.
    pub(super) fn fill(
        &self,
        plan: InfillPlan,
        role: Role,
    ) -> Result<SupportFill<'a>, InfillError> {
        let walls = WallPlan {
            count: 1,
            around_tops: 1,
            outer: plan.width,
            ..self.plans.walls
        };
        Ok(SupportFill {
            infill: Infill::new(plan, self.around, self.site)?,
            posts: Posts::new(walls, self.plans.resolution),
            role,
        })
    }
}

/// How an area of support is filled.
pub(super) struct SupportFill<'a> {
    infill: Infill<'a>,
    posts: Posts,
    role: Role,
}

impl SupportFill<'_> {
    /// A wall around the area, and lines inside it.
    pub(super) fn beads(
        &self,
        area: &Area,
        span: &LayerSpan,
    ) -> Result<Vec<Bead>, InfillError> {
        if area.is_empty() {
            return Ok(Vec::new());
        }
        let walled = self.posts.walled(area, span.height());
        let lines = self.infill.beads(&walled.fill, span, None)?;
        let all = walled.beads.into_iter().chain(lines);
        // They are no walls, however they were laid.
        let own = |bead: Bead| Bead::new(self.role, bead.stroke, bead.height);
        Ok(all.map(own).collect())
    }
}
