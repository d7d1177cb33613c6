//! Sparse infill: a pattern's lines inside the covered areas.
//!
//! One pattern per file, each a [`Pattern`]. A pattern's place depends on
//! the settings and the model's coordinates only, so that layers stand on
//! each other and islands continue each other.

mod grid;
mod rectilinear;

use crate::bead::{Bead, Role, spacing};
use crate::plane::Area;
use crate::plane::hatch::Segment;
use crate::plane::offset::offset;
use crate::settings::{InfillPattern, Settings};
use crate::units::{Degrees, Mm};

/// What a pattern needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Number of the layer.
    pub layer: usize,
    /// Distance of parallel lines that would give the density if all lines
    /// of the layer had one direction.
    pub spacing: Mm,
    /// Direction of the lines.
    pub angle: Degrees,
    /// Pieces shorter than this are not worth a travel.
    pub shortest: Mm,
}

/// A way to fill an area with lines.
pub trait Pattern {
    /// The pattern's lines inside the area.
    fn lines(&self, area: &Area, params: &Params) -> Vec<Segment>;
}

/// The pattern of that name.
pub fn pattern(kind: InfillPattern) -> &'static dyn Pattern {
    match kind {
        InfillPattern::Rectilinear => &rectilinear::Rectilinear,
        InfillPattern::Grid => &grid::Grid,
    }
}

/// Beads of a layer's sparse infill.
///
/// Lines reach into the walls around the area by `infill_overlap` of their
/// width: their round ends overlap the wall's bead by that much.
pub fn beads(
    sparse: &Area,
    layer: usize,
    height: Mm,
    settings: &Settings,
) -> Vec<Bead> {
    let width = settings.infill_width;
    // Graded by an expression, infill is laid by the patterns themselves.
    let density = settings.infill_density.constant().unwrap_or(0.0);
    if sparse.is_empty() || density <= 0.0 {
        return Vec::new();
    }
    let overlap = width * settings.infill_overlap / 100.0;
    let ends = offset(sparse, overlap - 0.5 * width, 0.02);
    let params = Params {
        layer,
        spacing: spacing(width, width, height) * 100.0 / density,
        angle: settings.infill_angle,
        shortest: width,
    };
    pattern(settings.infill_pattern)
        .lines(&ends, &params)
        .iter()
        .map(|s| Bead {
            role: Role::SparseInfill,
            points: vec![s.from, s.to],
            closed: false,
            width,
            widths: Vec::new(),
            height,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn density_is_the_share_of_the_area_under_beads() {
        let ring = [(-25.0, -25.0), (25.0, -25.0), (25.0, 25.0), (-25.0, 25.0)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        let area = Area { rings: vec![ring] };
        for kind in [InfillPattern::Rectilinear, InfillPattern::Grid] {
            for density in [10.0, 25.0, 60.0] {
                let settings = Settings {
                    infill_density: density.into(),
                    infill_pattern: kind,
                    ..Settings::default()
                };
                // Two layers: the lines turn from one to the next.
                let volume: f64 = (0..2)
                    .flat_map(|i| beads(&area, i, 0.2, &settings))
                    .map(|b| b.area() * b.length())
                    .sum();
                let share = 100.0 * volume / (2500.0 * 0.4);
                assert!(
                    (share / density - 1.0).abs() < 0.03,
                    "{kind:?} {density}: {share}"
                );
            }
        }
    }

    #[test]
    fn no_density_no_beads() {
        let ring = [(0.0, 0.0), (30.0, 0.0), (30.0, 30.0), (0.0, 30.0)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        let area = Area { rings: vec![ring] };
        let settings = |density: f64| Settings {
            infill_density: density.into(),
            ..Settings::default()
        };
        assert!(!beads(&area, 0, 0.2, &settings(5.0)).is_empty());
        assert!(beads(&area, 0, 0.2, &settings(0.0)).is_empty());
    }
}
