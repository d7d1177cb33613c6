//! Measures the distance to the nearest surface for points inside the part.
//!
//! In: the field and its box. Out: a lattice of signed distances that is
//! interpolated between its nodes.
//!
//! The surface is known at its crossings with the lattice's edges, found by
//! bisection, each with its tangent plane. Every node then learns its nearest
//! crossing from its neighbours in sweeps over the lattice (P.-E. Danielsson,
//! *Euclidean distance mapping*, 1980, in space). Only the sign and the
//! direction of f are used, so f need not be a distance.
//!
//! Threads wait for the distances while they are measured, so they are measured
//! apart from other work.
//!
//! Distances are right to a few hundredths of the lattice's step near the
//! surface, and also where one surface is clearly nearest. Details smaller than
//! the step are missed.

use crate::{Expression, ExpressionError, Model, Place};
use fidget::context::Tree;
use glam::{DVec3, IVec3};
use isoslice_base::parallel;
use isoslice_base::units::Mm;

/// Greatest number of nodes. They take 6 MB of distances and half a second.
const NODES: f64 = 1.5e6;

/// Least step, mm. No setting needs a finer one.
const FINEST: Mm = 0.2;

/// Number of halvings of a crossed edge, to 0.001 of the step.
const HALVINGS: usize = 10;

/// Signed distances on a lattice, positive inside.
#[derive(Clone, Debug)]
pub(crate) struct DepthMap {
    origin: DVec3,
    step: Mm,
    size: [usize; 3],
    depth: Vec<f32>,
}

/// A point of the surface.
#[derive(Clone, Copy, Debug)]
struct SurfacePoint {
    at: DVec3,
    /// Unit normal; zero if there is none.
    normal: DVec3,
}

impl DepthMap {
    /// Measures a model. What is below the bed, or below the air above a raft,
    /// is outside.
    ///
    /// # Errors
    /// If the field cannot be evaluated.
    pub(crate) fn new(model: &Model) -> Result<DepthMap, ExpressionError> {
        let foot = model.foot();
        let solid = model.tree.max(Tree::from(foot as f32) - Tree::z());
        let field = Expression::of_shape(&solid)?;
        let (min, max) = (model.bounds.min, model.bounds.max);
        let extent = (max - min).max(DVec3::splat(1e-6));
        let even = (extent.x * extent.y * extent.z / NODES).cbrt();
        // Flat parts have more nodes on their faces than in their volume.
        let mut step = even.max(FINEST);
        let count = |step: f64| {
            let n = (extent / step).ceil() + 3.0;
            (n.x * n.y * n.z, n)
        };
        while count(step).0 > 1.5 * NODES {
            step *= 1.1;
        }
        let n = count(step).1;
        let size = [n.x as usize, n.y as usize, n.z as usize];
        // The lattice has one node outside on every side.
        let origin = min - DVec3::splat(step);
        let mut map = DepthMap {
            origin,
            step,
            size,
            depth: Vec::new(),
        };
        let inside = map.inside(&field);
        let feet = map.feet(&field, &inside);
        map.spread(&inside, &feet);
        Ok(map)
    }

    fn index(&self, node: [usize; 3]) -> usize {
        (node[2] * self.size[1] + node[1]) * self.size[0] + node[0]
    }

    fn node(&self, index: usize) -> [usize; 3] {
        let (x, rest) = (index % self.size[0], index / self.size[0]);
        [x, rest % self.size[1], rest / self.size[1]]
    }

    fn point(&self, node: [usize; 3]) -> DVec3 {
        let n = DVec3::new(node[0] as f64, node[1] as f64, node[2] as f64);
        self.origin + self.step * n
    }

    /// True for each node that is inside.
    fn inside(&self, field: &Expression) -> Vec<bool> {
        let plane = self.size[0] * self.size[1];
        let planes = parallel::map_apart(self.size[2], |k| {
            if isoslice_base::limits::is_stopped() {
                return vec![false; plane];
            }
            let first = k * plane;
            let places: Vec<Place> = (first..first + plane)
                .map(|i| place(self.point(self.node(i))))
                .collect();
            let mut values = Vec::with_capacity(plane);
            field.evaluate(&places, &mut values);
            // NaN is outside.
            values.iter().map(|v| *v < 0.0).collect::<Vec<bool>>()
        });
        planes.concat()
    }

