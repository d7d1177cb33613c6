//! Moves vertices along their lattice edges onto f = 0.
//!
//! The root is kept between an inside and an outside point at all times
//! (Illinois variant of the regula falsi: Dowell and Jarratt 1971). So a vertex
//! never leaves its edge, and neighbouring vertices never change places. Where
//! the field jumps, has a kink or is NaN, halving takes over. A bracket
//! remembers whether the field jumps in it, since a gradient found at a jump
//! says nothing about the outline and is not used.

use super::samples::Eyes;
use crate::Length;
use crate::field::FieldError;
use glam::DVec2;

/// A place on the outline at which chords end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct End {
    /// Its place.
    pub point: DVec2,
    /// In-plane gradient of the field; zero or not finite if it says nothing.
    pub gradient: DVec2,
}

/// A vertex on its way: the root lies between `lo` and `hi`, as fractions of
/// the way from an inside node to an outside one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bracket {
    inside: DVec2,
    outside: DVec2,
    /// The height of both.
    z: f32,
    lo: f64,
    hi: f64,
    /// Field at `lo` (negative) and at `hi`. The search may halve the value at
    /// an end.
    f_lo: f64,
    f_hi: f64,
    /// Field at the ends as it was found, for telling a jump from a root.
    ends: [f64; 2],
    /// The inside point before `lo`, and the field there.
    before: [f64; 2],
    /// How steeply the field rises from the inside node, per way from node to
    /// node; NaN if that has not been asked.
    rise: f64,
    /// |f| at both ends of the whole edge.
    whole: [f64; 2],
    /// Distance from the inside node to the outside one.
    length: Length,
    /// The best estimate so far, and the estimate before it.
    t: f64,
    from: f64,
    /// The end that moved last: −1 for `lo`, 1 for `hi`.
    last: i8,
    done: bool,
}

/// Evaluations after which a vertex stays where it is. Halving alone needs
/// fewer to bring a 2 mm edge down to a nanometre.
const MAX_STEPS: usize = 30;
/// Steps by interpolation before the bracket is halved instead.
const FREE_STEPS: usize = 6;
/// Step below which a vertex has arrived. It is far less than any accuracy that
/// is asked for.
const ARRIVED: f64 = 1e-6;
/// A last step below this need not be checked if the field fell so steeply
/// before it that the next step would be below [`ARRIVED`].
const NEAR: f64 = 3e-4;
/// A first step up to this is the last one if chord and slope agree on it
/// within a tenth. On a lattice edge this leaves an error of nanometres.
const CLOSE: f64 = 3e-3;
/// Share of their first difference by which the field's values at a bracket's
/// ends still differ at a jump, however close the ends have come.
const JUMP: f64 = 0.02;

impl Bracket {
    /// A bracket between two nodes at the height `z`, one of them inside, given
    /// the field at both.
    pub(super) fn new(nodes: [DVec2; 2], field: [f32; 2], z: f32) -> Self {
        let [mut inside, mut outside] = nodes;
        let mut ends = field.map(f64::from);
        if ends[0] >= 0.0 || ends[0].is_nan() {
            std::mem::swap(&mut inside, &mut outside);
            ends.reverse();
        }
        let mut b = Bracket {
            inside,
            outside,
            z,
            lo: 0.0,
            hi: 1.0,
            f_lo: ends[0],
            f_hi: ends[1],
            ends,
            before: [f64::NAN; 2],
            rise: f64::NAN,
            whole: ends.map(f64::abs),
            length: inside.distance(outside),
            t: 0.0,
            from: 0.0,
            last: 0,
            done: false,
        };
        b.t = b.estimate();
        b
    }

    pub(super) fn point(&self) -> DVec2 {
        self.inside.lerp(self.outside, self.t)
    }

    /// True if the field does not come down to zero on both sides.
    pub(super) fn jumps(&self) -> bool {
        let rest = self.ends[0].abs() + self.ends[1].abs();
        let open = (self.hi - self.lo) * self.length;
        let falls = rest <= JUMP * (self.whole[0] + self.whole[1]);
        // The field does not come down to zero, either, if a value is NaN.
        open < ARRIVED && !falls
    }

    /// If the field comes down to zero on the inside alone, moves the estimate
    /// to the inside end, where the field's gradient says how the outline goes
    /// on. Returns true if there is no such end, although the field jumps.
    fn ends_in_a_jump(&mut self) -> bool {
        if !self.jumps() {
            return false;
        }
        let falls = self.ends[0].abs() <= JUMP * self.whole[0];
        if falls {
            self.t = self.lo;
        }
        !falls
    }

    /// Where the line through the bracket's ends is zero; the bracket's middle
    /// if the value at an end is NaN.
    fn estimate(&self) -> f64 {
        if self.f_hi == f64::INFINITY {
            return self.extrapolated();
        }
        let t = self.lo
            + (self.hi - self.lo) * (self.f_lo / (self.f_lo - self.f_hi));
        if t.is_finite() && self.f_hi.is_finite() && self.f_lo.is_finite() {
            t.clamp(self.lo, self.hi)
        } else {
            0.5 * (self.lo + self.hi)
        }
    }

