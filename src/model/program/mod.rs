//! The model's expression as a flat list of operations, evaluated over boxes.
//!
//! In: an expression, a box. Out: a range that holds every value of the field
//! in the box, the value at the box's centre, and the range of the gradient.
//!
//! Every operation's range is the intersection of two: the natural one, made
//! from its operands' ranges (`slope`), and the centred form c + G·(p - centre)
//! with the range G of its gradient (`slot`). The natural one is exact where a
//! coordinate occurs once, the centred form has an error that shrinks with the
//! square of the box, which keeps the number of boxes along a curved or turned
//! surface small. (Moore, Kearfott, Cloud, *Introduction to Interval Analysis*,
//! chapter 6; intersecting at every node lets `max` and `min` of several
//! surfaces each have their own.)
//!
//! Why not fidget's interval evaluators: they are f32, and they panic (the
//! compiled ones abort) on fields whose ranges overflow. See `interval`.

mod slope;
mod slot;
#[cfg(test)]
mod tests;
mod value;

use super::cell::Cell;
use super::interval::Interval;
use fidget::context::{BinaryOpcode, Context, Node, Op, UnaryOpcode};
use fidget::var::Var;
use slope::{binary, unary};
use slot::{FLAT, Slot, mixed, tightened};
use std::collections::HashMap;
use value::{binary_value, unary_value};

/// One operation; operands are indices of earlier steps.
#[derive(Clone, Copy, Debug)]
enum Step {
    Axis(usize),
    Const(f64),
    Unary(UnaryOpcode, u32),
    Binary(BinaryOpcode, u32, u32),
}

/// A straight-line program; the last step is the field.
#[derive(Clone, Debug)]
pub(super) struct Program {
    steps: Vec<Step>,
}

/// What is known of the field over a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Enclosure {
    /// Holds every value that is not NaN.
    pub range: Interval,
    /// Value at the centre of the box, perhaps NaN.
    pub centre: f64,
    /// Largest |partial derivative|, infinite where unknown.
    pub steepness: [f64; 3],
}

/// Reusable memory of the evaluation.
#[derive(Default)]
pub(super) struct Scratch {
    slots: Vec<Slot>,
    values: Vec<f64>,
    /// Operations evaluated so far: the measure of work, which does not
    /// depend on the machine.
    pub work: u64,
}

/// What a box costs beside its operations, in operations: it is kept in a
/// queue, with an expression of its own.
const BOX_WORK: u64 = 24;

impl Program {
    /// Flattens the part of `context` that `root` depends on.
    ///
    /// `Err` holds a variable other than x, y, z.
    pub fn new(context: &Context, root: Node) -> Result<Self, Var> {
        let mut steps: Vec<Step> = Vec::with_capacity(context.len());
        let mut index: HashMap<Node, u32> = HashMap::new();
        // (node, whether its operands are done)
        let mut todo = vec![(root, false)];
        while let Some((node, ready)) = todo.pop() {
            if index.contains_key(&node) {
                continue;
            }
            let Some(op) = context.get_op(node) else {
                // A node of another context: the caller's mistake, which
                // the type cannot rule out. A NaN field has no inside.
                return Ok(Self {
                    steps: vec![Step::Const(f64::NAN)],
                });
            };
            if !ready {
                todo.push((node, true));
                todo.extend(op.iter_children().map(|c| (c, false)));
                continue;
            }
            let of = |n: &Node| index.get(n).copied().unwrap_or(0);
            let step = match op {
                Op::Input(Var::X) => Step::Axis(0),
                Op::Input(Var::Y) => Step::Axis(1),
                Op::Input(Var::Z) => Step::Axis(2),
                Op::Input(other) => return Err(*other),
                Op::Const(c) => Step::Const(f64::from(c.0)),
                Op::Unary(op, a) => Step::Unary(*op, of(a)),
                Op::Binary(op, a, b) => Step::Binary(*op, of(a), of(b)),
            };
            index.insert(node, steps.len() as u32);
            steps.push(step);
        }
        Ok(Self { steps })
    }

    /// Number of operations.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Value at a point, perhaps NaN.
    pub fn value(&self, point: [f64; 3], scratch: &mut Scratch) -> f64 {
        scratch.work += self.steps.len() as u64 / 8 + 1;
        let v = &mut scratch.values;
        v.clear();
        for step in &self.steps {
            let value = match *step {
                Step::Axis(i) => point[i],
                Step::Const(c) => c,
                Step::Unary(op, a) => unary_value(op, v[a as usize]),
                Step::Binary(op, a, b) => {
                    binary_value(op, v[a as usize], v[b as usize])
                }
            };
            v.push(value);
        }
        v.last().copied().unwrap_or(f64::NAN)
    }

