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
//! Where there are lines inside the rings, rings that nothing holds wait for them.

use super::Fill;
use crate::walls::hanging;
use isoslice_base::units::Mm;
use isoslice_planar::bead::{Bead, Role, Stroke};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::signed_area;
use std::collections::BTreeMap;

/// Share of a ring's length from which on it counts as hanging.
const MOST: f64 = 0.5;
/// The rings that lie on the layer below, which `below` holds, and the others, of a
/// role of their own: those nearest to it first.
pub(super) fn apart(
    rings: Vec<Bead>,
    below: &EdgeGrid,
    role: Role,
) -> (Vec<Bead>, Vec<Fill>) {
    let mut held = Vec::with_capacity(rings.len());
    // By their distance from what is below, in halves of a width: a ring's neighbours
    // are nearly a width from it.
    let mut hung: BTreeMap<u32, Vec<Bead>> = BTreeMap::new();
    let widths = rings.iter().map(|bead| bead.stroke.width);
    let step = 0.5 * widths.fold(0.0, f64::max);
    for bead in rings {
        match distance(&bead.stroke, below) {
            Some(far) if bead.role == Role::BottomSkin => {
                let bead = Bead { role, ..bead };
                hung.entry((far / step) as u32).or_default().push(bead);
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

/// True for a ring that faces downwards.
pub(super) fn faces_down(ring: &Bead) -> bool {
    matches!(ring.role, Role::BottomSkin | Role::Bridge) && ring.stroke.closed
}

/// Takes out the rings that nothing below holds, and gives them a role: they come after
/// the lines beside them, which hold them. Those around holes may be held in part.
pub(super) fn after_lines(
    rings: &mut Vec<Bead>,
    below: &EdgeGrid,
    role: Role,
) -> Option<Fill> {
    let hangs = |ring: &mut Bead| {
        let stroke = &ring.stroke;
        faces_down(ring)
            && if signed_area(&stroke.points) < 0.0 {
                distance(stroke, below).is_some()
            } else {
                hanging(stroke, below).all(|(_, far)| far.is_some())
            }
    };
    let hung = rings.extract_if(.., hangs);
    let lines: Vec<Bead> = hung.map(|ring| Bead { role, ..ring }).collect();
    (!lines.is_empty()).then(|| fill(lines))
}

/// The mean distance of a ring from what is below, if most of the ring hangs.
fn distance(stroke: &Stroke, below: &EdgeGrid) -> Option<Mm> {
    let (mut hung, mut length, mut sum) = (0.0, 0.0, 0.0);
    for (own, far) in hanging(stroke, below) {
        length += own;
        if let Some(far) = far {
            hung += own;
            sum += far * own;
        }
    }
    (hung > MOST * length).then(|| sum / hung)
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
