//! Takes parts that depend on one coordinate alone out of the expression.
//!
//! The lattice is aligned with the axes, so `sin(k·x)` has one value per
//! column, `sin(k·y)` one per row and `sin(k·z)` one per layer. Variables
//! replace the largest such parts, and each part is evaluated once. For a
//! gyroid a few additions and multiplications are left.

use fidget::context::UnaryOpcode;
use fidget::context::{BinaryOpcode, Context, Node, Op, Tree, TreeOp};
use fidget::var::Var;
use std::collections::HashMap;
use std::sync::Arc;

/// A part of the expression that depends on one coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// The variable that stands for the part.
    pub var: Var,
    /// 0, 1 or 2 for x, y or z.
    pub axis: usize,
    /// The part, as a node of the context in which it was found.
    pub node: Node,
}

/// An expression without its one-coordinate parts.
pub(super) struct Hoisted {
    /// The rest, with variables in place of the parts.
    pub tree: Tree,
    /// The parts that were taken out.
    pub parts: Vec<Part>,
}

/// Least work for which a part is worth a variable. An addition would cost as
/// much as reading the variable.
const WORTHWHILE: u32 = 2;
/// Greatest number of parts, of which the costliest come first. Each costs
/// memory for every column, row or layer.
const MOST_PARTS: usize = 1000;

/// What is known of a node.
#[derive(Clone, Copy)]
struct Known {
    /// One bit for each coordinate on which the node depends.
    axes: u8,
    /// The node's cost, about as many additions.
    cost: u32,
}

fn cost_of(op: &Op) -> u32 {
    use BinaryOpcode as B;
    use UnaryOpcode as U;
    match op {
        Op::Input(_) | Op::Const(_) => 0,
        Op::Unary(
            U::Sin
            | U::Cos
            | U::Tan
            | U::Asin
            | U::Acos
            | U::Atan
            | U::Exp
            | U::Ln
            | U::Rand,
            _,
        )
        | Op::Binary(B::Atan | B::Mod | B::Mix, ..) => 20,
        Op::Unary(U::Sqrt | U::Recip, _) | Op::Binary(B::Div, ..) => 4,
        Op::Unary(..) | Op::Binary(..) => 1,
    }
}

/// Nodes on which `root` depends, operands before the nodes that use them. What
/// is below `taken` nodes alone is left out.
pub(super) fn in_order(
    ctx: &Context,
    root: Node,
    taken: &HashMap<Node, Var>,
) -> Vec<Node> {
    let mut order = Vec::new();
    let mut seen: HashMap<Node, bool> = HashMap::new();
    let mut todo = vec![root];
    while let Some(&node) = todo.last() {
        match seen.get(&node) {
            None => {
                seen.insert(node, false);
                if let Some(op) = ctx.get_op(node)
                    && !taken.contains_key(&node)
                {
                    todo.extend(
                        op.iter_children().filter(|c| !seen.contains_key(c)),
                    );
                }
            }
            Some(false) => {
                seen.insert(node, true);
                order.push(node);
                todo.pop();
            }
            Some(true) => {
                todo.pop();
            }
        }
    }
    order
}

/// Takes the one-coordinate parts out of the expression `root`.
pub(super) fn hoist(ctx: &Context, root: Node) -> Hoisted {
    let order = in_order(ctx, root, &HashMap::new());
    let mut known: HashMap<Node, Known> = HashMap::new();
    for &node in &order {
        let Some(op) = ctx.get_op(node) else { continue };
        let own = match op {
            Op::Input(Var::X) => 1,
            Op::Input(Var::Y) => 2,
            Op::Input(Var::Z) => 4,
            // This is another variable: nothing above it is hoisted.
            Op::Input(Var::V(_)) => 7,
            _ => 0,
        };
        let of = op.iter_children().filter_map(|c| known.get(&c));
        let all = of.fold(
            Known {
                axes: own,
                cost: cost_of(op),
            },
            |sum, k| Known {
                axes: sum.axes | k.axes,
                cost: sum.cost.saturating_add(k.cost),
            },
        );
        known.insert(node, all);
    }
    let single = |n: &Node| {
        known
            .get(n)
            .filter(|k| k.axes.count_ones() == 1 && k.cost >= WORTHWHILE)
    };
    // The largest parts are those that an operation on more coordinates uses.
    let mut largest: Vec<(u32, Node)> = Vec::new();
    let mut taken: HashMap<Node, Var> = HashMap::new();
    let mut take = |node: Node| {
        if let Some(k) = single(&node)
            && !taken.contains_key(&node)
        {
            taken.insert(node, Var::new());
            largest.push((k.cost, node));
        }
    };
    take(root);
    for node in &order {
        let whole = known.get(node).is_some_and(|k| k.axes.count_ones() > 1);
        if let (true, Some(op)) = (whole, ctx.get_op(*node)) {
            op.iter_children().for_each(&mut take);
        }
    }
    largest.sort_by_key(|(cost, _)| std::cmp::Reverse(*cost));
    for (_, node) in largest.drain(MOST_PARTS.min(largest.len())..) {
        taken.remove(&node);
    }
    let parts = largest
        .iter()
        .filter_map(|(_, node)| {
            Some(Part {
                var: *taken.get(node)?,
                axis: known.get(node)?.axes.trailing_zeros() as usize,
                node: *node,
            })
        })
        .collect();
    Hoisted {
        tree: rest(ctx, &order, &taken),
        parts,
    }
}

