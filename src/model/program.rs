//! The model's expression as a flat list of operations, evaluated over boxes.
//!
//! In: an expression, a box. Out: a range that holds every value of the field
//! in the box, the value at the box's centre, and the range of the gradient.
//!
//! Every operation's range is the intersection of two: the natural one, made
//! from its operands' ranges, and the centred form c + G·(p - centre) with the
//! range G of its gradient. The natural one is exact where a coordinate occurs
//! once, the centred form has an error that shrinks with the square of the
//! box, which keeps the number of boxes along a curved or turned surface
//! small. (Moore, Kearfott, Cloud, *Introduction to Interval Analysis*,
//! chapter 6; intersecting at every node lets `max` and `min` of several
//! surfaces each have their own.)
//!
//! Why not fidget's interval evaluators: they are f32, and they panic (the
//! compiled ones abort) on fields whose ranges overflow. See `interval`.

use super::interval::Interval;
use fidget::context::{BinaryOpcode, Context, Node, Op, UnaryOpcode};
use fidget::var::Var;
use std::collections::HashMap;

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

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub lo: [f64; 3],
    pub hi: [f64; 3],
}

impl Cell {
    pub fn width(&self, axis: usize) -> f64 {
        self.hi[axis] - self.lo[axis]
    }

    pub fn centre(&self) -> [f64; 3] {
        // Halved before the sum: no overflow, whatever the box.
        std::array::from_fn(|i| 0.5 * self.lo[i] + 0.5 * self.hi[i])
    }

    /// Cuts in two across `axis`.
    pub fn split(&self, axis: usize) -> [Self; 2] {
        let (mut a, mut b) = (*self, *self);
        let middle = self.centre()[axis];
        a.hi[axis] = middle;
        b.lo[axis] = middle;
        [a, b]
    }
}

