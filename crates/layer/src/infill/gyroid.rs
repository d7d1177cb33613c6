//! The gyroid: a surface without straight lines or mirror planes that parts
//! space into two equal labyrinths (Schoen 1970). It is equally stiff in all
//! directions, its lines do not cross, and every layer is a set of long waves.
//!
//! ```text
//!   ∿∿∿∿∿∿∿∿     sin x·cos y + sin y·cos z + sin z·cos x = 0:
//!   ∿∿∿∿∿∿∿∿     waves along x at one height, along y a quarter of a cell
//!   ∿∿∿∿∿∿∿∿     above
//! ```

use super::sheet::Angles;

/// The gyroid.
pub(super) fn gyroid(a: Angles) -> f64 {
    a.x.sin * a.y.cos + a.y.sin * a.z.cos + a.z.sin * a.x.cos
}
