//! What needs supports, as places.
//!
//! In: by layer, the areas that supports are to hold, and the layers' outlines.
//! Out: places, from the bed up, and their sums. So what is told of the places is
//! what is printed of supports.

use super::gap::bridge;
use super::places::{Found, Places};
use super::{Hanging, Kind, Unsupported};
use crate::region::floating::floating;
use glam::{DVec2, DVec3};
use isoslice_base::units::Mm;
use isoslice_planar::clip::intersection;
use isoslice_planar::{Area, BoxTree, Solid};
use isoslice_settings::Settings;
use isoslice_settings::layers::LayerSpan;
use rayon::prelude::*;

/// About how many points of an area's rim its reach is measured at.
const POINTS: usize = 500;

/// What needs a support, and the layers that it is in.
#[derive(Clone, Copy, Debug)]
pub struct Needs<'a> {
    /// What of each layer needs a support.
    pub needs: &'a [Area],
    /// The layers' outlines.
    pub outlines: &'a [Area],
    /// The layers' heights.
    pub spans: &'a [LayerSpan],
}

/// An island of what needs a support in a layer.
struct Piece {
    kind: Kind,
    /// True if the island begins in a cavity.
    in_cavity: bool,
    reach: Mm,
    at: DVec2,
    area: Area,
}

impl Needs<'_> {
    /// The places, and what they amount to. `place` turns a point in the plane and a
    /// layer into a point on the bed.
    pub fn places(
        self,
        settings: &Settings,
        place: impl Fn(DVec2, &LayerSpan) -> DVec3,
    ) -> (Hanging, Vec<Unsupported>) {
        let layers = (0..self.needs.len()).into_par_iter();
        let pieces = layers.map(|i| self.pieces(i, settings));
        let mut places = Places::default();
        let mut hanging = Hanging::default();
        let pieces: Vec<Vec<Piece>> = pieces.collect();
        for (pieces, span) in pieces.into_iter().zip(self.spans) {
            places.next_layer();
            for piece in pieces {
                let at = place(piece.at, span);
                let area = piece.area.content();
                places.add(Found {
                    kind: piece.kind,
                    area,
                    reach: piece.reach,
                    at,
                    around: piece.area.bounds(),
                });
                if piece.kind == Kind::Begins {
                    hanging.add_where(piece.in_cavity, area, at);
                }
            }
        }
        let places = places.finish();
        for place in &places {
            let sum = match place.kind {
                Kind::Begins => &mut hanging.begins,
                Kind::Leans => &mut hanging.leans,
                Kind::Bridge => &mut hanging.bridges,
            };
            sum.add(place.area, place.area, place.reach, place.at);
        }
        (hanging, places)
    }

    /// The islands of what needs a support in layer `i`.
    fn pieces(self, i: usize, settings: &Settings) -> Vec<Piece> {
        if self.needs[i].is_empty() {
            return Vec::new();
        }
        if isoslice_base::limits::is_stopped() {
            return Vec::new();
        }
        let here = &self.outlines[i];
        let below = i.checked_sub(1).map(|k| self.outlines[k].clone());
        let below = Solid::new(below.unwrap_or(Area::EMPTY));
        let begins = floating(here, &below);
        let boxes = begins.iter().map(|begun| begun.island.bounds());
        let boxes = BoxTree::new(boxes.enumerate());
        let piece = |area: Area| {
            let near = boxes.meeting(area.bounds());
            let on_nothing = near.filter(|&k| {
                !intersection(&begins[k].island, &area).is_empty()
            });
            if let Some(begun) = on_nothing.min().map(|k| &begins[k]) {
                return Piece {
                    kind: Kind::Begins,
                    in_cavity: begun.in_cavity,
                    reach: 0.0,
                    at: begun.at,
                    area,
                };
            }
            let bridge = bridge(&area, here, &below, i, settings);
            let (kind, (reach, at)) = match bridge {
                Some(bridge) => (Kind::Bridge, bridge),
                None => (Kind::Leans, farthest(&area, &below)),
            };
            Piece {
                kind,
                in_cavity: false,
                reach,
                at,
                area,
            }
        };
        self.needs[i].islands().into_iter().map(piece).collect()
    }
}

