//! Beads of the walls.

use super::Walls;
use crate::resolution::Resolution;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::arc;
use isoslice_planar::bead::{Bead, Plane, Role, Stroke};
use std::iter;

/// The walls' lines as beads, the outer wall's first. A part too thin for walls
/// is an outer wall. A bead in the middle of walls fills a gap, unless it goes
/// on in one of the walls. The lengths of rings are kept, since later stages may
/// open or cut them.
pub fn beads(walls: &Walls, height: Mm) -> Vec<Bead> {
    let all = walls.lines.iter().zip(roles(Role::InnerWall));
    all.chain(walls.thin.iter().zip(roles(Role::GapFill)))
        .flat_map(|(lines, role)| {
            lines.iter().map(move |l| bead(l, role, height))
        })
        .collect()
}

/// Does what [`beads`] does for walls that interlock: every other inner wall is
/// to lie half a layer lower.
pub fn interlocked(walls: &Walls, height: Mm) -> Vec<Bead> {
    let mut all = beads(walls, height);
    // The beads come in the order of the walls.
    let mut counted = 0;
    for (k, lines) in walls.lines.iter().enumerate() {
        let of_wall = &mut all[counted..counted + lines.len()];
        for bead in of_wall.iter_mut().filter(|_| k % 2 == 1) {
            bead.plane = Plane::HalfLower;
        }
        counted += lines.len();
    }
    all
}

/// Thins the walls' lines to what their roles permit.
pub fn thin(walls: &mut Walls, resolution: Resolution) {
    let all = walls.lines.iter_mut().zip(roles(Role::InnerWall));
    let thin = walls.thin.iter_mut().zip(roles(Role::GapFill));
    for (lines, role) in all.chain(thin) {
        for line in lines {
            resolution.thin(line, role);
        }
    }
}

/// The walls, where arcs are laid along walls of one width and stand as fine
/// polygons. The arcs begin at each wall's first point; in the print they begin
/// at its seam.
pub fn rounded(walls: &Walls, resolution: Resolution) -> Walls {
    /// Greatest distance of the polygons from the arcs, mm.
    const FLAT: Mm = 0.0002;
    let mut walls = walls.clone();
    for (lines, role) in walls.lines.iter_mut().zip(roles(Role::InnerWall)) {
        for line in lines.iter_mut().filter(|l| l.widths.is_empty()) {
            let path: Vec<DVec2> = line.path().collect();
            let Some((points, turns)) = resolution.arcs(&path, role) else {
                continue;
            };
            line.points = arc::flat(&points, &turns, FLAT);
            if line.closed {
                line.points.pop();
            }
        }
    }
    walls
}

/// The roles of lines by their walls; `inside` is the role of walls that are
/// not seen.
fn roles(inside: Role) -> impl Iterator<Item = Role> {
    iter::once(Role::OuterWall).chain(iter::repeat(inside))
}

fn bead(stroke: &Stroke, role: Role, height: Mm) -> Bead {
    let wall = matches!(role, Role::OuterWall | Role::InnerWall);
    let mut bead = Bead::new(role, stroke.clone(), height);
    if wall && stroke.closed {
        bead.ring = stroke.length();
    }
    bead
}

#[cfg(test)]
mod tests;
