//! The border as rings.
//!
//! Each edge is gone along with the inside to its left. Where edges end, any
//! that begins there goes on: all ways to join them go round the same places.

use super::{Area, Edge};
use crate::curve::Curve;
use glam::{DAffine2, DVec2};
use isocontour::Ring;

/// How far rings may be from the curves, mm.
const FLAT: f64 = 0.0005;

/// The most points of a curve.
const MOST_POINTS: f64 = 4096.0;

impl Edge {
    /// Its curve with the inside to the left.
    fn along(&self) -> Curve {
        let curve = self.piece.curve;
        if self.out > 0.0 {
            curve
        } else {
            curve.reversed()
        }
    }
}

impl Area {
    /// The edges of each ring, one after the other. None if they do not close.
    pub(super) fn chains(&self) -> Option<Vec<Vec<u32>>> {
        let starts: Vec<DVec2> =
            self.edges.iter().map(|e| e.along().start()).collect();
        let mut order: Vec<u32> = (0..starts.len() as u32).collect();
        order.sort_by(|a, b| {
            let x = |i: &u32| starts[*i as usize].x;
            x(a).total_cmp(&x(b)).then(a.cmp(b))
        });
        let mut used = vec![false; starts.len()];
        let mut chains = Vec::new();
        for first in 0..starts.len() {
            if used[first] {
                continue;
            }
            let mut chain = Vec::new();
            let mut edge = first;
            loop {
                used[edge] = true;
                chain.push(edge as u32);
                let end = self.edges[edge].along().end();
                // The ring is closed where it can be.
                if (end - starts[first]).length() <= self.near {
                    break;
                }
                edge = self.next(&order, &starts, &used, end)?;
            }
            chains.push(chain);
        }
        Some(chains)
    }

    /// The edge that begins nearest to a point.
    fn next(
        &self,
        order: &[u32],
        starts: &[DVec2],
        used: &[bool],
        end: DVec2,
    ) -> Option<usize> {
        let at = |i: &u32| starts[*i as usize];
        let from = order.partition_point(|i| at(i).x < end.x - self.near);
        let free = order[from..]
            .iter()
            .take_while(|i| at(i).x <= end.x + self.near)
            .filter(|i| !used[**i as usize])
            .map(|i| ((at(i) - end).length(), *i))
            .filter(|(far, _)| *far <= self.near);
        let nearest = free.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, i)| i as usize)
    }

    /// The rings after a map, of straight lines close to the curves.
    pub(crate) fn rings(&self, by: DAffine2) -> Option<Vec<Ring>> {
        let chains = self.chains.get_or_init(|| self.chains()).as_ref()?;
        let mirrored = by.matrix2.determinant() < 0.0;
        let ring = |chain: &Vec<u32>| {
            let mut ring = Vec::new();
            for edge in chain {
                let curve = self.edges[*edge as usize].along();
                let curve = curve.map(|p| by.transform_point2(p));
                flatten(&curve, &mut ring);
            }
            if mirrored {
                ring.reverse();
            }
            ring
        };
        Some(chains.iter().map(ring).collect())
    }
}

/// Appends points of a curve but for its end.
fn flatten(curve: &Curve, ring: &mut Ring) {
    // A chord of a share 1/n is at most |B''| / 8n² away.
    let control = curve.control();
    let bend = control
        .windows(3)
        .map(|w| (w[0] - 2.0 * w[1] + w[2]).length())
        .fold(0.0, f64::max);
    let n = curve.degree() as f64;
    let parts = (bend * n * (n - 1.0) / (8.0 * FLAT)).sqrt().ceil();
    let parts = parts.clamp(1.0, MOST_POINTS) as u32;
    for i in 0..parts {
        ring.push(curve.at(f64::from(i) / f64::from(parts)));
    }
}
