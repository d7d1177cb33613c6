//! Surfaces that consist of known parts: the triangles of meshes, and what is at one
//! distance from triangles.
//!
//! The slopes of a mesh's distance say nothing of a box that meets an edge: beside
//! the edge the distance has slopes between those of both faces. So boxes would have
//! to be cut until each holds a single face. The parts themselves tell all. A
//! triangle is as level as its normal says, at all heights between its corners. A
//! place that is r away from an edge or a corner is the more level the higher it
//! lies: z − z₀ = r·n_z.
//!
//! A box that is no higher than boxes that may be done is looked at part by part,
//! the most level one first. The first one that shows, which has what is inside on
//! one side only, is the bound. Of a triangle that does not show, such as one within
//! another body, this is asked every [`NARROW`] across what of it is in the box.
//!
//! A triangle that is level but for what files round is a level face.

use super::{DONE_BINS, Length, NARROW, OFF_FACE, Search};
use crate::Bounds;
use crate::cell::Cell;
use crate::data::Facet;
use crate::program::{Placed, Program, Surface};
use glam::{DAffine3, DVec3};
use std::rc::Rc;

/// Greatest difference of the heights of a level triangle's corners. Coordinates of
/// 100 mm that were turned, and written with 32 bits, are off by some 1e-5. The plan
/// of layers takes faces that are 5e-4 apart for one.
const FLAT: Length = 2e-4;
/// Greatest slope of a level triangle whose corners' heights differ. Triangles that
/// are small may be steep within [`FLAT`].
const LEVEL: f64 = 1e-3;
/// Width below which a triangle is none: what its normal says is rounding.
const SLIVER: Length = 2e-5;
/// Most places in a row at which it is asked whether a part shows.
const MOST_PLACES: f64 = 64.0;
/// Most parts of a box of which that is asked. The next one counts as if it showed.
const MOST_ASKED: usize = 256;
/// Number of parts that take the time of an interval operation.
const PARTS: u64 = 4;
/// Number of interval operations that take the time in which data tells a part.
const TOLD: u64 = 8;

/// The parts that count in a box, those of each surface. They are all that count in
/// any part of the box, so that data is asked once for all boxes of a slab.
pub(super) type Parts = Rc<[Told]>;

/// The parts of a surface.
pub(super) struct Told {
    /// The data, by its address.
    data: *const (),
    place: DAffine3,
    level: f64,
    parts: Rc<[Facet]>,
}

impl Told {
    /// True if these are the parts of a surface. The map's translation is rounded
    /// otherwise in each box.
    fn are_of(&self, placed: &Placed) -> bool {
        const ROUNDINGS: f64 = 1e-12;
        let [a, b] = [self.place, placed.place].map(|p| p.translation);
        let most = a.abs().max_element() + 1.0;
        std::ptr::addr_eq(self.data, placed.data)
            && self.level == placed.level
            && self.place.matrix3 == placed.place.matrix3
            && a.abs_diff_eq(b, ROUNDINGS * most)
    }
}

/// What is known of the parts in a box that is too high to be done.
#[derive(Default)]
pub(super) struct Facets {
    /// Bound of |n_z| for all that are not level.
    pub most: f64,
    /// True if one may be level.
    pub has_faces: bool,
    /// What counts in the parts of the box.
    pub parts: Vec<Told>,
}

/// A part, and what is known of it in a box.
struct Part {
    facet: Facet,
    kind: Kind,
}

/// What a part is.
#[derive(Clone, Copy)]
enum Kind {
    /// Level at a height.
    Level(Length),
    /// As level as this, at most.
    Leaning(f64),
}

