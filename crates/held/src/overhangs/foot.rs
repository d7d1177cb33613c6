//! Whether a part stands firmly enough on the bed for its height.
//!
//! ```text
//!      ← pull      The nozzle pulls at the top of what is printed. What sticks
//!      ┌┐          to the bed must bear the moment of this pull about the foot:
//!      ││          pull × height.
//!     ─┴┴─ foot
//! ```
//!
//! A foot bends like the root of a beam, so its edge comes off first. It bears
//! a moment of bond × W, where W is the least section modulus of what lies on
//! the bed: the second moment of area about an axis through the middle, over
//! the distance of the farthest edge from that axis. For a square of side b
//! that is b³/(6·√2), over its corners. So a square twice as wide holds a part
//! eight times as high.
//!
//! In: the outline of the first layer, its brim, and the pads on which the layers
//! right above it lie. Out: its [`Foot`]. Where the brim meets a pad, the pad counts.
//!
//! Not known: the bed, the material, and how strongly the nozzle pulls. This
//! module takes round figures for them. A part that is higher than they allow
//! has a reason for a brim, which is no proof that it falls. Bodies that stand
//! apart count as one.

use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_layer::adhesion::{BrimPlan, brim};
use isoslice_planar::{Area, edges};

/// Tension that a well-set first layer bears at its edge, N/mm²: about half
/// of what is measured for warm PLA.
const BOND: f64 = 0.25;
/// Pull of the nozzle at the top of a thin part, N.
const PULL: f64 = 0.1;
/// Axes that are tried, over half a turn.
const AXES: u32 = 36;

/// What a part stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Content of what lies on the bed, brim and pads included.
    pub area: Mm2,
    /// Greatest height that the foot holds.
    pub holds: Mm,
}

impl Foot {
    /// True if the foot holds less than 1 mm, about the first layers of any part:
    /// its figure would be told as 0.
    pub fn holds_nothing(&self) -> bool {
        self.holds < 1.0
    }
}

