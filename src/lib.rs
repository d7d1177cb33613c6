//! A slicer for implicit surfaces: from f(x, y, z) to G-code without a mesh.

pub mod bead;
pub mod layers;
pub mod model;
pub mod pipeline;
pub mod settings;
pub mod travel;
pub mod units;
