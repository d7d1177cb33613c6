//! What needs supports, as places.
//!
//! In: by layer, the areas that supports are to hold, the layers' outlines, and how
//! far their rims get from what holds them ([`track`](super::track)). Out: places, from
//! the bed up. So what is told of the places is what is printed of supports, and their
//! reach is the one that the summary of a run has.

use super::across::{Across, Upper};
use super::piece::{Both, OverhangPiece, piece};
use super::places::{Found, Places};
use super::plan::OverhangPlan;
use super::track::Far;
use super::{OverhangKind, Unsupported};
use glam::{DVec2, DVec3};
use isoslice_base::parallel;
use isoslice_base::units::Mm;
use isoslice_layer::floating::floating;
use isoslice_planar::clip::intersection;
use isoslice_planar::{Area, BoxTree, Rect, Solid};
use isoslice_settings::layers::LayerSpan;

/// What needs a support, and the layers that it is in.
#[derive(Clone, Copy, Debug)]
pub struct Needs<'a> {
    /// What of each layer needs a support.
    pub needs: &'a [Area],
    /// The layers' outlines.
    pub outlines: &'a [Area],
    /// The layers' heights.
    pub spans: &'a [LayerSpan],
    /// How far the layers' rims get, from below.
    pub far: &'a [Far],
}

/// A rim's place is in an area although they are so far apart, mm: outlines are coarse
/// where supports are planned.
const COARSE: Mm = 0.1;

impl Needs<'_> {
    /// The places. `place` turns a point in the plane and a layer into a point on the
    /// bed.
    pub fn places(
        self,
        plan: &OverhangPlan,
        place: impl Fn(DVec2, &LayerSpan) -> DVec3,
    ) -> Vec<Unsupported> {
        let pieces = parallel::map(self.needs.len(), |i| self.pieces(i, plan));
        let mut places = Places::default();
        for (pieces, span) in pieces.into_iter().zip(self.spans) {
            places.next_layer();
            for (piece, around) in pieces {
                places.add(Found {
                    kind: piece.kind,
                    area: piece.area,
                    reach: piece.reach,
                    at: place(piece.at, span),
                    around,
                });
            }
        }
        places.finish()
    }

    /// The islands of what needs a support in layer `i`, and boxes around them.
    fn pieces(
        self,
        i: usize,
        plan: &OverhangPlan,
    ) -> Vec<(OverhangPiece, Rect)> {
        if self.needs[i].is_empty() || isoslice_base::limits::is_stopped() {
            return Vec::new();
        }
        let here = &self.outlines[i];
        let nothing = Area::EMPTY;
        let below = i.checked_sub(1).map_or(&nothing, |k| &self.outlines[k]);
        let below = Solid::of(below, 1.0);
        let begins = floating(here, &below);
        let boxes = begins.iter().map(|begun| begun.island.bounds());
        let boxes = BoxTree::new(boxes.enumerate());
        let upper = Upper {
            outline: &Solid::of(here, Across::depth(plan)),
            number: i + plan.raft_layers,
            height: self.spans[i].height(),
            plan,
        };
        let both = Both::new(here, &below);
        let of_island = |area: Area| {
            let around = area.bounds();
            let near = boxes.meeting(around);
            let on_nothing = near.filter(|&k| {
                !intersection(&begins[k].island, &area).is_empty()
            });
            let piece = match on_nothing.min() {
                Some(k) => OverhangPiece {
                    kind: OverhangKind::Begins,
                    area: area.content(),
                    reach: 0.0,
                    at: begins[k].at,
                },
                None => piece(&area, &both, upper),
            };
            (self.farthest(piece, around, upper.number), around)
        };
        self.needs[i].islands().into_iter().map(of_island).collect()
    }

    /// A piece in a box of a layer, with the reach that adds up over the layers below.
    fn farthest(
        self,
        mut piece: OverhangPiece,
        around: Rect,
        number: usize,
    ) -> OverhangPiece {
        if piece.kind != OverhangKind::Leans {
            return piece;
        }
        let from = self.far.partition_point(|far| far.layer < number);
        let far = self.far[from..].iter();
        let far = far.take_while(|far| far.layer == number);
        let near = around.grown(COARSE);
        for far in far.filter(|far| near.contains(far.at)) {
            if far.reach > piece.reach {
                (piece.reach, piece.at) = (far.reach, far.at);
            }
        }
        piece
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::clip::{difference, union};
    use isoslice_planar::rect;
    use isoslice_settings::testing::usual_plan;

    fn told(needs: &[Area], outlines: &[Area]) -> Vec<Unsupported> {
        let spans = LayerSpan::stack(0.2, outlines.len());
        let needs = Needs {
            needs,
            outlines,
            spans: &spans,
            far: &[],
        };
        let place = |p: DVec2, span: &LayerSpan| p.extend(span.bottom);
        needs.places(&usual_plan(OverhangPlan::of), place)
    }

    #[test]
    fn places_have_the_area_that_supports_hold() {
        let post = rect(0.0, 0.0, 10.0, 10.0);
        let arm = rect(10.3, 0.0, 30.0, 10.0);
        let ball = rect(50.0, 0.0, 52.0, 2.0);
        let above = union(&rect(0.0, 0.0, 30.0, 10.0), &ball);
        let needs = [Area::EMPTY, union(&arm, &ball)];
        let places = told(&needs, &[post, above]);
        let [leans, begins] = &places[..] else {
            panic!("{places:?}");
        };
        let kinds = [leans.kind, begins.kind];
        assert_eq!(kinds, [OverhangKind::Leans, OverhangKind::Begins]);
        // With the strip of 0.3 mm that the layer below holds.
        assert!((leans.area - 200.0).abs() < 0.1, "{leans:?}");
        assert!((leans.reach - 20.0).abs() < 1e-6);
        assert!((begins.area - 4.0).abs() < 1e-6 && begins.reach == 0.0);
    }

    #[test]
    fn long_bridges_and_what_begins_in_a_cavity_are_told_apart() {
        let plate = rect(0.0, 0.0, 60.0, 20.0);
        let hole = rect(5.0, 5.0, 55.0, 14.0);
        let below = difference(&plate, &hole);
        let lid = [Area::EMPTY, rect(5.3, 5.3, 54.7, 13.7)];
        let places = told(&lid, &[below.clone(), plate]);
        // It is 9 mm wide, and bridges may be longer.
        assert_eq!(places[0].kind, OverhangKind::Leans);
        let two = [rect(0.0, 0.0, 5.0, 20.0), rect(45.0, 0.0, 50.0, 20.0)];
        let two = Area::from_iter(two);
        let need = [Area::EMPTY, rect(5.3, 0.0, 44.7, 20.0)];
        let over = rect(0.0, 0.0, 50.0, 20.0);
        let places = told(&need, &[two, over]);
        assert_eq!(places[0].kind, OverhangKind::Bridge);
        assert!((places[0].reach - 40.0).abs() < 1.0, "{places:?}");
        let ball = rect(10.0, 8.0, 12.0, 10.0);
        let needs = [Area::EMPTY, ball.clone()];
        let above = union(&below, &ball);
        let places = told(&needs, &[below, above]);
        assert_eq!(places[0].kind, OverhangKind::Begins);
    }
}