    /// Points of the surface, each with a node beside it.
    fn feet(
        &self,
        field: &Expression,
        inside: &[bool],
    ) -> Vec<(usize, SurfacePoint)> {
        let stride = [1, self.size[0], self.size[0] * self.size[1]];
        let plane = stride[2];
        let of_plane = |k: usize| {
            let mut nodes = Vec::new();
            // The inner and outer end of each crossed edge.
            let mut ends: Vec<(DVec3, DVec3)> = Vec::new();
            for i in k * plane..(k + 1) * plane {
                if isoslice_base::limits::is_stopped() {
                    break;
                }
                let node = self.node(i);
                for axis in 0..3 {
                    if node[axis] + 1 >= self.size[axis]
                        || inside[i] == inside[i + stride[axis]]
                    {
                        continue;
                    }
                    let (a, b) = (self.point(node), {
                        let mut next = node;
                        next[axis] += 1;
                        self.point(next)
                    });
                    nodes.push(i);
                    ends.push(if inside[i] { (a, b) } else { (b, a) });
                }
            }
            let feet = feet_between(field, ends, self.step);
            nodes.into_iter().zip(feet).collect::<Vec<_>>()
        };
        parallel::map_apart(self.size[2], of_plane).concat()
    }

    /// Distances of all nodes from their nearest feet.
    fn spread(&mut self, inside: &[bool], feet: &[(usize, SurfacePoint)]) {
        const NONE: u32 = u32::MAX;
        let mut nearest = vec![NONE; inside.len()];
        let square = |node: [usize; 3], foot: u32, map: &DepthMap| match feet
            .get(foot as usize)
        {
            Some((_, f)) => f.at.distance_squared(map.point(node)),
            None => f64::INFINITY,
        };
        // A foot is near both ends of its edge, and near the nodes around them.
        for (number, (i, _)) in feet.iter().enumerate() {
            let node = self.node(*i);
            for dz in 0..2 {
                for dy in 0..2 {
                    for dx in 0..2 {
                        let at = [node[0] + dx, node[1] + dy, node[2] + dz];
                        if (0..3).any(|a| at[a] >= self.size[a]) {
                            continue;
                        }
                        let here = self.index(at);
                        let foot = number as u32;
                        if square(at, foot, self)
                            < square(at, nearest[here], self)
                        {
                            nearest[here] = foot;
                        }
                    }
                }
            }
        }
        // Every point of the surface reaches every node by a way that is
        // monotonic along each axis, so 8 sweeps are enough, one for each
        // direction.
        for direction in 0..8 {
            let back = |axis: usize| direction >> axis & 1 == 1;
            let order = |axis: usize| {
                let n = self.size[axis];
                (0..n).map(move |i| if back(axis) { n - 1 - i } else { i })
            };
            for z in order(2) {
                if isoslice_base::limits::is_stopped() {
                    break;
                }
                for y in order(1) {
                    for x in order(0) {
                        let node = [x, y, z];
                        let here = self.index(node);
                        let mut best = square(node, nearest[here], self);
                        for axis in 0..3 {
                            let mut from = IVec3::new(
                                node[0] as i32,
                                node[1] as i32,
                                node[2] as i32,
                            );
                            from[axis] += if back(axis) { 1 } else { -1 };
                            if from[axis] < 0
                                || from[axis] as usize >= self.size[axis]
                            {
                                continue;
                            }
                            let from = self.index([
                                from.x as usize,
                                from.y as usize,
                                from.z as usize,
                            ]);
                            let foot = nearest[from];
                            let there = square(node, foot, self);
                            if there < best {
                                best = there;
                                nearest[here] = foot;
                            }
                        }
                    }
                }
            }
        }
        // Sweeps pass a foot on along the axes only, so a diagonal neighbour
        // may have the nearest foot.
        let plane = self.size[0] * self.size[1];
        let of_plane = |k: usize| {
            let distance = |i: usize| {
                let node = self.node(i);
                let p = self.point(node);
                let mut best: Option<(f64, &SurfacePoint)> = None;
                for beside in self.around(node) {
                    let Some((_, foot)) = feet.get(nearest[beside] as usize)
                    else {
                        continue;
                    };
                    let d = foot.at.distance_squared(p);
                    if best.is_none_or(|(least, _)| d < least) {
                        best = Some((d, foot));
                    }
                }
                let d = best
                    .map_or(f64::INFINITY, |(_, f)| f.distance(p, self.step));
                (if inside[i] { d } else { -d }) as f32
            };
            let nodes = k * plane..(k + 1) * plane;
            nodes.map(distance).collect::<Vec<f32>>()
        };
        self.depth = parallel::map_apart(self.size[2], of_plane).concat();
    }

