//! What tests of several files need.

use glam::DVec3;
use isocontour::{Bounds, Data};

/// Looks at random boxes within a box: are values and derivatives at random
/// points of each in the bounds? Boxes are of all sizes down to points.
pub(crate) fn bounds_hold(data: &dyn Data, within: Bounds, boxes: usize) {
    let mut random = fastrand::Rng::with_seed(7);
    let mut checked = 0;
    for _ in 0..boxes {
        let point = |random: &mut fastrand::Rng| {
            let t = DVec3::from_array(std::array::from_fn(|_| random.f64()));
            within.min + t * within.size()
        };
        let centre = point(&mut random);
        let size = DVec3::from_array(std::array::from_fn(|_| {
            match random.u32(0..8) {
                0 => 0.0,
                _ => 10_f64.powf(-4.0 * random.f64()),
            }
        }));
        let half = 0.5 * size * within.size();
        let over = Bounds {
            min: centre - half,
            max: centre + half,
        };
        let [least, most] = data.range(&over);
        let slopes = data.slopes(&over);
        for n in 0..8 {
            let t = DVec3::from_array(std::array::from_fn(|_| match n {
                0 => 0.0,
                1 => 1.0,
                _ => random.f64(),
            }));
            let p = (over.min + t * over.size()).clamp(over.min, over.max);
            let (value, slope) = data.at(p);
            assert!(
                least <= value && value <= most,
                "{value} at {p} is not in {least}..{most} over {over:?}"
            );
            for (axis, [least, most]) in slopes.iter().enumerate() {
                assert!(
                    (least..=most).contains(&&slope[axis]),
                    "slope {slope} at {p} is not in {slopes:?} over {over:?}"
                );
            }
            checked += 1;
        }
    }
    assert_eq!(checked, 8 * boxes);
}
