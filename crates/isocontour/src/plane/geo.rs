//! Areas as `geo-types` has them, for libraries that go on from there.

use super::{Area, Ring, signed_area};
use geo_types::{Coord, LineString, MultiPolygon, Polygon};
use glam::DVec2;

/// The islands of an area, each as a polygon with its holes.
impl From<&Area> for MultiPolygon<f64> {
    fn from(area: &Area) -> MultiPolygon<f64> {
        let polygon = |island: Area| {
            let mut rings = island.rings.iter().map(|r| line(r));
            let outer = rings.next().unwrap_or_else(LineString::empty);
            Polygon::new(outer, rings.collect())
        };
        MultiPolygon(area.islands().into_iter().map(polygon).collect())
    }
}

/// The area of polygons, whichever way round their rings run.
impl From<&MultiPolygon<f64>> for Area {
    fn from(polygons: &MultiPolygon<f64>) -> Area {
        let rings = polygons.iter().flat_map(|polygon| {
            let holes = polygon.interiors().iter();
            std::iter::once(ring(polygon.exterior(), true))
                .chain(holes.map(|hole| ring(hole, false)))
        });
        rings.filter(|ring| ring.len() > 2).collect()
    }
}

/// A ring whose first point is repeated at the end.
fn line(ring: &[DVec2]) -> LineString<f64> {
    let points = ring.iter().chain(ring.first());
    points.map(|p| Coord { x: p.x, y: p.y }).collect()
}

/// A ring that runs counter-clockwise, or clockwise.
fn ring(line: &LineString<f64>, counter_clockwise: bool) -> Ring {
    let points = line.coords().map(|c| DVec2::new(c.x, c.y));
    let mut ring: Ring = points.collect();
    // `geo-types` closes the rings of polygons.
    ring.pop();
    if (signed_area(&ring) > 0.0) != counter_clockwise {
        ring.reverse();
    }
    ring
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::tests::{reversed, square};

    #[test]
    fn an_area_comes_back_as_it_was() {
        // A frame with an island in its hole, and a square beside it.
        let area = Area::from_iter([
            square(0.0, 0.0, 10.0),
            reversed(square(0.0, 0.0, 8.0)),
            square(0.0, 0.0, 5.0),
            square(30.0, 0.0, 2.0),
        ]);
        let polygons = MultiPolygon::from(&area);
        let holes: Vec<usize> =
            polygons.iter().map(|p| p.interiors().len()).collect();
        assert_eq!(holes, [1, 0, 0]);
        let back = Area::from(&polygons);
        assert_eq!(back, area);
        // The rings of other libraries run either way round.
        let turned = polygons.iter().map(|polygon| {
            let (mut outer, mut holes) = polygon.clone().into_inner();
            outer.0.reverse();
            holes.iter_mut().for_each(|hole| hole.0.reverse());
            Polygon::new(outer, holes)
        });
        let again = Area::from(&MultiPolygon(turned.collect()));
        assert_eq!(again.content(), area.content());
        assert!(Area::from(&MultiPolygon::<f64>(Vec::new())).is_empty());
    }
}
