//! What hangs as places: the findings of all layers, put together where they
//! are connected.
//!
//! In: what is found layer by layer. Out: places, from the bed up.
//! What leans in one layer belongs to what leans in the layer below if their
//! boxes come near each other, so a slope is one place, over all of its height.

use super::OverhangKind;
use glam::DVec3;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::Rect;

/// Boxes that are nearer to each other belong together, mm.
const NEAR: Mm = 1.0;
/// Greatest number of places that are kept, besides at least one of each kind.
/// Lattices may have more, and their area still counts.
const MOST_PLACES: usize = 10_000;

/// A place of a part that would need a support.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Unsupported {
    /// What hangs there.
    pub kind: OverhangKind,
    /// Content of the underside, seen from below.
    pub area: Mm2,
    /// Height above the bed at which the underside begins.
    pub from: Mm,
    /// Height above the bed at which the underside ends.
    pub to: Mm,
    /// How far the place gets from what holds it; for bridges the greatest
    /// length, and 0 for islands that begin on nothing.
    pub reach: Mm,
    /// The place's farthest point, on the bed.
    pub at: DVec3,
}

/// What was found of one kind in one layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub kind: OverhangKind,
    pub area: Mm2,
    pub reach: Mm,
    /// The farthest point, on the bed.
    pub at: DVec3,
    /// The box around it in the plane.
    pub around: Rect,
}

/// The places found so far.
#[derive(Debug, Default)]
pub(super) struct Places {
    all: Vec<Unsupported>,
    /// The number of the last place of each kind.
    last: Vec<(OverhangKind, usize)>,
    /// The slopes of the layer below, and of this layer: numbers of places, and
    /// boxes.
    below: Vec<(usize, Rect)>,
    here: Vec<(usize, Rect)>,
}

impl Places {
    /// Goes up by a layer.
    pub(super) fn next_layer(&mut self) {
        self.below = std::mem::take(&mut self.here);
    }

    /// Adds what was found in this layer.
    pub(super) fn add(&mut self, found: Found) {
        let Found {
            kind,
            area,
            reach,
            at,
            around,
        } = found;
        let near = around.grown(NEAR);
        let known = self.below.iter().chain(&self.here);
        let mut known = known.filter(|(_, rect)| rect.meets(near));
        let known = known.next().filter(|_| kind == OverhangKind::Leans);
        // If there are too many places, new ones go with the last one of their
        // kind.
        let full = self.all.len() >= MOST_PLACES;
        let of_kind = self.last.iter().filter(|(of, _)| full && *of == kind);
        let last = of_kind.map(|(_, number)| *number).next();
        let number = match known {
            Some(&(number, _)) => number,
            None => {
                let number = last.unwrap_or(self.all.len());
                if number == self.all.len() {
                    self.all.push(Unsupported {
                        kind,
                        area: 0.0,
                        from: at.z,
                        to: at.z,
                        reach: 0.0,
                        at,
                    });
                    self.last.retain(|(of, _)| *of != kind);
                    self.last.push((kind, number));
                }
                number
            }
        };
        let place = &mut self.all[number];
        place.area += area;
        place.to = place.to.max(at.z);
        if reach > place.reach {
            place.reach = reach;
            place.at = at;
        }
        if kind == OverhangKind::Leans {
            self.here.push((number, around));
        }
    }

    /// The places.
    pub(super) fn finish(self) -> Vec<Unsupported> {
        self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn what_is_too_much_goes_with_the_last_of_its_kind() {
        let mut places = Places::default();
        let mut add = |kind, count: usize, area| {
            for _ in 0..count {
                places.add(Found {
                    kind,
                    area,
                    reach: 1.0,
                    at: DVec3::ZERO,
                    around: Rect::around(&[DVec2::ZERO]),
                });
            }
        };
        add(OverhangKind::Begins, 5, 1.0);
        add(OverhangKind::Bridge, MOST_PLACES, 2.0);
        add(OverhangKind::Begins, 3, 1.0);
        add(OverhangKind::Leans, 2, 4.0);
        let all = places.finish();
        assert_eq!(all.len(), MOST_PLACES + 1);
        let area = |kind| -> Mm2 {
            all.iter().filter(|p| p.kind == kind).map(|p| p.area).sum()
        };
        assert_eq!(area(OverhangKind::Begins), 8.0);
        assert_eq!(area(OverhangKind::Bridge), 2.0 * MOST_PLACES as f64);
        assert_eq!(area(OverhangKind::Leans), 8.0);
    }

    #[test]
    fn what_leans_layer_after_layer_is_one_place() {
        let mut places = Places::default();
        let found = |x: f64, z: f64, kind| {
            let at = DVec2::new(x, 0.0);
            Found {
                kind,
                area: 2.0,
                reach: x,
                at: at.extend(z),
                around: Rect::around(&[at, at + DVec2::new(0.3, 9.0)]),
            }
        };
        for k in 0..10 {
            places.next_layer();
            let at = 0.5 * f64::from(k);
            places.add(found(
                1.0 + at,
                0.2 * f64::from(k),
                OverhangKind::Leans,
            ));
            places.add(found(
                50.0 - at,
                0.2 * f64::from(k),
                OverhangKind::Leans,
            ));
        }
        // After a layer without a slope the next slope is another place.
        places.next_layer();
        places.next_layer();
        places.add(found(6.0, 2.4, OverhangKind::Leans));
        places.add(found(6.0, 2.4, OverhangKind::Begins));
        places.add(found(6.0, 2.4, OverhangKind::Begins));
        let all = places.finish();
        assert_eq!(all.len(), 5);
        assert_eq!([all[0].from, all[0].area, all[0].reach], [0.0, 20.0, 5.5]);
        assert!((all[0].to - 1.8).abs() < 1e-9 && all[0].at.x == 5.5);
        assert_eq!([all[1].reach, all[1].at.x], [50.0, 50.0]);
        assert_eq!(all[2].from, 2.4);
    }
}
