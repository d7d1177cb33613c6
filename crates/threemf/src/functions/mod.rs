//! Functions of the volumetric and the implicit extension.
//!
//! In: elements of a model file. Out: expressions.
//!
//! ```text
//!  <implicitfunction id="5">        inputs: pos, radius
//!    <length identifier="a">        a.result  = length(inputs.pos)
//!    <subtraction identifier="b">   b.result  = a.result − inputs.radius
//!    <out>                          shape     = b.result
//! ```
//!
//! | file | what it does |
//! |---|---|
//! | `graph` | nodes and their links, as files have them, and their order |
//! | `value` | numbers, vectors and matrices, as expressions |
//! | `op` | what each kind of node makes of its inputs |
//! | `inverse` | the inverse of a matrix of expressions |
//! | `image` | stacks of pictures |
//! | `evaluate` | makes expressions of functions |
//!
//! A function is evaluated once for each call, with expressions in the place of
//! numbers, so that what comes out is an expression like any other. Only nodes
//! that its outputs need are looked at. Constants have 24 bits, as they do in
//! all expressions.

pub(crate) mod evaluate;
pub(crate) mod graph;
pub(crate) mod image;
mod inverse;
pub(crate) mod op;
pub(crate) mod value;

use graph::Graph;
use image::ImageFunction;

/// A function of a model file.
#[derive(Debug)]
pub(crate) enum Function {
    Graph(Graph),
    Image(ImageFunction),
}
