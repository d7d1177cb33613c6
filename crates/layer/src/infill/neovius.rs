//! Neovius' surface: the relative of Schwarz' P with twelve windows to a
//! chamber (Neovius 1883).
//!
//! ```text
//!   ╭─╮╭─╮     3·(cos x + cos y + cos z) + 4·cos x·cos y·cos z = 0
//!   ╰─╯╰─╯
//! ```

use super::sheet::Angles;

/// Neovius' surface.
pub(super) fn neovius(a: Angles) -> f64 {
    let (x, y, z) = (a.x.cos, a.y.cos, a.z.cos);
    3.0 * (x + y + z) + 4.0 * x * y * z
}
