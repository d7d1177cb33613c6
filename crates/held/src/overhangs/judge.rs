//! The judge: what of a layer the layer below does not hold.
//!
//! In: a layer and the layer below, as they are printed. Out: the areas that stick
//! out by more than h·tan(`support.angle`), without what bridges span. Whoever says
//! that something hangs, or holds it, asks here: supports about all of a layer, the
//! summary of a run about places where the rim tells of something ([`look`]).
//!
//! What is told of such an area is the matter of [`piece`] and [`lip`].
//!
//! [`look`]: super::look
//! [`piece`]: super::piece
//! [`lip`]: super::lip

use super::across::{Across, Upper};
use super::held::held;
use super::plan::OverhangPlan;
use super::printed::Printed;
use isoslice_base::units::Mm;
use isoslice_layer::cover::neighbour::Neighbour;
use isoslice_layer::floating::floating;
use isoslice_planar::clip::{crop, difference, intersection, union, unite};
use isoslice_planar::clusters::clusters;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::offset::offset;
use isoslice_planar::opening::opened;
use isoslice_planar::{Area, Solid};

/// Tolerance of the offsets, mm.
const TOLERANCE: Mm = 0.01;
/// A piece is a speck if its area is less than this length, mm, times the
/// layer's height. A speck sticks to what is beside it.
const SPECK: Mm = 0.15;

/// What of a layer the layer below does not hold.
#[derive(Clone, Debug, Default)]
pub(crate) struct Unheld {
    /// What is printed of it.
    pub must: Area,
    /// What of it is too thin to be printed.
    pub thin: Area,
}

/// What of a layer the layer `below` does not hold.
pub(crate) fn unheld(
    here: &Printed,
    below: &Printed,
    number: usize,
    height: Mm,
    plan: &OverhangPlan,
) -> Unheld {
    if here.area.is_empty()
        || here.area == below.area
        || isoslice_base::limits::is_stopped()
    {
        return Unheld::default();
    }
    let solid = Solid::new(below.area.clone());
    let begins = floating(&here.area, &solid).into_iter();
    let begins: Vec<_> = begins.flat_map(|f| f.island.rings).collect();
    let upper = Upper {
        outline: &Solid::of(&here.area, Across::depth(plan)),
        number,
        height,
        plan,
    };
    let mut unheld = upper.over(here, below);
    if !begins.is_empty() {
        unheld.must = union(&unheld.must, &Area { rings: begins });
    }
    unheld
}

impl Upper<'_> {
    /// What of `here`, which is part of the layer, `below` does not hold. Islands that
    /// begin on nothing are nobody's bridge and should not be among it.
    pub(super) fn over(self, here: &Printed, below: &Printed) -> Unheld {
        let [beyond, thin] = self.beyond(here, below);
        let spans = self.plan.bridges || self.plan.by_skin;
        let must = if beyond.is_empty() || !spans {
            beyond
        } else {
            // Lines of a bridge end on what the layer below holds.
            let reach =
                held(self.height, self.plan) + 2.0 * self.plan.walls.outer;
            let around = beyond.bounds().grown(reach);
            let [core, area] =
                [&below.core, &below.area].map(|all| crop(&all.rings, around));
            let thick = Printed::thick(&core, &area, self.plan);
            self.unbridged(beyond, &here.area, &thick)
        };
        Unheld { must, thin }
    }

    /// Two areas of `here`, without specks. The first one sticks out beyond all
    /// that `below` holds. The second one would, but is too thin to be printed.
    fn beyond(self, here: &Printed, below: &Printed) -> [Area; 2] {
        let Upper { height, plan, .. } = self;
        let (held, half) = (held(height, plan), Printed::half(plan));
        // This cheap test takes too much for need at the corners of the layer
        // below, which hold a little more. The loop over the islands is exact
        // there.
        let reached = offset(&below.core, held + half, TOLERANCE);
        let beyond = large(difference(&here.area, &reached), height);
        if beyond.is_empty() {
            return [Area::EMPTY, Area::EMPTY];
        }
        let [core, area, own] =
            [&below.core, &below.area, &here.core].map(Neighbour::new);
        let (mut need, mut unprinted) = (Vec::new(), Vec::new());
        for island in beyond.islands() {
            // What is farther away has no influence on the island.
            let around = island.bounds().grown(held + 4.0 * half);
            let thick = |core: &Neighbour<'_>, area: &Area| {
                Printed::thick(&core.within(around), area, plan)
            };
            let below = thick(&core, &area.within(around));
            let rest = difference(&island, &offset(&below, held, TOLERANCE));
            if rest.is_empty() {
                continue;
            }
            let printed = thick(&own, &rest);
            unprinted.extend(difference(&rest, &printed).rings);
            need.extend(printed.rings);
        }
        [need, unprinted].map(|rings| large(Area { rings }, height))
    }

    /// The part of `beyond` that no bridge spans. `beyond` is what only a bridge
    /// can hold.
    fn unbridged(self, beyond: Area, here: &Area, below: &Area) -> Area {
        let held = held(self.height, self.plan);
        let around = offset(&beyond, held + TOLERANCE, TOLERANCE);
        // Most of a layer is far from all that sticks out.
        let own = Neighbour::new(here);
        let under = Neighbour::new(below);
        let mut rings = Vec::new();
        for near in clusters(&around) {
            let all = intersection(&own.near(&near.area), &near.area);
            for gap in under.open(&all).islands() {
                rings.extend(self.unspanned(gap, &under).rings);
            }
        }
        large(intersection(&beyond, &unite(&Area { rings })), self.height)
    }

    /// The part of a gap over the layer `below` that bridges do not span.
    fn unspanned(self, gap: Area, below: &Neighbour<'_>) -> Area {
        // A line looks this far for something that holds its ends.
        let around = Across::anchor(self.plan);
        let below = below.within(gap.bounds().grown(around));
        let grid = &EdgeGrid::new(&below, self.plan.walls.skin);
        let Some(across) = Across::new(&gap, grid, self) else {
            return gap;
        };
        let spanned = across.spanned();
        if spanned.is_empty() {
            return gap;
        }
        let rest = difference(&gap, &unite(&spanned));
        // A strip at the gap's edge that is too narrow for a line of its own hangs
        // on the line beside it.
        let spacing = across.spacing;
        opened(&rest, 0.26 * spacing, TOLERANCE)
    }
}

