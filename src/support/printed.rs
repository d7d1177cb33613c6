//! What of a layer is wide enough for a line.
//!
//! In: a layer's outline. Out: its islands that are printed, and where they are
//! thick. A part that begins in a point begins where a line fits into it, and
//! a spike that is too thin for a line holds nothing.

use crate::plane::Area;
use crate::plane::clip::{crop, intersection};
use crate::plane::offset::offset;
use crate::settings::Settings;
use crate::units::{Mm, Mm2};

/// Tolerance of the offsets, mm.
const TOLERANCE: Mm = 0.002;
/// Thick places are so much wider than the places of lines' middles, by half
/// the thinnest line: corners of 90 degrees stay.
const CORNER: f64 = 1.5;

/// What is printed of a layer.
#[derive(Clone, Debug, Default)]
pub(super) struct Printed {
    /// Its islands that have room for a line.
    pub area: Area,
    /// Where the middle of the thinnest line may be.
    pub core: Area,
}

impl Printed {
    /// Half the width of the thinnest line.
    pub(super) fn half(settings: &Settings) -> Mm {
        0.5 * settings.thinnest_line()
    }

    /// What is printed of an outline, and its islands that are not.
    pub(super) fn new(outline: &Area, settings: &Settings) -> (Printed, Area) {
        let core = offset(outline, -Self::half(settings), TOLERANCE);
        let small: Mm2 = (4.0 * settings.outer_wall_width()).powi(2);
        let islands = outline.islands().into_iter();
        let (printed, not): (Vec<Area>, Vec<Area>) =
            islands.partition(|island| {
                let has = || crop(&core.rings, island.bounds());
                island.content() > small
                    || !intersection(island, &has()).is_empty()
            });
        let [area, not] = [printed, not].map(|islands| Area {
            rings: islands.into_iter().flat_map(|i| i.rings).collect(),
        });
        (Printed { area, core }, not)
    }

    /// What of an area is wide enough for a line, by the core around it.
    pub(super) fn thick(core: &Area, area: &Area, settings: &Settings) -> Area {
        let wide = CORNER * Self::half(settings);
        intersection(area, &offset(core, wide, TOLERANCE))
    }
}
