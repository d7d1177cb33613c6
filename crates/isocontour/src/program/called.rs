//! Calls of data, over boxes.

use super::slot::Slot;
use crate::data::{Data, range_over, slopes_over};
use glam::DVec3;

/// The value of data at a place; NaN where the place is none.
pub(super) fn value(data: &dyn Data, at: [f64; 3]) -> f64 {
    let p = DVec3::from_array(at);
    if p.is_finite() {
        data.value(p)
    } else {
        f64::NAN
    }
}

/// What is known of data over a box of places.
pub(super) fn over(data: &dyn Data, at: [Slot; 3]) -> Slot {
    let places = at.map(|slot| slot.range);
    let by = slopes_over(data, places);
    // The chain rule.
    let slope = [0, 1, 2].map(|axis| {
        let [x, y, z] = [0, 1, 2].map(|i| by[i].mul(at[i].slope[axis]));
        x.add(y).add(z)
    });
    Slot {
        range: range_over(data, places),
        centre: value(data, at.map(|slot| slot.centre)),
        slope,
    }
}
