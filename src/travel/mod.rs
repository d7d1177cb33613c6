//! Contract only: what the travel stage hands on.
use crate::bead::Bead;
use crate::layers::LayerSpan;
use glam::DVec2;

/// One step of a layer's tool path, in print order.
#[derive(Clone, Debug, PartialEq)]
pub enum Move {
    /// Go through `points` without extruding, in print coordinates; the
    /// first point is where the path goes, not where the head stands.
    Travel {
        /// Way points, the last one the destination.
        points: Vec<DVec2>,
        /// Retract before and prime after.
        retract: bool,
    },
    /// Print a bead; the head stands at its first point.
    Print(Bead),
}

/// The ordered moves of one layer, in print coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerPath {
    /// The layer.
    pub span: LayerSpan,
    /// Its moves.
    pub moves: Vec<Move>,
}
