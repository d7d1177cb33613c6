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

/// Loops around everything that is printed: they show that the nozzle primes
/// and the bed is level, and keep draughts off.
pub struct Skirt {
    /// The outermost first.
    loops: Vec<Ring>,
    width: Mm,
}

impl Skirt {
    /// The skirt of a print whose layers beside it have these outlines:
    /// `skirt.distance` away from the hull of them all, and of the brim. It is
    /// the same in all of these layers, lest it hang in the air.
    pub fn new<'a>(
        outlines: impl IntoIterator<Item = &'a Area>,
        settings: &Settings,
    ) -> Self {
        let points: MultiPoint<f64> = outlines
            .into_iter()
            .flat_map(|outline| outline.rings.iter().flatten())
            .map(|p| Point::new(p.x, p.y))
            .collect();
        let hull: Vec<DVec2> = points
            .convex_hull()
            .exterior()
            .coords()
            .skip(1)
            .map(|&Coord { x, y }| DVec2::new(x, y))
            .collect();
        let width = settings.outer_wall_width;
        let mut loops = Vec::new();
        if hull.len() >= 3 {
            let hull = Area { rings: vec![hull] };
            let brim = match settings.brim.place {
                BrimPlace::Outer | BrimPlace::Both => {
                    let height = settings.first_layer_height;
                    let depths = brim_depths(height, settings);
                    depths.last().map_or(0.0, |d| d + 0.5 * width)
                }
                _ => 0.0,
            };
            let step = spacing(width, width, settings.layer_height);
            let nearest = brim + settings.skirt.distance + 0.5 * width;
            for i in (0..settings.skirt.loops).rev() {
                let away = nearest + step * f64::from(i);
                loops.extend(offset(&hull, away, TOLERANCE).rings);
            }
        }
        Skirt { loops, width }
    }

    /// Its beads in a layer of this height.
    pub fn beads(&self, height: Mm) -> Vec<Bead> {
        let rings = self.loops.iter().cloned();
        rings
            .map(|points| around(Role::Skirt, points, self.width, height))
            .collect()
    }
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
        let lengths = |outlines: &[Area], settings: &Settings| {
            let skirt = Skirt::new(outlines, settings);
            let beads = skirt.beads(0.2);
            beads.iter().map(Bead::length).collect::<Vec<f64>>()
        };
        let alone = lengths(std::slice::from_ref(&outline), &settings);
        assert_eq!(alone.len(), 2);
        let exact = 40.0 + std::f64::consts::TAU * 6.225;
        assert!((alone[1] - exact).abs() < 0.1, "{alone:?}");
        assert!(lengths(&[Area::EMPTY], &settings).is_empty());
        // Round the brim.
        settings.brim.place = BrimPlace::Outer;
        let outside = lengths(std::slice::from_ref(&outline), &settings);
        let more = outside[1] - alone[1];
        let brim = 0.1 + 0.45 + 11.0 * spacing(0.45, 0.45, 0.2);
        let exact = std::f64::consts::TAU * brim;
        assert!((more - exact).abs() < 0.02, "{more} {exact}");
        settings.brim.place = BrimPlace::None;
        // Round all layers beside it.
        let wide = rect(-5.0, 2.0, 20.0, 8.0);
        let both = lengths(&[outline, wide], &settings);
        // The hull has two slanting sides on the left and two on the right.
        let left = 2.0 * 5f64.hypot(2.0);
        let right = 2.0 * 10f64.hypot(2.0);
        let exact = 32.0 + left + right + std::f64::consts::TAU * 6.225;
        assert!((both[1] - exact).abs() < 0.1, "{both:?} {exact}");
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
