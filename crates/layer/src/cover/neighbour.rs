//! What a neighbouring layer has near one small area after another.
//!
//! ```text
//!    ╭╮  ╭╮  ╭╮  ╭╮  ╭╮      an island of skin looks at the rings near to it,
//!    ╰╯ ┌──────┐ ╰╯  ╰╯      and of a long ring at the runs of points that
//!   ╭───┼──────┼─────────╮   come near: what lies beyond one side of its box
//!   ╰───┼──────┼─────────╯   is left out, run by run
//!       └──────┘
//! ```
//!
//! In: a layer's solid. Out: the part of it in and around an area, as much as
//! tells what of the area it covers.
//! To look at all of its points for each of the areas would be quadratic,
//! whether they are in many rings or in one.

use isoslice_base::units::Mm;
use isoslice_planar::clip::{crop, difference};
use isoslice_planar::{Area, BoxTree, Rect, Ring};

/// A neighbouring layer's solid, its rings sorted by place.
#[derive(Debug)]
pub struct Neighbour<'a> {
    area: &'a Area,
    boxes: BoxTree,
    /// The runs of each ring.
    runs: Vec<Runs>,
}

/// Boxes around runs of a ring's edges, then around pairs of those, and so on
/// up to one.
#[derive(Debug)]
struct Runs {
    levels: Vec<Vec<Rect>>,
}

/// Number of edges in a run. With so many, boxes take little memory beside the
/// points.
const RUN: usize = 16;

/// Width of the border around an area that is looked at, mm.
const MARGIN: Mm = 1.0;

impl<'a> Neighbour<'a> {
    /// Sorts a layer's rings.
    pub fn new(area: &'a Area) -> Neighbour<'a> {
        let runs: Vec<Runs> = area.rings.iter().map(Runs::new).collect();
        let boxes = runs
            .iter()
            .enumerate()
            .filter_map(|(i, runs)| Some((i, runs.all()?)));
        Neighbour {
            area,
            boxes: BoxTree::new(boxes),
            runs,
        }
    }

    /// The part of the layer in and around an area: as much as tells what of the
    /// area the layer covers.
    pub fn near(&self, area: &Area) -> Area {
        if area.is_empty() {
            return Area::EMPTY;
        }
        self.within(area.bounds().grown(MARGIN))
    }

    /// What the layer has in a box.
    pub fn within(&self, bounds: Rect) -> Area {
        let mut numbers: Vec<usize> = self.boxes.meeting(bounds).collect();
        numbers.sort_unstable();
        let rings = numbers.into_iter().map(|i| {
            let mut kept = Ring::new();
            self.runs[i].near(&self.area.rings[i], bounds, &mut kept);
            kept
        });
        let rings: Vec<Ring> = rings.collect();
        crop(&rings, bounds)
    }

    /// What the layer leaves open of an area.
    pub fn open(&self, area: &Area) -> Area {
        difference(area, &self.near(area))
    }
}

impl Runs {
    fn new(ring: &Ring) -> Runs {
        let lowest: Vec<Rect> = (0..ring.len())
            .step_by(RUN)
            .map(|from| {
                let last = (from + RUN).min(ring.len());
                let end = ring[last % ring.len()];
                Rect::around(&ring[from..last]).with(end)
            })
            .collect();
        let mut levels = vec![lowest];
        while let Some(top) = levels.last().filter(|l| l.len() > 1) {
            let pairs = top.chunks(2);
            let pairs = pairs.map(|p| p.iter().fold(p[0], |r, b| r.union(*b)));
            let pairs: Vec<Rect> = pairs.collect();
            levels.push(pairs);
        }
        Runs { levels }
    }

    /// The box around the ring.
    fn all(&self) -> Option<Rect> {
        self.levels.last()?.first().copied()
    }

