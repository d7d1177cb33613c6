//! How far the model reaches on each side: best-first branch and bound.

use super::cut::split_axis;
use super::search::{Part, Search};
use super::side::BoxSide;
use super::{Bounds, BoundsError, FoundBounds};
use crate::cell::Cell;
use crate::program::Program;
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

/// A box in which the field may be negative.
struct Candidate {
    reach: f64,
    depth: u32,
    /// Number in the order of creation. It makes the order total, and so
    /// repeatable.
    number: u64,
    cell: Cell,
    program: Rc<Program>,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        // Of boxes that reach equally far the deepest comes first, since it is
        // the nearest to a decision.
        self.reach
            .total_cmp(&other.reach)
            .then(self.depth.cmp(&other.depth))
            .then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

/// Least budget for a climb, per operation of the program. A climb takes 64
/// values.
const CLIMB: u64 = 400;

impl Search<'_> {
    /// The box of {f < 0}.
    pub(super) fn run(
        mut self,
        program: Rc<Program>,
    ) -> Result<FoundBounds, BoundsError> {
        let parts = self.narrow(program)?;
        let mut slack_mm = f64::INFINITY;
        // The tolerance is a share of the size, which the coarse region may
        // overestimate. So the search is repeated with the size that it found.
        for _ in 0..3 {
            let before = self.region.largest_side();
            slack_mm = self.all_sides(&parts)?;
            if self.region.largest_side() > 0.6 * before {
                break;
            }
        }
        Ok(FoundBounds {
            bounds: Bounds {
                min: DVec3::from_array(self.region.lo),
                max: DVec3::from_array(self.region.hi),
            },
            slack_mm,
        })
    }

    /// Moves all sides of the region to the model; returns the slack.
    fn all_sides(&mut self, parts: &[Part]) -> Result<f64, BoundsError> {
        let far = (0..3)
            .map(|i| self.region.lo[i].abs().max(self.region.hi[i].abs()))
            .fold(0.0, f64::max);
        // The tolerance is not below the distance that f64 coordinates can tell
        // apart.
        let tolerance = (self.region.largest_side() * self.options.tolerance)
            .min(1e-4)
            .max(far * 1e-13);
        let mut slack_mm: f64 = 0.0;
        let sides = BoxSide::all();
        if let [part] = parts {
            for side in sides {
                self.trim(side, &part.program, 0.5 * tolerance);
            }
        }
        for (done, side) in sides.into_iter().enumerate() {
            let left = self.options.max_work.saturating_sub(self.scratch.work);
            let budget = left / (sides.len() - done) as u64;
            let reach = self.side(side, parts, tolerance, budget)?;
            side.set_reach(&mut self.region, reach);
            if let Some(inside) = self.inside {
                slack_mm = slack_mm.max(reach - side.reach(&inside));
            }
        }
        Ok(slack_mm.max(self.pitch))
    }

    /// Cuts off the largest slab at a side that one enclosure proves empty, to
    /// within `tolerance`. Where a body cuts a lattice, that body alone proves
    /// the whole slab empty. Small cells would each have to be split where the
    /// lattice jumps.
    fn trim(&mut self, side: BoxSide, program: &Program, tolerance: f64) {
        let mut face = side.reach(&self.region);
        let mut inner = side.outward(side.inner_face(&self.region));
        if let Some(inside) = &self.inside {
            inner = inner.max(side.reach(inside));
        }
        while face - inner > tolerance {
            let middle = 0.5 * (inner + face);
            if middle <= inner || middle >= face {
                break;
            }
            let mut slab = self.region;
            side.set_reach(&mut slab, face);
            side.clip(&mut slab, middle);
            let f = program.enclose(&slab, &mut self.scratch);
            if f.is_outside() {
                face = middle;
            } else {
                inner = middle;
            }
        }
        side.set_reach(&mut self.region, face);
    }