    /// A node and its neighbours, the diagonal ones included.
    fn around(
        &self,
        [x, y, z]: [usize; 3],
    ) -> impl Iterator<Item = usize> + '_ {
        let near = |i: usize, n: usize| i.saturating_sub(1)..(i + 2).min(n);
        near(z, self.size[2]).flat_map(move |z| {
            near(y, self.size[1]).flat_map(move |y| {
                near(x, self.size[0]).map(move |x| self.index([x, y, z]))
            })
        })
    }

    /// Distance of a point in the model's coordinates from the nearest
    /// surface, positive inside.
    pub(crate) fn at(&self, p: DVec3) -> Mm {
        let q = (p - self.origin) / self.step;
        let last = DVec3::new(
            (self.size[0] - 2) as f64,
            (self.size[1] - 2) as f64,
            (self.size[2] - 2) as f64,
        );
        let low = q.floor().clamp(DVec3::ZERO, last);
        let t = (q - low).clamp(DVec3::ZERO, DVec3::ONE);
        let node = [low.x as usize, low.y as usize, low.z as usize];
        let corner = |x: usize, y: usize, z: usize| {
            let i = self.index([node[0] + x, node[1] + y, node[2] + z]);
            f64::from(self.depth[i])
        };
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let row =
            |y: usize, z: usize| mix(corner(0, y, z), corner(1, y, z), t.x);
        let plane = |z: usize| mix(row(0, z), row(1, z), t.y);
        mix(plane(0), plane(1), t.z)
    }

    /// Distance between neighbouring nodes, mm.
    pub(crate) fn step(&self) -> Mm {
        self.step
    }
}

impl SurfacePoint {
    /// Distance of a point from the surface near this foot: from the foot's
    /// plane if the point is roughly in front of the foot, or else from the
    /// foot itself.
    fn distance(&self, p: DVec3, step: Mm) -> Mm {
        /// Number of steps by which a node's foot may be farther than the
        /// nearest one.
        const REACH: f64 = 1.5;
        let way = p - self.at;
        let length = way.length();
        let off = way.dot(self.normal).abs();
        let along = (length * length - off * off).max(0.0).sqrt();
        // A foot that is seen more from the side may be at the edge of a notch.
        let facing = along <= step || along <= off.min(REACH * step);
        if self.normal != DVec3::ZERO && facing {
            off
        } else {
            length
        }
    }
}

fn place(at: DVec3) -> Place {
    Place { at, depth: 0.0 }
}

