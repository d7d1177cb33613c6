//! Beads of the walls.

use crate::bead::{Bead, Role};
use crate::region::Walls;
use crate::units::Mm;

/// The walls' centre lines as closed beads, the outer wall's first.
pub fn beads(walls: &Walls, height: Mm) -> Vec<Bead> {
    let mut beads = Vec::new();
    for (depth, (area, &width)) in
        walls.lines.iter().zip(&walls.widths).enumerate()
    {
        let role = match depth {
            0 => Role::OuterWall,
            _ => Role::InnerWall,
        };
        beads.extend(area.rings.iter().map(|ring| Bead {
            role,
            points: ring.clone(),
            closed: true,
            width,
            height,
        }));
    }
    beads
}