    /// Finds how far the model reaches on one side.
    fn side(
        &mut self,
        side: BoxSide,
        parts: &[Part],
        tolerance: f64,
        budget: u64,
    ) -> Result<f64, BoundsError> {
        let stop = self.scratch.work + budget;
        let face = side.reach(&self.region);
        let thinnest = tolerance / 16.0;
        if let [part] = parts {
            self.probe(side, &part.program, tolerance, budget);
        }
        let mut number = 0;
        let mut candidate = |depth: u32, cell: Cell, program: Rc<Program>| {
            number += 1;
            Candidate {
                reach: side.reach(&cell),
                depth,
                number,
                cell,
                program,
            }
        };
        let mut queue = BinaryHeap::new();
        for Part { cell, program } in parts {
            let cell = cell.common(&self.region);
            if (0..3).all(|i| cell.lo[i] <= cell.hi[i]) {
                queue.push(candidate(0, cell, program.clone()));
            }
        }
        while let Some(mut c) = queue.pop() {
            if self.cancel.is_asked() {
                break;
            }
            if let Some(inside) = &self.inside {
                let known = side.reach(inside);
                if self.options.within.is_none()
                    && known > 0.9 * self.options.limit_mm
                {
                    return Err(BoundsError::Unbounded {
                        direction: side.name(),
                        at_mm: side.outward(known).round(),
                        flipped: false,
                    });
                }
                // No candidate reaches farther than this one.
                if c.reach <= known + tolerance {
                    break;
                }
                // The cut lies half a tolerance below the part that is still to
                // be decided, so that no box gets thinner than that. With a cut
                // right at the height of a rounded top, ever thinner boxes
                // would follow.
                side.clip(&mut c.cell, known + 0.5 * tolerance);
            }
            if self.scratch.work > stop {
                let (reach, program) = (c.reach, c.program.clone());
                queue.push(c);
                let hull = queue.iter().map(|c| c.cell);
                let hull = hull.reduce(|a, b| a.joined(&b));
                let boxes = queue.into_iter().map(|c| (c.cell, c.program));
                let known = self.sample(side, boxes, tolerance, budget);
                let beyond = reach >= 0.9 * self.options.limit_mm
                    && self.options.within.is_none();
                return match known {
                    Some(known) => Ok((known + tolerance).min(reach)),
                    None if self.inside.is_none() || beyond => {
                        Err(self.undecided(side, &program))
                    }
                    None => {
                        let looked = match (parts, hull) {
                            ([part], Some(hull)) => self.columns(
                                side,
                                &hull,
                                &part.program,
                                tolerance,
                            ),
                            _ => None,
                        };
                        let (found, pitch) = looked.unwrap_or((reach, 0.0));
                        self.pitch = self.pitch.max(pitch);
                        Ok(found.min(reach))
                    }
                };
            }
            let f = c.program.enclose(&c.cell, &mut self.scratch);
            if f.is_outside()
                || c.program.is_border(&c.cell, &f, &mut self.scratch)
            {
                continue;
            }
            // The climb starts from the middle of the inner face as well. Where
            // the surface has a rounded top just above that face, the box's
            // centre is outside the surface however small the box gets.
            let mut start = c.cell.centre();
            let mut is_inside = f.centre < 0.0;
            if !is_inside {
                start[side.axis] = side.inner_face(&c.cell);
                is_inside = c.program.value(start, &mut self.scratch) < 0.0;
            }
            if is_inside {
                c.program = c.program.simplified(&self.scratch);
                self.note_inside(start);
                // If the program is long, boxes are only halved.
                if c.program.len() as u64 * CLIMB < budget {
                    self.climb(side, &c.program, start, c.reach);
                }
                // The box is put back into the queue, cut at the new extent.
                queue.push(c);
                continue;
            }
            let whole = c.cell;
            c.cell = c.program.contracted(&whole, &self.scratch);
            // Contracting the box may leave a part too thin to count.
            let too_thin =
                |i: usize| c.cell.width(i) < whole.width(i).min(thinnest);
            if (0..3).any(too_thin) {
                continue;
            }
            let mut by_pieces = c.program.by_pieces(&self.scratch);
            if by_pieces.is_empty() {
                by_pieces = c.program.by_sectors(&self.scratch);
            }
            if !by_pieces.is_empty() {
                queue.extend(by_pieces.into_iter().map(|program| {
                    candidate(c.depth + 1, c.cell, Rc::new(program))
                }));
                continue;
            }
            let Some(across) =
                split_axis(&c.cell, f.steepness, c.depth, thinnest)
            else {
                continue;
            };
            let program = c.program.simplified(&self.scratch);
            queue.extend(
                c.cell
                    .split(across)
                    .map(|cell| candidate(c.depth + 1, cell, program.clone())),
            );
        }
        let Some(inside) = &self.inside else {
            return Err(self.nothing(parts));
        };
        let known = side.reach(inside);
        let proved = (known + tolerance).min(face).max(known);
        Ok(simplest_between(known, proved))
    }

