//! Beads of the walls.

mod overhang;

pub use overhang::Support;

use crate::bead::{Bead, Role};
use crate::region::Walls;
use crate::region::line::Line;
use crate::units::Mm;

/// The walls' lines as beads, the outer wall's first. A part too thin for
/// walls is an outer wall, what is too thin between walls a gap.
pub fn beads(walls: &Walls, height: Mm) -> Vec<Bead> {
    let rings = walls.lines.iter().enumerate().flat_map(|(depth, lines)| {
        let role = match depth {
            0 => Role::OuterWall,
            _ => Role::InnerWall,
        };
        lines.iter().map(move |l| bead(l, role, height))
    });
    let thin = walls.thin.iter().enumerate().flat_map(|(depth, lines)| {
        let role = match depth {
            0 => Role::OuterWall,
            _ => Role::GapFill,
        };
        lines.iter().map(move |l| bead(l, role, height))
    });
    rings.chain(thin).collect()
}

fn bead(line: &Line, role: Role, height: Mm) -> Bead {
    Bead {
        role,
        points: line.points.clone(),
        closed: line.closed,
        width: line.width,
        widths: line.widths.clone(),
        height,
    }
}
