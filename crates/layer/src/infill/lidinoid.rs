//! The lidinoid: a relative of the gyroid with a finer weave (Lidin and
//! Larsson 1990).
//!
//! ```text
//!   ≀≀≀≀≀≀     sin 2x·cos y·sin z + sin 2y·cos z·sin x + sin 2z·cos x·sin y
//!   ≀≀≀≀≀≀     − cos 2x·cos 2y − cos 2y·cos 2z − cos 2z·cos 2x + 0.3 = 0
//! ```

use super::sheet::Angles;

/// The lidinoid.
pub(super) fn lidinoid(a: Angles) -> f64 {
    let (x, y, z) = (a.x, a.y, a.z);
    let (x2, y2, z2) = (x.double(), y.double(), z.double());
    x2.sin * y.cos * z.sin + y2.sin * z.cos * x.sin + z2.sin * x.cos * y.sin
        - x2.cos * y2.cos
        - y2.cos * z2.cos
        - z2.cos * x2.cos
        + 0.3
}