/// Where the field changes sign between an inner and an outer point, and the
/// direction in which it grows there.
fn feet_between(
    field: &Expression,
    mut ends: Vec<(DVec3, DVec3)>,
    step: Mm,
) -> Vec<SurfacePoint> {
    /// Length over which slopes are taken, as a share of the step.
    const PROBE: f64 = 0.05;
    let mut places = Vec::with_capacity(ends.len());
    let mut values = Vec::new();
    for _ in 0..HALVINGS {
        places.clear();
        places.extend(ends.iter().map(|(a, b)| place(0.5 * (*a + *b))));
        values.clear();
        field.evaluate(&places, &mut values);
        for ((end, middle), v) in ends.iter_mut().zip(&places).zip(&values) {
            if *v < 0.0 {
                end.0 = middle.at
            } else {
                end.1 = middle.at
            }
        }
    }
    let slope = |axis: DVec3| -> Vec<f64> {
        let probe = PROBE * step * axis;
        let beside = |sign: f64| {
            let places: Vec<Place> =
                ends.iter().map(|(a, _)| place(*a + sign * probe)).collect();
            let mut values = Vec::with_capacity(places.len());
            field.evaluate(&places, &mut values);
            values
        };
        let (up, down) = (beside(1.0), beside(-1.0));
        up.iter().zip(down).map(|(u, d)| u - d).collect()
    };
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(slope);
    ends.iter()
        .enumerate()
        .map(|(i, (a, b))| SurfacePoint {
            at: 0.5 * (*a + *b),
            normal: DVec3::new(x[i], y[i], z[i])
                .try_normalize()
                .filter(|n| n.is_finite())
                .unwrap_or(DVec3::ZERO),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Placement, placed};

    fn map(formula: &str) -> (Model, DepthMap) {
        let model = placed(formula, &Placement::default());
        let map = DepthMap::new(&model).unwrap();
        (model, map)
    }

    /// Points spread over a box, in no order.
    fn spread(half: DVec3) -> impl Iterator<Item = DVec3> {
        (1..4000).map(move |i| {
            let t = f64::from(i);
            let u = DVec3::new(t * 0.754_877, t * 0.569_84, t * 0.618_034);
            (u.fract() * 2.0 - 1.0) * half
        })
    }

    #[test]
    fn a_raft_does_not_change_what_the_bed_cuts_off() {
        let (mut model, _) = map("sqrt(x^2 + y^2 + z^2) - 10");
        // Half of the ball is below the bed.
        model.offset.z = 0.0;
        let cut = DepthMap::new(&model).unwrap();
        let raised = DepthMap::new(&model.raised(0.9)).unwrap();
        for z in [0.5, 2.0, 6.0] {
            let p = DVec3::new(1.0, 2.0, z);
            assert_eq!(raised.at(p), cut.at(p));
        }
        assert!((cut.at(DVec3::Z * 2.0) - 2.0).abs() < 0.05);
    }

    #[test]
    fn a_ball_is_as_deep_as_its_radius() {
        // This function is badly scaled, and no distance.
        let (_, map) = map("1e-3*(x^2 + y^2 + z^2 - 400)");
        for p in spread(DVec3::splat(20.0)) {
            let depth = 20.0 - p.length();
            let d = map.at(p);
            // The middle is equally far from all of the surface.
            let most = if p.length() < 2.0 { 0.4 } else { 0.02 };
            if depth < -1.0 {
                assert!(d < -1.0 + most, "{p}: {d} {depth}");
                continue;
            }
            assert!((d - depth).abs() < most, "{p}: {d} {depth}");
        }
    }

    #[test]
    fn a_box_and_its_cavity() {
        let (_, map) = map("max(max(max(abs(x)-15,abs(y)-12),abs(z)-10), \
             4 - sqrt(x^2+y^2+z^2))");
        let mut worst: f64 = 0.0;
        for p in spread(DVec3::new(15.0, 12.0, 10.0)) {
            let walls = DVec3::new(15.0, 12.0, 10.0) - p.abs();
            let depth = walls.min_element().min(p.length() - 4.0);
            // Where two surfaces are equally near, the lattice rounds the
            // ridge.
            worst = worst.max((map.at(p) - depth).abs());
        }
        assert!(worst < 0.6 * map.step() && worst > 0.0, "{worst}");
        assert!(map.at(DVec3::ZERO) < -3.0);
        assert!((map.at(DVec3::new(13.0, 0.0, 1.0)) - 2.0).abs() < 0.01);
    }
}
