//! Supports in the picture of a part: slabs, one upon the other.
//!
//! In: the areas of supports, layer by layer. Out: their faces, which are flat
//! polygons: the top or the bottom of a slab, and its sides.

use glam::{DVec2, DVec3};
use isoslice_base::units::Mm;
use isoslice_model::Bounds;
use isoslice_planar::{Area, Ring, edges};

/// The supports of the parts on a plate, as they stand on the bed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slabs(Vec<Slab>);

/// Supports between two heights.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slab {
    bottom: Mm,
    top: Mm,
    area: Area,
}

/// No supports.
pub(super) static NONE: Slabs = Slabs(Vec::new());

impl Slabs {
    /// Adds supports between two heights above the bed.
    pub fn add(&mut self, [bottom, top]: [Mm; 2], area: Area) {
        if !area.is_empty() {
            self.0.push(Slab { bottom, top, area });
        }
    }

    /// True if there are no supports.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The box around the supports.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        let of = |slab: &Slab| {
            let all = slab.area.bounds();
            Bounds {
                min: all.min.extend(slab.bottom),
                max: all.max.extend(slab.top),
            }
        };
        self.0.iter().map(of).reduce(Bounds::union)
    }

    /// The supports, some slabs at a time.
    pub(super) fn chunks(&self) -> std::slice::Chunks<'_, Slab> {
        /// Slabs whose faces are kept at a time, since they take memory.
        const AT_ONCE: usize = 64;
        self.0.chunks(AT_ONCE)
    }
}

/// A flat polygon of a slab's surface.
pub(super) struct Face {
    /// Rings of positions, mm. A place is inside if they wind round it an odd
    /// number of times.
    pub rings: Vec<Vec<DVec3>>,
    /// The normal, of length 1, away from the slab.
    pub normal: DVec3,
}

impl Slab {
    /// The faces, moved by `way`, that a viewer in the direction `towards` may
    /// see.
    pub(super) fn faces(&self, way: DVec3, towards: DVec3) -> Vec<Face> {
        let corner = |p: DVec2, z: Mm| p.extend(z) + way;
        let mut faces = Vec::new();
        if towards.z != 0.0 {
            let z = if towards.z > 0.0 {
                self.top
            } else {
                self.bottom
            };
            let at_height = |ring: &Ring| -> Vec<DVec3> {
                ring.iter().map(|p| corner(*p, z)).collect()
            };
            faces.push(Face {
                rings: self.area.rings.iter().map(at_height).collect(),
                normal: DVec3::Z * towards.z.signum(),
            });
        }
        for (a, b) in self.area.rings.iter().flat_map(|ring| edges(ring)) {
            // Outer rings are counter-clockwise, holes clockwise.
            let out = -(b - a).perp().normalize_or_zero();
            if out.dot(towards.truncate()) > 0.0 {
                let side = vec![
                    corner(a, self.bottom),
                    corner(b, self.bottom),
                    corner(b, self.top),
                    corner(a, self.top),
                ];
                faces.push(Face {
                    rings: vec![side],
                    normal: out.extend(0.0),
                });
            }
        }
        faces
    }
}

#[cfg(test)]
mod tests {
    use super::super::raster::{Seen, Subject, is_part};
    use super::super::view::View;
    use super::*;
    use isoslice_model::{Placement, placed};
    use isoslice_planar::rect;

    const PIXELS: usize = 240;

    /// A part on the bed, 20 mm long and wide, 10 mm high.
    const BLOCK: &str = "max(max(abs(x), abs(y)) - 10, abs(z) - 5)";

    fn seen(formula: &str, supports: &Slabs, view: View) -> Seen {
        let model = placed(formula, &Placement::default());
        let subject = Subject::new(&model, supports, view).unwrap();
        subject.fitted(PIXELS, PIXELS).unwrap()
    }

    /// The block as slabs, round the middle of the bed.
    fn slabs(count: usize) -> Slabs {
        let model = placed(BLOCK, &Placement::default());
        let middle = model.offset.truncate();
        let (low, high) = (middle - 10.0, middle + 10.0);
        let mut slabs = Slabs::default();
        for k in 0..count {
            let z = |k: usize| 10.0 * k as f64 / count as f64;
            let area = rect(low.x, low.y, high.x, high.y);
            slabs.add([z(k), z(k + 1)], area);
        }
        slabs
    }

