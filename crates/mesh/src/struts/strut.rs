//! One strut: a cone between two places, with an end at each.
//!
//! A strut is round, so its distance is that in the plane of its axis and the
//! place: along the axis, and away from it.
//!
//! ```text
//!              cap            side                cap
//!           .-‾‾‾|‾‾‾‾‾‾----------------______|
//!          /     |r₀                          |r₁   Butt: a flat end
//!         |      |                            |
//!   - - - ┼ - - -a - - - - - - - - - - - - - -b - - along the axis
//!     Hemisphere, Sphere: round. A sphere at the thicker end of a cone also
//!     stands out of its side, and the side begins where it comes out of it.
//! ```

use glam::{DAffine3, DVec2, DVec3};
use isocontour::Bounds;

/// How a strut ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cap {
    /// Half a ball, outwards.
    Hemisphere,
    /// A ball.
    Sphere,
    /// A flat end.
    Butt,
}

/// A cone between two places, mm, with its ends. One whose ends are one place
/// is a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strut {
    /// The middles of its ends.
    pub ends: [DVec3; 2],
    /// Its radii there.
    pub radii: [f64; 2],
    /// How it ends there.
    pub caps: [Cap; 2],
}

/// A distance in the plane of the axis and a place, negative inside, and its
/// gradient there: along the axis, and away from it.
type Found = (f64, DVec2);

/// A strut in the plane: it lies from 0 to `length` on the axis.
#[derive(Clone, Copy)]
struct Profile {
    length: f64,
    radii: [f64; 2],
    caps: [Cap; 2],
}

impl Strut {
    /// A ball.
    pub fn ball(centre: DVec3, radius: f64) -> Strut {
        Strut {
            ends: [centre; 2],
            radii: [radius; 2],
            caps: [Cap::Sphere; 2],
        }
    }

    /// The distance of a place, negative inside.
    pub(super) fn distance(&self, p: DVec3) -> f64 {
        if self.is_round() {
            return p.distance(self.on_axis(p)) - self.radii[0];
        }
        let (at, profile, _) = self.in_plane(p);
        profile.nearest(at).0
    }

    /// A number that the distance of a place is not below, but for rounding: what
    /// is within the thickest radius of the axis holds the strut. It costs a tenth
    /// of the distance itself.
    pub(super) fn at_least(&self, p: DVec3) -> f64 {
        p.distance(self.on_axis(p)) - self.thickest()
    }