    /// Adds the ring's points to `kept`, but only the first point of each run
    /// away from `bounds`. Such a run lies beyond one side of the box, and so
    /// does the straight way to the next run.
    fn near(&self, ring: &Ring, bounds: Rect, kept: &mut Ring) {
        let mut pending = vec![(self.levels.len() - 1, 0)];
        while let Some((level, k)) = pending.pop() {
            let Some(own) = self.levels[level].get(k) else {
                continue;
            };
            let from = (k * RUN) << level;
            if !own.meets(bounds) {
                kept.extend(ring.get(from));
            } else if level == 0 {
                let to = (from + RUN).min(ring.len());
                kept.extend_from_slice(&ring[from..to]);
            } else {
                pending.push((level - 1, 2 * k + 1));
                pending.push((level - 1, 2 * k));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use isoslice_planar::clip::intersection;
    use isoslice_planar::rect;
    use std::f64::consts::TAU;

    /// A ring of so many points that winds in and out.
    fn flower(middle: DVec2, radius: f64, points: u32) -> Ring {
        (0..points)
            .map(|i| {
                let turn = TAU * f64::from(i) / f64::from(points);
                let far = radius * (1.0 + 0.3 * (12.0 * turn).sin());
                middle + DVec2::from_angle(turn) * far
            })
            .collect()
    }

    #[test]
    fn what_is_near_tells_what_is_covered() {
        let mut hole = flower(DVec2::ZERO, 8.0, 777);
        hole.reverse();
        let layer = Area::from_iter([
            flower(DVec2::ZERO, 20.0, 5000),
            hole,
            flower(DVec2::new(40.0, 3.0), 3.0, 30),
            flower(DVec2::new(60.0, 3.0), 3.0, 3),
        ]);
        let neighbour = Neighbour::new(&layer);
        let mut partly = 0;
        for i in 0..400 {
            let at = DVec2::new(f64::from(i % 20), f64::from(i / 20));
            let at = at * DVec2::new(4.9, 2.9) - DVec2::new(26.0, 28.0);
            let area = rect(at.x, at.y, at.x + 2.0, at.y + 1.5);
            let wanted = intersection(&area, &layer).content();
            let near = neighbour.near(&area);
            let found = intersection(&area, &near).content();
            assert!((found - wanted).abs() < 1e-6, "{at}: {found} {wanted}");
            let open = neighbour.open(&area).content();
            assert!((open + wanted - 3.0).abs() < 1e-6, "{at}: {open}");
            partly += u32::from(wanted > 0.1 && wanted < 2.9);
        }
        assert!(partly > 40, "{partly}");
        assert!(neighbour.near(&Area::EMPTY).is_empty());
        assert!(neighbour.near(&rect(90.0, 0.0, 91.0, 1.0)).is_empty());
        assert_eq!(Neighbour::new(&Area::EMPTY).near(&layer), Area::EMPTY);
    }

    #[test]
    fn of_a_long_ring_few_points_are_looked_at() {
        // A comb of a thousand teeth, and areas in some of them.
        let mut ring = vec![DVec2::new(4000.0, -2.0), DVec2::new(4000.0, 0.0)];
        for i in (0..1000).rev() {
            let x = 4.0 * f64::from(i);
            let tooth = [(x + 3.0, 0.0), (x + 3.0, 9.0), (x, 9.0), (x, 0.0)];
            ring.extend(tooth.map(|(x, y)| DVec2::new(x, y)));
        }
        ring.push(DVec2::new(0.0, -2.0));
        let layer = Area::from(ring);
        let runs = Runs::new(&layer.rings[0]);
        let neighbour = Neighbour::new(&layer);
        for i in [0, 1, 500, 777, 999] {
            let x = 4.0 * f64::from(i);
            let area = rect(x + 0.5, 3.0, x + 3.5, 6.0);
            let mut kept = Ring::new();
            runs.near(&layer.rings[0], area.bounds(), &mut kept);
            assert!(kept.len() < 100, "{}", kept.len());
            let open = neighbour.open(&area).content();
            assert!((open - 1.5).abs() < 1e-6, "{i}: {open}");
        }
    }
}
