//! What is printed of a layer's outline.
//!
//! In: a layer's outline. Out: the islands of it that are printed, and where
//! they are thick. A part that begins in a point is printed from where a bead
//! fits into it, and a spike that is too thin for a line holds nothing.

use super::plan::OverhangPlan;
use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_layer::cover::neighbour::Neighbour;
use isoslice_layer::walls::prints;
use isoslice_planar::clip::intersection;
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Ring, Solid, signed_area};
use std::borrow::Cow;
use std::cell::LazyCell;

/// Tolerance of the offsets, mm.
const TOLERANCE: Mm = 0.002;
/// Thick places are the core, grown by so many halves of the thinnest place.
/// Corners of 90 degrees stay.
const CORNER: f64 = 1.5;
/// A small island is printed for sure if its thickness, four times its area over
/// its perimeter, is so many times the thinnest place's. The thickness of a disc is
/// its diameter, that of a narrow strip twice its width.
const SURE: f64 = 2.4;
/// Size of the ring that stands for the middle of an island, as a share of the
/// island's size.
const MIDDLE: f64 = 0.05;

/// What is printed of a layer.
#[derive(Clone, Debug, Default)]
pub(crate) struct Printed {
    /// The islands that have room for a line.
    pub area: Area,
    /// Where the middle of the thinnest place may be. Islands that are printed
    /// although they are thinner have a small ring in their middle.
    pub core: Area,
}

impl Printed {
    /// Half the thickness of the thinnest place that gets a line.
    pub(crate) fn half(plan: &OverhangPlan) -> Mm {
        0.5 * plan.thinnest
    }

    /// The islands of a layer's outline that are printed, and those that are
    /// not.
    pub(crate) fn new(
        outline: &Area,
        height: Mm,
        plan: &OverhangPlan,
    ) -> (Printed, Area) {
        let mut core = offset(outline, -Self::half(plan), TOLERANCE);
        let cores = LazyCell::new(|| Neighbour::new(&core));
        let core_of = |island: &Area| {
            let has = cores.within(island.bounds());
            intersection(island, &has)
        };
        let islands = Islands::new(outline, core_of, height, plan);
        drop(cores);
        // The middles join the core at the end: no island may count the
        // middle of another one as its own core.
        core.rings.extend(islands.middles);
        let area = Area {
            rings: islands.printed,
        };
        let not = Area { rings: islands.not };
        (Printed { area, core }, not)
    }

    /// A part of what is printed of a layer. `around` is what of the layer is
    /// printed there and as far around as something matters.
    pub(crate) fn part(
        area: Area,
        around: &Area,
        plan: &OverhangPlan,
    ) -> Printed {
        Printed {
            area,
            core: offset(around, -Self::half(plan), TOLERANCE),
        }
    }

    /// The part of an area that is wide enough for a line, told by the core of
    /// the layer around it.
    pub(crate) fn thick(core: &Area, area: &Area, plan: &OverhangPlan) -> Area {
        let wide = CORNER * Self::half(plan);
        intersection(area, &offset(core, wide, TOLERANCE))
    }
}

/// The islands of a layer.
#[derive(Default)]
struct Islands {
    /// The rings of those that are printed.
    printed: Vec<Ring>,
    not: Vec<Ring>,
    /// The middles of those that are printed although no line fits into them.
    middles: Vec<Ring>,
}

impl Islands {
    /// Sorts the islands of a layer. `core_of` says where the middle of the thinnest
    /// line may be in an island.
    fn new(
        outline: &Area,
        core_of: impl Fn(&Area) -> Area,
        height: Mm,
        plan: &OverhangPlan,
    ) -> Islands {
        let small = small(plan);
        let mut all = Islands::default();
        for island in outline.islands() {
            if island.content() > small {
                all.printed.extend(island.rings);
                continue;
            }
            let fits = !core_of(&island).is_empty();
            let thickness = 4.0 * island.content() / island.perimeter();
            let sure = fits && thickness > SURE * plan.thinnest;
            if !sure && !prints(&island, height, &plan.walls) {
                all.not.extend(island.rings);
                continue;
            }
            if !fits {
                all.middles.extend(middle(&island));
            }
            all.printed.extend(island.rings);
        }
        all
    }
}

/// A layer without the islands that are not printed.
pub(super) fn kept<'a>(
    outline: &'a Solid<'a>,
    height: Mm,
    plan: &OverhangPlan,
) -> Cow<'a, Solid<'a>> {
    let core_of =
        |island: &Area| offset(island, -Printed::half(plan), TOLERANCE);
    if has_no_small_islands(outline.area(), plan) {
        return Cow::Borrowed(outline);
    }
    let islands = Islands::new(outline.area(), core_of, height, plan);
    if islands.not.is_empty() {
        return Cow::Borrowed(outline);
    }
    Cow::Owned(Solid::new(Area {
        rings: islands.printed,
    }))
}

/// Content of an island that may be too small to be printed.
fn small(plan: &OverhangPlan) -> Mm2 {
    (4.0 * plan.walls.outer).powi(2)
}

/// True if the rings of a layer tell at once that all of its islands are printed.
fn has_no_small_islands(outline: &Area, plan: &OverhangPlan) -> bool {
    let content = outline.rings.iter().map(|ring| signed_area(ring));
    let (outer, holes): (Vec<Mm2>, Vec<Mm2>) =
        content.partition(|content| *content > 0.0);
    let holes: Mm2 = holes.iter().sum();
    outer.iter().all(|content| content + holes > small(plan))
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
