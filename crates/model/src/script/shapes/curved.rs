//! Round faces that two bodies have in common, beyond which no blend may swell.
//!
//! In: two fields. Out: the functions that bound both bodies at one place, such
//! as two cylinders of one radius, as fields. `flush` finds flat faces and says
//! why a blend needs them.
//!
//! The functions are read off the expressions, as planes are, and compared by
//! their values at fixed places, since a moved cylinder is written in another
//! way than one that was not moved. Guaranteed: each result is nowhere greater
//! than the lesser of both fields, so that it takes nothing off either body,
//! even if two functions that differ were taken for one. Not guaranteed: that
//! every common face is found.

use super::flush::{FLUSH, Search, constant};
use fidget::context::{BinaryOpcode, Context, Tree, TreeOp, UnaryOpcode};
use isocontour::operands;
use std::sync::Arc;

/// Operations that are looked at in one field, and that are evaluated at the places of
/// both. A field that has as many takes some 10 ms.
const MOST_STEPS: usize = 20_000;

/// Comparisons of two functions that one blend makes. Most end at the first place.
const MOST_COMPARED: usize = 200_000;

/// Functions of one field that are kept.
const MOST_LEAVES: usize = 256;

/// Faces that one blend keeps. Each makes the field longer; few bodies have as
/// many round faces in common.
const MOST_FACES: usize = 16;

/// Places where functions are compared.
const PLACES: usize = 24;

/// Half the edge of the cube in which these places lie, mm.
const REACH: f64 = 45.0;

/// Values that differ by this share are one: moved fields are rounded in other
/// places.
const ROUNDING: f32 = 1e-5;

/// A function that a field is nowhere less than.
#[derive(Clone)]
struct Leaf {
    field: Tree,
    /// Functions that this one is nowhere less than.
    within: Vec<Leaf>,
    /// Functions that this one is nowhere greater than: the faces of what is cut
    /// out, from inside.
    cut: Vec<Leaf>,
    /// True for what was found under a square root. A ball lies in three such
    /// cylinders, and so do all other balls about the same axes: two functions that are
    /// both from under a root are not taken for a common face.
    of_root: bool,
    values: Vec<f32>,
}

/// The functions that bound both of two bodies at one place.
pub(super) fn curved(a: &Tree, b: &Tree) -> Vec<Tree> {
    let mut a = leaves(a);
    let mut b = if a.is_empty() { Vec::new() } else { leaves(b) };
    if b.is_empty() {
        return Vec::new();
    }
    let mut left = MOST_STEPS;
    for leaf in a.iter_mut().chain(&mut b) {
        leaf.measure(&mut left);
    }
    let mut faces = Common::of(&a, &b);
    faces.truncate(MOST_FACES);
    faces.into_iter().map(|face| face.field).collect()
}

fn leaves(field: &Tree) -> Vec<Leaf> {
    Leaves::new().below(field, false, 0)
}

/// What leaves of one field have in common with those of another.
struct Common<'a> {
    /// All leaves of the other field.
    others: Vec<&'a Leaf>,
    faces: Vec<Leaf>,
    /// Comparisons that may still be made.
    left: usize,
}

impl<'a> Common<'a> {
    /// Nothing yet in common with these leaves.
    fn new(leaves: &'a [Leaf]) -> Self {
        let mut others = Vec::new();
        with_inner(leaves, &mut others);
        Common {
            others,
            faces: Vec::new(),
            left: MOST_COMPARED,
        }
    }

    fn of(a: &[Leaf], b: &'a [Leaf]) -> Vec<Leaf> {
        let mut common = Common::new(b);
        common.search(a);
        common.faces
    }

    /// Looks for leaves among the others. What lies within a function that is common
    /// has nothing to add.
    fn search(&mut self, leaves: &[Leaf]) {
        for leaf in leaves {
            if self.faces.len() >= MOST_LEAVES {
                return;
            }
            let left = &mut self.left;
            let same = self.others.iter().find(|of| leaf.shares(of, left));
            match same {
                Some(other) => self.faces.push(leaf.lower(other)),
                None => self.search(&leaf.within),
            }
        }
    }
}

/// Adds leaves, and those that lie within them, to all.
fn with_inner<'a>(leaves: &'a [Leaf], all: &mut Vec<&'a Leaf>) {
    for leaf in leaves {
        all.push(leaf);
        with_inner(&leaf.within, all);
    }
}