    /// Where the line through the last two inside points is zero. If that is
    /// the outside end, a place just before it. If the points do not tell, the
    /// bracket's middle.
    fn extrapolated(&self) -> f64 {
        /// Distance within which two places are one, as a share of the bracket.
        const SAME: f64 = 1e-3;
        /// If the slope at the inside node leads to the outside end or beyond,
        /// the next point is tried at this share of the way there.
        const SHORTER: f64 = 0.98;
        let open = self.hi - self.lo;
        let [t, f] = self.before;
        if t.is_nan() {
            let root = self.lo - self.ends[0] / self.rise;
            return if root >= self.hi && self.hi < 1.0 {
                self.lo + SHORTER * open
            } else if root > self.lo && root < self.hi {
                root
            } else {
                self.lo + 0.5 * open
            };
        }
        let rise = (self.ends[0] - f) / (self.lo - t);
        let root = self.lo - self.ends[0] / rise;
        let edge = self.hi - 0.5 * ARRIVED / self.length;
        if (root - self.hi).abs() <= SAME * open && edge > self.lo {
            edge
        } else if root > self.lo && root < self.hi {
            root
        } else {
            self.lo + 0.5 * open
        }
    }

    /// True if only values on the inside tell where the root is.
    fn is_one_sided(&self) -> bool {
        self.f_hi == f64::INFINITY
    }

    /// Makes an estimate from the field's gradient in the inside node.
    fn leap(&mut self, gradient: DVec2) {
        self.rise = gradient.dot(self.outside - self.inside);
        self.t = self.estimate();
    }

    /// True if the first step was the last one, given the field and its
    /// gradient where the step began. That is so if the slope gives about the
    /// step that the chord gave, and if the step is so short that neither
    /// changes on the way.
    fn arrives(&mut self, f: f64, gradient: DVec2) -> bool {
        if self.done {
            return !self.jumps();
        }
        let along = gradient.dot(self.outside - self.inside);
        let newton = self.from - f / along;
        let step = (newton - self.from).abs() * self.length;
        let apart = (newton - self.t).abs() * self.length;
        let agrees = step < CLOSE && apart <= 0.1 * step;
        if agrees && self.lo <= newton && newton <= self.hi {
            self.t = newton;
            self.done = true;
        }
        self.done
    }

    /// Takes in the field's value at the estimate and makes a new one.
    fn step(&mut self, f: f64, count: usize) {
        let end = if f < 0.0 { self.f_lo } else { self.f_hi };
        // At a jump the estimate comes nearer in tiny steps from one side, but
        // the field's value does not fall.
        let falls = f.abs() <= 0.25 * end.abs();
        if f < 0.0 {
            self.before = [self.lo, self.ends[0]];
            self.lo = self.t;
            self.f_lo = f;
            self.ends[0] = f;
            if self.last == -1 {
                self.f_hi *= 0.5;
            }
            self.last = -1;
        } else {
            self.hi = self.t;
            self.f_hi = f;
            self.ends[1] = f;
            if self.last == 1 {
                self.f_lo *= 0.5;
            }
            self.last = 1;
        }
        if f == 0.0 {
            self.from = self.t;
            self.done = true;
            return;
        }
        self.from = self.t;
        self.t = if count >= FREE_STEPS {
            0.5 * (self.lo + self.hi)
        } else {
            self.estimate()
        };
        let moved = (self.t - self.from).abs() * self.length;
        let open = (self.hi - self.lo) * self.length;
        let next = moved * (f / end).abs();
        self.done = open < ARRIVED
            || (falls && (moved < ARRIVED || (moved < NEAR && next < ARRIVED)));
    }
}

/// Brings all brackets to their roots, and evaluates those on their way
/// together. Returns the roots, with the field's gradients; a gradient is zero
/// where the field jumps.
pub(super) fn refine(
    brackets: &mut [Bracket],
    eyes: &mut Eyes<'_>,
) -> Result<Vec<End>, FieldError> {
    // If the field is infinite at the outer end of a bracket, it does not tell
    // how the field rises. Two points inside would, and so does one with its
    // slope.
    let one_sided: Vec<usize> = (0..brackets.len())
        .filter(|&i| brackets[i].is_one_sided())
        .collect();
    if !one_sided.is_empty() {
        for &i in &one_sided {
            brackets[i].t = brackets[i].lo;
        }
        let slopes = slopes(brackets, eyes, one_sided.iter().copied());
        for (&i, slopes) in one_sided.iter().zip(slopes) {
            brackets[i].leap(gradient(slopes));
        }
    }
    // For most brackets the first estimate is so good that the slope there
    // leads the rest of the way, and serves as the gradient at the root.
    let first = slopes(brackets, eyes, 0..brackets.len());
    let mut gradients = Vec::with_capacity(brackets.len());
    let mut open: Vec<usize> = Vec::new();
    for (i, (b, slopes)) in brackets.iter_mut().zip(first).enumerate() {
        let (f, gradient) = (f64::from(slopes[0]), gradient(slopes));
        b.step(f, 0);
        if !b.arrives(f, gradient) {
            open.push(i);
        }
        gradients.push(gradient);
    }
    let mut active = open.clone();
    for count in 1..MAX_STEPS {
        active.retain(|&i| !brackets[i].done);
        if active.is_empty() {
            break;
        }
        ask(brackets, eyes, active.iter().copied());
        for (&i, &f) in active.iter().zip(eyes.values()?) {
            brackets[i].step(f64::from(f), count);
        }
    }
    let jumps: Vec<bool> =
        open.iter().map(|&i| brackets[i].ends_in_a_jump()).collect();
    if !open.is_empty() {
        let last = slopes(brackets, eyes, open.iter().copied());
        for ((i, jumps), slopes) in open.into_iter().zip(jumps).zip(last) {
            gradients[i] = if jumps { DVec2::ZERO } else { gradient(slopes) };
        }
    }
    let roots = brackets.iter().map(Bracket::point).zip(gradients);
    Ok(roots
        .map(|(point, gradient)| End { point, gradient })
        .collect())
}

