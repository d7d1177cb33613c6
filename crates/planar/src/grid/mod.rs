//! A uniform grid over edges, for questions about what is within a short
//! distance.
//!
//! A grid is cheaper to build than a tree (two passes over the edges). It is as
//! fast to ask where the edges are spread evenly, as a layer's edges are.
//!
//! | file | what it answers |
//! |---|---|
//! | `mod` | what is inside, what a segment crosses |
//! | `near` | what is near to a segment, or meets a box |
//! | `nearest` | what is nearest to a point |
//! | `segment` | distances and crossings of single segments |

mod near;
mod nearest;
mod segment;

pub use isocontour::plane::nearest_on;

use super::shelves::Shelves;
use super::{Area, Rect, Ring};
use glam::DVec2;
use isoslice_base::units::Mm;
use segment::{box_meets, crossing, is_left};
use std::ops::Range;
use std::sync::OnceLock;

/// Edges by the cells they pass through.
///
/// Edges are numbered in the order of their rings. Each ring takes one number
/// more than it has edges: see [`EdgeGrid::numbers`].
#[derive(Clone, Debug)]
pub struct EdgeGrid {
    /// The points of the rings, each ring with its first point again at the
    /// end: an edge runs from the point with its number to the next. This takes
    /// half the memory of pairs of points.
    points: Vec<DVec2>,
    /// The first point's number of each ring (or other chain of edges), and
    /// the number of what it belongs to.
    chains: Vec<(u32, u32)>,
    /// For the first of each `BLOCK` points, the place of its chain in `chains`.
    blocks: Vec<u32>,
    origin: DVec2,
    cell: Mm,
    /// Cells per millimetre.
    per_cell: f64,
    columns: usize,
    rows: usize,
    /// The numbers of each cell's edges.
    members: Shelves<u32>,
    /// For each cell whether a place in it is inside, once that was asked for.
    insides: OnceLock<Vec<bool>>,
}

/// Greatest number of cells per edge. A finer grid costs memory and saves
/// nothing.
const CELLS_PER_EDGE: f64 = 4.0;