    #[test]
    fn slabs_look_like_a_part_of_their_shape() {
        // A ball within the slabs, which hide it.
        let ball = "sqrt(x^2 + y^2 + z^2) - 5";
        for view in [View::ISO, View::THUMBNAIL, View::of(130.0, -25.0)] {
            let part = seen(BLOCK, &NONE, view);
            let drawn = seen(ball, &slabs(7), view);
            assert!((drawn.pixel / part.pixel - 1.0).abs() < 0.02);
            let shown = |seen: &Seen| {
                seen.depths.iter().filter(|d| is_part(d)).count() as f64
            };
            let share = shown(&drawn) / shown(&part);
            assert!((share - 1.0).abs() < 0.03, "{view:?}: {share}");
            assert!(
                (0..drawn.depths.len()).all(|k| {
                    drawn.is_support(k) == is_part(&drawn.depths[k])
                })
            );
            // Every pixel is on one of the faces of the block that are seen.
            let towards = drawn.axes.z_axis;
            for (k, depth) in drawn.depths.iter().enumerate() {
                if !is_part(depth) {
                    continue;
                }
                let (x, y) = (k % drawn.width, k / drawn.width);
                let at = DVec3::new(x as f64, y as f64, f64::from(*depth));
                // The ball is as high as the block, and its middle is 0.
                let place = drawn.place(at);
                let across = place / DVec3::new(10.0, 10.0, 5.0);
                let most = across.abs().max_element();
                assert!((most - 1.0).abs() < 1e-4, "{view:?}: {place}");
                let normal = drawn.axes * drawn.normals[k].as_dvec3();
                assert!(normal.dot(towards) > 0.0);
                assert!((normal.dot(across) - 1.0).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn supports_show_where_they_are_nearer_than_the_part() {
        // Slabs beside the block's front half, seen from the front: they hide
        // it. From behind, the block hides them.
        let model = placed(BLOCK, &Placement::default());
        let at = model.offset.truncate();
        let mut beside = Slabs::default();
        let area = rect(at.x - 2.0, at.y - 14.0, at.x + 2.0, at.y - 11.0);
        beside.add([0.0, 8.0], area);
        let shown = |azimuth: f64| {
            let seen = seen(BLOCK, &beside, View::of(azimuth, 0.0));
            let count = seen.supports.iter().filter(|s| **s).count() as f64;
            count * seen.pixel * seen.pixel
        };
        assert!((shown(-90.0) / 32.0 - 1.0).abs() < 0.05, "{}", shown(-90.0));
        assert_eq!(shown(90.0), 0.0);
        assert!((shown(0.0) / 24.0 - 1.0).abs() < 0.05, "{}", shown(0.0));
    }

    #[test]
    fn holes_of_supports_are_open() {
        let model = placed(BLOCK, &Placement::default());
        let at = model.offset.truncate();
        let square = |half: f64| {
            rect(at.x - half, at.y - half, at.x + half, at.y + half)
        };
        let mut ring = square(20.0);
        let mut hole = square(12.0).rings.remove(0);
        hole.reverse();
        ring.rings.push(hole);
        let mut around = Slabs::default();
        around.add([0.0, 1.0], ring);
        let seen = seen(BLOCK, &around, View::of(-90.0, 90.0));
        let count = |which: &dyn Fn(usize) -> bool| {
            let all = (0..seen.depths.len()).filter(|k| which(*k)).count();
            all as f64 * seen.pixel * seen.pixel
        };
        let supports = count(&|k| seen.is_support(k));
        let shown = count(&|k| is_part(&seen.depths[k]));
        assert!(
            (supports / (1600.0 - 576.0) - 1.0).abs() < 0.02,
            "{supports}"
        );
        let part = shown - supports;
        assert!((part / 400.0 - 1.0).abs() < 0.03, "{part}");
    }
}
