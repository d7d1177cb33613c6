//! What helps the first layer: the skirt.

use crate::bead::{Bead, Role, spacing};
use crate::plane::Area;
use crate::plane::offset::offset;
use crate::settings::Settings;
use crate::units::Mm;
use geo::{ConvexHull, Coord, MultiPoint, Point};
use glam::DVec2;

/// Loops around everything that is printed, `skirt.distance` away from the
/// hull of the outline, the outermost first: they show that the nozzle
/// primes and the bed is level, and keep draughts off.
pub fn skirt(outline: &Area, height: Mm, settings: &Settings) -> Vec<Bead> {
    let points: MultiPoint<f64> = outline
        .rings
        .iter()
        .flatten()
        .map(|p| Point::new(p.x, p.y))
        .collect();
    let hull: Vec<DVec2> = points
        .convex_hull()
        .exterior()
        .coords()
        .skip(1)
        .map(|&Coord { x, y }| DVec2::new(x, y))
        .collect();
    if hull.len() < 3 {
        return Vec::new();
    }
    let hull = Area { rings: vec![hull] };
    let width = settings.outer_wall_width;
    let step = spacing(width, width, height);
    (0..settings.skirt.loops)
        .rev()
        .flat_map(|i| {
            let away =
                settings.skirt.distance + 0.5 * width + step * f64::from(i);
            offset(&hull, away, 0.01).rings
        })
        .map(|points| Bead {
            role: Role::Skirt,
            points,
            closed: true,
            width,
            widths: Vec::new(),
            height,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_skirt_keeps_its_distance() {
        let ring = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        let outline = Area { rings: vec![ring] };
        let mut settings = Settings::default();
        settings.skirt.loops = 2;
        let loops = skirt(&outline, 0.2, &settings);
        assert_eq!(loops.len(), 2);
        let inner = &loops[1];
        let exact = 40.0 + std::f64::consts::TAU * 6.225;
        assert!((inner.length() - exact).abs() < 0.1, "{}", inner.length());
        assert!(skirt(&Area::EMPTY, 0.2, &settings).is_empty());
    }
}
