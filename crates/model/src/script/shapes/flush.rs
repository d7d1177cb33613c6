//! Faces that two bodies have in common, beyond which no blend may swell.
//!
//! In: two fields. Out: the planes that bound both bodies at one place, as
//! fields. A soft union adds material where both fields are small, which is so
//! in a corner between two bodies, but also all over a face that is flush.
//!
//! The planes are read off the expressions: a greater of several fields is at
//! least each of them, and a sum at least one term if the other is never
//! negative. Guaranteed: both bodies lie on the inner side of each plane, to
//! `FLUSH`. Not guaranteed: that every such plane is found. Only flat faces are,
//! and not those inside a field that is itself soft.

use fidget::context::{BinaryOpcode, Tree, TreeOp, UnaryOpcode};
use fidget::var::Var;
use glam::DVec3;

/// Faces are flush if they are as near as outlines are accurate, mm.
pub(super) const FLUSH: f64 = 0.005;

/// Directions that differ by less are one: over 200 mm this is 2 µm.
const PARALLEL: f64 = 1e-5;

/// Operations that are looked at in one field, so that a field of any size
/// takes milliseconds.
const MOST_STEPS: usize = 5000;

/// Planes of one field that are kept: remapped fields may have twice as many at
/// each level. Few bodies have as many sides.
const MOST_BOUNDS: usize = 256;

/// Operations inside one another, so that no field overflows the stack.
const DEEPEST: usize = 200;

/// A function n·p + d that a field is nowhere less than.
#[derive(Clone, Copy, Debug)]
struct Bound {
    n: DVec3,
    d: f64,
}

/// The planes that bound both of two bodies at one place.
pub(super) fn flush(a: &Tree, b: &Tree) -> Vec<Tree> {
    let [a, b] = [a, b].map(|tree| {
        let all = Search { left: MOST_STEPS }.below(tree, 0);
        all.iter().filter_map(Bound::scaled).collect::<Vec<_>>()
    });
    let mut planes: Vec<Bound> = Vec::new();
    for of_a in &a {
        let same = |of_b: &&Bound| (of_b.d - of_a.d).abs() <= FLUSH;
        let of_b = b.iter().filter(|of_b| of_a.parallel(of_b)).find(same);
        let Some(of_b) = of_b else {
            continue;
        };
        let plane = Bound {
            n: of_a.n,
            d: of_a.d.min(of_b.d),
        };
        if !planes.iter().any(|p| p.parallel(&plane) && p.d == plane.d) {
            planes.push(plane);
        }
    }
    planes.iter().map(Bound::tree).collect()
}

impl Bound {
    fn constant(d: f64) -> Self {
        Bound { n: DVec3::ZERO, d }
    }

    fn times(&self, factor: f64) -> Self {
        Bound {
            n: self.n * factor,
            d: self.d * factor,
        }
    }

    fn plus(&self, other: &Bound) -> Self {
        Bound {
            n: self.n + other.n,
            d: self.d + other.d,
        }
    }

    fn parallel(&self, other: &Bound) -> bool {
        (self.n - other.n).abs().max_element() <= PARALLEL
    }

    /// The plane with a direction of length 1.
    fn scaled(&self) -> Option<Self> {
        let length = self.n.length();
        let scaled = self.times(1.0 / length);
        (length > 0.0 && scaled.d.is_finite()).then_some(scaled)
    }

    fn tree(&self) -> Tree {
        let (x, y, z) = Tree::axes();
        let terms = [(self.n.x, x), (self.n.y, y), (self.n.z, z)];
        let terms = terms.into_iter().filter(|(n, _)| n.abs() > PARALLEL);
        let terms = terms.map(|(n, axis)| match n {
            1.0 => axis,
            -1.0 => -axis,
            _ => axis * n as f32,
        });
        let sum = terms.reduce(|a, b| a + b);
        sum.unwrap_or_else(|| Tree::constant(0.0)) + self.d as f32
    }
}

pub(super) struct Search {
    /// Operations that may still be looked at.
    pub(super) left: usize,
}

impl Search {
    /// True if there is no time for one operation more.
    pub(super) fn ends(&mut self, depth: usize) -> bool {
        let ends = self.left == 0 || depth > DEEPEST;
        self.left = self.left.saturating_sub(1);
        ends
    }

