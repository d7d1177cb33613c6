//! What helps the first layer: the skirt and the brim.
//!
//! ```text
//!   skirt      brim          part
//!   ┃ ┃        ┃┃┃┃ ┊←gap→┊█████████
//!     ┊←─ distance ─→┊
//! ```

use crate::bead::{Bead, Role, spacing};
use crate::plane::nest::Nest;
use crate::plane::offset::offset;
use crate::plane::{Area, Ring, signed_area};
use crate::settings::{BrimPlace, Settings};
use crate::units::Mm;
use geo::{ConvexHull, Coord, MultiPoint, Point};
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// How far loops may be off, mm.
const TOLERANCE: Mm = 0.01;

/// Loops around everything that is printed, `skirt.distance` away from the
/// hull of the outline (and of the brim, on the first layer), the outermost
/// first: they show that the nozzle primes and the bed is level, and keep
/// draughts off.
pub fn skirt(
    outline: &Area,
    first_layer: bool,
    height: Mm,
    settings: &Settings,
) -> Vec<Bead> {
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
    let brim = match settings.brim.place {
        BrimPlace::Outer | BrimPlace::Both if first_layer => {
            let loops = brim_depths(height, settings);
            loops.last().map_or(0.0, |d| d + 0.5 * width)
        }
        _ => 0.0,
    };
    (0..settings.skirt.loops)
        .rev()
        .flat_map(|i| {
            let away = brim + settings.skirt.distance + 0.5 * width;
            offset(&hull, away + step * f64::from(i), TOLERANCE).rings
        })
        .map(|points| around(Role::Skirt, points, width, height))
        .collect()
}

/// Loops beside the part that hold it down, `brim.gap` away from its outline
/// and then side by side over `brim.width`: outside the part, in its holes, or
/// both. The outermost come first, so that the print goes on at the part; in
/// the holes each loop is followed by the nearest.
pub fn brim(outline: &Area, height: Mm, settings: &Settings) -> Vec<Bead> {
    let place = settings.brim.place;
    if place == BrimPlace::None || outline.is_empty() {
        return Vec::new();
    }
    let (outer, holes): (Vec<&Ring>, Vec<&Ring>) =
        outline.rings.iter().partition(|r| signed_area(r) > 0.0);
    let holes = Nest::new(holes.into_iter());
    let in_a_hole =
        |ring: &Ring| ring.first().is_some_and(|&p| holes.around(p).is_some());
    let grown = match place {
        // Without its holes the part grows faster.
        BrimPlace::Outer => Area {
            rings: outer
                .into_iter()
                .filter(|r| !in_a_hole(r))
                .cloned()
                .collect(),
        },
        _ => outline.clone(),
    };
    let (mut outside, mut inside) = (Vec::new(), Vec::new());
    for depth in brim_depths(height, settings).into_iter().rev() {
        for ring in offset(&grown, depth, TOLERANCE).rings {
            match in_a_hole(&ring) {
                true => inside.push(ring),
                false => outside.push(ring),
            }
        }
    }
    if place == BrimPlace::Inner {
        outside.clear();
    }
    let width = settings.outer_wall_width;
    let near = outside.last().and_then(|ring| ring.first()).copied();
    outside
        .into_iter()
        .chain(chained(inside, near))
        .map(|points| around(Role::Brim, points, width, height))
        .collect()
}

/// Distances of the brim's loops from the outline, the nearest first.
fn brim_depths(height: Mm, settings: &Settings) -> Vec<Mm> {
    let width = settings.outer_wall_width;
    let step = spacing(width, width, height);
    let loops = (settings.brim.width / step).round().max(1.0) as u32;
    (0..loops)
        .map(|i| settings.brim.gap + 0.5 * width + step * f64::from(i))
        .collect()
}

/// Rings so that each is followed by the one with the nearest first point.
fn chained(rings: Vec<Ring>, from: Option<DVec2>) -> Vec<Ring> {
    let Some(mut at) = from.or_else(|| rings.first().map(|r| r[0])) else {
        return rings;
    };
    let places = rings.iter().enumerate();
    let mut left = RTree::bulk_load(
        places
            .map(|(i, r)| GeomWithData::new([r[0].x, r[0].y], i))
            .collect(),
    );
    let mut rings: Vec<Option<Ring>> = rings.into_iter().map(Some).collect();
    let mut chain = Vec::with_capacity(rings.len());
    while let Some(next) = left.pop_nearest_neighbor(&[at.x, at.y]) {
        at = DVec2::from(*next.geom());
        chain.extend(rings[next.data].take());
    }
    chain
}

