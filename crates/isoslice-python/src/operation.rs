//! fidget's operations on fields, by their names, which pickles have.

use fidget::context::Tree;

/// The name of an operation, by which `unary_of` and `binary_of` know it.
pub(crate) fn name_of(op: &impl std::fmt::Debug) -> String {
    format!("{op:?}").to_lowercase()
}

/// An operation on one field; nothing if none has this name.
pub(crate) fn unary_of(name: &str, f: &Tree) -> Option<Tree> {
    Some(match name {
        "neg" => f.neg(),
        "sqrt" => f.sqrt(),
        "sin" => f.sin(),
        "cos" => f.cos(),
        "tan" => f.tan(),
        "asin" => f.asin(),
        "acos" => f.acos(),
        "atan" => f.atan(),
        "exp" => f.exp(),
        "ln" => f.ln(),
        "abs" => f.abs(),
        "floor" => f.floor(),
        "ceil" => f.ceil(),
        "round" => f.round(),
        "square" => f.square(),
        "recip" => f.recip(),
        "not" => f.not(),
        "rand" => f.rand(),
        _ => return None,
    })
}

/// An operation on two fields; nothing if none has this name.
pub(crate) fn binary_of(name: &str, a: &Tree, b: &Tree) -> Option<Tree> {
    let (a, b) = (a.clone(), b.clone());
    Some(match name {
        "add" => a + b,
        "sub" => a - b,
        "mul" => a * b,
        "div" => a / b,
        "min" => a.min(b),
        "max" => a.max(b),
        "atan2" | "atan" => a.atan2(b),
        "mod" => a.modulo(b),
        "compare" => a.compare(b),
        "and" => a.and(b),
        "or" => a.or(b),
        "mix" => a.mix(b),
        _ => return None,
    })
}