    /// Looks for inside points in boxes about which nothing could be proved, so
    /// closely that nothing that can be printed lies between the points. Of some
    /// fields, such as sin(r)/r near r = 0, the ranges say too little however
    /// small the boxes get. Returns the known extent; none if there is none, or
    /// if it takes more work than `budget`.
    fn sample(
        &mut self,
        side: BoxSide,
        boxes: impl Iterator<Item = (Cell, Rc<Program>)>,
        tolerance: f64,
        budget: u64,
    ) -> Option<f64> {
        /// Width of the columns in which points are looked at: half that of a
        /// thin line.
        const PITCH: f64 = 0.2;
        let stop = self.scratch.work + budget;
        let [u, v] = [(side.axis + 1) % 3, (side.axis + 2) % 3];
        let mut todo: Vec<(Cell, Rc<Program>)> = boxes.collect();
        while let Some((mut cell, program)) = todo.pop() {
            if self.is_over(stop) {
                return None;
            }
            if let Some(inside) = &self.inside {
                let known = side.reach(inside);
                if side.reach(&cell) <= known + tolerance {
                    continue;
                }
                side.clip(&mut cell, known);
            }
            let f = program.enclose(&cell, &mut self.scratch);
            if f.is_outside() {
                continue;
            }
            let wider = if cell.width(u) < cell.width(v) { v } else { u };
            if cell.width(wider) > PITCH {
                let halves = cell.split(wider);
                todo.extend(halves.map(|half| (half, program.clone())));
                continue;
            }
            self.look_down(side, &cell, &program, tolerance, 0.5 * PITCH);
        }
        self.inside.as_ref().map(|inside| side.reach(inside))
    }