    /// Functions that a field is nowhere less than, at most [`MOST_BOUNDS`].
    fn below(&mut self, op: &TreeOp, depth: usize) -> Vec<Bound> {
        let mut all = self.all_below(op, depth);
        all.truncate(MOST_BOUNDS);
        all
    }

    fn all_below(&mut self, op: &TreeOp, depth: usize) -> Vec<Bound> {
        if self.ends(depth) {
            return Vec::new();
        }
        if let Some(bound) = self.linear(op, depth) {
            return vec![bound];
        }
        let depth = depth + 1;
        match op {
            TreeOp::Binary(BinaryOpcode::Max, a, b) => {
                let mut all = self.below(a, depth);
                all.extend(self.below(b, depth));
                all
            }
            TreeOp::Binary(BinaryOpcode::Min, a, b) => {
                let (a, b) = (self.below(a, depth), self.below(b, depth));
                let lower = |of_a: &Bound| {
                    let of_b = b.iter().find(|of_b| of_a.parallel(of_b))?;
                    Some(if of_b.d < of_a.d { *of_b } else { *of_a })
                };
                a.iter().filter_map(lower).collect()
            }
            TreeOp::Binary(BinaryOpcode::Add, a, b) => {
                let terms = [(a, b), (b, a)];
                let found = terms.into_iter().find_map(|(of, other)| {
                    self.least(other, depth).map(|least| (of, least))
                });
                self.shifted(found, depth)
            }
            TreeOp::Binary(BinaryOpcode::Sub, a, b) => {
                let by = constant(b).map(|v| (a, -v));
                self.shifted(by, depth)
            }
            TreeOp::Binary(BinaryOpcode::Mul, a, b) => {
                let factor = |of: &TreeOp| constant(of).filter(|v| *v > 0.0);
                let pairs = [(a, factor(b)), (b, factor(a))];
                let found = pairs.into_iter().find_map(|(f, v)| Some((f, v?)));
                let Some((of, factor)) = found else {
                    return Vec::new();
                };
                let all = self.below(of, depth);
                all.iter().map(|bound| bound.times(factor)).collect()
            }
            TreeOp::Unary(UnaryOpcode::Abs, a) => match self.linear(a, depth) {
                Some(bound) => vec![bound, bound.times(-1.0)],
                None => self.below(a, depth),
            },
            TreeOp::RemapAxes { target, x, y, z } => {
                let axes = [x, y, z].map(|axis| {
                    let linear = self.linear(axis, depth);
                    let below = self.below(axis, depth);
                    (linear, below)
                });
                let all = self.below(target, depth);
                all.iter()
                    .flat_map(|bound| replaced(bound, &axes))
                    .collect()
            }
            TreeOp::RemapAffine { target, mat } => {
                let axes = affine(mat).map(|axis| (Some(axis), vec![axis]));
                let all = self.below(target, depth);
                all.iter()
                    .flat_map(|bound| replaced(bound, &axes))
                    .collect()
            }
            _ => Vec::new(),
        }
    }

    fn shifted(
        &mut self,
        of: Option<(&std::sync::Arc<TreeOp>, f64)>,
        depth: usize,
    ) -> Vec<Bound> {
        let Some((of, by)) = of else {
            return Vec::new();
        };
        let by = Bound::constant(by);
        self.below(of, depth).iter().map(|f| f.plus(&by)).collect()
    }

    /// The least value of a field that is constant or never negative.
    fn least(&mut self, op: &TreeOp, depth: usize) -> Option<f64> {
        let constant = constant(op);
        constant.or_else(|| self.never_negative(op, depth).then_some(0.0))
    }

    pub(super) fn never_negative(&mut self, op: &TreeOp, depth: usize) -> bool {
        if self.ends(depth) {
            return false;
        }
        let depth = depth + 1;
        match op {
            TreeOp::Const(v) => *v >= 0.0,
            TreeOp::Unary(
                UnaryOpcode::Abs | UnaryOpcode::Square | UnaryOpcode::Sqrt,
                _,
            ) => true,
            TreeOp::Binary(BinaryOpcode::Max, a, b) => {
                self.never_negative(a, depth) || self.never_negative(b, depth)
            }
            TreeOp::Binary(
                BinaryOpcode::Add | BinaryOpcode::Mul | BinaryOpcode::Div,
                a,
                b,
            ) => self.never_negative(a, depth) && self.never_negative(b, depth),
            _ => false,
        }
    }

    /// True if the field is n·p + d.
    pub(super) fn is_linear(&mut self, op: &TreeOp, depth: usize) -> bool {
        self.linear(op, depth).is_some()
    }