/// What is known of one step over a box.
#[derive(Clone, Copy, Debug)]
struct Slot {
    range: Interval,
    /// Value at the centre of the box, perhaps NaN.
    centre: f64,
    /// Range of the partial derivatives; all real numbers where unknown.
    slope: [Interval; 3],
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

/// No slope: the step does not change within the box.
const FLAT: [Interval; 3] = [Interval::ZERO; 3];
/// Unknown slope: the step may jump.
const STEEP: [Interval; 3] = [Interval::REALS; 3];

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

/// The slot with its range cut down by the centred form.
fn tightened(mut slot: Slot, half: [f64; 3]) -> Slot {
    // Across a hole in the domain (NaN) the mean value theorem is void.
    if slot.range.nan || !slot.centre.is_finite() {
        return slot;
    }
    let mut reach = 0.0;
    for (slope, half) in slot.slope.iter().zip(half) {
        let steepest = slope.magnitude();
        if slope.nan || !steepest.is_finite() {
            return slot;
        }
        reach += steepest * half;
    }
    let lo = slot.range.lo.max(slot.centre - reach);
    let hi = slot.range.hi.min(slot.centre + reach);
    // The two can only miss each other by rounding.
    if lo <= hi {
        slot.range.lo = lo;
        slot.range.hi = hi;
    }
    slot
}

/// The slot of a `max` (or `min`) of two crossing surfaces with its lower
/// (upper) end cut by a blend of the two.
///
/// max(a, b) ≥ t·a + (1 - t)·b for every t in [0, 1]. Along an edge the two
/// slopes partly cancel for some t: the ridge of a roof is bounded by its
/// height, although neither slope of the roof is. Without this an oblique
/// edge of length L takes L / tolerance boxes.
fn mixed(
    op: BinaryOpcode,
    mut slot: Slot,
    a: &Slot,
    b: &Slot,
    half: [f64; 3],
) -> Slot {
    let sign = match op {
        BinaryOpcode::Max => 1.0,
        // min(a, b) = -max(-a, -b)
        BinaryOpcode::Min => -1.0,
        _ => return slot,
    };
    let known = |s: &Slot| {
        !s.range.nan
            && s.centre.is_finite()
            && s.slope.iter().all(|g| g.is_finite() && !g.nan)
    };
    let decided = a.range.hi <= b.range.lo || b.range.hi <= a.range.lo;
    if decided || !known(a) || !known(b) {
        return slot;
    }
    let middle = |g: Interval| 0.5 * (g.lo + g.hi);
    for i in 0..3 {
        let (ga, gb) = (middle(a.slope[i]), middle(b.slope[i]));
        // The share of `a` at which the slopes along this axis cancel.
        let t = gb / (gb - ga);
        if !(t > 0.0 && t < 1.0) {
            continue;
        }
        let mut reach = 0.0;
        for (j, half) in half.iter().enumerate() {
            let (ga, gb) = (a.slope[j], b.slope[j]);
            let lo = t * ga.lo + (1.0 - t) * gb.lo;
            let hi = t * ga.hi + (1.0 - t) * gb.hi;
            reach += lo.abs().max(hi.abs()) * half;
        }
        let centre = t * a.centre + (1.0 - t) * b.centre;
        let end = centre - sign * reach;
        if sign > 0.0 && end > slot.range.lo {
            slot.range.lo = end.min(slot.range.hi);
        } else if sign < 0.0 && end < slot.range.hi {
            slot.range.hi = end.max(slot.range.lo);
        }
    }
    slot
}

fn scaled(slope: &[Interval; 3], by: Interval) -> [Interval; 3] {
    slope.map(|s| {
        // A constant stays one, however steep the outer function.
        if s == Interval::ZERO { s } else { s.mul(by) }
    })
}

fn sum(a: [Interval; 3], b: [Interval; 3]) -> [Interval; 3] {
    std::array::from_fn(|i| a[i].add(b[i]))
}

fn hull(a: &[Interval; 3], b: &[Interval; 3]) -> [Interval; 3] {
    std::array::from_fn(|i| a[i].hull(b[i]))
}

/// The slope of a step that jumps: unknown along every axis on which its
/// operands change.
fn jumping(slopes: &[&[Interval; 3]]) -> [Interval; 3] {
    let mut out = FLAT;
    for (i, o) in out.iter_mut().enumerate() {
        if slopes.iter().any(|s| s[i] != Interval::ZERO) {
            *o = STEEP[i];
        }
    }
    out
}

fn unary(op: UnaryOpcode, a: &Slot) -> Slot {
    let r = a.range;
    let g = &a.slope;
    let (range, slope) = match op {
        UnaryOpcode::Neg => (r.neg(), g.map(Interval::neg)),
        UnaryOpcode::Abs => {
            let sign = if r.lo >= 0.0 {
                Interval::point(1.0)
            } else if r.hi <= 0.0 {
                Interval::point(-1.0)
            } else {
                Interval::new(-1.0, 1.0)
            };
            (r.abs(), scaled(g, sign))
        }
        UnaryOpcode::Recip => {
            let out = r.recip();
            (out, scaled(g, out.square().neg()))
        }
        UnaryOpcode::Sqrt => {
            let out = r.sqrt();
            let half_recip = Interval::point(0.5).div(out);
            (out, scaled(g, half_recip))
        }
        UnaryOpcode::Square => {
            (r.square(), scaled(g, r.mul(Interval::point(2.0))))
        }
        UnaryOpcode::Floor => (r.floor(), jumping(&[g])),
        UnaryOpcode::Ceil => (r.ceil(), jumping(&[g])),
        UnaryOpcode::Round => (r.round(), jumping(&[g])),
        UnaryOpcode::Sin => (r.sin(), scaled(g, r.cos())),
        UnaryOpcode::Cos => (r.cos(), scaled(g, r.sin().neg())),
        UnaryOpcode::Tan => {
            let out = r.tan();
            (out, scaled(g, out.square().add(Interval::point(1.0))))
        }
        UnaryOpcode::Asin | UnaryOpcode::Acos => {
            let run = Interval::point(1.0).sub(r.square()).sqrt();
            let rise = Interval::point(1.0).div(run);
            if op == UnaryOpcode::Asin {
                (r.asin(), scaled(g, rise))
            } else {
                (r.acos(), scaled(g, rise.neg()))
            }
        }
        UnaryOpcode::Atan => {
            let run = Interval::point(1.0).add(r.square());
            (r.atan(), scaled(g, Interval::point(1.0).div(run)))
        }
        UnaryOpcode::Exp => {
            let out = r.exp();
            (out, scaled(g, out))
        }
        UnaryOpcode::Ln => (r.ln(), scaled(g, Interval::point(1.0).div(r))),
        UnaryOpcode::Not => (r.not(), jumping(&[g])),
        UnaryOpcode::Rand => (Interval::new(0.0, 1.0), jumping(&[g])),
    };
    Slot {
        range,
        centre: unary_value(op, a.centre),
        slope,
    }
}

fn binary(op: BinaryOpcode, a: &Slot, b: &Slot) -> Slot {
    let (ra, rb) = (a.range, b.range);
    let (ga, gb) = (&a.slope, &b.slope);
    let (range, slope) = match op {
        BinaryOpcode::Add => (ra.add(rb), sum(*ga, *gb)),
        BinaryOpcode::Sub => (ra.sub(rb), sum(*ga, gb.map(Interval::neg))),
        BinaryOpcode::Mul => (ra.mul(rb), sum(scaled(ga, rb), scaled(gb, ra))),
        BinaryOpcode::Div => {
            let out = ra.div(rb);
            let over = Interval::point(1.0).div(rb);
            // (a/b)' = (a' - (a/b)·b')/b
            let rest = scaled(gb, out.neg());
            (out, scaled(&sum(*ga, rest), over))
        }
        BinaryOpcode::Min | BinaryOpcode::Max => {
            let (below, above) = (ra.hi < rb.lo, rb.hi < ra.lo);
            let (range, left, right) = if op == BinaryOpcode::Min {
                (ra.min(rb), below, above)
            } else {
                (ra.max(rb), above, below)
            };
            let slope = if left {
                *ga
            } else if right {
                *gb
            } else {
                hull(ga, gb)
            };
            (range, slope)
        }
        BinaryOpcode::Atan => {
            let squared = ra.square().add(rb.square());
            let over = Interval::point(1.0).div(squared);
            let turn = sum(scaled(ga, rb), scaled(gb, ra.neg()));
            let mut slope = scaled(&turn, over);
            if ra.contains(0.0) && rb.lo < 0.0 {
                // The angle jumps where its first operand changes sign, and
                // nowhere along an axis on which that stays the same.
                for (out, jump) in slope.iter_mut().zip(jumping(&[ga])) {
                    if jump != Interval::ZERO {
                        *out = jump;
                    }
                }
            }
            (ra.atan2(rb), slope)
        }
        BinaryOpcode::Mod => {
            let slope = if ra.same_period(rb) {
                *ga
            } else {
                jumping(&[ga, gb])
            };
            (ra.modulo(rb), slope)
        }
        BinaryOpcode::Compare => (ra.compare(rb), jumping(&[ga, gb])),
        BinaryOpcode::And => (ra.and(rb), jumping(&[ga, gb])),
        BinaryOpcode::Or => (ra.or(rb), jumping(&[ga, gb])),
        BinaryOpcode::Mix => (Interval::ANYTHING, jumping(&[ga, gb])),
    };
    Slot {
        range,
        centre: binary_value(op, a.centre, b.centre),
        slope,
    }
}

fn unary_value(op: UnaryOpcode, a: f64) -> f64 {
    match op {
        UnaryOpcode::Neg => -a,
        UnaryOpcode::Abs => a.abs(),
        UnaryOpcode::Recip => 1.0 / a,
        UnaryOpcode::Sqrt => a.sqrt(),
        UnaryOpcode::Square => a * a,
        UnaryOpcode::Floor => a.floor(),
        UnaryOpcode::Ceil => a.ceil(),
        UnaryOpcode::Round => a.round(),
        UnaryOpcode::Sin => a.sin(),
        UnaryOpcode::Cos => a.cos(),
        UnaryOpcode::Tan => a.tan(),
        UnaryOpcode::Asin => a.asin(),
        UnaryOpcode::Acos => a.acos(),
        UnaryOpcode::Atan => a.atan(),
        UnaryOpcode::Exp => a.exp(),
        UnaryOpcode::Ln => a.ln(),
        // Defined by their bits or by exact zeros: fidget's own, in f32.
        UnaryOpcode::Not | UnaryOpcode::Rand => f64::from(op.eval(a as f32)),
    }
}

fn binary_value(op: BinaryOpcode, a: f64, b: f64) -> f64 {
    match op {
        BinaryOpcode::Add => a + b,
        BinaryOpcode::Sub => a - b,
        BinaryOpcode::Mul => a * b,
        BinaryOpcode::Div => a / b,
        BinaryOpcode::Atan => a.atan2(b),
        // NaN wins in fidget's min and max, unlike in f64's.
        BinaryOpcode::Min | BinaryOpcode::Max if a.is_nan() || b.is_nan() => {
            f64::NAN
        }
        BinaryOpcode::Min => a.min(b),
        BinaryOpcode::Max => a.max(b),
        BinaryOpcode::Mod => a.rem_euclid(b),
        BinaryOpcode::Compare => match a.partial_cmp(&b) {
            Some(order) => f64::from(order as i8),
            None => f64::NAN,
        },
        BinaryOpcode::And => {
            if a == 0.0 {
                a
            } else {
                b
            }
        }
        BinaryOpcode::Or => {
            if a != 0.0 {
                a
            } else {
                b
            }
        }
        BinaryOpcode::Mix => f64::from(op.eval(a as f32, b as f32)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::Tree;

    fn program(tree: &Tree) -> Program {
        let mut context = Context::new();
        let root = context.import(tree);
        Program::new(&context, root).unwrap()
    }

    /// A field that uses every kind of operation with a slope.
    fn mixture() -> Tree {
        let (x, y, z) = Tree::axes();
        let ball = (x.square() + y.square() + z.square()).sqrt() - 3.0;
        let wave = (x.clone() * 2.0).sin() * y.cos() + z.atan();
        let smooth = (ball.clone() * -2.0).exp() + (wave.clone()).exp();
        let angle = y.atan2(x.clone() + 10.0);
        let cells = (x.clone() + 0.3).modulo(1.5) + (y.clone() / 7.0).tan();
        ball.max(wave.abs() - 0.4)
            .min(smooth.ln() / (z.abs() + 1.0))
            .max(angle - cells.recip())
    }

    #[test]
    fn enclosures_hold_samples_of_value() {
        let p = program(&mixture());
        let mut scratch = Scratch::default();
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        for _ in 0..500 {
            let size = 4.0 * random() * random();
            let lo: [f64; 3] = std::array::from_fn(|_| 8.0 * random() - 4.0);
            let hi = lo.map(|v| v + size);
            let cell = Cell { lo, hi };
            let all = p.enclose(&cell, &mut scratch);
            let simple = p.simplify(&scratch);
            for _ in 0..20 {
                let point: [f64; 3] =
                    std::array::from_fn(|i| lo[i] + random() * size);
                let v = p.value(point, &mut scratch);
                if let Some(simple) = &simple {
                    let w = simple.value(point, &mut scratch);
                    assert!(v == w || v.is_nan() && w.is_nan());
                }
                if v.is_nan() {
                    assert!(all.range.nan);
                } else {
                    assert!(
                        all.range.lo - 1e-9 <= v && v <= all.range.hi + 1e-9,
                        "{v} is not in {all:?} over {cell:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_turned_plane_is_enclosed_exactly() {
        let (x, y, _) = Tree::axes();
        let p = program(&(x * 0.5 + y * 0.25));
        let cell = Cell {
            lo: [0.0; 3],
            hi: [1.0; 3],
        };
        let all = p.enclose(&cell, &mut Scratch::default());
        assert_eq!((all.range.lo, all.range.hi), (0.0, 0.75));
        assert_eq!(all.steepness, [0.5, 0.25, 0.0]);
    }

    #[test]
    fn the_centred_form_shrinks_with_the_square_of_the_box() {
        // x·x - 2x + 1 = (x - 1)², whose natural range is linear in the box.
        let (x, _, _) = Tree::axes();
        let p = program(&(x.clone() * x.clone() - x * 2.0 + 1.0));
        let cell = Cell {
            lo: [0.999, 0.0, 0.0],
            hi: [1.001, 0.0, 0.0],
        };
        let all = p.enclose(&cell, &mut Scratch::default());
        assert!(all.range.lo > -1e-5, "{:?}", all.range);
    }

    #[test]
    fn simplify_drops_the_far_body() {
        let (x, y, z) = Tree::axes();
        let r = y.square() + z.square();
        let near = ((x.clone() + 10.0).square() + r.clone()).sqrt() - 1.0;
        let far = ((x - 10.0).square() + r).sqrt() - 1.0;
        let p = program(&near.min(far));
        let mut scratch = Scratch::default();
        let cell = Cell {
            lo: [-12.0, -1.0, -1.0],
            hi: [-8.0, 1.0, 1.0],
        };
        p.enclose(&cell, &mut scratch);
        let simple = p.simplify(&scratch).unwrap();
        assert!(simple.len() < p.len());
    }
}