    /// Looks for inside points in all of a box, `pitch` apart along all axes, where
    /// that is as little as the budget permits. Returned: how far the part reaches, if
    /// it has nothing thinner than that, and the pitch, if lines may be as thin.
    fn columns(
        &mut self,
        side: BoxSide,
        hull: &Cell,
        program: &Program,
        tolerance: f64,
    ) -> Option<(f64, f64)> {
        /// Distances of points, mm: a line is as thick as the least of them.
        const PITCHES: [f64; 4] = [0.4, 0.8, 1.6, 3.2];
        let [u, v] = [(side.axis + 1) % 3, (side.axis + 2) % 3];
        let face = side.reach(hull);
        let low = side.outward(side.inner_face(hull));
        let known = |search: &Self| {
            let inside = search.inside.as_ref();
            inside.map_or(low, |inside| side.reach(inside).max(low))
        };
        let counts = |pitch: f64| {
            [u, v].map(|axis| (hull.width(axis) / pitch).ceil().max(1.0))
        };
        let work = program.value_work() as f64;
        let known_before = known(self);
        let fits = |pitch: &f64| {
            let [a, b] = counts(*pitch);
            let deep = ((face - known_before) / pitch).max(0.0) + 2.0;
            a * b * deep * work < 4.0 * self.options.max_work as f64
        };
        let pitch = PITCHES.into_iter().find(fits)?;
        let [across, along] = counts(pitch);
        let before = self.scratch.work;
        for i in 0..(across * along) as usize {
            if self.cancel.is_asked() {
                return None;
            }
            let at = [i % across as usize, i / across as usize];
            let mut column = *hull;
            for (axis, (k, count)) in
                [u, v].into_iter().zip(at.into_iter().zip([across, along]))
            {
                let width = hull.width(axis) / count;
                column.lo[axis] = hull.lo[axis] + k as f64 * width;
                column.hi[axis] = column.lo[axis] + width;
            }
            // What rises beyond the known extent by less than the pitch is inside
            // just above that, and what ends with the box right below its end.
            let low = known(self);
            let steps = ((face - low) / pitch).floor().max(0.0) as usize;
            let between = (1..=steps).rev().map(|k| low + k as f64 * pitch);
            let places = std::iter::once(face - tolerance).chain(between);
            let mut p = column.centre();
            for reach in places.chain([low + tolerance]) {
                p[side.axis] = side.outward(reach);
                if program.value(p, &mut self.scratch) < 0.0 {
                    self.creep(side, &column, program, p, tolerance);
                    break;
                }
            }
        }
        // This work has a budget of its own, so that no other side lacks it.
        self.scratch.work = before;
        // Nothing that is printed is as thin as the least pitch.
        Some(if pitch > PITCHES[0] {
            (known(self) + pitch, pitch)
        } else {
            (known(self) + tolerance, 0.0)
        })
    }

    /// Looks for the highest inside point in the middle of a column that ends
    /// at the known extent. The points lie `pitch` apart near that extent, and
    /// farther apart beyond, since a column may reach to the search's end.
    fn look_down(
        &mut self,
        side: BoxSide,
        column: &Cell,
        program: &Program,
        tolerance: f64,
        pitch: f64,
    ) {
        /// Distance of two points, as a share of the way to the known extent.
        const SHARE: f64 = 0.1;
        let (low, face) =
            (side.outward(side.inner_face(column)), side.reach(column));
        let mut p = column.centre();
        // The part often ends where the column does, and is not inside there.
        let mut reach = face - tolerance;
        while reach > low {
            p[side.axis] = side.outward(reach);
            if program.value(p, &mut self.scratch) < 0.0 {
                break;
            }
            reach -= (SHARE * (reach - low)).max(pitch);
        }
        // What rises beyond the known extent by less than the pitch is inside
        // just above that.
        if reach <= low {
            p[side.axis] = side.outward(low + tolerance);
        }
        if program.value(p, &mut self.scratch) < 0.0 {
            self.creep(side, column, program, p, tolerance);
        }
    }

    /// Moves the known extent outwards within a column, from an inside point
    /// `p`, towards the highest point near by.
    fn creep(
        &mut self,
        side: BoxSide,
        column: &Cell,
        program: &Program,
        mut p: [f64; 3],
        tolerance: f64,
    ) {
        /// Halvings of the steps, from the column's width.
        const HALVINGS: i32 = 12;
        self.note_inside(p);
        self.climb(side, program, p, side.reach(column));
        for (k, n) in (1..=HALVINGS).flat_map(|k| (0..4).map(move |n| (k, n))) {
            let Some(inside) = &self.inside else { return };
            let axis = (side.axis + 1 + n % 2) % 3;
            let step = column.width(axis) * 0.5_f64.powi(k);
            let mut q = p;
            q[axis] += if n < 2 { step } else { -step };
            q[axis] = q[axis].clamp(column.lo[axis], column.hi[axis]);
            q[side.axis] = side.outward(side.reach(inside) + tolerance);
            if program.value(q, &mut self.scratch) < 0.0 {
                self.note_inside(q);
                self.climb(side, program, q, side.reach(column));
                p = q;
            }
        }
    }

