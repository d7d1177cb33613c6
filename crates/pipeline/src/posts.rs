//! The walls of posts of support, and of its other islands.
//!
//! A lattice has thousands of posts, which are discs of a few sizes. The wall
//! of a size is laid once, around the origin, and moved to each of them. The
//! walls of another island are laid by themselves: columns have the same
//! islands in many layers, and a wall that is hard to lay makes those of other
//! islands no harder.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_held::support::Disc;
use isoslice_layer::resolution::Resolution;
use isoslice_layer::walls;
use isoslice_layer::walls::{WallPlan, support_walls};
use isoslice_planar::bead::Bead;
use isoslice_planar::{Area, Rect, Ring, signed_area};
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, PoisonError};

/// So many sizes are kept. Tall posts have another size in each layer.
const SIZES: usize = 256;
/// So many islands that are no posts are kept. They take some kilobytes each.
const ISLANDS: usize = 1024;

/// The walls around an area of support, and what they leave for lines.
#[derive(Clone, Debug, Default)]
pub(super) struct Walled {
    pub beads: Vec<Bead>,
    pub fill: Area,
}

impl Walled {
    /// Lays the walls around an area in a layer of some height.
    fn new(
        area: &Area,
        height: Mm,
        plan: &WallPlan,
        resolution: Resolution,
    ) -> Walled {
        let mut walls = support_walls(area, height, plan);
        walls::thin(&mut walls, resolution);
        Walled {
            beads: walls::beads(&walls, height),
            fill: walls.fill,
        }
    }

    /// Adds the walls of another area, moved by some way.
    fn add(&mut self, other: &Walled, by: DVec2) {
        self.beads.extend(other.beads.iter().map(|bead| {
            let mut bead = bead.clone();
            bead.stroke.points.iter_mut().for_each(|p| *p += by);
            bead
        }));
        let moved = other.fill.rings.iter();
        let moved = moved.map(|ring| ring.iter().map(|p| *p + by).collect());
        self.fill.rings.extend(moved);
    }
}

/// A size of post, and the bits of the layer's height.
type Size = (Disc, u64);

/// The corners of an island's rings, and the layer's height, bit by bit.
type Shape = (Vec<Vec<[u64; 2]>>, u64);

/// The walls of the sizes and of the islands that have been met.
#[derive(Debug)]
pub(super) struct Posts {
    plan: WallPlan,
    resolution: Resolution,
    sizes: Mutex<HashMap<Size, Arc<Walled>>>,
    islands: Mutex<HashMap<Shape, Arc<Walled>>>,
}

impl Posts {
    pub(super) fn new(plan: WallPlan, resolution: Resolution) -> Posts {
        Posts {
            plan,
            resolution,
            sizes: Mutex::default(),
            islands: Mutex::default(),
        }
    }

    /// Lays the walls around an area of support in a layer of some height.
    pub(super) fn walled(&self, area: &Area, height: Mm) -> Walled {
        let new = |area: &Area| {
            Walled::new(area, height, &self.plan, self.resolution)
        };
        let (discs, rest) = discs(area);
        let mut all = Walled::default();
        for island in rest.islands() {
            let ring = |ring: &Ring| {
                let points = ring.iter();
                points.map(|p| p.to_array().map(f64::to_bits)).collect()
            };
            let shape = island.rings.iter().map(ring).collect();
            let key = (shape, height.to_bits());
            let walls = kept(&self.islands, key, ISLANDS, || new(&island));
            all.add(&walls, DVec2::ZERO);
        }
        for (disc, middle) in discs {
            let lay = || new(&Area::from(disc.ring()));
            let size = (disc, height.to_bits());
            let walls = kept(&self.sizes, size, SIZES, lay);
            all.add(&walls, middle);
        }
        all
    }
}

