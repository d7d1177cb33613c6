//! Beads of the walls.

mod overhang;
#[cfg(test)]
mod tests;

pub(crate) use overhang::Support;

use crate::bead::{Bead, Role, Stroke};
use crate::region::Walls;
use crate::units::Mm;
use std::iter;

/// The walls' lines as beads, the outer wall's first. A part too thin for
/// walls is an outer wall, and a bead in the middle of walls is one of those that
/// it stands for. Rings shorter
/// than `small` are marked: later they may be opened, or cut.
pub(crate) fn beads(walls: &Walls, height: Mm, small: Mm) -> Vec<Bead> {
    let of = |all: &[Vec<Stroke>]| -> Vec<Bead> {
        let roles =
            iter::once(Role::OuterWall).chain(iter::repeat(Role::InnerWall));
        let lines = all.iter().zip(roles);
        lines
            .flat_map(|(lines, role)| {
                lines.iter().map(move |l| bead(l, role, height, small))
            })
            .collect()
    };
    let mut beads = of(&walls.lines);
    beads.extend(of(&walls.thin));
    beads
}

fn bead(stroke: &Stroke, role: Role, height: Mm, small: Mm) -> Bead {
    let wall = matches!(role, Role::OuterWall | Role::InnerWall);
    let ring = wall && stroke.closed;
    Bead {
        small: ring && stroke.length() < small,
        ..Bead::new(role, stroke.clone(), height)
    }
}
