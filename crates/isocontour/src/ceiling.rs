//! Takes ceilings off an expression.
//!
//! ```text
//!        f ╱                  min(f, 0) has the same inside as f. But it is 0
//!   ──────╱┄┄┄┄┄┄ 0 ┄┄┄       all over its outside, where its values do not
//!        ╱ ▔▔▔▔▔▔ min(f, 0)   tell how far the outline is, and where they
//!       ╱                     have no slope.
//! ```
//!
//! In: an expression. Out: an expression that is negative at the same places,
//! and has the same values there. A ceiling is a number in a `min` that is not
//! below what makes a place inside, or a number in a `max` where more is inside.
//! f − |f| is 2·min(f, 0), and is taken as such.
//!
//! Not guaranteed: that all ceilings are found. Only `min`, `max`, changes of
//! sign, and sums and products with a number are looked through.

use fidget::context::{BinaryOpcode, Context, Node, Op, UnaryOpcode};
use std::collections::HashMap;

/// A part of the expression, and which of its values are inside.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Part {
    node: Node,
    /// True if values above the level are inside; otherwise those below it.
    above: bool,
    /// Bits of the level.
    level: u64,
}

impl Part {
    fn new(node: Node, above: bool, level: f64) -> Part {
        Part {
            node,
            above,
            level: level.to_bits(),
        }
    }

    fn level(self) -> f64 {
        f64::from_bits(self.level)
    }

    /// Another part that is asked the same.
    fn of(self, node: Node) -> Part {
        Part { node, ..self }
    }

    /// The operand of a change of sign.
    fn negated(self, node: Node) -> Part {
        Part::new(node, !self.above, -self.level())
    }

    /// The operand to which a number is added.
    fn plus(self, node: Node, number: f64) -> Part {
        Part::new(node, self.above, self.level() - number)
    }

    /// The operand that is multiplied by a number.
    fn times(self, node: Node, number: f64) -> Part {
        let above = self.above != (number < 0.0);
        Part::new(node, above, self.level() / number)
    }

    /// True if a number is not inside.
    fn is_outside(self, number: f64) -> bool {
        if self.above {
            number <= self.level()
        } else {
            number >= self.level()
        }
    }
}

/// How a part is made from others.
enum Made {
    /// It stays as it is.
    Same,
    /// It is another part, without its ceiling.
    Other(Part),
    /// It is twice another part, without its ceiling.
    Twice(Part),
    Negated(Part),
    /// An operation on a part and a number, in this order.
    Before(BinaryOpcode, Part, Node),
    /// An operation on a number and a part, in this order.
    After(BinaryOpcode, Node, Part),
    /// A `min` or `max` of two parts.
    Choice(BinaryOpcode, Part, Part),
}

impl Made {
    fn parts(&self) -> impl Iterator<Item = Part> {
        let (a, b) = match *self {
            Made::Same => (None, None),
            Made::Other(a)
            | Made::Twice(a)
            | Made::Negated(a)
            | Made::Before(_, a, _)
            | Made::After(_, _, a) => (Some(a), None),
            Made::Choice(_, a, b) => (Some(a), Some(b)),
        };
        a.into_iter().chain(b)
    }
}

/// Parts that are looked at, as a multiple of the expression's operations. A
/// part that is shared may be asked with many levels.
const LOOKS_PER_OPERATION: usize = 4;

/// The expression `root` without ceilings.
pub(crate) fn uncapped(ctx: &mut Context, root: Node) -> Node {
    let first = Part::new(root, false, 0.0);
    let most = LOOKS_PER_OPERATION * ctx.len();
    let mut any = false;
    let mut done: HashMap<Part, Node> = HashMap::new();
    let mut todo = vec![(first, false)];
    while let Some((part, ready)) = todo.pop() {
        if done.contains_key(&part) {
            continue;
        }
        if done.len() > most {
            return root;
        }
        let made = made(ctx, part);
        any |= matches!(made, Made::Other(_) | Made::Twice(_));
        if ready {
            done.insert(part, built(ctx, part.node, &made, &done));
        } else {
            todo.push((part, true));
            todo.extend(made.parts().map(|p| (p, false)));
        }
    }
    done.get(&first).copied().filter(|_| any).unwrap_or(root)
}

