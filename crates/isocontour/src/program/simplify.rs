//! What of a program decides the field's sign in a box, and the program
//! without the rest.
//!
//! A branch of a `min` is irrelevant where it is above the other branch, or
//! above anything to which later operations are still sensitive: the other
//! branches of a union of thousands, and in the end 0, since only the sign
//! counts. So the limits beyond which a value makes no difference are passed
//! down from the field to its operands, as the window of an alpha-beta search
//! is.

use super::inverse::{inverse, only};
use super::piece::{StepPiece, pieces_of};
use super::slot::Slot;
use super::{Program, Scratch, Step, slots_of};
use crate::interval::Interval;
use fidget::context::{BinaryOpcode, UnaryOpcode};
use std::rc::Rc;

/// The window of values that make a difference: values above `hi` count as
/// `hi`, values below `lo` as `lo`.
#[derive(Clone, Copy)]
struct Window {
    lo: f64,
    hi: f64,
}

impl Window {
    /// No value makes a difference.
    const SHUT: Self = Self {
        lo: f64::INFINITY,
        hi: f64::NEG_INFINITY,
    };

    /// Every value makes a difference.
    const OPEN: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };

    /// Only the sign counts.
    const SIGN: Self = Self { lo: 0.0, hi: 0.0 };

    /// Widens the window for one more operation that depends on the value.
    fn widen(&mut self, other: Self) {
        self.lo = self.lo.min(other.lo);
        self.hi = self.hi.max(other.hi);
    }

    fn mapped(self, map: impl Fn(f64) -> f64) -> Self {
        let (a, b) = (map(self.lo), map(self.hi));
        if a.is_nan() || b.is_nan() {
            Self::OPEN
        } else {
            Self {
                lo: a.min(b),
                hi: a.max(b),
            }
        }
    }
}

impl Program {
    /// For each step the step whose value it has, and true if the step is
    /// needed.
    fn needed(&self, s: &[Slot]) -> (Vec<u32>, Vec<bool>) {
        let n = self.steps.len();
        let mut source: Vec<u32> = (0..n as u32).collect();
        let mut live = vec![false; n];
        let mut windows = vec![Window::SHUT; n];
        let mut look = |at: u32, window: Window, live: &mut [bool]| {
            live[at as usize] = true;
            windows[at as usize].widen(window);
            windows[at as usize]
        };
        if n > 0 {
            look(n as u32 - 1, Window::SIGN, &mut live);
        }
        for piece in &self.pieces {
            look(piece.step, Window::OPEN, &mut live);
        }
        for i in (0..n).rev() {
            if !live[i] {
                continue;
            }
            // Widening by nothing returns the window.
            let window = look(i as u32, Window::SHUT, &mut live);
            match self.steps[i] {
                Step::Axis(_) | Step::Const(_) => {}
                Step::Unary(op, a) => {
                    let inner = match op {
                        UnaryOpcode::Neg => window.mapped(|v| -v),
                        _ => Window::OPEN,
                    };
                    look(a, inner, &mut live);
                }
                Step::Binary(op, a, b) => {
                    if let Some(from) = chosen(op, a, b, window, s) {
                        source[i] = from;
                        live[i] = false;
                        look(from, window, &mut live);
                        continue;
                    }
                    let [of_a, of_b] = handed_down(op, a, b, window, s);
                    look(a, of_a, &mut live);
                    look(b, of_b, &mut live);
                }
                Step::Blend(blend, a, b) => {
                    let [ra, rb] = [a, b].map(|o| s[o as usize].range);
                    if let Some(second) = blend.passes(ra, rb, window.hi) {
                        let from = if second { b } else { a };
                        source[i] = from;
                        live[i] = false;
                        look(from, window, &mut live);
                        continue;
                    }
                    // A field that is above the other one by more than the
                    // radius makes no difference.
                    let radius = f64::from(blend.radius);
                    let of = |other: Interval| Window {
                        lo: window.lo,
                        hi: window.hi.min(other.hi) + radius,
                    };
                    look(a, of(rb), &mut live);
                    look(b, of(ra), &mut live);
                }
                Step::Data(_, at) => {
                    for a in at {
                        look(a, Window::OPEN, &mut live);
                    }
                }
            }
        }
        for i in 0..n {
            source[i] = source[source[i] as usize];
        }
        (source, live)
    }

    /// True for each step that decides the field's sign in the box of these
    /// slots.
    pub(super) fn live(&self, s: &[Slot]) -> Vec<bool> {
        self.needed(s).1
    }

