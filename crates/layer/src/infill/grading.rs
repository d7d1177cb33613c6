//! A density that varies over a layer.
//!
//! The expression is evaluated on a lattice over the area, and interpolated
//! linearly in x and y between the nodes, since a density varies over
//! millimetres.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Rect;
use isoslice_planar::border::LinePiece;

/// The share of the plane to be filled, 0 to 1, over a layer's area.
#[derive(Clone, Debug)]
pub(super) struct Grading {
    origin: DVec2,
    step: Mm,
    size: [usize; 2],
    shares: Vec<f64>,
}

/// Distance of the lattice's nodes, mm; they are closer in small areas.
const NODE_STEP: Mm = 1.0;
/// Least and greatest number of nodes along the longer side of an area.
const SIDE: (f64, f64) = (40.0, 1024.0);
/// Least distance of the nodes, mm.
const FINEST: Mm = 0.2;

impl Grading {
    /// The shares within `bounds`. `eval` gives their percentage at some
    /// points.
    ///
    /// # Errors
    /// The errors of `eval`.
    pub(super) fn new<E>(
        bounds: Rect,
        eval: impl FnOnce(&[DVec2], &mut Vec<f64>) -> Result<(), E>,
    ) -> Result<Grading, E> {
        let extent = bounds.size();
        let side = extent.max_element();
        let step = NODE_STEP.min(side / SIDE.0).max(FINEST).max(side / SIDE.1);
        let size =
            [extent.x, extent.y].map(|side| (side / step).ceil() as usize + 2);
        let mut points = Vec::with_capacity(size[0] * size[1]);
        for j in 0..size[1] {
            for i in 0..size[0] {
                let node = DVec2::new(i as f64, j as f64) * step;
                points.push(bounds.min + node);
            }
        }
        let mut shares = Vec::with_capacity(points.len());
        eval(&points, &mut shares)?;
        for share in &mut shares {
            *share = (*share / 100.0).clamp(0.0, 1.0);
        }
        Ok(Grading {
            origin: bounds.min,
            step,
            size,
            shares,
        })
    }

    /// Distance of the lattice's nodes.
    pub(super) fn step(&self) -> Mm {
        self.step
    }

    /// The greatest share.
    pub(super) fn most(&self) -> f64 {
        self.shares.iter().fold(0.0, |a, &b| f64::max(a, b))
    }

    /// The mean share over the box.
    pub(super) fn mean(&self) -> f64 {
        let sum: f64 = self.shares.iter().sum();
        sum / (self.shares.len() as f64).max(1.0)
    }

    /// The share at a point; beyond the box it is the share at the box's side.
    pub(super) fn share(&self, p: DVec2) -> f64 {
        let q = (p - self.origin) / self.step;
        let last =
            DVec2::new((self.size[0] - 1) as f64, (self.size[1] - 1) as f64);
        let q = q.clamp(DVec2::ZERO, last);
        let (i, j) = (
            (q.x as usize).min(self.size[0] - 2),
            (q.y as usize).min(self.size[1] - 2),
        );
        let (u, v) = (q.x - i as f64, q.y - j as f64);
        let k = j * self.size[0] + i;
        let at = |k: usize| self.shares[k];
        let low = at(k) + u * (at(k + 1) - at(k));
        let k = k + self.size[0];
        let high = at(k) + u * (at(k + 1) - at(k));
        low + v * (high - low)
    }

    /// The parts of a closed ring where the share is more than `limit`.
    pub(super) fn above(
        &self,
        ring: &[DVec2],
        limit: f64,
        pieces: &mut Vec<LinePiece>,
    ) {
        // Points are added to the ring until they are close enough for the
        // share to be read at them.
        let mut points: Vec<DVec2> = Vec::new();
        for (a, b) in isoslice_planar::edges(ring) {
            let count = (a.distance(b) / self.step).ceil().max(1.0);
            let between = 0..count as usize;
            points.extend(between.map(|k| a.lerp(b, k as f64 / count)));
        }
        let over: Vec<f64> =
            points.iter().map(|&p| self.share(p) - limit).collect();
        let n = points.len();
        let Some(start) = over.iter().position(|&f| f <= 0.0) else {
            return pieces.push(LinePiece::inner(points, true));
        };
        let mut run: Vec<DVec2> = Vec::new();
        for k in start..start + n {
            let (i, j) = (k % n, (k + 1) % n);
            let (f, g) = (over[i], over[j]);
            if f > 0.0 {
                run.push(points[i]);
            }
            if (f > 0.0) == (g > 0.0) {
                continue;
            }
            run.push(points[i].lerp(points[j], f / (f - g)));
            if f > 0.0 {
                pieces.push(LinePiece::inner(std::mem::take(&mut run), false));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Grading {
        let bounds = Rect::new(DVec2::ZERO, DVec2::new(10.0, 5.0));
        let made = Grading::new(bounds, |points, out| {
            out.extend(points.iter().map(|p| 10.0 * p.x));
            Ok::<(), ()>(())
        });
        made.unwrap()
    }

    #[test]
    fn linear_between_the_nodes_and_level_beyond() {
        let grading = ramp();
        for (x, share) in [(3.3, 0.33), (9.99, 0.999), (-4.0, 0.0)] {
            let found = grading.share(DVec2::new(x, 2.2));
            assert!((found - share).abs() < 1e-9, "{x}: {found}");
        }
        assert_eq!(grading.share(DVec2::new(50.0, 99.0)), 1.0);
        assert_eq!(grading.most(), 1.0);
    }

    #[test]
    fn rings_are_cut_where_the_limit_is_passed() {
        let ring: Vec<DVec2> = [(2.0, 1.0), (8.0, 1.0), (8.0, 4.0), (2.0, 4.0)]
            .map(DVec2::from)
            .to_vec();
        let mut pieces = Vec::new();
        ramp().above(&ring, 0.45, &mut pieces);
        assert_eq!(pieces.len(), 1);
        let length = isoslice_planar::path_length(&pieces[0].points, false);
        assert!((length - (2.0 * 3.5 + 3.0)).abs() < 1e-9, "{length}");
        pieces.clear();
        ramp().above(&ring, 0.1, &mut pieces);
        assert!(pieces.len() == 1 && pieces[0].closed);
        pieces.clear();
        ramp().above(&ring, 0.9, &mut pieces);
        assert!(pieces.is_empty());
    }
}
