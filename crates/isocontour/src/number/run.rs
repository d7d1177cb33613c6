//! Interpretation of a tape, for any kind of number.

use super::Number;
use fidget::compiler::{RegOp, RegTape};

/// An operation that passes on one of its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pick {
    Min,
    Max,
    And,
    Or,
}

/// Runs a tape on `N` numbers at a time. `input` fills in the numbers of an
/// input, and `output` gets the result. `pick` gets the operands of every
/// operation that passes one of them on, in the order of the operations. `v`
/// holds the registers, as many as the tape's `slot_count`. `field::boxes` has
/// the shortest calls.
///
/// The function is long, and is compiled once more for each type of its
/// closures. So its callers take closures of their own by reference.
#[inline(always)]
pub(crate) fn run<T: Number, const N: usize>(
    tape: &RegTape,
    v: &mut [[T; N]],
    input: impl Fn(usize, &mut [T; N]),
    mut output: impl FnMut(&[T; N]),
    mut pick: impl FnMut(Pick, &[T; N], &[T; N]),
) {
    macro_rules! unary {
        ($o:ident, $a:ident, $f:expr) => {{
            let (o, a) = (usize::from($o), usize::from($a));
            for k in 0..N {
                v[o][k] = $f(v[a][k]);
            }
        }};
    }
    macro_rules! binary {
        ($o:ident, $a:ident, $b:ident, $f:expr) => {{
            let [o, a, b] = [$o, $a, $b].map(usize::from);
            for k in 0..N {
                v[o][k] = $f(v[a][k], v[b][k]);
            }
        }};
    }
    macro_rules! either {
        ($o:ident, $a:ident, $b:ident, $pick:ident, $f:expr) => {{
            pick(Pick::$pick, &v[usize::from($a)], &v[usize::from($b)]);
            binary!($o, $a, $b, $f)
        }};
    }
    macro_rules! either_right {
        ($o:ident, $a:ident, $imm:ident, $pick:ident, $f:expr) => {{
            pick(Pick::$pick, &v[usize::from($a)], &[T::splat($imm); N]);
            right!($o, $a, $imm, $f)
        }};
    }
    // These operations have a constant on the right, or on the left.
    macro_rules! right {
        ($o:ident, $a:ident, $imm:ident, $f:expr) => {{
            let imm = T::splat($imm);
            unary!($o, $a, |a: T| $f(a, imm))
        }};
    }
    macro_rules! left {
        ($o:ident, $imm:ident, $b:ident, $f:expr) => {{
            let imm = T::splat($imm);
            unary!($o, $b, |b: T| $f(imm, b))
        }};
    }
    use RegOp::*;
    for &op in tape.iter().rev() {
        match op {
            Output(a, 0) => output(&v[usize::from(a)]),
            Output(..) => {}
            Input(o, i) => input(i as usize, &mut v[usize::from(o)]),
            CopyReg(o, a) => v[usize::from(o)] = v[usize::from(a)],
            CopyImm(o, imm) => v[usize::from(o)] = [T::splat(imm); N],
            Load(o, mem) => v[usize::from(o)] = v[mem as usize],
            Store(a, mem) => v[mem as usize] = v[usize::from(a)],
            NegReg(o, a) => unary!(o, a, T::neg),
            AbsReg(o, a) => unary!(o, a, T::abs),
            RecipReg(o, a) => unary!(o, a, T::recip),
            SqrtReg(o, a) => unary!(o, a, T::sqrt),
            SquareReg(o, a) => unary!(o, a, T::square),
            FloorReg(o, a) => unary!(o, a, T::floor),
            CeilReg(o, a) => unary!(o, a, T::ceil),
            RoundReg(o, a) => unary!(o, a, T::round),
            SinReg(o, a) => unary!(o, a, T::sin),
            CosReg(o, a) => unary!(o, a, T::cos),
            TanReg(o, a) => unary!(o, a, T::tan),
            AsinReg(o, a) => unary!(o, a, T::asin),
            AcosReg(o, a) => unary!(o, a, T::acos),
            AtanReg(o, a) => unary!(o, a, T::atan),
            ExpReg(o, a) => unary!(o, a, T::exp),
            LnReg(o, a) => unary!(o, a, T::ln),
            NotReg(o, a) => unary!(o, a, T::not),
            RandReg(o, a) => unary!(o, a, T::rand),
            AddRegReg(o, a, b) => binary!(o, a, b, T::add),
            AddRegImm(o, a, b) => right!(o, a, b, T::add),
            SubRegReg(o, a, b) => binary!(o, a, b, T::sub),
            SubRegImm(o, a, b) => right!(o, a, b, T::sub),
            SubImmReg(o, b, a) => left!(o, a, b, T::sub),
            MulRegReg(o, a, b) => binary!(o, a, b, T::mul),
            MulRegImm(o, a, b) => unary!(o, a, |a: T| a.scale(b)),
            DivRegReg(o, a, b) => binary!(o, a, b, T::div),
            DivRegImm(o, a, b) => right!(o, a, b, T::div),
            DivImmReg(o, b, a) => left!(o, a, b, T::div),
            AtanRegReg(o, a, b) => binary!(o, a, b, T::atan2),
            AtanRegImm(o, a, b) => right!(o, a, b, T::atan2),
            AtanImmReg(o, b, a) => left!(o, a, b, T::atan2),
            ModRegReg(o, a, b) => binary!(o, a, b, T::modulo),
            ModRegImm(o, a, b) => right!(o, a, b, T::modulo),
            ModImmReg(o, b, a) => left!(o, a, b, T::modulo),
            CompareRegReg(o, a, b) => binary!(o, a, b, T::compare),
            CompareRegImm(o, a, b) => right!(o, a, b, T::compare),
            CompareImmReg(o, b, a) => left!(o, a, b, T::compare),
            MixRegReg(o, a, b) => binary!(o, a, b, T::mix),
            MixRegImm(o, a, b) => right!(o, a, b, T::mix),
            MixImmReg(o, b, a) => left!(o, a, b, T::mix),
            MinRegReg(o, a, b) => either!(o, a, b, Min, T::min),
            MinRegImm(o, a, b) => either_right!(o, a, b, Min, T::min),
            MaxRegReg(o, a, b) => either!(o, a, b, Max, T::max),
            MaxRegImm(o, a, b) => either_right!(o, a, b, Max, T::max),
            AndRegReg(o, a, b) => either!(o, a, b, And, T::and),
            AndRegImm(o, a, b) => either_right!(o, a, b, And, T::and),
            OrRegReg(o, a, b) => either!(o, a, b, Or, T::or),
            OrRegImm(o, a, b) => either_right!(o, a, b, Or, T::or),
        }
    }
}
