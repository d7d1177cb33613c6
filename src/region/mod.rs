//! What a layer's solid is made of: walls, skin, sparse infill.
//!
//! ```text
//!   outline ┃←w₀/2→┊←──s──→┊←s/2→│  fill: sparse or skin
//!           ┃ outer wall    inner │
//! ```
//!
//! In: the outline of the layer and those of its neighbours. Out: the centre
//! lines of the walls, in-plane offsets of the outline in millimetres, and
//! the area inside them, split by [`exposure`] into skin and sparse infill.
//!
//! Not done here: places too thin for a wall stay empty; their area is
//! reported as a gap.

pub mod exposure;

use crate::bead::spacing;
use crate::plane::offset::offset;
use crate::plane::simplify::simplify;
use crate::plane::{Area, signed_area};
use crate::settings::Settings;
use crate::units::{Mm, Mm2};

/// Share of `accuracy` left to the outline; the offsets get the rest.
pub const OUTLINE_SHARE: f64 = 0.7;

/// A layer's walls and the area inside them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Walls {
    /// Centre lines, the outermost wall first.
    pub lines: Vec<Area>,
    /// Width of each of them.
    pub widths: Vec<Mm>,
    /// What the walls leave for infill and skin.
    pub fill: Area,
    /// Solid that is neither under a wall nor left for filling, because a
    /// wall does not fit: mm², good to a per cent of a wall's area.
    pub gap: Mm2,
}

/// Depths of the walls' centre lines below the outline, outermost first, and
/// that of the border of the fill.
pub fn wall_depths(height: Mm, settings: &Settings) -> (Vec<Mm>, Mm) {
    let (outer, inner) = (settings.outer_wall_width, settings.inner_wall_width);
    let mut depths = Vec::new();
    let mut depth = 0.5 * outer;
    for i in 0..settings.walls {
        depths.push(depth);
        let here = if i == 0 { outer } else { inner };
        depth += spacing(here, inner, height);
    }
    let border = match depths.last() {
        Some(last) => last + 0.5 * (depth - last),
        None => 0.0,
    };
    (depths, border)
}

/// The walls of an outline, as offsets in the plane.
///
/// Each wall is made from the one outside it: shrinking by a and then by b
/// is shrinking by a + b, exactly, and the rings become simpler on the way.
pub fn walls(outline: &Area, height: Mm, settings: &Settings) -> Walls {
    let tolerance = 0.5 * (1.0 - OUTLINE_SHARE) * settings.accuracy;
    let (depths, border) = wall_depths(height, settings);
    let mut current = outline.clone();
    let mut at = 0.0;
    let mut lines = Vec::new();
    for &depth in &depths {
        current = shrink(&current, depth - at, tolerance);
        at = depth;
        lines.push(current.clone());
    }
    let fill = shrink(&current, border - at, tolerance);
    finish(outline, lines, fill, &depths, border, settings)
}

fn finish(
    outline: &Area,
    lines: Vec<Area>,
    fill: Area,
    depths: &[Mm],
    border: Mm,
    settings: &Settings,
) -> Walls {
    let widths = (0..lines.len())
        .map(|i| match i {
            0 => settings.outer_wall_width,
            _ => settings.inner_wall_width,
        })
        .collect();
    Walls {
        gap: gap(outline, &lines, &fill, depths, border),
        lines,
        widths,
        fill,
    }
}

/// Walls whose centre lines are outlines of the expression offset by their
/// depths: `areas`, outermost first, the fill's border last. In-plane
/// millimetres only where the field is an in-plane distance.
pub fn field_walls(
    outline: &Area,
    mut areas: Vec<Area>,
    height: Mm,
    settings: &Settings,
) -> Walls {
    let fill = areas.pop().unwrap_or_default();
    let (depths, border) = wall_depths(height, settings);
    finish(outline, areas, fill, &depths, border, settings)
}

/// The area shrunk by `distance` and thinned.
pub(crate) fn shrink(area: &Area, distance: Mm, tolerance: Mm) -> Area {
    if distance == 0.0 {
        return area.clone();
    }
    let mut shrunk = offset(area, -distance, tolerance);
    shrunk.rings = shrunk
        .rings
        .iter()
        .map(|r| simplify(r, tolerance))
        .filter(|r| !r.is_empty())
        .collect();
    shrunk
}

/// Content of the outline less that of the walls' bands and the fill.
///
/// A band between the depths a and b around a closed line of length L at
/// depth m has the content L·(b − a) + π·χ·((m − a)² − (b − m)²) (Steiner's
/// formula, χ the number of outer rings less that of holes): exact for round
/// corners, off by a fraction of a square width at sharp ones.
fn gap(
    outline: &Area,
    lines: &[Area],
    fill: &Area,
    depths: &[Mm],
    border: Mm,
) -> Mm2 {
    let mut covered = fill.content();
    let mut inside = 0.0;
    for (i, line) in lines.iter().enumerate() {
        let middle = depths[i];
        let outside = inside;
        inside = match depths.get(i + 1) {
            Some(next) => 0.5 * (middle + next),
            None => border,
        };
        let turns: f64 =
            line.rings.iter().map(|r| signed_area(r).signum()).sum();
        covered += line.perimeter() * (inside - outside)
            + std::f64::consts::PI
                * turns
                * ((middle - outside).powi(2) - (inside - middle).powi(2));
    }
    // Sharp corners and thinning leave a remainder even where walls fit.
    let noise = 0.01 * (outline.content() - fill.content()).max(0.0);
    let gap = outline.content() - covered;
    if gap > noise { gap } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use std::f64::consts::{PI, TAU};

    fn disc(r: f64) -> Area {
        let ring = (0..2000)
            .map(|i| DVec2::from_angle(TAU * f64::from(i) / 2000.0) * r)
            .collect();
        Area { rings: vec![ring] }
    }

    #[test]
    fn walls_of_a_disc_are_concentric() {
        let settings = Settings {
            walls: 3,
            ..Settings::default()
        };
        let w = walls(&disc(10.0), 0.2, &settings);
        let s = spacing(0.45, 0.45, 0.2);
        for (k, line) in w.lines.iter().enumerate() {
            let r = 10.0 - 0.225 - s * k as f64;
            assert_eq!(line.rings.len(), 1);
            for p in &line.rings[0] {
                assert!((p.length() - r).abs() < 0.002, "{k}: {p}");
            }
        }
        let inner = 10.0 - 0.225 - 2.5 * s;
        assert!((w.fill.content() - PI * inner * inner).abs() < 0.1);
        assert_eq!(w.gap, 0.0);
    }

    #[test]
    fn a_strip_too_thin_for_two_walls_has_a_gap() {
        let strip = |width: f64| {
            let ring = [(0.0, 0.0), (50.0, 0.0), (50.0, width), (0.0, width)]
                .map(|(x, y)| DVec2::new(x, y))
                .to_vec();
            walls(&Area { rings: vec![ring] }, 0.2, &Settings::default())
        };
        // One ring fits into 0.6 mm and leaves nothing inside to speak of;
        // none fits into 0.4 mm.
        assert!((strip(0.4).gap - 20.0).abs() < 1e-6);
        assert!(strip(1.2).gap > 5.0);
        assert_eq!(strip(5.0).gap, 0.0);
    }

    #[test]
    fn no_walls_leave_everything_to_the_fill() {
        let settings = Settings {
            walls: 0,
            ..Settings::default()
        };
        let w = walls(&disc(3.0), 0.2, &settings);
        assert!(w.lines.is_empty());
        assert_eq!(w.fill, disc(3.0));
        assert_eq!(w.gap, 0.0);
    }
}
