//! The islands of support in each layer, and where they are dense.
//!
//! In: the area of the branches in each layer, and what they hold. Out: the
//! islands of support in each layer, each with its sparse and its dense part.

use super::heights::Heights;
use super::parts::Parts;
use super::plan::SupportPlan;
use super::room::Size;
use super::{SPECK, TOLERANCE};
use isoslice_base::parallel;
use isoslice_base::units::Mm;
use isoslice_planar::clip::{crop, difference, intersection, union, unite};
use isoslice_planar::offset::offset;
use isoslice_planar::opening::opened;
use isoslice_planar::{Area, Rect};

/// Distance of supports from those ends of the part that are too thin to be
/// printed, mm: the round ends of lines reach beyond the area of the supports.
const BESIDE: Mm = 0.12;
/// That distance for all supports in the first layer, if it has pads. A pad is
/// printed along the edge that it holds, so no line ends there. At a greater
/// distance the edge's first line would not lie on it.
const BESIDE_PAD: Mm = 0.05;

/// An island of support.
#[derive(Clone, Debug)]
pub(super) struct SupportIsland {
    /// The box around it.
    pub bounds: Rect,
    /// Where it is sparse.
    pub body: Area,
    /// Where it is dense, because something is right above.
    pub interface: Area,
    /// The whole island, unless it is only sparse or only dense. Most islands
    /// are, and all of a part's are kept for a while.
    whole: Area,
}

/// The islands of support in each layer. `areas` are what the branches and the
/// pads have, `needs` what they hold.
pub(super) fn pieces(
    parts: Parts<'_>,
    needs: &[Area],
    areas: Vec<Area>,
    pads: &Area,
    plan: &SupportPlan,
) -> Vec<Vec<SupportIsland>> {
    let roof = plan.interface_layers;
    let mut tops = tops(parts.heights, needs, areas.len(), plan);
    if let Some(lowest) = tops.first_mut()
        && !pads.is_empty()
    {
        *lowest = union(lowest, pads);
    }
    let of_layer = |j: usize, all: Area| {
        if all.is_empty()
            || parts.heights.span(j).is_none()
            || isoslice_base::limits::is_stopped()
        {
            return Vec::new();
        }
        let apart = match j {
            0 if !pads.is_empty() => BESIDE_PAD,
            _ => BESIDE,
        };
        let all = without_ends(on_bed(all, parts.bed), parts, j, apart);
        let above: Vec<&Area> = tops.iter().skip(j).take(roof).collect();
        printable(all)
            .map(|island| SupportIsland::new(island, &above, plan))
            .collect()
    };
    parallel::map_owned(areas, of_layer)
}

/// The area that each layer of supports holds right above itself.
fn tops(
    heights: &Heights,
    needs: &[Area],
    count: usize,
    plan: &SupportPlan,
) -> Vec<Area> {
    let mut tops: Vec<Area> = vec![Area::EMPTY; count];
    for (i, need) in needs.iter().enumerate() {
        if need.is_empty() {
            continue;
        }
        if let Some(j) = heights.below(i) {
            let top = offset(need, Size::new(plan).post, TOLERANCE);
            tops[j] = union(&tops[j], &top);
        }
    }
    tops
}

/// The part of an area that is on the bed.
fn on_bed(all: Area, bed: Rect) -> Area {
    let Rect { min, max } = all.bounds();
    if bed.contains(min) && bed.contains(max) {
        return all;
    }
    unite(&crop(&all.rings, bed))
}

/// The supports of layer `j` without what is nearer than `apart` to the ends of the
/// part that are too thin to be printed.
fn without_ends(all: Area, parts: Parts<'_>, j: usize, apart: Mm) -> Area {
    let ends = parts.ends[parts.heights.beside(j)].iter();
    let ends: Vec<_> = ends.flat_map(|e| e.rings.clone()).collect();
    if ends.is_empty() {
        return all;
    }
    let ends = unite(&Area { rings: ends });
    difference(&all, &offset(&ends, apart, TOLERANCE))
}

impl SupportIsland {
    /// An island below some tops.
    fn new(all: Area, tops: &[&Area], plan: &SupportPlan) -> SupportIsland {
        let bounds = all.bounds();
        let [body, interface] = split(&all, bounds, tops, plan);
        let both = !body.is_empty() && !interface.is_empty();
        SupportIsland {
            bounds,
            body,
            interface,
            whole: if both { all } else { Area::EMPTY },
        }
    }

    /// The part of the island that lies in an area.
    pub(super) fn within(&self, area: &Area) -> SupportIsland {
        let within = |own: &Area| intersection(own, area);
        SupportIsland {
            bounds: area.bounds(),
            body: within(&self.body),
            interface: within(&self.interface),
            whole: within(&self.whole),
        }
    }

    /// The whole island.
    pub(super) fn all(&self) -> &Area {
        if self.interface.is_empty() {
            &self.body
        } else if self.body.is_empty() {
            &self.interface
        } else {
            &self.whole
        }
    }
}

