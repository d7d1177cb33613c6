//! Finds the vertices of a batch: where its edges meet the outline.
//!
//! ```text
//!      a            Of the vertices that follow each other, every fourth is
//!     ╱ ╲p          brought onto f = 0 (`refine`). The cubic through two of
//!    ╱   ╲q         them, with the directions of their gradients, then says
//!   ╱     ╲         where those between them are; the field's values at
//!  ╱       b        their edges' ends say so, too, by a parabola.
//! ```
//!
//! Where the two agree to half the tolerance of chords, the cubic is believed,
//! and where they do not, the field is asked.
//!
//! Not guaranteed: that a dent is found that leaves no trace at any node, nor
//! at `a` and `b`. Such a dent is narrower than a cell of the lattice.
//!
//! What is on the border of the batch is always brought onto f = 0: other
//! batches have it, too, and have to come to the same.

use super::edges::Edge;
use super::link::NONE;
use super::refine::{Bracket, refine};
use super::samples::Samples;
use super::trace::End;
use crate::Length;
use crate::field::{FieldError, Sampler};

/// Vertices from one that is found to the next.
const STEP: usize = 4;

/// How closely the values at the nodes have to agree with the cubic, as a share
/// of the tolerance.
const AGREE: f64 = 0.5;

/// Greatest slope of the outline against the line between two vertices.
const STEEP: f64 = 0.3;

/// How the vertices follow each other.
pub(super) struct Order {
    next: Vec<u32>,
    /// Whether another one comes before.
    follows: Vec<bool>,
    /// Whether it has to be found.
    needed: Vec<bool>,
}

impl Order {
    /// Of so many vertices, by the pieces of outline from one to another.
    /// Those of pieces with another one beside them have to be found.
    pub(super) fn new(
        count: usize,
        pieces: impl Iterator<Item = (u32, u32, bool)>,
    ) -> Self {
        let mut order = Order {
            next: vec![NONE; count],
            follows: vec![false; count],
            needed: vec![false; count],
        };
        for (from, to, beside) in pieces {
            let (a, b) = (from as usize, to as usize);
            order.next[a] = to;
            order.follows[b] = true;
            order.needed[a] |= beside;
            order.needed[b] |= beside;
        }
        order
    }

    /// Visits the lines of vertices; of a closed one, the first is visited
    /// again at the end.
    fn lines(&self, mut visit: impl FnMut(&[u32])) {
        let mut seen = vec![false; self.next.len()];
        let mut line = Vec::new();
        let open = (0..seen.len()).filter(|&v| !self.follows[v]);
        for first in open.chain(0..seen.len()) {
            if seen[first] {
                continue;
            }
            line.clear();
            let mut at = first as u32;
            while at != NONE && !seen[at as usize] {
                seen[at as usize] = true;
                line.push(at);
                at = self.next[at as usize];
            }
            line.extend((at != NONE).then_some(at));
            visit(&line);
        }
    }
}

/// The vertices of the edges, with their gradients, which are zero where the
/// field jumps. `z` are the heights of the slab's layers.
pub(super) fn settle(
    edges: &[Edge],
    order: &Order,
    z: &[f32],
    tolerance: Length,
    sampler: &mut dyn Sampler,
    scratch: &mut Samples,
) -> Result<Vec<End>, FieldError> {
    // Lines of vertices between two that are found.
    let mut spans: Vec<u32> = Vec::with_capacity(2 * edges.len());
    let mut ends: Vec<u32> = Vec::new();
    let mut wanted: Vec<u32> = Vec::new();
    order.lines(|line| {
        let mut from = 0;
        wanted.extend(line.first());
        for k in 1..line.len() {
            let last = k + 1 == line.len();
            if !last && k - from < STEP && !order.needed[line[k] as usize] {
                continue;
            }
            // A closed line's first is known.
            if !(last && line[k] == line[0]) {
                wanted.push(line[k]);
            }
            if k > from + 1 {
                spans.extend(&line[from..=k]);
                ends.push(spans.len() as u32);
            }
            from = k;
        }
    });
    let mut found = vec![End::default(); edges.len()];
    let mut find = |wanted: &[u32], found: &mut [End]| {
        let edges = wanted.iter().map(|&v| &edges[v as usize]);
        let mut brackets: Vec<Bracket> =
            edges.clone().map(Edge::bracket).collect();
        let heights: Vec<f32> = edges.map(|e| z[e.layer as usize]).collect();
        let gradients = refine(&mut brackets, &heights, sampler, scratch)?;
        for ((&v, b), gradient) in wanted.iter().zip(&brackets).zip(gradients) {
            let point = b.point();
            found[v as usize] = End { point, gradient };
        }
        Ok::<(), FieldError>(())
    };
    find(&wanted, &mut found)?;
    wanted.clear();
    let mut start = 0;
    for end in ends {
        let span = &spans[start..end as usize];
        start = end as usize;
        if !between(span, edges, tolerance, &mut found) {
            wanted.extend(&span[1..span.len() - 1]);
        }
    }
    find(&wanted, &mut found)?;
    Ok(found)
}

