//! Triangles that fill a loop, without new vertices.
//!
//! A short loop gets those with the least area of all (Barequet and Sharir 1995).
//! A long flat one is cut ear by ear. Others are parted at short chords until
//! they are short.

use glam::{DVec2, DVec3};
use isoslice_base::limits::{Cancelled, go_on};
use robust::{Coord, orient2d};

/// Loops with no more edges than this get the least area. The work goes with the
/// third power: a loop of 100 edges takes a millisecond.
const SHORT: usize = 100;
/// Pieces of longer ones.
const PIECE: usize = 24;
/// Triples of vertices that all loops together may look at: about a second.
/// After that loops are short up to [`PIECE`] only.
const TRIPLES: usize = 100_000_000;
/// Ears are looked for in loops up to this many edges. The work goes with the
/// second power.
const EARS: usize = 5000;
/// Vertices and corners that all loops together may compare for ears: about a
/// second.
const COMPARED: usize = 200_000_000;
/// A loop is flat if it is no thicker than this share of its size.
const FLAT: f64 = 0.05;
/// Chords are looked for from this many vertices of a loop.
const CHORDS: usize = 16;
/// The square of a chord counts as this share of an area: among triangles in one
/// plane it is those without long sides that are taken.
const COMPACT: f64 = 1e-3;

/// Fills loops.
pub(crate) struct Filler<'a> {
    vertices: &'a [DVec3],
    /// What may still be done.
    triples: usize,
    compared: usize,
}

impl<'a> Filler<'a> {
    pub(crate) fn new(vertices: &'a [DVec3]) -> Filler<'a> {
        Filler {
            vertices,
            triples: TRIPLES,
            compared: COMPARED,
        }
    }

    /// Triangles whose rim is the loop.
    pub(crate) fn fill(
        &mut self,
        ring: &[u32],
    ) -> Result<Vec<[u32; 3]>, Cancelled> {
        let mut found = Vec::with_capacity(ring.len());
        let places = self.places(ring);
        let triples = ring.len().pow(3) / 6;
        if ring.len() <= SHORT && triples <= self.triples {
            self.triples -= triples;
            least(ring, &places, &mut found);
        } else if let Some(ears) = self.ears(ring, &places) {
            found = ears;
        } else {
            self.part(ring, &mut found)?;
        }
        Ok(found)
    }

    fn places(&self, ring: &[u32]) -> Vec<DVec3> {
        ring.iter().map(|v| self.vertices[*v as usize]).collect()
    }

    /// Parts a loop at chords, and fills the pieces.
    fn part(
        &self,
        ring: &[u32],
        found: &mut Vec<[u32; 3]>,
    ) -> Result<(), Cancelled> {
        let mut todo = vec![ring.to_vec()];
        while let Some(ring) = todo.pop() {
            go_on()?;
            if ring.len() <= PIECE {
                least(&ring, &self.places(&ring), found);
                continue;
            }
            let (low, high) = self.chord(&ring);
            let inner = ring[low..=high].to_vec();
            let outer = [&ring[..=low], &ring[high..]].concat();
            todo.push(outer);
            todo.push(inner);
        }
        Ok(())
    }

    /// A short chord. Both sides have at least a quarter of the edges.
    fn chord(&self, ring: &[u32]) -> (usize, usize) {
        let count = ring.len();
        let place = |i: usize| self.vertices[ring[i % count] as usize];
        let mut best = (f64::INFINITY, 0, count / 2);
        for k in 0..CHORDS.min(count) {
            let from = k * count / CHORDS.min(count);
            for to in from + count / 4..=from + 3 * count / 4 {
                let square = place(from).distance_squared(place(to));
                if square < best.0 {
                    best = (square, from, to % count);
                }
            }
        }
        (best.1.min(best.2), best.1.max(best.2))
    }

    /// Cuts a flat loop. None if it is not flat, or crosses itself.
    fn ears(
        &mut self,
        ring: &[u32],
        places: &[DVec3],
    ) -> Option<Vec<[u32; 3]>> {
        if ring.len() > EARS {
            return None;
        }
        let flat = flattened(places)?;
        let mut left: Vec<usize> = (0..ring.len()).collect();
        let mut found = Vec::with_capacity(ring.len());
        let (mut at, mut misses) = (0, 0);
        while left.len() > 2 {
            let count = left.len();
            let corner =
                [count - 1, 0, 1].map(|step| left[(at + step) % count]);
            let is_level = misses >= count;
            if misses >= 2 * count || self.compared < count {
                return None;
            }
            self.compared -= count;
            if is_ear(&flat, corner, &left, is_level) {
                found.push(corner.map(|i| ring[i]));
                left.remove(at % count);
                // The next ear is not beside it, so that they do not become
                // long.
                at = (at + 1) % (count - 1);
                misses = 0;
            } else {
                at = (at + 1) % count;
                misses += 1;
            }
        }
        Some(found)
    }
}

/// True if a corner of a flat loop can be cut off. `is_level` allows it one
/// without an area.
fn is_ear(
    flat: &[DVec2],
    corner: [usize; 3],
    left: &[usize],
    is_level: bool,
) -> bool {
    let [a, b, c] = corner.map(|i| flat[i]);
    let turn = side(a, b, c);
    if turn < 0.0 || turn == 0.0 && !is_level {
        return false;
    }
    left.iter().all(|i| {
        let p = flat[*i];
        corner.contains(i)
            || p == a
            || p == b
            || p == c
            || side(a, b, p) < 0.0
            || side(b, c, p) < 0.0
            || side(c, a, p) < 0.0
            || turn == 0.0
    })
}

/// Positive if the way turns left at `b`.
fn side(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p.x, y: p.y });
    orient2d(a, b, c)
}

