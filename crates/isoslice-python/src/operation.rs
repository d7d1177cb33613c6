//! fidget's operations on fields, by their names, which pickles have.

use fidget::context::Tree;
use isocontour::{BINARY, UNARY, binary, unary};

/// The name of an operation, by which `unary_of` and `binary_of` know it.
pub(crate) fn name_of(op: &impl std::fmt::Debug) -> String {
    format!("{op:?}").to_lowercase()
}

/// An operation on one field; nothing if none has this name.
pub(crate) fn unary_of(name: &str, f: &Tree) -> Option<Tree> {
    let (_, op) = UNARY.into_iter().find(|(known, _)| *known == name)?;
    Some(unary(op, f))
}

/// An operation on two fields; nothing if none has this name.
pub(crate) fn binary_of(name: &str, a: &Tree, b: &Tree) -> Option<Tree> {
    // `name_of` calls it "atan".
    let known = |(own, op): &(&str, _)| *own == name || name_of(op) == name;
    let (_, op) = BINARY.into_iter().find(known)?;
    Some(binary(op, a.clone(), b.clone()))
}