/// The expression with variables in place of the `taken` nodes. The root is
/// the last of `order`.
pub(super) fn rest(
    ctx: &Context,
    order: &[Node],
    taken: &HashMap<Node, Var>,
) -> Tree {
    rebuilt(ctx, order, |node, _| {
        taken.get(&node).copied().map(TreeOp::Input)
    })
}

/// What a node has become.
pub(super) type Term = Arc<TreeOp>;

/// The expression with other operations in place of those nodes for which
/// `instead` has one. It is told of a node, and what nodes before have become. The
/// root is the last of `order`.
pub(super) fn rebuilt(
    ctx: &Context,
    order: &[Node],
    mut instead: impl FnMut(Node, &dyn Fn(&Node) -> Term) -> Option<TreeOp>,
) -> Tree {
    let mut made: HashMap<Node, Term> = HashMap::new();
    let nan = Arc::new(TreeOp::Const(f32::NAN));
    let mut tree = Tree::constant(f32::NAN);
    for (k, node) in order.iter().enumerate() {
        let of = |n: &Node| made.get(n).unwrap_or(&nan).clone();
        let op = match (instead(*node, &of), ctx.get_op(*node)) {
            (Some(op), _) => op,
            (None, Some(Op::Input(var))) => TreeOp::Input(*var),
            (None, Some(Op::Const(c))) => TreeOp::Const(c.0),
            (None, Some(Op::Unary(op, a))) => TreeOp::Unary(*op, of(a)),
            (None, Some(Op::Binary(op, a, b))) => {
                TreeOp::Binary(*op, of(a), of(b))
            }
            (None, None) => continue,
        };
        if k + 1 == order.len() {
            tree = Tree::from(op);
        } else {
            made.insert(*node, Arc::new(op));
        }
    }
    tree
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hoisted(tree: &Tree) -> (Context, Hoisted) {
        let mut ctx = Context::new();
        let root = ctx.import(tree);
        let h = hoist(&ctx, root);
        (ctx, h)
    }

    #[test]
    fn the_largest_parts_of_one_coordinate_are_taken_once() {
        let (x, y, z) = Tree::axes();
        let sx = (x.clone() * 0.5).sin();
        let tree = (sx.clone() * y.cos() + sx * z.exp() + x).max(y + 1.0);
        let (_, h) = hoisted(&tree);
        let axes: Vec<usize> = h.parts.iter().map(|p| p.axis).collect();
        // The parts are sin(x/2), cos(y) and exp(z). x and y + 1 are not worth
        // a variable.
        assert_eq!(h.parts.len(), 3);
        assert!((0..3).all(|a| axes.contains(&a)), "{axes:?}");
    }

    #[test]
    fn an_expression_of_one_coordinate_is_one_part() {
        let (_, h) = hoisted(&((Tree::z() - 1.0).abs() - 0.5));
        assert_eq!((h.parts.len(), h.parts[0].axis), (1, 2));
        assert!(matches!(&*h.tree, TreeOp::Input(Var::V(_))));
    }

    #[test]
    fn what_is_left_with_the_parts_put_back_is_the_expression() {
        let (x, y, z) = Tree::axes();
        let wave = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
        let tree =
            wave.max((x.square() + y.square() + z.square()).sqrt() - 5.0);
        let (ctx, h) = hoisted(&tree);
        let mut rest = Context::new();
        let root = rest.import(&h.tree);
        for p in [[0.3, -1.0, 2.0], [4.0, 0.1, -3.3], [-0.7, 9.0, 0.5]] {
            let [x, y, z] = p;
            let whole = {
                let mut c = Context::new();
                let r = c.import(&tree);
                c.eval_xyz(r, x, y, z).unwrap()
            };
            let mut vars: HashMap<Var, f32> =
                [(Var::X, x), (Var::Y, y), (Var::Z, z)].into();
            for part in &h.parts {
                vars.insert(
                    part.var,
                    ctx.eval_xyz(part.node, x, y, z).unwrap(),
                );
            }
            let put_back = rest.eval(root, &vars).unwrap();
            assert_eq!(whole.to_bits(), put_back.to_bits());
        }
    }
}