    /// The field as n·p + d, if it is that.
    fn linear(&mut self, op: &TreeOp, depth: usize) -> Option<Bound> {
        if self.ends(depth) {
            return None;
        }
        let depth = depth + 1;
        let of = |n| Some(Bound { n, d: 0.0 });
        match op {
            TreeOp::Input(Var::X) => of(DVec3::X),
            TreeOp::Input(Var::Y) => of(DVec3::Y),
            TreeOp::Input(Var::Z) => of(DVec3::Z),
            TreeOp::Const(v) => Some(Bound::constant((*v).into())),
            TreeOp::Unary(UnaryOpcode::Neg, a) => {
                Some(self.linear(a, depth)?.times(-1.0))
            }
            TreeOp::Binary(BinaryOpcode::Add, a, b) => {
                let (a, b) = (self.linear(a, depth)?, self.linear(b, depth)?);
                Some(a.plus(&b))
            }
            TreeOp::Binary(BinaryOpcode::Sub, a, b) => {
                let (a, b) = (self.linear(a, depth)?, self.linear(b, depth)?);
                Some(a.plus(&b.times(-1.0)))
            }
            TreeOp::Binary(BinaryOpcode::Mul, a, b) => {
                let (a, b) = (self.linear(a, depth)?, self.linear(b, depth)?);
                match (a.n == DVec3::ZERO, b.n == DVec3::ZERO) {
                    (true, _) => Some(b.times(a.d)),
                    (_, true) => Some(a.times(b.d)),
                    _ => None,
                }
            }
            TreeOp::Binary(BinaryOpcode::Div, a, b) => {
                let (a, b) = (self.linear(a, depth)?, constant(b)?);
                Some(a.times(1.0 / b))
            }
            TreeOp::RemapAxes { target, x, y, z } => {
                let axes = [x, y, z].map(|axis| self.linear(axis, depth));
                let axes = axes.map(|axis| (axis, Vec::new()));
                let of = self.linear(target, depth)?;
                replaced(&of, &axes).first().copied()
            }
            TreeOp::RemapAffine { target, mat } => {
                let axes = affine(mat).map(|axis| (Some(axis), Vec::new()));
                let of = self.linear(target, depth)?;
                replaced(&of, &axes).first().copied()
            }
            _ => None,
        }
    }
}

pub(super) fn constant(op: &TreeOp) -> Option<f64> {
    match op {
        TreeOp::Const(v) => Some((*v).into()),
        _ => None,
    }
}

/// The coordinates that an affine map makes.
fn affine(mat: &nalgebra::Affine3<f32>) -> [Bound; 3] {
    let m = |row: usize, column: usize| f64::from(mat.matrix()[(row, column)]);
    [0, 1, 2].map(|row| Bound {
        n: DVec3::new(m(row, 0), m(row, 1), m(row, 2)),
        d: m(row, 3),
    })
}

/// A function of other coordinates: each is linear, or has functions that it is
/// nowhere less than.
fn replaced(of: &Bound, axes: &[(Option<Bound>, Vec<Bound>); 3]) -> Vec<Bound> {
    let mut all = vec![Bound::constant(of.d)];
    for (n, (linear, below)) in of.n.to_array().into_iter().zip(axes) {
        let choices: &[Bound] = match linear {
            _ if n == 0.0 => continue,
            Some(linear) => std::slice::from_ref(linear),
            None if n > 0.0 => below,
            None => &[],
        };
        let with = |sum: &Bound| {
            let sum = *sum;
            choices.iter().map(move |axis| sum.plus(&axis.times(n)))
        };
        all = all.iter().flat_map(with).collect();
        // More than two choices for each coordinate are no shape's.
        all.truncate(8);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each level has twice the bounds of the one inside, unless something stops
    /// that: 30 levels would have a thousand million.
    #[test]
    fn bounds_of_remapped_fields_do_not_grow_without_end() {
        let (x, y, z) = Tree::axes();
        let mut field = x.max(y.clone());
        for levels in 0..30 {
            let search = || Search { left: MOST_STEPS };
            let bounds = search().below(&field, 0);
            assert!(bounds.len() <= MOST_BOUNDS, "{levels}");
            let (a, b) = (x.max(y.clone()), y.max(x.clone()));
            field = field.remap_xyz(a, b, z.clone());
        }
        assert!(!flush(&field, &field).is_empty());
    }
}
