//! Soft unions: min(a, b) − max(r − |a − b|, 0)² / 4r.
//!
//! Operation by operation, the range of such a union is r/4 too low wherever
//! the two fields may be as near to one another as r. For a thousand unions,
//! each of the last one and another body, the range is 250 r too low. As a
//! function of a and b the union never falls where one of them rises, and rises
//! by as much as both do:
//!
//! ```text
//!   b ╱╱╱╱╱╱   ranges: from where both are least to where both are greatest;
//!    ╱╱╱╱╱╱            a alone where a + r < b,
//!   ╱╱╱╱╱╱ a   slopes: w a' + (1 − w) b', with w = (r − (a − b)) / 2r from 0
//!                      to 1.
//! ```
//!
//! In: an operation of an expression. Out: the soft union that it is, if it is
//! one, and what is known of the union over a box.

use super::slot::{Slot, tightened};
use crate::interval::Interval;
use crate::number::Number;
use fidget::context::{BinaryOpcode, Context, Node, Op, UnaryOpcode};

/// A soft union of two fields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blend {
    /// Difference of the two fields below which they are blended.
    pub radius: f32,
}

impl Blend {
    /// The soft union that `root` is, and the two fields that it unites.
    pub(super) fn of(ctx: &Context, root: Node) -> Option<(Self, [Node; 2])> {
        let is = |node: Node, wanted: BinaryOpcode| match ctx.get_op(node)? {
            Op::Binary(op, a, b) if *op == wanted => Some([*a, *b]),
            _ => None,
        };
        let of = |node: Node, wanted: UnaryOpcode| match ctx.get_op(node)? {
            Op::Unary(op, a) if *op == wanted => Some(*a),
            _ => None,
        };
        let number = |n: Node| match ctx.get_op(n)? {
            Op::Const(c) => Some(c.0),
            _ => None,
        };
        // The number among two operands, which may be swapped, and the other
        // operand.
        let times = |[a, b]: [Node; 2]| match (number(a), number(b)) {
            (Some(n), None) => Some((n, b)),
            (None, Some(n)) => Some((n, a)),
            _ => None,
        };
        let [least, taken] = is(root, BinaryOpcode::Sub)?;
        let [a, b] = is(least, BinaryOpcode::Min)?;
        // An expression leaves out a factor of 1.
        let (factor, square) =
            is(taken, BinaryOpcode::Mul).map_or(Some((1.0, taken)), times)?;
        let cut = of(square, UnaryOpcode::Square)?;
        let (zero, near) = times(is(cut, BinaryOpcode::Max)?)?;
        let [radius, distance] = is(near, BinaryOpcode::Sub)?;
        let radius = number(radius)?;
        let apart = is(of(distance, UnaryOpcode::Abs)?, BinaryOpcode::Sub)?;
        // The factor is 1 / 4r, rounded to f32.
        let share = 4.0 * f64::from(factor) * f64::from(radius);
        let is_one = zero == 0.0
            && radius > 0.0
            && (apart == [a, b] || apart == [b, a])
            && (share - 1.0).abs() < 1e-6;
        is_one.then_some((Blend { radius }, [a, b]))
    }

    /// The union's value, or the range that the operations give.
    pub(super) fn value<T: Number>(self, a: T, b: T) -> T {
        let near = T::splat(self.radius).sub(a.sub(b).abs());
        let depth = near.max(T::splat(0.0)).square();
        a.min(b).sub(depth.scale(0.25 / self.radius))
    }

