//! Compensations: outlines changed in the plane before anything is made of
//! them, for what the nozzle and the plastic will do.
//!
//! In: a layer's outline. Out: the outline to print. Slits are filled
//! ([`slit`]); all other changes are in-plane distances, exact to the
//! tolerance. Where a distance differs from place to place, each place of the
//! outline moves by its own, square to the outline.

mod plan;
mod slit;

pub use plan::OutlinePlan;

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_model::expressions::{Quantity, QuantityError};
use isoslice_model::{Model, Place};
use isoslice_planar::bend::{Bend, bends};
use isoslice_planar::clip::{difference, intersection, union, unite};
use isoslice_planar::offset::offset;
use isoslice_planar::opening::wide_parts;
use isoslice_planar::simplify::simplify_area;
use isoslice_planar::{Area, Solid, signed_area};
use isoslice_settings::Varying;
use isoslice_settings::layers::LayerSpan;
use slit::{filled, slits};

/// The distance by which outlines are moved outwards, if it differs from place
/// to place.
pub struct Growth {
    by: Quantity,
    /// Vector from the outlines' coordinates to those of the expression.
    origin: DVec2,
}

/// Places of an outline that are nearer to each other than this share of their
/// way move as one, so that the ways of a round hole that is filled do not all
/// cross each other.
const NEAR: f64 = 0.02;

impl Growth {
    /// `xy_compensation`, if it is an expression.
    ///
    /// # Errors
    /// If the expression has a mistake.
    pub fn new(
        compensation: &Varying<Mm>,
        model: &Model,
    ) -> Result<Option<Growth>, QuantityError> {
        if compensation.constant().is_some() {
            return Ok(None);
        }
        Ok(Some(Growth {
            by: Quantity::of_outline("xy_compensation", compensation)?,
            origin: model.origin.truncate(),
        }))
    }

    /// An area whose border is at the height `z`, grown.
    fn grown(
        &self,
        area: &Area,
        z: Mm,
        tolerance: Mm,
    ) -> Result<Area, QuantityError> {
        let mut rings = Vec::new();
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut places = Vec::new();
        for ring in &area.rings {
            if isoslice_base::limits::is_stopped() {
                break;
            }
            let bends = bends(ring);
            places.clear();
            places.extend(bends.iter().map(|bend: &Bend| Place {
                at: (bend.at + self.origin).extend(z),
                depth: bend.curvature,
            }));
            let mut by = Vec::new();
            self.by.evaluate(&places, &mut by)?;
            least = by.iter().copied().fold(least, f64::min);
            most = by.iter().copied().fold(most, f64::max);
            rings.push((bends, by));
        }
        // A way that is the same everywhere is that of a number.
        if most - least <= tolerance {
            return Ok(offset(area, 0.5 * (least + most), tolerance));
        }
        // What is too thin for the shortest way inwards vanishes. Long ways over
        // thin places cross each other too often to be walked.
        if most < 0.0 && offset(area, most, tolerance).is_empty() {
            return Ok(Area::EMPTY);
        }
        Ok(simplify_area(&moved(area, &rings), tolerance))
    }
}

/// An area whose border is moved outwards: the places of each ring, and the way
/// of each place.
fn moved(area: &Area, rings: &[(Vec<Bend>, Vec<Mm>)]) -> Area {
    // The areas that the border passes over on its way outwards and
    // inwards. The border may meet itself there, as that of a hole does
    // that is filled.
    let (mut added, mut taken) = (Area::EMPTY, Area::EMPTY);
    for (bends, by) in rings {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let mut kept: Vec<(DVec2, DVec2, Mm)> = Vec::new();
        for (bend, &by) in bends.iter().zip(by) {
            let apart = |last: &(DVec2, DVec2, Mm)| {
                last.0.distance(bend.at) >= NEAR * by.abs()
            };
            if kept.last().is_none_or(apart) {
                kept.push((bend.at, by * bend.out, by));
            }
        }
        let pairs = kept.iter().zip(kept.iter().cycle().skip(1));
        for (&(a, from, by), &(b, to, next)) in pairs {
            let way = by + next;
            if way == 0.0 {
                continue;
            }
            let (c, d) = (b + to, a + from);
            let to = if way > 0.0 { &mut added } else { &mut taken };
            // Two triangles, since the ways of two places may cross.
            for mut half in [vec![a, b, c], vec![a, c, d]] {
                if signed_area(&half) < 0.0 {
                    half.reverse();
                }
                to.rings.push(half);
            }
        }
    }
    let mut grown = area.clone();
    if !added.is_empty() {
        grown = union(&grown, &unite(&added));
    }
    if !taken.is_empty() {
        grown = difference(&grown, &unite(&taken));
    }
    grown
}