/// How a part is made.
fn made(ctx: &Context, part: Part) -> Made {
    use BinaryOpcode::{Add, Div, Max, Min, Mul, Sub};
    let number = |n: Node| match ctx.get_op(n) {
        Some(Op::Const(c)) => Some(f64::from(c.0)),
        _ => None,
    };
    let scales = |n: Node| number(n).filter(|v| *v != 0.0 && v.is_finite());
    match ctx.get_op(part.node) {
        Some(&Op::Unary(UnaryOpcode::Neg, a)) => Made::Negated(part.negated(a)),
        Some(&Op::Binary(op @ (Min | Max), a, b)) => {
            let caps = part.above == (op == Max);
            let cap = |n| number(n).is_some_and(|v| part.is_outside(v));
            match (caps && cap(a), caps && cap(b)) {
                (false, false) => Made::Choice(op, part.of(a), part.of(b)),
                (true, false) => Made::Other(part.of(b)),
                (_, true) => Made::Other(part.of(a)),
            }
        }
        Some(&Op::Binary(op @ (Add | Sub), a, b)) => {
            let sign = if op == Add { 1.0 } else { -1.0 };
            match (number(a), number(b)) {
                (_, Some(c)) => Made::Before(op, part.plus(a, sign * c), b),
                (Some(c), _) if op == Add => {
                    Made::After(op, a, part.plus(b, c))
                }
                (Some(c), _) => Made::After(op, a, part.plus(b, c).negated(b)),
                _ => folded(ctx, part, op, a, b),
            }
        }
        Some(&Op::Binary(Mul, a, b)) => match (scales(a), scales(b)) {
            (_, Some(c)) => Made::Before(Mul, part.times(a, c), b),
            (Some(c), _) => Made::After(Mul, a, part.times(b, c)),
            _ => Made::Same,
        },
        Some(&Op::Binary(Div, a, b)) => match scales(b) {
            Some(c) => Made::Before(Div, part.times(a, 1.0 / c), b),
            None => Made::Same,
        },
        _ => Made::Same,
    }
}

/// How f − |f| and f + |f| are made, which are twice min(f, 0) and max(f, 0).
fn folded(
    ctx: &Context,
    part: Part,
    op: BinaryOpcode,
    a: Node,
    b: Node,
) -> Made {
    // The expression whose size a node is, and true if the size is negated.
    let size = |n: Node| match ctx.get_op(n) {
        Some(&Op::Unary(UnaryOpcode::Abs, f)) => Some((f, false)),
        Some(&Op::Unary(UnaryOpcode::Neg, n)) => match ctx.get_op(n) {
            Some(&Op::Unary(UnaryOpcode::Abs, f)) => Some((f, true)),
            _ => None,
        },
        _ => None,
    };
    let adds = op == BinaryOpcode::Add;
    let of = |f: Node, n: Node| size(n).filter(|(g, _)| *g == f);
    let found = of(a, b).or_else(|| of(b, a).filter(|_| adds));
    match found {
        // f + |f| is never below 0, and f - |f| never above it.
        Some((f, negated))
            if part.above == (adds != negated) && part.is_outside(0.0) =>
        {
            Made::Twice(part.times(f, 2.0))
        }
        _ => Made::Same,
    }
}

