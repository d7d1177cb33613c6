//! Values of the field at many points, by interpretation.
//!
//! fidget's interpreter runs each operation over the whole batch through
//! bounds-checked vectors of vectors, half a nanosecond for an addition;
//! its native code is slow where functions are called. Here an operation runs
//! over a fixed number of lanes, which the compiler turns into vector
//! instructions and which stay in the nearest cache, so that what is left
//! of the time is the sines and exponentials themselves. Every value equals
//! fidget's, bit for bit.

use super::ranges::Readable;
use fidget::compiler::RegOp;
use fidget::types::FloatExt;

/// Points per pass: 60 registers of them fit 16 kB.
const LANES: usize = 64;

type Register = [f32; LANES];

/// The interpreter's registers, kept for their memory.
#[derive(Default)]
pub(super) struct Lanes {
    slots: Vec<Register>,
}

impl Lanes {
    /// Appends the function's (first) output at `count` points to `out`.
    /// `inputs` are by the function's input number and hold a value for each
    /// point, those the function reads at least.
    pub(super) fn eval(
        &mut self,
        f: &impl Readable,
        inputs: &[&[f32]],
        count: usize,
        out: &mut Vec<f32>,
    ) {
        let slots = f.operations().slot_count();
        if self.slots.len() < slots {
            self.slots.resize(slots, [0.0; LANES]);
        }
        for from in (0..count).step_by(LANES) {
            self.pass(f, inputs, from, LANES.min(count - from), out);
        }
    }

    fn pass(
        &mut self,
        f: &impl Readable,
        inputs: &[&[f32]],
        from: usize,
        n: usize,
        out: &mut Vec<f32>,
    ) {
        let v = &mut self.slots;
        macro_rules! unary {
            ($o:ident, $a:ident, $f:expr) => {{
                let a = v[usize::from($a)];
                let o = &mut v[usize::from($o)];
                for i in 0..LANES {
                    o[i] = $f(a[i]);
                }
            }};
        }
        macro_rules! binary {
            ($o:ident, $a:ident, $b:ident, $f:expr) => {{
                let (a, b) = (v[usize::from($a)], v[usize::from($b)]);
                let o = &mut v[usize::from($o)];
                for i in 0..LANES {
                    o[i] = $f(a[i], b[i]);
                }
            }};
        }
        use RegOp::*;
        for &op in f.operations().iter().rev() {
            match op {
                Output(a, 0) => {
                    out.extend_from_slice(&v[usize::from(a)][..n]);
                }
                Output(..) => {}
                Input(o, i) => {
                    let o = &mut v[usize::from(o)];
                    let values = &inputs[i as usize][from..from + n];
                    o[..n].copy_from_slice(values);
                    // Lanes to spare repeat a point: whatever was there
                    // before could be slow to compute with.
                    o[n..].fill(values[n - 1]);
                }
                CopyReg(o, a) => v[usize::from(o)] = v[usize::from(a)],
                CopyImm(o, imm) => v[usize::from(o)] = [imm; LANES],
                Load(o, mem) => v[usize::from(o)] = v[mem as usize],
                Store(a, mem) => v[mem as usize] = v[usize::from(a)],
                NegReg(o, a) => unary!(o, a, |a: f32| -a),
                AbsReg(o, a) => unary!(o, a, f32::abs),
                RecipReg(o, a) => unary!(o, a, |a: f32| 1.0 / a),
                SqrtReg(o, a) => unary!(o, a, f32::sqrt),
                SquareReg(o, a) => unary!(o, a, |a: f32| a * a),
                FloorReg(o, a) => unary!(o, a, f32::floor),
                CeilReg(o, a) => unary!(o, a, f32::ceil),
                RoundReg(o, a) => unary!(o, a, f32::round),
                SinReg(o, a) => unary!(o, a, f32::sin),
                CosReg(o, a) => unary!(o, a, f32::cos),
                TanReg(o, a) => unary!(o, a, f32::tan),
                AsinReg(o, a) => unary!(o, a, f32::asin),
                AcosReg(o, a) => unary!(o, a, f32::acos),
                AtanReg(o, a) => unary!(o, a, f32::atan),
                ExpReg(o, a) => unary!(o, a, f32::exp),
                LnReg(o, a) => unary!(o, a, f32::ln),
                NotReg(o, a) => unary!(o, a, FloatExt::not),
                RandReg(o, a) => unary!(o, a, FloatExt::rand),
                AddRegReg(o, a, b) => binary!(o, a, b, |a, b| a + b),
                AddRegImm(o, a, b) => unary!(o, a, |a: f32| a + b),
                SubRegReg(o, a, b) => binary!(o, a, b, |a, b| a - b),
                SubRegImm(o, a, b) => unary!(o, a, |a: f32| a - b),
                SubImmReg(o, b, a) => unary!(o, b, |b: f32| a - b),
                MulRegReg(o, a, b) => binary!(o, a, b, |a, b| a * b),
                MulRegImm(o, a, b) => unary!(o, a, |a: f32| a * b),
                DivRegReg(o, a, b) => binary!(o, a, b, |a, b| a / b),
                DivRegImm(o, a, b) => unary!(o, a, |a: f32| a / b),
                DivImmReg(o, b, a) => unary!(o, b, |b: f32| a / b),
                AtanRegReg(o, a, b) => binary!(o, a, b, f32::atan2),
                AtanRegImm(o, a, b) => unary!(o, a, |a: f32| a.atan2(b)),
                AtanImmReg(o, b, a) => unary!(o, b, |b: f32| a.atan2(b)),
                ModRegReg(o, a, b) => binary!(o, a, b, f32::rem_euclid),
                ModRegImm(o, a, b) => unary!(o, a, |a: f32| a.rem_euclid(b)),
                ModImmReg(o, b, a) => unary!(o, b, |b: f32| a.rem_euclid(b)),
                CompareRegReg(o, a, b) => binary!(o, a, b, FloatExt::compare),
                CompareRegImm(o, a, b) => {
                    unary!(o, a, |a: f32| FloatExt::compare(a, b))
                }
                CompareImmReg(o, b, a) => {
                    unary!(o, b, |b: f32| FloatExt::compare(a, b))
                }
                MixRegReg(o, a, b) => binary!(o, a, b, FloatExt::mix),
                MixRegImm(o, a, b) => {
                    unary!(o, a, |a: f32| FloatExt::mix(a, b))
                }
                MixImmReg(o, b, a) => {
                    unary!(o, b, |b: f32| FloatExt::mix(a, b))
                }
                MinRegReg(o, a, b) => binary!(o, a, b, min),
                MinRegImm(o, a, b) => unary!(o, a, |a| min(a, b)),
                MaxRegReg(o, a, b) => binary!(o, a, b, max),
                MaxRegImm(o, a, b) => unary!(o, a, |a| max(a, b)),
                AndRegReg(o, a, b) => binary!(o, a, b, and),
                AndRegImm(o, a, b) => unary!(o, a, |a| and(a, b)),
                OrRegReg(o, a, b) => binary!(o, a, b, or),
                OrRegImm(o, a, b) => unary!(o, a, |a| or(a, b)),
            }
        }
    }
}

