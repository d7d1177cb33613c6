//! Schwarz' D surface, the diamond: two labyrinths linked like the atoms of
//! diamond, four ways from every node.
//!
//! ```text
//!   ╲╱╲╱╲╱     sin x·sin y·sin z + sin x·cos y·cos z + cos x·sin y·cos z
//!   ╱╲╱╲╱╲     + cos x·cos y·sin z = 0
//! ```

use super::sheet::Angles;

/// Schwarz' D surface.
pub(super) fn diamond(a: Angles) -> f64 {
    let (x, y, z) = (a.x, a.y, a.z);
    x.sin * (y.sin * z.sin + y.cos * z.cos)
        + x.cos * (y.sin * z.cos + y.cos * z.sin)
}