/// The islands that are no specks.
pub(crate) fn large(area: Area, height: Mm) -> Area {
    let islands = area.islands().into_iter();
    let rings = islands.filter(|i| i.content() > SPECK * height);
    rings.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use isoslice_planar::{Ring, rect};
    use isoslice_settings::testing::usual_plan;

    fn both(here: &Area, below: &Area) -> [Area; 2] {
        let plan = usual_plan(OverhangPlan::of);
        let printed = |area: &Area| Printed::new(area, 0.2, &plan).0;
        let Unheld { must, thin } =
            unheld(&printed(here), &printed(below), 1, 0.2, &plan);
        [must, thin]
    }

    fn of(here: &Area, below: &Area) -> Area {
        let [need, _] = both(here, below);
        need
    }

    #[test]
    fn a_ledge_needs_support_beyond_what_the_layer_below_holds() {
        let below = rect(0.0, 0.0, 10.0, 10.0);
        let area = of(&rect(0.0, 0.0, 30.0, 10.0), &below);
        let held = held(0.2, &usual_plan(OverhangPlan::of));
        let exact = 10.0 * (20.0 - held);
        assert!((area.content() - exact).abs() < 0.1, "{}", area.content());
        // 0.28 mm in a layer of 0.2 mm: 54.5°.
        assert!(of(&rect(0.0, 0.0, 10.28, 10.0), &below).is_empty());
    }

    #[test]
    fn a_slope_needs_support_by_its_angle_whatever_the_layer_height() {
        let plan = usual_plan(OverhangPlan::of);
        let below = rect(0.0, 0.0, 10.0, 10.0);
        for height in [0.05, 0.1, 0.2, 0.3, 0.6] {
            let needs = |angle: f64| {
                let out = height * angle.to_radians().tan();
                let here = rect(0.0, 0.0, 10.0 + out, 10.0);
                let [here, below] =
                    [&here, &below].map(|a| Printed::new(a, height, &plan).0);
                let found = unheld(&here, &below, 1, height, &plan);
                !found.must.is_empty()
            };
            // Faces that lean by 55 degrees hold themselves.
            assert_eq!([55.5, 60.0].map(needs), [false, true], "{height}");
        }
    }

    #[test]
    fn what_begins_on_nothing_needs_all_of_it() {
        let pin = rect(20.0, 0.0, 21.0, 1.0);
        let below = rect(0.0, 0.0, 10.0, 10.0);
        assert!((of(&pin, &below).content() - 1.0).abs() < 1e-6);
        assert!((of(&pin, &Area::EMPTY).content() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn walls_that_follow_the_rim_across_a_gap_are_no_bridges() {
        let plate = rect(-10.0, -10.0, 10.0, 10.0);
        let slit = |x: f64| rect(x, -7.0, x + 1.0, 7.0);
        let over = |slit: &Area| of(&plate, &difference(&plate, slit));
        // In the middle of a plate lines run from side to side.
        assert!(over(&slit(0.0)).is_empty());
        // Beside its edge walls run along the slit.
        let held = held(0.2, &usual_plan(OverhangPlan::of));
        let exact = (1.0 - 2.0 * held) * (14.0 - 2.0 * held);
        let found = over(&slit(8.7)).content();
        assert!((found - exact).abs() < 0.1, "{found}, {exact}");
    }

    #[test]
    fn a_wall_that_bends_in_beside_a_neck_is_no_bridge() {
        // Two blocks with a neck between them, whose sides bend in, and which is
        // wider by 0.5 mm on each side in the layer above.
        let blocks =
            union(&rect(-6.0, -5.0, -1.5, 5.0), &rect(1.5, -5.0, 6.0, 5.0));
        let neck = |half: f64| {
            let side = |sign: f64| {
                let at = move |k: i32| {
                    let x = f64::from(k) / 10.0;
                    let bend = 0.5 * (x / 1.5).powi(2);
                    sign * DVec2::new(-x, half + bend)
                };
                (-16..=16).map(at)
            };
            let all: Ring = side(1.0).chain(side(-1.0)).collect();
            union(&blocks, &Area::from(all))
        };
        let (here, below) = (neck(1.5), neck(1.0));
        let held = held(0.2, &usual_plan(OverhangPlan::of));
        let exact = difference(&here, &offset(&below, held, 1e-3)).content();
        let found = of(&here, &below).content();
        assert!((found - exact).abs() < 0.1, "{found}, {exact}");
    }

    #[test]
    fn a_wall_that_turns_round_the_end_of_a_slot_is_no_bridge() {
        // The slot, whose end is round, is shorter by 0.6 mm in the layer above.
        let plate = rect(-10.0, -5.0, 10.0, 5.0);
        let slot = |end: f64| {
            let turn = |k: i32| {
                let angle = f64::from(k) * std::f64::consts::PI / 40.0;
                DVec2::new(end - 0.5 * angle.sin(), 0.5 * angle.cos())
            };
            let open = [(9.0, -0.5), (9.0, 0.5)].map(DVec2::from);
            let ring: Ring = (0..=40).map(turn).chain(open).collect();
            difference(&plate, &unite(&Area::from(ring)))
        };
        let (here, below) = (slot(0.6), slot(0.0));
        let held = held(0.2, &usual_plan(OverhangPlan::of));
        let exact = difference(&here, &offset(&below, held, 1e-3)).content();
        let found = of(&here, &below).content();
        assert!(exact > 0.05, "{exact}");
        assert!((found - exact).abs() < 0.03, "{found}, {exact}");
    }

    #[test]
    fn a_wall_along_a_rim_is_no_bridge_to_what_it_passes_by() {
        // A strip that sticks out along the edge of a plate, and a post beside
        // its end: a line that goes askew ends on it, the wall does not.
        let plate = rect(0.0, 0.0, 10.0, 10.0);
        let strip = rect(0.0, 0.0, 10.5, 10.0);
        let post = rect(9.0, -2.0, 10.4, -0.2);
        let (here, below) = (union(&strip, &post), union(&plate, &post));
        let held = held(0.2, &usual_plan(OverhangPlan::of));
        let found = of(&here, &below).content();
        let exact = (0.5 - held) * (10.0 - held);
        assert!((found - exact).abs() < 0.1, "{found}, {exact}");
    }

    #[test]
    fn what_is_too_thin_to_be_printed_needs_none_and_holds_nothing() {
        // A spike of 0.1 mm, which is 0.5 mm wide in the layer above.
        let plate = rect(0.0, 0.0, 10.0, 10.0);
        let spike =
            |half: f64| union(&plate, &rect(9.0, 5.0 - half, 14.0, 5.0 + half));
        let held = held(0.2, &usual_plan(OverhangPlan::of));
        let [need, unprinted] = both(&spike(0.05), &plate);
        assert!(need.is_empty(), "{need:?}");
        let exact = 0.1 * (4.0 - held);
        assert!((unprinted.content() - exact).abs() < 0.02);
        let [need, unprinted] = both(&spike(0.25), &spike(0.05));
        assert!(unprinted.is_empty(), "{unprinted:?}");
        let exact = 0.5 * (4.0 - held);
        let found = need.content();
        assert!((found - exact).abs() < 0.1, "{found}, {exact}");
    }

    #[test]
    fn bridges_need_none_unless_they_are_too_long() {
        let two = |gap: f64| {
            Area::from_iter([
                rect(0.0, 0.0, 5.0, 10.0),
                rect(5.0 + gap, 0.0, 10.0 + gap, 10.0),
            ])
        };
        let lid = |gap: f64| rect(0.0, 0.0, 10.0 + gap, 10.0);
        assert!(of(&lid(9.0), &two(9.0)).is_empty());
        let long = of(&lid(30.0), &two(30.0)).content();
        assert!((long - 300.0).abs() < 10.0, "{long}");
    }
}