/// The greatest distance of an area's rim from what is below, and the place that has
/// it.
fn farthest(area: &Area, below: &Solid<'_>) -> (Mm, DVec2) {
    let points = area.rings.iter().flatten();
    let step = points.clone().count().div_ceil(POINTS).max(1);
    let away = |p: &DVec2| {
        let foot = below.grid().foot(*p);
        (foot.map_or(0.0, |(_, q)| q.distance(*p)), *p)
    };
    let found = points.step_by(step).map(away);
    let farther = |a: &(Mm, DVec2), b: &(Mm, DVec2)| a.0.total_cmp(&b.0);
    found.max_by(farther).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::clip::{difference, union};
    use isoslice_planar::rect;

    fn told(needs: &[Area], outlines: &[Area]) -> (Hanging, Vec<Unsupported>) {
        let spans = LayerSpan::stack(0.2, outlines.len());
        let needs = Needs {
            needs,
            outlines,
            spans: &spans,
        };
        let place = |p: DVec2, span: &LayerSpan| p.extend(span.bottom);
        needs.places(&Settings::default(), place)
    }

    #[test]
    fn places_have_the_area_that_supports_hold() {
        let post = rect(0.0, 0.0, 10.0, 10.0);
        let arm = rect(10.3, 0.0, 30.0, 10.0);
        let ball = rect(50.0, 0.0, 52.0, 2.0);
        let above = union(&rect(0.0, 0.0, 30.0, 10.0), &ball);
        let needs = [Area::EMPTY, union(&arm, &ball)];
        let (sums, places) = told(&needs, &[post, above]);
        let [leans, begins] = &places[..] else {
            panic!("{places:?}");
        };
        let kinds = [leans.kind, begins.kind];
        assert_eq!(kinds, [Kind::Leans, Kind::Begins]);
        assert!((leans.area - 197.0).abs() < 1e-6);
        assert!((leans.reach - 20.0).abs() < 1e-6);
        assert!((begins.area - 4.0).abs() < 1e-6 && begins.reach == 0.0);
        assert_eq!(sums.leans.area, leans.area);
        assert_eq!([sums.begins.count, sums.in_cavity.count], [1, 0]);
    }

    #[test]
    fn long_bridges_and_what_begins_in_a_cavity_are_told_apart() {
        let plate = rect(0.0, 0.0, 60.0, 20.0);
        let hole = rect(5.0, 5.0, 55.0, 14.0);
        let below = difference(&plate, &hole);
        let lid = [Area::EMPTY, rect(5.3, 5.3, 54.7, 13.7)];
        let (sums, places) = told(&lid, &[below.clone(), plate]);
        // It is 9 mm wide, and bridges may be longer.
        assert_eq!(places[0].kind, Kind::Leans);
        assert_eq!(sums.bridges.count, 0);
        let two = [rect(0.0, 0.0, 5.0, 20.0), rect(45.0, 0.0, 50.0, 20.0)];
        let two = Area::from_iter(two);
        let need = [Area::EMPTY, rect(5.3, 0.0, 44.7, 20.0)];
        let over = rect(0.0, 0.0, 50.0, 20.0);
        let (sums, places) = told(&need, &[two, over]);
        assert_eq!(places[0].kind, Kind::Bridge);
        assert!((sums.bridges.reach - 40.0).abs() < 1.0, "{places:?}");
        let ball = rect(10.0, 8.0, 12.0, 10.0);
        let needs = [Area::EMPTY, ball.clone()];
        let above = union(&below, &ball);
        let (sums, _) = told(&needs, &[below, above]);
        assert_eq!([sums.begins.count, sums.in_cavity.count], [1, 1]);
    }
}
