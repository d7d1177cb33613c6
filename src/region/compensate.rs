//! Compensations: outlines changed in the plane before anything is made of
//! them, for what the nozzle and the plastic will do.
//!
//! In: a layer's outline. Out: the outline to print. Slits are filled
//! ([`super::slit`]); all other changes are in-plane distances, exact to the
//! tolerance.

use super::slit::{filled, slits};
use crate::layers::LayerSpan;
use crate::plane::clip::{difference, intersection, union};
use crate::plane::offset::offset;
use crate::plane::{Area, Solid};
use crate::settings::Settings;
use crate::units::Mm;

/// What is done to the outline of a layer: its slits are filled, it is moved
/// outwards everywhere, and then inwards where it is not too thin for that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Compensation {
    /// Slits narrower than this are filled.
    slit: Mm,
    grow: Mm,
    draw_in: Mm,
    /// Thickness of what may be left when the outline is drawn in.
    keep: Mm,
    tolerance: Mm,
}

impl Compensation {
    /// What the settings want for a layer.
    pub(crate) fn new(span: &LayerSpan, settings: &Settings) -> Self {
        let layers = settings.elephant_foot_layers as usize;
        // Nothing squeezes a part on a raft.
        let left = match settings.raft_layers() {
            0 => layers.saturating_sub(span.index) as f64,
            _ => 0.0,
        };
        Compensation {
            slit: 2.0 * settings.slit_closing(),
            grow: settings.xy_compensation,
            draw_in: settings.elephant_foot * left / layers.max(1) as f64,
            keep: 2.0 * settings.outer_wall_width(),
            tolerance: 0.2 * settings.accuracy,
        }
    }

    /// The outline as the print will have it, if the plastic does what it is
    /// drawn in for; `None` if it is not drawn in.
    pub(crate) fn squeezed(&self, outline: &Area) -> Option<Area> {
        let grown = || self.grown(&Solid::of(outline, CELL), &mut []);
        (self.draw_in > 0.0).then(|| grown().unwrap_or_else(|| outline.clone()))
    }

    /// The outline to print, unless it is the one there is. `walls` are areas
    /// that lie so deep in it, and are changed as it is.
    pub(crate) fn apply(
        &self,
        outline: &Solid<'_>,
        walls: &mut [(Mm, Area)],
    ) -> Option<Area> {
        let grown = self.grown(outline, walls);
        if self.draw_in == 0.0 {
            return grown;
        }
        for (_, wall) in walls {
            *wall = self.drawn_in(wall);
        }
        Some(self.drawn_in(grown.as_ref().unwrap_or(outline.area())))
    }

    /// The outline with its slits filled, and grown.
    fn grown(
        &self,
        outline: &Solid<'_>,
        walls: &mut [(Mm, Area)],
    ) -> Option<Area> {
        let closed = self.closed(outline, walls);
        if self.grow == 0.0 {
            return closed;
        }
        let grow = |area: &Area| offset(area, self.grow, self.tolerance);
        for (_, wall) in walls.iter_mut() {
            *wall = grow(wall);
        }
        let grown = grow(closed.as_ref().unwrap_or(outline.area()));
        // What was wider than a slit may be one now.
        let closed = match self.grow > 0.0 {
            true => self.closed(&Solid::of(&grown, CELL), walls),
            false => None,
        };
        Some(closed.unwrap_or(grown))
    }

    /// The outline with its slits filled, if it has any.
    fn closed(
        &self,
        outline: &Solid<'_>,
        walls: &mut [(Mm, Area)],
    ) -> Option<Area> {
        if self.slit <= 0.0 {
            return None;
        }
        let found = slits(outline, self.slit, self.tolerance);
        if found.is_empty() {
            return None;
        }
        let closed = filled(outline.area(), &found, self.slit, self.tolerance);
        for (depth, wall) in walls {
            let around = offset(&found, *depth + self.slit, self.tolerance);
            let inner = offset(&closed, -*depth, self.tolerance);
            *wall = union(wall, &intersection(&inner, &around));
        }
        Some(closed)
    }

    /// The area drawn in, but for the places that would become thinner than
    /// `keep`: these stay as they are.
    fn drawn_in(&self, area: &Area) -> Area {
        let inner = offset(area, -self.draw_in, self.tolerance);
        let half = self.draw_in + 0.5 * self.keep;
        let core = offset(area, -half, self.tolerance);
        // What a disc of this size can reach inside the area; a little more,
        // lest corners and roundings count as thin.
        let reached = offset(&core, half + ROUNDING * half, self.tolerance);
        let thin = difference(area, &reached);
        if thin.is_empty() {
            return inner;
        }
        // Grown into the thicker part, so that what is left of it overlaps.
        let thin = intersection(&offset(&thin, half, self.tolerance), area);
        union(&inner, &thin)
    }
}