/// What is kept for a key, or else what `lay` gives, which is kept then. No more
/// than `most` are kept.
fn kept<K: Eq + Hash>(
    all: &Mutex<HashMap<K, Arc<Walled>>>,
    key: K,
    most: usize,
    lay: impl FnOnce() -> Walled,
) -> Arc<Walled> {
    let all = || all.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(walls) = all().get(&key) {
        return walls.clone();
    }
    let walls = Arc::new(lay());
    let mut all = all();
    // What is forgotten is laid again, and comes out the same.
    if all.len() >= most {
        all.clear();
    }
    all.insert(key, walls.clone());
    walls
}

/// The islands of an area that are discs without holes, with their middles, and
/// the rest of the area.
fn discs(area: &Area) -> (Vec<(Disc, DVec2)>, Area) {
    let holes: Vec<Rect> = area
        .rings
        .iter()
        .filter(|ring| signed_area(ring) < 0.0)
        .map(Rect::around)
        .collect();
    let (mut discs, mut rest) = (Vec::new(), Vec::new());
    for ring in &area.rings {
        let alone = || !holes.iter().any(|h| h.meets(Rect::around(ring)));
        match Disc::of(ring) {
            Some(disc) if signed_area(ring) > 0.0 && alone() => {
                discs.push(disc);
            }
            _ => rest.push(ring.clone()),
        }
    }
    (discs, Area { rings: rest })
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::rect;
    use isoslice_planar::shapes::{circle, moved};
    use isoslice_settings::testing::settings;

    fn posts() -> Posts {
        let settings = settings(&[]);
        Posts::new(WallPlan::of(&settings), Resolution::of(&settings))
    }

    #[test]
    fn posts_have_the_walls_that_they_would_have_by_themselves() {
        let ring = |x: f64, y: f64| moved(circle(0.495, 12), x, y);
        let posts = posts();
        for at in [DVec2::new(3.0, 4.0), DVec2::new(-71.3, 0.123)] {
            let area = Area::from(ring(at.x, at.y));
            let found = posts.walled(&area, 0.2);
            let alone = Walled::new(&area, 0.2, &posts.plan, posts.resolution);
            assert_eq!(found.beads.len(), alone.beads.len());
            for (a, b) in found.beads.iter().zip(&alone.beads) {
                assert_eq!(
                    (a.stroke.closed, a.role),
                    (b.stroke.closed, b.role)
                );
                // They may begin elsewhere.
                let near = |p: &DVec2| {
                    b.stroke.points.iter().any(|q| p.distance(*q) < 2e-4)
                };
                assert_eq!(a.stroke.points.len(), b.stroke.points.len());
                assert!(a.stroke.points.iter().all(near), "{a:?} {b:?}");
            }
        }
        assert_eq!(posts.sizes.lock().unwrap().len(), 1);
    }

    #[test]
    fn islands_of_one_shape_and_place_are_laid_once() {
        let posts = posts();
        let of = |x: f64| rect(x, 0.0, x + 3.0, 2.0);
        let both: Area = [of(0.0), of(9.0)].into_iter().collect();
        let count = || posts.islands.lock().unwrap().len();
        let first = posts.walled(&both, 0.2);
        assert_eq!(count(), 2);
        let second = posts.walled(&of(9.0), 0.2);
        assert_eq!((count(), second.beads.len()), (2, 2));
        let points = |beads: &[Bead]| -> Vec<Vec<DVec2>> {
            beads
                .iter()
                .map(|bead| bead.stroke.points.clone())
                .collect()
        };
        assert_eq!(points(&first.beads[2..]), points(&second.beads));
        assert_eq!(first.fill.rings[1], second.fill.rings[0]);
        // Another layer height, and another place.
        posts.walled(&of(9.0), 0.3);
        posts.walled(&of(9.5), 0.2);
        assert_eq!(count(), 4);
    }

    #[test]
    fn a_disc_with_a_hole_is_no_post() {
        let mut hole = circle(0.2, 8);
        hole.reverse();
        let outer = circle(2.0, 16);
        let pierced = Area::from_iter([outer.clone(), hole]);
        assert!(discs(&pierced).0.is_empty());
        let (found, rest) = discs(&Area::from(outer));
        assert_eq!((found.len(), rest.rings.len()), (1, 0));
    }
}
