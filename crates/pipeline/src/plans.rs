//! What the stages of a part do, resolved once from the part's settings.

use crate::report::Used;
use isoslice_base::units::{Degrees, Mm, Percent};
use isoslice_held::overhangs::OverhangPlan;
use isoslice_held::support::SupportPlan;
use isoslice_layer::adhesion::AdhesionPlan;
use isoslice_layer::exposure::ExposurePlan;
use isoslice_layer::infill::InfillPlan;
use isoslice_layer::outline::OutlinePlan;
use isoslice_layer::resolution::Resolution;
use isoslice_layer::seam::EndingPlan;
use isoslice_layer::skin::SkinPlan;
use isoslice_layer::walls::WallPlan;
use isoslice_path::order::OrderPlan;
use isoslice_path::pace::PacePlan;
use isoslice_path::spiral::SpiralPlan;
use isoslice_path::travel::TravelPlan;
use isoslice_path::z_contouring::ZContouringPlan;
use isoslice_planar::bead::spacing;
use isoslice_settings::{
    FuzzySkin, InfillPattern, InterfacePattern, LineDensity, SeamRule,
    Settings, Varying, WallOffset,
};

/// The plans of a part.
pub(super) struct Plans {
    pub resolution: Resolution,
    pub outline: OutlinePlan,
    pub walls: WallPlan,
    pub exposure: ExposurePlan,
    pub skin: SkinPlan,
    pub infill: InfillPlan,
    pub adhesion: AdhesionPlan,
    pub overhangs: OverhangPlan,
    pub support: SupportPlan,
    pub ending: EndingPlan,
    pub spiral: SpiralPlan,
    pub order: OrderPlan,
    pub z_contouring: ZContouringPlan,
    pub travel: TravelPlan,
    pub pace: PacePlan,
    pub raft: RaftPlan,
    pub support_fill: SupportFillPlan,
    /// Where loops begin.
    pub seam: Varying<SeamRule>,
    /// The texture of outer walls.
    pub fuzzy: FuzzySkin,
    /// How far outlines grow, mm.
    pub growth: Varying<Mm>,
    /// Distance of the samples of the field, mm.
    pub sample_spacing: Mm,
    /// Greatest error of outlines, mm.
    pub accuracy: Mm,
    /// Which fields the walls are offsets of.
    pub wall_fields: WallFieldPlan,
    /// True if the part is printed as a vase.
    pub vase: bool,
    /// True if every other inner wall lies half a layer lower.
    pub interlocked: bool,
    /// True if walls depend on how far they reach beyond the layer below.
    pub by_reach: bool,
    /// True if beads follow the surface above them.
    pub contours_z: bool,
    /// True if the tops of supports follow the undersides above them.
    pub supports_follow: bool,
    /// Greatest number of layers of internal bridges one above the other; none
    /// if there are no internal bridges.
    pub internal_bridges: Option<usize>,
    /// Diameter of the nozzle's flat end, mm.
    pub nozzle_flat: Mm,
    /// What a report tells of the settings.
    pub used: Used,
}

impl Plans {
    /// The plans of a part with these settings.
    pub(super) fn of(settings: &Settings) -> Plans {
        Plans {
            resolution: Resolution::of(settings),
            outline: OutlinePlan::of(settings),
            walls: WallPlan::of(settings),
            exposure: ExposurePlan::of(settings),
            skin: SkinPlan::of(settings),
            infill: InfillPlan::of(settings),
            adhesion: AdhesionPlan::of(settings),
            overhangs: OverhangPlan::of(settings),
            support: SupportPlan::of(settings),
            ending: EndingPlan::of(settings),
            spiral: SpiralPlan::of(settings),
            order: OrderPlan::of(settings),
            z_contouring: ZContouringPlan::of(settings),
            travel: TravelPlan::of(settings),
            pace: PacePlan::of(settings),
            raft: RaftPlan::of(settings),
            support_fill: SupportFillPlan::of(settings),
            seam: settings.seam.clone(),
            fuzzy: settings.fuzzy.clone(),
            growth: settings.xy_compensation.clone(),
            sample_spacing: settings.lattice_spacing(),
            accuracy: settings.accuracy,
            wall_fields: match settings.wall_offset {
                WallOffset::Distance => WallFieldPlan::None,
                WallOffset::Field if settings.is_uniform() => {
                    WallFieldPlan::Alike(settings.layer_height())
                }
                WallOffset::Field => WallFieldPlan::ByHeight,
            },
            vase: settings.is_vase(),
            interlocked: settings.interlocks(),
            by_reach: settings.by_reach(),
            contours_z: !settings.contour_z.is(0.0),
            supports_follow: settings.supports_follow(),
            internal_bridges: settings.bridges_infill().then(|| {
                settings.internal_bridges.number().unwrap_or(2) as usize
            }),
            nozzle_flat: settings.nozzle_flat(),
            used: used(settings),
        }
    }
}