/// The distance by which the outline of a layer is moved outwards.
#[derive(Clone, Copy)]
enum Grow<'a> {
    By(Mm),
    /// A distance that differs from place to place, and the layer's height in
    /// it.
    Varying(&'a Growth, Mm),
}

/// The changes to the outline of a layer: its slits are filled, and it is moved
/// outwards, and then inwards where it is not too thin for that.
#[derive(Clone, Copy)]
pub struct Compensation<'a> {
    plan: OutlinePlan,
    grow: Grow<'a>,
    draw_in: Mm,
}

impl<'a> Compensation<'a> {
    /// The changes of a layer. `growth` tells how far each place moves outwards,
    /// if not all of them move alike.
    pub fn new(
        span: &LayerSpan,
        plan: OutlinePlan,
        growth: Option<&'a Growth>,
    ) -> Self {
        let layers = plan.foot_layers;
        let left = layers.saturating_sub(span.index) as f64;
        Compensation {
            plan,
            grow: match growth {
                Some(growth) => Grow::Varying(growth, span.sample_z()),
                None => Grow::By(plan.grow),
            },
            draw_in: plan.foot * left / layers.max(1) as f64,
        }
    }

    /// True if the outline of another layer of the part is surely changed as
    /// this one's would be.
    pub fn is_like(&self, other: &Compensation<'_>) -> bool {
        match (self.grow, other.grow) {
            (Grow::By(a), Grow::By(b)) => {
                a == b && self.draw_in == other.draw_in
            }
            _ => false,
        }
    }

    /// The outline that the print will have if the plastic is squeezed out as
    /// much as the outline is drawn in; `None` if it is not drawn in.
    ///
    /// # Errors
    /// If an expression has no value somewhere.
    pub fn squeezed(
        &self,
        outline: &Area,
    ) -> Result<Option<Area>, QuantityError> {
        if self.draw_in == 0.0 {
            return Ok(None);
        }
        let grown = self.grown(&Solid::of(outline, CELL), &mut [])?;
        Ok(Some(grown.unwrap_or_else(|| outline.clone())))
    }

    /// The outline to print; `None` if nothing is to be changed. `walls` are
    /// areas inside the outline, each with its depth, and are changed as the
    /// outline is.
    ///
    /// # Errors
    /// If an expression has no value somewhere.
    pub fn apply(
        &self,
        outline: &Solid<'_>,
        walls: &mut [(Mm, Area)],
    ) -> Result<Option<Area>, QuantityError> {
        let grown = self.grown(outline, walls)?;
        if self.draw_in == 0.0 {
            return Ok(grown);
        }
        for (_, wall) in walls {
            *wall = self.drawn_in(wall);
        }
        Ok(Some(
            self.drawn_in(grown.as_ref().unwrap_or(outline.area())),
        ))
    }

    /// The outline with its slits filled, and grown.
    fn grown(
        &self,
        outline: &Solid<'_>,
        walls: &mut [(Mm, Area)],
    ) -> Result<Option<Area>, QuantityError> {
        let closed = self.closed(outline, walls);
        if matches!(self.grow, Grow::By(0.0)) {
            return Ok(closed);
        }
        let grow = |area: &Area| match self.grow {
            Grow::By(by) => Ok(offset(area, by, self.plan.tolerance)),
            Grow::Varying(growth, z) => {
                growth.grown(area, z, self.plan.tolerance)
            }
        };
        for (_, wall) in walls.iter_mut() {
            *wall = grow(wall)?;
        }
        let grown = grow(closed.as_ref().unwrap_or(outline.area()))?;
        // A gap that was wider than a slit may be a slit now that the outline
        // has grown.
        let closed = match self.grow {
            Grow::By(..=0.0) => None,
            _ => self.closed(&Solid::of(&grown, CELL), walls),
        };
        Ok(Some(closed.unwrap_or(grown)))
    }

