//! Decides whether a travel shows and has to be retracted.
//!
//! In: a travel's way. Out: whether it passes over infill, walls, air or top
//! skin.
//!
//! ```text
//!   wall ━━━━━━━━━━━━━━━━━━━━    What a way does near its ends, at the beads
//!           ●                    that it leaves and reaches, does not count.
//!   ┈┈┈┈┈┈┈┈╲┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈    Within half a line's width it may touch a
//!    sparse  ╲                   wall. Within a whole width it may be beside
//!    infill   ╲─────────● next   what hides its ooze.
//! ```
//!
//! A way is hidden if it stays inside the part, behind the outer walls, and off top
//! skin; with one setting it may not cross inner walls, either. A gap between two
//! islands is air, however thin. With another setting every part of a way has to lie
//! over sparse infill ([`Obstacles::within_infill`]), and no wall may be crossed
//! ([`Obstacles::wall`]). A way that touches a wall, or comes nearer to its middle than
//! half a line's width, crosses it.
//!
//! A layer's walls and sparse infill are put into grids when the first way asks
//! for them. Only parts that share a grid's cells and overlap with a way's box
//! are compared with the way.

use super::cross::meets;
use super::{Ground, TravelPlan};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Rect;
use isoslice_planar::along::parted;
use isoslice_planar::bead::{Bead, Role};
use isoslice_planar::grid::EdgeGrid;
use std::cell::OnceCell;

/// What a travel may cross in a layer.
pub(super) struct Obstacles<'a> {
    ground: Ground<'a>,
    beads: &'a [Bead],
    /// Box around the sparse infill; none if there is no sparse infill, or if
    /// it is not printed.
    infill: Option<Rect>,
    walls: OnceCell<EdgeGrid>,
    open: OnceCell<EdgeGrid>,
    inner: OnceCell<EdgeGrid>,
    tops: OnceCell<EdgeGrid>,
    width: Mm,
    inner_width: Mm,
}

/// Distance from a wall's middle that counts as on the wall, as a share of its
/// width. It is a little less than half, since ways keep half a width away
/// where they can.
const NEAR: f64 = 0.4;

/// Share of a depth that remains after rounding.
const ROUNDED: f64 = 0.95;

/// Size of a grid's cells, mm: some lengths of a wall's segments.
const CELL: Mm = 1.0;

