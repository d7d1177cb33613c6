//! Evaluates functions over single boxes.
//!
//! In: a function and, for each of its inputs, the range of its values over a
//! box. Out: the range of its result. With the ranges comes a trace of the
//! branches of `min`, `max`, `and` and `or` that are never taken in the box.
//! From it fidget makes a shorter function.
//!
//! Why not fidget's own interval evaluator: it panics where one end of a range
//! becomes NaN, as ∞ − ∞ does. This one never fails.

use super::signs::{self, Need};
use crate::interval::Interval;
use crate::number::run::{Pick, run};
use fidget::vm::{Choice, VmFunction, VmTrace};

/// Evaluates functions over boxes. It is kept between uses for its memory.
#[derive(Default)]
pub(crate) struct Boxes {
    ranges: Vec<[Interval; 1]>,
    trace: VmTrace,
    /// For each choice, the side that has the result's sign.
    signs: Vec<Choice>,
    needs: Vec<Need>,
}

impl Boxes {
    /// The range of the function's (first) output for given ranges of its
    /// inputs, and the trace of its choices if any branch is ruled out.
    pub(crate) fn range(
        &mut self,
        f: &VmFunction,
        input: &dyn Fn(usize) -> Interval,
    ) -> (Interval, Option<&VmTrace>) {
        let tape = f.data().asm();
        self.ranges.resize(tape.slot_count(), [Interval::ANYTHING]);
        self.trace.resize(f.choice_count(), Choice::Both);
        self.signs.clear();
        let mut choices = self.trace.as_mut_slice().iter_mut();
        let mut simpler = false;
        let mut out = Interval::ANYTHING;
        run(
            tape,
            &mut self.ranges[..],
            |slot, [range]| *range = input(slot),
            |[range]| out = *range,
            |pick, &[a], &[b]| {
                let choice = chosen(pick, a, b);
                simpler |= choice != Choice::Both;
                self.signs.push(of_sign(pick, a, b));
                if let Some(next) = choices.next() {
                    *next = choice;
                }
            },
        );
        (out, simpler.then_some(&self.trace))
    }

    /// Does what [`Boxes::range`] does. The shorter function has the sign of the
    /// given one, and perhaps another value.
    pub(crate) fn range_of_sign(
        &mut self,
        f: &VmFunction,
        input: &dyn Fn(usize) -> Interval,
    ) -> (Interval, Option<&VmTrace>) {
        let (range, trace) = self.range(f, input);
        let simpler = trace.is_some();
        let choices = self.trace.as_mut_slice();
        let more = signs::choose(f, &self.signs, choices, &mut self.needs);
        (range, (simpler || more).then_some(&self.trace))
    }
}

/// The side that an operation always takes, if there is one.
fn chosen(pick: Pick, a: Interval, b: Interval) -> Choice {
    match pick {
        Pick::Min => lesser(a, b),
        Pick::Max => lesser(a.neg(), b.neg()),
        Pick::And => zero(a),
        Pick::Or => match zero(a) {
            Choice::Left => Choice::Right,
            Choice::Right => Choice::Left,
            other => other,
        },
    }
}

/// A side that always has the sign of the result, if there is one. The other side
/// is never NaN.
fn of_sign(pick: Pick, a: Interval, b: Interval) -> Choice {
    let no_matter = |r: Interval| match pick {
        Pick::Min => r.lo > 0.0 && !r.nan,
        Pick::Max => r.hi < 0.0 && !r.nan,
        Pick::And | Pick::Or => false,
    };
    match [a, b].map(no_matter) {
        [_, true] => Choice::Left,
        [true, false] => Choice::Right,
        _ => Choice::Both,
    }
}

/// The side that `min` always takes. A side that may be NaN is kept, since the
/// result may then be NaN.
fn lesser(a: Interval, b: Interval) -> Choice {
    if a.hi < b.lo && !b.nan {
        Choice::Left
    } else if b.hi < a.lo && !a.nan {
        Choice::Right
    } else {
        Choice::Both
    }
}

/// The side that `and` takes: the left one where that is 0.
fn zero(a: Interval) -> Choice {
    if a.nan {
        Choice::Both
    } else if a.lo == 0.0 && a.hi == 0.0 {
        Choice::Left
    } else if !a.contains(0.0) {
        Choice::Right
    } else {
        Choice::Both
    }
}

/// The range of a function of one variable.
pub(crate) fn range_of(f: &VmFunction, over: Interval) -> Interval {
    Boxes::default().range(f, &|_| over).0
}

#[cfg(test)]
pub(crate) mod tests;