    /// The outline with its slits filled, if it has any.
    fn closed(
        &self,
        outline: &Solid<'_>,
        walls: &mut [(Mm, Area)],
    ) -> Option<Area> {
        if self.plan.slit <= 0.0 {
            return None;
        }
        let found = slits(outline, self.plan.slit, self.plan.tolerance);
        if found.is_empty() {
            return None;
        }
        let closed =
            filled(outline.area(), &found, self.plan.slit, self.plan.tolerance);
        for (depth, wall) in walls {
            let around =
                offset(&found, *depth + self.plan.slit, self.plan.tolerance);
            let inner = offset(&closed, -*depth, self.plan.tolerance);
            *wall = union(wall, &intersection(&inner, &around));
        }
        Some(closed)
    }

    /// The area drawn in, but for the places that would become thinner than
    /// `keep`: these stay as they are.
    fn drawn_in(&self, area: &Area) -> Area {
        let inner = offset(area, -self.draw_in, self.plan.tolerance);
        let half = self.draw_in + 0.5 * self.plan.keep;
        let wide = wide_parts(area, half, self.plan.tolerance);
        let thin = difference(area, &wide);
        if thin.is_empty() {
            return inner;
        }
        // Thin places grow into the thicker part beside them, so that they
        // overlap with what is left of that part.
        let thin =
            intersection(&offset(&thin, half, self.plan.tolerance), area);
        union(&inner, &thin)
    }
}