    /// The distance of a place, and its gradient. On the axis, where there are
    /// many, the gradient is one of them.
    pub(super) fn distance_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let (at, profile, [along, away]) = self.in_plane(p);
        let (distance, gradient) = if self.is_round() {
            let way = at - DVec2::new(at.x.clamp(0.0, profile.length), 0.0);
            let out = way.try_normalize().unwrap_or(DVec2::Y);
            (way.length() - self.radii[0], out)
        } else {
            profile.nearest(at)
        };
        (distance, along * gradient.x + away * gradient.y)
    }

    /// True if it is all that is within its radius of its axis.
    fn is_round(&self) -> bool {
        let [a, b] = self.ends;
        self.radii[0] == self.radii[1]
            && (a == b || !self.caps.contains(&Cap::Butt))
    }

    /// True if it is convex, and its distance, too.
    pub(super) fn is_convex(&self) -> bool {
        self.is_round() || self.caps == [Cap::Butt; 2]
    }

    /// Its thickest radius: no place of it is deeper.
    pub(super) fn thickest(&self) -> f64 {
        self.radii[0].max(self.radii[1])
    }

    /// The place of the axis that is closest to another one.
    fn on_axis(&self, p: DVec3) -> DVec3 {
        let [a, b] = self.ends;
        let way = b - a;
        let square = way.length_squared();
        let t = if square > 0.0 {
            ((p - a).dot(way) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        a + t * way
    }

    /// The way from the closest place of the axis, if that is the gradient's. It
    /// changes by no more than the place does.
    pub(super) fn way_from_axis(&self, p: DVec3) -> Option<DVec3> {
        self.is_round().then(|| p - self.on_axis(p))
    }

    /// A place in the plane, the strut there, and the plane's axes.
    fn in_plane(&self, p: DVec3) -> (DVec2, Profile, [DVec3; 2]) {
        let [a, b] = self.ends;
        let length = a.distance(b);
        let along = (b - a).try_normalize().unwrap_or(DVec3::Z);
        let t = (p - a).dot(along);
        let side = p - a - t * along;
        let away = side
            .try_normalize()
            .unwrap_or_else(|| along.any_orthonormal_vector());
        let profile = Profile {
            length,
            radii: self.radii,
            caps: self.caps,
        };
        (DVec2::new(t, side.length()), profile, [along, away])
    }

    /// The box around it where `seen` puts it.
    pub(super) fn extent(&self, seen: &DAffine3) -> Bounds {
        let [a, b] = self.ends;
        let along = (b - a).try_normalize().unwrap_or(DVec3::Z);
        let rows = seen.matrix3.transpose();
        let mut bounds = Bounds::EMPTY;
        for e in [0, 1] {
            let out = if e == 0 { -along } else { along };
            let middle = seen.transform_point3(self.ends[e]);
            for k in 0..3 {
                let row = rows.col(k);
                let reach = |way: DVec3| self.reach(e, out, way);
                bounds.max[k] = bounds.max[k].max(middle[k] + reach(row));
                bounds.min[k] = bounds.min[k].min(middle[k] - reach(-row));
            }
        }
        bounds
    }

    /// How far an end reaches from its middle in some way, times its length.
    fn reach(&self, end: usize, out: DVec3, way: DVec3) -> f64 {
        let is_ball = match self.caps[end] {
            Cap::Sphere => true,
            Cap::Hemisphere => way.dot(out) >= 0.0,
            Cap::Butt => self.ends[0] == self.ends[1],
        };
        let across = if is_ball {
            way
        } else {
            way - way.dot(out) * out
        };
        self.radii[end] * across.length()
    }
}

impl Profile {
    /// The distance of a place of the plane.
    fn nearest(&self, at: DVec2) -> Found {
        match self.side() {
            Some(side) => self.surface(at, side),
            None => self.parts(at),
        }
    }

    /// The strut as it is seen from one of its ends: along the axis, inwards.
    fn from(&self, end: usize, at: DVec2) -> DVec2 {
        let x = if end == 0 { at.x } else { self.length - at.x };
        DVec2::new(x, at.y)
    }

    /// A direction from the view of an end, as it is along the axis.
    fn back(&self, end: usize, way: DVec2) -> DVec2 {
        let x = if end == 0 { way.x } else { -way.x };
        DVec2::new(x, way.y)
    }

    /// Where the side begins and ends. None if it is hidden, or if an end
    /// reaches to the other one: then the strut is shorter than it is thick.
    fn side(&self) -> Option<[DVec2; 2]> {
        let mut side = [DVec2::ZERO; 2];
        for (e, corner) in side.iter_mut().enumerate() {
            let radius = self.radii[e];
            let mut from = DVec2::new(0.0, radius);
            if self.caps[e] == Cap::Sphere {
                if radius >= self.length {
                    return None;
                }
                // The side is away by radius − slope · x. It leaves the ball
                // where x² + (radius − slope · x)² = radius².
                let slope = (radius - self.radii[1 - e]) / self.length;
                if slope > 0.0 {
                    from.x = 2.0 * radius * slope / (1.0 + slope * slope);
                    from.y = radius - slope * from.x;
                }
            }
            *corner = self.from(e, from);
        }
        (side[0].x < side[1].x).then_some(side)
    }

    /// True for places between the ends, below the side.
    fn is_in_cone(&self, at: DVec2) -> bool {
        let t = at.x / self.length;
        let radius = self.radii[0] + (self.radii[1] - self.radii[0]) * t;
        (0.0..=1.0).contains(&t) && at.y <= radius
    }

    /// True for places in the ball at an end, or in its half.
    fn is_in_ball(&self, end: usize, at: DVec2) -> bool {
        let from = self.from(end, at);
        let is_there = match self.caps[end] {
            Cap::Butt => false,
            Cap::Sphere => true,
            Cap::Hemisphere => from.x <= 0.0,
        };
        is_there && from.length() <= self.radii[end]
    }

    /// The distance to the pieces of the surface: the side, and two ends.
    fn surface(&self, at: DVec2, side: [DVec2; 2]) -> Found {
        let is_inside = self.is_in_cone(at)
            || self.is_in_ball(0, at)
            || self.is_in_ball(1, at);
        let sign = if is_inside { -1.0 } else { 1.0 };
        let normal = (side[1] - side[0]).perp().normalize_or(DVec2::Y);
        let mut best = to_segment(at, side, normal, sign);
        for e in [0, 1] {
            let from = self.from(e, at);
            let corner = self.from(e, side[e]);
            let found = if self.caps[e] == Cap::Butt {
                let end = [DVec2::ZERO, corner];
                Some(to_segment(from, end, DVec2::NEG_X, sign))
            } else {
                to_arc(from, corner, self.radii[e])
            };
            if let Some((distance, out)) = found
                && distance < best.0
            {
                best = (distance, self.back(e, out));
            }
        }
        (sign * best.0, best.1)
    }

    /// The least of the distances to the cone with half balls at its ends, and to
    /// whole balls. Where a ball reaches out of the cone's side, the surface may be
    /// deeper inside than that says.
    fn parts(&self, at: DVec2) -> Found {
        let halved = |cap| match cap {
            Cap::Butt => Cap::Butt,
            Cap::Sphere | Cap::Hemisphere => Cap::Hemisphere,
        };
        let half = Profile {
            caps: self.caps.map(halved),
            ..*self
        };
        let cone = [0, 1].map(|e| half.from(e, DVec2::new(0.0, self.radii[e])));
        let mut best = half.surface(at, cone);
        for e in [0, 1].into_iter().filter(|&e| self.caps[e] == Cap::Sphere) {
            let from = self.from(e, at);
            let distance = from.length() - self.radii[e];
            if distance < best.0 {
                let out = from.try_normalize().unwrap_or(DVec2::NEG_X);
                best = (distance, self.back(e, out));
            }
        }
        best
    }
}

/// The distance to a segment, and the way out there: from the segment, or to it
/// if the sign is that of places inside. On the segment that is its normal.
fn to_segment(
    at: DVec2,
    [a, b]: [DVec2; 2],
    normal: DVec2,
    sign: f64,
) -> Found {
    let way = b - a;
    let square = way.length_squared();
    let t = if square > 0.0 {
        ((at - a).dot(way) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let from = at - a - t * way;
    let distance = from.length();
    // Nearer than that, the direction is rounding.
    let least = 1e-12 * (at.abs() + a.abs() + b.abs()).max_element();
    let out = if distance > least {
        from * (sign / distance)
    } else {
        normal
    };
    (distance, out)
}

/// The distance to an arc from the axis to a corner, around the origin, and the
/// way out there. None where the
/// corner is the nearest place of it.
fn to_arc(at: DVec2, corner: DVec2, radius: f64) -> Option<Found> {
    let distance = at.length();
    let is_there = at.x * radius <= corner.x * distance;
    let out = at.try_normalize().unwrap_or(DVec2::NEG_X);
    is_there.then(|| ((distance - radius).abs(), out))
}
