//! Values and slopes of the field at many points, by interpretation.
//!
//! fidget's interpreter runs each operation over the whole batch through
//! bounds-checked vectors of vectors. Its native code is slow where functions
//! are called, has to be compiled, needs AVX2, and was no faster than this file
//! on any model measured (docs/decisions.md). Here an operation runs over a
//! fixed number of lanes, which stay in the nearest cache, with the widest
//! vector instructions of the processor. The instructions change nothing but
//! the time: a value is equal, bit for bit, on any processor. It also equals
//! fidget's where no function is called; `wide` has functions of its own.

use crate::interval::Interval;
use crate::number::Number;
use crate::number::dual::Dual;
use crate::number::run::run;
use crate::number::span::{BOXES, Span};
use crate::number::wide::{WIDTH, Wide};
use fidget::compiler::RegTape;
use fidget::vm::VmFunction;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Points per pass: 60 registers of them fit 16 kB.
const LANES: usize = 64;
/// Number of points up to which the last pass is a short one.
const FEW: usize = 16;
/// Points per pass with slopes.
const DUAL_LANES: usize = 32;

/// Boxes per pass.
const BOX_LANES: usize = 32;

type Register = [Wide; LANES / WIDTH];
type ShortRegister = [Wide; FEW / WIDTH];
type DualRegister = [Dual<Wide, 2>; DUAL_LANES / WIDTH];
type SpanRegister = [Span; BOX_LANES / BOXES];

/// What a tape reads at each point, with its slopes.
#[derive(Clone, Copy)]
pub(super) struct Seed<'a> {
    pub values: &'a [f32],
    pub slopes: Slopes<'a>,
}

/// The slopes of what a tape reads.
#[derive(Clone, Copy)]
pub(super) enum Slopes<'a> {
    /// It is a coordinate, whose derivative by itself is 1.
    Coordinate(usize),
    /// It depends on one coordinate, by which these are its derivatives.
    Along(usize, &'a [f32]),
    /// Its derivatives by both coordinates.
    Both([&'a [f32]; 2]),
}

/// The interpreter's registers, kept for their memory.
#[derive(Default)]
pub(crate) struct Lanes {
    numbers: Vec<Register>,
    few: Vec<ShortRegister>,
    duals: Vec<DualRegister>,
    spans: Vec<SpanRegister>,
}

impl Lanes {
    /// Appends the function's (first) output at `count` points to `out`.
    /// `inputs` are in the order of the function's inputs. Those that the
    /// function reads have a value for each point.
    pub(super) fn eval(
        &mut self,
        f: &VmFunction,
        inputs: &[&[f32]],
        count: usize,
        out: &mut Vec<f32>,
    ) {
        let tape = f.data().asm();
        // Either all passes are long, or the last one is short.
        let left = count % LANES;
        let long = if left > FEW { count } else { count - left };
        if long > 0 {
            Arch::new().dispatch(Values {
                tape,
                registers: enough(&mut self.numbers, tape, Wide::ZERO),
                inputs,
                points: 0..long,
                out,
            });
        }
        if long < count {
            Arch::new().dispatch(Values {
                tape,
                registers: enough(&mut self.few, tape, Wide::ZERO),
                inputs,
                points: long..count,
                out,
            });
        }
    }

    /// Appends value and derivatives along x and y of the function's (first)
    /// output at `count` points to `out`.
    pub(super) fn slopes(
        &mut self,
        f: &VmFunction,
        inputs: &[Seed<'_>],
        count: usize,
        out: &mut Vec<[f32; 3]>,
    ) {
        let tape = f.data().asm();
        let registers = enough(&mut self.duals, tape, Dual::splat(0.0));
        Arch::new().dispatch(Derivatives {
            tape,
            registers,
            inputs,
            count,
            out,
        });
    }

    /// Appends to `out` the ranges of the function's (first) output over
    /// `count` boxes; none for a box that has to be evaluated alone. `input` is
    /// the range of an input over a box.
    pub(crate) fn ranges(
        &mut self,
        f: &VmFunction,
        count: usize,
        input: &dyn Fn(usize, usize) -> Interval,
        out: &mut Vec<Option<Interval>>,
    ) {
        let tape = f.data().asm();
        let registers = enough(&mut self.spans, tape, Span::UNKNOWN);
        Arch::new().dispatch(Ranges {
            tape,
            registers,
            input,
            count,
            out,
        });
    }
}

/// As many registers as a tape has, or more.
fn enough<'a, T: Copy, const N: usize>(
    registers: &'a mut Vec<[T; N]>,
    tape: &RegTape,
    empty: T,
) -> &'a mut [[T; N]] {
    if registers.len() < tape.slot_count() {
        registers.resize(tape.slot_count(), [empty; N]);
    }
    registers
}

/// The numbers of a list from place `from` on. Spare lanes repeat the last
/// number, since numbers left from an earlier pass could be slow to compute
/// with.
#[inline(always)]
fn load(list: &[f32], from: usize) -> Wide {
    if let Some(all) = list.get(from..from + WIDTH)
        && let Ok(all) = all.try_into()
    {
        return Wide(all);
    }
    let last = list.last().copied().unwrap_or_default();
    let at = |k| list.get(from + k).copied().unwrap_or(last);
    Wide(std::array::from_fn(at))
}

struct Values<'a, const N: usize> {
    tape: &'a RegTape,
    registers: &'a mut [[Wide; N]],
    inputs: &'a [&'a [f32]],
    points: Range<usize>,
    out: &'a mut Vec<f32>,
}