/// Size of the cells in which edges are looked up, mm.
const CELL: Mm = 1.0;

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::{rect, shapes};
    use isoslice_settings::testing::{plan_with, usual_plan};
    use std::f64::consts::PI;

    fn span(index: usize) -> LayerSpan {
        LayerSpan {
            index,
            bottom: 0.2 * index as f64,
            top: 0.2 * (index as f64 + 1.0),
        }
    }

    fn usual() -> OutlinePlan {
        usual_plan(OutlinePlan::of)
    }

    fn disc(radius: f64) -> Area {
        shapes::disc(radius, 720)
    }

    impl Compensation<'_> {
        /// The outline to print.
        fn printed(&self, outline: &Area) -> Area {
            self.apply(&Solid::of(outline, CELL), &mut [])
                .unwrap()
                .unwrap_or_else(|| outline.clone())
        }
    }

    /// The outline that a formula for `xy_compensation` makes of an outline.
    fn by_formula(text: &str, outline: &Area) -> Result<Area, QuantityError> {
        let value = Varying::Expression(text.to_owned());
        let growth = Growth {
            by: Quantity::of_outline("xy_compensation", &value)?,
            origin: DVec2::ZERO,
        };
        let c = Compensation::new(&span(9), usual(), Some(&growth));
        let grown = c.apply(&Solid::of(outline, CELL), &mut [])?;
        Ok(grown.unwrap_or_else(|| outline.clone()))
    }

    /// A disc of 10 mm with round holes of these radii.
    fn with_holes(radii: &[f64]) -> Area {
        let mut area = disc(10.0);
        for (i, radius) in radii.iter().enumerate() {
            let middle = DVec2::from_angle(i as f64 * 2.0) * 5.5;
            let ring = disc(*radius).rings.remove(0).into_iter().rev();
            area.rings.push(ring.map(|p| p + middle).collect());
        }
        area
    }

    /// Mean radii of an area's rings, as circles of their content.
    fn radii(area: &Area) -> Vec<f64> {
        let content = |r: &Vec<DVec2>| signed_area(r).abs();
        let rings = area.rings.iter();
        rings.map(|r| (content(r) / PI).sqrt()).collect()
    }

    #[test]
    fn holes_are_widened_by_their_curvature() {
        let before = with_holes(&[0.5, 1.0, 2.5]);
        // Holes become wider by 0.05 mm² over their radius; the disc stays.
        let text = "0.05*min(curvature, 0)";
        let after = by_formula(text, &before).unwrap();
        let found = radii(&after);
        assert_eq!(found.len(), 4);
        for exact in [10.0, 0.5 + 0.1, 1.0 + 0.05, 2.5 + 0.02] {
            let off = found.iter().map(|r| (r - exact).abs());
            let off = off.fold(f64::INFINITY, f64::min);
            assert!(off < 0.004, "{exact}: {found:?}");
        }
    }

    /// Ways of 5 mm over thin strips cross each other a million times.
    #[test]
    fn a_long_way_over_thin_strips_is_not_walked() {
        let strip = |i: u32| rect(0.0, f64::from(i), 60.0, f64::from(i) + 0.5);
        let strips = Area {
            rings: (0..300).flat_map(|i| strip(i).rings).collect(),
        };
        for text in ["-5", "-5 + 0*x", "-4.5 - 0.005*x"] {
            assert!(by_formula(text, &strips).unwrap().is_empty(), "{text}");
        }
        let one = by_formula("5", &strips).unwrap();
        assert_eq!(one.rings.len(), 1, "the strips grow together");
        // A thicker strip among them is left.
        let mut with = strips;
        with.rings.extend(rect(0.0, 310.0, 60.0, 320.0).rings);
        let left = by_formula("-0.4 + 0.001*x", &with).unwrap();
        assert_eq!(left.rings.len(), 1);
    }

    #[test]
    fn a_formula_of_places_moves_each_place_by_its_own() {
        let square = rect(-10.0, -10.0, 10.0, 10.0);
        let even = by_formula("0.1 + 0*x", &square).unwrap();
        let exact = 20.2 * 20.2 - (4.0 - PI) * 0.1 * 0.1;
        assert!((even.content() - exact).abs() < 1e-2);
        // The right side moves by 0.2, the left one inwards by 0.2.
        let skew = by_formula("0.02*x", &square).unwrap();
        let bounds = skew.bounds();
        assert!((bounds.max.x - 10.2).abs() < 2e-3, "{bounds:?}");
        assert!((bounds.min.x + 9.8).abs() < 2e-3, "{bounds:?}");
        // A hole that is filled is gone, and nothing is inside out.
        let holes = with_holes(&[0.5, 2.5]);
        let filled = by_formula("0.6 + 0*x", &holes).unwrap();
        assert_eq!(filled.rings.len(), 2);
        let exact = PI * (10.6f64.powi(2) - 1.9f64.powi(2));
        assert!((filled.content() - exact).abs() < 0.2);
        let error = by_formula("sqrt(curvature)", &holes).unwrap_err();
        let error = error.to_string();
        assert!(
            error.contains("xy_compensation")
                && error.contains("curvature = -"),
            "{error}"
        );
        assert!(by_formula("d", &holes).is_err());
    }

    #[test]
    fn nothing_is_moved_by_default() {
        let c = Compensation::new(&span(0), usual(), None);
        assert_eq!(c.printed(&disc(3.0)), disc(3.0));
        assert_eq!(c.squeezed(&disc(3.0)), Ok(None));
    }

    #[test]
    fn outlines_grow_and_holes_shrink() {
        let mut ring = disc(10.0);
        let mut hole = disc(4.0).rings.remove(0);
        hole.reverse();
        ring.rings.push(hole);
        let content = |by: Mm| {
            let plan =
                plan_with(OutlinePlan::of, |s| s.xy_compensation = by.into());
            Compensation::new(&span(9), plan, None)
                .printed(&ring)
                .content()
        };
        let exact = PI * (10.1_f64.powi(2) - 3.9_f64.powi(2));
        assert!((content(0.1) - exact).abs() < 0.07);
        let exact = PI * (9.9_f64.powi(2) - 4.1_f64.powi(2));
        assert!((content(-0.1) - exact).abs() < 0.07);
    }

    #[test]
    fn the_foot_is_drawn_in_less_from_layer_to_layer() {
        let plan = plan_with(OutlinePlan::of, |s| {
            s.elephant_foot = isoslice_settings::ElephantFoot {
                drawn: 0.3,
                layers: 3,
            };
        });
        let square = rect(0.0, 0.0, 20.0, 10.0);
        for (index, by) in [(0, 0.3), (1, 0.2), (2, 0.1)] {
            let c = Compensation::new(&span(index), plan, None);
            let got = c.printed(&square);
            let exact = (20.0 - 2.0 * by) * (10.0 - 2.0 * by);
            assert!((got.content() - exact).abs() < 1e-6, "{index}");
        }
        let c = Compensation::new(&span(3), plan, None);
        assert_eq!(c.printed(&square), square);
    }

    #[test]
    fn thin_places_keep_their_width() {
        let plan = plan_with(OutlinePlan::of, |s| s.elephant_foot = 0.3.into());
        let c = Compensation::new(&span(0), plan, None);
        // A block with a fin of 0.8 mm.
        let block = rect(0.0, 0.0, 20.0, 20.0);
        let fin = rect(20.0, 9.6, 40.0, 10.4);
        let both = union(&block, &fin);
        let got = c.printed(&both);
        assert_eq!(got.rings.len(), 1, "in one piece");
        assert!(got.contains(DVec2::new(39.9, 10.35)));
        assert!(got.contains(DVec2::new(39.9, 9.65)));
        assert!(got.contains(DVec2::new(20.0, 10.0)));
        // The block's own sides are drawn in.
        assert!(!got.contains(DVec2::new(10.0, 0.25)));
        assert!(!got.contains(DVec2::new(0.25, 10.0)));
        assert!(!got.contains(DVec2::new(19.8, 2.0)));
        assert!(got.contains(DVec2::new(10.0, 0.35)));
    }

    /// Slits close before the outline moves inwards, which would widen them,
    /// and after it has moved outwards, which narrows them.
    #[test]
    fn slits_are_told_by_what_is_left_of_them() {
        let parts = |gap: f64, by: f64, closing: f64| {
            let plan = plan_with(OutlinePlan::of, |s| {
                s.xy_compensation = by.into();
                s.slit_closing = closing.into();
            });
            let both = Area::from_iter([
                rect(-5.0, 0.0, -gap, 4.0),
                rect(0.0, 0.0, 5.0, 4.0),
            ]);
            let c = Compensation::new(&span(0), plan, None);
            c.printed(&both).rings.len()
        };
        assert_eq!(parts(0.05, 0.0, 0.05), 1);
        assert_eq!(parts(0.05, 0.0, 0.0), 2);
        assert_eq!(parts(0.05, -0.2, 0.05), 1);
        assert_eq!(parts(0.25, 0.0, 0.05), 2);
        assert_eq!(parts(0.25, 0.1, 0.05), 1);
        assert_eq!(parts(0.35, 0.1, 0.05), 2);
    }

    /// Walls that are offsets of the expression close where the outline does.
    #[test]
    fn walls_of_the_field_close_with_the_outline() {
        let both = |inset: f64| {
            [(-5.0, -0.03), (0.0, 5.0)]
                .iter()
                .flat_map(|&(a, b)| {
                    rect(a + inset, inset, b - inset, 4.0 - inset).rings
                })
                .collect()
        };
        let mut walls = [(0.2, both(0.2)), (0.6, both(0.6))];
        let outline = Solid::new(both(0.0));
        let c = Compensation::new(&span(0), usual(), None);
        assert!(c.apply(&outline, &mut walls).unwrap().is_some());
        for (depth, wall) in walls {
            assert_eq!(wall.rings.len(), 1, "{depth}");
            let exact = (10.0 - 2.0 * depth) * (4.0 - 2.0 * depth);
            assert!((wall.content() - exact).abs() < 2e-3, "{depth}");
        }
    }
}