/// The lesser one; NaN if one of them is.
#[inline]
fn min(a: f32, b: f32) -> f32 {
    let lesser = if a < b { a } else { b };
    if a.is_nan() { f32::NAN } else { lesser }
}

/// The greater one; NaN if one of them is.
#[inline]
fn max(a: f32, b: f32) -> f32 {
    let greater = if a > b { a } else { b };
    if a.is_nan() { f32::NAN } else { greater }
}

#[inline]
fn and(a: f32, b: f32) -> f32 {
    if a == 0.0 { a } else { b }
}

#[inline]
fn or(a: f32, b: f32) -> f32 {
    if a != 0.0 { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::super::ranges::everything;
    use super::*;
    use fidget::context::Context;
    use fidget::eval::{BulkEvaluator, Function, MathFunction};
    use fidget::vm::VmFunction;

    #[test]
    fn every_operation_gives_the_bits_of_fidgets_interpreter() {
        const AWKWARD: [f32; 11] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.5,
            -2.75,
            3.5,
            1e30,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
        ];
        let pick = |k: usize| match k % 3 {
            0 => AWKWARD[k / 3 % AWKWARD.len()],
            _ => (k as f32 * 0.7311).sin() * 6.0,
        };
        // More than one pass, and a last one that is not full.
        let n = 3 * LANES + 7;
        let points: [Vec<f32>; 3] = [7, 11, 13]
            .map(|step| (0..n).map(|k| pick(k * step + step)).collect());
        for (k, tree) in everything().iter().enumerate() {
            let mut ctx = Context::new();
            let root = ctx.import(tree);
            let f = VmFunction::new(&ctx, &[root]).unwrap();
            let inputs: Vec<&[f32]> =
                points.iter().map(Vec::as_slice).collect();
            let mut fidget = VmFunction::new_float_slice_eval();
            let tape = f.float_slice_tape(Default::default());
            let expected = fidget.eval(&tape, &inputs).unwrap();
            let mut out = Vec::new();
            Lanes::default().eval(&f, &inputs, n, &mut out);
            for (a, b) in out.iter().zip(&expected[0]) {
                let same = a.to_bits() == b.to_bits();
                assert!(same || a.is_nan() && b.is_nan(), "{k}: {a} for {b}");
            }
            assert_eq!(out.len(), n);
        }
    }
}
