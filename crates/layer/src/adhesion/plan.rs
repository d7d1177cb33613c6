//! What the loops around a part follow from.

use glam::DVec2;
use isoslice_base::units::{Degrees, Mm};
use isoslice_planar::Rect;
use isoslice_planar::bead::spacing;
use isoslice_settings::layers::LayerSpan;
use isoslice_settings::{BrimPlace, DraftShield, Settings};

/// The loops around a part.
#[derive(Clone, Copy, Debug)]
pub struct AdhesionPlan {
    /// The skirt.
    pub skirt: SkirtPlan,
    /// What is printed instead of the skirt if a draft shield is asked for.
    pub shield: ShieldPlan,
    /// The brim.
    pub brim: BrimPlan,
    /// What all of them stay on.
    pub bed: BedPlan,
}

impl AdhesionPlan {
    /// The loops that settings ask for.
    pub fn of(settings: &Settings) -> AdhesionPlan {
        AdhesionPlan {
            skirt: SkirtPlan::of(settings),
            shield: ShieldPlan {
                height: settings.draft_shield.height(),
                skirt: SkirtPlan {
                    loops: 1,
                    distance: settings.shield_distance(),
                    ..SkirtPlan::of(settings)
                },
            },
            brim: BrimPlan::of(settings),
            bed: BedPlan::of(settings),
        }
    }
}

/// A skirt or a draft shield.
#[derive(Clone, Copy, Debug)]
pub struct SkirtPlan {
    /// Number of loops.
    pub loops: u32,
    /// Number of layers, from the bed, that have the loops.
    pub layers: usize,
    /// Gap between the brim, or the part, and the innermost loop, mm.
    pub distance: Mm,
    /// How far the brim reaches beyond the part, mm.
    pub brim: Mm,
    /// Line width, mm.
    pub width: Mm,
    /// Distance between the centre lines of loops, mm.
    pub step: Mm,
}

impl SkirtPlan {
    /// The skirt that settings ask for.
    pub fn of(settings: &Settings) -> SkirtPlan {
        let width = settings.outer_wall_width();
        SkirtPlan {
            loops: settings.skirt.loops,
            layers: settings.skirt.layers as usize,
            distance: settings.skirt_distance(),
            brim: BrimPlan::of(settings).reach,
            width,
            step: spacing(width, width, settings.thickest_layer()),
        }
    }
}

/// How much higher than the shield a layer may reach, mm: rounding.
const ROUNDED: Mm = 1e-6;

/// A draft shield.
#[derive(Clone, Copy, Debug)]
pub struct ShieldPlan {
    /// Height up to which layers have the shield, mm.
    height: Mm,
    /// The loop, whose number of layers follows from the height.
    skirt: SkirtPlan,
}

impl ShieldPlan {
    /// The shield of a part with these layers.
    pub fn among(&self, spans: &[LayerSpan]) -> SkirtPlan {
        let has_shield = |span: &LayerSpan| span.top <= self.height + ROUNDED;
        SkirtPlan {
            layers: spans.partition_point(has_shield),
            ..self.skirt
        }
    }
}

/// A brim.
#[derive(Clone, Copy, Debug)]
pub struct BrimPlan {
    /// Where it is.
    pub place: BrimPlace,
    /// Width of the strip that its loops fill, or radius of ears, mm.
    pub strip: Mm,
    /// Gap between the part and the innermost loop, mm.
    pub gap: Mm,
    /// Corners sharper than this have ears.
    pub ear_angle: Degrees,
    /// Line width, mm.
    pub width: Mm,
    /// How far it reaches beyond the outside of a part, mm.
    pub reach: Mm,
}

impl BrimPlan {
    /// The brim that settings ask for.
    pub fn of(settings: &Settings) -> BrimPlan {
        let brim = &settings.brim;
        let plan = BrimPlan {
            place: brim.place,
            strip: brim.width,
            gap: brim.gap,
            ear_angle: brim.ear_angle,
            width: settings.outer_wall_width(),
            reach: 0.0,
        };
        let reach = match brim.place {
            BrimPlace::Outer | BrimPlace::Both => {
                let depths = plan.depths(settings.first_layer_height());
                depths.last().map_or(0.0, |d| d + 0.5 * plan.width)
            }
            BrimPlace::Ears => brim.width,
            BrimPlace::None | BrimPlace::Inner => 0.0,
        };
        BrimPlan { reach, ..plan }
    }

    /// Distances of the brim's loops from the outline, mm, the nearest first, in
    /// a layer of a height.
    pub(super) fn depths(&self, height: Mm) -> Vec<Mm> {
        let step = spacing(self.width, self.width, height);
        let loops = (self.strip / step).round().max(1.0) as u32;
        let nearest = self.gap + 0.5 * self.width;
        (0..loops).map(|i| nearest + step * f64::from(i)).collect()
    }
}

/// The bed that loops have to stay on.
#[derive(Clone, Copy, Debug)]
pub struct BedPlan {
    /// The bed.
    pub bed: Rect,
    /// True if the skirt is a draft shield.
    pub shield: bool,
}

impl BedPlan {
    /// The bed of these settings.
    pub fn of(settings: &Settings) -> BedPlan {
        let printer = &settings.printer;
        let size = DVec2::new(printer.bed_x, printer.bed_y);
        BedPlan {
            bed: Rect::new(DVec2::ZERO, size),
            shield: settings.draft_shield != DraftShield::Off,
        }
    }
}