/// A loop as seen from above its plane. None if it has none.
fn flattened(places: &[DVec3]) -> Option<Vec<DVec2>> {
    let middle = places.iter().sum::<DVec3>() / places.len() as f64;
    let normal: DVec3 = (0..places.len())
        .map(|i| {
            let next = places[(i + 1) % places.len()];
            (places[i] - middle).cross(next - middle)
        })
        .sum();
    let normal = normal.try_normalize()?;
    let x = normal.any_orthonormal_vector();
    let y = normal.cross(x);
    let mut thickness = 0.0f64;
    let mut size = 0.0f64;
    let flat = places
        .iter()
        .map(|p| {
            let way = *p - middle;
            thickness = thickness.max(way.dot(normal).abs());
            size = size.max(way.length());
            DVec2::new(way.dot(x), way.dot(y))
        })
        .collect();
    (thickness <= FLAT * size).then_some(flat)
}

/// Adds the triangles with the least area.
fn least(ring: &[u32], places: &[DVec3], found: &mut Vec<[u32; 3]>) {
    let count = ring.len();
    if count < 3 {
        return;
    }
    // Of the piece from i to j: what it costs, and the third corner at its
    // chord.
    let mut cost = vec![0.0; count * count];
    let mut third = vec![0; count * count];
    for length in 2..count {
        for i in 0..count - length {
            let j = i + length;
            let (a, b) = (places[i], places[j]);
            let chord = b - a;
            let mut best = (f64::INFINITY, i + 1);
            for k in i + 1..j {
                let sum = cost[i * count + k]
                    + cost[k * count + j]
                    + 0.5 * chord.cross(places[k] - a).length();
                if sum < best.0 {
                    best = (sum, k);
                }
            }
            cost[i * count + j] = best.0 + COMPACT * chord.length_squared();
            third[i * count + j] = best.1;
        }
    }
    let mut todo = vec![(0, count - 1)];
    while let Some((i, j)) = todo.pop() {
        if j - i < 2 {
            continue;
        }
        let k = third[i * count + j];
        found.push([ring[i], ring[k], ring[j]]);
        todo.push((i, k));
        todo.push((k, j));
    }
}
