//! Which edge is nearest to a point.

use super::EdgeGrid;
use super::nearest_on;
use glam::DVec2;
use isoslice_base::units::Mm;

impl EdgeGrid {
    /// The point of the edges nearest to `p` and the number of its ring.
    pub fn nearest(&self, p: DVec2) -> Option<(usize, DVec2)> {
        let (edge, q) = self.foot(p)?;
        Some((self.owner(edge), q))
    }

    /// The point of the edges nearest to `p`, however far away, and the
    /// number of its edge.
    pub fn foot(&self, p: DVec2) -> Option<(usize, DVec2)> {
        // No point of the grid is farther away than this.
        let size = DVec2::new(self.columns as f64, self.rows as f64);
        let middle = self.origin + 0.5 * self.cell * size;
        let far = p.distance(middle) + self.cell * (size.x + size.y);
        let mut reach = self.cell;
        loop {
            let found = self.nearest_edge(p, reach);
            if found.is_some() || reach > far {
                return found;
            }
            reach *= 2.0;
        }
    }

    /// The point of the edges nearest to `p` and the number of its ring, if
    /// it is within `reach`.
    pub fn nearest_within(
        &self,
        p: DVec2,
        reach: Mm,
    ) -> Option<(usize, DVec2)> {
        let (edge, q) = self.nearest_edge(p, reach)?;
        Some((self.owner(edge), q))
    }

    /// The point of the edges nearest to `p` and the number of its edge, if
    /// it is within `reach`.
    pub fn nearest_edge(&self, p: DVec2, reach: Mm) -> Option<(usize, DVec2)> {
        // What is far is looked at only where nothing is near.
        let mut near = self.cell;
        while near < reach {
            let found = self.nearest_in_rows(p, near);
            if found.is_some() {
                return found;
            }
            near *= FARTHER;
        }
        self.nearest_in_rows(p, reach)
    }

    /// Does what [`EdgeGrid::nearest_edge`] does, at once.
    fn nearest_in_rows(&self, p: DVec2, reach: Mm) -> Option<(usize, DVec2)> {
        if self.members.is_empty() {
            return None;
        }
        let mut found = Nearest::new(p, reach);
        // Look at the row with the point first, then at the rows on either
        // side: what is near the point may rule out all others.
        let (low, high) = (self.row(p.y - reach), self.row(p.y + reach));
        let own = self.row(p.y);
        found.look(self, own, 0.0);
        // Edges outside the grid are in the cells at its border.
        let side = |row: usize| self.origin.y + row as f64 * self.cell;
        for row in own + 1..=high {
            if !found.look(self, row, side(row) - p.y) {
                break;
            }
        }
        for row in (low..own).rev() {
            if !found.look(self, row, p.y - side(row + 1)) {
                break;
            }
        }
        found.found()
    }

    /// The point nearest to a place among some edges. They have to include all
    /// edges that may be within `reach`.
    pub fn nearest_of(
        &self,
        edges: &[u32],
        p: DVec2,
        reach: Mm,
    ) -> Option<(usize, DVec2)> {
        let mut found = Nearest::new(p, reach);
        edges.iter().for_each(|&edge| found.ask(self, edge));
        found.found()
    }
}

/// How much farther the next look goes if nothing is near. With 3, the looks that
/// found nothing cost less than a fifth of the last one.
const FARTHER: f64 = 3.0;

/// The number that no edge has.
const NONE: u32 = u32::MAX;

/// A search for the edge nearest to a point.
struct Nearest {
    p: DVec2,
    /// Square of the distance beyond which nothing is of interest.
    limit: f64,
    /// The nearest edge so far, or `NONE`, and its nearest point.
    edge: u32,
    at: DVec2,
}

impl Nearest {
    fn new(p: DVec2, reach: Mm) -> Nearest {
        Nearest {
            p,
            limit: reach * reach,
            edge: NONE,
            at: p,
        }
    }

    fn found(&self) -> Option<(usize, DVec2)> {
        (self.edge != NONE).then_some((self.edge as usize, self.at))
    }

    /// Looks at a row of a grid that is `off` away, where it is near enough. False if all
    /// of it is too far away, as are then all rows beyond it.
    #[inline]
    fn look(&mut self, grid: &EdgeGrid, row: usize, off: Mm) -> bool {
        // The limit is a hair wider, since the cells' sides are rounded.
        let left = self.limit + 1e-9 - off * off;
        if left < 0.0 {
            return false;
        }
        let half = left.sqrt();
        let ends = [self.p.x - half, self.p.x + half];
        for &edge in grid.of_row(row, ends.map(|x| grid.column(x))) {
            self.ask(grid, edge);
        }
        true
    }

    /// Looks at an edge.
    #[inline]
    fn ask(&mut self, grid: &EdgeGrid, edge: u32) {
        let p = self.p;
        let (a, b) = grid.edge(edge as usize);
        let along = b - a;
        let side = along.perp_dot(p - a);
        let length = along.length_squared();
        // The edge's line is farther away already. The limit is a hair wider,
        // for rounding.
        if side * side > self.limit * length * (1.0 + 1e-9) {
            return;
        }
        let q = nearest_on(p, a, b);
        let d = p.distance_squared(q);
        // Of equally near edges the one with the least number wins, however
        // cells and edges are laid out.
        if d < self.limit || (d == self.limit && edge < self.edge) {
            (self.limit, self.edge, self.at) = (d, edge, q);
        }
    }
}
