//! Areas and volumes by the field itself, without outlines.
//!
//! In: the field. Out: how much of a plane or of space is inside, and how far
//! off that may be. The lengths of straight lines inside the part are added up.
//! Between two samples the field is taken for linear to find a crossing. The
//! uncertainty follows from the differences between groups of lines, each
//! evenly spread over the whole part.
//!
//! Not guaranteed: that details thinner than the distance of samples are seen.

use super::ReportError;
use glam::DVec3;
use isoslice_base::parallel;
use isoslice_base::timings::{Stage, Timings};
use isoslice_base::units::{Mm, Mm2, Mm3};
use isoslice_model::Probe;
use isoslice_planar::Rect;

/// Samples along a line, at most.
const MOST_SAMPLES: f64 = 4096.0;
/// Groups of lines whose results are compared, for a volume.
const GROUPS: usize = 8;
/// Groups of lines whose results are compared, for an area. Their number and
/// that of the lines are odd: otherwise the halves of a symmetric part would
/// agree whatever the error.
const ROW_GROUPS: usize = 3;

/// Length of the line along x at `y`, `z` that is inside.
fn inside(
    probe: &Probe,
    (from, to): (Mm, Mm),
    (y, z): (Mm, Mm),
    pitch: Mm,
) -> Result<Mm, ReportError> {
    // The part's box encloses the part, so the ends of the line are outside.
    let count = ((to - from) / pitch).ceil().clamp(8.0, MOST_SAMPLES);
    let step = (to - from) / count;
    let x: Vec<f32> = (0..=count as usize)
        .map(|i| (from + step * i as f64) as f32)
        .collect();
    let (y, z) = (vec![y as f32; x.len()], vec![z as f32; x.len()]);
    let f = probe.values(&x, &y, &z)?;
    let value = |k: usize| f.get(k).copied().map(f64::from);
    // The share of the way from one sample, which is inside, to the next one,
    // which is outside. `beyond` is the value at the sample after them.
    let part = |inside: f64, outside: f64, beyond: Option<f64>| {
        // A field that is 0 all over its outside does not tell.
        let tells = outside != 0.0 || beyond != Some(0.0);
        let t = inside / (inside - outside);
        if tells && t.is_finite() { t } else { 0.5 }
    };
    let share = |(k, pair): (usize, &[f32])| {
        let (a, b) = (f64::from(pair[0]), f64::from(pair[1]));
        match (a < 0.0, b < 0.0) {
            (true, true) => 1.0,
            (true, false) => part(a, b, value(k + 2)),
            (false, true) => part(b, a, k.checked_sub(1).and_then(value)),
            (false, false) => 0.0,
        }
    };
    Ok(step * f.windows(2).enumerate().map(share).sum::<f64>())
}

/// Mean of the results of groups of equal size, and how far it may be off: two
/// standard errors.
fn mean_of_groups(groups: &[f64]) -> (f64, f64) {
    let n = groups.len() as f64;
    let mean = groups.iter().sum::<f64>() / n;
    let square: f64 = groups.iter().map(|g| (g - mean).powi(2)).sum();
    (mean, 2.0 * (square / (n * (n - 1.0))).sqrt())
}

/// Area inside in the plane at height `z`, by about `lines` lines, and its
/// uncertainty.
///
/// # Errors
/// If the evaluator fails, which is a bug.
pub(super) fn content(
    probe: &Probe,
    frame: Rect,
    z: Mm,
    lines: usize,
    pitch: Mm,
) -> Result<(Mm2, Mm2), ReportError> {
    let per_group = lines.div_ceil(ROW_GROUPS) | 1;
    let rows = per_group * ROW_GROUPS;
    let height = frame.max.y - frame.min.y;
    let mut sums = [0.0; ROW_GROUPS];
    for row in 0..rows {
        let y = frame.min.y + height * (row as f64 + 0.5) / rows as f64;
        let length = inside(probe, (frame.min.x, frame.max.x), (y, z), pitch)?;
        sums[row % ROW_GROUPS] += length;
    }
    Ok(mean_of_groups(&sums.map(|s| s * height / per_group as f64)))
}

/// Volume inside the box from `low` to `high`, by about `lines` lines, and its
/// uncertainty. The time goes to `timings`.
///
/// # Errors
/// If the evaluator fails, which is a bug.
pub(super) fn volume(
    probe: &Probe,
    low: DVec3,
    high: DVec3,
    lines: usize,
    pitch: Mm,
    timings: &Timings,
) -> Result<(Mm3, Mm3), ReportError> {
    // An additive sequence by the powers of the plastic number, which covers
    // the plane evenly for any number of points.
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let size = high - low;
    let lines = lines.div_ceil(GROUPS).max(1) * GROUPS;
    let per_group = lines / GROUPS;
    let groups = parallel::map(GROUPS, |group| {
        timings.time(Stage::Report, || {
            let mut sum = 0.0;
            for k in 0..per_group {
                let k = (group * per_group + k) as f64 + 0.5;
                let y = low.y + size.y * (k / PLASTIC).fract();
                let z = low.z + size.z * (k / PLASTIC.powi(2)).fract();
                sum += inside(probe, (low.x, high.x), (y, z), pitch)?;
            }
            Ok(sum / per_group as f64 * size.y * size.z)
        })
    });
    let groups: Result<Vec<f64>, ReportError> = groups.into_iter().collect();
    Ok(mean_of_groups(&groups?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::Tree;
    use glam::DVec2;
    use std::f64::consts::PI;

    #[test]
    fn a_ball_and_its_middle_within_their_own_uncertainty() {
        let (x, y, z) = (Tree::x(), Tree::y(), Tree::z());
        let f = (x.clone() * x + y.clone() * y + z.clone() * z).sqrt() - 5.0;
        let probe = Probe::new(&f).unwrap();
        let frame = Rect::new(DVec2::splat(-5.0), DVec2::splat(5.0));
        let (area, error) = content(&probe, frame, 3.0, 400, 0.1).unwrap();
        assert!((area - PI * 16.0).abs() < error, "{area} ± {error}");
        assert!(error < 0.003 * area, "{error}");
        let (low, high) = (DVec3::splat(-5.0), DVec3::splat(5.0));
        let (v, error) = {
            let timings = Timings::default();
            volume(&probe, low, high, 2000, 0.1, &timings).unwrap()
        };
        let truth = PI * 4.0 / 3.0 * 125.0;
        assert!((v - truth).abs() < error, "{v} ± {error}, {truth}");
        assert!(error < 0.01 * truth, "{error}");
    }
}
