//! Moves the origin of a model that was drawn far from it.
//!
//! In: an expression, a point c. Out: g with g(p) = f(p + c). c is added, in
//! f64, to the constants that the coordinates meet: x - 30000 becomes x - 0 and
//! not (x + 30000) - 30000, which f32 evaluates in steps of 0.002 mm. An
//! operation that cannot take up a constant, such as a square, has it added to
//! its operand.
//!
//! `digits` measures the gain.

use crate::cancel::Cancel;
use crate::cell::Cell;
use crate::cuboid::Bounds;
use crate::data::{Call, call, call_of};
use crate::expand::{ExpandError, expand, nodes_of};
use crate::program::{Program, Scratch};
use crate::tree;
use fidget::context::{BinaryOpcode, Context, Node, Op, Tree, UnaryOpcode};
use fidget::var::Var;
use glam::DVec3;
use std::collections::HashMap;

/// An expression and a number to add to it.
#[derive(Clone)]
struct Sum {
    tree: Option<Tree>,
    plus: f64,
}

impl Sum {
    fn tree(self) -> Tree {
        match self.tree {
            None => Tree::constant(self.plus as f32),
            Some(tree) if self.plus == 0.0 => tree,
            Some(tree) => tree + self.plus as f32,
        }
    }

    fn of(tree: Tree) -> Self {
        Self {
            tree: Some(tree),
            plus: 0.0,
        }
    }

    fn scaled(self, by: f64) -> Self {
        Self {
            tree: self.tree.map(|t| t * by as f32),
            plus: self.plus * by,
        }
    }

    /// The number, if the sum is nothing else.
    fn number(&self) -> Option<f64> {
        self.tree.is_none().then_some(self.plus)
    }
}

/// The expression with its origin moved to `to`.
pub fn shifted(tree: &Tree, to: DVec3) -> Result<Tree, ExpandError> {
    let (context, root) = expand(tree)?;
    let mut done: HashMap<_, Sum> = HashMap::new();
    for node in nodes_of(&context, root) {
        let Some(op) = context.get_op(node) else {
            continue;
        };
        let called = call_of(&context, node);
        let axis = |tree: Tree, plus: f64| Sum {
            tree: Some(tree),
            plus,
        };
        let of = |n: Node| done.get(&n).cloned();
        let sum = match op {
            _ if let Some(Call { data, at }) = called => {
                let none = || Tree::constant(f32::NAN);
                let at = at.map(|n| of(n).map_or_else(none, Sum::tree));
                Sum::of(call(&data, at))
            }
            Op::Input(Var::X) => axis(Tree::x(), to.x),
            Op::Input(Var::Y) => axis(Tree::y(), to.y),
            Op::Input(Var::Z) => axis(Tree::z(), to.z),
            Op::Input(_) => return Err(ExpandError::FreeVariable),
            Op::Const(c) => Sum {
                tree: None,
                plus: f64::from(c.0),
            },
            Op::Unary(op, a) => match of(*a) {
                Some(a) => unary(*op, a),
                None => continue,
            },
            Op::Binary(op, a, b) => match (of(*a), of(*b)) {
                (Some(a), Some(b)) => binary(*op, a, b),
                _ => continue,
            },
        };
        done.insert(node, sum);
    }
    let sum = done.remove(&root);
    Ok(sum.map_or_else(|| Tree::constant(f32::NAN), Sum::tree))
}

fn unary(op: UnaryOpcode, a: Sum) -> Sum {
    match op {
        UnaryOpcode::Neg => {
            return Sum {
                tree: a.tree.map(|t| -t),
                plus: -a.plus,
            };
        }
        // Whole turns make no difference.
        UnaryOpcode::Sin | UnaryOpcode::Cos if a.tree.is_some() => {
            let plus = a.plus % std::f64::consts::TAU;
            let a = Sum { plus, ..a }.tree();
            return Sum::of(match op {
                UnaryOpcode::Sin => a.sin(),
                _ => a.cos(),
            });
        }
        // Whole numbers pass through the operation.
        UnaryOpcode::Floor if a.tree.is_some() => {
            let whole = a.plus.floor();
            let rest = Sum {
                plus: a.plus - whole,
                ..a
            };
            return Sum {
                tree: Some(rest.tree().floor()),
                plus: whole,
            };
        }
        _ => {}
    }
    Sum::of(tree::unary(op, &a.tree()))
}

