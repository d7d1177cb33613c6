//! What is printed of a layer's outline.
//!
//! In: a layer's outline. Out: the islands of it that are printed, and where
//! they are thick. A part that begins in a point is printed from where a bead
//! fits into it, and a spike that is too thin for a line holds nothing.

use crate::region::neighbour::Neighbour;
use crate::region::{WallPlan, prints};
use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::clip::intersection;
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Ring};
use isoslice_settings::Settings;
use std::cell::LazyCell;

/// Tolerance of the offsets, mm.
const TOLERANCE: Mm = 0.002;
/// Thick places are the core, grown by so many halves of the thinnest line.
/// Corners of 90 degrees stay.
const CORNER: f64 = 1.5;
/// A small island is printed for sure if its thickness, four times its area over
/// its perimeter, is so many times the thinnest line. The thickness of a disc is
/// its diameter, that of a narrow strip twice its width.
const SURE: f64 = 2.4;
/// Size of the ring that stands for the middle of an island, as a share of the
/// island's size.
const MIDDLE: f64 = 0.05;

/// What is printed of a layer.
#[derive(Clone, Debug, Default)]
pub(super) struct Printed {
    /// The islands that have room for a line.
    pub area: Area,
    /// Where the middle of the thinnest line may be. Islands that are printed
    /// although they are thinner have a small ring in their middle.
    pub core: Area,
}

impl Printed {
    /// Half the width of the thinnest line.
    pub(super) fn half(settings: &Settings) -> Mm {
        0.5 * settings.thinnest_line()
    }

    /// The islands of a layer's outline that are printed, and those that are
    /// not.
    pub(super) fn new(
        outline: &Area,
        height: Mm,
        settings: &Settings,
    ) -> (Printed, Area) {
        let mut core = offset(outline, -Self::half(settings), TOLERANCE);
        let small: Mm2 = (4.0 * settings.outer_wall_width()).powi(2);
        let (mut area, mut not) = (Vec::new(), Vec::new());
        // The middles join the core after the loop: no island may count the
        // middle of another one as its own core.
        let mut middles = Vec::new();
        let cores = LazyCell::new(|| Neighbour::new(&core));
        for island in outline.islands() {
            if island.content() > small {
                area.extend(island.rings);
                continue;
            }
            let has = cores.within(island.bounds());
            let fits = !intersection(&island, &has).is_empty();
            let thickness = 4.0 * island.content() / island.perimeter();
            let sure = fits && thickness > SURE * settings.thinnest_line();
            if !sure && !prints(&island, height, &WallPlan::of(settings)) {
                not.extend(island.rings);
                continue;
            }
            if !fits {
                middles.extend(middle(&island));
            }
            area.extend(island.rings);
        }
        drop(cores);
        core.rings.extend(middles);
        let area = Area { rings: area };
        (Printed { area, core }, Area { rings: not })
    }

    /// The part of an area that is wide enough for a line, told by the core of
    /// the layer around it.
    pub(super) fn thick(core: &Area, area: &Area, settings: &Settings) -> Area {
        let wide = CORNER * Self::half(settings);
        intersection(area, &offset(core, wide, TOLERANCE))
    }
}

/// A small ring that stands for the middle of a small island.
fn middle(island: &Area) -> Option<Ring> {
    let ring = island.rings.first()?;
    let mean = ring.iter().sum::<DVec2>() / ring.len().max(1) as f64;
    // The mean of a crescent's points lies outside the crescent.
    let at = if island.contains(mean) {
        mean
    } else {
        *ring.first()?
    };
    Some(ring.iter().map(|p| at.lerp(*p, MIDDLE)).collect())
}
