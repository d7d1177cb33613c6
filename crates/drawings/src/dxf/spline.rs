//! Splines (NURBS) as cubic curves.
//!
//! Between two knots a spline is one piece, whose ends and ways at them a cubic
//! curve takes over. If the piece is a polynomial of degree 3 at most, that is the
//! piece itself. Others are halved until the cubic is close to them.

use super::pairs::Record;
use super::pen::Pen;
use crate::outline::Outline;
use glam::{DVec2, DVec3};
use isoslice_base::problem::{Problem, go_on};

/// The greatest degree, of which programs make none greater.
const MOST_DEGREE: usize = 10;

/// How far a curve may be from the truth, as a share of the spline's size: as far
/// as curves are from arcs.
const ACCURACY: f64 = 1e-7;

/// How often a piece is halved at most. Of one that is turned by its weights at a
/// point, 4096 parts are left, and then it is refused.
const DEEPEST: u32 = 12;

struct Spline {
    degree: usize,
    knots: Vec<f64>,
    /// Control points times their weights, and the weights.
    control: Vec<DVec3>,
    line: usize,
    accuracy: f64,
}

/// The line of a spline.
pub(super) fn spline(record: &Record<'_>, mut pen: Pen) -> Problem<Outline> {
    Spline::read(record)?.draw(&mut pen)?;
    Ok(pen.line())
}

impl Spline {
    fn read(record: &Record<'_>) -> Problem<Spline> {
        let wrong = |what: &str| Err(format!("line {}: {what}", record.line));
        let (mut knots, mut weights) = (Vec::new(), Vec::new());
        let mut points: Vec<DVec2> = Vec::new();
        for pair in record.pairs() {
            match (pair.code, points.last_mut()) {
                (40, _) => knots.push(pair.number()?),
                (41, _) => weights.push(pair.number()?),
                (10, _) => {
                    go_on()?;
                    points.push(DVec2::new(pair.number()?, 0.0));
                }
                (20, Some(point)) => point.y = pair.number()?,
                _ => {}
            }
        }
        if points.is_empty() {
            return wrong(
                "a SPLINE has no control points, and its other points do not \
                 tell its way exactly; let the program write control points, or \
                 turn it into a polyline",
            );
        }
        let degree = record.integer(71)?.unwrap_or(3);
        let Some(degree) = usize::try_from(degree)
            .ok()
            .filter(|n| (1..=MOST_DEGREE).contains(n))
        else {
            return wrong(&format!(
                "a SPLINE is of degree {degree}; from 1 to {MOST_DEGREE} are \
                 read"
            ));
        };
        if points.len() <= degree
            || knots.len() != points.len() + degree + 1
            || knots.windows(2).any(|w| w[0] > w[1])
        {
            return wrong("the knots of a SPLINE do not fit its points");
        }
        if weights.is_empty() {
            weights.resize(points.len(), 1.0);
        }
        if weights.len() != points.len() || weights.iter().any(|w| *w <= 0.0) {
            return wrong("the weights of a SPLINE do not fit its points");
        }
        let [min, max] = [DVec2::min, DVec2::max]
            .map(|f| points.iter().copied().fold(points[0], f));
        let weighed = |(p, w): (&DVec2, &f64)| (*p * *w).extend(*w);
        Ok(Spline {
            degree,
            knots,
            control: points.iter().zip(&weights).map(weighed).collect(),
            line: record.line,
            accuracy: ACCURACY * (max - min).length(),
        })
    }

    fn draw(&self, pen: &mut Pen) -> Problem<()> {
        let mut end = None;
        for span in self.degree..self.control.len() {
            let [from, to] = [self.knots[span], self.knots[span + 1]];
            if from < to {
                let start = self.at(span, from).0;
                self.go_to(pen, start, end)?;
                self.piece(pen, span, [from, to], DEEPEST)?;
                end = Some(self.at(span, to).0);
            }
        }
        Ok(())
    }

    /// Begins the spline, or checks that it goes on where it was.
    fn go_to(
        &self,
        pen: &mut Pen,
        start: DVec2,
        end: Option<DVec2>,
    ) -> Problem<()> {
        match end {
            None => pen.move_to(start),
            Some(end) if end.distance(start) > self.accuracy => {
                return Err(format!(
                    "line {}: a SPLINE is broken at a knot, beyond which it \
                     goes on elsewhere; split it there into two",
                    self.line
                ));
            }
            Some(_) => {}
        }
        Ok(())
    }

    /// Goes along a part of a piece.
    fn piece(
        &self,
        pen: &mut Pen,
        span: usize,
        [from, to]: [f64; 2],
        deep: u32,
    ) -> Problem<()> {
        let third = (to - from) / 3.0;
        let ((a, out), (d, back)) = (self.at(span, from), self.at(span, to));
        let (b, c) = (a + out * third, d - back * third);
        let off = |share: f64| {
            let cubic = {
                let rest = 1.0 - share;
                let [p, q, r] =
                    [(a, b), (b, c), (c, d)].map(|(p, q)| p * rest + q * share);
                (p * rest + q * share) * rest + (q * rest + r * share) * share
            };
            self.at(span, from + (to - from) * share).0.distance(cubic)
        };
        let far = [0.25, 0.5, 0.75].map(off);
        if far.iter().all(|far| *far <= self.accuracy) {
            return pen.cubic_to(b, c, d);
        }
        let middle = 0.5 * (from + to);
        if !far.iter().all(|far| far.is_finite()) {
            return Err(format!(
                "line {}: a SPLINE has numbers that are too great or too small \
                 to be read; turn it into a polyline",
                self.line
            ));
        }
        if deep == 0 {
            return Err(format!(
                "line {}: a SPLINE turns too sharply to be read; turn it into \
                 a polyline",
                self.line
            ));
        }
        self.piece(pen, span, [from, middle], deep - 1)?;
        self.piece(pen, span, [middle, to], deep - 1)
    }

    /// The place and the derivative at a parameter of a span (de Boor's way).
    fn at(&self, span: usize, u: f64) -> (DVec2, DVec2) {
        let n = self.degree;
        let mut row = [DVec3::ZERO; MOST_DEGREE + 1];
        row[..=n].copy_from_slice(&self.control[span - n..=span]);
        let mut slope = DVec3::ZERO;
        for level in 1..=n {
            for j in (level..=n).rev() {
                let low = self.knots[span - n + j];
                let high = self.knots[span + 1 + j - level];
                let share = (u - low) / (high - low);
                if level == n {
                    slope = (row[j] - row[j - 1]) * (n as f64 / (high - low));
                }
                row[j] = row[j - 1] * (1.0 - share) + row[j] * share;
            }
        }
        let place = row[n].truncate() / row[n].z;
        (place, (slope.truncate() - place * slope.z) / row[n].z)
    }
}