/// Moments of area about the origin: of order 0, 1 and 2.
#[derive(Default)]
struct Moments {
    content: f64,
    first: DVec2,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Moments {
    /// Adds the triangle from the origin to `a` and `b`, signed.
    fn triangle(&mut self, a: DVec2, b: DVec2) {
        let twice = a.perp_dot(b);
        self.content += 0.5 * twice;
        self.first += twice / 6.0 * (a + b);
        let second = |p: DVec2| (p.x * p.x, p.x * p.y, p.y * p.y);
        // The mean of a square over a triangle is a twelfth of the sum of the
        // squares of its corners and of their sum.
        for (xx, xy, yy) in [second(a), second(b), second(a + b)] {
            self.xx += twice / 24.0 * xx;
            self.xy += twice / 24.0 * xy;
            self.yy += twice / 24.0 * yy;
        }
    }

    /// Adds a piece of bead as if it were in one place.
    fn point(&mut self, p: DVec2, content: f64) {
        self.content += content;
        self.first += p * content;
        self.xx += content * p.x * p.x;
        self.xy += content * p.x * p.y;
        self.yy += content * p.y * p.y;
    }

    /// The second moment of the distances from an axis through the middle. `n`
    /// is at right angles to the axis.
    fn about(&self, middle: DVec2, n: DVec2) -> f64 {
        let all = n.x * n.x * self.xx
            + 2.0 * n.x * n.y * self.xy
            + n.y * n.y * self.yy;
        all - self.content * middle.dot(n).powi(2)
    }
}

impl Foot {
    /// The foot of a part whose first layer, `height` high, has this outline,
    /// and stands on these pads beside it, and on the brim of a plan; none if
    /// nothing lies on the bed.
    pub fn new(
        outline: &Area,
        pads: &Area,
        height: Mm,
        plan: &BrimPlan,
    ) -> Option<Foot> {
        let rings = || outline.rings.iter().chain(&pads.rings);
        let origin = *rings().next()?.first()?;
        let mut moments = Moments::default();
        for (a, b) in rings().flat_map(|r| edges(r)) {
            moments.triangle(a - origin, b - origin);
        }
        let mut rim: Vec<(DVec2, Mm)> =
            rings().flatten().map(|p| (*p - origin, 0.0)).collect();
        for bead in brim(outline, height, plan) {
            let half = 0.5 * bead.stroke.width;
            for (a, b) in edges(&bead.stroke.points) {
                if pads.contains(a.midpoint(b)) {
                    continue;
                }
                let (a, b) = (a - origin, b - origin);
                moments.point(a.midpoint(b), a.distance(b) * bead.stroke.width);
                rim.push((a, half));
            }
        }
        if moments.content <= 0.0 {
            return None;
        }
        let middle = moments.first / moments.content;
        let modulus = (0..AXES).map(|k| {
            let turn = std::f64::consts::PI * f64::from(k) / f64::from(AXES);
            let n = DVec2::from_angle(turn);
            let away =
                |(p, half): &(DVec2, Mm)| (*p - middle).dot(n).abs() + half;
            let farthest = rim.iter().map(away).fold(0.0, f64::max);
            moments.about(middle, n) / farthest.max(1e-9)
        });
        let modulus = modulus.fold(f64::INFINITY, f64::min);
        Some(Foot {
            area: moments.content,
            holds: BOND / PULL * modulus.max(0.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::shapes::{circle, rect};
    use isoslice_settings::BrimPlace;
    use isoslice_settings::testing::{plan_with, usual_plan};

    fn usual() -> BrimPlan {
        usual_plan(BrimPlan::of)
    }

    fn holds(outline: &Area) -> Mm {
        Foot::new(outline, &Area::EMPTY, 0.2, &usual())
            .unwrap()
            .holds
    }

    #[test]
    fn a_foot_holds_by_its_section_modulus() {
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a}");
        // A square, wherever it is, has b³/(6·√2), over a corner.
        let square = |b: f64| 2.5 * b.powi(3) / 6.0 / 2.0_f64.sqrt();
        near(holds(&rect(0.0, 0.0, 3.0, 3.0)), square(3.0));
        near(holds(&rect(70.0, 90.0, 76.0, 96.0)), square(6.0));
        // A strip that falls straight to its side has b·h²/6.
        let strip = 2.5 * 40.0 * 4.0 / 6.0;
        let found = holds(&rect(0.0, 0.0, 40.0, 2.0));
        assert!((0.5 * strip..=1.001 * strip).contains(&found), "{found}");
        // Two legs hold each other in one direction only.
        let mut legs = rect(0.0, 0.0, 3.0, 3.0);
        legs.rings.extend(rect(20.0, 0.0, 23.0, 3.0).rings);
        let found = holds(&legs);
        assert!(found < 2.5 * 9.001 && found > square(3.0), "{found}");
        let none = &Area::EMPTY;
        assert_eq!(Foot::new(none, none, 0.2, &usual()), None);
    }

    #[test]
    fn pads_on_both_sides_of_an_edge_count() {
        let plan = usual();
        let pads = Area::from_iter([
            rect(-9.0, -1.0, 9.0, -0.4),
            rect(-9.0, 0.4, 9.0, 1.0),
        ]);
        let edge = rect(-9.0, -0.1, 9.0, 0.1);
        let foot = |outline: &Area, pads: &Area| {
            Foot::new(outline, pads, 0.2, &plan).unwrap()
        };
        let [none, alone] = [&Area::EMPTY, &edge].map(|o| foot(o, &pads));
        assert!((none.area - 21.6).abs() < 1e-9, "{none:?}");
        assert!((alone.area - 25.2).abs() < 1e-9, "{alone:?}");
        // Two strips that fall straight to a side hold as one of their width
        // would, less the gap in the middle: b·(h³ − g³)/(6·h).
        let exact = 2.5 * 18.0 * (8.0 - 0.8_f64.powi(3)) / 12.0;
        assert!((0.5..=1.001).contains(&(none.holds / exact)), "{none:?}");
        assert!(none.holds > 50.0 * foot(&edge, &Area::EMPTY).holds);
    }

    #[test]
    fn a_ring_of_a_vase_holds_much_and_a_brim_helps() {
        let mut hole = circle(29.0, 200);
        hole.reverse();
        let vase = Area::from_iter([circle(30.0, 200), hole]);
        assert!(holds(&vase) > 5000.0);
        let pin = rect(0.0, 0.0, 3.0, 3.0);
        let wide = plan_with(BrimPlan::of, |s| s.brim.place = BrimPlace::Outer);
        let foot = Foot::new(&pin, &Area::EMPTY, 0.2, &wide).unwrap();
        // A brim of 5 mm makes 13 mm of 3 mm, round at the corners.
        let square = 2.5 * 13.0_f64.powi(3) / 6.0;
        assert!((0.4..1.05).contains(&(foot.holds / square)), "{foot:?}");
        // Pads in the place of the brim count once.
        let mut pads = rect(-9.0, -9.0, 12.0, 12.0);
        pads.rings.extend(pin.rings.iter().map(|ring| {
            let mut hole = ring.clone();
            hole.reverse();
            hole
        }));
        let foot = Foot::new(&pin, &pads, 0.2, &wide).unwrap();
        assert!((foot.area - 441.0).abs() < 1e-6, "{foot:?}");
    }
}
