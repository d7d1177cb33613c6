//! Brim ears: discs at the sharp corners of the first layer, where parts come
//! off the bed first.
//!
//! ```text
//!    ╭───╮              ╭───╮
//!    │ ┌─┼──────────────┼─┐ │     There is a disc around each convex corner
//!    ╰─┼─╯  part        ╰─┼─╯     that is sharper than brim.ear_angle, as far
//!      │                  │       as it lies outside of the part.
//! ```

use super::{BrimPlan, TOLERANCE, inwards};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::spacing;
use isoslice_planar::clip::{difference, unite};
use isoslice_planar::offset::offset;
use isoslice_planar::simplify::simplify;
use isoslice_planar::{Area, Ring, signed_area};

/// Least height of a corner's tip, mm. Corners with a lower tip are round.
const ROUND: Mm = 0.1;
/// Corners of a disc's polygon.
const SIDES: u32 = 48;

/// The loops that fill the ears of a part with this outline, from outside to
/// inside, one ear after another.
pub(super) fn ears(outline: &Area, height: Mm, plan: &BrimPlan) -> Vec<Ring> {
    let radius = plan.strip;
    let disc = |middle: DVec2| -> Ring {
        let step = std::f64::consts::TAU / f64::from(SIDES);
        let corner = |k| DVec2::from_angle(f64::from(k) * step) * radius;
        (0..SIDES).map(|k| middle + corner(k)).collect()
    };
    let discs: Vec<Ring> = corners(outline, plan.ear_angle)
        .into_iter()
        .map(disc)
        .collect();
    if discs.is_empty() {
        return Vec::new();
    }
    // Ears are outside the part: holes stay free.
    let outer = outline.rings.iter().filter(|r| signed_area(r) > 0.0);
    let without_holes = unite(&outer.cloned().collect());
    let kept_free = offset(&without_holes, plan.gap, TOLERANCE);
    let area = difference(&unite(&Area { rings: discs }), &kept_free);
    let width = plan.width;
    let step = spacing(width, width, height);
    let mut levels: Vec<Vec<Ring>> = Vec::new();
    let mut depth = 0.5 * width;
    loop {
        if isoslice_base::limits::is_stopped() {
            return inwards(levels);
        }
        let level = offset(&area, -depth, TOLERANCE).rings;
        if level.is_empty() {
            return inwards(levels);
        }
        levels.push(level);
        depth += step;
    }
}

/// The convex corners of an area that are sharper than an angle, in degrees.
pub(super) fn corners(outline: &Area, angle: f64) -> Vec<DVec2> {
    let turn = (180.0 - angle).to_radians();
    let mut found = Vec::new();
    for ring in outline.rings.iter().filter(|r| signed_area(r) > 0.0) {
        let ring = simplify(ring, ROUND);
        let n = ring.len();
        if n < 3 {
            continue;
        }
        for i in 0..n {
            let [a, b, c] = [i + n - 1, i, i + 1].map(|k| ring[k % n]);
            if (b - a).angle_to(c - b) > turn {
                found.push(b);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::shapes::{disc, rect};
    use isoslice_settings::testing::plan_with;

    #[test]
    fn sharp_convex_corners_get_ears_and_others_none() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        // An L, with one corner that is concave and one that is cut.
        let ring = vec![
            at(0.0, 0.0),
            at(18.0, 0.0),
            at(20.0, 2.0),
            at(20.0, 10.0),
            at(10.0, 10.0),
            at(10.0, 20.0),
            at(0.0, 20.0),
        ];
        let area = Area::from(ring);
        assert_eq!(corners(&area, 125.0).len(), 4);
        assert_eq!(corners(&area, 140.0).len(), 6);
        assert_eq!(corners(&area, 80.0).len(), 0);
        // A round part has no corners.
        let round = disc(6.0, 200);
        assert!(corners(&round, 125.0).is_empty());
    }

    #[test]
    fn ears_fill_their_discs_outside_of_the_part() {
        let plan = plan_with(BrimPlan::of, |s| {
            s.brim.width = 4.0;
            s.brim.gap = 0.1;
        });
        let part = rect(0.0, 0.0, 30.0, 20.0);
        let loops = ears(&part, 0.2, &plan);
        let length: f64 = loops
            .iter()
            .map(|r| isoslice_planar::path_length(r, true))
            .sum();
        // Three quarters of each of four discs are filled with lines of 0.407
        // mm.
        let exact = 4.0 * 0.75 * std::f64::consts::PI * 16.0 / 0.407;
        assert!((length / exact - 1.0).abs() < 0.08, "{length} of {exact}");
        let near = offset(&part, 0.1 + 0.2, 1e-3);
        let inside = loops.iter().flatten().any(|&p| near.contains(p));
        assert!(!inside);
    }

    #[test]
    fn ears_leave_holes_free() {
        let plan = plan_with(BrimPlan::of, |s| s.brim.width = 4.0);
        let solid = rect(0.0, 0.0, 30.0, 20.0);
        let mut part = solid.clone();
        // A hole lies within reach of a corner.
        part.rings.extend(rect(1.0, 1.0, 12.0, 12.0).rings);
        part.rings[1].reverse();
        let loops = ears(&part, 0.2, &plan);
        assert_eq!(loops, ears(&solid, 0.2, &plan));
    }
}
