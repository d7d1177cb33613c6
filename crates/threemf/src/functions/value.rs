//! Numbers, vectors and matrices, as expressions.

use fidget::context::{Tree, TreeOp};

/// What a link or an output is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Type {
    Scalar,
    Vector,
    /// 4 × 4 numbers.
    Matrix,
    /// The number of a function or a mesh.
    Resource,
}

impl Type {
    /// The type that the name of an element says: `scalar`, `scalarref`.
    pub(crate) fn of(name: &str) -> Option<Type> {
        match name.strip_suffix("ref").unwrap_or(name) {
            "scalar" => Some(Type::Scalar),
            "vector" => Some(Type::Vector),
            "matrix" => Some(Type::Matrix),
            "resource" | "resourceid" => Some(Type::Resource),
            _ => None,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Type::Scalar => "scalar",
            Type::Vector => "vector",
            Type::Matrix => "matrix",
            Type::Resource => "resource",
        }
    }
}

/// What a node gives.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    /// A scalar, a vector, or a matrix row by row.
    Numbers(Type, Vec<Tree>),
    Resource(u32),
}

impl Value {
    pub(crate) fn scalar(x: Tree) -> Value {
        Value::Numbers(Type::Scalar, vec![x])
    }

    pub(crate) fn vector(parts: [Tree; 3]) -> Value {
        Value::Numbers(Type::Vector, parts.into())
    }

    pub(crate) fn matrix(parts: Vec<Tree>) -> Value {
        Value::Numbers(Type::Matrix, parts)
    }

    pub(crate) fn kind(&self) -> Type {
        match self {
            Value::Numbers(kind, _) => *kind,
            Value::Resource(_) => Type::Resource,
        }
    }

    pub(crate) fn parts(&self) -> &[Tree] {
        match self {
            Value::Numbers(_, parts) => parts,
            Value::Resource(_) => &[],
        }
    }
}

/// A constant.
pub(crate) fn number(x: f64) -> Tree {
    Tree::constant(x as f32)
}

/// The number that an expression is, if it is one.
pub(crate) fn constant(tree: &Tree) -> Option<f64> {
    match &**tree {
        TreeOp::Const(x) => Some(f64::from(*x)),
        _ => None,
    }
}
