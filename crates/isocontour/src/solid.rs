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
                Some(a.extent()?.union(b.extent()?))
            }
            _ => None,
        }
    }

    /// True if all of its data has sections.
    pub fn has_sections(&self) -> bool {
        self.all(&|data| data.has_section())
    }

    /// True if all of its data knows where lines cross it.
    pub(crate) fn has_crossings(&self) -> bool {
        self.all(&|data| data.has_crossings())
    }

    fn all(&self, is: &dyn Fn(&dyn Data) -> bool) -> bool {
        match self {
            Solid::Data { data, .. } => is(&**data),
            Solid::HalfSpace { .. } | Solid::Constant(_) => true,
            Solid::Union(both) | Solid::Common(both) => {
                both.iter().all(|one| one.all(is))
            }
            Solid::Outside(of) => of.all(is),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::call;

    /// A ball's distance, as data.
    struct Ball;

    impl Data for Ball {
        fn name(&self) -> &str {
            "ball"
        }

        fn at(&self, p: DVec3) -> (f64, DVec3) {
            (p.length() - 5.0, p.normalize_or_zero())
        }

        fn range(&self, over: &Bounds) -> [f64; 2] {
            let far = over.min.abs().max(over.max.abs());
            [-5.0, far.length() - 5.0]
        }

        fn slopes(&self, _: &Bounds) -> [[f64; 2]; 3] {
            [[-1.0, 1.0]; 3]
        }

        fn contents(&self, _: &mut dyn FnMut(&[u8])) {}

        fn bytes(&self) -> usize {
            0
        }
    }

    /// True if a place is in a solid.
    fn holds(solid: &Solid, p: DVec3) -> bool {
        match solid {
            Solid::Data { data, place } => {
                data.value(place.transform_point3(p)) < 0.0
            }
            Solid::HalfSpace { normal, level } => normal.dot(p) < *level,
            Solid::Constant(all) => *all,
            Solid::Union(both) => both.iter().any(|s| holds(s, p)),
            Solid::Common(both) => both.iter().all(|s| holds(s, p)),
            Solid::Outside(of) => !holds(of, p),
        }
    }

    #[test]
    fn a_solid_holds_what_is_below_zero() {
        let data: Arc<dyn Data> = Arc::new(Ball);
        let (x, y, z) = Tree::axes();
        let ball = || call(&data, [x.clone(), y.clone(), z.clone()]);
        let moved = ball().remap_xyz(
            x.clone() * 0.5 + y.clone() - 1.0,
            y.clone() * -1.0,
            (z.clone() + x.clone()) / 2.0,
        );
        let same = |f: &Tree| f.clone();
        let trees = [
            same(&ball()),
            ball() * -0.25,
            (-moved.clone() * 3.0).max(ball()),
            moved.clone().min(x.abs() - 2.0).max(1.5 - z.abs()),
            (0.5 - (ball().max(y.clone() - 1.0) * 2.0 + 0.5)) * -1.0,
            (-(x.clone() * 2.0 + z.clone()).abs()).min(-1.0) + 3.0,
        ];
        let mut rng = fastrand::Rng::with_seed(7);
        let mut random = || 14.0 * (rng.f64() - 0.5);
        let places: Vec<DVec3> = (0..2000)
            .map(|_| DVec3::new(random(), random(), random()))
            .collect();
        let list = |axis: usize| -> Vec<f32> {
            places.iter().map(|p| p[axis] as f32).collect()
        };
        let lists = [list(0), list(1), list(2)];
        for (n, tree) in trees.iter().enumerate() {
            // Some have no data of their own.
            let Some(solid) = solid(&tree.max(ball())) else {
                panic!("{n}");
            };
            let mut values = Vec::new();
            let field = crate::Values::new(&tree.max(ball()), None).unwrap();
            let lists = lists.each_ref().map(|l| &l[..]);
            field.at(&lists, &mut values).unwrap();
            for (p, v) in places.iter().zip(&values) {
                let inside = holds(&solid, *p);
                assert!(inside == (*v < 0.0) || v.abs() < 1e-4, "{n}: {p} {v}");
            }
        }
    }

    #[test]
    fn what_is_no_solid_of_data_and_planes_is_none() {
        let data: Arc<dyn Data> = Arc::new(Ball);
        let (x, y, z) = Tree::axes();
        let ball = || call(&data, [x.clone(), y.clone(), z.clone()]);
        // Without data samples do as well, and with offsets there is no section.
        for tree in [
            x.abs().max(y.abs()) - 3.0,
            ball() - 1.0,
            ball().max(x.square() + y.square() - 4.0),
            ball() + x.clone(),
            ball().remap_xyz(x.square(), y.clone(), z.clone()),
        ] {
            assert!(solid(&tree).is_none());
        }
        // A sum of a sum of …, 2⁶⁰ times x, is looked at once for each sum.
        let mut deep = x.clone();
        for _ in 0..60 {
            deep = deep.clone() + deep;
        }
        assert!(solid(&ball().max(deep)).is_some());
    }

    #[test]
    fn one_without_sections_leaves_none_of_the_whole() {
        struct Cut;
        impl Data for Cut {
            fn name(&self) -> &str {
                "cut"
            }

            fn at(&self, p: DVec3) -> (f64, DVec3) {
                (p.x, DVec3::X)
            }

            fn range(&self, over: &Bounds) -> [f64; 2] {
                [over.min.x, over.max.x]
            }

            fn slopes(&self, _: &Bounds) -> [[f64; 2]; 3] {
                [[1.0; 2], [0.0; 2], [0.0; 2]]
            }

            fn contents(&self, _: &mut dyn FnMut(&[u8])) {}

            fn bytes(&self) -> usize {
                0
            }

            fn has_section(&self) -> bool {
                true
            }
        }
        let data: [Arc<dyn Data>; 2] = [Arc::new(Cut), Arc::new(Ball)];
        let (x, y, z) = Tree::axes();
        let [cut, ball] = data
            .each_ref()
            .map(|d| call(d, [x.clone(), y.clone(), z.clone()]));
        let known = |tree: Tree| {
            let solid = solid(&tree).unwrap();
            [solid.has_sections(), solid.has_crossings()]
        };
        let plane = || z.clone() - 1.0;
        assert_eq!(known(cut.max(plane())), [true, false]);
        assert_eq!(known(ball.max(plane())), [false, false]);
        assert_eq!(known(cut.min(-ball)), [false, false]);
    }

    #[test]
    fn the_extent_of_a_union_is_that_of_both() {
        struct Known;
        impl Data for Known {
            fn name(&self) -> &str {
                "known"
            }

            fn at(&self, p: DVec3) -> (f64, DVec3) {
                (p.abs().max_element() - 1.0, DVec3::X)
            }

            fn range(&self, _: &Bounds) -> [f64; 2] {
                [-1.0, f64::INFINITY]
            }

            fn slopes(&self, _: &Bounds) -> [[f64; 2]; 3] {
                [[-1.0, 1.0]; 3]
            }

            fn contents(&self, _: &mut dyn FnMut(&[u8])) {}

            fn bytes(&self) -> usize {
                0
            }

            fn extent(&self, place: &DAffine3) -> Option<Bounds> {
                let middle = place.inverse().translation;
                let half = DVec3::ONE;
                let (min, max) = (middle - half, middle + half);
                Some(Bounds { min, max })
            }
        }
        let data: Arc<dyn Data> = Arc::new(Known);
        let (x, y, z) = Tree::axes();
        let at = |to: f32| call(&data, [x.clone() - to, y.clone(), z.clone()]);
        let both = solid(&at(0.0).min(at(5.0))).and_then(|s| s.extent());
        let both = both.unwrap();
        assert_eq!(both.min, DVec3::splat(-1.0));
        assert_eq!(both.max, DVec3::new(6.0, 1.0, 1.0));
        let cut = solid(&at(0.0).max(-at(5.0))).unwrap();
        assert!(cut.extent().is_none());
    }
}
