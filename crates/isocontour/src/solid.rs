//! Solids made of data whose sections are known, and of half-spaces.
//!
//! ```text
//!   max(mesh(x, y, z), abs(z - 5) - 3)      a mesh ∩ two half-spaces
//!   min(mesh(x, y, z), mesh(x - 9, z, y))   a mesh ∪ the mesh moved and turned
//! ```
//!
//! In: an expression. Out: what is inside it as unions, common parts and
//! complements of placed data and half-spaces, if that is all it says. Their
//! sections need no samples, so that a corner stays a corner.

use crate::cuboid::Bounds;
use crate::data::{Data, call_of, data_of};
use crate::expand::expand;
use fidget::context::{BinaryOpcode, Context, Node, Op, Tree, UnaryOpcode};
use fidget::var::Var;
use glam::{DAffine3, DMat3, DVec3};
use std::collections::HashMap;
use std::sync::Arc;

/// What is inside an expression.
#[derive(Clone, Debug)]
pub enum Solid {
    /// Where data is below zero at `place` of a point.
    Data {
        /// The data.
        data: Arc<dyn Data>,
        /// It leads from a point to where the data is asked.
        place: DAffine3,
    },
    /// Where normal · p is below the level.
    HalfSpace {
        /// The direction out of it, of any length but 0.
        normal: DVec3,
        /// The level.
        level: f64,
    },
    /// Everywhere or nowhere.
    Constant(bool),
    /// What is in either.
    Union(Box<[Solid; 2]>),
    /// What is in both.
    Common(Box<[Solid; 2]>),
    /// What is not in it.
    Outside(Box<Solid>),
}

/// Greatest number of parts of a solid. With more, its sections would take
/// longer than samples.
const MOST: usize = 200;
/// Greatest depth of an expression that is looked at.
const DEEPEST: usize = 400;

impl Solid {
    /// The box around it, if it is data or a union of data whose box is known.
    pub(crate) fn extent(&self) -> Option<Bounds> {
        match self {
            Solid::Data { data, place } => data.extent(place),
            Solid::Union(both) => {
                let [a, b] = &**both;
                let (a, b) = (a.extent()?, b.extent()?);
                Some(Bounds {
                    min: a.min.min(b.min),
                    max: a.max.max(b.max),
                })
            }
            _ => None,
        }
    }
}

/// What is inside an expression, if it is made of data with sections, and of
/// half-spaces.
pub fn solid(tree: &Tree) -> Option<Solid> {
    if data_of(tree).is_empty() {
        return None;
    }
    let (context, root) = expand(tree).ok()?;
    let mut reader = Reader {
        context: &context,
        known: HashMap::new(),
        left: MOST,
        has_data: false,
    };
    let solid = reader.below(root, 1.0, 0.0, DEEPEST)?;
    reader.has_data.then_some(solid)
}

/// A function a·x + b·y + c·z + d.
#[derive(Clone, Copy)]
struct Linear {
    by: DVec3,
    plus: f64,
}

struct Reader<'a> {
    context: &'a Context,
    /// The nodes that are linear functions, and those that are none.
    known: HashMap<Node, Option<Linear>>,
    left: usize,
    has_data: bool,
}

