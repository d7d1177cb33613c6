//! Which edges of a grid may be near to a point, asked about several edges at
//! once.
//!
//! In: a grid's edges, in the order of its cells. Out: of a row of cells the
//! edges that may be within some distance of a point. Coordinates are kept in
//! single precision, in which any processor works on four of them at once. The
//! sieve allows for all that this precision can blur, so it leaves out no edge
//! within the distance. It may let through an edge that is a hair farther away,
//! so the caller has to measure each edge.

use crate::units::Mm;
use glam::{DVec2, Vec4};

/// Number of edges that are asked about at once.
pub(super) const LANES: usize = 4;

/// The bits of [`LANES`] edges.
const ALL: u32 = (1 << LANES) - 1;

/// What single precision loses of coordinates, and of the sum of two, as a
/// share of the largest: four times half a unit in the last place of each.
const BLUR: f64 = 5e-7;
/// What single precision loses of squares and their products.
const LOST: f32 = 4e-6;

/// The edges' ends, relative to the grid's corner.
#[derive(Clone, Debug, Default)]
pub(super) struct Sieve {
    ax: Vec<f32>,
    ay: Vec<f32>,
    bx: Vec<f32>,
    by: Vec<f32>,
    origin: DVec2,
    /// The largest coordinate.
    extent: Mm,
}

/// A place around which edges are looked for.
pub(super) struct Query {
    x: f32,
    y: f32,
    /// Added to the square of a distance for what is blurred.
    pad: f64,
}

/// A box, ready to be compared with the boxes of edges.
pub(super) struct Frame {
    lo: [Vec4; 2],
    hi: [Vec4; 2],
}

/// Calls `visit` with the numbers of the bits of `near`, counted from `k`, that
/// are less than `end`, as long as `visit` returns true. False if `visit`
/// returned false.
#[inline(always)]
pub(super) fn each(
    mut near: u32,
    k: usize,
    end: usize,
    mut visit: impl FnMut(usize) -> bool,
) -> bool {
    while near != 0 {
        let i = k + near.trailing_zeros() as usize;
        near &= near - 1;
        if i < end && !visit(i) {
            return false;
        }
    }
    true
}

impl Sieve {
    /// The sieve of `count` edges that lie within `size` of `origin`.
    pub(super) fn new(
        edges: impl Iterator<Item = (DVec2, DVec2)>,
        count: usize,
        origin: DVec2,
        size: DVec2,
    ) -> Sieve {
        // Some are added beyond the last, so that the last few are read as a
        // full group.
        let lane = || vec![0.0; count + LANES];
        let mut sieve = Sieve {
            ax: lane(),
            ay: lane(),
            bx: lane(),
            by: lane(),
            origin,
            extent: size.max_element(),
        };
        let ends = [&mut sieve.ax, &mut sieve.ay, &mut sieve.bx, &mut sieve.by];
        let [ax, ay, bx, by] = ends.map(|lane| lane.iter_mut());
        let lanes = ax.zip(ay).zip(bx.zip(by));
        for ((a, b), ((ax, ay), (bx, by))) in edges.zip(lanes) {
            let (a, b) = (a - origin, b - origin);
            (*ax, *ay) = (a.x as f32, a.y as f32);
            (*bx, *by) = (b.x as f32, b.y as f32);
        }
        sieve
    }

    /// What coordinates may be off by, if they are within the edges' bounds or
    /// as far from the sieve's origin as `p`.
    fn blur(&self, p: DVec2) -> Mm {
        BLUR * self.extent.max(p.abs().max_element())
    }

    /// Prepares to ask what is in the box from `lo` to `hi`.
    pub(super) fn frame(&self, lo: DVec2, hi: DVec2) -> Frame {
        let (lo, hi) = (lo - self.origin, hi - self.origin);
        let blur = self.blur(lo).max(self.blur(hi));
        let lanes = |x: Mm| Vec4::splat(x as f32);
        Frame {
            lo: [lanes(lo.x - blur), lanes(lo.y - blur)],
            hi: [lanes(hi.x + blur), lanes(hi.y + blur)],
        }
    }

    /// The edges from the `k`th on whose boxes may meet the frame: a bit for
    /// each of up to [`LANES`] edges, the first edge the lowest.
    #[inline(always)]
    pub(super) fn meets(&self, k: usize, frame: &Frame) -> u32 {
        let lanes = |all: &[f32]| Vec4::from_slice(&all[k..k + LANES]);
        let beside = |a: Vec4, b: Vec4, lo: Vec4, hi: Vec4| {
            // The ends are compared one by one, not their minimum and maximum,
            // because a comparison with NaN is false.
            (a.cmpgt(hi) & b.cmpgt(hi)) | (a.cmplt(lo) & b.cmplt(lo))
        };
        let (lo, hi) = (frame.lo, frame.hi);
        let x = beside(lanes(&self.ax), lanes(&self.bx), lo[0], hi[0]);
        let y = beside(lanes(&self.ay), lanes(&self.by), lo[1], hi[1]);
        !(x | y).bitmask() & ALL
    }

