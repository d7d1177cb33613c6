//! Compensations: outlines moved in the plane before anything is made of
//! them, for what the plastic will do.
//!
//! In: a layer's outline. Out: the outline to print. Both compensations are
//! in-plane distances, exact to the tolerance.

use crate::layers::LayerSpan;
use crate::plane::Area;
use crate::plane::clip::{difference, intersection, union};
use crate::plane::offset::offset;
use crate::settings::Settings;
use crate::units::Mm;

/// How far the outline of a layer is moved: outwards everywhere, and then
/// inwards where it is not too thin for that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensation {
    grow: Mm,
    draw_in: Mm,
    /// Thickness of what may be left when the outline is drawn in.
    keep: Mm,
    tolerance: Mm,
}

impl Compensation {
    /// What the settings want for a layer; `None` if nothing is moved.
    pub fn new(span: &LayerSpan, settings: &Settings) -> Option<Self> {
        let layers = settings.elephant_foot_layers as usize;
        let left = layers.saturating_sub(span.index) as f64;
        let it = Compensation {
            grow: settings.xy_compensation,
            draw_in: settings.elephant_foot * left / layers.max(1) as f64,
            keep: 2.0 * settings.outer_wall_width,
            tolerance: 0.2 * settings.accuracy,
        };
        (it.grow != 0.0 || it.draw_in > 0.0).then_some(it)
    }

    /// The outline as the print will have it, if the plastic does what it is
    /// drawn in for; `None` if it is not drawn in.
    pub fn squeezed(&self, outline: &Area) -> Option<Area> {
        (self.draw_in > 0.0).then(|| offset(outline, self.grow, self.tolerance))
    }

    /// The outline, moved.
    pub fn apply(&self, outline: &Area) -> Area {
        let area = offset(outline, self.grow, self.tolerance);
        match self.draw_in > 0.0 {
            true => self.drawn_in(&area),
            false => area,
        }
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

    #[test]
    fn nothing_is_moved_by_default() {
        assert_eq!(Compensation::new(&span(0), &Settings::default()), None);
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
            let c = Compensation::new(&span(9), s).unwrap();
            c.apply(&ring).content()
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
            let c = Compensation::new(&span(index), &settings).unwrap();
            let got = c.apply(&square);
            let exact = (20.0 - 2.0 * by) * (10.0 - 2.0 * by);
            assert!((got.content() - exact).abs() < 1e-6, "{index}");
        }
        assert_eq!(Compensation::new(&span(3), &settings), None);
    }

    #[test]
    fn thin_places_keep_their_width() {
        let settings = Settings {
            elephant_foot: 0.3,
            ..Settings::default()
        };
        let c = Compensation::new(&span(0), &settings).unwrap();
        // A block with a fin of 0.8 mm.
        let block = rect(0.0, 0.0, 20.0, 20.0);
        let fin = rect(20.0, 9.6, 40.0, 10.4);
        let both = union(&block, &fin);
        let got = c.apply(&both);
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
}