    /// What [`Program::simplify`] gives, or the program itself.
    pub(crate) fn simplified(self: &Rc<Self>, scratch: &Scratch) -> Rc<Self> {
        self.simplify(scratch).map_or_else(|| self.clone(), Rc::new)
    }

    /// The program without the branches of `min` and `max` that the last
    /// `enclose` (of this program, with this scratch) proved not to decide the
    /// sign; `None` if that would save little.
    ///
    /// The result has the program's sign everywhere in that box. A branch that
    /// may be NaN is kept, since dropping it would lose the NaN.
    pub(crate) fn simplify(&self, scratch: &Scratch) -> Option<Self> {
        let s = &scratch.slots;
        let n = self.steps.len();
        if s.len() != n || n == 0 {
            return None;
        }
        let (source, live) = self.needed(s);
        let kept = live.iter().filter(|l| **l).count();
        // A copy that saves less than a quarter costs more than it gives, and
        // would let the memory of a deep search add up.
        if kept * 4 > n * 3 {
            return None;
        }
        let mut position = vec![0u32; n];
        let mut steps = Vec::with_capacity(kept);
        let mut data = Vec::new();
        for i in (0..n).filter(|&i| live[i]) {
            let at = |a: u32| position[source[a as usize] as usize];
            let step = match self.steps[i] {
                Step::Unary(op, a) => Step::Unary(op, at(a)),
                Step::Binary(op, a, b) => Step::Binary(op, at(a), at(b)),
                Step::Blend(blend, a, b) => Step::Blend(blend, at(a), at(b)),
                Step::Data(n, places) => {
                    data.push(self.data[n as usize].clone());
                    Step::Data(data.len() as u32 - 1, places.map(at))
                }
                other => other,
            };
            position[i] = steps.len() as u32;
            steps.push(step);
        }
        // The field is the last step, even where a piece comes after it.
        let root = position[source[n - 1] as usize];
        if root as usize + 1 != steps.len() {
            steps.push(Step::Binary(BinaryOpcode::Max, root, root));
        }
        let moved = |p: &StepPiece| StepPiece {
            step: position[p.step as usize],
            index: p.index,
        };
        Some(Self {
            steps: steps.into(),
            data: data.into(),
            pieces: self
                .pieces
                .iter()
                // A step with a single piece needs no condition.
                .filter(|p| {
                    let step = &self.steps[p.step as usize];
                    let [a, b] = slots_of(s, step);
                    !pieces_of(step, a, b).is_empty()
                })
                .map(moved)
                .collect(),
        })
    }
}

/// The operand that a `min` or `max` passes on, as far as it makes a
/// difference.
fn chosen(
    op: BinaryOpcode,
    a: u32,
    b: u32,
    window: Window,
    s: &[Slot],
) -> Option<u32> {
    let (ra, rb) = (s[a as usize].range, s[b as usize].range);
    if ra.is_empty() || rb.is_empty() {
        return None;
    }
    let (no_a, no_b) = match op {
        BinaryOpcode::Min => (
            rb.hi <= ra.lo || ra.lo > window.hi,
            ra.hi <= rb.lo || rb.lo > window.hi,
        ),
        BinaryOpcode::Max => (
            ra.hi <= rb.lo || ra.hi < window.lo,
            rb.hi <= ra.lo || rb.hi < window.lo,
        ),
        _ => return None,
    };
    if no_b && !rb.nan {
        Some(a)
    } else if no_a && !ra.nan {
        Some(b)
    } else {
        None
    }
}

/// The windows of an operation's operands, given the operation's own window.
fn handed_down(
    op: BinaryOpcode,
    a: u32,
    b: u32,
    window: Window,
    s: &[Slot],
) -> [Window; 2] {
    let (ra, rb) = (s[a as usize].range, s[b as usize].range);
    match op {
        BinaryOpcode::Min => [rb, ra].map(|other| Window {
            lo: window.lo,
            hi: window.hi.min(other.hi),
        }),
        BinaryOpcode::Max => [rb, ra].map(|other| Window {
            lo: window.lo.max(other.lo),
            hi: window.hi,
        }),
        _ => {
            let mut windows = [Window::OPEN; 2];
            if let Some((operand, of)) = inverse(op, [ra, rb].map(only)) {
                windows[operand] = window.mapped(of);
            }
            windows
        }
    }
}