    /// Range, centre value and slope over a box.
    pub fn enclose(&self, cell: &Cell, scratch: &mut Scratch) -> Enclosure {
        scratch.work += self.steps.len() as u64 + BOX_WORK;
        let centre = cell.centre();
        let half: [f64; 3] = std::array::from_fn(|i| 0.5 * cell.width(i));
        let s = &mut scratch.slots;
        s.clear();
        for step in &self.steps {
            let slot = match *step {
                Step::Axis(i) => {
                    let mut slope = FLAT;
                    slope[i] = Interval::point(1.0);
                    Slot {
                        range: Interval::new(cell.lo[i], cell.hi[i]),
                        centre: centre[i],
                        slope,
                    }
                }
                Step::Const(c) => Slot {
                    range: Interval::point(c),
                    centre: c,
                    slope: FLAT,
                },
                Step::Unary(op, a) => {
                    tightened(unary(op, &s[a as usize]), half)
                }
                Step::Binary(op, a, b) => {
                    let (a, b) = (&s[a as usize], &s[b as usize]);
                    mixed(op, tightened(binary(op, a, b), half), a, b, half)
                }
            };
            s.push(slot);
        }
        match s.last() {
            Some(f) => Enclosure {
                range: f.range,
                centre: f.centre,
                steepness: f.slope.map(Interval::magnitude),
            },
            None => Enclosure {
                range: Interval::EMPTY,
                centre: f64::NAN,
                steepness: [0.0; 3],
            },
        }
    }

    /// The program without the branches of `min` and `max` that the last
    /// `enclose` (of this program, with this scratch) proved never to be
    /// taken; `None` if that would save little.
    ///
    /// The result equals the program everywhere in that box, except that a
    /// dropped branch's NaN, were it possible, would be lost: such branches
    /// are kept.
    pub fn simplify(&self, scratch: &Scratch) -> Option<Self> {
        let s = &scratch.slots;
        if s.len() != self.steps.len() {
            return None;
        }
        let n = self.steps.len();
        // Where a step's value comes from, if it is only passed on.
        let chosen = |step: &Step| -> Option<u32> {
            let Step::Binary(op, a, b) = *step else {
                return None;
            };
            let (ra, rb) = (s[a as usize].range, s[b as usize].range);
            let (below, above) = (
                ra.hi <= rb.lo && !ra.is_empty() && !rb.is_empty(),
                rb.hi <= ra.lo && !ra.is_empty() && !rb.is_empty(),
            );
            let (left, right) = match op {
                BinaryOpcode::Min => (below, above),
                BinaryOpcode::Max => (above, below),
                _ => return None,
            };
            if left && !rb.nan {
                Some(a)
            } else if right && !ra.nan {
                Some(b)
            } else {
                None
            }
        };
        let mut source: Vec<u32> = (0..n as u32).collect();
        let mut any = false;
        for (i, step) in self.steps.iter().enumerate() {
            if let Some(from) = chosen(step) {
                source[i] = source[from as usize];
                any = true;
            }
        }
        if !any {
            return None;
        }
        let mut live = vec![false; n];
        let root = *source.last()? as usize;
        live[root] = true;
        for i in (0..=root).rev() {
            if live[i] {
                match self.steps[i] {
                    Step::Axis(_) | Step::Const(_) => {}
                    Step::Unary(_, a) => {
                        live[source[a as usize] as usize] = true;
                    }
                    Step::Binary(_, a, b) => {
                        live[source[a as usize] as usize] = true;
                        live[source[b as usize] as usize] = true;
                    }
                }
            }
        }
        let kept = live.iter().filter(|l| **l).count();
        // A copy that saves less than a quarter costs more than it gives,
        // and would let the memory of a deep search add up.
        if kept * 4 > n * 3 {
            return None;
        }
        let mut position = vec![0u32; n];
        let mut steps = Vec::with_capacity(kept);
        for i in (0..=root).filter(|&i| live[i]) {
            let at = |a: u32| position[source[a as usize] as usize];
            let step = match self.steps[i] {
                Step::Unary(op, a) => Step::Unary(op, at(a)),
                Step::Binary(op, a, b) => Step::Binary(op, at(a), at(b)),
                other => other,
            };
            position[i] = steps.len() as u32;
            steps.push(step);
        }
        Some(Self { steps })
    }
}