impl<const N: usize> WithSimd for Values<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for from in self.points.clone().step_by(N * WIDTH) {
            run(
                self.tape,
                self.registers,
                |i, register| {
                    let values = self.inputs[i];
                    for (k, wide) in register.iter_mut().enumerate() {
                        *wide = load(values, from + k * WIDTH);
                    }
                },
                |result| {
                    let mut left = self.points.end - from;
                    for wide in result {
                        let n = left.min(WIDTH);
                        self.out.extend_from_slice(&wide.0[..n]);
                        left -= n;
                    }
                },
                |_, _, _| {},
            );
        }
    }
}

struct Derivatives<'a> {
    tape: &'a RegTape,
    registers: &'a mut [DualRegister],
    inputs: &'a [Seed<'a>],
    count: usize,
    out: &'a mut Vec<[f32; 3]>,
}

impl WithSimd for Derivatives<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for from in (0..self.count).step_by(DUAL_LANES) {
            run(
                self.tape,
                self.registers,
                |i, register| {
                    let seed = &self.inputs[i];
                    for (k, dual) in register.iter_mut().enumerate() {
                        let from = from + k * WIDTH;
                        let v = load(seed.values, from);
                        match seed.slopes {
                            Slopes::Coordinate(axis) => {
                                *dual = Dual::coordinate(v, axis);
                            }
                            Slopes::Along(axis, slopes) => {
                                *dual = Dual::flat(v);
                                if let Some(d) = dual.d.get_mut(axis) {
                                    *d = load(slopes, from);
                                }
                            }
                            Slopes::Both(slopes) => {
                                let d = slopes.map(|s| load(s, from));
                                *dual = Dual { v, d };
                            }
                        }
                    }
                },
                |result| {
                    let mut left = self.count - from;
                    for d in result {
                        let n = left.min(WIDTH);
                        let all: [[f32; 3]; WIDTH] = std::array::from_fn(|k| {
                            [d.v.0[k], d.d[0].0[k], d.d[1].0[k]]
                        });
                        self.out.extend_from_slice(&all[..n]);
                        left -= n;
                    }
                },
                |_, _, _| {},
            );
        }
    }
}

struct Ranges<'a> {
    tape: &'a RegTape,
    registers: &'a mut [SpanRegister],
    input: &'a dyn Fn(usize, usize) -> Interval,
    count: usize,
    out: &'a mut Vec<Option<Interval>>,
}

impl WithSimd for Ranges<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let last = self.count.saturating_sub(1);
        for from in (0..self.count).step_by(BOX_LANES) {
            run(
                self.tape,
                self.registers,
                |i, register| {
                    for k in 0..BOX_LANES {
                        let range = (self.input)(i, (from + k).min(last));
                        register[k / BOXES].set(k % BOXES, range);
                    }
                },
                |result| {
                    let left = (self.count - from).min(BOX_LANES);
                    let of = |k: usize| result[k / BOXES].get(k % BOXES);
                    self.out.extend((0..left).map(of));
                },
                |_, _, _| {},
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::tests::everything;
    use fidget::context::Context;
    use fidget::eval::{BulkEvaluator, Function, MathFunction};
    use fidget::types::Grad;
    use fidget::var::Var;
    use fidget::vm::VmFunction;

    #[test]
    fn every_operation_gives_what_fidgets_interpreter_does() {
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
        // The points need more than one pass, and the last pass is not full.
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
                let bits = a.to_bits() == b.to_bits();
                // Sines and other functions are our own, not the system's.
                let near = (a - b).abs() <= 2e-6 * (1.0 + b.abs());
                let same = bits || near || a.is_nan() && b.is_nan();
                assert!(same, "{k}: {a} for {b}");
            }
            assert_eq!(out.len(), n);
        }
    }

    #[test]
    fn slopes_are_those_of_fidgets_interpreter() {
        let n = DUAL_LANES + 5;
        let at =
            |k: usize, step: usize| ((k * step) as f32 * 0.731).sin() * 3.0;
        let points: [Vec<f32>; 3] =
            [7, 11, 13].map(|step| (0..n).map(|k| at(k + 1, step)).collect());
        let mut compared = 0;
        for (e, tree) in everything().iter().enumerate() {
            let mut ctx = Context::new();
            let root = ctx.import(tree);
            let f = VmFunction::new(&ctx, &[root]).unwrap();
            let count = f.vars().len();
            let axes: Vec<usize> = (0..count)
                .map(|slot| {
                    let all = [Var::X, Var::Y, Var::Z];
                    let own = |v: &Var| f.vars().get(v) == Some(slot);
                    all.iter().position(own).unwrap()
                })
                .collect();
            let seeds: Vec<Seed<'_>> = axes
                .iter()
                .map(|&axis| Seed {
                    values: &points[axis],
                    slopes: super::Slopes::Coordinate(axis),
                })
                .collect();
            let grads: Vec<Vec<Grad>> = axes
                .iter()
                .map(|&axis| {
                    let d = |a| f32::from(a == axis);
                    let all = points[axis].iter();
                    all.map(|&v| Grad::new(v, d(0), d(1), d(2))).collect()
                })
                .collect();
            let mut fidget = VmFunction::new_grad_slice_eval();
            let tape = f.grad_slice_tape(Default::default());
            let expected = fidget.eval(&tape, &grads).unwrap();
            let mut out = Vec::new();
            Lanes::default().slopes(&f, &seeds, n, &mut out);
            assert_eq!(out.len(), n);
            for (got, want) in out.iter().zip(&expected[0]) {
                for (a, b) in got.iter().zip([want.v, want.dx, want.dy]) {
                    if b.is_finite() {
                        let near = (a - b).abs() <= 1e-4 * (1.0 + b.abs());
                        assert!(near, "{e}: {a} for {b}");
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 30 * n, "{compared}");
    }
}
