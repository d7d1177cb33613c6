//! Zero lines of a function over a lattice, and points thinned along them.
//!
//! Marching squares finds what is connected. Then the lines' points are moved
//! along the lattice's edges to where the function is zero (Illinois variant of
//! the regula falsi, all points at once). The negative side is to the left.
//!
//! A lattice may be periodic in both directions. A line on it either closes, or
//! comes back to where it began some periods away: its `winding`.

use crate::Length;
use crate::cells::segments;
use crate::plane::simplify::keep_farthest;
use glam::DVec2;

/// Where the function is sampled.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    /// The first node.
    pub origin: DVec2,
    /// Distance of neighbouring nodes.
    pub step: f64,
    /// Number of nodes along x and y; in one period of a periodic lattice.
    pub size: [usize; 2],
    /// True if the lattice goes on after the last nodes with the first ones.
    pub periodic: bool,
}

/// A zero line.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The line's points, unrolled: none jumps by a period.
    pub points: Vec<DVec2>,
    /// True if the line returns to its first point, some periods away if it
    /// winds. Any other line begins and ends at the lattice's border.
    pub closed: bool,
    /// Number of periods along x and y by which the end is away from the
    /// beginning.
    pub winding: [i32; 2],
}

impl Lattice {
    /// The node of column `i` and row `j`.
    pub fn node(&self, i: usize, j: usize) -> DVec2 {
        self.origin + DVec2::new(i as f64, j as f64) * self.step
    }

