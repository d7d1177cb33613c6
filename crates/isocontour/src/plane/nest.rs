//! Which outer ring a point is in, for many points.
//!
//! The rings' edges are sorted into bands of the plane, and a point looks at
//! the edges of its own band only. With n rings of a layer that is about √n of
//! them instead of all. This is near enough to linear growth for a layer of
//! many thousand islands or holes.

use super::shelves::Shelves;
use super::{Ring, edges, is_within, signed_area};
use crate::{Content, Length};
use glam::DVec2;

/// Rings by the bands that their edges pass through.
pub struct Nest {
    /// Content of each ring.
    contents: Vec<Content>,
    bands: Bands,
    /// Ring and ends of the edges of each band.
    edges: Shelves<(u32, DVec2, DVec2)>,
}

/// Bands of the plane of one height.
struct Bands {
    bottom: f64,
    height: Length,
    count: usize,
}

impl Bands {
    /// The band in which a place is.
    fn at(&self, y: f64) -> usize {
        let k = (y - self.bottom) / self.height;
        (k.max(0.0) as usize).min(self.count - 1)
    }
}

impl Nest {
    /// A nest of the rings, which are numbered in their order.
    pub fn new<'a>(rings: impl Iterator<Item = &'a Ring> + Clone) -> Nest {
        let contents: Vec<Content> =
            rings.clone().map(|r| signed_area(r).abs()).collect();
        let all = || {
            rings
                .clone()
                .enumerate()
                .flat_map(|(i, r)| edges(r).map(move |(a, b)| (i as u32, a, b)))
        };
        let (mut count, mut rise) = (0_usize, 0.0);
        let (mut bottom, mut top) = (f64::INFINITY, f64::NEG_INFINITY);
        for (_, a, b) in all() {
            count += 1;
            rise += (b.y - a.y).abs();
            bottom = bottom.min(a.y);
            top = top.max(a.y);
        }
        if count == 0 {
            (bottom, top) = (0.0, 0.0);
        }
        // No band is lower than the edges' mean height, so that an edge is in
        // about two bands. There are no more bands than edges.
        let mean = rise.max(top - bottom) / count.max(1) as f64;
        let height = mean.max(1e-9);
        let bands = Bands {
            bottom,
            height,
            count: ((top - bottom) / height) as usize + 1,
        };
        let mut through = Vec::with_capacity(2 * count);
        for (i, a, b) in all() {
            let over = bands.at(a.y.min(b.y))..=bands.at(a.y.max(b.y));
            through.extend(over.map(|band| (band as u32, (i, a, b))));
        }
        Nest {
            contents,
            edges: Shelves::new(bands.count, &through),
            bands,
        }
    }

    /// Content of a ring, by its number.
    pub fn content(&self, ring: usize) -> Content {
        self.contents[ring]
    }

    /// The number of the smallest ring around the point (points on a ring
    /// may count either way).
    pub fn around(&self, p: DVec2) -> Option<usize> {
        self.around_but(p, usize::MAX)
    }

    /// The number of the smallest ring around the point, of all but one.
    pub fn around_but(&self, p: DVec2, except: usize) -> Option<usize> {
        let mut best: Option<usize> = None;
        // The edges of a ring follow each other.
        let band = self.edges.at(self.bands.at(p.y));
        for own in band.chunk_by(|a, b| a.0 == b.0) {
            let ring = own[0].0 as usize;
            let edges = own.iter().map(|&(_, a, b)| (a, b));
            let smaller =
                |best: usize| self.contents[ring] < self.contents[best];
            if is_within(edges, p) && ring != except && best.is_none_or(smaller)
            {
                best = Some(ring);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::super::ring_contains;
    use super::*;

    fn star(x: f64, y: f64, r: f64, points: usize) -> Ring {
        (0..2 * points)
            .map(|i| {
                let turn = std::f64::consts::PI * i as f64 / points as f64;
                let r = if i % 2 == 0 { r } else { 0.6 * r };
                DVec2::new(x, y) + DVec2::from_angle(turn) * r
            })
            .collect()
    }

    #[test]
    fn the_smallest_ring_around_each_point_is_found() {
        let mut rings = vec![star(0.0, 0.0, 40.0, 9)];
        for i in 0..100 {
            let (x, y) = (f64::from(i % 10), f64::from(i / 10));
            rings.push(star(6.1 * x - 27.0, 5.7 * y - 26.0, 2.5, 7));
            rings.push(star(6.1 * x - 27.0, 5.7 * y - 26.0, 1.1, 5));
        }
        let nest = Nest::new(rings.iter());
        for i in 0..2500 {
            let p = DVec2::new(f64::from(i % 50), f64::from(i / 50));
            let p = p * 1.83 - 45.07;
            let expected = (0..rings.len())
                .filter(|&k| ring_contains(&rings[k], p))
                .min_by(|&a, &b| {
                    let content = |k: usize| signed_area(&rings[k]);
                    content(a).total_cmp(&content(b))
                });
            assert_eq!(nest.around(p), expected, "{p}");
        }
    }

    #[test]
    fn nothing_is_around_a_point_without_rings() {
        let none: [Ring; 0] = [];
        assert_eq!(Nest::new(none.iter()).around(DVec2::ZERO), None);
        let flat = [vec![DVec2::ZERO, DVec2::X]];
        assert_eq!(Nest::new(flat.iter()).around(DVec2::ZERO), None);
    }
}