impl Leaf {
    fn new(field: Tree) -> Self {
        Leaf {
            field,
            within: Vec::new(),
            cut: Vec::new(),
            of_root: false,
            values: Vec::new(),
        }
    }

    /// The leaf of a function that rises with this one.
    fn map(&self, f: &dyn Fn(&Tree) -> Tree) -> Self {
        let all = |of: &[Leaf]| of.iter().map(|leaf| leaf.map(f)).collect();
        Leaf {
            field: f(&self.field),
            within: all(&self.within),
            cut: all(&self.cut),
            of_root: self.of_root,
            values: Vec::new(),
        }
    }

    fn mark_of_root(&mut self) {
        self.of_root = true;
        self.within.iter_mut().for_each(Leaf::mark_of_root);
    }

    /// Works out the values of all that can be compared. A function that has
    /// data, or more operations than are left, has none and is like no other.
    fn measure(&mut self, left: &mut usize) {
        self.values = values(&self.field, left).unwrap_or_default();
        for leaf in self.within.iter_mut().chain(&mut self.cut) {
            leaf.measure(left);
        }
    }

    fn equals(&self, other: &Leaf) -> bool {
        let close = |(a, b): (&f32, &f32)| {
            (a - b).abs() <= FLUSH as f32 + ROUNDING * a.abs()
        };
        !self.values.is_empty()
            && self.values.len() == other.values.len()
            && self.values.iter().zip(&other.values).all(close)
    }

    /// True if both leaves, or what is cut out of both, are one function. With no
    /// comparisons left none is.
    fn shares(&self, other: &Leaf, left: &mut usize) -> bool {
        let mut is_one = |a: &Leaf, b: &Leaf| {
            let may = *left > 0;
            *left = left.saturating_sub(1);
            may && a.equals(b)
        };
        let alone = !(self.of_root && other.of_root);
        let mut cuts = self
            .cut
            .iter()
            .flat_map(|a| other.cut.iter().map(move |b| (a, b)));
        alone && is_one(self, other) || cuts.any(|(a, b)| is_one(a, b))
    }

    fn lower(&self, other: &Leaf) -> Leaf {
        Leaf::new(self.field.min(other.field.clone()))
    }
}

struct Leaves {
    search: Search,
}

impl Leaves {
    fn new() -> Self {
        let search = Search { left: MOST_STEPS };
        Leaves { search }
    }

    /// Functions that a field is nowhere less than. Planes are among them only
    /// if `flat`: `flush` finds them in all but what is bent.
    fn below(&mut self, op: &TreeOp, flat: bool, depth: usize) -> Vec<Leaf> {
        if self.search.ends(depth) {
            return Vec::new();
        }
        if self.search.is_linear(op, depth) {
            return Vec::from_iter(flat.then(|| whole(op)));
        }
        let mut all = self.of_curved(op, flat, depth + 1);
        all.truncate(MOST_LEAVES);
        all
    }

    fn of_curved(
        &mut self,
        op: &TreeOp,
        flat: bool,
        depth: usize,
    ) -> Vec<Leaf> {
        match op {
            TreeOp::Binary(BinaryOpcode::Max, a, b) => {
                let mut all = self.below(a, flat, depth);
                all.extend(self.below(b, flat, depth));
                all
            }
            TreeOp::Binary(BinaryOpcode::Min, a, b) => {
                self.of_both(a, b, flat, depth)
            }
            TreeOp::Binary(BinaryOpcode::Add, a, b) => {
                self.of_sum(op, [a, b], flat, depth)
            }
            TreeOp::Binary(BinaryOpcode::Sub, a, b) => match constant(b) {
                Some(by) => {
                    self.mapped(a, flat, depth, &|f| f.clone() - by as f32)
                }
                None => vec![whole(op)],
            },
            TreeOp::Binary(BinaryOpcode::Mul, a, b) => {
                let factor = |of: &TreeOp| constant(of).filter(|v| *v > 0.0);
                match (factor(a), factor(b)) {
                    (_, Some(k)) => {
                        self.mapped(a, flat, depth, &|f| f.clone() * k as f32)
                    }
                    (Some(k), _) => {
                        self.mapped(b, flat, depth, &|f| f.clone() * k as f32)
                    }
                    _ => vec![whole(op)],
                }
            }
            TreeOp::Unary(UnaryOpcode::Neg, a) => {
                vec![self.cut(a, depth)]
            }
            TreeOp::Unary(UnaryOpcode::Abs, a) => {
                let mut all = self.below(a, flat, depth);
                if flat || !self.search.is_linear(a, depth) {
                    all.push(self.cut(a, depth));
                }
                all
            }
            TreeOp::Unary(UnaryOpcode::Sqrt, a) => {
                let root = |f: &Tree| f.max(0.0).sqrt();
                let mut within = self.mapped(a, false, depth, &root);
                within.iter_mut().for_each(Leaf::mark_of_root);
                vec![Leaf {
                    within,
                    ..whole(op)
                }]
            }
            TreeOp::RemapAxes { target, x, y, z } => {
                let [x, y, z] = [x, y, z].map(|axis| tree(axis));
                let mut straight =
                    |axis: &Tree| self.search.is_linear(axis, depth);
                let bent = ![&x, &y, &z].into_iter().all(&mut straight);
                self.mapped(target, flat || bent, depth, &|f| {
                    f.remap_xyz(x.clone(), y.clone(), z.clone())
                })
            }
            TreeOp::RemapAffine { target, mat } => {
                self.mapped(target, flat, depth, &|f| f.remap_affine(*mat))
            }
            _ => vec![whole(op)],
        }
    }

