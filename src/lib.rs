//! A slicer for implicit surfaces: from f(x, y, z) to G-code without a mesh.

pub mod adhesion;
pub mod bead;
pub mod contour;
pub mod field;
pub mod gcode;
pub mod infill;
pub mod layers;
pub mod model;
pub mod order;
pub mod pace;
pub mod pipeline;
pub mod plane;
pub mod preview;
pub mod region;
pub mod settings;
pub mod skin;
pub mod timings;
pub mod travel;
pub mod units;
pub mod walls;