    /// The error if nothing is inside any of the parts.
    fn nothing(&mut self, parts: &[Part]) -> BoundsError {
        match parts.first() {
            Some(part) => self.empty(&part.program),
            None => BoundsError::Empty {
                searched: self.searched(),
                cause: None,
            },
        }
    }

    /// Looks for inside points far out, so that the search begins with a known
    /// extent. Where the part ends in a plateau, or the given bounds cut it,
    /// many boxes reach equally far. A search of the deepest first could then
    /// spend its budget on the corner where it begins.
    fn probe(
        &mut self,
        side: BoxSide,
        program: &Program,
        tolerance: f64,
        budget: u64,
    ) {
        /// Points along each of the face's two axes, for a long program.
        const FEW: usize = 2;
        /// Points along each of these axes, for any other program.
        const MANY: usize = 8;
        /// Depths below the face, as shares of the region; the face first.
        const DEPTHS: [f64; 4] = [0.0, 0.02, 0.1, 0.3];
        let short = program.len() as u64 * CLIMB < budget;
        let across = if short { MANY } else { FEW };
        // The points avoid middles and quarters, since fields are often 0 or
        // NaN in planes of symmetry.
        let part = |i: usize| (i as f64 + 0.38) / across as f64;
        let region = self.region;
        let stop = self.scratch.work + budget / 8;
        let face = side.reach(&region);
        let [u, v] = [(side.axis + 1) % 3, (side.axis + 2) % 3];
        for depth in DEPTHS {
            let reach = face - depth * region.width(side.axis);
            for i in 0..across * across {
                if self.is_over(stop) {
                    return;
                }
                let known = self.inside.as_ref().map(|c| side.reach(c));
                if known.is_some_and(|k| reach <= k + tolerance) {
                    return;
                }
                let mut p = region.lo;
                p[side.axis] = side.outward(reach);
                p[u] += part(i % across) * region.width(u);
                p[v] += part(i / across) * region.width(v);
                if program.value(p, &mut self.scratch) < 0.0 {
                    self.note_inside(p);
                    if short {
                        self.climb(side, program, p, face);
                    }
                }
            }
        }
        if self.inside.is_none() {
            self.scatter(program, stop);
        }
    }

    /// Looks for any inside point. All rows of points may meet the holes of a
    /// part that repeats itself, such as a sponge. These points do not repeat.
    fn scatter(&mut self, program: &Program, stop: u64) {
        const POINTS: u32 = 4096;
        /// The sequence R₃ of M. Roberts (2018): powers of the inverse of
        /// the root of x⁴ = x + 1.
        const STEPS: [f64; 3] =
            [0.819_172_513_396, 0.671_043_606_703, 0.549_700_477_901];
        for n in 0..POINTS {
            if self.is_over(stop) {
                return;
            }
            let region = self.region;
            let p = std::array::from_fn(|i| {
                let part = (0.5 + f64::from(n) * STEPS[i]).fract();
                region.lo[i] + part * region.width(i)
            });
            if program.value(p, &mut self.scratch) < 0.0 {
                self.note_inside(p);
                return;
            }
        }
    }

    /// Moves the known extent outwards from an inside point to a surface.
    fn climb(
        &mut self,
        side: BoxSide,
        program: &Program,
        start: [f64; 3],
        reach: f64,
    ) {
        let at = |v: f64| {
            let mut p = start;
            p[side.axis] = v;
            p
        };
        let mut inner = start[side.axis];
        let mut outer = side.outward(reach);
        if program.value(at(outer), &mut self.scratch) < 0.0 {
            self.note_inside(at(outer));
            return;
        }
        // Halving until f64 has no number in between.
        for _ in 0..64 {
            let middle = 0.5 * (inner + outer);
            if middle == inner || middle == outer {
                break;
            }
            if program.value(at(middle), &mut self.scratch) < 0.0 {
                inner = middle;
            } else {
                outer = middle;
            }
        }
        self.note_inside(at(inner));
    }
}

