//! The model's expression as a flat list of operations, evaluated over boxes.
//!
//! In: an expression, a box. Out: a range that holds every value of the field
//! in the box, the value at the box's centre, and the range of the gradient.
//!
//! Every operation's range is the intersection of two: the natural range, made
//! from its operands' ranges ([`Dual`](crate::number::dual::Dual)), and the
//! centred form c + G·(p - centre) with the range G of its gradient (`slot`).
//! The natural range is exact where a coordinate occurs once. The centred form
//! has an error that shrinks with the square of the box, which keeps the number
//! of boxes along a curved or turned surface small. (Moore, Kearfott, Cloud,
//! *Introduction to Interval Analysis*, chapter 6. Intersecting at every node
//! lets `max` and `min` of several surfaces each have their own.)
//!
//! Soft unions are taken as a whole (`blend`). Operations that jump are smooth
//! in pieces (`piece`), and a program may be about one piece of some of them.
//! What does not decide the sign of f in a box is left out of the box's program
//! (`simplify`).
//!
//! Why not fidget's interval evaluators: they are f32, and they panic (the
//! compiled ones abort) on fields whose ranges overflow. See `interval`.

mod blend;
mod called;
mod inverse;
mod mix;
mod piece;
mod simplify;
mod slot;
mod soft;
mod surfaces;
#[cfg(test)]
mod tests;
mod undefined;

use crate::cell::Cell;
use crate::data::{Data, call_of};
use crate::interval::Interval;
use crate::number::{binary, unary};
use blend::Blend;
use fidget::context::{BinaryOpcode, Context, Node, Op, UnaryOpcode};
use fidget::var::Var;
use piece::StepPiece;
use slot::{FLAT, Slot, mixed, tightened};
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;
pub(super) use surfaces::{Placed, Surface};

/// One operation. Its operands are indices of earlier steps.
#[derive(Clone, Copy, Debug)]
enum Step {
    Axis(usize),
    Const(f64),
    Unary(UnaryOpcode, u32),
    Binary(BinaryOpcode, u32, u32),
    Blend(Blend, u32, u32),
    /// A call of data, by its number among the program's.
    Data(u32, [u32; 3]),
}

impl Step {
    /// The steps whose values this step takes.
    fn operands(&self) -> impl Iterator<Item = u32> {
        let operands = match *self {
            Step::Axis(_) | Step::Const(_) => [None; 3],
            Step::Unary(_, a) => [Some(a), None, None],
            Step::Binary(_, a, b) | Step::Blend(_, a, b) => {
                [Some(a), Some(b), None]
            }
            Step::Data(_, at) => at.map(Some),
        };
        operands.into_iter().flatten()
    }
}

/// A straight-line program; the last step is the field.
#[derive(Clone, Debug)]
pub(super) struct Program {
    steps: Rc<[Step]>,
    data: Rc<[Arc<dyn Data>]>,
    /// The steps that stand for one of their pieces, in order. The program is
    /// then only about the points where this piece is the true one.
    pieces: Vec<StepPiece>,
}

/// What is known of the field over a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Enclosure {
    /// Range of every value that is not NaN.
    pub range: Interval,
    /// Value at the centre of the box, perhaps NaN.
    pub centre: f64,
    /// Largest |partial derivative|, infinite where unknown: of the field, and
    /// of what decides in which pieces a point of the box lies.
    pub steepness: [f64; 3],
}

impl Enclosure {
    /// True if no place of the box is inside.
    pub(crate) fn is_outside(&self) -> bool {
        self.range.is_empty() || self.range.lo >= 0.0
    }

    /// What is known if the box has no point of the program.
    const NONE: Self = Self {
        range: Interval::EMPTY,
        centre: f64::NAN,
        steepness: [0.0; 3],
    };
}

/// Memory of the evaluation, which is used again.
#[derive(Default)]
pub(super) struct Scratch {
    slots: Vec<Slot>,
    values: Vec<f64>,
    /// Operations evaluated so far: the measure of work, which does not
    /// depend on the machine.
    pub work: u64,
    /// True if slopes are to be as narrow as possible, at the cost of more
    /// work.
    sharp: bool,
}

impl Scratch {
    /// Memory for slopes that are as narrow as possible.
    pub(crate) fn sharp() -> Self {
        Self {
            sharp: true,
            ..Self::default()
        }
    }
}

/// Cost of a box besides its operations, in operations. It is kept in a queue,
/// with an expression of its own.
const BOX_WORK: u64 = 24;
/// Cost of a look at data, in operations: a mesh's takes some microseconds.
const DATA_WORK: u64 = 200;

