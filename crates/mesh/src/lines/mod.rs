//! Where parallel lines go into a mesh and out of it.
//!
//! In: a grid of lines. Out: for each line the depths at which the winding number
//! passes one half.
//!
//! ```text
//!     · · · · · · ·      Triangles are seen along the lines: each vertex has a
//!     · ·╱╲ · · · ·      column, a row and a depth. Only what holds a line (a
//!     · ╱· ╲· · · ·      dot) is looked into: boxes, triangles, rows.
//!     ·╱──·─╲ · · ·
//! ```
//!
//! Guarantees: a line that meets an edge or a corner meets as many triangles as
//! one beside it, since both triangles of an edge see the same corners, and signs
//! are exact.

#[cfg(test)]
mod tests;

use crate::mesh::Mesh;
use crate::ray::around;
use crate::shell::Shell;
use crate::tree::Node;
use glam::{DAffine3, DVec2, DVec3};
use isocontour::{Crossing, Grid};
use std::ops::RangeInclusive;

/// A triangle that a line meets.
struct Meeting {
    line: u32,
    depth: f64,
    /// What the winding number behind it is more than that before it.
    change: i64,
    normal: DVec3,
}

/// Lines, and what they meet.
struct Look {
    /// From the mesh to columns, rows and depths.
    to: DAffine3,
    /// True if the map mirrors.
    mirrors: bool,
    /// Number of columns and rows.
    size: [usize; 2],
    meetings: Vec<Meeting>,
}

impl Mesh {
    /// Where lines cross the surface. None if there are openings, or the grid is
    /// flat.
    pub(crate) fn crossed_by(&self, lines: &Grid) -> Option<Vec<Crossing>> {
        self.sign.is_whole().then_some(())?;
        let [x, y, z] = lines.steps;
        let to = DAffine3::from_cols(x, y, z, lines.origin).inverse();
        to.is_finite().then_some(())?;
        let mut look = Look {
            to,
            mirrors: to.matrix3.determinant() < 0.0,
            size: [lines.size[0], lines.size[1]],
            meetings: Vec::new(),
        };
        look.through(&self.shell);
        if let Some(cover) = self.sign.cover() {
            look.through(&cover.shell);
        }
        Some(crossings(look.meetings))
    }
}

/// Where the winding number passes one half.
fn crossings(mut meetings: Vec<Meeting>) -> Vec<Crossing> {
    meetings
        .sort_by(|a, b| a.line.cmp(&b.line).then(a.depth.total_cmp(&b.depth)));
    let mut out = Vec::with_capacity(meetings.len());
    for of_line in meetings.chunk_by(|a, b| a.line == b.line) {
        let mut winding = 0;
        for meeting in of_line {
            let before = winding;
            winding += meeting.change;
            if (before > 0) != (winding > 0) {
                out.push(Crossing {
                    line: meeting.line,
                    depth: meeting.depth,
                    gradient: meeting.normal.normalize_or_zero(),
                });
            }
        }
    }
    out
}

impl Look {
    /// Adds the triangles of a shell.
    fn through(&mut self, shell: &Shell) {
        let mut leaves = Vec::new();
        let meets =
            |node: &Node| [0, 1, 2, 3].map(|i| self.may_hold_a_line(node, i));
        shell
            .tree
            .visit(meets, |first, end| leaves.push(first..end));
        for triangle in leaves.into_iter().flatten() {
            self.meet(shell, triangle);
        }
    }

    /// True if there may be a line in a box of a node.
    fn may_hold_a_line(&self, node: &Node, i: usize) -> bool {
        (0..2).all(|axis| {
            let row = self.to.matrix3.row(axis);
            let offset = self.to.translation[axis];
            let [low, high] = node.range(i, row, offset);
            !self.within(axis, low, high).is_empty()
        })
    }

    /// The columns or rows between two numbers.
    fn within(&self, axis: usize, low: f64, high: f64) -> RangeInclusive<i64> {
        // Numbers that are too large become the largest integers.
        let last = self.size[axis] as i64 - 1;
        (low.ceil() as i64).max(0)..=(high.floor() as i64).min(last)
    }

    /// Notes the lines that meet a triangle.
    fn meet(&mut self, shell: &Shell, triangle: usize) {
        let corners = shell.triangle(triangle);
        let seen = corners.map(|p| self.to.transform_point3(p));
        let flat = seen.map(DVec3::truncate);
        let low = flat[0].min(flat[1]).min(flat[2]);
        let high = flat[0].max(flat[1]).max(flat[2]);
        let columns = self.within(0, low.x, high.x);
        if columns.is_empty() {
            return;
        }
        let depth = Depth::of(seen);
        for row in self.within(1, low.y, high.y) {
            for column in columns.clone() {
                let at = DVec2::new(column as f64, row as f64);
                let around = around(flat, at);
                if around == 0 {
                    continue;
                }
                let [a, b, c] = corners;
                self.meetings.push(Meeting {
                    line: (row * self.size[0] as i64 + column) as u32,
                    depth: depth.at(at),
                    change: if self.mirrors { around } else { -around },
                    normal: (b - a).cross(c - a),
                });
            }
        }
    }
}

/// The depth of a triangle as a function of column and row.
struct Depth {
    start: DVec3,
    slope: DVec2,
    /// The depths of the nearest and the farthest corner.
    ends: [f64; 2],
}

impl Depth {
    fn of([a, b, c]: [DVec3; 3]) -> Depth {
        let normal = (b - a).cross(c - a);
        Depth {
            start: a,
            slope: -normal.truncate() / normal.z,
            ends: [a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z)],
        }
    }

    fn at(&self, at: DVec2) -> f64 {
        let [low, high] = self.ends;
        let along = self.slope.dot(at - self.start.truncate());
        // A triangle that is seen from its side has no slope.
        let depth = self.start.z + along;
        if depth.is_nan() {
            high
        } else {
            depth.max(low).min(high)
        }
    }
}
