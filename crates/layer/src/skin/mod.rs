//! Solid fill: a ring around each skin area, and lines at ±45° inside it.
//!
//! ```text
//!   ╭────────────╮   the ring runs half a bead's spacing inside the area's
//!   │ ╱╱╱╱╱╱╱╱╱╱ │   border, around holes as well; lines end about half a
//!   │ ╱╱╱╱╱╱╱╱╱╱ │   spacing off the ring's centre line (`skin_ring_gap` more,
//!   ╰────────────╯   if asked for), one spacing apart, turned by 90° from layer
//!                    to layer
//! ```
//!
//! Lines go on in their neighbours over narrow turns ([`zigzag`]). An area that
//! is nowhere wider than some lines gets no lines: it gets rings one inside the
//! other, and beads in the middle. Where these hang, they are laid from what holds
//! them outwards ([`hung`]).
//!
//! Inside the ring the area is split by what the neighbouring layers leave
//! open. It has bridges where it hangs between supports, then bottom, top and
//! internal skin, each with its own width and pattern. Where two kinds have
//! equal widths and patterns, lines run on from one kind to the other and only
//! their roles change.

pub mod bridge;
mod dabs;
mod direction;
mod fill;
mod gaps;
mod hung;
pub mod internal_bridges;
mod plan;
mod roles;
mod short;
mod strips;
mod strokes;
mod sweep;
mod zigzag;

use crate::cover::{Covered, Islands};
use crate::view::{LayerFace, LayerView};
use fill::{AdjacentLayer, Filler};
use isoslice_base::units::Mm;
use isoslice_planar::bead::{Bead, Role};
use isoslice_planar::clip::difference;
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Solid};
pub use plan::SkinPlan;
use roles::Sides;

/// A connected skin area's beads.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Beads around the area and its holes, and those in the middle of
    /// places too thin for lines. Internal bridges have none.
    pub rings: Vec<Bead>,
    /// What is inside the rings, in print order.
    pub fills: Vec<Fill>,
}

impl Patch {
    /// The beads: rings, then what is inside them.
    pub fn beads(&self) -> impl Iterator<Item = &Bead> {
        let lines = self.fills.iter().flat_map(|fill| &fill.lines);
        self.rings.iter().chain(lines)
    }

    /// The bead that is printed first. If several may be, it is one of them.
    pub fn first(&self) -> Option<&Bead> {
        self.beads().next()
    }
}

/// Beads of one role inside a skin's rings.
#[derive(Clone, Debug, PartialEq)]
pub struct Fill {
    /// The beads.
    pub lines: Vec<Bead>,
    /// For each bead the numbers of the beads that have to be printed before
    /// it. Empty if any order will do.
    pub after: Vec<Vec<u32>>,
    /// For each bead whether it has to be printed the way it runs. Empty if no
    /// bead has to.
    pub one_way: Vec<bool>,
}

/// The beads of a layer's skin, beside which `sparse` infill lies. Even layers
/// get lines at `skin_angle`, odd ones at right angles to it. If supports hold some
/// of the layer, what bridges do not cross is left to them.
pub fn patches(
    skin: &Area,
    sparse: &Area,
    view: &LayerView<'_>,
    supported: bool,
    plan: &SkinPlan,
) -> Vec<Patch> {
    let pressed = into_walls(skin, sparse, plan.into_walls);
    let islands = pressed.as_ref().unwrap_or(skin).islands();
    let asked = Islands::new(&islands);
    let side = |face: Option<&LayerFace<'_>>| match face {
        Some(face) => asked.covered(face.rough),
        None => vec![Covered::Not; islands.len()],
    };
    let (above, below) = (view.above.first(), view.below.first());
    let covers = side(above).into_iter().zip(side(below));
    let span = view.here.span;
    let filler = Filler {
        above: AdjacentLayer::new(above),
        below: AdjacentLayer::new(below),
        sparse: Solid::of(sparse, 1.0),
        on_bed: span.index == 0,
        angle: plan.directions[span.index % 2],
        height: span.height(),
        plan,
        hung: if plan.rings_hang && !supported {
            Role::Bridge
        } else {
            Role::BottomSkin
        },
    };
    let sides = covers.map(|(over, under)| Sides {
        above: (over, above.map(|f| f.outline.grid())),
        below: (under, below.map(|f| f.outline.grid())),
    });
    islands
        .iter()
        .zip(sides)
        .filter_map(|(island, sides)| filler.patch(island, sides))
        .collect()
}