fn around(role: Role, points: Ring, width: Mm, height: Mm) -> Bead {
    Bead {
        role,
        points,
        closed: true,
        width,
        widths: Vec::new(),
        height,
        small: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::grid::EdgeGrid;
    use crate::plane::rect;

    #[test]
    fn the_skirt_keeps_its_distance() {
        let ring = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        let outline = Area { rings: vec![ring] };
        let mut settings = Settings::default();
        settings.skirt.loops = 2;
        let loops = skirt(&outline, true, 0.2, &settings);
        assert_eq!(loops.len(), 2);
        let inner = &loops[1];
        let exact = 40.0 + std::f64::consts::TAU * 6.225;
        assert!((inner.length() - exact).abs() < 0.1, "{}", inner.length());
        assert!(skirt(&Area::EMPTY, true, 0.2, &settings).is_empty());
        // Round the brim on the first layer only.
        settings.brim.place = BrimPlace::Outer;
        let outside = skirt(&outline, true, 0.2, &settings);
        let more = outside[1].length() - inner.length();
        let brim = 0.1 + 0.45 + 11.0 * spacing(0.45, 0.45, 0.2);
        let exact = std::f64::consts::TAU * brim;
        assert!((more - exact).abs() < 0.02, "{more} {exact}");
        let above = skirt(&outline, false, 0.2, &settings);
        assert!((above[1].length() - inner.length()).abs() < 1e-9);
    }

    fn frame() -> Area {
        let mut frame = rect(0.0, 0.0, 30.0, 30.0);
        let mut hole = rect(5.0, 5.0, 25.0, 25.0).rings.remove(0);
        hole.reverse();
        frame.rings.push(hole);
        // A pin in the hole.
        frame.rings.extend(rect(13.0, 13.0, 17.0, 17.0).rings);
        frame
    }

    #[test]
    fn the_brim_is_where_it_should_be() {
        let frame = frame();
        let mut settings = Settings::default();
        assert!(brim(&frame, 0.2, &settings).is_empty());
        settings.brim.width = 2.0;
        settings.brim.gap = 0.2;
        let step = spacing(0.45, 0.45, 0.2);
        let grid = EdgeGrid::new(&frame, 1.0);
        let count = |place: BrimPlace, settings: &mut Settings| {
            settings.brim.place = place;
            let loops = brim(&frame, 0.2, settings);
            for bead in &loops {
                assert_eq!(bead.role, Role::Brim);
                let away = grid.nearest(bead.points[0]).unwrap().1;
                let k = (away.distance(bead.points[0]) - 0.425) / step;
                assert!((k - k.round()).abs() < 0.02, "{k}");
            }
            let inside =
                |b: &&Bead| rect(0.0, 0.0, 30.0, 30.0).contains(b.points[0]);
            let within = loops.iter().filter(inside).count();
            (loops.len() - within, within)
        };
        // Five loops of 0.407 mm are 2 mm; in the hole at the frame and the
        // pin alike.
        assert_eq!(count(BrimPlace::Outer, &mut settings), (5, 0));
        assert_eq!(count(BrimPlace::Inner, &mut settings), (0, 10));
        assert_eq!(count(BrimPlace::Both, &mut settings), (5, 10));
        // It ends where there is no more room.
        settings.brim.width = 20.0;
        let loops = count(BrimPlace::Inner, &mut settings).1;
        assert!((18..=30).contains(&loops), "{loops}");
    }

    #[test]
    fn the_brim_comes_from_outside_to_the_part() {
        let mut settings = Settings::default();
        settings.brim.place = BrimPlace::Outer;
        let loops = brim(&rect(0.0, 0.0, 9.0, 9.0), 0.2, &settings);
        let lengths: Vec<f64> = loops.iter().map(Bead::length).collect();
        assert!(lengths.is_sorted_by(|a, b| a > b), "{lengths:?}");
    }
}
