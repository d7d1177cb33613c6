//! Finds edges that are near each other, by the squares of a grid.

use glam::DVec2;

/// Edges by the squares that they pass through.
pub(super) struct Buckets {
    starts: Vec<u32>,
    items: Vec<u32>,
}

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

impl Buckets {
    pub(super) fn new(
        edges: impl Iterator<Item = (DVec2, DVec2)> + Clone,
    ) -> Buckets {
        let squares = Squares::over(edges.clone());
        let count = squares.nx * squares.ny;
        let mut starts = vec![0_u32; count + 1];
        for edge in edges.clone() {
            squares.visit(edge, |k| starts[k + 1] += 1);
        }
        for k in 0..count {
            starts[k + 1] += starts[k];
        }
        let mut items = vec![0_u32; starts[count] as usize];
        let mut free = starts.clone();
        for (n, edge) in edges.enumerate() {
            squares.visit(edge, |k| {
                items[free[k] as usize] = n as u32;
                free[k] += 1;
            });
        }
        Buckets { starts, items }
    }

    pub(super) fn buckets(&self) -> impl Iterator<Item = &[u32]> {
        self.starts
            .windows(2)
            .map(|w| &self.items[w[0] as usize..w[1] as usize])
    }

    /// Numbers of edges, counted once for each square that they pass through.
    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
        self.items.len()
    }
}