impl Program {
    /// Flattens the part of `context` on which `root` depends.
    ///
    /// `Err` holds a variable other than x, y, z.
    pub(crate) fn new(context: &Context, root: Node) -> Result<Self, Var> {
        let mut steps: Vec<Step> = Vec::with_capacity(context.len());
        let mut data = Vec::new();
        let mut index: HashMap<Node, u32> = HashMap::new();
        // Each entry has a node, and true if its operands are done.
        let mut todo = vec![(root, false)];
        while let Some((node, ready)) = todo.pop() {
            if index.contains_key(&node) {
                continue;
            }
            let Some(op) = context.get_op(node) else {
                // The node is from another context, which is the caller's
                // mistake and which the type cannot rule out. A field that is
                // NaN has no inside.
                return Ok(Self {
                    steps: Rc::new([Step::Const(f64::NAN)]),
                    data: Rc::new([]),
                    pieces: Vec::new(),
                });
            };
            let blend = Blend::of(context, node);
            let called = call_of(context, node);
            if !ready {
                todo.push((node, true));
                match (blend, called) {
                    (Some((_, both)), _) => {
                        todo.extend(both.map(|c| (c, false)));
                    }
                    (_, Some(call)) => {
                        todo.extend(call.at.map(|c| (c, false)));
                    }
                    _ => todo.extend(op.iter_children().map(|c| (c, false))),
                }
                continue;
            }
            let of = |n: &Node| index.get(n).copied().unwrap_or(0);
            let step = match op {
                _ if let Some((blend, [a, b])) = blend => {
                    Step::Blend(blend, of(&a), of(&b))
                }
                _ if let Some(call) = called => {
                    data.push(call.data);
                    Step::Data(data.len() as u32 - 1, call.at.map(|n| of(&n)))
                }
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
        Ok(Self {
            steps: steps.into(),
            data: data.into(),
            pieces: Vec::new(),
        })
    }

    /// True if no place of a box of the last `enclose` is inside but for those
    /// at its border, by the roundings of coordinates. The box of a piece
    /// reaches that far beyond it, and where a part ends in the face in which
    /// its field jumps, nothing else of the box is inside.
    pub(crate) fn is_border(
        &self,
        cell: &Cell,
        found: &Enclosure,
        scratch: &mut Scratch,
    ) -> bool {
        /// Error of a coordinate as a share of it.
        const SHARE: f64 = 1e-12;
        let error =
            |i: usize| SHARE * (1.0 + cell.lo[i].abs().max(cell.hi[i].abs()));
        let most: f64 = (0..3).map(|i| error(i) * found.steepness[i]).sum();
        // Where the steepness is unknown, another look would hardly ever tell.
        let near = most.is_finite() && found.range.lo >= -most;
        if self.pieces.is_empty() || !near {
            return false;
        }
        let core = Cell {
            lo: std::array::from_fn(|i| cell.lo[i] + error(i)),
            hi: std::array::from_fn(|i| cell.hi[i] - error(i)),
        };
        if (0..3).any(|i| core.width(i) <= 0.0) {
            return true;
        }
        // What is known of the whole box is still needed.
        let mut own = Scratch::default();
        let is_outside = self.enclose(&core, &mut own).is_outside();
        scratch.work += own.work;
        is_outside
    }

    /// The work of an evaluation, in operations.
    fn work(&self) -> u64 {
        self.steps.len() as u64 + DATA_WORK * self.data.len() as u64
    }

    /// The work of a value, in operations.
    pub(crate) fn value_work(&self) -> u64 {
        self.work() / 8 + 1
    }

    /// True if it asks data.
    pub(crate) fn has_data(&self) -> bool {
        !self.data.is_empty()
    }

    /// Number of operations.
    pub(crate) fn len(&self) -> usize {
        self.steps.len()
    }

    /// The program of -f.
    pub(crate) fn negated(&self) -> Self {
        let root = self.steps.len().saturating_sub(1) as u32;
        let mut steps = self.steps.to_vec();
        steps.push(Step::Unary(UnaryOpcode::Neg, root));
        Self {
            steps: steps.into(),
            data: self.data.clone(),
            pieces: self.pieces.clone(),
        }
    }

    /// True if the field may depend on x (0), y (1) or z (2).
    pub(crate) fn depends_on(&self, axis: usize) -> bool {
        let is_it = |s: &Step| matches!(s, Step::Axis(a) if *a == axis);
        self.steps.iter().any(is_it)
    }

    /// Which operation makes the field NaN at a point, and of what, as in
    /// "the square root of -4".
    pub(crate) fn why_nan(
        &self,
        point: [f64; 3],
        scratch: &mut Scratch,
    ) -> Option<String> {
        self.value(point, scratch);
        let v = &scratch.values;
        let (number, step) = self.steps.iter().enumerate().find(|(i, s)| {
            v[*i].is_nan() && s.operands().all(|o| !v[o as usize].is_nan())
        })?;
        let operands: Vec<f64> =
            step.operands().map(|o| v[o as usize]).collect();
        let [x, y, z] = point;
        debug_assert!(v[number].is_nan());
        Some(format!(
            "{} (at x = {x:.3}, y = {y:.3}, z = {z:.3})",
            undefined::no_number(step, &operands)
        ))
    }

    /// Value at a point, perhaps NaN. It is NaN where another piece is the true
    /// one.
    pub(crate) fn value(&self, point: [f64; 3], scratch: &mut Scratch) -> f64 {
        scratch.work += self.value_work();
        let v = &mut scratch.values;
        v.clear();
        for step in self.steps.iter() {
            let value = match *step {
                Step::Axis(i) => point[i],
                Step::Const(c) => c,
                Step::Unary(op, a) => unary(op, v[a as usize]),
                Step::Binary(op, a, b) => {
                    binary(op, v[a as usize], v[b as usize])
                }
                Step::Blend(blend, a, b) => {
                    blend.value(v[a as usize], v[b as usize])
                }
                Step::Data(n, at) => {
                    let at = at.map(|a| v[a as usize]);
                    called::value(&*self.data[n as usize], at)
                }
            };
            v.push(value);
        }
        for StepPiece { step, index } in &self.pieces {
            let step = &self.steps[*step as usize];
            let mut operands = step.operands().map(|o| v[o as usize]);
            let a = operands.next().unwrap_or(0.0);
            let b = operands.next().unwrap_or(0.0);
            if !piece::holds(step, *index, a, b) {
                return f64::NAN;
            }
        }
        v.last().copied().unwrap_or(f64::NAN)
    }

    /// Range, centre value and slope over a box. The range is empty where no
    /// point of the box is in the program's pieces.
    pub(crate) fn enclose(
        &self,
        cell: &Cell,
        scratch: &mut Scratch,
    ) -> Enclosure {
        scratch.work += self.work() + BOX_WORK;
        let centre = cell.centre();
        let half: [f64; 3] = std::array::from_fn(|i| 0.5 * cell.width(i));
        let s = &mut scratch.slots;
        s.clear();
        let mut pieces = self.pieces.iter().peekable();
        let mut at_centre = true;
        let mut steepness = [0.0_f64; 3];
        for (number, step) in self.steps.iter().enumerate() {
            if let Some(chosen) = pieces.next_if(|p| p.step as usize == number)
            {
                let [a, b] = slots_of(s, step);
                let Some(over) = piece::over(step, chosen.index, a, b) else {
                    return Enclosure::NONE;
                };
                at_centre &= over.at_centre;
                for (known, more) in steepness.iter_mut().zip(over.steepness) {
                    *known = known.max(more);
                }
                s.push(tightened(over.slot, half));
                continue;
            }
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
                Step::Const(c) => Slot::constant(c),
                Step::Unary(op, a) => {
                    let mut slot = unary(op, s[a as usize]);
                    if scratch.sharp
                        && op == UnaryOpcode::Ln
                        && let Some(soft) = self.soft_slope(a, s)
                    {
                        for (known, soft) in slot.slope.iter_mut().zip(soft) {
                            *known = soft::common(*known, soft);
                        }
                    }
                    tightened(slot, half)
                }
                Step::Binary(op, a, b) => {
                    let operands = [a, b];
                    let (a, b) = (&s[a as usize], &s[b as usize]);
                    let mut slot = binary(op, *a, *b);
                    if op == BinaryOpcode::Add {
                        slot = mix::narrowed(slot, &self.steps, operands, s);
                    }
                    if scratch.sharp
                        && op == BinaryOpcode::Atan
                        && a.range.lo >= 0.0
                    {
                        slot.slope = soft::turn(a, b);
                    }
                    mixed(op, tightened(slot, half), a, b, half)
                }
                Step::Blend(blend, a, b) => {
                    blend.over(&s[a as usize], &s[b as usize], half)
                }
                Step::Data(n, at) => {
                    let at = at.map(|a| s[a as usize]);
                    tightened(called::over(&*self.data[n as usize], at), half)
                }
            };
            s.push(slot);
        }
        match s.last() {
            Some(f) => Enclosure {
                range: f.range,
                centre: if at_centre { f.centre } else { f64::NAN },
                steepness: std::array::from_fn(|i| {
                    steepness[i].max(f.slope[i].magnitude())
                }),
            },
            None => Enclosure::NONE,
        }
    }

    /// The program once for each piece of its first step that jumps in the box
    /// of the last `enclose` (of this program, with this scratch). Empty if no
    /// step jumps, or none with few pieces.
    pub(crate) fn by_pieces(&self, scratch: &Scratch) -> Vec<Self> {
        let mut jumps = self.dividing(scratch, piece::pieces_of);
        jumps
            .next()
            .map_or(Vec::new(), |found| self.in_pieces(found))
    }

    /// The program once for each side of the first `atan2` that jumps in the
    /// box of the last `enclose` (of this program, with this scratch), if its
    /// jump is at the same place at each z. Empty if there is none, or if more
    /// than [`MOST_TURNS`] jump there: each doubles the number of programs.
    pub(crate) fn by_upright_turns(&self, scratch: &Scratch) -> Vec<Self> {
        let upright = |step: &Step, a: &Slot, b: &Slot| match step {
            Step::Binary(BinaryOpcode::Atan, ..)
                if a.slope[2] == Interval::ZERO =>
            {
                piece::pieces_of(step, a, b)
            }
            _ => Vec::new(),
        };
        let mut turns = self.dividing(scratch, upright);
        let Some(first) = turns.next() else {
            return Vec::new();
        };
        if self.pieces.len() + 1 + turns.count() > MOST_TURNS {
            return Vec::new();
        }
        self.in_pieces(first)
    }

    /// The program once for each sector around the pole of `atan2` in the box
    /// of the last `enclose` (of this program, with this scratch). Empty if
    /// there is no pole. Empty, too, if there are several: the sectors of one
    /// tell little of the others, and all together are too many.
    pub(crate) fn by_sectors(&self, scratch: &Scratch) -> Vec<Self> {
        let mut poles = self.dividing(scratch, piece::sectors_of);
        match (poles.next(), poles.next()) {
            (Some(found), None) => self.in_pieces(found),
            _ => Vec::new(),
        }
    }

    /// The numbers of the steps that count in the box of the last `enclose` and
    /// have some `parts` there, each with these parts.
    fn dividing<'a>(
        &'a self,
        scratch: &'a Scratch,
        parts: impl Fn(&Step, &Slot, &Slot) -> Vec<f64> + 'a,
    ) -> impl Iterator<Item = (usize, Vec<f64>)> + 'a {
        let s = &scratch.slots;
        let known = s.len() == self.steps.len();
        let usable = known && self.pieces.len() < MOST_PIECES;
        let steps = self.steps.iter().enumerate().filter(move |_| usable);
        let mut taken = self.pieces.iter().peekable();
        let mut live = None;
        steps.filter_map(move |(number, step)| {
            if taken.next_if(|p| p.step as usize == number).is_some() {
                return None;
            }
            let [a, b] = slots_of(s, step);
            let found = parts(step, a, b);
            let counts = !found.is_empty()
                && live.get_or_insert_with(|| self.live(s))[number];
            counts.then_some((number, found))
        })
    }

    /// The program once for each of these pieces of a step.
    fn in_pieces(&self, (step, indices): (usize, Vec<f64>)) -> Vec<Self> {
        let step = step as u32;
        let at = self.pieces.partition_point(|p| p.step < step);
        let with = |index: f64| {
            let mut pieces = self.pieces.clone();
            pieces.insert(at, StepPiece { step, index });
            Self {
                steps: self.steps.clone(),
                data: self.data.clone(),
                pieces,
            }
        };
        indices.into_iter().map(with).collect()
    }

    /// The part of the box of the last `enclose` (of this program, with this
    /// scratch) that the program's pieces leave, as far as slopes tell. If
    /// nothing is left, an upper end is below its lower end.
    pub(crate) fn contracted(&self, whole: &Cell, scratch: &Scratch) -> Cell {
        let s = &scratch.slots;
        let mut cell = *whole;
        if s.len() == self.steps.len() {
            for StepPiece { step, index } in &self.pieces {
                let step = &self.steps[*step as usize];
                let [a, b] = slots_of(s, step);
                piece::contract(step, *index, a, b, whole, &mut cell);
            }
        }
        cell
    }
}

/// Greatest number of steps that may stand for one piece only.
const MOST_PIECES: usize = 16;
/// Greatest number of `atan2` for whose jumps a program is looked at side by
/// side in one box.
const MOST_TURNS: usize = 2;

/// The slots of a step's operands. If it has none, they are arbitrary.
fn slots_of<'a>(s: &'a [Slot], step: &Step) -> [&'a Slot; 2] {
    const NONE: Slot = Slot {
        range: Interval::ZERO,
        centre: 0.0,
        slope: FLAT,
    };
    let mut operands = step.operands().map(|o| &s[o as usize]);
    [(); 2].map(|()| operands.next().unwrap_or(&NONE))
}
