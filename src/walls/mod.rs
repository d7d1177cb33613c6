//! Beads of the walls.

mod overhang;
#[cfg(test)]
mod tests;

pub(crate) use overhang::Support;

use crate::bead::{Bead, Role, Stroke};
use crate::region::Walls;
use crate::units::Mm;

/// The walls' lines as beads, the outer wall's first. A part too thin for
/// walls is an outer wall, what is too thin between walls a gap. Rings shorter
/// than `small` are marked: later they may be opened, or cut.
pub(crate) fn beads(walls: &Walls, height: Mm, small: Mm) -> Vec<Bead> {
    let rings = walls.lines.iter().enumerate().flat_map(|(depth, lines)| {
        let role = match depth {
            0 => Role::OuterWall,
            _ => Role::InnerWall,
        };
        lines.iter().map(move |l| bead(l, role, height, small))
    });
    let thin = walls.thin.iter().enumerate().flat_map(|(depth, lines)| {
        let role = match depth {
            0 => Role::OuterWall,
            _ => Role::GapFill,
        };
        lines.iter().map(move |l| bead(l, role, height, small))
    });
    rings.chain(thin).collect()
}

fn bead(stroke: &Stroke, role: Role, height: Mm, small: Mm) -> Bead {
    let wall = matches!(role, Role::OuterWall | Role::InnerWall);
    let ring = wall && stroke.closed;
    Bead {
        small: ring && stroke.length() < small,
        ..Bead::new(role, stroke.clone(), height)
    }
}