/// The part, built from others that are done. It stays as it is if fidget
/// refuses, which it never does for nodes of its own.
fn built(
    ctx: &mut Context,
    node: Node,
    made: &Made,
    done: &HashMap<Part, Node>,
) -> Node {
    let of = |part: &Part| done.get(part).copied().unwrap_or(part.node);
    let result = match made {
        Made::Same => Some(node),
        Made::Other(a) => Some(of(a)),
        Made::Twice(a) => ctx.mul(of(a), 2.0).ok(),
        Made::Negated(a) => ctx.neg(of(a)).ok(),
        Made::Before(op, a, c) => binary(ctx, *op, of(a), *c),
        Made::After(op, c, a) => binary(ctx, *op, *c, of(a)),
        Made::Choice(op, a, b) => binary(ctx, *op, of(a), of(b)),
    };
    result.unwrap_or(node)
}

fn binary(
    ctx: &mut Context,
    op: BinaryOpcode,
    a: Node,
    b: Node,
) -> Option<Node> {
    let made = match op {
        BinaryOpcode::Add => ctx.add(a, b),
        BinaryOpcode::Sub => ctx.sub(a, b),
        BinaryOpcode::Mul => ctx.mul(a, b),
        BinaryOpcode::Div => ctx.div(a, b),
        BinaryOpcode::Min => ctx.min(a, b),
        _ => ctx.max(a, b),
    };
    made.ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::Tree;

    fn ball() -> Tree {
        let (x, y, z) = Tree::axes();
        (x.square() + y.square() + z.square()).sqrt() - 5.0
    }

    /// The expression of a tree, and that without ceilings.
    fn both(tree: &Tree) -> (Context, [Node; 2]) {
        let mut ctx = Context::new();
        let root = ctx.import(tree);
        let uncapped = uncapped(&mut ctx, root);
        (ctx, [root, uncapped])
    }

    #[test]
    fn ceilings_are_gone_and_the_inside_stays() {
        let f = ball();
        let wall = Tree::x().abs() - 2.0;
        let other = Tree::y() - 1.0;
        let cases = [
            f.min(0.0),
            f.min(0.0) * 3.0,
            f.min(0.5) - 0.5,
            -(-f.clone()).max(0.0),
            -(-f.clone()).max(0.0) / 2.0,
            1.0 - (1.0 - f.clone()).max(1.0),
            f.max(-1.0).min(0.0),
            f.min(0.0).max(-1.0),
            f.min(0.0).max(wall.clone()),
            f.min(0.0).min(wall.min(0.0)).max(other.min(0.0)),
            f.clone() - f.abs(),
            (f.clone() + -f.abs()) * 0.5,
        ];
        for (case, tree) in cases.into_iter().enumerate() {
            let (ctx, [plain, found]) = both(&tree);
            let mut outside = 0;
            for i in 0..2000 {
                let at = |k: f32| 8.0 * (k * 0.618 + 0.01 * i as f32).sin();
                let [x, y, z] = [1.0, 2.7, 3.9].map(|k| at(k * i as f32));
                let of = |n| ctx.eval_xyz(n, x, y, z).unwrap();
                let (a, b) = (of(plain), of(found));
                if a < 0.0 {
                    assert!((a - b).abs() < 1e-5, "{a} {b}");
                } else {
                    assert!(b > 0.0, "{case}: {a} {b}");
                    outside += 1;
                }
            }
            assert!(outside > 500);
        }
    }

    #[test]
    fn what_is_no_ceiling_stays() {
        let f = ball();
        let (x, y, _) = Tree::axes();
        for tree in [
            f.clone(),
            f.max(0.0) - 1.0,
            f.min(-1.0),
            f.max(-0.5),
            (f.min(0.0) + x.clone()).max(y.clone()),
            f.min(0.0).square() - 1.0,
            f.clone() + x.abs(),
        ] {
            let (_, [plain, found]) = both(&tree);
            assert_eq!(plain, found);
        }
    }

    /// Levels of a shared part double with each step.
    #[test]
    fn levels_do_not_multiply() {
        let mut tree = ball().min(0.0);
        for k in 0..60 {
            let by = 1.0 + 0.37_f32.powi(k);
            tree = (tree.clone() - by).min(tree * by);
        }
        both(&tree);
    }
}
