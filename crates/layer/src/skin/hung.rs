//! Rings of skin over nothing that no lines can bridge, as in the ceiling of a
//! counterbore.
//!
//! ```text
//!   ▒▒▒▒▒▒▒▒│           ▒ what the layer below holds; rings that lie on it come
//!   ▒▒═══1══│═2═ ═3═ ○  first, then one beside the other, so that each is laid
//!   ▒▒▒▒▒▒▒▒│           along one that is there
//! ```
//!
//! In: rings, the layer below, and the role of what hangs: a bridge's, or skin's where
//! supports may hold it. Out: those that are held, and those that hang, in print order.
//! Where there are lines inside the rings, only rings around holes wait for them.

use super::Fill;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::{Bead, Role, Stroke};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::signed_area;
use std::collections::BTreeMap;

/// Share of a ring's length from which on it counts as hanging.
const MOST: f64 = 0.5;
/// A place hangs if it lies farther beyond what is below than so many widths: a
/// quarter of the bead, or less, then lies on that.
const BEYOND: f64 = 0.25;

/// The rings that lie on the layer below, which `below` holds, and the others, of a
/// role of their own: those nearest to it first.
pub(super) fn apart(
    rings: Vec<Bead>,
    below: &EdgeGrid,
    role: Role,
) -> (Vec<Bead>, Vec<Fill>) {
    let mut held = Vec::with_capacity(rings.len());
    // By their distance from what is below, in widths.
    let mut hung: BTreeMap<u32, Vec<Bead>> = BTreeMap::new();
    for bead in rings {
        let width = bead.stroke.width;
        match distance(&bead.stroke, below) {
            Some(far) if bead.role == Role::BottomSkin => {
                let bead = Bead { role, ..bead };
                hung.entry((far / width) as u32).or_default().push(bead);
            }
            _ => held.push(bead),
        }
    }
    (held, hung.into_values().map(fill).collect())
}

/// Beads that may be printed in any order.
pub(super) fn fill(lines: Vec<Bead>) -> Fill {
    Fill {
        lines,
        after: Vec::new(),
        one_way: Vec::new(),
    }
}

/// True for a ring around a hole that faces downwards.
pub(super) fn is_around_hole(ring: &Bead) -> bool {
    matches!(ring.role, Role::BottomSkin | Role::Bridge)
        && ring.stroke.closed
        && signed_area(&ring.stroke.points) < 0.0
}

/// Takes out the rings around holes that hang, and gives them a role: they come after
/// the lines beside them, which hold them.
pub(super) fn around_holes(
    rings: &mut Vec<Bead>,
    below: &EdgeGrid,
    role: Role,
) -> Option<Fill> {
    let hangs = |ring: &mut Bead| {
        is_around_hole(ring) && distance(&ring.stroke, below).is_some()
    };
    let hung = rings.extract_if(.., hangs);
    let lines: Vec<Bead> = hung.map(|ring| Bead { role, ..ring }).collect();
    (!lines.is_empty()).then(|| fill(lines))
}

/// The mean distance of a ring from what is below, if most of the ring hangs.
fn distance(stroke: &Stroke, below: &EdgeGrid) -> Option<Mm> {
    let least = BEYOND * stroke.width;
    let far = |p: DVec2| {
        let hangs =
            !below.contains(p) && below.nearest_edge(p, least).is_none();
        // Beyond a layer without any edge nothing is near.
        let far = || below.foot(p).map_or(f64::MAX, |(_, q)| p.distance(q));
        hangs.then(far)
    };
    let (mut hanging, mut length, mut sum) = (0.0, 0.0, 0.0);
    for (a, b) in stroke.segments() {
        let own = a.distance(b);
        length += own;
        if let Some(far) = far(a.midpoint(b)) {
            hanging += own;
            sum += far * own;
        }
    }
    (hanging > MOST * length).then(|| sum / hanging)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::clip::difference;
    use isoslice_planar::shapes::{circle, disc, rect};

    #[test]
    fn rings_over_a_hole_are_laid_from_its_rim_inwards() {
        let below = difference(&rect(-9.0, -9.0, 9.0, 9.0), &disc(4.0, 100));
        let below = EdgeGrid::new(&below, 0.5);
        let ring = |radius: Mm| {
            let stroke = Stroke::new(circle(radius, 100), true, 0.45);
            Bead::new(Role::BottomSkin, stroke, 0.2)
        };
        // The one at 3.95 mm lies on the rim for the most part.
        let radii = [2.2, 3.0, 3.95, 4.6, 3.45];
        let rings = radii.map(ring).to_vec();
        let (held, hung) = apart(rings, &below, Role::Bridge);
        let size = |bead: &Bead| bead.stroke.points[0].length();
        assert_eq!(held.iter().map(size).collect::<Vec<_>>(), [3.95, 4.6]);
        let sizes: Vec<f64> =
            hung.iter().flat_map(|f| &f.lines).map(size).collect();
        assert_eq!(sizes, [3.45, 3.0, 2.2]);
        let all = hung.iter().flat_map(|f| &f.lines);
        assert!(all.clone().all(|b| b.role == Role::Bridge));
        assert_eq!(hung.len(), 3);
        // What is skin for another reason stays what it is.
        let inside = Bead {
            role: Role::InternalSkin,
            ..ring(3.0)
        };
        let (held, _) = apart(vec![inside.clone()], &below, Role::Bridge);
        assert_eq!(held, [inside]);
    }
}