/// Splits an island into its sparse and its dense part. A sparse strip beside the
/// dense part joins it if it is too narrow for two lines: its own walls would fill
/// it anyway.
fn split(
    island: &Area,
    bounds: Rect,
    tops: &[&Area],
    plan: &SupportPlan,
) -> [Area; 2] {
    let near = tops.iter().map(|top| crop(&top.rings, bounds));
    let near: Area = near.collect();
    if near.is_empty() {
        return [island.clone(), Area::EMPTY];
    }
    let above = unite(&near);
    let rest = difference(island, &above);
    if island.content() - rest.content() <= SPECK {
        return [island.clone(), Area::EMPTY];
    }
    if rest.content() <= SPECK {
        return [Area::EMPTY, island.clone()];
    }
    let half = plan.width;
    let wide = opened(&rest, half, TOLERANCE);
    let body = if rest.content() - wide.content() > SPECK {
        let beside = offset(&above, 2.0 * half, TOLERANCE);
        union(&wide, &difference(&rest, &beside))
    } else {
        wide
    };
    let body = joined(printable(body));
    if body.is_empty() {
        return [body, island.clone()];
    }
    // A speck that is left out would be a pore, with a wall around it.
    let interface = joined(printable(difference(island, &body)));
    let body = joined(printable(difference(island, &interface)));
    [body, interface]
}

/// The islands of an area that are no specks.
fn printable(area: Area) -> impl Iterator<Item = Area> {
    let islands = area.islands().into_iter();
    islands.filter(|island| island.content() > SPECK)
}

/// Islands, put together as one area.
fn joined(islands: impl Iterator<Item = Area>) -> Area {
    islands.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::rect;
    use isoslice_settings::layers::LayerSpan;
    use isoslice_settings::testing::usual_plan;

    fn heights() -> Heights {
        Heights::new(LayerSpan::stack(0.2, 6), &usual_plan(SupportPlan::of))
    }

    #[test]
    fn supports_are_cut_around_ends_that_are_too_thin_to_be_printed() {
        let none = vec![Area::EMPTY; 6];
        // A spike of 0.2 mm that ends in the middle of a support of 6 mm.
        let mut ends = none.clone();
        ends[1] = rect(-5.0, -0.1, 1.0, 0.1);
        let heights = heights();
        let parts = Parts::in_layers(&heights, &none, &ends);
        let areas = vec![rect(-3.0, -3.0, 3.0, 3.0); 6];
        let no_pads = Area::EMPTY;
        let plan = usual_plan(SupportPlan::of);
        let found = pieces(parts, &none, areas, &no_pads, &plan);
        let content =
            |j: usize| found[j].iter().map(|p| p.all().content()).sum::<f64>();
        assert_eq!([content(0), content(2)], [36.0; 2]);
        let round = std::f64::consts::PI * BESIDE * BESIDE / 2.0;
        let cut = 4.0 * (0.2 + 2.0 * BESIDE) + 0.2 * BESIDE + round;
        assert!((content(1) - (36.0 - cut)).abs() < 0.01, "{}", content(1));
    }

    #[test]
    fn what_is_right_above_makes_an_island_dense_and_narrow_strips_with_it() {
        let plan = usual_plan(SupportPlan::of);
        let island = rect(0.0, 0.0, 10.0, 6.0);
        let split_by = |x: f64| {
            let top = rect(-1.0, -1.0, x, 7.0);
            let bounds = island.bounds();
            let parts = split(&island, bounds, &[&top], &plan);
            parts.map(|part| part.content())
        };
        let near = |found: [f64; 2], wanted: [f64; 2]| {
            (found[0] - wanted[0]).abs() < 0.2
                && (found[1] - wanted[1]).abs() < 0.2
        };
        let two = 2.0 * plan.width;
        assert_eq!(split_by(-0.5), [60.0, 0.0]);
        assert!(near(split_by(4.0), [36.0, 24.0]), "{:?}", split_by(4.0));
        let wide = 10.0 - (two + 0.1);
        let wanted = [6.0 * (two + 0.1), 6.0 * wide];
        assert!(near(split_by(wide), wanted), "{:?}", split_by(wide));
        assert_eq!(split_by(10.0 - (two - 0.1)), [0.0, 60.0]);
    }

    #[test]
    fn a_narrow_island_is_dense_only_near_to_what_is_above() {
        let plan = usual_plan(SupportPlan::of);
        let wall = rect(0.0, 0.0, 100.0, 0.6);
        let top = rect(-1.0, -1.0, 5.0, 1.0);
        let [body, interface] = split(&wall, wall.bounds(), &[&top], &plan)
            .map(|part| part.content());
        let near = 5.0 + 2.0 * plan.width;
        assert!((interface - 0.6 * near).abs() < 0.01, "{interface}");
        assert!((body - 0.6 * (100.0 - near)).abs() < 0.01, "{body}");
    }
}