/// Puts the vertices between the first and the last one of a span where these
/// say; false if that is not where they are.
fn between(
    span: &[u32],
    edges: &[Edge],
    tolerance: Length,
    found: &mut [End],
) -> bool {
    let [first, inner @ .., last] = span else {
        return true;
    };
    let (p, q) = (found[*first as usize], found[*last as usize]);
    let chord = q.point - p.point;
    let length = chord.length();
    let along = chord / length;
    let across = along.perp();
    // The outline's direction, as a slope against the chord.
    let steep = [p, q].map(|end| end.gradient.dot(across));
    let slope = [p, q].map(|e| -e.gradient.dot(along) / e.gradient.dot(across));
    let [s, t] = slope;
    // Also if it is no number.
    let smooth = s.abs() <= STEEP && t.abs() <= STEEP;
    if !smooth || steep[0] * steep[1] <= 0.0 {
        return false;
    }
    let mut before = 0.0;
    for &v in inner {
        let edge = &edges[v as usize];
        let guess = edge.guess() - p.point;
        let u = guess.dot(along) / length;
        let w = 1.0 - u;
        let off = guess.dot(across) - length * u * w * (s * w - t * u);
        if !(off.abs() <= AGREE * tolerance && before < u && u < 1.0) {
            return false;
        }
        before = u;
        // Along the edge onto the cubic, whose own slope is small.
        let way = edge.outside - edge.inside;
        let rise = s * w * (w - 2.0 * u) - t * u * (2.0 * w - u);
        let by = off / (way.dot(across) - rise * way.dot(along));
        let point = p.point + guess - by * way;
        let inside = (point - edge.inside).dot(way) / way.length_squared();
        if !(by.abs() < 0.1 && (0.0..=1.0).contains(&inside)) {
            return false;
        }
        let gradient = (across - rise * along) * (w * steep[0] + u * steep[1]);
        found[v as usize] = End { point, gradient };
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Bound;
    use crate::plane::Rect;
    use glam::DVec2;

    /// Evaluates a function of x and y, and counts.
    struct Plane<F: Fn(DVec2) -> f64>(F, usize);

    impl<F: Fn(DVec2) -> f64> Sampler for Plane<F> {
        fn values(
            &mut self,
            x: &[f32],
            y: &[f32],
            _: &[f32],
            out: &mut Vec<f32>,
        ) -> Result<(), FieldError> {
            self.1 += x.len();
            out.clear();
            let points = x.iter().zip(y);
            let points = points.map(|(&x, &y)| DVec2::new(x.into(), y.into()));
            out.extend(points.map(|p| (self.0)(p) as f32));
            Ok(())
        }

        fn slopes(
            &mut self,
            x: &[f32],
            y: &[f32],
            _: &[f32],
            out: &mut Vec<[f32; 3]>,
        ) {
            self.1 += x.len();
            out.clear();
            out.extend(x.iter().zip(y).map(|(&x, &y)| {
                let p = DVec2::new(x.into(), y.into());
                let along =
                    |d: DVec2| ((self.0)(p + d) - (self.0)(p - d)) / 2e-6;
                let [dx, dy] = [DVec2::X, DVec2::Y].map(|d| along(1e-6 * d));
                [(self.0)(p) as f32, dx as f32, dy as f32]
            }));
        }

        fn bounds(&mut self, _: &[(Rect, f32)], _: &mut Vec<Bound>) {}
    }

    /// The edges around the origin of a lattice 0.1 mm wide that an outline
    /// crosses, by their angle.
    fn around(f: &impl Fn(DVec2) -> f64) -> Vec<Edge> {
        let mut edges = Vec::new();
        for (i, j) in (-60..60).flat_map(|i| (-60..60).map(move |j| (i, j))) {
            let p = 0.1 * DVec2::new(f64::from(i) + 0.03, f64::from(j) + 0.04);
            for step in [DVec2::new(0.1, 0.0), DVec2::new(0.0, 0.1)] {
                let q = p + step;
                if (f(p) < 0.0) == (f(q) < 0.0) {
                    continue;
                }
                let bend = f(p - step) - f(p) - f(q) + f(q + step);
                let [inside, outside] =
                    if f(p) < 0.0 { [p, q] } else { [q, p] };
                edges.push(Edge {
                    inside,
                    outside,
                    field: [inside, outside].map(|p| f(p) as f32),
                    bend: (0.5 * bend) as f32,
                    number: 0,
                    layer: 0,
                });
            }
        }
        edges.sort_by(|a, b| {
            let angle = |e: &Edge| e.guess().to_angle();
            angle(a).total_cmp(&angle(b))
        });
        edges
    }

    /// The vertices of a ring, and how often the field was asked, for each.
    fn ring(f: impl Fn(DVec2) -> f64) -> (Vec<End>, f64) {
        let edges = around(&f);
        let n = edges.len() as u32;
        let pieces = (0..n).map(|k| (k, (k + 1) % n, false));
        let order = Order::new(edges.len(), pieces);
        let mut plane = Plane(f, 0);
        let mut scratch = Samples::default();
        let found =
            settle(&edges, &order, &[0.0], 5e-4, &mut plane, &mut scratch);
        (found.unwrap(), plane.1 as f64 / edges.len() as f64)
    }

    #[test]
    fn most_of_a_smooth_outline_need_not_be_found() {
        // A circle; an ellipse whose field is no distance, at a small scale.
        type Case = fn(DVec2) -> f64;
        let cases: [(Case, Case); 2] = [
            (|p| p.length() - 3.0, |p| p.length() - 3.0),
            (
                |p| 1e-6 * ((p.x / 5.0).powi(2) + (p.y / 3.0).powi(2) - 1.0),
                |p| {
                    let f = (p.x / 5.0).powi(2) + (p.y / 3.0).powi(2) - 1.0;
                    f / DVec2::new(p.x / 12.5, p.y / 4.5).length()
                },
            ),
        ];
        for (f, distance) in cases {
            let (found, asked) = ring(f);
            assert!(found.len() > 200 && asked < 0.5, "{asked}");
            for End { point, gradient } in found {
                assert!(distance(point).abs() < 2e-4, "{}", distance(point));
                let d = |p: DVec2| distance(point + p) - distance(point - p);
                let normal = DVec2::new(d(1e-4 * DVec2::X), d(1e-4 * DVec2::Y));
                assert!(gradient.angle_to(normal).abs() < 0.005);
            }
        }
    }

    #[test]
    fn what_is_not_smooth_is_found_all_along() {
        // Corners, a dent as wide as a span, steps.
        let square = |p: DVec2| p.abs().max_element() - 2.97;
        let dent = |p: DVec2| {
            let off = p - DVec2::new(3.0, 0.0);
            p.length() - 3.0 + 0.004 * (-off.length_squared() / 0.01).exp()
        };
        let steps = |p: DVec2| p.length().powi(2).floor() - 8.5;
        for f in [&square as &dyn Fn(DVec2) -> f64, &dent, &steps] {
            for End { point, .. } in ring(f).0 {
                let out = point.normalize();
                let near = [-5e-4, 5e-4].map(|d| f(point + d * out));
                assert!(near[0] < 0.0 && near[1] >= 0.0, "{point}");
            }
        }
    }

    #[test]
    fn lines_of_vertices_open_and_closed() {
        let pieces = [(4, 2), (2, 0), (5, 6), (6, 5), (3, 3)];
        let pieces = pieces.iter().map(|&(a, b)| (a, b, false));
        let mut lines = Vec::new();
        Order::new(7, pieces).lines(|line| lines.push(line.to_vec()));
        assert_eq!(lines, [vec![1], vec![4, 2, 0], vec![3, 3], vec![5, 6, 5]]);
    }
}