    fn mapped(
        &mut self,
        of: &TreeOp,
        flat: bool,
        depth: usize,
        f: &dyn Fn(&Tree) -> Tree,
    ) -> Vec<Leaf> {
        let all = self.below(of, flat, depth);
        all.iter().map(|leaf| leaf.map(f)).collect()
    }

    /// A sum, and what it is nowhere less than if one of its terms has a least
    /// value.
    fn of_sum(
        &mut self,
        op: &TreeOp,
        [a, b]: [&Arc<TreeOp>; 2],
        flat: bool,
        depth: usize,
    ) -> Vec<Leaf> {
        if let Some((of, by)) = constant(a)
            .map(|by| (b, by))
            .or_else(|| constant(b).map(|by| (a, by)))
        {
            return self.mapped(of, flat, depth, &|f| f.clone() + by as f32);
        }
        let mut within = Vec::new();
        for (of, other) in [(a, b), (b, a)] {
            if self.search.never_negative(other, depth) {
                within.extend(self.below(of, flat, depth));
            }
        }
        vec![Leaf {
            within,
            ..whole(op)
        }]
    }

    /// A union is bounded by what bounds both of its bodies.
    fn of_both(
        &mut self,
        a: &TreeOp,
        b: &TreeOp,
        flat: bool,
        depth: usize,
    ) -> Vec<Leaf> {
        let mut a = self.below(a, flat, depth);
        let mut b = if a.is_empty() {
            Vec::new()
        } else {
            self.below(b, flat, depth)
        };
        if b.is_empty() {
            return Vec::new();
        }
        for leaf in a.iter_mut().chain(&mut b) {
            leaf.measure(&mut self.search.left);
        }
        Common::of(&a, &b)
    }

    /// A body less what is cut out of it is nowhere less than the negative of
    /// what is cut out.
    fn cut(&mut self, of: &TreeOp, depth: usize) -> Leaf {
        let cut = self.mapped(of, true, depth, &|f| -f.clone());
        let mut all = Vec::new();
        with_inner(&cut, &mut all);
        let cut = all.into_iter().filter(|leaf| !leaf.of_root);
        let cut = cut.take(MOST_LEAVES).map(|leaf| Leaf {
            within: Vec::new(),
            cut: Vec::new(),
            ..leaf.clone()
        });
        Leaf {
            cut: cut.collect(),
            ..Leaf::new(-tree(of))
        }
    }
}

fn whole(op: &TreeOp) -> Leaf {
    Leaf::new(tree(op))
}

/// A tree of an operation that is part of another tree.
fn tree(op: &TreeOp) -> Tree {
    let shared = Arc::clone;
    Tree::from(match op {
        TreeOp::Input(v) => TreeOp::Input(*v),
        TreeOp::Const(v) => TreeOp::Const(*v),
        TreeOp::Unary(op, a) => TreeOp::Unary(*op, shared(a)),
        TreeOp::Binary(op, a, b) => TreeOp::Binary(*op, shared(a), shared(b)),
        TreeOp::RemapAxes { target, x, y, z } => TreeOp::RemapAxes {
            target: shared(target),
            x: shared(x),
            y: shared(y),
            z: shared(z),
        },
        TreeOp::RemapAffine { target, mat } => TreeOp::RemapAffine {
            target: shared(target),
            mat: *mat,
        },
    })
}

