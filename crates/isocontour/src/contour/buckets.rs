//! Finds edges that are near each other, by the squares of a grid.

use crate::plane::shelves::Shelves;
use glam::DVec2;

/// A grid of squares over some edges, about as large as the edges are long.
struct Squares {
    lo: DVec2,
    size: f64,
    /// Columns and rows.
    nx: usize,
    ny: usize,
}

impl Squares {
    fn over(edges: impl Iterator<Item = (DVec2, DVec2)>) -> Squares {
        let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (mut count, mut length) = (0_usize, 0.0);
        for (a, b) in edges {
            lo = lo.min(a.min(b));
            hi = hi.max(a.max(b));
            length += a.distance(b);
            count += 1;
        }
        // There are not many more squares than edges.
        let extent = (hi - lo).max(DVec2::ZERO);
        let even = (extent.element_product() / count.max(1) as f64).sqrt();
        let size = even.max(length / count.max(1) as f64).max(1e-6);
        let cells = |x: f64| (x / size) as usize + 1;
        let (nx, ny) = (cells(extent.x), cells(extent.y));
        Squares { lo, size, nx, ny }
    }

    fn column(&self, x: f64) -> usize {
        let column = ((x - self.lo.x) / self.size) as u32;
        (column as usize).min(self.nx - 1)
    }

    fn row(&self, y: f64) -> usize {
        let row = ((y - self.lo.y) / self.size) as u32;
        (row as usize).min(self.ny - 1)
    }

    /// Visits the squares that an edge passes through, row by row. The squares
    /// of its whole box would be far too many for a long slanting edge.
    fn visit(&self, (a, b): (DVec2, DVec2), mut visit: impl FnMut(usize)) {
        let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
        let (bottom, top) = (self.row(a.y), self.row(b.y));
        let [left, right] = [a.x.min(b.x), a.x.max(b.x)];
        let (left, right) = (self.column(left), self.column(right));
        // Most edges are in one row or column, or in two of each.
        let short = (top - bottom) * (right - left) <= 1;
        let pad = 1e-9 * self.size;
        for j in bottom..=top {
            let (mut from, mut to) = (left, right);
            if !short {
                // The places where the edge enters and leaves the row, and a
                // little more.
                let x = |y: f64| {
                    let share = (y - a.y) / (b.y - a.y);
                    a.x + (b.x - a.x) * share.clamp(0.0, 1.0)
                };
                let bottom = self.lo.y + j as f64 * self.size;
                let [p, q] = if a.y < b.y {
                    [x(bottom - pad), x(bottom + self.size + pad)]
                } else {
                    [a.x, b.x]
                };
                from = self.column(p.min(q) - pad);
                to = self.column(p.max(q) + pad);
            }
            for i in from..=to {
                visit(j * self.nx + i);
            }
        }
    }
}

/// The numbers of edges by the squares that they pass through.
pub(super) fn buckets(
    edges: impl Iterator<Item = (DVec2, DVec2)> + Clone,
) -> Shelves<u32> {
    let squares = Squares::over(edges.clone());
    let mut through = Vec::new();
    for (edge, n) in edges.zip(0..) {
        squares.visit(edge, |square| through.push((square as u32, n)));
    }
    Shelves::new(squares.nx * squares.ny, &through)
}

/// Calls `see` for each two edges that pass through one square, as often as they
/// share one.
pub(super) fn each_pair(
    edges: impl Iterator<Item = (DVec2, DVec2)> + Clone,
    mut see: impl FnMut(u32, u32),
) {
    let buckets = buckets(edges);
    for bucket in (0..buckets.count()).map(|k| buckets.at(k)) {
        for (k, &m) in bucket.iter().enumerate() {
            for &n in &bucket[k + 1..] {
                see(m, n);
            }
        }
    }
}
