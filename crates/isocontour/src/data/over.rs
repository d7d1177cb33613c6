//! What is known of data over boxes.

use super::Data;
use crate::cuboid::Bounds;
use crate::interval::Interval;
use glam::DVec3;

/// The box of places at which data is asked; none if there is no such place.
fn places(at: [Interval; 3]) -> Option<Bounds> {
    let some = at.iter().all(|r| !r.is_empty());
    some.then(|| Bounds {
        min: DVec3::from_array(at.map(|r| r.lo)),
        max: DVec3::from_array(at.map(|r| r.hi)),
    })
}

/// The range of data over a box of places.
pub(crate) fn range_over(data: &dyn Data, at: [Interval; 3]) -> Interval {
    let nan = at.iter().any(|r| r.nan);
    match places(at) {
        Some(over) => {
            let [lo, hi] = data.range(&over);
            Interval::new(lo, hi).or_nan(nan)
        }
        None => Interval::EMPTY,
    }
}

/// The ranges of the derivatives of data over a box of places.
pub(crate) fn slopes_over(data: &dyn Data, at: [Interval; 3]) -> [Interval; 3] {
    match places(at) {
        Some(over) if at.iter().all(|r| !r.nan) => {
            data.slopes(&over).map(|[lo, hi]| Interval::new(lo, hi))
        }
        _ => [Interval::ANYTHING; 3],
    }
}
