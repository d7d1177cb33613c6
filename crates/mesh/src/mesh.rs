//! A mesh as a function: the signed distance to its triangles.

use crate::closest::Near;
use crate::error::MeshError;
use crate::facts::Facts;
use crate::few::Few;
use crate::repair::repair;
use crate::rim::rim;
use crate::shell::{ROUNDINGS, Shell};
use crate::sign::Sign;
use crate::triangles::Triangles;
use glam::{DAffine3, DVec3};
use isocontour::{Bounds, Crossing, Data, Facet, Grid, Ring, places};
use std::cell::Cell;
use std::sync::OnceLock;

/// Places that are farther than this along an axis, mm, are so far that the
/// mesh is a point.
const FAR_AWAY: f64 = 1e15;

/// The value inside where a triangle passes through the place: a number below
/// zero that is none for any length. Triangles inside a body, where shells
/// cross, make no gaps in it.
const INSIDE: f64 = 1e-30;

/// Distances below this share of the coordinates have no direction that is right
/// to six digits. There the gradient is the normal of the triangle.
const NO_DIRECTION: f64 = 1e6 * f64::EPSILON;

thread_local! {
    /// The triangle that was closest last, of any mesh. The next place is often
    /// near to the last one. What is found does not depend on it.
    static LAST: Cell<usize> = const { Cell::new(0) };
}

/// A mesh as a function of three coordinates, mm: the distance to the closest
/// triangle, negative inside.
///
/// Inside is where the winding number is above one half, and only in the box
/// around the triangles.
#[derive(Debug)]
pub struct Mesh {
    name: String,
    pub(crate) shell: Shell,
    pub(crate) sign: Sign,
    pub(crate) bounds: Bounds,
    facts: Facts,
    /// True if some triangle is inside, once that was asked.
    has_inner: OnceLock<bool>,
}

/// What is known of the last place that was asked for.
#[derive(Clone, Copy)]
struct Last {
    place: DVec3,
    distance: f64,
    is_inside: bool,
}

/// What is known from the places before.
#[derive(Default)]
struct Before {
    last: Option<Last>,
    few: Few,
}

impl Mesh {
    /// Makes a function of triangles. `name` is how messages call it, such as
    /// `mesh("part.stl")`.
    ///
    /// # Errors
    /// If there are no triangles, or work was stopped.
    pub fn new(name: &str, triangles: Triangles) -> Result<Mesh, MeshError> {
        if triangles.corners.is_empty() {
            return Err(MeshError::Empty);
        }
        let mut facts = Facts::of(&triangles);
        let triangles = repair(triangles, &mut facts)?;
        if triangles.corners.is_empty() {
            return Err(MeshError::File(
                "its triangles have no area, or cancel one another: nothing is \
                 left of them; export the part again"
                    .to_owned(),
            ));
        }
        let bounds = triangles.bounds();
        let shell = Shell::new(triangles.vertices, triangles.corners);
        isoslice_base::limits::go_on()?;
        let open = if facts.open_edges == 0 {
            Vec::new()
        } else {
            rim(&shell.corners, shell.vertices.len())
        };
        let sign = Sign::new(&shell, &bounds, &open)?;
        isoslice_base::limits::go_on()?;
        Ok(Mesh {
            name: name.to_owned(),
            shell,
            sign,
            bounds,
            facts,
            has_inner: OnceLock::new(),
        })
    }

    /// What is known of the mesh.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// Its vertices, mm, and the corners of its triangles, as they are once they
    /// are repaired.
    pub fn triangles(&self) -> (&[DVec3], &[[u32; 3]]) {
        (&self.shell.vertices, &self.shell.corners)
    }

    /// How often the mesh goes round a place: 1 inside a sound body, 2 where two
    /// overlap, a fraction near holes.
    pub fn winding(&self, p: DVec3) -> f64 {
        self.sign.winding(&self.shell, &self.bounds, p)
    }

    pub(crate) fn is_inside(&self, p: DVec3) -> bool {
        self.bounds.contains(p) && self.winding(p) > 0.5
    }

    /// True if both sides of some triangle's middle are inside.
    pub(crate) fn has_inner(&self) -> bool {
        /// The way from the middle to both sides, as a share of the coordinates.
        const OFF: f64 = 1e-9;
        *self.has_inner.get_or_init(|| {
            (0..self.shell.corners.len()).any(|i| {
                let [a, b, c] = self.shell.triangle(i);
                let middle = (a + b + c) / 3.0;
                let step = OFF * (1.0 + middle.abs().max_element());
                let way = self.shell.normal(i).normalize_or_zero() * step;
                self.is_inside(middle + way) && self.is_inside(middle - way)
            })
        })
    }

