//! What all searches for a direction of lines have in common.
//!
//! In: an area, and what a direction costs. Out: lines to judge a direction by,
//! and the best direction. Near a corner any slanting line is short, so the
//! shortest lines must not decide. A direction is judged by the value that the
//! share [`COMMON`] of the lines' length stays below.

use glam::DVec2;
use isoslice_base::units::{Degrees, Mm};
use isoslice_planar::Area;
use isoslice_planar::hatch::Lines;

/// How lines run over a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// Across it, in a direction.
    Across(Degrees),
    /// Along its border.
    Around,
}

/// Step of the fan of angles.
const FAN: Degrees = 7.5;

/// Share of the lines' length that counts.
const COMMON: f64 = 0.75;

/// A fan of angles, which are tried besides those that an area suggests.
pub(super) fn fan() -> impl Iterator<Item = Degrees> {
    (0..(180.0 / FAN) as usize).map(|i| i as f64 * FAN)
}

/// The direction across another one.
pub(super) fn across(angle: Degrees) -> Degrees {
    (angle + 90.0).rem_euclid(180.0)
}

/// The direction with the least cost, and the cost. Of equally good directions
/// it is the first one.
pub(super) fn best(
    costs: impl Iterator<Item = (Mm, Degrees)>,
) -> Option<(Mm, Degrees)> {
    costs.reduce(|best, next| {
        // A direction that is better by rounding alone does not win.
        let better = next.0 < best.0 * (1.0 - 1e-3);
        if better { next } else { best }
    })
}

/// Lines in a direction all over an area: about `rows` of them, but no nearer
/// to one another than half of `width`.
pub(super) fn rows(area: &Area, angle: Degrees, rows: f64, width: Mm) -> Lines {
    let along = DVec2::from_angle(angle.to_radians());
    let v = area.rings.iter().flatten().map(|p| along.perp().dot(*p));
    let (low, high) = v.fold((f64::INFINITY, f64::NEG_INFINITY), |r, v| {
        (r.0.min(v), r.1.max(v))
    });
    let spacing = ((high - low) / rows).max(0.5 * width);
    Lines {
        angle,
        spacing,
        phase: low + 0.5 * spacing,
    }
}

/// The value that the share [`COMMON`] of the lines' length stays below. Each
/// value comes with the length that has it.
pub(super) fn common(mut values: Vec<(Mm, Mm)>) -> Option<Mm> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: Mm = values.iter().map(|(_, length)| length).sum();
    let mut below = 0.0;
    let common = values.into_iter().find(|(_, length)| {
        below += length;
        below >= COMMON * total
    });
    common.map(|(value, _)| value)
}
