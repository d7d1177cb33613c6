//! A uniform grid over edges, for questions about what is within a short
//! distance.
//!
//! Cheaper to build than a tree (two passes over the edges), and as fast to
//! ask where the edges are spread evenly, as a layer's are.

use super::sieve::{LANES, Place, Sieve, each};
use super::{Area, Rect, Ring};
use crate::units::Mm;
use glam::DVec2;

/// Edges by the cells they pass through.
///
/// Edges are numbered in the order of their rings, and so that each ring has
/// one number more than edges: [`EdgeGrid::numbers`].
#[derive(Clone, Debug)]
pub struct EdgeGrid {
    /// Ring by ring, the first point again at the end: an edge runs from the
    /// point with its number to the next. Half the memory of pairs of points.
    points: Vec<DVec2>,
    /// The first point's number of each ring (or other chain of edges), and
    /// the number of what it belongs to.
    chains: Vec<(u32, u32)>,
    origin: DVec2,
    cell: Mm,
    /// Cells per millimetre.
    per_cell: f64,
    columns: usize,
    rows: usize,
    /// Where each cell's edges begin in `members`; one more than cells.
    starts: Vec<u32>,
    members: Vec<u32>,
    /// Tells which of them may be near to a point.
    sieve: Sieve,
}

/// At most so many cells per edge: beyond that a finer grid costs memory and
/// saves nothing.
const CELLS_PER_EDGE: f64 = 4.0;

impl EdgeGrid {
    /// A grid of the area's edges for questions about the distance `reach`.
    pub fn new(area: &Area, reach: Mm) -> EdgeGrid {
        let mut points = Vec::with_capacity(EdgeGrid::numbers(&area.rings));
        let mut chains = Vec::with_capacity(area.rings.len());
        for (i, ring) in area.rings.iter().enumerate() {
            let Some(first) = ring.first() else { continue };
            chains.push((points.len() as u32, i as u32));
            points.extend_from_slice(ring);
            points.push(*first);
        }
        EdgeGrid::build(points, chains, reach)
    }

    /// A grid of any segments, each with the number of what it belongs to.
    pub fn of(
        segments: impl Iterator<Item = (usize, (DVec2, DVec2))>,
        reach: Mm,
    ) -> EdgeGrid {
        let mut points: Vec<DVec2> = Vec::new();
        let mut chains: Vec<(u32, u32)> = Vec::new();
        for (i, (a, b)) in segments {
            let goes_on = chains.last().is_some_and(|c| c.1 == i as u32)
                && points.last() == Some(&a);
            if !goes_on {
                chains.push((points.len() as u32, i as u32));
                points.push(a);
            }
            points.push(b);
        }
        EdgeGrid::build(points, chains, reach)
    }

    /// A grid of lines' edges, each with the number of its line. As with
    /// rings, a line takes one number more than it has edges; one without
    /// points takes none.
    pub fn of_lines<L: IntoIterator<Item = DVec2>>(
        lines: impl Iterator<Item = L>,
        reach: Mm,
    ) -> EdgeGrid {
        let mut points: Vec<DVec2> = Vec::new();
        let mut chains: Vec<(u32, u32)> = Vec::new();
        for (i, line) in lines.enumerate() {
            let first = points.len();
            points.extend(line);
            if points.len() > first {
                chains.push((first as u32, i as u32));
            }
        }
        EdgeGrid::build(points, chains, reach)
    }

    /// How many numbers the edges of some rings take.
    pub fn numbers(rings: &[Ring]) -> usize {
        let of_ring = |r: &Ring| r.len() + usize::from(!r.is_empty());
        rings.iter().map(of_ring).sum()
    }

