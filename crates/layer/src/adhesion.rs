//! What helps the first layer: the skirt and the brim.
//!
//! ```text
//!   skirt      brim          part
//!   ┃ ┃        ┃┃┃┃ ┊←gap→┊█████████
//!     ┊←─ distance ─→┊
//! ```

mod ears;
mod plan;

pub use plan::{AdhesionPlan, BedPlan, BrimPlan, SkirtPlan};

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::{Bead, Role, Stroke};
use isoslice_planar::nest::Nest;
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Ring, hull, signed_area};
use isoslice_settings::BrimPlace;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Tolerance of the loops, mm.
const TOLERANCE: Mm = 0.01;

/// Loops around everything that is printed. They show that the nozzle primes
/// and that the bed is level. As a draft shield they keep draughts off.
pub struct Skirt {
    /// The loops, the outermost first.
    loops: Vec<Ring>,
    plan: SkirtPlan,
}

impl Skirt {
    /// The skirt of a print whose layers beside it have these outlines. It keeps
    /// its distance from the hull of all the outlines and of the brim. All of
    /// these layers have one skirt, so that it does not hang in the air.
    pub fn new<'a>(
        outlines: impl IntoIterator<Item = &'a Area>,
        plan: SkirtPlan,
    ) -> Self {
        let rings = outlines.into_iter().flat_map(|outline| &outline.rings);
        let hull = hull(rings.flatten().copied());
        let mut loops = Vec::new();
        if hull.len() >= 3 {
            let hull = Area::from(hull);
            let nearest = plan.brim + plan.distance + 0.5 * plan.width;
            for i in (0..plan.loops).rev() {
                let away = nearest + plan.step * f64::from(i);
                loops.extend(offset(&hull, away, TOLERANCE).rings);
            }
        }
        Skirt { loops, plan }
    }

    /// The skirt's beads in a layer of this number and height.
    pub fn beads(&self, number: usize, height: Mm) -> Vec<Bead> {
        let rings = self.loops.iter().filter(|_| number < self.plan.layers);
        rings
            .cloned()
            .map(|points| around(Role::Skirt, points, self.plan.width, height))
            .collect()
    }
}

/// A layer's loops: the skirt's and, in the first layer, the brim's. `skirt` is
/// given if the skirt has more layers than the first.
pub fn loops(
    number: usize,
    outline: &Area,
    height: Mm,
    skirt: Option<&Skirt>,
    plan: &AdhesionPlan,
) -> Vec<Bead> {
    let mut beads = match skirt {
        Some(skirt) => skirt.beads(number, height),
        None if number >= plan.skirt.layers => Vec::new(),
        None => Skirt::new([outline], plan.skirt).beads(number, height),
    };
    if number == 0 {
        beads.extend(brim(outline, height, &plan.brim));
    }
    beads
}

/// A warning if ears are asked for, but a first layer's loops have no ears.
pub fn without_ears(loops: &[Bead], plan: &BrimPlan) -> Option<String> {
    let ears = plan.place == BrimPlace::Ears;
    let any = loops.iter().any(|bead| bead.role == Role::Brim);
    (ears && !any).then(|| {
        format!(
            "there are no brim ears: no corner of the first layer is sharper \
             than brim.ear_angle = {}°; raise that, or set brim.place to \
             \"outer\"",
            plan.ear_angle
        )
    })
}

/// Leaves out loops that would leave the bed, and tells what to do about it.
/// `offset` leads from the loops' coordinates to the bed's.
pub fn keep_on_bed(
    loops: &mut Vec<Bead>,
    offset: DVec2,
    BedPlan { bed, shield }: BedPlan,
) -> Vec<String> {
    let leaves = |b: &mut Bead| {
        let half = DVec2::splat(0.5 * b.stroke.width);
        !b.stroke.points.iter().all(|&p| {
            let p = p + offset;
            bed.contains(p - half) && bed.contains(p + half)
        })
    };
    let left_out: Vec<Bead> = loops.extract_if(.., leaves).collect();
    let told = [
        (
            Role::Skirt,
            if shield {
                "the draft shield does not fit on the bed and is left out; \
                 lower skirt.distance or set draft_shield = off"
            } else {
                "the skirt does not fit on the bed and is left out; lower \
                 skirt.distance or set skirt.loops = 0"
            },
        ),
        (
            Role::Brim,
            "the brim does not fit on the bed: loops that would leave it are \
             left out; lower brim.width",
        ),
    ];
    told.into_iter()
        .filter(|(role, _)| left_out.iter().any(|b| b.role == *role))
        .map(|(_, text)| text.to_owned())
        .collect()
}