/// Points whose chain is looked for from the same place.
const BLOCK: usize = 16;

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

    /// A grid of lines' edges, each with the number of its line. As with rings,
    /// a line takes one number more than it has edges. A line without points
    /// takes no number.
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
        let count = points.len() - chains.len();
        let bounds = Rect::around(&points);
        let (origin, size) = match count {
            0 => (DVec2::ZERO, DVec2::ZERO),
            _ => (bounds.min, bounds.size()),
        };
        let limit = CELLS_PER_EDGE * count as f64 + 16.0;
        let even = (size.x * size.y / limit).sqrt();
        let long = (size.x + size.y) / limit;
        let cell = reach.max(even).max(long).max(1e-9);
        let columns = (size.x / cell) as usize + 1;
        let rows = (size.y / cell) as usize + 1;
        let mut grid = EdgeGrid {
            blocks: blocks(&chains, points.len()),
            points,
            chains,
            origin,
            cell,
            per_cell: 1.0 / cell,
            columns,
            rows,
            members: Shelves::new(0, &[]),
            insides: OnceLock::new(),
        };
        let mut through = Vec::with_capacity(2 * count);
        for i in grid.edges() {
            let (a, b) = grid.edge(i);
            grid.walk(a, b, |cell| through.push((cell as u32, i as u32)));
        }
        grid.members = Shelves::new(columns * rows, &through);
        grid
    }

    /// The numbers of all edges.
    fn edges(&self) -> impl Iterator<Item = usize> {
        let ends = self.chains.iter().skip(1).map(|c| c.0 as usize);
        let ends = ends.chain([self.points.len()]);
        let chains = self.chains.iter().zip(ends);
        chains.flat_map(|(chain, end)| chain.0 as usize..end - 1)
    }

    /// The number of what an edge belongs to.
    pub fn owner(&self, edge: usize) -> usize {
        self.chains[self.chain(edge)].1 as usize
    }

    /// The place of an edge's chain.
    fn chain(&self, edge: usize) -> usize {
        let from = self.blocks[edge / BLOCK] as usize;
        let goes_on = |c: &&(u32, u32)| c.0 as usize <= edge;
        from + self.chains[from + 1..].iter().take_while(goes_on).count()
    }

    /// The numbers of an edge and of those before and after it in its chain.
    pub(super) fn beside(&self, edge: u32) -> Range<u32> {
        let chain = self.chain(edge as usize);
        let next = self.chains.get(chain + 1);
        let end = next.map_or(self.points.len() as u32, |next| next.0) - 1;
        edge.saturating_sub(1).max(self.chains[chain].0)..end.min(edge + 2)
    }

    /// The ends of an edge.
    pub fn edge(&self, number: usize) -> (DVec2, DVec2) {
        (self.points[number], self.points[number + 1])
    }

    /// The ends of an edge, if there is an edge with this number.
    pub(super) fn get(&self, number: u32) -> Option<(DVec2, DVec2)> {
        let first = number as usize;
        let ends = self.points.get(first..)?;
        Some((*ends.first()?, *ends.get(1)?))
    }

    fn column(&self, x: f64) -> usize {
        // A value that is not a number, or less than 0, becomes 0. The
        // conversion to 64 bits would take several times as long.
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
        // Most edges stay in one row or one column.
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
            let x1 = if row == last {
                high.x
            } else {
                at(bottom + self.cell)
            };
            let (c0, c1) = (self.column(x0.min(x1)), self.column(x0.max(x1)));
            for column in c0..=c1 {
                visit(row * self.columns + column);
            }
        }
    }

    /// The edges of a row's cells between two columns.
    fn of_row(&self, row: usize, columns: [usize; 2]) -> &[u32] {
        let [from, to] = columns.map(|column| row * self.columns + column);
        self.members.over(from..=to)
    }

    /// True if the point is inside the area (even–odd rule; points on the
    /// border may count either way).
    pub fn contains(&self, p: DVec2) -> bool {
        let size = DVec2::new(self.columns as f64, self.rows as f64);
        let corner = self.origin + self.cell * size;
        let within = p.cmpge(self.origin).all() && p.cmple(corner).all();
        if self.members.is_empty() || !within {
            return false;
        }
        let (column, row) = (self.column(p.x), self.row(p.y));
        let cell = row * self.columns + column;
        let begin = self.begin(column, row);
        let (lo, hi) = (begin.min(p), begin.max(p));
        let crossed = |&&m: &&u32| {
            let (a, b) = self.edge(m as usize);
            box_meets(a, b, lo, hi)
                && is_left(begin, p, a) != is_left(begin, p, b)
                && is_left(a, b, begin) != is_left(a, b, p)
        };
        let crossed = self.members.at(cell).iter().filter(crossed).count();
        let insides = self.insides.get_or_init(|| self.find_insides());
        insides[cell] ^ (crossed % 2 == 1)
    }

    /// The place of a cell at which ways to points in the cell begin. It is a share
    /// of the cell that no usual edge runs through, as many do through middles and
    /// corners.
    fn begin(&self, column: usize, row: usize) -> DVec2 {
        const SHARE: DVec2 = DVec2::new(0.381_966, 0.270_091);
        let cell = DVec2::new(column as f64, row as f64);
        self.origin + (cell + SHARE) * self.cell
    }

    /// For each cell whether the place at which ways begin is inside the area.
    fn find_insides(&self) -> Vec<bool> {
        let mut insides = vec![false; self.columns * self.rows];
        // The place is inside if an odd number of edges is crossed on the way to it
        // from the left. Each edge is noted where the first place right of it is.
        for (a, b) in self.edges().map(|i| self.edge(i)) {
            let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
            let slope = (high.x - low.x) / (high.y - low.y);
            for row in self.row(low.y)..=self.row(high.y) {
                let y = self.begin(0, row).y;
                if (low.y > y) == (high.y > y) {
                    continue;
                }
                let is_right =
                    |column| !is_left(low, high, self.begin(column, row));
                let mut column = self.column(low.x + slope * (y - low.y));
                while column > 0 && is_right(column - 1) {
                    column -= 1;
                }
                while column < self.columns && !is_right(column) {
                    column += 1;
                }
                if column < self.columns {
                    insides[row * self.columns + column] ^= true;
                }
            }
        }
        for row in insides.chunks_mut(self.columns) {
            for column in 1..row.len() {
                row[column] ^= row[column - 1];
            }
        }
        insides
    }

    /// The places at which the segment from `a` to `b` crosses or touches
    /// edges, as fractions of its length, in no particular order. A place may
    /// be listed more than once.
    pub fn crossings(&self, a: DVec2, b: DVec2) -> Vec<f64> {
        let mut found = Vec::new();
        if self.members.is_empty() {
            return found;
        }
        self.walk(a, b, |cell| {
            for &m in self.members.at(cell) {
                let (c, d) = self.edge(m as usize);
                found.extend(crossing(a, b, c, d));
            }
        });
        found
    }

    /// True if the way from one place to another crosses an edge, not at its own ends,
    /// which may lie on edges.
    pub fn crosses_way(&self, from: DVec2, to: DVec2) -> bool {
        /// Share of the way at both ends that is not looked at.
        const ENDS: f64 = 0.01;
        let (from, to) = (from.lerp(to, ENDS), to.lerp(from, ENDS));
        let mut crosses = false;
        self.visit_crossed(from, to, |_, _| crosses = true);
        crosses
    }

    /// Calls `visit` with every edge that the segment from `a` to `b` crosses,
    /// and with the place of the crossing, as a fraction of the segment's
    /// length. It may name a crossing more than once. An end of an edge that is
    /// on the segment counts as right of it, so that a ring is crossed as often
    /// inwards as outwards.
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
            for &m in self.members.at(cell) {
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
}

/// For the first of each `BLOCK` points, the place of its chain.
fn blocks(chains: &[(u32, u32)], points: usize) -> Vec<u32> {
    let mut chain = 0;
    let of_point = |point: usize| {
        let begins = |c: &(u32, u32)| c.0 as usize <= point;
        while chains.get(chain + 1).is_some_and(begins) {
            chain += 1;
        }
        chain as u32
    };
    (0..points).step_by(BLOCK).map(of_point).collect()
}

#[cfg(test)]
mod tests;