/// True if a field has no more operations than are left, each counted as often
/// as it is met.
fn is_short(field: &TreeOp, left: &mut usize) -> bool {
    let mut todo = vec![field];
    while let Some(op) = todo.pop() {
        let Some(fewer) = left.checked_sub(1) else {
            return false;
        };
        *left = fewer;
        todo.extend(operands(op));
    }
    true
}

/// The values of a field at [`PLACES`], unless it has more operations than are
/// left, or is no number at one of them.
fn values(field: &Tree, left: &mut usize) -> Option<Vec<f32>> {
    if !is_short(field, left) {
        return None;
    }
    let mut context = Context::new();
    let node = context.import(field);
    let value = |[x, y, z]: [f32; 3]| {
        let value = context.eval_xyz(node, x, y, z).ok();
        value.filter(|value| value.is_finite())
    };
    places().map(value).collect()
}

/// Places that lie evenly in a cube about the origin (M. Roberts: The
/// unreasonable effectiveness of quasirandom sequences, 2018).
fn places() -> impl Iterator<Item = [f32; 3]> {
    /// Powers of the inverse of the root of x⁴ = x + 1.
    const STEPS: [f64; 3] = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];
    (1..=PLACES).map(|i| {
        STEPS.map(|step| {
            let share = (step * i as f64).fract();
            ((2.0 * share - 1.0) * REACH) as f32
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{tree, value};
    use super::*;

    /// Two bodies, and places beside and within the face that they share, with
    /// the values of their union there.
    type Case = (&'static str, &'static str, &'static [([f32; 3], f32)]);

    #[test]
    fn blends_keep_round_faces() {
        let side: &[([f32; 3], f32)] = &[
            ([20.5, 0.0, 10.0], 0.5),
            ([0.0, -20.5, 10.0], 0.5),
            ([20.5, 0.0, 8.0], 0.5),
            ([19.9, 0.0, 10.0], -0.1),
        ];
        let ball: &[([f32; 3], f32)] =
            &[([20.5, 0.0, 0.0], 0.5), ([0.0, 0.0, 20.5], 0.5)];
        let cases: &[Case] = &[
            (
                "cylinder([0, 0, 5], 20, 10)",
                "cylinder([0, 0, 15], 20, 10)",
                side,
            ),
            (
                "cylinder([0, 0, 5], 20, 10)",
                "cylinder(20, 10).move([0, 0, 15])",
                side,
            ),
            (
                "tube([0, 0, 15], 20, 17, 10)",
                "cylinder([0, 0, 5], 20, 10)",
                side,
            ),
            (
                "rounded_cylinder([0, 0, 15], 20, 10, 2)",
                "extrude_z(circle(20), 0, 12)",
                side,
            ),
            (
                "max(sqrt(x*x + y*y) - 20, abs(z - 5) - 5)",
                "intersection(cylinder([0, 0, 5], 20, 30), z - 20)",
                side,
            ),
            (
                "polygon([[0, 0], [20, 0], [20, 10], [0, 10]]).revolve_z()",
                "cylinder([0, 0, 15], 20, 10)",
                side,
            ),
            // A ball on a cylinder of its radius, and half a ball on a ball.
            (
                "cylinder([0, 0, 0], 20, 20)",
                "sphere([0, 0, 10], 20)",
                side,
            ),
            (
                "capsule([0, 0, 0], [0, 0, 20], 20)",
                "cylinder([0, 0, 10], 20, 8)",
                side,
            ),
            (
                "sphere(20)",
                "intersection(sphere(20), box([0, -30, -30], [30, 30, 30]))",
                ball,
            ),
            (
                "cone([0, 0, 5], 22, 20, 10)",
                "cone([0, 0, 15], 20, 18, 10)",
                &[([20.5, 0.0, 10.0], 0.5 * 0.980_580_7)],
            ),
            (
                "rounded_box([-20, -20, 0], [20, 20, 10], 0)",
                "rounded_rectangle([-20, -20], [20, 20], 8).extrude_z(8, 20)",
                &[([20.5, 0.0, 9.0], 0.5)],
            ),
        ];
        for (a, b, places) in cases {
            for turn in ["", ".rotate([1, 2, 3], 33).move([5, 6, 7])"] {
                let turned = |p: &[f32; 3]| -> [f32; 3] {
                    if turn.is_empty() {
                        return *p;
                    }
                    let axis = glam::DVec3::new(1.0, 2.0, 3.0).normalize();
                    let by =
                        glam::DQuat::from_axis_angle(axis, 33f64.to_radians());
                    let p = by * glam::Vec3::from_array(*p).as_dvec3();
                    (p + glam::DVec3::new(5.0, 6.0, 7.0)).as_vec3().to_array()
                };
                let text = format!(
                    "let a = {a}; let b = {b}; blend(a{turn}, b{turn}, 6)"
                );
                for (p, wanted) in *places {
                    let [x, y, z] = turned(p);
                    let found = value(&text, x, y, z);
                    assert!(
                        (found - wanted).abs() < 0.01,
                        "{text} at {p:?}: {found}, not {wanted}"
                    );
                }
            }
        }
    }

    /// A bore through both of two bodies stays open.
    #[test]
    fn blends_keep_bores() {
        let bores = [
            ("cylinder(5, 60)", "cylinder(5, 60)"),
            ("cylinder(5, 60)", "cylinder([0, 0, 10], 5, 22)"),
            (
                "box([-5, -5, -9], [5, 5, 25])",
                "box([-5, -5, -1], [5, 5, 40])",
            ),
        ];
        for (first, second) in bores {
            let text = format!(
                "blend(difference(cylinder([0, 0, 5], 20, 10), {first}), \
                 difference(cylinder([0, 0, 15], 12, 10), {second}), 6)"
            );
            let found = value(&text, 4.9, 0.0, 10.0);
            assert!((found - 0.1).abs() < 0.01, "{first}, {second}: {found}");
            // The corner at the outside is still filled.
            assert!(value(&text, 12.5, 0.0, 10.5) < -0.5, "{first}, {second}");
        }
    }

    /// Whatever was taken for one face, no blend is smaller than the union.
    #[test]
    fn no_face_takes_anything_off_a_body() {
        let bodies = [
            "cylinder([0, 0, 5], 20, 10)",
            "tube([3, 0, 5], 20, 17, 10)",
            "sphere([0, 0, 3], 20)",
            "capsule([0, 0, 0], [9, 0, 9], 6)",
            "difference(box([-9, -9, -9], [9, 9, 9]), cylinder(5, 30))",
            "torus(15, 4).twist(50)",
            "gyroid(10, 1)",
            "blend(sphere(9), cylinder(9, 30), 3)",
            "union(sphere(9), cylinder(9, 30))",
            "sin(x) + cos(y) * z",
        ];
        for a in bodies {
            for b in bodies {
                let bodies = format!("let a = {a}; let b = {b}; ");
                let soft = tree(&format!("{bodies} blend(a, b, 5)")).unwrap();
                let hard = tree(&format!("{bodies} union(a, b)")).unwrap();
                let [soft, hard] = [soft, hard]
                    .map(|field| values(&field, &mut usize::MAX.clone()));
                let pairs = soft.unwrap().into_iter().zip(hard.unwrap());
                for (soft, hard) in pairs {
                    assert!(soft <= hard + 1e-4, "{a} {b}: {soft} {hard}");
                }
            }
        }
    }

    /// Fields of any size take a time that is bounded.
    #[test]
    fn long_fields_are_not_gone_through_to_their_end() {
        let (x, y, z) = Tree::axes();
        let mut field = (x.square() + y.square()).sqrt() - 3.0;
        for i in 0..60 {
            let other = field.remap_xyz(y.sin() + i, x.clone(), z.clone());
            field = match i % 3 {
                0 => field.max(other),
                1 => field.min(other.clone()).max(-other),
                _ => (field.abs() + other.abs()).sqrt() - 2.0,
            };
        }
        let mut found = Leaves::new();
        let all = found.below(&field, false, 0);
        assert_eq!(found.search.left, 0);
        assert!(all.len() <= MOST_LEAVES);
        assert!(curved(&field, &field).len() <= MOST_FACES);
    }

    /// Bodies of many round faces that have none in common.
    #[test]
    fn comparisons_are_bounded() {
        let body = |radius: f32| {
            let (x, y, _) = Tree::axes();
            let post = |i: u16| {
                let x = x.clone() - 0.1 * f32::from(i);
                (x.square() + y.square()).sqrt() - radius
            };
            (1..300).map(post).fold(post(0), |all, post| all.max(post))
        };
        let [mut a, mut b] = [body(3.0), body(4.0)].map(|f| leaves(&f));
        let mut left = usize::MAX;
        for leaf in a.iter_mut().chain(&mut b) {
            leaf.measure(&mut left);
        }
        let mut common = Common::new(&b);
        common.search(&a);
        assert_eq!(common.left, 0);
        assert!(common.faces.is_empty());
    }
}
