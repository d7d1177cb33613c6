//! Path data, such as `M0 0h5a2 2 0 0 1 2 2z`.

use crate::curve::Curve;
use crate::outline::{Fill, Outline};
use crate::stroke::Strand;
use glam::{DAffine2, DVec2};
use svgtypes::{PathParser, PathSegment};

/// Lines of a path, each of which may be closed.
#[derive(Clone, Debug, Default)]
pub(super) struct Path {
    pub(super) strands: Vec<Strand>,
    at: DVec2,
}

impl Path {
    pub(super) fn move_to(&mut self, p: DVec2) {
        self.strands.push(Strand {
            start: p,
            ..Strand::default()
        });
        self.at = p;
    }

    fn push(&mut self, control: &[DVec2]) {
        // After a ring is closed, the next begins where it began.
        if self.strands.last().is_none_or(|s| s.closed) {
            self.move_to(self.at);
        }
        if let Some(strand) = self.strands.last_mut() {
            let curve = Curve::new(control);
            self.at = curve.end();
            strand.curves.push(curve);
        }
    }

    pub(super) fn line_to(&mut self, p: DVec2) {
        self.push(&[self.at, p]);
    }

    pub(super) fn close(&mut self) {
        if let Some(strand) = self.strands.last_mut() {
            strand.closed = true;
            self.at = strand.start;
        }
    }

    /// Its area, if it is filled.
    pub(super) fn filled(&self, fill: Fill) -> Outline {
        let mut outline = Outline::new(fill);
        for strand in &self.strands {
            outline.move_to(strand.start);
            for curve in &strand.curves {
                outline.push(curve.control());
            }
        }
        outline.close();
        outline
    }

    /// Adds an outline that is one ring.
    pub(super) fn ring(&mut self, outline: &Outline) {
        let Some(first) = outline.curves().first() else {
            return;
        };
        self.move_to(first.start());
        for curve in outline.curves() {
            self.push(curve.control());
        }
        self.close();
    }

    /// Reads path data, up to the first mistake. Returns whether there is one.
    pub(super) fn parse(text: &str) -> (Path, bool) {
        let mut path = Path::default();
        // The control point of the last curve, for curves that go on smoothly.
        let mut last: (DVec2, usize) = (DVec2::ZERO, 0);
        for segment in PathParser::from(text) {
            let Ok(segment) = segment else {
                return (path, true);
            };
            last = path.segment(segment, last);
        }
        (path, false)
    }

    /// Draws a segment. Returns its last control point and its degree.
    fn segment(
        &mut self,
        segment: PathSegment,
        (control, degree): (DVec2, usize),
    ) -> (DVec2, usize) {
        let at = self.at;
        let place = |abs: bool, x: f64, y: f64| {
            let p = DVec2::new(x, y);
            if abs { p } else { at + p }
        };
        let smooth = |of: usize| {
            if degree == of { 2.0 * at - control } else { at }
        };
        match segment {
            PathSegment::MoveTo { abs, x, y } => {
                self.move_to(place(abs, x, y));
            }
            PathSegment::LineTo { abs, x, y } => {
                self.line_to(place(abs, x, y));
            }
            PathSegment::HorizontalLineTo { abs, x } => {
                let x = if abs { x } else { at.x + x };
                self.line_to(DVec2::new(x, at.y));
            }
            PathSegment::VerticalLineTo { abs, y } => {
                let y = if abs { y } else { at.y + y };
                self.line_to(DVec2::new(at.x, y));
            }
            PathSegment::CurveTo {
                abs,
                x1,
                y1,
                x2,
                y2,
                x,
                y,
            } => {
                let b = place(abs, x2, y2);
                self.push(&[at, place(abs, x1, y1), b, place(abs, x, y)]);
                return (b, 3);
            }
            PathSegment::SmoothCurveTo { abs, x2, y2, x, y } => {
                let b = place(abs, x2, y2);
                self.push(&[at, smooth(3), b, place(abs, x, y)]);
                return (b, 3);
            }
            PathSegment::Quadratic { abs, x1, y1, x, y } => {
                let a = place(abs, x1, y1);
                self.push(&[at, a, place(abs, x, y)]);
                return (a, 2);
            }
            PathSegment::SmoothQuadratic { abs, x, y } => {
                let a = smooth(2);
                self.push(&[at, a, place(abs, x, y)]);
                return (a, 2);
            }
            PathSegment::EllipticalArc {
                abs,
                rx,
                ry,
                x_axis_rotation,
                large_arc,
                sweep,
                x,
                y,
            } => self.arc(
                DVec2::new(rx, ry).abs(),
                x_axis_rotation,
                [large_arc, sweep],
                place(abs, x, y),
            ),
            PathSegment::ClosePath { .. } => self.close(),
        }
        (DVec2::ZERO, 0)
    }

    /// An arc of an ellipse to a point, as SVG describes it (appendix B.2 of
    /// SVG 2).
    fn arc(
        &mut self,
        radii: DVec2,
        degrees: f64,
        [large, sweep]: [bool; 2],
        to: DVec2,
    ) {
        let from = self.at;
        if from == to {
            return;
        }
        if radii.min_element() <= 0.0 {
            self.line_to(to);
            return;
        }
        let angle = degrees.to_radians();
        let turn = DVec2::new(libm::cos(angle), libm::sin(angle));
        // Where the ellipse is a circle of radius 1.
        let half = turn.conjugate_rotate(0.5 * (from - to)) / radii;
        let far = half.length();
        let (radii, half) = if far > 1.0 {
            (radii * far, half / far)
        } else {
            (radii, half)
        };
        let across = (1.0 / half.length_squared() - 1.0).max(0.0).sqrt();
        let side = if large == sweep { -across } else { across };
        let centre = -half.perp() * side;
        let start = half - centre;
        let end = -half - centre;
        let mut by = libm::atan2(start.perp_dot(end), start.dot(end));
        if sweep && by < 0.0 {
            by += std::f64::consts::TAU;
        } else if !sweep && by > 0.0 {
            by -= std::f64::consts::TAU;
        }
        let begins = libm::atan2(start.y, start.x);
        let axes = [turn * radii.x, turn.perp() * radii.y];
        let middle =
            0.5 * (from + to) + axes[0] * centre.x + axes[1] * centre.y;
        let ellipse = DAffine2::from_cols(axes[0], axes[1], middle);
        let mut arc = Outline::new(Fill::NonZero);
        arc.move_to(from);
        arc.arc(ellipse, begins, by);
        let mut curves = arc.curves().to_vec();
        if let Some(last) = curves.last_mut() {
            last.end_at(to);
        }
        for curve in curves {
            self.push(curve.control());
        }
        self.at = to;
    }
}

/// Turning back.
trait Rotate {
    fn conjugate_rotate(self, v: DVec2) -> DVec2;
}

impl Rotate for DVec2 {
    /// `v` turned back by the angle whose cosine and sine these are.
    fn conjugate_rotate(self, v: DVec2) -> DVec2 {
        DVec2::new(self.dot(v), self.perp_dot(v))
    }
}