/// By how much a disc is taken to be larger than it is: a right-angled corner
/// sticks out of the disc in it by √2 − 1 of its radius.
const ROUNDING: f64 = 0.5;

/// Size of the cells in which edges are looked up, mm.
const CELL: Mm = 1.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::rect;
    use glam::DVec2;

    fn span(index: usize) -> LayerSpan {
        LayerSpan {
            index,
            bottom: 0.2 * index as f64,
            top: 0.2 * (index as f64 + 1.0),
        }
    }

    fn disc(radius: f64) -> Area {
        let points = (0..720).map(|i| {
            DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / 720.0)
                * radius
        });
        Area {
            rings: vec![points.collect()],
        }
    }

    impl Compensation {
        /// The outline to print.
        fn printed(&self, outline: &Area) -> Area {
            self.apply(&Solid::of(outline, CELL), &mut [])
                .unwrap_or_else(|| outline.clone())
        }
    }

    #[test]
    fn nothing_is_moved_by_default() {
        let c = Compensation::new(&span(0), &Settings::default());
        assert_eq!(c.printed(&disc(3.0)), disc(3.0));
        assert_eq!(c.squeezed(&disc(3.0)), None);
    }

    #[test]
    fn outlines_grow_and_holes_shrink() {
        let mut settings = Settings {
            xy_compensation: 0.1,
            ..Settings::default()
        };
        let mut ring = disc(10.0);
        let mut hole = disc(4.0).rings.remove(0);
        hole.reverse();
        ring.rings.push(hole);
        let content = |s: &Settings| {
            Compensation::new(&span(9), s).printed(&ring).content()
        };
        let pi = std::f64::consts::PI;
        let exact = pi * (10.1_f64.powi(2) - 3.9_f64.powi(2));
        assert!((content(&settings) - exact).abs() < 0.07);
        settings.xy_compensation = -0.1;
        let exact = pi * (9.9_f64.powi(2) - 4.1_f64.powi(2));
        assert!((content(&settings) - exact).abs() < 0.07);
    }

    #[test]
    fn the_foot_is_drawn_in_less_from_layer_to_layer() {
        let settings = Settings {
            elephant_foot: 0.3,
            elephant_foot_layers: 3,
            ..Settings::default()
        };
        let square = rect(0.0, 0.0, 20.0, 10.0);
        for (index, by) in [(0, 0.3), (1, 0.2), (2, 0.1)] {
            let c = Compensation::new(&span(index), &settings);
            let got = c.printed(&square);
            let exact = (20.0 - 2.0 * by) * (10.0 - 2.0 * by);
            assert!((got.content() - exact).abs() < 1e-6, "{index}");
        }
        let c = Compensation::new(&span(3), &settings);
        assert_eq!(c.printed(&square), square);
    }

    #[test]
    fn thin_places_keep_their_width() {
        let settings = Settings {
            elephant_foot: 0.3,
            ..Settings::default()
        };
        let c = Compensation::new(&span(0), &settings);
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
            let settings = Settings {
                xy_compensation: by,
                slit_closing: closing.into(),
                ..Settings::default()
            };
            let both = Area {
                rings: [rect(-5.0, 0.0, -gap, 4.0), rect(0.0, 0.0, 5.0, 4.0)]
                    .into_iter()
                    .flat_map(|a| a.rings)
                    .collect(),
            };
            let c = Compensation::new(&span(0), &settings);
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
        let both = |inset: f64| Area {
            rings: [(-5.0, -0.05), (0.0, 5.0)]
                .iter()
                .flat_map(|&(a, b)| {
                    rect(a + inset, inset, b - inset, 4.0 - inset).rings
                })
                .collect(),
        };
        let mut walls = [(0.2, both(0.2)), (0.6, both(0.6))];
        let outline = Solid::new(both(0.0));
        let c = Compensation::new(&span(0), &Settings::default());
        assert!(c.apply(&outline, &mut walls).is_some());
        for (depth, wall) in walls {
            assert_eq!(wall.rings.len(), 1, "{depth}");
            let exact = (10.0 - 2.0 * depth) * (4.0 - 2.0 * depth);
            assert!((wall.content() - exact).abs() < 2e-3, "{depth}");
        }
    }
}
