//! Branches that may change a field's value in a box, but never its sign.
//!
//! ```text
//!    max(a, b)          An outline is where the field changes its sign. So in
//!       b  ────────     a box where b is below zero, max(a, b) may as well be
//!   ┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄ 0   a: its sign is that of a, whichever is greater. A
//!       a  ╲   ╱        prism thus depends on x and y alone up to its very
//!           ╲╱          top, and a union on those of its shapes that are near.
//! ```
//!
//! This holds for a `min` or a `max` whose result only serves as a sign: the
//! field itself, an operand of such an operation, or a multiple of one.

use fidget::compiler::RegOp;
use fidget::vm::{Choice, VmFunction};

/// What is needed of a register.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Need {
    #[default]
    Nothing,
    /// Whether it is below zero, zero, or above.
    Sign,
    Value,
}

impl Need {
    /// What is needed of the operands of an operation that takes their values.
    fn of_value(self) -> Need {
        match self {
            Need::Nothing => Need::Nothing,
            _ => Need::Value,
        }
    }
}

/// Adds to the choices of a function's operations those that leave its sign as
/// it is: `signs` has these for operations of which only the sign is needed.
/// Both are in the order of the operations. `needs` is scratch. True if there
/// are more choices now.
pub(super) fn choose(
    f: &VmFunction,
    signs: &[Choice],
    choices: &mut [Choice],
    needs: &mut Vec<Need>,
) -> bool {
    use RegOp::*;
    let tape = f.data().asm();
    needs.clear();
    needs.resize(tape.slot_count(), Need::Nothing);
    let mut more = false;
    let mut signs = signs.iter().rev();
    let mut choices = choices.iter_mut().rev();
    // From the result to the inputs.
    for &op in tape.iter() {
        let mut registers = [0; 3];
        let mut count = 0;
        op.visit_regs(|register| {
            registers[count] = usize::from(register);
            count += 1;
        });
        let [o, a, b] = registers;
        if let Output(_, number) = op {
            let need = if number == 0 { Need::Sign } else { Need::Value };
            needs[o] = needs[o].max(need);
            continue;
        }
        if let Store(_, mem) = op {
            needs[o] = needs[o].max(std::mem::take(&mut needs[mem as usize]));
            continue;
        }
        let need = std::mem::take(&mut needs[o]);
        // What is needed of the operands.
        let [left, right] = match op {
            Load(_, mem) => {
                let mem = &mut needs[mem as usize];
                *mem = need.max(*mem);
                continue;
            }
            MinRegReg(..) | MinRegImm(..) | MaxRegReg(..) | MaxRegImm(..) => {
                let known = choices.next().zip(signs.next());
                let Some((choice, sign)) = known else {
                    continue;
                };
                if need == Need::Sign && *choice == Choice::Both {
                    *choice = *sign;
                    more |= *sign != Choice::Both;
                }
                match *choice {
                    Choice::Left => [need, Need::Nothing],
                    Choice::Right => [Need::Nothing, need],
                    _ => [need; 2],
                }
            }
            AndRegReg(..) | AndRegImm(..) | OrRegReg(..) | OrRegImm(..) => {
                choices.next();
                signs.next();
                [need.of_value(); 2]
            }
            CopyReg(..) | NegReg(..) => [need; 2],
            MulRegImm(_, _, by) | DivRegImm(_, _, by) if by > 0.0 => [need; 2],
            _ => [need.of_value(); 2],
        };
        for (register, need) in
            [a, b].into_iter().zip([left, right]).take(count - 1)
        {
            needs[register] = need.max(needs[register]);
        }
    }
    more
}

#[cfg(test)]
mod tests {
    use crate::field::boxes::Boxes;
    use crate::field::boxes::tests::{function, value};
    use crate::interval::Interval;
    use crate::number::tests::everything;
    use fidget::context::Tree;
    use fidget::eval::Function;
    use fidget::var::Var;
    use fidget::vm::VmFunction;

    /// The axis of each input.
    fn axes(f: &VmFunction) -> Vec<usize> {
        let slot = |v| f.vars().get(&v);
        let slots = [Var::X, Var::Y, Var::Z].map(slot);
        let axis = |i| slots.iter().position(|s| *s == Some(i)).unwrap();
        (0..f.vars().len()).map(axis).collect()
    }

    /// The shorter function for a box.
    fn shorter(f: &VmFunction, of: [Interval; 3]) -> Option<VmFunction> {
        let axes = axes(f);
        let mut boxes = Boxes::default();
        let (_, trace) = boxes.range_of_sign(f, &|slot| of[axes[slot]]);
        let scratch = &mut Default::default();
        trace.map(|t| f.simplify(t, Default::default(), scratch).unwrap())
    }

    #[test]
    fn what_is_left_has_the_same_sign() {
        let all = everything();
        let mut rng = fastrand::Rng::with_seed(11);
        let mut random = || rng.f32();
        let mut compared = 0;
        for k in 0..3000 {
            let mut any = || {
                let n = (random() * all.len() as f32) as usize;
                all[n.min(all.len() - 1)].clone() + 3.0 * (random() - 0.5)
            };
            let [a, b, c, d] = [any(), any(), any(), any()];
            // One operand is also needed for its value.
            let tree = match k % 3 {
                0 => a.min(b.max(-(c.min(d)))) * 2.0,
                1 => a.max(b.clone()).min(c + b),
                _ => (a.max(b).max(c) + 0.5).min(d),
            };
            let f = function(&tree);
            let lo: [f32; 3] = std::array::from_fn(|_| 8.0 * random() - 4.0);
            let size = 2.0 * random();
            let of = lo.map(|lo| Interval::new(lo.into(), (lo + size).into()));
            let Some(g) = shorter(&f, of) else { continue };
            for _ in 0..10 {
                let p = lo.map(|lo| lo + size * random());
                let [v, w] = [&f, &g].map(|f| value(f, p));
                if v.abs() > 1e-4 {
                    compared += usize::from(v != w);
                    assert_eq!(v < 0.0, w < 0.0, "{k}: {v} and {w} at {p:?}");
                }
            }
        }
        assert!(compared > 100, "{compared}");
    }

    #[test]
    fn what_is_needed_for_its_value_stays() {
        let (x, _, z) = Tree::axes();
        let of = [(-1.0, 1.0), (0.0, 0.0), (-0.5, -0.1)];
        let of = of.map(|(lo, hi)| Interval::new(lo, hi));
        let picked = x.max(z);
        let left = shorter(&function(&picked), of).unwrap();
        assert_eq!(axes(&function(&picked)).len(), 2);
        assert_eq!(value(&left, [-0.9, 0.0, -0.1]), -0.9);
        assert!(shorter(&function(&(picked + 0.3)), of).is_none());
    }
}