    /// Number of nodes.
    pub fn count(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Size of a period.
    fn period(&self) -> DVec2 {
        DVec2::new(self.size[0] as f64, self.size[1] as f64) * self.step
    }
}

const NONE: u32 = u32::MAX;

/// The zero lines of a function with these values at the nodes, row by row.
/// `eval` gives its values anywhere. NaN is outside.
pub fn trace(
    lattice: &Lattice,
    values: &[f64],
    rounds: usize,
    eval: &mut dyn FnMut(&[DVec2], &mut Vec<f64>),
) -> Vec<Curve> {
    let [nx, ny] = lattice.size;
    // Edges are counted by the node at which they begin: first the edge to the
    // right, then the edge upwards.
    let mut next = vec![NONE; 2 * nx * ny];
    let mut crossed: Vec<u32> = Vec::new();
    let wrap = usize::from(lattice.periodic);
    let inside = |k: usize| values[k] < 0.0;
    for j in 0..(ny + wrap).saturating_sub(1) {
        let (low, high) = (j * nx, (j + 1) % ny * nx);
        for i in 0..(nx + wrap).saturating_sub(1) {
            let right = (i + 1) % nx;
            let nodes = [low + i, low + right, high + right, high + i];
            let case = nodes
                .iter()
                .enumerate()
                .map(|(bit, &k)| usize::from(inside(k)) << bit)
                .sum::<usize>();
            let sum = || nodes.iter().map(|&k| values[k]).sum::<f64>();
            let edges = [
                2 * nodes[0],
                2 * nodes[1] + 1,
                2 * nodes[3],
                2 * nodes[0] + 1,
            ];
            for &(from, to) in segments(case, || sum() < 0.0) {
                let [from, to] =
                    [from, to].map(|side| edges[usize::from(side)]);
                next[from] = to as u32;
                crossed.push(from as u32);
            }
        }
    }
    chains(lattice, values, rounds, next, crossed, eval)
}

/// Follows the segments, and moves their points onto the zero line.
fn chains(
    lattice: &Lattice,
    values: &[f64],
    rounds: usize,
    mut next: Vec<u32>,
    crossed: Vec<u32>,
    eval: &mut dyn FnMut(&[DVec2], &mut Vec<f64>),
) -> Vec<Curve> {
    // Edges to which no other edge leads begin an open line. They come first.
    let mut led = vec![false; next.len()];
    for &e in &crossed {
        led[next[e as usize] as usize] = true;
    }
    let starts = crossed.iter().filter(|&&e| !led[e as usize]);
    let mut order: Vec<u32> = Vec::with_capacity(crossed.len());
    let mut lines: Vec<(usize, bool)> = Vec::new();
    for &start in starts.chain(&crossed) {
        let mut at = start;
        if next[at as usize] == NONE {
            continue;
        }
        loop {
            order.push(at);
            let to = std::mem::replace(&mut next[at as usize], NONE);
            if to == NONE {
                lines.push((order.len(), false));
                break;
            }
            if to == start {
                lines.push((order.len(), true));
                break;
            }
            at = to;
        }
    }
    let points = zeros(lattice, values, rounds, &order, eval);
    let period = lattice.period();
    let mut curves = Vec::with_capacity(lines.len());
    let mut begin = 0;
    for (end, closed) in lines {
        let mut line: Vec<DVec2> = points[begin..end].to_vec();
        begin = end;
        let mut winding = [0, 0];
        if lattice.periodic {
            let near = |to: DVec2, from: DVec2| {
                to - period * ((to - from) / period).round()
            };
            for k in 1..line.len() {
                line[k] = near(line[k], line[k - 1]);
            }
            if let (Some(&first), Some(&last)) = (line.first(), line.last()) {
                let turns = ((near(first, last) - first) / period).round();
                winding = [turns.x as i32, turns.y as i32];
            }
        }
        curves.push(Curve {
            points: line,
            closed,
            winding,
        });
    }
    curves
}

/// The places on some edges where the function is zero.
fn zeros(
    lattice: &Lattice,
    values: &[f64],
    rounds: usize,
    edges: &[u32],
    eval: &mut dyn FnMut(&[DVec2], &mut Vec<f64>),
) -> Vec<DVec2> {
    let [nx, ny] = lattice.size;
    // Ends of the brackets, as shares of the edge, the values there, and which
    // end moved last.
    let mut brackets: Vec<[f64; 5]> = Vec::with_capacity(edges.len());
    let mut ends: Vec<(DVec2, DVec2)> = Vec::with_capacity(edges.len());
    for &e in edges {
        let node = e as usize / 2;
        let (i, j) = (node % nx, node / nx);
        let from = lattice.node(i, j);
        let (to, other) = match e % 2 {
            0 => (DVec2::X, j * nx + (i + 1) % nx),
            _ => (DVec2::Y, (j + 1) % ny * nx + i),
        };
        ends.push((from, from + to * lattice.step));
        brackets.push([0.0, 1.0, values[node], values[other], 0.0]);
    }
    let guess = |b: &[f64; 5]| {
        let t = b[0] + (b[1] - b[0]) * b[2] / (b[2] - b[3]);
        if t >= b[0] && t <= b[1] {
            t
        } else {
            0.5 * (b[0] + b[1])
        }
    };
    let mut points: Vec<DVec2> = Vec::with_capacity(edges.len());
    let mut found = Vec::new();
    for round in 0..=rounds {
        points.clear();
        let places = ends.iter().zip(&brackets);
        points.extend(places.map(|((a, b), t)| a.lerp(*b, guess(t))));
        if round == rounds {
            break;
        }
        found.clear();
        eval(&points, &mut found);
        for (b, &f) in brackets.iter_mut().zip(&found) {
            let t = guess(b);
            let first = (f < 0.0) == (b[2] < 0.0);
            let (moved, kept, side) =
                if first { (0, 1, -1.0) } else { (1, 0, 1.0) };
            (b[moved], b[moved + 2]) = (t, f);
            // The value of an end that stays twice is halved.
            if b[4] == side {
                b[kept + 2] *= 0.5;
            }
            b[4] = side;
        }
    }
    points
}

/// The points of a line without those that are within `tolerance` of the chords
/// between the others. The ends stay.
pub fn thin(points: &[DVec2], tolerance: Length) -> Vec<DVec2> {
    let mut keep = vec![false; points.len()];
    keep_farthest(&mut keep, |from, to| {
        let chord = points[to] - points[from];
        let length = chord.length();
        let off = |p: DVec2| {
            let d = p - points[from];
            if length > 0.0 {
                let along = chord.dot(d) / length;
                let beyond = (-along).max(along - length).max(0.0);
                (chord.perp_dot(d) / length).abs().max(beyond)
            } else {
                d.length()
            }
        };
        let all = (from + 1..to).map(|k| (off(points[k]), k));
        let farthest = all.max_by(|a, b| a.0.total_cmp(&b.0));
        farthest.filter(|f| f.0 > tolerance).map(|f| f.1)
    });
    let all = points.iter().zip(keep);
    all.filter(|p| p.1).map(|p| *p.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::path_length;

    fn sample(lattice: &Lattice, f: impl Fn(DVec2) -> f64) -> Vec<Curve> {
        let mut values = Vec::new();
        for j in 0..lattice.size[1] {
            for i in 0..lattice.size[0] {
                values.push(f(lattice.node(i, j)));
            }
        }
        trace(lattice, &values, 3, &mut |points, out| {
            out.extend(points.iter().map(|&p| f(p)));
        })
    }

    #[test]
    fn a_circle_is_one_closed_line_on_the_circle() {
        let lattice = Lattice {
            origin: DVec2::splat(-5.0),
            step: 0.25,
            size: [41, 41],
            periodic: false,
        };
        let curves = sample(&lattice, |p| p.length_squared() - 9.0);
        assert_eq!(curves.len(), 1);
        assert!(curves[0].closed);
        for p in &curves[0].points {
            assert!((p.length() - 3.0).abs() < 1e-5, "{p}");
        }
        let length = path_length(&curves[0].points, true);
        assert!((length / (6.0 * std::f64::consts::PI) - 1.0).abs() < 0.002);
        assert!(crate::plane::signed_area(&curves[0].points) > 0.0);
    }

    #[test]
    fn lines_that_leave_the_lattice_are_open() {
        let lattice = Lattice {
            origin: DVec2::ZERO,
            step: 0.5,
            size: [11, 11],
            periodic: false,
        };
        let curves = sample(&lattice, |p| p.y - 1.3 - 0.2 * p.x);
        assert_eq!(curves.len(), 1);
        assert!(!curves[0].closed);
        let ends = (curves[0].points[0], curves[0].points.last().unwrap());
        // The negative side is below and to the left, so the line runs from
        // right to left.
        assert!((ends.0.x, ends.1.x) == (5.0, 0.0), "{ends:?}");
    }

    #[test]
    fn a_line_may_wind_around_a_period() {
        let lattice = Lattice {
            origin: DVec2::ZERO,
            step: 0.25,
            size: [16, 16],
            periodic: true,
        };
        let turn = std::f64::consts::TAU / 4.0;
        let curves = sample(&lattice, |p| ((p.x - p.y) * turn).sin());
        assert_eq!(curves.len(), 2);
        for c in &curves {
            assert!(c.closed);
            assert_eq!(c.winding[0], c.winding[1]);
            assert_eq!(c.winding[0].abs(), 1);
        }
    }

    #[test]
    fn thinning_keeps_within_the_tolerance() {
        let points: Vec<DVec2> = (0..=600)
            .map(|i| {
                let x = f64::from(i) * 0.02;
                DVec2::new(x, x.sin())
            })
            .collect();
        let thinned = thin(&points, 0.01);
        assert!(thinned.len() < 60, "{}", thinned.len());
        for p in &points {
            let near = thinned
                .windows(2)
                .map(|s| crate::plane::nearest_on(*p, s[0], s[1]))
                .map(|q| q.distance(*p))
                .fold(f64::INFINITY, f64::min);
            assert!(near <= 0.0101, "{near}");
        }
    }
}
