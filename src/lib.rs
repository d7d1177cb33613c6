//! A slicer for implicit surfaces: from f(x, y, z) to G-code without a mesh.

pub mod bead;
pub mod contour;
pub mod field;
pub mod layers;
pub mod model;
pub mod plane;
pub mod settings;
pub mod travel;
pub mod units;
