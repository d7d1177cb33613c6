//! Which edges come close to a segment, or meet a box.

use super::EdgeGrid;
use super::segment::{box_meets, closer};
use crate::Rect;
use glam::DVec2;
use isoslice_base::units::Mm;

impl EdgeGrid {
    /// Calls `visit` with the number of every edge that comes closer than
    /// `distance` to the segment. It may name an edge more than once.
    pub fn visit_edges_near(
        &self,
        a: DVec2,
        b: DVec2,
        distance: Mm,
        mut visit: impl FnMut(usize),
    ) {
        self.near(a, b, distance, |edge| {
            visit(edge);
            true
        });
    }

    /// Calls `visit` with every edge that comes closer than `distance` to the
    /// segment, as long as `visit` returns true.
    pub fn near(
        &self,
        a: DVec2,
        b: DVec2,
        distance: Mm,
        mut visit: impl FnMut(usize) -> bool,
    ) {
        if self.members.is_empty() {
            return;
        }
        let limit = distance * distance;
        let (lo, hi) = (a.min(b) - distance, a.max(b) + distance);
        let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
        let all = (self.column(lo.x), self.column(hi.x));
        let (first, last) = (self.row(lo.y), self.row(hi.y));
        // If the segment is long, the columns near it differ from row to row.
        let long = (high.x - low.x).abs() > self.cell && last > first;
        let slope = (high.x - low.x) / (high.y - low.y);
        let columns = |row: usize| {
            // The stretch of the segment that is near this row. Rows at the
            // grid's border hold all that is beyond them.
            let bottom = self.origin.y + row as f64 * self.cell - distance;
            let top = bottom + self.cell + 2.0 * distance;
            let at = |y: f64, end: DVec2, open: bool| {
                if open {
                    end.x
                } else {
                    let x = low.x + slope * (y - low.y);
                    x.clamp(low.x.min(high.x), low.x.max(high.x))
                }
            };
            let x0 = at(bottom, low, bottom <= low.y || row == 0);
            let x1 = at(top, high, top >= high.y || row + 1 == self.rows);
            let c0 = self.column(x0.min(x1) - distance);
            (c0, self.column(x0.max(x1) + distance))
        };
        for row in first..=last {
            let (c0, c1) = if long { columns(row) } else { all };
            for &m in self.of_row(row, [c0, c1]) {
                let (c, d) = self.edge(m as usize);
                if box_meets(c, d, lo, hi)
                    && closer(a, b, c, d, limit)
                    && !visit(m as usize)
                {
                    return;
                }
            }
        }
    }

    /// Calls `visit` with the ring's number of every edge that comes closer
    /// than `distance` to the segment. It may name a ring more than once.
    pub fn visit_near(
        &self,
        a: DVec2,
        b: DVec2,
        distance: Mm,
        mut visit: impl FnMut(usize),
    ) {
        self.visit_edges_near(a, b, distance, |edge| visit(self.owner(edge)));
    }

    /// True if some edge meets the box. It may be true as well if only the box
    /// around an edge meets it.
    pub fn meets(&self, rect: Rect) -> bool {
        self.any_in_box(rect.min, rect.max, |_| true)
    }

    /// Calls `visit` with the number of every edge that meets the box from `lo`
    /// to `hi`. It may name an edge more than once, and also edges of which
    /// only the box around them meets it.
    pub fn visit_box(
        &self,
        lo: DVec2,
        hi: DVec2,
        mut visit: impl FnMut(usize),
    ) {
        self.any_in_box(lo, hi, |edge| {
            visit(edge);
            false
        });
    }

    /// Looks for an edge that meets the box from `lo` to `hi`, as `visit_box`
    /// does, and for which `test` is true.
    fn any_in_box(
        &self,
        lo: DVec2,
        hi: DVec2,
        mut test: impl FnMut(usize) -> bool,
    ) -> bool {
        if self.members.is_empty() {
            return false;
        }
        let columns = [lo.x, hi.x].map(|x| self.column(x));
        for row in self.row(lo.y)..=self.row(hi.y) {
            for &m in self.of_row(row, columns) {
                let (c, d) = self.edge(m as usize);
                if box_meets(c, d, lo, hi) && test(m as usize) {
                    return true;
                }
            }
        }
        false
    }

    /// True if no edge comes closer than `distance` to the segment.
    pub fn clear(&self, a: DVec2, b: DVec2, distance: Mm) -> bool {
        let mut clear = true;
        self.near(a, b, distance, |_| {
            clear = false;
            false
        });
        clear
    }
}
