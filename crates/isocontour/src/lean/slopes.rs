//! How level surfaces are, by the ranges of their slopes.

use crate::interval::Interval;
use crate::program::Surface;

/// What is known of the surface in a box.
pub(super) struct Known {
    /// Range of the greatest |n_z| among all that is not exactly level.
    pub least: f64,
    pub most: f64,
    pub level: Vec<Surface>,
}

/// The lean of some surfaces. If the surfaces are not known, it may be
/// anything.
pub(super) fn known(surfaces: Option<Vec<Surface>>) -> Known {
    let mut known = Known {
        least: 0.0,
        most: 0.0,
        level: Vec::new(),
    };
    let Some(surfaces) = surfaces else {
        known.most = 1.0;
        return known;
    };
    let mut least: f64 = 1.0;
    for surface in surfaces {
        let [x, y, z] = surface.slope;
        let is_zero = |g: Interval| g == Interval::ZERO;
        if is_zero(x) && is_zero(y) && !is_zero(z) {
            known.level.push(surface);
            continue;
        }
        let (low, high) = vertical(x, y, z);
        if high > known.most {
            known.most = high;
            least = low;
        } else if high == known.most {
            least = least.min(low);
        }
    }
    known.least = least.min(known.most);
    known
}

/// Range of |n_z|, given the ranges of the slopes.
fn vertical(x: Interval, y: Interval, z: Interval) -> (f64, f64) {
    if z == Interval::ZERO {
        return (0.0, 0.0);
    }
    let sane = |g: Interval| !g.nan && !g.is_empty();
    if !(sane(x) && sane(y) && sane(z)) {
        return (0.0, 1.0);
    }
    let smallest = |g: Interval| g.lo.max(-g.hi).max(0.0);
    let share = |up: f64, along: f64| match up {
        0.0 => 0.0,
        up => up / along.hypot(up),
    };
    let most = share(z.magnitude(), smallest(x).hypot(smallest(y)));
    let least = share(smallest(z), x.magnitude().hypot(y.magnitude()));
    let number =
        |v: f64, otherwise: f64| if v.is_nan() { otherwise } else { v };
    (number(least, 0.0), number(most, 1.0))
}
