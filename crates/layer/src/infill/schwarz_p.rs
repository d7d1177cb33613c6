//! Schwarz' P surface: chambers with a round window to each of their six
//! neighbours (Schwarz 1890).
//!
//! ```text
//!    ( )( )( )     cos x + cos y + cos z = 0:
//!    ( )( )( )     rings around the chambers' middles at one height, around
//!                  what is between them half a cell above
//! ```

use super::sheet::Angles;

/// Schwarz' P surface.
pub(super) fn schwarz_p(a: Angles) -> f64 {
    a.x.cos + a.y.cos + a.z.cos
}
