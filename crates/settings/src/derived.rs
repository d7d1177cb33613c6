//! Values that follow from several settings.

use super::by_nozzle::share_of;
use super::{
    Acceleration, ByNozzle, Infill, InfillPattern, InterfaceShape,
    LayerHeights, Settings, Supports, WallOffset, check,
};
use isoslice_base::units::{
    Celsius, Degrees, Mm, MmPerSec, MmPerSec2, PerSec, Percent, PricePerKg,
};
use std::path::Path;

/// Lengths that follow the nozzle, each with what `auto` stands for: a
/// percentage of the nozzle's diameter, another of these lengths, or the lesser
/// or the greater of both.
macro_rules! by_nozzle {
    ($($(#[doc = $doc:literal])+ $name:ident = $auto:tt;)+) => {
        impl Settings {
            $(
                $(#[doc = $doc])+
                pub fn $name(&self) -> Mm {
                    let usual = by_nozzle!(@auto self $auto);
                    self.$name.with(self.printer.nozzle_diameter, usual)
                }
            )+

            /// The lengths that follow the nozzle: each setting's name, its
            /// value, and the length with this nozzle.
            pub(super) fn by_nozzle(
                &self,
            ) -> Vec<(&'static str, ByNozzle, Mm)> {
                vec![$((stringify!($name), self.$name, self.$name())),+]
            }
        }
    };
    (@auto $settings:ident $share:literal) => {
        share_of($settings.printer.nozzle_diameter, $share)
    };
    (@auto $settings:ident $name:ident) => {
        $settings.$name()
    };
    (@auto $settings:ident ($share:literal $bound:ident $name:ident)) => {
        share_of($settings.printer.nozzle_diameter, $share)
            .$bound($settings.$name())
    };
}

by_nozzle! {
    /// Height of every layer above the first, where these are uniform.
    layer_height = 50.0;
    /// Height of the first layer.
    first_layer_height = 50.0;
    /// Height of the thinnest layers that are not uniform.
    layer_height_min = (20.0 min layer_height);
    /// Height of the thickest layers that are not uniform.
    layer_height_max = (75.0 max layer_height);
    /// Half the width of the widest slit that is closed.
    slit_closing = 5.0;
    /// Line width of the outer wall.
    outer_wall_width = 112.5;
    /// Line width of the walls behind the outer wall.
    inner_wall_width = 112.5;
    /// Line width of skin, of the rings around it and of bridges.
    skin_width = 112.5;
    /// Width of the lines of skin that faces upwards.
    top_skin_width = skin_width;
    /// How far skin reaches into the sparse infill beside it.
    skin_overlap = 150.0;
    /// Distance between the lines of ironing.
    ironing_spacing = 25.0;
    /// Line width of sparse infill.
    infill_width = 112.5;
}

impl Settings {
    /// Greatest step of adaptive layers on the surface.
    pub fn step_error(&self) -> Mm {
        let usual = self.layer_height();
        match self.layer_heights {
            LayerHeights::Adaptive(step) => {
                step.with(self.printer.nozzle_diameter, usual)
            }
            _ => usual,
        }
    }

    /// Material for ironing, as a share of what would fill the layer.
    pub fn ironing_flow(&self) -> Percent {
        self.ironing.number().unwrap_or(10.0)
    }

    /// True if skin over nothing gets lines across the gap.
    pub fn bridges(&self) -> bool {
        self.bridge_max > 0.0
    }

    /// Thickness of solid material below each upward face.
    pub fn top_thickness(&self) -> Mm {
        let nozzle = self.printer.nozzle_diameter;
        self.top_layers.thickness(nozzle, share_of(nozzle, 200.0))
    }

    /// Thickness of solid material above each downward face.
    pub fn bottom_thickness(&self) -> Mm {
        let nozzle = self.printer.nozzle_diameter;
        self.bottom_layers
            .thickness(nozzle, share_of(nozzle, 150.0))
    }

    /// True if the part is printed as a vase, in walls that climb.
    pub fn is_vase(&self) -> bool {
        self.spiral.is_on()
    }

    /// True if every other inner wall lies half a layer lower.
    pub fn interlocks(&self) -> bool {
        self.walls_interlocked
            && !self.is_vase()
            && self.contour_z.is(0.0)
            && self.highest_interlocked() <= self.printer.nozzle_diameter
    }

    /// Distance of the ends of skin's lines from the centre line of the ring
    /// around them, mm: half a nozzle for lines of the usual width, which is about half
    /// of their spacing, and more for wider lines.
    pub fn off_skin_ring(&self) -> Mm {
        /// The usual width, in nozzles.
        const USUAL: f64 = 1.125;
        0.5 * self.skin_width() / USUAL + self.skin_ring_gap
    }

    /// True if skin over sparse infill becomes internal bridges. At a border
    /// without a wall nothing would hold their ends.
    pub fn bridges_infill(&self) -> bool {
        self.internal_bridges.is_on() && self.walls > 0 && !self.is_vase()
    }

    /// Height of the highest bead where walls interlock, mm: it ends a wall that
    /// lies half a layer lower.
    pub(crate) fn highest_interlocked(&self) -> Mm {
        self.thickest_layer()
            + 0.5 * self.thickest_layer().max(self.part_first_height())
    }

    /// True if the tops of supports follow the undersides above them.
    pub fn supports_follow(&self) -> bool {
        self.support.interface_shape == InterfaceShape::Follow
            && self.supports != Supports::Off
            && !self.is_vase()
    }

    /// True if scarfs rise with their flow. They do not if beads follow the
    /// surface above them, which then decides the beads' heights.
    pub fn scarf_rises(&self) -> bool {
        /// Greatest share of the height at which a rise is worth while.
        const HIGHEST: f64 = 90.0;
        self.seam_scarf.start <= HIGHEST && self.contour_z.is(0.0)
    }

    /// True if walls depend on how far they reach beyond the layer below.
    pub fn by_reach(&self) -> bool {
        self.speed.overhang.steps().is_some()
            || self.cooling.overhang_fan_speed.steps().is_some()
    }

    /// Diameter of the nozzle's flat end: `printer.nozzle_flat` if set, else
    /// what is usual.
    pub fn nozzle_flat(&self) -> Mm {
        const USUAL: f64 = 2.5;
        let usual = USUAL * self.printer.nozzle_diameter;
        self.printer.nozzle_flat.unwrap_or(usual)
    }

    /// Steepest face that beads follow in full.
    pub fn contour_z_full_angle(&self) -> FullAngle {
        FullAngle {
            wanted: self.contour_z_angle,
            flat: self.nozzle_flat(),
        }
    }

    /// True if all layers above the first have one height.
    pub fn is_uniform(&self) -> bool {
        self.layer_heights == LayerHeights::Uniform
    }

    /// Distance of the skirt from the part: `skirt.distance` if set.
    pub fn skirt_distance(&self) -> Mm {
        self.skirt.distance.unwrap_or(6.0)
    }

    /// Distance of the draft shield from the part: `skirt.distance` if set.
    pub fn shield_distance(&self) -> Mm {
        self.skirt.distance.unwrap_or(10.0)
    }

    /// Width of the thinnest line: [`Settings::thin_min`] of the outer wall's.
    pub fn thinnest_line(&self) -> Mm {
        self.thin_min / 100.0 * self.outer_wall_width()
    }

    /// Spacing of the lattice on which outlines are looked for: the one that is
    /// set, but at most half of the outer wall's width. A coarser lattice would
    /// overlook what a line can print.
    pub fn lattice_spacing(&self) -> Mm {
        self.sample_spacing.min(0.5 * self.outer_wall_width())
    }

    /// Height of the thickest layers above the first.
    pub fn thickest_layer(&self) -> Mm {
        if self.is_uniform() {
            self.layer_height()
        } else {
            self.layer_height_max()
        }
    }

    /// Number of walls around tops: at most [`Settings::walls`], and exactly so
    /// many if walls cannot be led around tops.
    pub fn top_walls(&self) -> u32 {
        let wanted = if self.divides_walls() {
            self.top_walls
        } else {
            None
        };
        wanted.map_or(self.walls, |tops| tops.min(self.walls))
    }

    /// True if walls can be led around tops.
    pub(crate) fn divides_walls(&self) -> bool {
        !self.is_vase()
            && !self.interlocks()
            && self.wall_offset == WallOffset::Distance
    }

    /// Number of solid layers below an upward face: `top_layers` if set, else
    /// as many as `top_thickness` takes.
    pub fn top_layers(&self) -> u32 {
        self.top_layers.layers().unwrap_or_else(|| {
            layers_in(self.top_thickness(), self.layer_height())
        })
    }

    /// True if nothing is printed inside walls and skin, because infill is a
    /// pattern of density 0. The density does not matter to an expression.
    pub fn is_hollow(&self) -> bool {
        self.infill_is_pattern() && self.infill_density.is(0.0)
    }

    /// True if the inside is printed as solid as skin, because infill is a
    /// pattern of density 100.
    pub fn is_solid(&self) -> bool {
        self.infill_is_pattern() && self.infill_density.is(100.0)
    }

    /// True if infill is one of the patterns, not an expression or a script.
    pub fn infill_is_pattern(&self) -> bool {
        matches!(self.infill, Infill::Pattern(_))
    }

    /// Temperature of the nozzle on the first layer:
    /// `filament.first_layer_nozzle_temperature` if set, else a little more than
    /// above it, as the first layer has to stick to the bed.
    pub fn first_layer_nozzle_temperature(&self) -> Celsius {
        const MORE: Celsius = 5.0;
        const USUAL: Celsius = 215.0;
        let filament = &self.filament;
        let auto = || {
            let above = filament.nozzle_temperature.constant();
            // No hotter than the machine bears, unless the layers above are.
            let most = self.max_nozzle_temperature();
            above.map_or(USUAL, |above| (above + MORE).min(most.max(above)))
        };
        filament.first_layer_nozzle_temperature.unwrap_or_else(auto)
    }

    /// Temperature of the bed on the first layer:
    /// `filament.first_layer_bed_temperature` if set, else that above it.
    pub fn first_layer_bed_temperature(&self) -> Celsius {
        let filament = &self.filament;
        let first = filament.first_layer_bed_temperature;
        first.unwrap_or(filament.bed_temperature)
    }

    /// Least temperature of the nozzle at which plastic is pushed:
    /// `filament.min_nozzle_temperature` if set, otherwise the one below which
    /// Marlin (`EXTRUDE_MINTEMP`) and Klipper (`min_extrude_temp`) refuse to
    /// push filament.
    pub fn min_nozzle_temperature(&self) -> Celsius {
        const USUAL: Celsius = 170.0;
        self.filament.min_nozzle_temperature.unwrap_or(USUAL)
    }

    /// Greatest temperature that may be asked of the nozzle:
    /// `printer.max_nozzle_temperature` if set, else more than nearly all hot
    /// ends bear.
    pub fn max_nozzle_temperature(&self) -> Celsius {
        const MOST: Celsius = 450.0;
        self.printer.max_nozzle_temperature.unwrap_or(MOST)
    }

    /// Greatest temperature that may be asked of the bed:
    /// `printer.max_bed_temperature` if set, else more than nearly all beds
    /// reach.
    pub fn max_bed_temperature(&self) -> Celsius {
        const MOST: Celsius = 200.0;
        self.printer.max_bed_temperature.unwrap_or(MOST)
    }

    /// True if lines of skin that begins to turn in the first layer would run
    /// along those of the infill right below them.
    pub(crate) fn skin_follows_infill(&self) -> bool {
        // Only lines of rectilinear and of solid infill turn with the layer as
        // skin does.
        let turns = match self.infill {
            Infill::Pattern(pattern) => pattern == InfillPattern::Rectilinear,
            Infill::Expression(_) | Infill::Script(_) => {
                self.infill_mode.walls().is_some()
            }
        };
        // Infill of an even layer lies below skin of an odd one.
        let apart = self.infill_angle - (self.skin_angle - 90.0);
        let apart = (apart + 90.0).rem_euclid(180.0) - 90.0;
        turns && apart.abs() < 45.0
    }

    /// Direction of skin lines in a layer, counted from the bed. They turn from
    /// layer to layer, and run across those of infill right below them
    /// that turn as well.
    pub fn skin_direction(&self, layer: usize) -> Degrees {
        let turn = layer + usize::from(self.skin_follows_infill());
        self.skin_angle - 90.0 * (turn % 2) as f64
    }

    /// Speed of moves that do not print.
    pub fn travel_speed(&self) -> MmPerSec {
        self.speed.travel.min(self.printer.max_speed)
    }

    /// Acceleration of moves that do not print.
    pub fn travel_acceleration(&self) -> MmPerSec2 {
        self.printer.travel_acceleration
    }

    /// Moves a second that the firmware takes:
    /// `printer.max_moves_per_second` if set, else a cautious figure for its
    /// kind.
    pub fn max_moves_per_second(&self) -> PerSec {
        let usual = self.gcode.flavour.firmware().moves_per_second;
        self.printer.max_moves_per_second.unwrap_or(usual)
    }

    /// Diameter of the filament.
    pub fn filament_diameter(&self) -> Mm {
        self.filament.diameter
    }

    /// Price of a kilogram of filament, or 0 if it is not known.
    pub fn filament_cost(&self) -> PricePerKg {
        self.filament.cost
    }

    /// The printer's name, as its maker writes it; empty if it is not known.
    pub fn printer_model(&self) -> &str {
        self.printer.model.trim()
    }

    /// The script that says where infill is, if infill is a script.
    pub fn infill_script(&self) -> Option<&Path> {
        match &self.infill {
            Infill::Script(path) => Some(Path::new(path)),
            Infill::Pattern(_) | Infill::Expression(_) => None,
        }
    }

    /// True if the part gets supports where it needs them.
    pub fn has_supports(&self) -> bool {
        self.supports != Supports::Off
    }

    /// True if curved paths are written as arcs.
    pub fn arcs(&self) -> bool {
        self.gcode.arcs
    }

    /// How far outer walls, or the raft, reach beyond the part, in the plane.
    /// Fuzzy skin and compensation that are expressions are not counted.
    pub fn reach(&self) -> Mm {
        let fuzzy = self.fuzzy.thickness.constant().unwrap_or(0.0);
        let grown = self.xy_compensation.constant().unwrap_or(0.0);
        let walls = (grown + fuzzy).max(0.0);
        match self.raft.layers {
            0 => walls,
            _ => walls + self.raft.expansion,
        }
    }

    /// Number of layers between the bed and the part.
    pub fn raft_layers(&self) -> usize {
        self.raft.layers as usize
    }

    /// Height of the layer on the bed: the part's first one, or the raft's.
    pub fn bed_layer_height(&self) -> Mm {
        match self.raft.layers {
            0 => self.first_layer_height(),
            _ => share_of(self.printer.nozzle_diameter, 75.0),
        }
    }

    /// Height of the part's first layer.
    pub fn part_first_height(&self) -> Mm {
        match self.raft.layers {
            0 => self.first_layer_height(),
            _ => self.layer_height(),
        }
    }

    /// Width of the lines of a raft's first layer.
    pub fn raft_line_width(&self) -> Mm {
        share_of(self.printer.nozzle_diameter, 150.0)
    }

    /// Most that `raft.gap` can be: the part's first layer is laid at most a
    /// nozzle's diameter above the raft, and its supports reach down to the
    /// raft, with lines no higher than is usual for their width.
    pub(super) fn raft_gap_most(&self) -> Mm {
        let most = self.highest_bead(self.infill_width());
        (most - self.part_first_height()).max(0.0)
    }

    /// Greatest height of a bead, as a share of its width.
    pub const FLAT: f64 = 0.9;

    /// Greatest height of a bead of some width that fills what is below it.
    pub fn highest_bead(&self, width: Mm) -> Mm {
        self.printer.nozzle_diameter.min(Settings::FLAT * width)
    }

    /// Air between the raft and the part: `raft.gap` if set, else what is
    /// usual, or less if that does not fit.
    pub fn raft_gap(&self) -> Mm {
        const USUAL: Mm = 0.2;
        let usual = || USUAL.min(self.raft_gap_most());
        self.raft.gap.unwrap_or_else(usual)
    }

    /// Height of the part's lowest point above the bed: that of the raft and
    /// of the air above it.
    pub fn raft_height(&self) -> Mm {
        match self.raft.layers {
            0 => 0.0,
            n => {
                let solid = f64::from(n - 1) * self.layer_height();
                self.bed_layer_height() + solid + self.raft_gap()
            }
        }
    }

    /// Notes on what the settings lead to unasked: speeds that
    /// `filament.max_flow` and `printer.max_speed` do not allow, and the speeds
    /// instead.
    pub fn notes(&self) -> Vec<String> {
        let notes = [check::flow_note(self), check::speed_note(self)];
        notes.into_iter().flatten().collect()
    }

    /// Number of solid layers above a downward face: `bottom_layers` if set,
    /// else as many as `bottom_thickness` takes.
    pub fn bottom_layers(&self) -> u32 {
        self.bottom_layers.layers().unwrap_or_else(|| {
            layers_in(self.bottom_thickness(), self.layer_height())
        })
    }

    /// Number of solid layers at the bottom. The first one has a height of its
    /// own, and all others are taken to be of one height.
    pub(super) fn layers_on_bed(&self) -> u32 {
        self.bottom_layers.layers().unwrap_or_else(|| {
            let rest = self.bottom_thickness() - self.part_first_height();
            let more = if rest > THICKNESS_SLACK {
                layers_in(rest, self.layer_height())
            } else {
                0
            };
            more + u32::from(self.bottom_thickness() > 0.0)
        })
    }
}

/// Steepest face that beads follow in full.
#[derive(Clone, Copy, Debug)]
pub struct FullAngle {
    /// What was asked for.
    pub wanted: Degrees,
    /// Diameter of the nozzle's flat end.
    flat: Mm,
}

impl FullAngle {
    /// The angle in a layer of this height: what was asked for, or less if the
    /// nozzle's flat end, whose edge is r·tan of the angle deeper than a face,
    /// would cut too deep.
    pub fn at(&self, height: Mm) -> Degrees {
        /// Depth of the cut as a share of the layer's height: what is left of
        /// the lines still holds the bead.
        const GOUGE: Percent = 75.0;
        let deep = 0.01 * GOUGE * height;
        let bound = deep.atan2(0.5 * self.flat).to_degrees();
        self.wanted.min(bound)
    }
}

impl Acceleration {
    /// True if some beads have an acceleration of their own.
    pub fn by_role(&self) -> bool {
        [
            self.outer_wall,
            self.inner_wall,
            self.sparse_infill,
            self.internal_skin,
            self.top_skin,
            self.bottom_skin,
            self.bridge,
            self.overhang,
            self.first_layer,
        ]
        .iter()
        .any(|a| *a > 0.0)
    }
}

/// What a shell may lack of its thickness, mm. No layer is added for so little:
/// 0.6 mm are three layers of 0.2 mm, also where a profile says 0.602.
pub const THICKNESS_SLACK: Mm = 0.01;

/// Least number of layers that are as thick as a thickness; at least 1 for any
/// thickness above 0.
fn layers_in(thickness: Mm, layer_height: Mm) -> u32 {
    /// Share of a layer that is rounding: 0.61 - 0.01 is a little more than 0.6.
    const ROUNDING: f64 = 1e-9;
    if thickness > 0.0 {
        let layers = (thickness - THICKNESS_SLACK) / layer_height;
        ((layers - ROUNDING).ceil() as u32).max(1)
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shell;

    fn settings(height: Mm, top: Mm) -> Settings {
        Settings {
            layer_height: height.into(),
            top_layers: Shell::Thickness(top.into()),
            ..Settings::default()
        }
    }

    #[test]
    fn thickness_becomes_whole_layers() {
        assert_eq!(Settings::default().top_layers(), 4);
        assert_eq!(Settings::default().bottom_layers(), 3);
        assert_eq!(settings(0.2, 0.79).top_layers(), 4);
        assert_eq!(settings(0.2, 0.81).top_layers(), 4);
        assert_eq!(settings(0.2, 0.82).top_layers(), 5);
        assert_eq!(settings(0.3, 0.8).top_layers(), 3);
        assert_eq!(settings(0.3, 0.9).top_layers(), 3);
        assert_eq!(settings(0.2, 0.01).top_layers(), 1);
        assert_eq!(settings(0.2, 0.0).top_layers(), 0);
    }

    #[test]
    fn skin_runs_across_the_infill_right_below_it() {
        use crate::InfillMode;
        let angles = [-45.0, 0.0, 20.0, 45.0, 90.0, 135.0, 290.0];
        let kinds = [
            Infill::Pattern(InfillPattern::Rectilinear),
            Infill::Expression("x".into()),
            Infill::Script("shape.rhai".into()),
        ];
        let each = kinds.iter().flat_map(|kind| angles.map(|a| (kind, a)));
        for (kind, infill) in each {
            for skin in [-90.0, 0.0, 30.0, 45.0, 135.0] {
                let s = Settings {
                    infill: kind.clone(),
                    infill_mode: InfillMode::Solid,
                    infill_angle: infill,
                    skin_angle: skin,
                    ..Settings::default()
                };
                for layer in 0..4 {
                    let below = infill + 90.0 * (layer % 2) as f64;
                    let turn = s.skin_direction(layer + 1) - below;
                    let turn = (turn + 90.0).rem_euclid(180.0) - 90.0;
                    assert!(turn.abs() >= 45.0, "{kind:?} {infill} {skin}");
                }
            }
        }
    }

    #[test]
    fn the_lattice_is_no_coarser_than_half_a_line() {
        let spacing = |set: Mm, width: Mm| {
            let s = Settings {
                sample_spacing: set,
                outer_wall_width: ByNozzle::Length(width),
                ..Settings::default()
            };
            s.lattice_spacing()
        };
        assert_eq!(spacing(0.1, 0.4), 0.1);
        assert_eq!(spacing(2.0, 0.4), 0.2);
        assert_eq!(spacing(0.1, 0.1), 0.05);
    }

    #[test]
    fn a_count_wins_over_a_thickness() {
        let s = Settings {
            top_layers: Shell::Layers(0),
            bottom_layers: Shell::Layers(7),
            ..Settings::default()
        };
        assert_eq!((s.top_layers(), s.bottom_layers()), (0, 7));
    }
}
