//! Where along a ridge which beads go.
//!
//! The thickness along a ridge decides: up to `least` there is no room for a
//! bead, up to `limit` for one, and beyond for two walls side by side. In: a
//! ridge. Out: its parts up to `limit`, each below or above `least` all along.
//!
//! A thickness that wavers around a bound would chop beads and walls into
//! pieces too short to print. Where a part is shorter than a bead is wide,
//! and the bound is not passed by much, the parts beside it go on.

use super::ridge::Ridge;
use crate::units::Mm;

/// By how much a bound may be passed for a short while.
const STRETCH: f64 = 1.25;

/// What is there room for?
#[derive(Clone, Copy, PartialEq)]
enum Room {
    None,
    Sliver,
    Bead,
    Walls,
}

/// The parts of a ridge that are thinner than `limit` once `less` has been
/// taken from their thickness, and whether there is room for a bead.
pub(super) fn parts(
    ridge: &Ridge,
    less: Mm,
    least: Mm,
    limit: Mm,
) -> Vec<(Ridge, bool)> {
    // Most ridges have room for walls all along, or for nothing.
    let most = limit.max(least).max(0.0);
    let mut all = ridge.thickness.iter().map(|t| t - less);
    if all.clone().all(|t| t > most) || all.all(|t| t <= 0.0) {
        return Vec::new();
    }
    let mut rest = ridge.clone();
    rest.thickness.iter_mut().for_each(|t| *t -= less);
    let room = |r: &Ridge| {
        let t = r.middle_thickness();
        match () {
            () if t <= 0.0 => Room::None,
            () if t <= least => Room::Sliver,
            () if t <= limit => Room::Bead,
            () => Room::Walls,
        }
    };
    let mut parts = vec![rest];
    for bound in [0.0, least, limit] {
        parts = parts.into_iter().flat_map(|p| p.split_at(bound)).collect();
    }
    let mut rooms: Vec<(Room, Ridge)> =
        parts.into_iter().map(|p| (room(&p), p)).collect();
    if !ridge.closed || rooms.len() > 1 {
        let n = rooms.len();
        for i in 0..n {
            let (own, part) = &rooms[i];
            let short = part.length() < 1.2 * part.thickest();
            let beads =
                |k: usize| rooms.get(k).is_some_and(|r| r.0 == Room::Bead);
            let between = i > 0 && beads(i - 1) && beads(i + 1);
            let fits = match own {
                Room::Walls => part.thickest() <= STRETCH * limit,
                Room::Sliver => part.thinnest() * STRETCH >= least,
                _ => false,
            };
            if short && between && fits {
                rooms[i].0 = Room::Bead;
            }
        }
        // A bead needs some length, or it is but a widening of the walls.
        for (room, part) in &mut rooms {
            let alone = part.length() < 0.5 * part.thickest();
            if *room == Room::Bead && !part.closed && alone {
                *room = Room::Sliver;
            }
        }
    }
    let mut kept: Vec<(Room, Ridge)> = Vec::new();
    for (room, part) in rooms {
        match kept.last_mut() {
            Some((before, whole)) if *before == room => whole.append(part),
            _ => kept.push((room, part)),
        }
    }
    // A closed ridge was opened at its first point, perhaps within a part.
    let across = ridge.closed
        && kept.len() > 1
        && kept.first().map(|k| k.0) == kept.last().map(|k| k.0);
    if across {
        let (_, first) = kept.remove(0);
        if let Some((_, last)) = kept.last_mut() {
            last.append(first);
        }
    }
    kept.into_iter()
        .filter(|(room, _)| matches!(room, Room::Sliver | Room::Bead))
        .map(|(room, mut part)| {
            let bounds = match room {
                Room::Bead => (least / STRETCH, f64::INFINITY),
                _ => (0.0, limit),
            };
            for t in &mut part.thickness {
                *t = t.max(bounds.0).min(bounds.1);
            }
            (part, room == Room::Bead)
        })
        .collect()
}
