//! Expanding an expression tree within a budget.
//!
//! In: a fidget `Tree`. Out: the deduplicated `Context` and its root, or the
//! reason why not.
//!
//! Trees hold remappings lazily: a node that is remapped twice is expanded
//! twice when it is imported. So thirty nested remaps in a script of thirty
//! lines ask for 2³⁰ nodes. The size of the expansion is therefore counted
//! first, which takes time in proportion to the tree's own size.
//!
//! Guarantees: no recursion on the stack, whatever the depth of the tree.

use crate::data::{call_of, known};
use crate::tree::operands;
use fidget::context::{Context, Node, Tree, TreeOp};
use fidget::var::Var;
use std::collections::{HashMap, HashSet};

/// Largest number of nodes to which an expression may expand. The largest
/// published fidget model has about 10,000. Generated lattices reach some
/// 100,000.
pub const MAX_EXPANDED_NODES: u64 = 2_000_000;

/// Why an expression cannot be used.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum ExpandError {
    /// The expression has more nodes than the budget allows.
    #[error(
        "the expression expands to more than {limit} operations: nested \
         remaps multiply it; repeat shapes with `%` (modulo) or `abs` of a \
         coordinate instead of remapped copies"
    )]
    TooLarge {
        /// The budget.
        limit: u64,
    },
    /// The expression has an input besides the coordinates.
    #[error(
        "the expression depends on a variable other than x, y and z; \
         replace it by a number"
    )]
    FreeVariable,
}

/// Imports a tree of x, y and z if its expansion fits the budget.
pub fn expand(tree: &Tree) -> Result<(Context, Node), ExpandError> {
    expand_with(tree, None)
}

/// Imports a tree in which there may be one more variable.
pub fn expand_with(
    tree: &Tree,
    variable: Option<Var>,
) -> Result<(Context, Node), ExpandError> {
    check_size(tree, variable, MAX_EXPANDED_NODES)?;
    let mut context = Context::new();
    let root = context.import(tree);
    Ok((context, root))
}

/// The nodes that make up an expression, each once and after its operands. A
/// call of data is one node, whose operands are the coordinates of its place.
///
/// What tells expressions from one another walks for itself: a fingerprint has
/// each operation inside a call, and an order that must never change.
pub fn nodes_of(context: &Context, root: Node) -> Vec<Node> {
    let mut order = Vec::new();
    let mut done = HashSet::new();
    let mut todo = vec![(root, false)];
    while let Some((node, is_ready)) = todo.pop() {
        if done.contains(&node) {
            continue;
        }
        if is_ready {
            done.insert(node);
            order.push(node);
            continue;
        }
        todo.push((node, true));
        match (call_of(context, node), context.get_op(node)) {
            (Some(call), _) => todo.extend(call.at.map(|n| (n, false))),
            (None, Some(op)) => {
                todo.extend(op.iter_children().map(|n| (n, false)));
            }
            (None, None) => {}
        }
    }
    order
}

/// One frame of coordinates: the nodes reached from its root without entering
/// the target of a remapping.
struct Frame<'a> {
    nodes: u64,
    /// Targets of the remappings met, once for each way to reach them.
    targets: Vec<&'a TreeOp>,
}

/// Collects a frame. `scanned` counts over all frames.
fn scan<'a>(
    root: &'a TreeOp,
    variable: Option<Var>,
    scanned: &mut u64,
    limit: u64,
) -> Result<Frame<'a>, ExpandError> {
    let mut seen: HashSet<*const TreeOp> = HashSet::new();
    let mut targets = Vec::new();
    let mut nodes = 0u64;
    let mut todo = vec![root];
    while let Some(op) = todo.pop() {
        // Every visit counts, repeated ones included, since importing pays for
        // them as well.
        nodes += 1;
        *scanned += 1;
        if *scanned > limit {
            return Err(ExpandError::TooLarge { limit });
        }
        match op {
            TreeOp::Input(v @ Var::V(_))
                if Some(*v) != variable && known(*v).is_none() =>
            {
                return Err(ExpandError::FreeVariable);
            }
            TreeOp::Input(_) | TreeOp::Const(_) => {}
            TreeOp::Unary(..) | TreeOp::Binary(..) => {
                if seen.insert(op) {
                    todo.extend(operands(op));
                }
            }
            // fidget does not cache remappings, so `seen` does not matter here.
            TreeOp::RemapAxes { target, x, y, z } => {
                todo.extend([&**x, &**y, &**z]);
                targets.push(&**target);
            }
            TreeOp::RemapAffine { target, .. } => targets.push(target),
        }
    }
    Ok(Frame { nodes, targets })
}

/// Counts the nodes that importing `tree` would visit, without visiting them. A
/// frame costs its own nodes and its targets' frames. A target costs the same
/// wherever it is met.
fn check_size(
    tree: &Tree,
    variable: Option<Var>,
    limit: u64,
) -> Result<(), ExpandError> {
    let root: &TreeOp = tree;
    let mut scanned = 0;
    let mut frames: HashMap<*const TreeOp, Frame> = HashMap::new();
    let mut cost: HashMap<*const TreeOp, u64> = HashMap::new();
    let mut todo = vec![root];
    while let Some(op) = todo.pop() {
        let key: *const TreeOp = op;
        if cost.contains_key(&key) {
            continue;
        }
        let Some(frame) = frames.get(&key) else {
            let frame = scan(op, variable, &mut scanned, limit)?;
            todo.push(op);
            todo.extend(frame.targets.iter().copied());
            frames.insert(key, frame);
            continue;
        };
        let mut total = frame.nodes;
        for target in &frame.targets {
            let target: *const TreeOp = *target;
            let part = cost.get(&target).copied().unwrap_or(0);
            total = total.saturating_add(part);
        }
        if total > limit {
            return Err(ExpandError::TooLarge { limit });
        }
        cost.insert(key, total);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_remaps_are_refused_before_they_are_expanded() {
        let mut tree = Tree::x().sin() + Tree::y();
        for _ in 0..40 {
            tree = tree.remap_xyz(
                tree.clone(),
                Tree::y() + 1.0,
                tree.clone() * 2.0,
            );
        }
        let start = std::time::Instant::now();
        assert!(matches!(expand(&tree), Err(ExpandError::TooLarge { .. })));
        assert!(start.elapsed().as_secs() < 5);
    }

    #[test]
    fn a_few_remaps_are_expanded() {
        let mut tree = Tree::x().sin() + Tree::y();
        for i in 0..8 {
            let turned =
                tree.remap_xyz(Tree::y(), Tree::x() + i as f32, Tree::z());
            tree = tree.min(turned);
        }
        let (context, _) = expand(&tree).unwrap();
        assert!(context.len() > 100);
    }

    #[test]
    fn deep_trees_do_not_overflow_the_stack() {
        let mut tree = Tree::x();
        for i in 0..100_000 {
            tree = tree.clone() + (tree * 0.001).sin() + i as f32;
        }
        let (context, _) = expand(&tree).unwrap();
        assert!(context.len() > 300_000);
        let mut tree = Tree::x();
        for _ in 0..100_000 {
            tree = tree
                .remap_xyz(Tree::x() + 1.0, Tree::y(), Tree::z())
                .min(0.5);
        }
        expand(&tree).unwrap();
    }

    #[test]
    fn free_variables_are_refused() {
        let tree = Tree::x() + Tree::from(Var::new());
        assert_eq!(expand(&tree).err(), Some(ExpandError::FreeVariable));
    }
}