impl Reader<'_> {
    /// Where `sign` times a node is below a level.
    fn below(
        &mut self,
        node: Node,
        sign: f64,
        level: f64,
        depth: usize,
    ) -> Option<Solid> {
        let depth = depth.checked_sub(1)?;
        if let Some(linear) = self.linear(node, depth) {
            self.left = self.left.checked_sub(1)?;
            return Some(half_space(linear, sign, level));
        }
        if let Some(call) = call_of(self.context, node) {
            self.left = self.left.checked_sub(1)?;
            return self.placed(call.data, call.at, sign, level, depth);
        }
        let number = |n: &Node| self.number(*n);
        match self.context.get_op(node)? {
            Op::Unary(UnaryOpcode::Neg, a) => {
                self.below(*a, -sign, level, depth)
            }
            Op::Unary(UnaryOpcode::Abs, a) => {
                let a = *a;
                let [u, v] = [
                    self.below(a, 1.0, level, depth)?,
                    self.below(a, -1.0, level, depth)?,
                ];
                Some(joined(sign < 0.0, u, v))
            }
            Op::Binary(op, a, b) => {
                let (a, b) = (*a, *b);
                match (op, number(&a), number(&b)) {
                    (BinaryOpcode::Min, ..) | (BinaryOpcode::Max, ..) => {
                        let u = self.below(a, sign, level, depth)?;
                        let v = self.below(b, sign, level, depth)?;
                        let least = *op == BinaryOpcode::Min;
                        Some(joined(least == (sign > 0.0), u, v))
                    }
                    (BinaryOpcode::Add, _, Some(c)) => {
                        self.below(a, sign, level - sign * c, depth)
                    }
                    (BinaryOpcode::Add, Some(c), _) => {
                        self.below(b, sign, level - sign * c, depth)
                    }
                    (BinaryOpcode::Sub, _, Some(c)) => {
                        self.below(a, sign, level + sign * c, depth)
                    }
                    (BinaryOpcode::Sub, Some(c), _) => {
                        self.below(b, -sign, level - sign * c, depth)
                    }
                    (BinaryOpcode::Mul, _, Some(c)) => {
                        self.scaled(a, sign, level, c, depth)
                    }
                    (BinaryOpcode::Mul, Some(c), _) => {
                        self.scaled(b, sign, level, c, depth)
                    }
                    (BinaryOpcode::Div, _, Some(c)) => {
                        self.scaled(a, sign, level, 1.0 / c, depth)
                    }
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// Where `sign` times `by` times a node is below a level.
    fn scaled(
        &mut self,
        node: Node,
        sign: f64,
        level: f64,
        by: f64,
        depth: usize,
    ) -> Option<Solid> {
        let known = by != 0.0 && by.is_finite();
        known.then_some(())?;
        let sign = sign * by.signum();
        self.below(node, sign, level / by.abs(), depth)
    }

    /// Where `sign` times a call of data is below a level. What is not at the
    /// data's own surface has no exact section.
    fn placed(
        &mut self,
        data: Arc<dyn Data>,
        at: [Node; 3],
        sign: f64,
        level: f64,
        depth: usize,
    ) -> Option<Solid> {
        if level != 0.0 {
            return None;
        }
        let mut rows = [Linear {
            by: DVec3::ZERO,
            plus: 0.0,
        }; 3];
        for (row, node) in rows.iter_mut().zip(at) {
            *row = self.linear(node, depth)?;
        }
        let by = DMat3::from_cols(rows[0].by, rows[1].by, rows[2].by);
        let plus = DVec3::from_array(rows.map(|row| row.plus));
        let place = DAffine3::from_mat3_translation(by.transpose(), plus);
        let inside = Solid::Data { data, place };
        self.has_data = true;
        Some(if sign > 0.0 {
            inside
        } else {
            Solid::Outside(Box::new(inside))
        })
    }

    fn number(&self, node: Node) -> Option<f64> {
        match self.context.get_op(node)? {
            Op::Const(c) => Some(f64::from(c.0)),
            _ => None,
        }
    }

    /// A node as a linear function, if it is one.
    fn linear(&mut self, node: Node, depth: usize) -> Option<Linear> {
        if let Some(known) = self.known.get(&node) {
            return *known;
        }
        let found = self.as_linear(node, depth);
        self.known.insert(node, found);
        found
    }

    fn as_linear(&mut self, node: Node, depth: usize) -> Option<Linear> {
        let depth = depth.checked_sub(1)?;
        let axis = |by| Linear { by, plus: 0.0 };
        let found = match self.context.get_op(node)? {
            Op::Input(Var::X) => axis(DVec3::X),
            Op::Input(Var::Y) => axis(DVec3::Y),
            Op::Input(Var::Z) => axis(DVec3::Z),
            Op::Const(c) => Linear {
                by: DVec3::ZERO,
                plus: c.0.into(),
            },
            Op::Unary(UnaryOpcode::Neg, a) => {
                let a = *a;
                self.linear(a, depth)?.times(-1.0)
            }
            Op::Binary(op, a, b) => {
                let (op, a, b) = (*op, *a, *b);
                let numbers = [self.number(a), self.number(b)];
                let mut of = |node| self.linear(node, depth);
                match (op, numbers) {
                    (BinaryOpcode::Add, _) => of(a)?.plus(of(b)?),
                    (BinaryOpcode::Sub, _) => of(a)?.plus(of(b)?.times(-1.0)),
                    (BinaryOpcode::Mul, [Some(c), _]) => of(b)?.times(c),
                    (BinaryOpcode::Mul, [_, Some(c)]) => of(a)?.times(c),
                    (BinaryOpcode::Div, [_, Some(c)]) => of(a)?.times(1.0 / c),
                    _ => return None,
                }
            }
            _ => return None,
        };
        let is_finite = found.by.is_finite() && found.plus.is_finite();
        is_finite.then_some(found)
    }
}

impl Linear {
    fn times(self, c: f64) -> Linear {
        Linear {
            by: self.by * c,
            plus: self.plus * c,
        }
    }

    fn plus(self, other: Linear) -> Linear {
        Linear {
            by: self.by + other.by,
            plus: self.plus + other.plus,
        }
    }
}

fn half_space(linear: Linear, sign: f64, level: f64) -> Solid {
    let level = level - sign * linear.plus;
    if linear.by == DVec3::ZERO {
        return Solid::Constant(0.0 < level);
    }
    Solid::HalfSpace {
        normal: linear.by * sign,
        level,
    }
}

fn joined(either: bool, a: Solid, b: Solid) -> Solid {
    let both = Box::new([a, b]);
    if either {
        Solid::Union(both)
    } else {
        Solid::Common(both)
    }
}
