//! Why a part cannot be one wall that climbs.

use glam::DVec2;
use isoslice_base::units::Mm;

/// Why a part cannot be one wall.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SpiralError {
    /// The part falls into several pieces.
    #[error(
        "spiral: at z = {z:.2} mm (layer {layer}) the part consists of \
         {count} pieces, at {} and {}; a spiral is one wall, so join them, \
         or set spiral = false",
        place(.at[0]), place(.at[1])
    )]
    Pieces {
        /// Height of the layer's middle, mm.
        z: Mm,
        /// Layer, from 1.
        layer: usize,
        /// Number of pieces.
        count: usize,
        /// A point on each of the two largest ones, on the bed.
        at: [DVec2; 2],
    },
    /// The part is thinner than the wall.
    #[error(
        "spiral: at z = {z:.2} mm (layer {layer}) the part is thinner \
         than its wall ({width:.2} mm); make it thicker or lower \
         outer_wall_width"
    )]
    TooThin {
        /// Height of the layer's middle, mm.
        z: Mm,
        /// Layer, from 1.
        layer: usize,
        /// Width of the wall, mm.
        width: Mm,
    },
    /// A wall inside the first one has no room.
    #[error(
        "spiral = {walls}: at z = {z:.2} mm (layer {layer}) there is no \
         room for wall {wall} all the way round, beside x = {:.1}, y = {:.1}; \
         make the part thicker there, or set spiral = {}",
        .at.x, .at.y, .wall - 1
    )]
    NoRoom {
        /// How many walls were asked for.
        walls: u32,
        /// The wall, from the outside; that is wall 1.
        wall: u32,
        /// Height of the layer's middle, mm.
        z: Mm,
        /// Layer, from 1.
        layer: usize,
        /// A point on the wall outside of it, on the bed.
        at: DVec2,
    },
    /// A high skirt would stand beside the wall.
    #[error(
        "skirt.layers = {skirt} would stand beside the climbing wall (spiral = \
         true), which begins after {flat} flat layers and goes on without a \
         stop; set skirt.layers to {flat} or less, or spiral = false"
    )]
    Skirt {
        /// The skirt's layers.
        skirt: usize,
        /// Flat layers below the wall.
        flat: usize,
    },
}

fn place(p: DVec2) -> String {
    format!("x = {:.1}, y = {:.1}", p.x, p.y)
}
