//! A grid of points, which finds those near a place.
//!
//! The points are many and fixed, and each search asks for a few near ones. A
//! tree would cost several times as much.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Rect;
use isoslice_planar::shelves::Shelves;

/// Points by the cells that they are in.
pub(super) struct NearEnds {
    points: Vec<DVec2>,
    origin: DVec2,
    cell: Mm,
    columns: usize,
    rows: usize,
    /// The numbers of each cell's points.
    members: Shelves<u32>,
}

/// Average number of points in a cell.
const TO_A_CELL: f64 = 2.0;
/// Greatest number of cells searched to each side.
const FAR: usize = 8;

impl NearEnds {
    /// A grid of the points, which are numbered in their order.
    pub(super) fn new(points: impl Iterator<Item = DVec2>) -> NearEnds {
        let points: Vec<DVec2> = points.collect();
        let bounds = Rect::around(&points);
        let size = bounds.size().max(DVec2::ZERO);
        let cells = points.len() as f64 / TO_A_CELL + 1.0;
        let even = (size.x * size.y / cells).sqrt();
        let long = (size.x + size.y) / cells;
        let cell = even.max(long).max(1e-6);
        let mut grid = NearEnds {
            columns: (size.x / cell) as usize + 1,
            rows: (size.y / cell) as usize + 1,
            points,
            origin: bounds.min,
            cell,
            members: Shelves::new(0, &[]),
        };
        let cell = |p: &DVec2| {
            let (column, row) = grid.place(*p);
            (row * grid.columns + column) as u32
        };
        let in_cells: Vec<(u32, u32)> =
            grid.points.iter().map(cell).zip(0..).collect();
        grid.members = Shelves::new(grid.columns * grid.rows, &in_cells);
        grid
    }

    fn place(&self, p: DVec2) -> (usize, usize) {
        let q = (p - self.origin) / self.cell;
        let inside = |v: f64, n: usize| (v.max(0.0) as usize).min(n - 1);
        (inside(q.x, self.columns), inside(q.y, self.rows))
    }

    /// The `count` points nearest to `p`, nearest first, with the squares of
    /// their distances. Points farther than `reach` or [`FAR`] cells are left
    /// out.
    pub(super) fn near(
        &self,
        p: DVec2,
        reach: Mm,
        count: usize,
        found: &mut Vec<(f64, u32)>,
    ) {
        found.clear();
        if !p.is_finite() || reach <= 0.0 {
            return;
        }
        let limit = reach * reach;
        let (column, row) = self.place(p);
        for ring in 0..=FAR {
            // No point in this ring of cells is nearer than this.
            let least = (ring as f64 - 1.0).max(0.0) * self.cell;
            let enough = found.len() == count
                && found.last().is_some_and(|f| f.0 <= least * least);
            if least > reach || enough {
                break;
            }
            let (low, high) = (row.saturating_sub(ring), row + ring);
            for r in low..=high.min(self.rows - 1) {
                let edge = r + ring == row || r == row + ring;
                let (left, right) = (column.checked_sub(ring), column + ring);
                if edge {
                    for c in left.unwrap_or(0)..=right.min(self.columns - 1) {
                        self.look(r, c, p, limit, count, found);
                    }
                    continue;
                }
                if let Some(c) = left {
                    self.look(r, c, p, limit, count, found);
                }
                if ring > 0 && right < self.columns {
                    self.look(r, right, p, limit, count, found);
                }
            }
        }
    }

    /// Keeps the nearest points of a cell.
    fn look(
        &self,
        row: usize,
        column: usize,
        p: DVec2,
        limit: f64,
        count: usize,
        found: &mut Vec<(f64, u32)>,
    ) {
        let cell = row * self.columns + column;
        for &m in self.members.at(cell) {
            let d = self.points[m as usize].distance_squared(p);
            let worst = if found.len() == count {
                found.last().map_or(limit, |f| f.0)
            } else {
                limit
            };
            if d < worst {
                found.truncate(count - 1);
                let at = found.partition_point(|f| f.0 <= d);
                found.insert(at, (d, m));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_points_are_found() {
        let points: Vec<DVec2> = (0..500)
            .map(|i| {
                let t = f64::from(i);
                // The points are dense on one side.
                let p = DVec2::new(t * 0.618_034, t * 0.754_878).fract();
                DVec2::new(40.0 * p.x * p.x, 30.0 * p.y)
            })
            .collect();
        let grid = NearEnds::new(points.iter().copied());
        let mut found = Vec::new();
        for i in 0..200 {
            let p = points[i] + DVec2::new(0.3, -0.2);
            grid.near(p, 7.0, 6, &mut found);
            let mut all: Vec<f64> =
                points.iter().map(|q| p.distance_squared(*q)).collect();
            all.sort_by(f64::total_cmp);
            all.retain(|d| *d < 49.0);
            all.truncate(6);
            let own: Vec<f64> = found.iter().map(|f| f.0).collect();
            assert_eq!(own, all);
        }
    }
}
