//! A honeycomb: hexagonal tubes, at equal places in every layer.
//!
//! ```text
//!   ╲__╱  ╲__╱  ╲      Each line zigzags between its neighbours and shares its
//!   ╱‾‾╲__╱‾‾╲__╱      level sides with them: two beads lie side by side there.
//!   ╲__╱‾‾╲__╱‾‾╲      So no bead crosses another, and a line is as long as the
//!                      area is wide.
//! ```

use super::{Layer, Pattern};
use glam::DVec2;
use isoslice_planar::Rect;
use isoslice_planar::border::{Cutter, LinePiece};

/// Hexagons.
pub(super) struct Hexagons;

impl Pattern for Hexagons {
    fn pieces(&self, layer: &Layer<'_>) -> Vec<LinePiece> {
        // With sides of length a, a zigzag is 4·a long for each 3·a of way, and
        // the next zigzag is a·sin 60° and half a bead on either side away.
        let pitch = 4.0 / 3.0 * layer.solid / layer.density.mean();
        let rise = (pitch - layer.solid).max(0.0);
        let side = rise / (0.75_f64).sqrt();
        let period = 3.0 * side;
        if side < layer.shortest * 0.25 {
            return Vec::new();
        }
        let frame = layer.frame();
        let bounds = frame.bounds(layer.border.bounds());
        let first = ((bounds.min.y - rise) / pitch).floor() as i64;
        let last = ((bounds.max.y + rise) / pitch).ceil() as i64;
        let left = (bounds.min.x / period).floor() as i64 - 1;
        let right = (bounds.max.x / period).ceil() as i64 + 1;
        let mut cutter = Cutter::new(layer.border);
        for row in first..=last {
            // Neighbouring lines mirror each other.
            let high = if row.rem_euclid(2) == 0 { 0.5 } else { -0.5 };
            let middle = row as f64 * pitch;
            cutter.end();
            for column in left..=right {
                let x = column as f64 * period;
                let one = [
                    (0.0, high),
                    (side, high),
                    (1.5 * side, -high),
                    (2.5 * side, -high),
                ]
                .map(|(along, up)| {
                    frame.out(DVec2::new(x + along, middle + up * rise))
                });
                cutter.run(&one, Rect::around(&one));
            }
        }
        cutter.finish()
    }

    // The zigzags of two densities do not meet.
    fn can_vary(&self) -> bool {
        false
    }
}