/// Skin that reaches so far into the walls around it, if at all. It ends where
/// sparse infill begins.
fn into_walls(skin: &Area, sparse: &Area, reach: Mm) -> Option<Area> {
    /// Tolerance of the border, mm. It lies under walls.
    const TOLERANCE: Mm = 0.01;
    if reach <= 0.0 {
        return None;
    }
    let grown = offset(skin, reach, TOLERANCE);
    Some(if sparse.is_empty() {
        grown
    } else {
        difference(&grown, sparse)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    pub(super) use crate::walls::content_of as laid;
    use glam::DVec2;
    use isoslice_planar::bead::{Stroke, spacing};
    use isoslice_planar::shapes::{circle, disc, moved, rect, square};
    use isoslice_settings::testing::{plan_with, usual_plan};
    use isoslice_settings::{SkinPattern, SwitchOr};

    /// The skin of a layer between two others, if there are any.
    fn laid_between(
        skin: &Area,
        sparse: &Area,
        [below, above]: [Option<&Area>; 2],
        layer: usize,
        plan: &SkinPlan,
    ) -> Vec<Patch> {
        let here = Solid::new(skin.clone());
        let [below, above] =
            [below, above].map(|area| area.map(|a| Solid::new(a.clone())));
        let [below, above] = [&below, &above]
            .map(|solid| solid.iter().collect::<Vec<&Solid<'_>>>());
        let view = LayerView::of(layer, &here, &above, &below);
        patches(skin, sparse, &view, false, plan)
    }

    #[test]
    fn a_square_gets_a_ring_and_lines_that_turn() {
        let plan = usual_plan(SkinPlan::of);
        let beside = [Some(&square(12.0)), None];
        for layer in [0, 1] {
            let patches =
                laid_between(&square(10.0), &Area::EMPTY, beside, layer, &plan);
            assert_eq!(patches.len(), 1);
            let p = &patches[0];
            assert_eq!(p.rings.len(), 1);
            assert_eq!(p.rings[0].role, Role::TopSkin);
            let lines = &p.fills[0].lines;
            let space = spacing(0.45, 0.45, 0.2);
            let content: f64 =
                lines.iter().map(|b| laid(&b.stroke, 0.45 - space)).sum();
            let side = 20.0 - space - 0.4;
            assert!((content / (side * side) - 1.0).abs() < 0.01);
            let d = lines[0].stroke.points[1] - lines[0].stroke.points[0];
            let slope = d.y / d.x;
            let expected = if layer == 0 { 1.0 } else { -1.0 };
            assert!((slope - expected).abs() < 1e-9, "{slope}");
        }
    }

    #[test]
    fn skin_reaches_into_walls_as_asked_and_not_into_sparse_infill() {
        let (skin, sparse) = (square(8.0), square(10.0));
        let sparse = difference(&sparse, &skin);
        let half = |overlap: f64, sparse: &Area| {
            let plan =
                plan_with(SkinPlan::of, |s| s.skin_wall_overlap = overlap);
            let all = laid_between(&skin, sparse, [None; 2], 0, &plan);
            let points = all[0].rings[0].stroke.points.iter();
            points.map(|p| p.x).fold(0.0, f64::max)
        };
        let beside = 8.0 - 0.5 * spacing(0.45, 0.45, 0.2);
        for (overlap, sparse, expected) in [
            (0.0, &Area::EMPTY, beside),
            (25.0, &Area::EMPTY, beside + 0.25 * 0.45),
            (25.0, &sparse, beside),
        ] {
            let is = half(overlap, sparse);
            assert!((is - expected).abs() < 0.011, "{overlap}: {is}");
        }
    }

    #[test]
    fn wide_skin_leaves_half_of_a_narrow_wall() {
        let width = isoslice_settings::ByNozzle::Length;
        let reach = |overlap: f64| {
            let plan = plan_with(SkinPlan::of, |s| {
                s.walls = 1;
                s.outer_wall_width = width(0.4);
                s.skin_width = width(2.0);
                s.skin_wall_overlap = overlap;
            });
            let skin = square(8.0);
            let pressed = into_walls(&skin, &Area::EMPTY, plan.into_walls);
            pressed.unwrap().bounds().max.x
        };
        assert!((reach(50.0) - 8.2).abs() < 0.011);
        assert!((reach(5.0) - 8.1).abs() < 0.011);
    }

    #[test]
    fn a_narrow_ring_gets_strokes_along_it_and_not_across() {
        let space = spacing(0.45, 0.45, 0.2);
        let hole = disc(10.0 - 4.0 * space, 720);
        let area = difference(&disc(10.0, 720), &hole);
        let plan = usual_plan(SkinPlan::of);
        let all = laid_between(&area, &Area::EMPTY, [None; 2], 0, &plan);
        assert_eq!(all.len(), 1);
        assert!(all[0].fills.is_empty());
        let rings = &all[0].rings;
        assert_eq!(rings.len(), 4);
        let laid: f64 =
            rings.iter().map(|b| laid(&b.stroke, 0.45 - space)).sum();
        assert!((laid / area.content() - 1.0).abs() < 2e-3, "{laid}");
        for ring in rings {
            assert!(ring.stroke.closed && ring.role == Role::BottomSkin);
        }
    }

    /// Which share of its content each place of an area gets, on average over
    /// half a millimetre.
    pub(super) fn shares<'a>(
        strokes: impl IntoIterator<Item = &'a Stroke>,
        less: Mm,
        area: &Area,
    ) -> Vec<(DVec2, f64)> {
        const CELL: Mm = 0.05;
        const WINDOW: usize = 10;
        let bounds = area.bounds();
        let size = bounds.size() / CELL;
        let (wide, high) = (size.x.ceil() as usize, size.y.ceil() as usize);
        let mut laid = vec![0.0; wide * high];
        let mut lay = |p: DVec2, content: f64| {
            let at = (p - bounds.min) / CELL;
            let (i, k) = (at.x as usize, at.y as usize);
            if at.min_element() >= 0.0 && i < wide && k < high {
                laid[k * wide + i] += content;
            }
        };
        for s in strokes {
            for (i, (a, b)) in s.segments().enumerate() {
                let steps = (a.distance(b) / 0.02).ceil();
                let across = (b - a).normalize_or_zero().perp();
                for t in (0..steps as usize).map(|j| (j as f64 + 0.5) / steps) {
                    let [from, to] = [s.width_at(i), s.width_at(i + 1)];
                    let width = from + t * (to - from) - less;
                    let part = a.distance(b) / steps * width / 9.0;
                    for j in -4..=4 {
                        let off = across * (width * f64::from(j) / 9.0);
                        lay(a.lerp(b, t) + off, part);
                    }
                }
            }
        }
        let middle = |i: usize, k: usize| {
            bounds.min + CELL * (DVec2::new(i as f64, k as f64) + 0.5)
        };
        let has: Vec<bool> = (0..wide * high)
            .map(|j| area.contains(middle(j % wide, j / wide)))
            .collect();
        let mut shares = Vec::new();
        for k in (0..high.saturating_sub(WINDOW)).step_by(2) {
            for i in (0..wide.saturating_sub(WINDOW)).step_by(2) {
                let cells = (k..k + WINDOW)
                    .flat_map(|k| (i..i + WINDOW).map(move |i| k * wide + i));
                let (got, own) = cells.fold((0.0, 0.0), |(l, h), j| {
                    (l + laid[j], h + f64::from(u8::from(has[j])))
                });
                if own > 0.7 * (WINDOW * WINDOW) as f64 {
                    let at = middle(i + WINDOW / 2, k + WINDOW / 2);
                    shares.push((at, got / (own * CELL * CELL)));
                }
            }
        }
        shares
    }

    #[test]
    fn places_between_holes_are_filled_to_where_they_widen() {
        // Holes some lines apart, and near an edge.
        let plan = usual_plan(SkinPlan::of);
        let space = spacing(0.45, 0.45, 0.2);
        for apart in [2.8, 3.2, 3.6, 4.2, 5.0] {
            let mut area = rect(-9.0, -9.0, 9.0, 9.0);
            let at = 2.5 + 0.5 * apart * space;
            for x in [-at, at] {
                let hole = moved(circle(2.5, 200), x, 9.0 - at);
                area = difference(&area, &Area::from(hole));
            }
            let beside = [Some(&area), None];
            let all = laid_between(&area, &Area::EMPTY, beside, 1, &plan);
            let beads = all.iter().flat_map(|p| {
                let lines = p.fills.iter().flat_map(|f| &f.lines);
                p.rings.iter().chain(lines).map(|b| &b.stroke)
            });
            for (p, share) in shares(beads, 0.45 - space, &area) {
                assert!(share > 0.65, "{apart}, {p}: {share}");
            }
        }
    }

    /// Content by role: what its lines lay.
    fn contents(patches: &[Patch], plan: &SkinPlan) -> Vec<(Role, f64)> {
        let width = plan.internal.width;
        let space = spacing(width, width, 0.2);
        let fills = patches.iter().flat_map(|p| &p.fills);
        fills
            .map(|f| {
                let less = width - space;
                let lines = f.lines.iter().map(|b| laid(&b.stroke, less));
                (f.lines[0].role, lines.sum())
            })
            .collect()
    }

    #[test]
    fn each_side_has_its_role_and_the_rest_is_internal() {
        let base = plan_with(SkinPlan::of, |s| s.bridge_max = 0.0);
        let wider = plan_with(SkinPlan::of, |s| {
            s.bridge_max = 0.0;
            s.top_skin_width = 0.5.into();
            s.skin_pattern.bottom = SkinPattern::Concentric;
        });
        let rect = |x0: f64, x1: f64| {
            Area::from(
                [(x0, -12.0), (x1, -12.0), (x1, 12.0), (x0, 12.0)]
                    .map(DVec2::from)
                    .to_vec(),
            )
        };
        let [above, below] = [rect(-12.0, 5.0), rect(-4.0, 12.0)];
        let laid_by = |plan: &SkinPlan| {
            let beside = [Some(&below), Some(&above)];
            laid_between(&square(10.0), &Area::EMPTY, beside, 1, plan)
        };
        let inner = 20.0 - spacing(0.45, 0.45, 0.2) - 0.4;
        let half = 0.5 * inner;
        let expected = [
            (Role::InternalSkin, 9.0 * inner),
            (Role::BottomSkin, (half - 4.0) * inner),
            (Role::TopSkin, (half - 5.0) * inner),
        ];
        let found = contents(&laid_by(&base), &base);
        // Two corners of what is hidden, in which lines are shorter than 4 mm, go
        // with what is seen beside them.
        let corner = 0.5 * 4.0 * 2.0;
        let moved = [-2.0 * corner, corner, corner];
        for (i, (role, is)) in found.iter().enumerate() {
            let (own, should) = expected[i];
            assert_eq!(*role, own);
            let should = should + moved[i];
            assert!((is / should - 1.0).abs() < 0.02, "{role:?} {is}");
        }
        // These are the areas above, with other widths and patterns.
        let all = laid_by(&wider);
        let fills = &all[0].fills;
        assert_eq!(fills.len(), 3);
        for (fill, (role, should)) in fills.iter().zip(expected) {
            let width = if role == Role::TopSkin { 0.5 } else { 0.45 };
            let space = spacing(width, width, 0.2);
            let lines =
                fill.lines.iter().map(|b| laid(&b.stroke, width - space));
            let is: f64 = lines.sum();
            assert_eq!(fill.lines[0].role, role);
            assert_eq!(fill.lines[0].stroke.width, width);
            let closed = role == Role::BottomSkin;
            assert_eq!(fill.lines[0].stroke.closed, closed);
            // A ring's width is what its place leaves it.
            assert!((is / should - 1.0).abs() < 0.06, "{role:?} {is}");
        }
    }

    #[test]
    fn a_roof_over_a_gap_is_a_bridge_but_not_on_the_bed() {
        let plan = usual_plan(SkinPlan::of);
        let wide = square(12.0);
        let frame = difference(&wide, &square(5.0));
        let on = |below: Option<&Area>, layer: usize| {
            let beside = [below, None];
            laid_between(&square(10.0), &Area::EMPTY, beside, layer, &plan)
        };
        let all = on(Some(&frame), 1);
        let found = contents(&all, &plan);
        let reach = 10.0 + 2.0 * plan.anchor;
        let bridge = found.iter().find(|f| f.0 == Role::Bridge).unwrap();
        assert!((bridge.1 / reach.powi(2) - 1.0).abs() < 0.05, "{found:?}");
        assert_eq!(contents(&on(None, 0), &plan)[0].0, Role::BottomSkin);
    }

    /// The ceiling of a counterbore, which is left to supports if there are some.
    #[test]
    fn a_ceiling_around_a_hole_is_laid_in_rings_unless_supports_hold_it() {
        let plan = usual_plan(SkinPlan::of);
        let skin = difference(&square(10.0), &disc(4.0, 200));
        let below = Solid::new(difference(&square(12.0), &disc(5.5, 200)));
        let here = Solid::new(skin.clone());
        let view = LayerView::of(1, &here, &[], &[&below]);
        let bridged = |supported: bool| -> f64 {
            let all = patches(&skin, &Area::EMPTY, &view, supported, &plan);
            let beads = all.iter().flat_map(Patch::beads);
            let bridges = beads.filter(|b| b.role == Role::Bridge);
            let of_ring = |b: &Bead| {
                assert!(b.stroke.closed);
                b.stroke.length()
            };
            bridges.map(of_ring).sum()
        };
        // Four rings of half a millimetre.
        let length = bridged(false);
        assert!((80.0..140.0).contains(&length), "{length}");
        assert_eq!(bridged(true), 0.0);
    }

    #[test]
    fn ironing_goes_over_tops_alone() {
        let plan = plan_with(SkinPlan::of, |s| s.ironing = SwitchOr::On);
        let [wide, half] = [square(12.0), square(4.0)];
        let beside = [Some(&wide), Some(&half)];
        let all = laid_between(&square(10.0), &Area::EMPTY, beside, 1, &plan);
        let last = all[0].fills.last().unwrap();
        assert_eq!(last.lines[0].role, Role::Ironing);
        let length: f64 = last.lines.iter().map(|b| b.stroke.length()).sum();
        let side = |inner: f64, off: f64| (inner + off).powi(2);
        let inner = 20.0 - spacing(0.45, 0.45, 0.2) - 0.4;
        let should = side(inner, -0.45) - side(8.0, 0.45);
        let is = length * plan.ironing.unwrap();
        assert!((is / should - 1.0).abs() < 0.02, "{is} {should}");
        for line in &last.lines {
            let points = &line.stroke.points;
            assert!(!half.contains(points[0].midpoint(points[1])));
        }
    }

    #[test]
    fn a_strip_that_nobody_sees_is_gap_fill_if_it_is_as_thin_as_a_bead() {
        let around = square(12.0);
        let hidden = [Some(&around); 2];
        let open = [Some(&around), None];
        let beside = |width: f64, sparse: &Area, others| {
            let strip = rect(-5.0, -0.5 * width, 5.0, 0.5 * width);
            let plan = usual_plan(SkinPlan::of);
            let all = laid_between(&strip, sparse, others, 1, &plan);
            let rings = all.iter().flat_map(|p| &p.rings);
            rings.map(|b| b.role).collect::<Vec<_>>()
        };
        let roles = |width: f64, others| beside(width, &Area::EMPTY, others);
        assert_eq!(roles(0.3, hidden), [Role::GapFill]);
        assert_eq!(roles(0.7, hidden), [Role::GapFill]);
        assert_eq!(roles(0.3, open), [Role::TopSkin]);
        // Infill at the strip's end leaves it a gap between walls. Infill along
        // it makes it the shell that the infill lies in.
        let at_end = rect(5.0, -4.0, 9.0, 4.0);
        assert_eq!(beside(0.3, &at_end, hidden), [Role::GapFill]);
        let along = rect(-5.0, 0.15, 5.0, 4.0);
        assert_eq!(beside(0.3, &along, hidden), [Role::InternalSkin]);
        let wide = roles(1.2, hidden);
        assert!(!wide.is_empty());
        assert!(wide.iter().all(|role| *role == Role::InternalSkin));
    }

    #[test]
    fn too_narrow_for_a_ring_is_left_out() {
        let plan = usual_plan(SkinPlan::of);
        let speck = square(0.15);
        let all = laid_between(&speck, &Area::EMPTY, [None; 2], 0, &plan);
        assert!(all.is_empty());
    }
}