    /// What is known of the union over a box with these half sides.
    pub(super) fn over(self, a: &Slot, b: &Slot, half: [f64; 3]) -> Slot {
        let plain = |s: &Slot| s.range.is_finite() && !s.range.nan;
        if !plain(a) || !plain(b) {
            return tightened(self.value(*a, *b), half);
        }
        let apart = tightened(Number::sub(*a, *b), half).range;
        let r = f64::from(self.radius);
        let share = |apart: f64| (0.5 - 0.5 * apart / r).clamp(0.0, 1.0);
        let shares = [share(apart.hi), share(apart.lo)];
        let slope = std::array::from_fn(|i| {
            let [low, high] = shares.map(|w| mixed(w, a.slope[i], b.slope[i]));
            low.hull(high)
        });
        let range = Interval::new(
            self.value(a.range.lo, b.range.lo),
            self.value(a.range.hi, b.range.hi),
        );
        let centre = self.value(a.centre, b.centre);
        tightened(
            Slot {
                range,
                centre,
                slope,
            },
            half,
        )
    }

    /// Which of the two fields the union is wherever they are in these ranges,
    /// if values above `high` count as `high`: false for the first field.
    pub(super) fn passes(
        self,
        a: Interval,
        b: Interval,
        high: f64,
    ) -> Option<bool> {
        let r = f64::from(self.radius);
        let is_far = |one: Interval, other: Interval| {
            !one.nan && !other.nan && one.lo - r >= other.hi.min(high)
        };
        if a.is_empty() || b.is_empty() {
            return None;
        }
        if is_far(b, a) {
            Some(false)
        } else {
            is_far(a, b).then_some(true)
        }
    }
}

/// A slope between two, the first of which has the share `w`. A slope without a
/// share does not count, even if it is unknown.
fn mixed(w: f64, a: Interval, b: Interval) -> Interval {
    if w == 0.0 {
        return b;
    }
    if w == 1.0 {
        return a;
    }
    a.mul(Interval::point(w))
        .add(b.mul(Interval::point(1.0 - w)))
}

#[cfg(test)]
mod tests {
    use super::super::{Program, Scratch, Step};
    use super::*;
    use crate::cell::Cell;
    use fidget::context::Tree;

    fn ball(x: f32) -> Tree {
        let (ax, y, z) = Tree::axes();
        ((ax - x).square() + y.square() + z.square()).sqrt() - 2.0
    }

    /// The union as fidget's shapes write it.
    fn soft(a: &Tree, b: &Tree, radius: f32) -> Tree {
        let near = (radius - (a.clone() - b.clone()).abs()).max(0.0);
        a.min(b.clone()) - 1.0 / (4.0 * radius) * near.square()
    }

    fn program(tree: &Tree) -> Program {
        let mut context = Context::new();
        let root = context.import(tree);
        Program::new(&context, root).unwrap()
    }

    fn blends(p: &Program) -> usize {
        let is = |s: &&Step| matches!(s, Step::Blend(..));
        p.steps.iter().filter(is).count()
    }

    /// Soft unions of x and y with several radii, and expressions that are
    /// nearly soft unions.
    #[test]
    fn a_soft_union_is_known_by_its_operations() {
        let (x, y, _) = Tree::axes();
        // With 0.25 there is no factor.
        for radius in [0.25, 0.3, 1.0, 7.0] {
            assert_eq!(blends(&program(&soft(&x, &y, radius))), 1);
        }
        let steep = (1.0 - (x.clone() - y.clone()).abs()).max(0.0).square();
        assert_eq!(blends(&program(&(x.min(y) - 0.3 * steep))), 0);
    }

    /// Far from a thousand balls, each blended with all balls before it, the
    /// union is at most one radius nearer than the nearest ball.
    #[test]
    fn a_long_chain_adds_no_slack() {
        let chain = (1..1000)
            .fold(ball(0.0), |all, i| soft(&all, &ball(0.01 * i as f32), 0.5));
        let p = program(&chain);
        let cell = Cell {
            lo: [-5.0, 20.0, -5.0],
            hi: [15.0, 40.0, 5.0],
        };
        let mut scratch = Scratch::default();
        let all = p.enclose(&cell, &mut scratch);
        assert!(all.range.lo > 17.4, "{:?}", all.range);
        // This is what is known of one ball's slope.
        assert!(all.steepness[1] <= 2.0, "{:?}", all.steepness);
    }
}