impl Search<'_> {
    /// Looks at those surfaces that consist of known parts, and returns the others.
    /// In a box that is low enough to be done, all is noted that is found.
    pub(super) fn facets(
        &mut self,
        cell: &Cell,
        seen: &Cell,
        program: &Program,
        surfaces: Vec<Surface>,
        known: &Parts,
    ) -> (Vec<Surface>, Facets) {
        let mut facets = Facets::default();
        let is_other = |of: &Surface| {
            !self.facets_of(cell, seen, program, of, known, &mut facets)
        };
        let others = surfaces.into_iter().filter(is_other).collect();
        (others, facets)
    }

    /// Looks at a surface. False if its parts are not known.
    fn facets_of(
        &mut self,
        cell: &Cell,
        seen: &Cell,
        program: &Program,
        surface: &Surface,
        known: &Parts,
        facets: &mut Facets,
    ) -> bool {
        let centre = DVec3::from_array(seen.centre());
        let Some(placed) = program.placed_data(surface, centre, &self.scratch)
        else {
            return false;
        };
        let over = Bounds::new(seen.lo.into(), seen.hi.into());
        let mut told = Vec::new();
        let all: &[Facet] = match known.iter().find(|t| t.are_of(&placed)) {
            Some(told) => &told.parts,
            None => {
                let is_known = placed.data.facets(
                    &placed.place,
                    placed.level,
                    &over,
                    &mut |facet| told.push(facet),
                );
                self.scratch.work += TOLD * told.len() as u64;
                if !is_known {
                    return false;
                }
                &told
            }
        };
        self.scratch.work += all.len() as u64 / PARTS;
        let is_low = cell.width(2) <= DONE_BINS * self.options.bin;
        let least = self.least_of(cell);
        let mut parts: Vec<Part> = Vec::new();
        for facet in all {
            if around(facet).gap(&over) > 0.0 {
                continue;
            }
            let Some(kind) = kind(facet, cell, self.margin) else {
                continue;
            };
            match kind {
                Kind::Level(z) if self.is_face(z) => continue,
                Kind::Level(_) => facets.has_faces = true,
                // Any part of the box is as level already.
                Kind::Leaning(up) if up <= least => continue,
                Kind::Leaning(up) => facets.most = facets.most.max(up),
            }
            parts.push(Part {
                facet: *facet,
                kind,
            });
        }
        facets.parts.push(Told {
            data: std::ptr::from_ref(placed.data).cast(),
            place: placed.place,
            level: placed.level,
            parts: parts.iter().map(|part| part.facet).collect(),
        });
        if !is_low {
            return true;
        }
        let mut leaning = Vec::new();
        for Part { facet, kind } in parts {
            match kind {
                Kind::Level(z) => {
                    let is_new = !self.is_face(z);
                    if is_new && self.shows(&facet, true, cell, seen, program) {
                        self.faces.push(z);
                    }
                }
                Kind::Leaning(up) => leaning.push((up, facet)),
            }
        }
        leaning.sort_by(|a, b| b.0.total_cmp(&a.0));
        let first = leaning.iter().enumerate().find(|(k, (_, facet))| {
            *k >= MOST_ASKED || self.shows(facet, false, cell, seen, program)
        });
        if let Some((_, (up, _))) = first {
            self.raise(cell.lo[2], cell.hi[2], *up);
        }
        true
    }

    /// True if a level face at a height is known.
    fn is_face(&self, z: Length) -> bool {
        self.faces.iter().any(|face| (face - z).abs() <= FLAT)
    }

    /// True if what is inside is on one side only of a part, somewhere in a box. Of
    /// what is round, all is looked at, also outside the box.
    fn shows(
        &mut self,
        facet: &Facet,
        is_level: bool,
        cell: &Cell,
        seen: &Cell,
        program: &Program,
    ) -> bool {
        let mut differs = |program: &Program, p: DVec3, normal: DVec3| {
            let step = OFF_FACE * (1.0 + p.abs().max_element());
            let [a, b] = [step, -step].map(|step| {
                let at = (p + step * normal).to_array();
                program.value(at, &mut self.scratch) < 0.0
            });
            a != b
        };
        match facet {
            Facet::Flat(corners) => {
                let [a, b, c] = *corners;
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let mut corners = corners.to_vec();
                for axis in 0..3 {
                    // A level triangle between two boxes belongs to both.
                    let of = if is_level { seen } else { cell };
                    corners = cut(&corners, axis, of.lo[axis], 1.0);
                    corners = cut(&corners, axis, -of.hi[axis], -1.0);
                }
                let all = places(&corners);
                all.into_iter().any(|p| differs(program, p, normal))
            }
            Facet::Round {
                line: [from, to],
                radius,
                ways,
                ..
            } => {
                let root = Rc::clone(&self.root);
                let many = count(from.distance(*to));
                (0..many as usize).any(|k| {
                    let p = from.lerp(*to, (k as f64 + 0.5) / many);
                    ways.iter()
                        .any(|way| differs(&root, p + *radius * *way, *way))
                })
            }
        }
    }
}

/// The box around a part.
fn around(facet: &Facet) -> Bounds {
    match *facet {
        Facet::Flat(corners) => Bounds::around(corners),
        Facet::Round {
            line,
            radius,
            up: [least, most],
            ..
        } => {
            let mut wide = Bounds::around(line).grown(radius.abs());
            let [p, q] = [radius * least, radius * most];
            wide.min.z = line[0].z.min(line[1].z) + p.min(q);
            wide.max.z = line[0].z.max(line[1].z) + p.max(q);
            wide
        }
    }
}

