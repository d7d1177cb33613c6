//! A model as words, to tell whether two models are the same.
//!
//! In: a placed model. Out: its operations, each once and in an order that
//! follows from the expression alone, its name and its place. Models with the
//! same words have the same outlines. Not guaranteed: that models with the same
//! outlines have the same words.

use super::placement::Model;
use fidget::context::{Node, Op, Tree};
use isocontour::{Data, ExpandError, expand, known_data};
use md5::{Digest, Md5};
use std::collections::HashMap;

impl Model {
    /// Tells the words that stand for the model.
    ///
    /// # Errors
    /// If the expression is too large to be sliced.
    pub fn words(&self, tell: &mut dyn FnMut(&str)) -> Result<(), ExpandError> {
        tell(&self.name);
        let Model { bounds, offset, .. } = self;
        for at in [bounds.min, bounds.max, *offset, self.origin] {
            // Shortest digits that are read back as the same number.
            tell(&format!("{:?} {:?} {:?}", at.x, at.y, at.z));
        }
        tell(&format!("{:?}", self.lift));
        operations(&self.tree, tell)
    }
}

/// Tells the operations of an expression.
///
/// # Errors
/// If the expression is too large to be sliced.
pub fn operations(
    tree: &Tree,
    tell: &mut dyn FnMut(&str),
) -> Result<(), ExpandError> {
    let (context, root) = expand(tree)?;
    let mut numbers: HashMap<Node, usize> = HashMap::new();
    // A node, and whether its operands have been told.
    let mut todo = vec![(root, false)];
    while let Some((node, ready)) = todo.pop() {
        let Some(op) = context.get_op(node) else {
            continue;
        };
        if numbers.contains_key(&node) {
            continue;
        }
        let operands = match *op {
            Op::Input(_) | Op::Const(_) => [None, None],
            Op::Unary(_, a) => [Some(a), None],
            Op::Binary(_, a, b) => [Some(a), Some(b)],
        };
        if !ready {
            todo.push((node, true));
            let operands = operands.iter().rev().flatten();
            todo.extend(operands.map(|&operand| (operand, false)));
            continue;
        }
        let number = |node: &Node| numbers.get(node).copied();
        let from = operands.iter().flatten().filter_map(number);
        let from: Vec<usize> = from.collect();
        match op {
            Op::Input(variable) => match known_data(*variable) {
                Some(data) => tell(&fingerprint(&*data)),
                None => tell(&format!("{variable:?}")),
            },
            Op::Const(value) => tell(&format!("{:08x}", value.0.to_bits())),
            Op::Unary(op, _) => tell(&format!("{op:?} {from:?}")),
            Op::Binary(op, ..) => tell(&format!("{op:?} {from:?}")),
        }
        numbers.insert(node, numbers.len());
    }
    Ok(())
}

/// What tells data from other data. The variable that stands for it is another
/// one in each run.
fn fingerprint(data: &dyn Data) -> String {
    let mut hash = Md5::new();
    data.contents(&mut |bytes| hash.update(bytes));
    let digits = hash.finalize();
    digits.iter().map(|byte| format!("{byte:02x}")).collect()
}
