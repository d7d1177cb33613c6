//! What the loops around a part follow from.

use glam::DVec2;
use isoslice_base::units::{Degrees, Mm};
use isoslice_planar::Rect;
use isoslice_planar::bead::spacing;
use isoslice_settings::{BrimPlace, DraftShield, Settings};

/// The loops around a part.
#[derive(Clone, Copy, Debug)]
pub struct AdhesionPlan {
    /// The skirt.
    pub skirt: SkirtPlan,
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

    /// The draft shield that settings ask for, in so many layers.
    pub fn of_shield(settings: &Settings, layers: usize) -> SkirtPlan {
        SkirtPlan {
            loops: 1,
            layers,
            distance: settings.shield_distance(),
            ..SkirtPlan::of(settings)
        }
    }

    #[cfg(test)]
    pub(crate) fn with(change: impl FnOnce(&mut Settings)) -> SkirtPlan {
        let mut settings = Settings::default();
        change(&mut settings);
        SkirtPlan::of(&settings)
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

    #[cfg(test)]
    pub(crate) fn with(change: impl FnOnce(&mut Settings)) -> BrimPlan {
        let mut settings = Settings::default();
        change(&mut settings);
        BrimPlan::of(&settings)
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