/// The roundest decimal within [lo, hi], down to 0.001, or else `hi`.
///
/// The model's extent is known to lie in the interval, but not where. Nearly
/// every drawn part ends at a multiple of a micrometre. Where the interval
/// holds such a number, it is the likeliest one: a cube of 20 mm reads 20 and
/// not 20.00002.
fn simplest_between(lo: f64, hi: f64) -> f64 {
    for scale in [1.0, 10.0, 100.0, 1000.0] {
        // The extent is a point inside. The surface is there or beyond, but f64
        // may have rounded the point over the decimal.
        let v = ((lo - 1e-11 * lo.abs()) * scale).ceil() / scale;
        if v <= hi {
            // This avoids a negative zero.
            return v + 0.0;
        }
    }
    hi
}

#[cfg(test)]
mod tests {
    use super::super::{SearchOptions, flattened};
    use super::*;
    use crate::cancel::Cancel;
    use crate::program::Scratch;
    use fidget::context::Tree;

    /// All rows of points that are looked at from a face lie in the slots
    /// between blocks.
    #[test]
    fn a_point_is_found_where_all_rows_meet_holes() {
        let slots = |axis: Tree| 1.0 - (axis.modulo(10.0) - 3.8).abs();
        let (x, y, z) = Tree::axes();
        let tree = slots(x).max(slots(y)).max(slots(z));
        let bounds = Bounds {
            min: DVec3::ZERO,
            max: DVec3::splat(80.0),
        };
        let options = SearchOptions {
            within: Some(bounds),
            ..SearchOptions::default()
        };
        let program = flattened(&tree).unwrap();
        let mut search = Search::new(&options, &Cancel::NEVER).unwrap();
        search.probe(BoxSide::all()[0], &program, 1e-4, options.max_work);
        let found = search.inside.expect("a point inside").centre();
        assert!(program.value(found, &mut Scratch::default()) < 0.0);
    }

    /// A bowl in a region that is far larger, whose boxes nothing is proved of.
    #[test]
    fn columns_find_how_far_a_part_reaches() {
        let (x, y, z) = Tree::axes();
        let out = (x.square() + y.square() + z.square()).sqrt() - 9.0;
        let bowl = out.max(z.clone() - 4.0 - 0.1 * (x * 2.0).sin());
        let program = flattened(&bowl).unwrap();
        let options = SearchOptions::default();
        // A plate far beside it is thinner than a tenth of the way to it.
        let (x, y, z) = Tree::axes();
        let plate = (x - 23.0).abs() - 0.4;
        let plate = plate.max(y.abs() - 6.0).max(z.abs() - 3.0);
        let both = flattened(&bowl.min(plate)).unwrap();
        let mut search = Search::new(&options, &Cancel::NEVER).unwrap();
        let hull = Cell {
            lo: [-30.0; 3],
            hi: [30.0; 3],
        };
        search.note_inside([0.1, 0.2, 0.3]);
        let up = BoxSide { axis: 0, up: true };
        let found = search.columns(up, &hull, &both, 1e-4).unwrap();
        assert!((found.0 - 23.4).abs() < 1e-3 && found.1 < 0.5, "{found:?}");
        for (half, off) in [(30.0, 1e-3), (50.0, 1e-3), (500.0, 3.3)] {
            for (side, true_reach) in BoxSide::all()
                .into_iter()
                .zip([9.0, 4.1, 9.0, 9.0, 9.0, 9.0])
            {
                let mut search = Search::new(&options, &Cancel::NEVER).unwrap();
                let region = Cell {
                    lo: [-half; 3],
                    hi: [half; 3],
                };
                search.region = region;
                search.note_inside([0.1, 0.2, 0.3]);
                let found = search.columns(side, &region, &program, 1e-4);
                let Some((found, _)) = found else {
                    assert!(half > 100.0);
                    continue;
                };
                let more = found - true_reach;
                assert!((0.0..off).contains(&more), "{half} {found}");
                assert_eq!(search.scratch.work, 0);
            }
        }
    }
}