/// What a part is in a box. None if it is not there, or has no direction. `margin` is
/// how far a part reaches into a box that it only touches.
fn kind(facet: &Facet, cell: &Cell, margin: Length) -> Option<Kind> {
    let is_inside = |low: Length, high: Length| {
        high > cell.lo[2] + margin && low < cell.hi[2] - margin
    };
    match *facet {
        Facet::Flat([a, b, c]) => {
            let across = (b - a).cross(c - a);
            let twice = across.length();
            let sides = [b - a, c - b, a - c].map(DVec3::length);
            let longest = sides.into_iter().fold(0.0, f64::max);
            let is_known = twice > SLIVER * longest;
            if !is_known {
                return None;
            }
            let normal = across / twice;
            let low = a.z.min(b.z).min(c.z);
            let high = a.z.max(b.z).max(c.z);
            let is_level = low == high
                || high - low <= FLAT && normal.truncate().length() <= LEVEL;
            if is_level {
                return Some(Kind::Level(0.5 * (low + high)));
            }
            is_inside(low, high).then(|| Kind::Leaning(normal.z.abs().min(1.0)))
        }
        Facet::Round {
            line: [from, to],
            radius,
            up: [least, most],
            ..
        } => {
            let (low, high) = (from.z.min(to.z), from.z.max(to.z));
            // What rounding leaves between the triangles of a level face is none.
            let steepest = if least <= 0.0 && most >= 0.0 {
                0.0
            } else {
                least.abs().min(most.abs())
            };
            let is_level = 1.0 - steepest <= 0.5 * LEVEL * LEVEL;
            let rise = (high - low) + radius.abs() * (most - least);
            if is_level && rise <= FLAT {
                return None;
            }
            // The directions in which a place of the line has a place in the box.
            let [p, q] =
                [cell.lo[2] - high, cell.hi[2] - low].map(|way| way / radius);
            let (least, most) = (least.max(p.min(q)), most.min(p.max(q)));
            let ends = [least, most].map(|up| up.abs().min(1.0));
            (least <= most).then(|| Kind::Leaning(ends[0].max(ends[1])))
        }
    }
}

/// What of a convex polygon has `sign` times a coordinate at `least` or above.
fn cut(corners: &[DVec3], axis: usize, least: f64, sign: f64) -> Vec<DVec3> {
    let above = |p: DVec3| sign * p[axis] - least;
    let mut left = Vec::with_capacity(corners.len() + 1);
    for (i, &p) in corners.iter().enumerate() {
        let q = corners[(i + 1) % corners.len()];
        let (u, v) = (above(p), above(q));
        if u >= 0.0 {
            left.push(p);
        }
        if (u >= 0.0) != (v >= 0.0) {
            left.push(p.lerp(q, u / (u - v)));
        }
    }
    left
}

/// In how many pieces a length is looked at.
fn count(length: Length) -> f64 {
    (length / NARROW).ceil().clamp(1.0, MOST_PLACES)
}

/// Places on a convex polygon, its middle first, no farther from one another than
/// [`NARROW`], and if it is large in rows of [`MOST_PLACES`].
fn places(corners: &[DVec3]) -> Vec<DVec3> {
    let Some(&first) = corners.first() else {
        return Vec::new();
    };
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let mut all = vec![middle];
    // The rows lie across the way to the corner that is farthest from the first.
    let from_first = |p: &DVec3| p.distance_squared(first);
    let farthest = corners
        .iter()
        .copied()
        .max_by(|p, q| from_first(p).total_cmp(&from_first(q)))
        .unwrap_or(first);
    let way = farthest - first;
    let Some(along) = way.try_normalize() else {
        return all;
    };
    let share = |k: usize, of: f64| (k as f64 + 0.5) / of;
    let least = corners
        .iter()
        .map(|p| (*p - first).dot(along))
        .fold(0.0, f64::min);
    let length = way.length() - least;
    let rows = count(length);
    for row in 0..rows as usize {
        let at = least + share(row, rows) * length;
        let ends = row_of(corners, first, along, at);
        let [Some(from), Some(to)] = ends else {
            continue;
        };
        let most = count(from.distance(to));
        all.extend((0..most as usize).map(|k| from.lerp(to, share(k, most))));
    }
    all
}

/// The ends of what a convex polygon has in common with a plane across a direction.
fn row_of(
    corners: &[DVec3],
    first: DVec3,
    along: DVec3,
    at: Length,
) -> [Option<DVec3>; 2] {
    let above = |p: DVec3| (p - first).dot(along) - at;
    let mut ends = [None; 2];
    for (i, &p) in corners.iter().enumerate() {
        let q = corners[(i + 1) % corners.len()];
        let (u, v) = (above(p), above(q));
        if (u >= 0.0) != (v >= 0.0) {
            ends[usize::from(u >= 0.0)] = Some(p.lerp(q, u / (u - v)));
        }
    }
    ends
}