    /// The triangle that is closest to a place.
    pub(crate) fn nearest(&self, p: DVec3) -> Near {
        let guess = LAST.get().min(self.shell.corners.len() - 1);
        let near = self.shell.nearest(p, guess);
        LAST.set(near.triangle);
        near
    }

    /// A distance with its sign.
    fn signed(distance: f64, is_inside: bool) -> f64 {
        if is_inside {
            -distance.max(INSIDE)
        } else {
            distance
        }
    }

    /// The value at a place, given what is known of places near to it. It is the
    /// same as without.
    fn next(&self, place: DVec3, before: &mut Before) -> f64 {
        if place.abs().max_element() > FAR_AWAY {
            return place.distance(self.bounds.centre());
        }
        let search = || self.nearest(place);
        let near = before.few.nearest(&self.shell, place, search);
        let distance = near.square.sqrt();
        // No triangle is within the last distance of the last place.
        let known = before.last.filter(|last| {
            place.distance(last.place)
                < last.distance * (1.0 - 1e-9)
                    - ROUNDINGS * place.abs().max_element()
                && !self.sign.may_change(&between(last.place, place))
        });
        let is_inside =
            known.map_or_else(|| self.is_inside(place), |l| l.is_inside);
        before.last = Some(Last {
            place,
            distance,
            is_inside,
        });
        Self::signed(distance, is_inside)
    }

    /// The gradient at a place whose closest point is known.
    fn gradient(&self, p: DVec3, near: &Near, is_inside: bool) -> DVec3 {
        let way = p - near.point;
        let distance = near.square.sqrt();
        let coordinates = p.abs().max(near.point.abs()).max_element();
        if distance > NO_DIRECTION * coordinates {
            let out = way / distance;
            if is_inside { -out } else { out }
        } else {
            let normal = self.shell.normal(near.triangle);
            normal.try_normalize().unwrap_or(DVec3::ZERO)
        }
    }
}

/// The box around two places.
fn between(a: DVec3, b: DVec3) -> Bounds {
    Bounds::new(a.min(b), a.max(b))
}

impl Data for Mesh {
    fn name(&self) -> &str {
        &self.name
    }

    fn at(&self, p: DVec3) -> (f64, DVec3) {
        if p.abs().max_element() > FAR_AWAY {
            let way = p - self.bounds.centre();
            return (way.length(), way.normalize_or_zero());
        }
        let near = self.nearest(p);
        let is_inside = self.is_inside(p);
        (
            Self::signed(near.square.sqrt(), is_inside),
            self.gradient(p, &near, is_inside),
        )
    }

    fn value(&self, p: DVec3) -> f64 {
        self.next(p, &mut Before::default())
    }

    fn values(&self, at: [&[f32]; 3], out: &mut Vec<f32>) {
        let mut before = Before::default();
        let mut value = |p| self.next(p, &mut before) as f32;
        out.extend(places(at).map(|p| p.map_or(f32::NAN, &mut value)));
    }

    fn range(&self, over: &Bounds) -> [f64; 2] {
        self.range_over(over)
    }

    fn slopes(&self, over: &Bounds) -> [[f64; 2]; 3] {
        self.slopes_over(over)
    }

    fn bytes(&self) -> usize {
        size_of::<Mesh>() + self.shell.bytes() + self.sign.bytes()
    }

    fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        for v in &self.shell.vertices {
            v.to_array().iter().for_each(|c| tell(&c.to_le_bytes()));
        }
        for corner in self.shell.corners.as_flattened() {
            tell(&corner.to_le_bytes());
        }
    }

    fn extent(&self, place: &DAffine3) -> Option<Bounds> {
        let back = place.inverse();
        let seen = self.shell.vertices.iter();
        let all = Bounds::around(seen.map(|v| back.transform_point3(*v)));
        all.is_finite().then_some(all)
    }

    fn corners(&self) -> Option<&[DVec3]> {
        Some(&self.shell.vertices)
    }

    fn has_section(&self) -> bool {
        true
    }

    fn section(&self, place: &DAffine3, z: f64) -> Option<Vec<Ring>> {
        self.section_at(place, z)
    }

    fn facets(
        &self,
        place: &DAffine3,
        level: f64,
        over: &Bounds,
        tell: &mut dyn FnMut(Facet),
    ) -> bool {
        self.facets_over(place, level, over, tell)
    }

    fn has_crossings(&self) -> bool {
        true
    }

    fn crossings(&self, lines: &Grid) -> Option<Vec<Crossing>> {
        self.crossed_by(lines)
    }
}