/// Loops beside the part that hold it down. They lie `brim.gap` away from its
/// outline and then side by side over `brim.width`: outside the part, in its
/// holes, or both. The outermost come first, so that the print goes on at the
/// part. In the holes each loop is followed by the nearest one.
pub fn brim(outline: &Area, height: Mm, plan: &BrimPlan) -> Vec<Bead> {
    let BrimPlan { place, width, .. } = *plan;
    if place == BrimPlace::None || outline.is_empty() {
        return Vec::new();
    }
    if place == BrimPlace::Ears {
        let loops = ears::ears(outline, height, plan).into_iter();
        return loops
            .map(|points| around(Role::Brim, points, width, height))
            .collect();
    }
    let (outer, holes): (Vec<&Ring>, Vec<&Ring>) =
        outline.rings.iter().partition(|r| signed_area(r) > 0.0);
    let holes = Nest::new(holes.into_iter());
    let in_a_hole =
        |ring: &Ring| ring.first().is_some_and(|&p| holes.around(p).is_some());
    let grown = match place {
        // A part without its holes grows faster.
        BrimPlace::Outer => outer
            .into_iter()
            .filter(|r| !in_a_hole(r))
            .cloned()
            .collect(),
        _ => outline.clone(),
    };
    let mut inside = Vec::new();
    let mut levels: Vec<Vec<Ring>> = Vec::new();
    for depth in plan.depths(height).into_iter().rev() {
        let mut level = offset(&grown, depth, TOLERANCE).rings;
        inside.extend(level.extract_if(.., |ring| in_a_hole(ring)));
        levels.push(level);
    }
    let outside = match place {
        BrimPlace::Inner => Vec::new(),
        _ => inwards(levels),
    };
    let near = outside.last().and_then(|ring| ring.first()).copied();
    outside
        .into_iter()
        .chain(chained(inside, near))
        .map(|points| around(Role::Brim, points, width, height))
        .collect()
}

/// Loops in print order, from their distances to the part: the farthest first,
/// each followed by those within it. Where a loop goes round several islands,
/// the loops of each island come together.
fn inwards(levels: Vec<Vec<Ring>>) -> Vec<Ring> {
    // Rings are numbered level by level, each with the rings directly within
    // it.
    let count = levels.iter().map(Vec::len).sum();
    let mut within: Vec<Vec<usize>> = vec![Vec::new(); count];
    let mut roots: Vec<usize> = Vec::new();
    let mut first = 0;
    let mut around: Option<(Nest, Vec<usize>)> = None;
    for level in &levels {
        let (outer, voids): (Vec<usize>, Vec<usize>) =
            (0..level.len()).partition(|&i| signed_area(&level[i]) > 0.0);
        for &i in &outer {
            let parent = around.as_ref().and_then(|(nest, numbers)| {
                let at = level[i].first()?;
                nest.around(*at).map(|k| numbers[k])
            });
            match parent {
                Some(parent) => within[parent].push(first + i),
                None => roots.push(first + i),
            }
        }
        let nest = Nest::new(outer.iter().map(|&i| &level[i]));
        for &i in &voids {
            let parent = level[i].first().and_then(|&p| nest.around(p));
            match parent {
                Some(k) => within[first + outer[k]].push(first + i),
                None => roots.push(first + i),
            }
        }
        around = Some((nest, outer.iter().map(|i| first + i).collect()));
        first += level.len();
    }
    let mut rings: Vec<Ring> = levels.into_iter().flatten().collect();
    let mut out = Vec::with_capacity(rings.len());
    let mut at = None;
    let mut left: Vec<usize> = in_chain(roots, &rings, at);
    left.reverse();
    while let Some(next) = left.pop() {
        at = rings[next].first().copied();
        let inner = in_chain(std::mem::take(&mut within[next]), &rings, at);
        left.extend(inner.into_iter().rev());
        out.push(std::mem::take(&mut rings[next]));
    }
    out
}

/// Rings in an order in which each is followed by the ring with the nearest
/// first point.
fn chained(mut rings: Vec<Ring>, from: Option<DVec2>) -> Vec<Ring> {
    let order = in_chain((0..rings.len()).collect(), &rings, from);
    let next = |i: usize| std::mem::take(&mut rings[i]);
    order.into_iter().map(next).collect()
}

/// Numbers of rings in the order of [`chained`].
fn in_chain(
    numbers: Vec<usize>,
    rings: &[Ring],
    from: Option<DVec2>,
) -> Vec<usize> {
    let start = |i: usize| rings[i].first().copied();
    let Some(mut at) = from.or_else(|| start(*numbers.first()?)) else {
        return numbers;
    };
    if numbers.len() < 2 {
        return numbers;
    }
    let places = numbers
        .iter()
        .filter_map(|&i| Some(GeomWithData::new(start(i)?.to_array(), i)));
    let mut left = RTree::bulk_load(places.collect());
    let mut chain = Vec::with_capacity(numbers.len());
    while let Some(next) = left.pop_nearest_neighbor(&at.to_array()) {
        at = DVec2::from(*next.geom());
        chain.push(next.data);
    }
    chain
}