fn binary(op: BinaryOpcode, a: Sum, b: Sum) -> Sum {
    match op {
        BinaryOpcode::Add | BinaryOpcode::Sub => {
            let sign = if op == BinaryOpcode::Add { 1.0 } else { -1.0 };
            let plus = a.plus + sign * b.plus;
            let tree = match (a.tree, b.tree) {
                (a, None) => a,
                (None, Some(b)) if sign > 0.0 => Some(b),
                (None, Some(b)) => Some(-b),
                (Some(a), Some(b)) if sign > 0.0 => Some(a + b),
                (Some(a), Some(b)) => Some(a - b),
            };
            Sum { tree, plus }
        }
        BinaryOpcode::Mul => match (a.number(), b.number()) {
            (_, Some(by)) => a.scaled(by),
            (Some(by), _) => b.scaled(by),
            _ => Sum::of(a.tree() * b.tree()),
        },
        BinaryOpcode::Div => match b.number() {
            Some(by) if by != 0.0 => a.scaled(1.0 / by),
            _ => Sum::of(a.tree() / b.tree()),
        },
        // Whole periods make no difference.
        BinaryOpcode::Mod => {
            let a = match b.number() {
                Some(period) if period != 0.0 && a.tree.is_some() => Sum {
                    plus: a.plus.rem_euclid(period),
                    ..a
                },
                _ => a,
            };
            Sum::of(a.tree().modulo(b.tree()))
        }
        // Only the sign of the difference counts.
        BinaryOpcode::Compare => {
            let plus = a.plus - b.plus;
            let b = Sum { plus: 0.0, ..b }.tree();
            Sum::of(Sum { plus, ..a }.tree().compare(b))
        }
        BinaryOpcode::Min
        | BinaryOpcode::Max
        | BinaryOpcode::Atan
        | BinaryOpcode::And
        | BinaryOpcode::Or
        | BinaryOpcode::Mix => Sum::of(tree::binary(op, a.tree(), b.tree())),
    }
}

/// How far f32 puts the surface of a model from where f64 has it, in mm: the
/// median over points all over the part. `None` if no points were found.
pub fn digits(tree: &Tree, within: &Bounds, cancel: &Cancel) -> Option<f64> {
    let cell = &Cell {
        lo: within.min.to_array(),
        hi: within.max.to_array(),
    };
    /// Points along each axis between which the surface is looked for.
    const ACROSS: usize = 7;
    let (context, root) = expand(tree).ok()?;
    let program = Program::new(&context, root).ok()?;
    let mut scratch = Scratch::default();
    let node = |n: usize| -> [f64; 3] {
        let at = [n % ACROSS, n / ACROSS % ACROSS, n / ACROSS / ACROSS];
        std::array::from_fn(|i| {
            let share = (at[i] as f64 + 0.46) / ACROSS as f64;
            cell.lo[i] + share * cell.width(i)
        })
    };
    let count = ACROSS.pow(3);
    let inside: Vec<bool> = (0..count)
        .map(|n| program.value(node(n), &mut scratch) < 0.0)
        .collect();
    let mut errors = Vec::new();
    for n in 0..count {
        cancel.check().ok()?;
        // The next point along x, if there is one.
        if n % ACROSS + 1 == ACROSS || inside[n] == inside[n + 1] {
            continue;
        }
        let (mut a, mut b) = (node(n), node(n + 1));
        for _ in 0..50 {
            let m: [f64; 3] = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
            if (program.value(m, &mut scratch) < 0.0) == inside[n] {
                a = m
            } else {
                b = m
            }
        }
        errors.extend(error_at(&context, root, &program, a, &mut scratch));
    }
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied()
}

/// How far f32 puts the surface from a point of it.
fn error_at(
    context: &Context,
    root: fidget::context::Node,
    program: &Program,
    p: [f64; 3],
    scratch: &mut Scratch,
) -> Option<f64> {
    /// Step of the differences that give the gradient.
    const GRADIENT_STEP: f64 = 1e-4;
    let mut squared = 0.0;
    for i in 0..3 {
        let mut at = |step: f64| {
            let mut q = p;
            q[i] += step;
            program.value(q, scratch)
        };
        let slope =
            (at(GRADIENT_STEP) - at(-GRADIENT_STEP)) / (2.0 * GRADIENT_STEP);
        squared += slope * slope;
    }
    let [x, y, z] = p.map(|v| v as f32);
    let seen = f64::from(context.eval_xyz(root, x, y, z).ok()?);
    let error = (seen - program.value(p, scratch)).abs() / squared.sqrt();
    error.is_finite().then_some(error)
}