impl<'a> Obstacles<'a> {
    /// The obstacles of a layer with these beads, in print order.
    pub(super) fn new(
        beads: &'a [Bead],
        ground: Ground<'a>,
        plan: &TravelPlan,
    ) -> Obstacles<'a> {
        Obstacles {
            ground,
            beads,
            infill: (!ground.sparse.area().is_empty() && !plan.hollow)
                .then(|| ground.sparse.area().bounds()),
            walls: OnceCell::new(),
            open: OnceCell::new(),
            inner: OnceCell::new(),
            tops: OnceCell::new(),
            width: plan.outer_width,
            inner_width: plan.inner_width,
        }
    }

    /// True if every part of the way through `points` lies over sparse infill,
    /// except for a line's width at either end. It is true for no points, and
    /// for one point over sparse infill.
    pub(super) fn within_infill(&self, points: &[DVec2]) -> bool {
        let Some(bounds) = self.infill else {
            return false;
        };
        let (Some(a), Some(b)) = (points.first(), points.last()) else {
            return points.is_empty();
        };
        let way = trimmed(points, self.inner_width);
        if way.is_empty() {
            // A way this short consists of its ends alone, so its middle
            // counts.
            return self.ground.sparse.grid().contains(0.5 * (*a + *b));
        }
        let sparse = || self.ground.sparse.grid();
        way.iter().all(|&p| bounds.contains(p))
            && sparse().contains(way[0])
            && !meets(sparse(), &way)
    }

    /// True if the way crosses a wall. It does if it meets a wall, except for
    /// half a line's width at either end, or if it comes nearer to a wall's
    /// middle than half a width, except for a whole width at either end.
    pub(super) fn wall(&self, points: &[DVec2]) -> bool {
        let grid = self.walls.get_or_init(|| {
            self.grid(|b| {
                use Role::{InnerWall, OuterWall, Overhang};
                matches!(b.role, OuterWall | InnerWall | Overhang)
            })
        });
        let width = self.width.max(self.inner_width);
        let near = NEAR * self.width.min(self.inner_width);
        let beside = trimmed(points, width);
        meets(grid, &trimmed(points, 0.5 * width))
            || beside.windows(2).any(|p| !grid.clear(p[0], p[1], near))
    }

    /// True for an outer wall that hangs, or for a part of one. Such a bead has
    /// the role of an overhang, but the outline is half its width away.
    fn hangs_outside(&self, bead: &Bead) -> bool {
        let middle = bead.stroke.points.get(bead.stroke.points.len() / 2);
        bead.role == Role::Overhang
            && middle.is_some_and(|&p| {
                let reach = 0.5 * self.width + NEAR * self.inner_width;
                self.ground
                    .outline()
                    .grid()
                    .nearest_edge(p, reach)
                    .is_some()
            })
    }

    fn grid(&self, wanted: impl Fn(&Bead) -> bool) -> EdgeGrid {
        self.grid_of(|bead, _| wanted(bead))
    }

    /// A grid of those segments of beads that are wanted.
    fn grid_of(
        &self,
        wanted: impl Fn(&Bead, (DVec2, DVec2)) -> bool,
    ) -> EdgeGrid {
        let all = self.beads.iter().enumerate();
        let segments =
            all.flat_map(|(i, b)| b.stroke.segments().map(move |s| (i, b, s)));
        let wanted = segments.filter(|(_, bead, s)| wanted(bead, *s));
        EdgeGrid::of(wanted.map(|(i, _, s)| (i, s)), CELL)
    }

    /// True if a piece of a bead stays in sight: if it is of top skin, or if the
    /// layer above does not cover its middle. Sparse infill that nothing covers
    /// is left open on purpose.
    fn is_top(&self, bead: &Bead, (a, b): (DVec2, DVec2)) -> bool {
        let view = self.ground.view;
        let bare = || match view.above.first() {
            Some(above) if above.is_like(&view.here) => false,
            Some(above) => !above.outline.grid().contains(a.midpoint(b)),
            None => true,
        };
        bead.role == Role::TopSkin
            || bead.role.is_part() && bead.role != Role::SparseInfill && bare()
    }

    /// True if the way through `points` leaves the part, or touches its
    /// border.
    pub(super) fn air(&self, points: &[DVec2]) -> bool {
        meets(self.ground.outline().grid(), points)
    }

    /// True if the way crosses an outer wall or follows one: if it comes too
    /// near to the outline, since the outer walls lie half a line's width
    /// inside it. The way's ends may be on walls, but may not lead over them.
    /// `next` is the number of the bead that the way leads to.
    pub(super) fn outer_wall(&self, points: &[DVec2], next: usize) -> bool {
        let middle = 0.5 * self.width;
        let near = middle + NEAR * self.width;
        let along = trimmed(points, self.width);
        let follows = along
            .windows(2)
            .any(|p| !self.ground.outline().grid().clear(p[0], p[1], near));
        // Beads of thin places, and walls that grow wider, reach into the part,
        // where they go on as two beads.
        let open = self.open.get_or_init(|| {
            self.grid(|b| {
                (b.role == Role::OuterWall || self.hangs_outside(b))
                    && (!b.stroke.closed || !b.stroke.widths.is_empty())
            })
        });
        let ends = [points.first(), points.last()];
        let at_end = |p: DVec2| {
            let mut ends = ends.iter().flatten();
            ends.any(|e| e.distance(p) < middle)
        };
        let crosses = |p: &[DVec2]| {
            let mut crossed = false;
            open.visit_crossed(p[0], p[1], |t, edge| {
                let i = open.owner(edge);
                let own = i == next || i + 1 == next;
                crossed |= !own || !at_end(p[0].lerp(p[1], t));
            });
            crossed
        };
        follows
            || points.windows(2).any(crosses)
            || self.leads_over(points.iter().copied(), middle)
            || self.leads_over(points.iter().rev().copied(), middle)
    }

    /// True if the beginning of a way comes nearer to the outline than the
    /// middle of the outline's wall, unless the way begins there.
    fn leads_over(
        &self,
        points: impl Iterator<Item = DVec2>,
        middle: Mm,
    ) -> bool {
        let [way, _] = parted(points, self.width);
        let Some(&first) = way.first() else {
            return false;
        };
        let grid = self.ground.outline().grid();
        let near = grid.nearest_edge(first, middle);
        let depth = near.map_or(middle, |(_, q)| first.distance(q));
        let least = ROUNDED * depth;
        way.windows(2).any(|p| !grid.clear(p[0], p[1], least))
    }

    /// True if the way crosses an inner wall. A way that leaves a wall towards
    /// the fill, or comes from the fill, does not cross it.
    pub(super) fn inner_wall(&self, points: &[DVec2]) -> bool {
        let grid = self.inner.get_or_init(|| {
            self.grid(|b| {
                b.role == Role::InnerWall
                    || b.role == Role::Overhang && !self.hangs_outside(b)
            })
        });
        let inside = trimmed(points, 1.2 * self.ground.border);
        inside
            .windows(2)
            .any(|p| !grid.crossings(p[0], p[1]).is_empty())
    }

    /// True if the way passes over what stays in sight and was printed before the
    /// `next`th bead. The bead from which the way comes does not count where the way
    /// leaves it.
    pub(super) fn top(&self, points: &[DVec2], next: usize) -> bool {
        let tops = || self.grid_of(|bead, s| self.is_top(bead, s));
        let grid = self.tops.get_or_init(tops);
        let meets = |points: &[DVec2], counts: &dyn Fn(usize) -> bool| {
            points.windows(2).any(|p| {
                let mut over = false;
                grid.visit_near(p[0], p[1], NEAR * self.width, |i| {
                    over |= counts(i);
                });
                over
            })
        };
        let [_, left] = parted(points.iter().copied(), 2.0 * self.width);
        meets(points, &|i| i + 1 < next) || meets(&left, &|i| i + 1 == next)
    }
}

/// A way without its first and last `length` mm; empty if nothing is left.
fn trimmed(points: &[DVec2], length: Mm) -> Vec<DVec2> {
    let [_, mut way] = parted(points.iter().copied(), length);
    way.reverse();
    let [_, mut way] = parted(way, length);
    way.reverse();
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_lose_their_ends() {
        let way =
            [(0.0, 0.0), (1.0, 0.0), (1.0, 3.0), (2.0, 3.0)].map(DVec2::from);
        let short = trimmed(&way, 1.5);
        let wanted = [DVec2::new(1.0, 0.5), DVec2::new(1.0, 2.5)];
        assert_eq!(short.len(), 2);
        assert!(short.iter().zip(wanted).all(|(p, q)| p.distance(q) < 1e-9));
        assert!(trimmed(&way, 2.6).is_empty());
        assert!(trimmed(&way[..1], 0.0).is_empty());
        assert!(trimmed(&[], 0.1).is_empty());
        assert_eq!(trimmed(&way, 0.0), way);
    }
}
