//! Where a field is not a number, and which operation makes it so.

use super::SearchOptions;
use crate::cancel::Cancel;
use crate::program::{Program, Scratch};

/// How much of a field is NaN.
pub(super) struct Undefined {
    /// Share of the points that are NaN.
    pub share: f64,
    /// What makes the field NaN at the first of these points.
    pub cause: Option<String>,
}

/// Looks at points all over what is searched, near the origin and far away.
pub(super) fn undefined(
    program: &Program,
    options: &SearchOptions,
    cancel: &Cancel,
    scratch: &mut Scratch,
) -> Undefined {
    /// Distances of the points if the search has no bounds.
    const FAR: [f64; 4] = [0.9, 11.0, 130.0, 7_000.0];
    /// Points along each axis, as shares of the way. None is in a plane of
    /// symmetry.
    const AT: [f64; 5] = [-0.93, -0.48, 0.04, 0.53, 0.97];
    let frames: Vec<[[f64; 2]; 3]> = match options.within {
        Some(b) => {
            let (lo, hi) = (b.min.to_array(), b.max.to_array());
            let half = |i: usize| 0.5 * (hi[i] - lo[i]);
            vec![std::array::from_fn(|i| [lo[i] + half(i), half(i)])]
        }
        None => FAR.iter().map(|&far| [[0.0, far]; 3]).collect(),
    };
    let (mut points, mut without) = (0.0, 0.0);
    let mut cause = None;
    for frame in frames {
        for n in 0..AT.len().pow(3) {
            if cancel.is_asked() {
                break;
            }
            let at = [n % 5, n / 5 % 5, n / 25].map(|i| AT[i]);
            let point: [f64; 3] =
                std::array::from_fn(|i| frame[i][0] + at[i] * frame[i][1]);
            points += 1.0;
            if program.value(point, scratch).is_nan() {
                without += 1.0;
                cause = cause.or_else(|| program.why_nan(point, scratch));
            }
            // A program that takes long is not looked at any further.
            if scratch.work > 2 * options.max_work {
                break;
            }
        }
    }
    Undefined {
        share: without / points,
        cause,
    }
}