fn around(role: Role, points: Ring, width: Mm, height: Mm) -> Bead {
    Bead::new(role, Stroke::new(points, true, width), height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::bead::spacing;
    use isoslice_planar::grid::EdgeGrid;
    use isoslice_planar::shapes::rect;
    use isoslice_settings::testing::{plan_with, usual_plan};

    #[test]
    fn the_skirt_keeps_its_distance() {
        let ring = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
            .map(DVec2::from)
            .to_vec();
        let outline = Area::from(ring);
        let plan = |place: BrimPlace| {
            plan_with(SkirtPlan::of, |s| {
                s.skirt.loops = 2;
                s.brim.place = place;
            })
        };
        let without = plan(BrimPlace::None);
        let lengths = |outlines: &[Area], plan: SkirtPlan| {
            let beads = Skirt::new(outlines, plan).beads(0, 0.2);
            beads
                .iter()
                .map(|b| b.stroke.length())
                .collect::<Vec<f64>>()
        };
        let alone = lengths(std::slice::from_ref(&outline), without);
        assert_eq!(alone.len(), 2);
        let exact = 40.0 + std::f64::consts::TAU * 6.225;
        assert!((alone[1] - exact).abs() < 0.1, "{alone:?}");
        assert!(lengths(&[Area::EMPTY], without).is_empty());
        // The skirt goes round the brim.
        let around = plan(BrimPlace::Outer);
        let outside = lengths(std::slice::from_ref(&outline), around);
        let more = outside[1] - alone[1];
        let brim = 0.1 + 0.45 + 11.0 * spacing(0.45, 0.45, 0.2);
        let exact = std::f64::consts::TAU * brim;
        assert!((more - exact).abs() < 0.02, "{more} {exact}");
        // The skirt goes round all layers beside it.
        let wide = rect(-5.0, 2.0, 20.0, 8.0);
        let both = lengths(&[outline, wide], without);
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
        // There is a pin in the hole.
        frame.rings.extend(rect(13.0, 13.0, 17.0, 17.0).rings);
        frame
    }

    #[test]
    fn the_brim_is_where_it_should_be() {
        let frame = frame();
        assert!(brim(&frame, 0.2, &usual_plan(BrimPlan::of)).is_empty());
        let step = spacing(0.45, 0.45, 0.2);
        let grid = EdgeGrid::new(&frame, 1.0);
        let count = |place: BrimPlace, width: Mm| {
            let plan = plan_with(BrimPlan::of, |s| {
                s.brim.place = place;
                s.brim.width = width;
                s.brim.gap = 0.2;
            });
            let loops = brim(&frame, 0.2, &plan);
            for bead in &loops {
                assert_eq!(bead.role, Role::Brim);
                let away = grid.nearest(bead.stroke.points[0]).unwrap().1;
                let k = (away.distance(bead.stroke.points[0]) - 0.425) / step;
                assert!((k - k.round()).abs() < 0.02, "{k}");
            }
            let inside = |b: &&Bead| {
                rect(0.0, 0.0, 30.0, 30.0).contains(b.stroke.points[0])
            };
            let within = loops.iter().filter(inside).count();
            (loops.len() - within, within)
        };
        // Five loops of 0.407 mm are 2 mm. In the hole there are as many at the
        // frame as at the pin.
        assert_eq!(count(BrimPlace::Outer, 2.0), (5, 0));
        assert_eq!(count(BrimPlace::Inner, 2.0), (0, 10));
        assert_eq!(count(BrimPlace::Both, 2.0), (5, 10));
        // The brim ends where there is no more room.
        let loops = count(BrimPlace::Inner, 20.0).1;
        assert!((18..=30).contains(&loops), "{loops}");
    }

    #[test]
    fn the_brim_is_finished_round_one_island_before_the_next() {
        let plan = plan_with(BrimPlan::of, |s| s.brim.place = BrimPlace::Outer);
        // Four pins stand so far apart that their brims do not meet, then so
        // near that the outer loops go round two of them.
        for (apart, pairs) in [(30.0, false), (12.0, true)] {
            let mut pins = rect(0.0, 0.0, 5.0, 5.0);
            for (x, y) in [(apart, 0.0), (0.0, 90.0), (apart, 90.0)] {
                pins.rings.extend(rect(x, y, x + 5.0, y + 5.0).rings);
            }
            let loops = brim(&pins, 0.2, &plan);
            let pin = |bead: &Bead| {
                let inside = |ring: &Ring| {
                    let area = Area::from(bead.stroke.points.clone());
                    area.contains(ring[0])
                };
                pins.rings.iter().map(inside).collect::<Vec<bool>>()
            };
            let mut around: Vec<Vec<bool>> = loops.iter().map(pin).collect();
            around.dedup();
            // Each pin's loops follow those that go round two pins at once.
            assert_eq!(around.len(), if pairs { 6 } else { 4 }, "{around:?}");
            assert!(loops.len() > 30);
        }
    }

    #[test]
    fn the_brim_comes_from_outside_to_the_part() {
        let plan = plan_with(BrimPlan::of, |s| s.brim.place = BrimPlace::Outer);
        let loops = brim(&rect(0.0, 0.0, 9.0, 9.0), 0.2, &plan);
        let lengths: Vec<f64> =
            loops.iter().map(|b| b.stroke.length()).collect();
        assert!(lengths.is_sorted_by(|a, b| a > b), "{lengths:?}");
    }
}
