//! Outlines as they are drawn: rings of lines and curves.

use crate::curve::Curve;
use glam::{DAffine2, DVec2};

/// What is inside rings that cross or hold one another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fill {
    /// What the rings go round, in sum.
    #[default]
    NonZero,
    /// What is within an odd number of rings.
    EvenOdd,
}

/// Rings of lines and curves that are filled together.
///
/// Coordinates are in mm, y upwards, once it is given to a
/// [`Drawing`](crate::Drawing).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    curves: Vec<Curve>,
    start: DVec2,
    at: DVec2,
    pub(crate) fill: Fill,
    /// Whether it cuts away from what was drawn before it.
    pub(crate) cuts: bool,
    /// The windows, by their numbers, in all of which it is seen.
    pub(crate) seen_in: Vec<u32>,
    /// The window of which it is a part, if it is not drawn itself.
    pub(crate) window: Option<u32>,
}

impl Outline {
    /// An outline without rings.
    pub fn new(fill: Fill) -> Outline {
        Outline {
            fill,
            ..Outline::default()
        }
    }

    /// Begins a ring. The ring before it is closed.
    pub fn move_to(&mut self, p: DVec2) {
        self.close();
        (self.start, self.at) = (p, p);
    }

    pub(crate) fn push(&mut self, control: &[DVec2]) {
        let curve = Curve::new(control);
        self.at = curve.end();
        if control.iter().any(|p| *p != control[0]) {
            self.curves.push(curve);
        }
    }

    /// Goes straight to a point.
    pub fn line_to(&mut self, p: DVec2) {
        self.push(&[self.at, p]);
    }

    /// Goes to `p` along a quadratic curve.
    pub fn quad_to(&mut self, a: DVec2, p: DVec2) {
        self.push(&[self.at, a, p]);
    }

    /// Goes to `p` along a cubic curve.
    pub fn cubic_to(&mut self, a: DVec2, b: DVec2, p: DVec2) {
        self.push(&[self.at, a, b, p]);
    }

    /// Goes along an arc of an ellipse: the image of the unit circle under
    /// `ellipse`, from one angle by another, radians.
    ///
    /// Cubic curves of at most a sixteenth of a turn stand for it, which are
    /// within 7·10⁻⁸ radii of it: 0.007 µm at 100 mm.
    pub fn arc(&mut self, ellipse: DAffine2, from: f64, by: f64) {
        let parts = (by.abs() * 8.0 / std::f64::consts::PI).ceil();
        let parts = parts.clamp(1.0, 64.0) as u32;
        let step = by / f64::from(parts);
        let way = libm::tan(step / 4.0) * 4.0 / 3.0;
        let on = |angle: f64| DVec2::new(libm::cos(angle), libm::sin(angle));
        for i in 0..parts {
            let a = on(from + step * f64::from(i));
            let b = on(from + step * f64::from(i + 1));
            let [a1, b1, b] = [a + a.perp() * way, b - b.perp() * way, b]
                .map(|p| ellipse.transform_point2(p));
            self.cubic_to(a1, b1, b);
        }
    }

    /// Goes along a curve. A straight line leads to its start if that is farther
    /// away than `near`; if not, it begins where the last one ends.
    pub(crate) fn along(&mut self, curve: &Curve, near: f64) {
        let mut control = curve.control().to_vec();
        if self.at.distance(curve.start()) > near {
            self.line_to(curve.start());
        }
        control[0] = self.at;
        self.push(&control);
    }

    /// Closes the ring with a straight line, if its ends are apart.
    pub fn close(&mut self) {
        // Arcs end where they should but for rounding.
        self.close_within(1e-12 * (1.0 + self.start.length()));
    }

    /// Closes the ring with a straight line, or if its ends are within `near` by
    /// moving the last.
    pub(crate) fn close_within(&mut self, near: f64) {
        if self.at == self.start {
            return;
        }
        match self.curves.last_mut() {
            Some(last) if self.at.distance(self.start) < near => {
                last.end_at(self.start);
            }
            _ => self.line_to(self.start),
        }
        self.at = self.start;
    }

    /// A circle or an ellipse.
    pub fn ellipse(&mut self, centre: DVec2, radii: DVec2) {
        let ellipse =
            DAffine2::from_scale_angle_translation(radii, 0.0, centre);
        self.move_to(centre + DVec2::new(radii.x, 0.0));
        self.arc(ellipse, 0.0, std::f64::consts::TAU);
        self.close();
    }

    /// A rectangle.
    pub fn rectangle(&mut self, min: DVec2, max: DVec2) {
        self.move_to(min);
        self.line_to(DVec2::new(max.x, min.y));
        self.line_to(max);
        self.line_to(DVec2::new(min.x, max.y));
        self.close();
    }

    /// Moved, turned, scaled.
    pub fn mapped(&self, by: DAffine2) -> Outline {
        let map = |p| by.transform_point2(p);
        Outline {
            curves: self.curves.iter().map(|c| c.map(map)).collect(),
            start: map(self.start),
            at: map(self.at),
            fill: self.fill,
            cuts: self.cuts,
            seen_in: self.seen_in.clone(),
            window: self.window,
        }
    }

    /// Adds the rings of another outline.
    pub fn append(&mut self, other: &Outline) {
        self.close();
        self.curves.extend(&other.curves);
        (self.start, self.at) = (other.start, other.at);
        self.close();
    }

    /// How many lines and curves it has.
    pub fn len(&self) -> usize {
        self.curves.len()
    }

    /// Whether nothing is drawn.
    pub fn is_empty(&self) -> bool {
        self.curves.is_empty()
    }

    /// Its lines and curves, in rings.
    pub(crate) fn curves(&self) -> &[Curve] {
        &self.curves
    }

    pub(crate) fn into_curves(self) -> Vec<Curve> {
        self.curves
    }
}