    /// Prepares to ask what is within `reach`, or less, of `p`.
    pub(super) fn query(&self, p: DVec2, reach: Mm) -> Query {
        let p = p - self.origin;
        let blur = self.blur(p);
        Query {
            x: p.x as f32,
            y: p.y as f32,
            pad: blur * (2.0 * reach + blur),
        }
    }

    /// The edges from the `k`th on that may be within the root of `limit` of a
    /// place: a bit for each of up to [`LANES`] edges, the first edge the
    /// lowest.
    #[inline(always)]
    pub(super) fn near(&self, k: usize, query: &Query, limit: f64) -> u32 {
        let lanes = |all: &[f32]| Vec4::from_slice(&all[k..k + LANES]);
        let (ax, ay) = (lanes(&self.ax), lanes(&self.ay));
        let (u, v) = (lanes(&self.bx) - ax, lanes(&self.by) - ay);
        let (x, y) = (query.x - ax, query.y - ay);
        let length = u * u + v * v;
        let t = x * u + y * v;
        let inside = t.max(Vec4::ZERO).min(length);
        // The square of the distance, times the square of the length, is the
        // difference of these two: no division is needed.
        let whole = (x * x + y * y) * length;
        let along = inside * (t + t - inside) + whole * LOST;
        let limit = Vec4::splat((limit + query.pad) as f32);
        !(whole - along).cmpgt(length * limit).bitmask() & ALL
    }
}

#[cfg(test)]
mod tests {
    use super::super::nearest_on;
    use super::*;

    /// Edges of all lengths, far from the origin, and one without length.
    fn edges() -> Vec<(DVec2, DVec2)> {
        let corner = DVec2::new(1200.0, -700.0);
        (0..400)
            .map(|i| {
                let i = f64::from(i);
                let a = DVec2::new((37.0 * i) % 19.3, (53.0 * i) % 17.9);
                let by = DVec2::from_angle(i) * 10f64.powf(i % 9.0 - 7.0);
                (corner + a, corner + a + by)
            })
            .chain([(corner, corner)])
            .collect()
    }

    #[test]
    fn nothing_near_is_left_out_and_little_else_let_through() {
        let all = edges();
        let (lo, hi) = all.iter().fold(
            (DVec2::INFINITY, DVec2::NEG_INFINITY),
            |(lo, hi), (a, b)| (lo.min(*a).min(*b), hi.max(*a).max(*b)),
        );
        let sieve = Sieve::new(all.iter().copied(), all.len(), lo, hi - lo);
        for i in 0..40 {
            let p = lo + DVec2::new(f64::from(i), f64::from(i * 7 % 40)) * 0.55;
            let (from, to) = (p - 0.4, p + 0.7);
            let frame = sieve.frame(from, to);
            for k in (0..all.len()).step_by(LANES) {
                for (i, (a, b)) in all[k..].iter().take(LANES).enumerate() {
                    let far = p.distance(nearest_on(p, *a, *b));
                    // At the very distance and just below it.
                    for reach in [far, far * (1.0 - 1e-9)] {
                        let query = sieve.query(p, reach);
                        let near = sieve.near(k, &query, far * far);
                        assert!(near & 1 << i != 0, "{a} {b} {p}");
                    }
                    // An edge that single precision takes for a point is as
                    // near as any.
                    let reach = (0.9 * far - 0.1).max(0.0);
                    let query = sieve.query(p, reach);
                    let near = sieve.near(k, &query, reach * reach);
                    let tiny = a.distance(*b) < 1e-3;
                    let let_through = near & 1 << i != 0;
                    assert!(!let_through || tiny || far < 0.2, "{a} {b} {p}");
                    let apart = a.min(*b).cmpgt(to) | a.max(*b).cmplt(from);
                    let meets = sieve.meets(k, &frame) & 1 << i != 0;
                    assert!(meets || apart.any());
                }
            }
        }
    }

    #[test]
    fn what_is_no_number_is_let_through() {
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            let edge = (DVec2::ZERO, DVec2::new(bad, 1.0));
            let size = DVec2::new(bad, 1.0);
            let one = std::iter::once(edge);
            let sieve = Sieve::new(one, 1, DVec2::ZERO, size);
            let query = sieve.query(DVec2::splat(3.0), 0.1);
            assert_eq!(sieve.near(0, &query, 0.01) & 1, 1, "{bad}");
            let frame = sieve.frame(DVec2::splat(0.5), DVec2::splat(3.0));
            assert_eq!(sieve.meets(0, &frame) & 1, 1, "{bad}");
        }
    }
}