    fn build(
        points: Vec<DVec2>,
        chains: Vec<(u32, u32)>,
        reach: Mm,
    ) -> EdgeGrid {
        crate::limits::check();
        let count = points.len() - chains.len();
        let bounds = Rect::around(&points);
        let (origin, size) = match count {
            0 => (DVec2::ZERO, DVec2::ZERO),
            _ => (bounds.min, bounds.max - bounds.min),
        };
        let limit = CELLS_PER_EDGE * count as f64 + 16.0;
        let even = (size.x * size.y / limit).sqrt();
        let long = (size.x + size.y) / limit;
        let cell = reach.max(even).max(long).max(1e-9);
        let columns = (size.x / cell) as usize + 1;
        let rows = (size.y / cell) as usize + 1;
        let mut grid = EdgeGrid {
            points,
            chains,
            origin,
            cell,
            per_cell: 1.0 / cell,
            columns,
            rows,
            starts: Vec::new(),
            members: Vec::new(),
            sieve: Sieve::default(),
        };
        // Count, sum up, then fill from the back of each cell's share.
        let mut starts = vec![0; columns * rows + 1];
        grid.walk_all(|c, _| starts[c + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let total = starts.last().copied().unwrap_or(0);
        let mut members = vec![0; total as usize];
        let mut next = starts.clone();
        grid.walk_all(|c, i| {
            members[next[c] as usize] = i;
            next[c] += 1;
        });
        let edges = members.iter().map(|&m| grid.edge(m as usize));
        grid.sieve = Sieve::new(edges, members.len(), origin, size);
        grid.starts = starts;
        grid.members = members;
        grid
    }

    /// The cells of all edges, with the edges' numbers.
    fn walk_all(&self, mut visit: impl FnMut(usize, u32)) {
        let ends = self.chains.iter().skip(1).map(|c| c.0 as usize);
        let ends = ends.chain([self.points.len()]);
        for (chain, end) in self.chains.iter().zip(ends) {
            for i in chain.0 as usize..end - 1 {
                let (a, b) = self.edge(i);
                self.walk(a, b, |c| visit(c, i as u32));
            }
        }
    }

    /// The number of what an edge belongs to.
    pub fn owner(&self, edge: usize) -> usize {
        let chain = self.chains.partition_point(|c| c.0 as usize <= edge);
        self.chains[chain - 1].1 as usize
    }

    /// The ends of an edge.
    pub fn edge(&self, number: usize) -> (DVec2, DVec2) {
        (self.points[number], self.points[number + 1])
    }

    /// The same, if there is one with this number.
    pub(super) fn get(&self, number: u32) -> Option<(DVec2, DVec2)> {
        let first = number as usize;
        let ends = self.points.get(first..)?;
        Some((*ends.first()?, *ends.get(1)?))
    }

    fn column(&self, x: f64) -> usize {
        // What is no number, or less than 0, becomes 0. To 64 bits it would
        // take several times as long.
        let c = (x - self.origin.x) * self.per_cell;
        (c as u32 as usize).min(self.columns - 1)
    }

    fn row(&self, y: f64) -> usize {
        let r = (y - self.origin.y) * self.per_cell;
        (r as u32 as usize).min(self.rows - 1)
    }

    /// The cells that the segment passes through, row by row.
    fn walk(&self, a: DVec2, b: DVec2, mut visit: impl FnMut(usize)) {
        let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
        let (first, last) = (self.row(low.y), self.row(high.y));
        let (from, to) = (self.column(low.x), self.column(high.x));
        // So do most of the edges.
        if first == last || from == to {
            for row in first..=last {
                for column in from.min(to)..=from.max(to) {
                    visit(row * self.columns + column);
                }
            }
            return;
        }
        let slope = (high.x - low.x) / (high.y - low.y);
        let at = |y: f64| {
            let x = low.x + slope * (y - low.y);
            x.clamp(low.x.min(high.x), low.x.max(high.x))
        };
        for row in first..=last {
            let bottom = self.origin.y + row as f64 * self.cell;
            let x0 = if row == first { low.x } else { at(bottom) };
            let x1 = match row == last {
                true => high.x,
                false => at(bottom + self.cell),
            };
            let (c0, c1) = (self.column(x0.min(x1)), self.column(x0.max(x1)));
            for column in c0..=c1 {
                visit(row * self.columns + column);
            }
        }
    }

    /// The cell's edges.
    fn members(&self, cell: usize) -> &[u32] {
        let (from, to) = (self.starts[cell], self.starts[cell + 1]);
        &self.members[from as usize..to as usize]
    }

    /// True if the point is inside the area (even–odd rule; points on the
    /// border may count either way).
    pub fn contains(&self, p: DVec2) -> bool {
        let top = self.origin.y + self.rows as f64 * self.cell;
        if self.members.is_empty() || p.y < self.origin.y || p.y > top {
            return false;
        }
        let row = self.row(p.y);
        // Count the edges crossed on the way to the left, each in the one
        // cell that has the crossing.
        let mut inside = false;
        for column in 0..=self.column(p.x) {
            for &m in self.members(row * self.columns + column) {
                let (a, b) = self.edge(m as usize);
                if (a.y > p.y) == (b.y > p.y) {
                    continue;
                }
                let x = a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
                inside ^= x < p.x && self.column(x) == column;
            }
        }
        inside
    }

    /// The places at which the segment from `a` to `b` crosses or touches
    /// edges, as fractions of its length, in no particular order; one may
    /// come more than once.
    pub fn crossings(&self, a: DVec2, b: DVec2) -> Vec<f64> {
        let mut found = Vec::new();
        if self.members.is_empty() {
            return found;
        }
        self.walk(a, b, |cell| {
            for &m in self.members(cell) {
                let (c, d) = self.edge(m as usize);
                found.extend(crossing(a, b, c, d));
            }
        });
        found
    }

    /// Calls `visit` with every edge that the segment from `a` to `b` crosses,
    /// and where, as a fraction of its length; the same one may come more than
    /// once. An end of an edge that is on the segment counts as to the right
    /// of it, so that a ring is crossed as often inwards as outwards.
    pub fn visit_crossed(
        &self,
        a: DVec2,
        b: DVec2,
        mut visit: impl FnMut(f64, usize),
    ) {
        if self.members.is_empty() {
            return;
        }
        self.walk(a, b, |cell| {
            for &m in self.members(cell) {
                let (c, d) = self.edge(m as usize);
                let (c_left, d_left) = (is_left(a, b, c), is_left(a, b, d));
                if c_left == d_left || is_left(c, d, a) == is_left(c, d, b) {
                    continue;
                }
                let (u, v) = (b - a, d - c);
                let t = (c - a).perp_dot(v) / u.perp_dot(v);
                visit(t.clamp(0.0, 1.0), m as usize);
            }
        });
    }

    /// Calls `visit` with the number of every edge that comes closer than
    /// `distance` to the segment; the same one may come more than once.
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
    /// segment, as long as it returns true.
    pub(super) fn near(
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
        // In some row there may be fewer columns, if the segment is long.
        let long = (high.x - low.x).abs() > self.cell && last > first;
        // Around a short segment a circle is as good as a box.
        let half = 0.5 * a.distance(b);
        let short = half < distance;
        let around = distance + half;
        let place = self.sieve.place(a.midpoint(b), around);
        let around = around * around;
        let frame = (!short).then(|| self.sieve.frame(lo, hi));
        let slope = (high.x - low.x) / (high.y - low.y);
        let columns = |row: usize| {
            // The stretch of the segment that is near this row; rows at the
            // grid's edge have all that is beyond them.
            let bottom = self.origin.y + row as f64 * self.cell - distance;
            let top = bottom + self.cell + 2.0 * distance;
            let at = |y: f64, end: DVec2, open: bool| match open {
                true => end.x,
                false => {
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
            let from = self.starts[row * self.columns + c0] as usize;
            let to = self.starts[row * self.columns + c1 + 1] as usize;
            let mut visit = |i: usize| {
                let m = self.members[i] as usize;
                let (c, d) = self.edge(m);
                !closer(a, b, c, d, limit) || visit(m)
            };
            for k in (from..to).step_by(LANES) {
                let near = match &frame {
                    None => self.sieve.near(k, &place, around),
                    Some(frame) => self.sieve.meets(k, frame),
                };
                if !each(near, k, to, &mut visit) {
                    return;
                }
            }
        }
    }

    /// The point of the edges nearest to `p` and the number of its ring.
    pub fn nearest(&self, p: DVec2) -> Option<(usize, DVec2)> {
        // No point of the grid is farther away than this.
        let size = DVec2::new(self.columns as f64, self.rows as f64);
        let middle = self.origin + 0.5 * self.cell * size;
        let far = p.distance(middle) + self.cell * (size.x + size.y);
        let mut reach = self.cell;
        loop {
            let found = self.nearest_within(p, reach);
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
        if self.members.is_empty() {
            return None;
        }
        let mut found = Nearest::new(p, reach);
        let place = self.sieve.place(p, reach);
        // The row with the point first, then those on either side of it: what
        // is near may settle all others.
        let (low, high) = (self.row(p.y - reach), self.row(p.y + reach));
        let own = self.row(p.y);
        // The same columns of all rows: a root for each to have fewer of them
        // takes longer than to look at the edges in the others.
        let columns = (self.column(p.x - reach), self.column(p.x + reach) + 1);
        found.look(self, &place, own, columns, 0.0);
        // What is outside the grid belongs to the cells at its edge.
        let side = |row: usize| self.origin.y + row as f64 * self.cell;
        for row in own + 1..=high {
            if !found.look(self, &place, row, columns, side(row) - p.y) {
                break;
            }
        }
        for row in (low..own).rev() {
            if !found.look(self, &place, row, columns, p.y - side(row + 1)) {
                break;
            }
        }
        found.found()
    }

    /// The same among some edges, all those that there may be within `reach`.
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

    /// Calls `visit` with the ring's number of every edge that comes closer
    /// than `distance` to the segment; the same one may come more than once.
    pub fn visit_near(
        &self,
        a: DVec2,
        b: DVec2,
        distance: Mm,
        mut visit: impl FnMut(usize),
    ) {
        self.near(a, b, distance, |edge| {
            visit(self.owner(edge));
            true
        });
    }

    /// True if the box around some edge meets the box.
    pub fn meets(&self, rect: Rect) -> bool {
        self.any_in_box(rect.min, rect.max, |_| true)
    }

    /// Calls `visit` with the number of every edge whose box meets that from
    /// `lo` to `hi`; the same one may come more than once.
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

    /// Looks for an edge whose box meets that from `lo` to `hi` and for which
    /// `test` is true.
    fn any_in_box(
        &self,
        lo: DVec2,
        hi: DVec2,
        mut test: impl FnMut(usize) -> bool,
    ) -> bool {
        if self.members.is_empty() {
            return false;
        }
        let (c0, c1) = (self.column(lo.x), self.column(hi.x));
        let frame = self.sieve.frame(lo, hi);
        for row in self.row(lo.y)..=self.row(hi.y) {
            let from = self.starts[row * self.columns + c0] as usize;
            let to = self.starts[row * self.columns + c1 + 1] as usize;
            let mut goes_on = |i: usize| {
                let m = self.members[i] as usize;
                let (c, d) = self.edge(m);
                let meets = (c.x <= hi.x || d.x <= hi.x)
                    && (c.x >= lo.x || d.x >= lo.x)
                    && (c.y <= hi.y || d.y <= hi.y)
                    && (c.y >= lo.y || d.y >= lo.y);
                !(meets && test(m))
            };
            for k in (from..to).step_by(LANES) {
                let near = self.sieve.meets(k, &frame);
                if !each(near, k, to, &mut goes_on) {
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

    /// Looks at a row of a grid that is `off` away; false if that is too far,
    /// as are then all beyond it.
    #[inline]
    fn look(
        &mut self,
        grid: &EdgeGrid,
        place: &Place,
        row: usize,
        columns: (usize, usize),
        off: Mm,
    ) -> bool {
        // A hair more: the cells' sides are rounded.
        if off * off > self.limit + 1e-9 {
            return false;
        }
        let first = row * grid.columns;
        let from = grid.starts[first + columns.0];
        let to = grid.starts[first + columns.1];
        let (from, to) = (from as usize, to as usize);
        for k in (from..to).step_by(LANES) {
            let near = grid.sieve.near(k, place, self.limit);
            each(near, k, to, |i| {
                self.ask(grid, grid.members[i]);
                true
            });
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
        // Farther from its line already; a hair less, for rounding.
        if side * side > self.limit * length * (1.0 + 1e-9) {
            return;
        }
        let q = nearest_on(p, a, b);
        let d = p.distance_squared(q);
        // Of equally near edges the first one, however cells and edges are
        // laid out.
        if d < self.limit || (d == self.limit && edge < self.edge) {
            (self.limit, self.edge, self.at) = (d, edge, q);
        }
    }
}

/// True if two segments come closer to each other than the root of `limit`.
#[inline]
fn closer(a: DVec2, b: DVec2, c: DVec2, d: DVec2, limit: f64) -> bool {
    let (u, v) = (b - a, d - c);
    let (ac, ad, cb) = (c - a, d - a, b - c);
    // One lies on one side of the other's line, farther away: so do nearly
    // all whose boxes are near to each other.
    let apart = |s: f64, t: f64, length: f64| {
        s * t > 0.0 && s * s > limit * length && t * t > limit * length
    };
    let (s0, s1) = (u.perp_dot(ac), u.perp_dot(ad));
    let uu = u.length_squared();
    if apart(s0, s1, uu) {
        return false;
    }
    let (t0, t1) = (ac.perp_dot(v), v.perp_dot(cb));
    let vv = v.length_squared();
    if apart(t0, t1, vv) {
        return false;
    }
    if s0 * s1 < 0.0 && t0 * t1 < 0.0 {
        return limit > 0.0;
    }
    // An end of one, as seen from the beginning of the other, which is
    // `along`; how far it is beside that, times the length.
    let near = |end: DVec2, along: DVec2, side: f64, length: f64| {
        let t = end.dot(along);
        if t <= 0.0 {
            end.length_squared() < limit
        } else if t >= length {
            (end - along).length_squared() < limit
        } else {
            side * side < limit * length
        }
    };
    near(ac, u, s0, uu)
        || near(ad, u, s1, uu)
        || near(-ac, v, t0, vv)
        || near(cb, v, t1, vv)
}

/// The point of the segment from `a` to `b` nearest to `p`.
pub fn nearest_on(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    let along = b - a;
    let t = (p - a).dot(along) / along.length_squared();
    // A segment without length is its own nearest point.
    let t = if t.is_finite() {
        t.clamp(0.0, 1.0)
    } else {
        0.0
    };
    a + along * t
}

/// True if `p` is strictly to the left of the line from `a` to `b`; exact (J.
/// R. Shewchuk, *Adaptive precision floating-point arithmetic and fast robust
/// geometric predicates*, 1997).
fn is_left(a: DVec2, b: DVec2, p: DVec2) -> bool {
    let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(p)) > 0.0
}

/// Where on a–b (0 to 1) it meets c–d, if it does.
fn crossing(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<f64> {
    let (u, v) = (b - a, d - c);
    let det = u.perp_dot(v);
    if det == 0.0 {
        return None;
    }
    let t = (c - a).perp_dot(v) / det;
    let s = (c - a).perp_dot(u) / det;
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::super::edges;
    use super::*;

    /// Square of the distance between two segments.
    fn distance_squared(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> f64 {
        if crossing(a, b, c, d).is_some() {
            return 0.0;
        }
        let to = |p: DVec2, q: DVec2, r: DVec2| {
            p.distance_squared(nearest_on(p, q, r))
        };
        to(a, c, d)
            .min(to(b, c, d))
            .min(to(c, a, b))
            .min(to(d, a, b))
    }

    #[test]
    fn clearance_of_a_star() {
        let ring: Vec<DVec2> = (0..40)
            .map(|i| {
                let r = if i % 2 == 0 { 10.0 } else { 6.0 };
                let turn = std::f64::consts::TAU * f64::from(i) / 40.0;
                DVec2::from_angle(turn) * r
            })
            .collect();
        let area = Area {
            rings: vec![ring.clone()],
        };
        let grid = EdgeGrid::new(&area, 0.3);
        for i in 0..300 {
            let a =
                DVec2::new(f64::from(i % 20) - 10.0, f64::from(i / 15) - 9.7);
            let b = a + DVec2::new(1.3, 0.4);
            let exact = edges(&ring)
                .map(|(c, d)| distance_squared(a, b, c, d))
                .fold(f64::INFINITY, f64::min)
                .sqrt();
            for reach in [0.1, 0.5, 3.0] {
                assert_eq!(grid.clear(a, b, reach), exact >= reach);
            }
        }
    }

    #[test]
    fn inside_crossings_and_nearest_agree_with_the_area() {
        let ring: Vec<DVec2> = (0..60)
            .map(|i| {
                let turn = std::f64::consts::TAU * f64::from(i) / 60.0;
                DVec2::from_angle(turn) * (8.0 + 2.0 * (5.0 * turn).sin())
            })
            .collect();
        let mut hole: Vec<DVec2> = ring.iter().map(|p| p * 0.4).collect();
        hole.reverse();
        let area = Area {
            rings: vec![ring, hole],
        };
        let grid = EdgeGrid::new(&area, 0.5);
        for i in 0..441 {
            let p =
                DVec2::new(f64::from(i % 21), f64::from(i / 21)) * 1.04 - 10.4;
            assert_eq!(grid.contains(p), area.contains(p), "{p}");
            let q = DVec2::new(-p.y, 0.7 * p.x);
            let mut found = grid.crossings(p, q);
            found.sort_by(f64::total_cmp);
            found.dedup();
            let crossed = found.len() % 2 == 1;
            assert_eq!(crossed, area.contains(p) != area.contains(q));
            let near = area
                .rings
                .iter()
                .flat_map(|r| edges(r))
                .map(|(a, b)| p.distance(nearest_on(p, a, b)))
                .fold(f64::INFINITY, f64::min);
            let (_, nearest) = grid.nearest(p).unwrap_or_default();
            assert!((p.distance(nearest) - near).abs() < 1e-9);
            let found = grid.nearest_within(p, 1.5);
            assert_eq!(found.is_some(), near <= 1.5);
            if let Some((_, q)) = found {
                assert!((p.distance(q) - near).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn nothing_is_near_an_empty_area() {
        let grid = EdgeGrid::new(&Area::EMPTY, 1.0);
        assert!(grid.clear(DVec2::ZERO, DVec2::ONE, 100.0));
    }
}