/// Which offsets of the expression the walls follow.
#[derive(Clone, Copy, Debug)]
pub(super) enum WallFieldPlan {
    /// Walls follow the outline.
    None,
    /// Walls follow offsets for layers of this height, mm.
    Alike(Mm),
    /// Walls follow offsets for each layer's own height.
    ByHeight,
}

/// What lies between the bed and the part.
#[derive(Clone, Copy, Debug)]
pub(super) struct RaftPlan {
    /// Number of layers.
    pub layers: usize,
    /// Height of the part's lowest point above the bed, mm.
    pub height: Mm,
    /// Height of the air between the raft and the part, mm; 0 without a raft.
    pub gap: Mm,
    /// How far the raft reaches beyond the part, mm.
    pub expansion: Mm,
    /// Width of the lines of its first layer and of those above, mm.
    pub widths: [Mm; 2],
}

impl RaftPlan {
    fn of(settings: &Settings) -> RaftPlan {
        let layers = settings.raft_layers();
        RaftPlan {
            layers,
            height: settings.raft_height(),
            gap: match layers {
                0 => 0.0,
                _ => settings.raft_gap(),
            },
            expansion: settings.raft.expansion,
            widths: [settings.raft_line_width(), settings.infill_width()],
        }
    }
}

/// How supports are filled.
#[derive(Clone, Copy, Debug)]
pub(super) struct SupportFillPlan {
    /// Share of the body that is printed.
    pub density: Percent,
    /// How dense the layers below the part are.
    pub interface_density: LineDensity,
    /// How the lines of the layers below the part run.
    pub interface_pattern: InfillPattern,
    /// Direction of the lines of the layers below the part; none for the infill's.
    pub interface_angle: Option<Degrees>,
    /// Distance of lines that lie side by side, mm.
    pub side_by_side: Mm,
    /// Greatest height of a bead, as a share of its width.
    pub flattest: f64,
    /// Height of the part's first layer without a raft, mm.
    pub first_layer: Mm,
    /// Diameter of the nozzle's hole, mm.
    pub nozzle: Mm,
}

impl SupportFillPlan {
    fn of(settings: &Settings) -> SupportFillPlan {
        let support = &settings.support;
        let width = settings.infill_width();
        SupportFillPlan {
            density: support.density,
            interface_density: support.interface_density,
            interface_pattern: match support.interface_pattern {
                InterfacePattern::Concentric => InfillPattern::Concentric,
                _ => InfillPattern::Rectilinear,
            },
            interface_angle: match support.interface_pattern {
                InterfacePattern::Towards(angle) => Some(angle),
                _ => None,
            },
            side_by_side: spacing(width, width, settings.layer_height()),
            flattest: Settings::FLAT,
            first_layer: settings.first_layer_height(),
            nozzle: settings.printer.nozzle_diameter,
        }
    }
}

/// What a report tells of the settings.
fn used(settings: &Settings) -> Used {
    Used {
        layer_height: settings.layer_height(),
        first_layer_height: settings.bed_layer_height(),
        accuracy: settings.accuracy,
        sample_spacing: settings.lattice_spacing(),
        walls: settings.walls,
        wall_offset: settings.wall_offset.name(),
        outer_wall_width: settings.outer_wall_width(),
        inner_wall_width: settings.inner_wall_width(),
        thin_min: settings.thin_min,
        thin_max: settings.thin_max,
    }
}