/// Asks the field at the estimates of some brackets.
fn ask(
    brackets: &[Bracket],
    eyes: &mut Eyes<'_>,
    which: impl Iterator<Item = usize>,
) {
    eyes.clear();
    for b in which.map(|i| &brackets[i]) {
        eyes.push(b.point(), b.z);
    }
}

/// Values and slopes at the estimates of some brackets.
fn slopes<'e>(
    brackets: &[Bracket],
    eyes: &'e mut Eyes<'_>,
    which: impl Iterator<Item = usize>,
) -> &'e [[f32; 3]] {
    ask(brackets, eyes, which);
    eyes.slopes()
}

/// The gradient that a value and its slopes say.
fn gradient(&[_, dx, dy]: &[f32; 3]) -> DVec2 {
    DVec2::new(f64::from(dx), f64::from(dy))
}

#[cfg(test)]
mod tests {
    use super::super::samples::Samples;
    use super::*;
    use crate::field::{Lattice, Sampler};
    use crate::plane::Rect;

    /// Evaluates a function of x.
    struct Line<F: Fn(f32) -> f32>(F);

    impl<F: Fn(f32) -> f32> Sampler for Line<F> {
        fn values(
            &mut self,
            [x, ..]: [&[f32]; 3],
            out: &mut Vec<f32>,
        ) -> Result<(), FieldError> {
            out.clear();
            out.extend(x.iter().map(|&x| (self.0)(x)));
            Ok(())
        }

        fn slopes(&mut self, [x, ..]: [&[f32]; 3], out: &mut Vec<[f32; 3]>) {
            out.clear();
            // Where the quotient of differences says nothing, the gradient is
            // not tested.
            let slope = |x: f32| (self.0(x + 1e-4) - self.0(x - 1e-4)) / 2e-4;
            out.extend(x.iter().map(|&x| [(self.0)(x), slope(x), 0.0]));
        }
    }

    /// The bracket of a function from 0 to 0.1, brought to its root.
    fn refined(f: impl Fn(f32) -> f32) -> Bracket {
        let nodes = [DVec2::ZERO, DVec2::new(0.1, 0.0)];
        let mut b = [Bracket::new(nodes, [f(0.0), f(0.1)], 0.0)];
        let rect = Rect::around(&nodes);
        let mut eyes = Eyes {
            z: &[],
            lattice: &Lattice::over(rect, 1.0).unwrap(),
            sampler: &mut Line(f),
            samples: &mut Samples::default(),
        };
        refine(&mut b, &mut eyes).unwrap();
        b[0]
    }

    #[test]
    fn jumps_are_told_from_roots() {
        let jumps = |f: fn(f32) -> f32| refined(f).jumps();
        assert!(!jumps(|x| x - 0.03));
        assert!(!jumps(|x| 1e6 * (x - 0.05).powi(3)));
        assert!(!jumps(|x| (x - 0.06).max(1e4 * (x - 0.061))));
        assert!(jumps(|x| if x < 0.0123 { -1.0 } else { 1.0 }));
        assert!(jumps(|x| if x < 0.0123 { x - 1.0 } else { x + 1e6 }));
        assert!(jumps(|x| if x < 0.0777 { -1.0 } else { f32::NAN }));
    }

    #[test]
    fn roots_of_smooth_kinked_and_jumping_functions() {
        type Case = (fn(f32) -> f32, f64);
        let cases: [Case; 7] = [
            (|x| x - 0.03, 0.03),
            (|x| x * x - 0.0049, 0.07),
            (|x| 1e6 * (x - 0.05).powi(3), 0.05),
            (|x| (x - 0.06).max(100.0 * (x - 0.061)), 0.06),
            (|x| if x < 0.0123 { -1.0 } else { 1e6 }, 0.0123),
            (|x| if x < 0.0777 { -1.0 } else { f32::NAN }, 0.0777),
            (|x| if x < 0.04 { -1.0 } else { f32::INFINITY }, 0.04),
        ];
        for (k, (f, x)) in cases.into_iter().enumerate() {
            let r = refined(f).point().x;
            assert!((r - x).abs() < 3e-6, "case {k}: {r} for {x}");
        }
    }
}
