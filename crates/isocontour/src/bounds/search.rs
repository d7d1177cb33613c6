//! The state of a search, and its coarse beginning: proofs over a grid narrow
//! the region in which the field may be negative.

use super::side::BoxSide;
use super::undefined::{Undefined, undefined};
use super::{Bounds, BoundsError, SearchOptions};
use crate::cancel::Cancel;
use crate::cell::Cell;
use crate::program::{Program, Scratch};
use std::collections::VecDeque;
use std::rc::Rc;

/// Operations beyond which a program is long.
const LONG: usize = 20_000;

/// A part of the region, and the program simplified for it.
pub(super) struct Part {
    pub cell: Cell,
    pub program: Rc<Program>,
}

/// A search for the box of {f < 0}.
pub(super) struct Search<'a> {
    pub options: &'a SearchOptions,
    pub cancel: &'a Cancel,
    pub scratch: Scratch,
    /// Where f may be negative.
    pub region: Cell,
    /// Box of the points known to be inside.
    pub inside: Option<Cell>,
    /// How far apart points are that were looked at in place of a proof, mm.
    pub pitch: f64,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        options: &'a SearchOptions,
        cancel: &'a Cancel,
    ) -> Result<Self, BoundsError> {
        let region = match options.within {
            None => Cell {
                lo: [-options.limit_mm; 3],
                hi: [options.limit_mm; 3],
            },
            Some(Bounds { min, max }) => {
                let ok =
                    min.is_finite() && max.is_finite() && min.cmplt(max).all();
                if !ok {
                    return Err(BoundsError::NoBox { min, max });
                }
                Cell {
                    lo: min.to_array(),
                    hi: max.to_array(),
                }
            }
        };
        Ok(Self {
            options,
            cancel,
            scratch: Scratch::default(),
            region,
            inside: None,
            pitch: 0.0,
        })
    }

    /// Makes this a search for a slice of a model that is equal at every
    /// height.
    pub(super) fn of_a_slice(mut self) -> Self {
        (self.region.lo[2], self.region.hi[2]) = (-0.5, 0.5);
        self
    }

    /// True if more work was done than `most`, or if the search has to stop. It
    /// then ends as when its budget ends.
    pub(super) fn is_over(&self, most: u64) -> bool {
        self.scratch.work > most || self.cancel.is_asked()
    }

    /// The space that is searched, in words.
    pub(super) fn searched(&self) -> String {
        match self.options.within {
            None => format!("±{} mm", self.options.limit_mm),
            Some(_) => "the given bounds".to_owned(),
        }
    }

    /// What makes the field NaN somewhere, if something does.
    ///
    /// # Errors
    /// If the field is NaN everywhere.
    fn undefined(
        &mut self,
        program: &Program,
    ) -> Result<Option<String>, BoundsError> {
        let searched = self.searched();
        let Undefined { share, cause } =
            undefined(program, self.options, self.cancel, &mut self.scratch);
        match cause {
            Some(cause) if share == 1.0 => {
                Err(BoundsError::NotANumber { searched, cause })
            }
            cause => Ok(cause),
        }
    }

    /// The error if nothing is inside, with the cause.
    pub(super) fn empty(&mut self, program: &Program) -> BoundsError {
        let searched = self.searched();
        match self.undefined(program) {
            Ok(cause) => BoundsError::Empty { searched, cause },
            Err(error) => error,
        }
    }

    /// Narrows the region as far as coarse proofs go. Returns what is left of
    /// it, with the program simplified for each part.
    pub(super) fn narrow(
        &mut self,
        program: Rc<Program>,
    ) -> Result<Vec<Part>, BoundsError> {
        let all = program.enclose(&self.region, &mut self.scratch);
        if all.is_outside() {
            return Err(self.empty(&program));
        }
        if all.range.hi < 0.0 && !all.range.nan && self.options.within.is_none()
        {
            return Err(BoundsError::EverythingInside {
                limit_mm: self.options.limit_mm,
            });
        }
        self.look_far(&program)?;
        let program = self.peel(program);
        if program.len() > LONG {
            self.shards(program)
        } else {
            Ok(vec![Part {
                program: self.sift(program)?,
                cell: self.region,
            }])
        }
    }

    /// The error where the ranges do not tell how far the part reaches. A field
    /// that has no values at all has an error of its own.
    pub(super) fn undecided(
        &mut self,
        side: BoxSide,
        program: &Program,
    ) -> BoundsError {
        let direction = side.name();
        let undecided = BoundsError::Undecided { direction };
        self.undefined(program).err().unwrap_or(undecided)
    }

    /// Looks at the middle of each far side. A model that is solid there is
    /// unbounded.
    fn look_far(&mut self, program: &Program) -> Result<(), BoundsError> {
        if self.options.within.is_some() {
            return Ok(());
        }
        for side in BoxSide::all() {
            let mut point = self.region.centre();
            point[side.axis] = side.outward(side.reach(&self.region));
            if point[side.axis].abs() >= self.options.limit_mm
                && program.value(point, &mut self.scratch) < 0.0
            {
                return Err(BoundsError::Unbounded {
                    direction: side.name(),
                    at_mm: point[side.axis],
                    flipped: false,
                });
            }
        }
        Ok(())
    }

    /// Divides the region among boxes in which far less of a long program
    /// counts, as of a union of thousands. Each side of the model is then
    /// looked for with these short programs.
    fn shards(
        &mut self,
        program: Rc<Program>,
    ) -> Result<Vec<Part>, BoundsError> {
        /// Greatest number of times that a region is halved.
        const DEPTH: u32 = 9;
        let most = self.scratch.work + self.options.max_work / 3;
        let short = program.len() / 64;
        let whole = program.clone();
        let mut parts: Vec<Part> = Vec::new();
        let mut todo = VecDeque::from([(self.region, program, 0)]);
        while let Some((cell, program, depth)) = todo.pop_front() {
            if self.is_over(most) {
                parts.push(Part { cell, program });
                continue;
            }
            let f = program.enclose(&cell, &mut self.scratch);
            if f.is_outside() {
                continue;
            }
            if f.centre < 0.0 {
                self.note_inside(cell.centre());
            }
            let program = program.simplified(&self.scratch);
            if depth == DEPTH || program.len() <= short {
                parts.push(Part { cell, program });
                continue;
            }
            for half in cell.split(cell.widest_axis()) {
                todo.push_back((half, program.clone(), depth + 1));
            }
        }
        let hull = parts.iter().map(|p| p.cell).reduce(|a, b| a.joined(&b));
        self.region = hull.ok_or_else(|| self.empty(&whole))?;
        Ok(parts)
    }

    /// Takes slabs off the region's sides as long as one of them is proved to
    /// be empty. Whatever the program's size, few boxes are needed for much of
    /// the region.
    fn peel(&mut self, mut program: Rc<Program>) -> Rc<Program> {
        /// Shares of the way from the middle to the side that are left, the
        /// greatest gain first.
        const LEAVES: [f64; 4] =
            [1.0 / 4096.0, 1.0 / 64.0, 1.0 / 8.0, 1.0 / 2.0];
        let most = self.scratch.work + self.options.max_work / 8;
        let mut least = 0;
        loop {
            let mut peeled = false;
            // A share that could not be taken off once is not tried again.
            let mut best = LEAVES.len();
            let centre = self.region.centre();
            for side in BoxSide::all() {
                if self.region.width(side.axis) <= 1e-6 {
                    continue;
                }
                for (nth, leave) in LEAVES.iter().enumerate().skip(least) {
                    if self.is_over(most) {
                        return program;
                    }
                    let middle = side.outward(centre[side.axis]);
                    let reach =
                        middle + leave * (side.reach(&self.region) - middle);
                    let mut slab = self.region;
                    side.clip(&mut slab, reach);
                    let f = program.enclose(&slab, &mut self.scratch);
                    if f.is_outside() {
                        side.set_reach(&mut self.region, reach);
                        peeled = true;
                        best = best.min(nth);
                        break;
                    }
                }
            }
            if !peeled {
                return program;
            }
            least = best;
            program.enclose(&self.region, &mut self.scratch);
            program = program.simplified(&self.scratch);
        }
    }

    /// Narrows the region to the hull of the boxes of a grid that may hold some
    /// of the model, as long as that helps.
    fn sift(
        &mut self,
        mut program: Rc<Program>,
    ) -> Result<Rc<Program>, BoundsError> {
        /// Cells per axis. A round removes three quarters of the region round
        /// an off-centre model, and half round a centred one.
        const GRID: usize = 4;
        loop {
            let edge = |axis: usize, i: usize| {
                // The ends are taken exactly, so that rounding opens no gap.
                match i {
                    0 => self.region.lo[axis],
                    GRID => self.region.hi[axis],
                    _ => {
                        let t = i as f64 / GRID as f64;
                        self.region.lo[axis] * (1.0 - t)
                            + self.region.hi[axis] * t
                    }
                }
            };
            let edges: [[f64; GRID + 1]; 3] =
                std::array::from_fn(|a| std::array::from_fn(|i| edge(a, i)));
            let mut hull: Option<Cell> = None;
            for i in 0..GRID * GRID * GRID {
                if self.cancel.is_asked() {
                    break;
                }
                let at = [i % GRID, i / GRID % GRID, i / GRID / GRID];
                let cell = Cell {
                    lo: std::array::from_fn(|a| edges[a][at[a]]),
                    hi: std::array::from_fn(|a| edges[a][at[a] + 1]),
                };
                let f = program.enclose(&cell, &mut self.scratch);
                if f.is_outside() {
                    continue;
                }
                if f.centre < 0.0 {
                    self.note_inside(cell.centre());
                }
                hull = Some(hull.map_or(cell, |h| h.joined(&cell)));
            }
            let Some(hull) = hull else {
                return Err(self.empty(&program));
            };
            let shrunk =
                (0..3).any(|i| hull.width(i) < 0.9 * self.region.width(i));
            self.region = hull;
            // Without this a region like a point would be halved for ever.
            let tiny = (0..3)
                .all(|i| hull.width(i) <= 1e-9 * (1.0 + hull.lo[i].abs()));
            if tiny || self.scratch.work > self.options.max_work {
                return Ok(program);
            }
            if !shrunk && !self.shave(&program) {
                return Ok(program);
            }
            program.enclose(&self.region, &mut self.scratch);
            program = program.simplified(&self.scratch);
        }
    }

    /// Takes slabs off the sides of a region that is larger than any part, if
    /// they are proved to be empty box by box. Where a model is twisted, a box
    /// far out is proved to be empty only if it spans little of a turn. Returns
    /// true if a slab was taken off.
    fn shave(&mut self, program: &Program) -> bool {
        /// Width of a region that is larger than any part. Smaller ones are
        /// left to the search for the sides, which is quick there.
        const LARGE: f64 = 2000.0;
        /// Share of the region's width that a slab has.
        const SLAB: f64 = 0.25;
        let mut shaved = false;
        for side in BoxSide::all() {
            let width = self.region.width(side.axis);
            if width < LARGE {
                continue;
            }
            let reach = side.reach(&self.region) - SLAB * width;
            let mut slab = self.region;
            side.clip(&mut slab, reach);
            if self.is_empty(program, slab) {
                side.set_reach(&mut self.region, reach);
                shaved = true;
            }
        }
        shaved
    }

    /// True if a box is proved to be empty, divided a few times.
    fn is_empty(&mut self, program: &Program, whole: Cell) -> bool {
        /// Greatest number of times that a box is halved.
        const DEPTH: u32 = 12;
        /// Greatest number of boxes that are looked at.
        const BOXES: usize = 1000;
        let mut todo = vec![(whole, 0)];
        let mut looked_at = 0;
        while let Some((cell, depth)) = todo.pop() {
            let f = program.enclose(&cell, &mut self.scratch);
            if f.is_outside() {
                continue;
            }
            looked_at += 1;
            if depth == DEPTH
                || looked_at > BOXES
                || f.centre < 0.0
                || self.is_over(self.options.max_work / 4)
            {
                return false;
            }
            // Steepness is mostly infinite in boxes as large as these, so the
            // axes take turns.
            let share = |axis: usize| cell.width(axis) / whole.width(axis);
            let widest = |a: &usize, b: &usize| share(*a).total_cmp(&share(*b));
            let axes = (0..3).filter(|&axis| f.steepness[axis] != 0.0);
            let Some(across) = axes.max_by(widest) else {
                return false;
            };
            todo.extend(cell.split(across).map(|half| (half, depth + 1)));
        }
        true
    }

    /// Notes that a point is inside the model.
    pub(super) fn note_inside(&mut self, p: [f64; 3]) {
        let point = Cell { lo: p, hi: p };
        let known = self.inside;
        self.inside = Some(known.map_or(point, |known| known.joined(&point)));
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SearchOptions, find_bounds};
    use crate::cancel::Cancel;
    use fidget::context::Tree;
    use glam::DVec3;

    /// Far out no box that spans much of a turn is proved to be empty.
    #[test]
    fn a_twisted_column_is_found_from_afar() {
        let (x, y, z) = Tree::axes();
        let turn = z.clone() * (std::f32::consts::TAU / 120.0);
        let (c, s) = (turn.cos(), turn.sin());
        let u = x.clone() * c.clone() + y.clone() * s.clone();
        let v = y * c - x * s;
        // A square of 20 mm with round corners of 3 mm.
        let (u, v) = (u.abs() - 7.0, v.abs() - 7.0);
        let corner = u.max(0.0).square() + v.max(0.0).square();
        let square = corner.sqrt() + u.max(v).min(0.0) - 3.0;
        let column = square.max((z - 25.0).abs() - 25.0);
        let options = SearchOptions {
            max_work: 4_000_000,
            ..SearchOptions::default()
        };
        let found = find_bounds(&column, &options, &Cancel::NEVER).unwrap();
        assert!(found.slack_mm < 1e-4, "{found:?}");
        let reach = 7.0 * 2_f64.sqrt() + 3.0;
        let [low, high] = [
            DVec3::new(-reach, -reach, 0.0),
            DVec3::new(reach, reach, 50.0),
        ];
        for (found, exact) in
            [(found.bounds.min, low), (found.bounds.max, high)]
        {
            assert!((found - exact).abs().max_element() < 1e-4, "{found}");
        }
    }
}
