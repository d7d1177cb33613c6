//! How level the surface f = 0 is at each height, proved, and where it is
//! exactly level.
//!
//! In: an expression, a box, and the length of the bins into which its height
//! is cut. Out: for each bin an upper bound of |n_z|, the vertical part of the
//! surface's unit normal, on all of the surface within the bin, and the heights
//! of level faces, which the bounds leave out.
//!
//! How: boxes are evaluated with intervals of f's slopes and cut in two, as
//! long as they may hold some of the surface. Those that may be the most level
//! come first. Since |n_z| = |f_z| / |∇f|, the ranges of the slopes bound it,
//! for each of the surfaces of which f = 0 consists there
//! (`program::surfaces`). A box is done when it is less level than the options
//! ask for, when its bins are known to be as level as the box, or when its
//! bound is within 4 % of its least value. Where a surface consists of parts that
//! data tells, such as a mesh's triangles, these parts bound it instead (`facets`).
//! A surface whose slopes along x and y
//! are exactly 0 is level. Its height is found by bisection, and counts if f
//! changes its sign there.
//!
//! An angle (`atan2`) jumps by a turn. Where it does so on an upright face, as
//! that of a screw along z does, a box on the face is looked at once for each
//! side (`program::piece`).
//!
//! Guarantees: the result is deterministic, and the work is bounded. Surface
//! that cannot be bounded, for lack of work or because f has a kink, jumps or
//! is NaN, counts as level (1). Within `tolerance` of a level face or of the
//! box's top and bottom it does not count: no layer that ends there is wrong by
//! more than that.
//!
//! A level face that two bodies share does not show, and does not count.
//!
//! Not guaranteed: level faces smaller than some 0.1 mm may be missed as such.
//! The bounds hold all the same, and then count the face as level. A ledge that
//! is narrower than that, where two bodies share a face, may not count at all.

mod facets;
mod slopes;

use crate::cancel::{Cancel, Cancelled};
use crate::ceiling::uncapped;
use crate::cell::Cell;
use crate::expand::{ExpandError, expand};
use crate::program::{Program, Scratch, Surface};
use crate::{Bounds, Length};
use facets::{Facets, Parts};
use fidget::context::Tree;
use slopes::{Known, known};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

/// How a surface's lean is looked for.
#[derive(Clone, Copy, Debug)]
pub struct LeanOptions {
    /// Height of a bin.
    pub bin: Length,
    /// |n_z| up to which it does not matter how level the surface is.
    pub enough: f64,
    /// |n_z| from which on it does not matter how level the surface is.
    pub most: f64,
    /// Height that does not matter beside a level face.
    pub tolerance: Length,
    /// The range of bins to look at. All other bins keep `enough`.
    pub bins: (usize, usize),
    /// Budget, in interval operations.
    pub max_work: u64,
}

/// How level a surface is, by height.
#[derive(Clone, Debug, PartialEq)]
pub struct Lean {
    /// The lower end of the first bin.
    pub bottom: Length,
    /// Height of a bin; the last one may reach beyond the box.
    pub bin: Length,
    /// For each bin, a bound of |n_z|, at least [`LeanOptions::enough`].
    pub most_level: Vec<f64>,
    /// Heights of level faces, from the lowest to the highest.
    pub faces: Vec<Length>,
    /// Height of all bins together in which something was not proved and counts
    /// as level.
    pub unproved: Length,
    /// Height of those bins of them in which the surface may be as level as
    /// [`LeanOptions::most`] for all that was proved.
    pub unknown: Length,
}

impl Lean {
    /// Number of bins of the height `bin` in a box.
    pub fn count(bounds: &Bounds, bin: Length) -> usize {
        (bounds.size().z / bin - 1e-9).ceil().max(1.0) as usize
    }

    /// The results of two looks at different bins as one.
    #[must_use]
    pub fn joined(mut self, other: Lean) -> Lean {
        for (a, b) in self.most_level.iter_mut().zip(other.most_level) {
            *a = a.max(b);
        }
        self.faces.extend(other.faces);
        self.faces.sort_by(f64::total_cmp);
        self.faces.dedup_by(|b, a| *b - *a <= SAME);
        self.unproved += other.unproved;
        self.unknown += other.unknown;
        self
    }
}

/// Why there is no lean.
#[derive(Debug, thiserror::Error, PartialEq)]
#[non_exhaustive]
pub enum LeanError {
    /// The search was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The expression is unusable.
    #[error(transparent)]
    Expression(#[from] ExpandError),
}

/// Number of bins of a slab. Slabs are searched one by one.
const SLAB_BINS: usize = 64;
/// Greatest number of bins of a box that may be done.
const DONE_BINS: f64 = 2.0;
/// Size below which a box is not cut across x or y.
const THIN: Length = 0.02;
/// Share of a bound that is slack.
const BOUND_SLACK: f64 = 0.04;
/// How far above and below a level face it is asked what is solid, as a share
/// of the height and of 1.
const OFF_FACE: f64 = 1e-7;
/// Width of a cell at the border of two bodies that share a level face, up to
/// which the cell's corners tell whether the face shows in it.
const NARROW: Length = 0.1;
/// Distance below which two faces are one.
const SAME: Length = 1e-5;

/// Finds how level the surface f = 0 is within `bounds`.
///
/// # Errors
/// If the expression is unusable, or `cancel` asked to stop.
pub fn lean(
    tree: &Tree,
    bounds: &Bounds,
    options: &LeanOptions,
    cancel: &Cancel,
) -> Result<Lean, LeanError> {
    let (mut context, root) = expand(tree)?;
    let root = uncapped(&mut context, root);
    let program =
        Program::new(&context, root).map_err(|_| ExpandError::FreeVariable)?;
    let (bottom, top) = (bounds.min.z, bounds.max.z);
    let count = Lean::count(bounds, options.bin);
    let (first, last) = (options.bins.0, options.bins.1.min(count));
    let program = Rc::new(program);
    let mut search = Search {
        options,
        root: program.clone(),
        bottom,
        found: vec![options.enough; count],
        faces: Vec::new(),
        joints: Vec::new(),
        doubts: Vec::new(),
        margin: 1e-9 * (1.0 + bounds.size().max_element()),
        scratch: Scratch::sharp(),
        aside: Scratch::sharp(),
    };
    let whole = Cell {
        lo: bounds.min.to_array(),
        hi: bounds.max.to_array(),
    };
    let slabs = last.saturating_sub(first).div_ceil(SLAB_BINS);
    for slab in 0..slabs {
        let from = first + slab * SLAB_BINS;
        let to = (from + SLAB_BINS).min(last);
        let end = |i: usize| bottom + i as f64 * options.bin;
        let mut cell = whole;
        if from > 0 {
            cell.lo[2] = end(from);
        }
        if to < count {
            cell.hi[2] = end(to);
        }
        let left = options.max_work.saturating_sub(search.scratch.work);
        let most = search.scratch.work + left / (slabs - slab) as u64;
        search.slab(cell, &program, most, cancel)?;
    }
    Ok(search.finish(top))
}

struct Search<'a> {
    options: &'a LeanOptions,
    /// The whole function, which holds everywhere.
    root: Rc<Program>,
    bottom: Length,
    found: Vec<f64>,
    faces: Vec<Length>,
    /// Heights of level faces that two bodies share, which are none of the
    /// whole.
    joints: Vec<Length>,
    /// Heights between which something was not proved, each with its bound.
    doubts: Vec<([Length; 2], f64)>,
    /// By how much a cell is looked at beyond its border. The surface may run
    /// along that border, and intervals are not rounded outwards.
    margin: Length,
    scratch: Scratch,
    /// Memory for looking at other cells while one is being looked at.
    aside: Scratch,
}

/// A cell to be cut.
struct Open {
    cell: Cell,
    program: Rc<Program>,
    parts: Parts,
    /// Bound of |n_z| for all that is not exactly level.
    most: f64,
    /// True if some of the surface in the cell is exactly level, at a height
    /// that is not known yet.
    has_faces: bool,
    axis: usize,
    number: u64,
}

impl Ord for Open {
    /// The most level cell comes first, and of equally level ones the oldest.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_level = self.most.total_cmp(&other.most);
        by_level.then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl Open {
    /// Bound of |n_z| if nothing more is found.
    fn worst(&self) -> f64 {
        if self.has_faces { 1.0 } else { self.most }
    }
}

impl Search<'_> {
    /// The bins that a cell reaches into.
    fn bins(&self, lo: Length, hi: Length) -> std::ops::Range<usize> {
        /// Distance below which a cell only touches a bin, and is not in it,
        /// whatever the rounding.
        const TOUCH: f64 = 1e-7;
        let at = |z: Length| (z - self.bottom) / self.options.bin;
        let last = self.found.len() - 1;
        let first = ((at(lo) + TOUCH).max(0.0) as usize).min(last);
        let end = (at(hi) - TOUCH).max(0.0).ceil() as usize;
        first..end.clamp(first + 1, last + 1)
    }

    /// The least bound of some bins so far.
    fn least_of(&self, cell: &Cell) -> f64 {
        let bins = self.bins(cell.lo[2], cell.hi[2]);
        self.found[bins].iter().fold(1.0, |a: f64, b| a.min(*b))
    }

    fn raise(&mut self, lo: Length, hi: Length, to: f64) {
        let bins = self.bins(lo, hi);
        // From `most` on it does not matter how level the surface is.
        let to = if to >= self.options.most { 1.0 } else { to };
        for found in &mut self.found[bins] {
            *found = found.max(to);
        }
    }

    fn slab(
        &mut self,
        whole: Cell,
        program: &Rc<Program>,
        most: u64,
        cancel: &Cancel,
    ) -> Result<(), Cancelled> {
        let mut todo = BinaryHeap::new();
        let mut number = 0;
        let parts: Parts = Rc::new([]);
        self.look(whole, program, &parts, number, &mut todo);
        while let Some(open) = todo.pop() {
            if number.is_multiple_of(256) {
                cancel.check()?;
            }
            let least = self.least_of(&open.cell);
            if open.most <= least * (1.0 + BOUND_SLACK) && !open.has_faces {
                // No open cell is more level, so this cannot add up.
                self.raise(open.cell.lo[2], open.cell.hi[2], open.most);
                continue;
            }
            if self.scratch.work >= most {
                let ends = [open.cell.lo[2], open.cell.hi[2]];
                self.doubts.push((ends, open.worst()));
                continue;
            }
            for half in open.cell.split(open.axis) {
                number += 1;
                self.look(half, &open.program, &open.parts, number, &mut todo);
            }
        }
        Ok(())
    }

    /// Looks at a cell, and notes it to be cut if it has to be.
    fn look(
        &mut self,
        cell: Cell,
        program: &Rc<Program>,
        parts: &Parts,
        number: u64,
        todo: &mut BinaryHeap<Open>,
    ) {
        let seen = Cell {
            lo: cell.lo.map(|v| v - self.margin),
            hi: cell.hi.map(|v| v + self.margin),
        };
        let f = program.enclose(&seen, &mut self.scratch);
        let outside = f.range.is_empty() || f.range.lo >= 0.0;
        if outside || (f.range.hi < 0.0 && !f.range.nan) {
            return;
        }
        let (others, facets) = match program.surfaces(&self.scratch) {
            Some(all) if program.has_data() => {
                let (others, facets) =
                    self.facets(&cell, &seen, program, all, parts);
                (Some(others), facets)
            }
            all => (all, Facets::default()),
        };
        let mut known = known(others);
        // Triangles are told of a box however wide it is.
        let is_wide_enough = !facets.parts.is_empty()
            && known.level.is_empty()
            && known.most <= self.least_of(&cell);
        let mut has_faces = !self.level_faces(&seen, program, &known.level);
        if cell.width(2) > DONE_BINS * self.options.bin {
            known.most = known.most.max(facets.most);
            has_faces |= facets.has_faces;
        }
        if !has_faces && self.is_done(&cell, &known) {
            return;
        }
        // What f jumps by is upright, so both sides of it are all there is.
        let sides = program.by_upright_turns(&self.scratch);
        if !sides.is_empty() {
            for side in sides {
                self.look(cell, &Rc::new(side), parts, number, todo);
            }
            return;
        }
        let Some(axis) = self.axis(&cell, &known, is_wide_enough) else {
            let worst = if has_faces { 1.0 } else { known.most };
            self.doubts.push(([cell.lo[2], cell.hi[2]], worst));
            return;
        };
        todo.push(Open {
            cell,
            parts: if facets.parts.is_empty() {
                parts.clone()
            } else {
                facets.parts.into()
            },
            program: program.simplified(&self.scratch),
            most: known.most,
            has_faces,
            axis,
            number,
        });
    }

    /// Notes what is known of a cell, and returns true if that suffices.
    fn is_done(&mut self, cell: &Cell, known: &Known) -> bool {
        if known.most <= self.least_of(cell) {
            return true;
        }
        let close = known.most - known.least <= BOUND_SLACK * known.most;
        let level = known.least >= self.options.most;
        let thin = cell.width(2) <= DONE_BINS * self.options.bin;
        let done = thin && (close || level);
        if done {
            self.raise(cell.lo[2], cell.hi[2], known.most);
        }
        done
    }

    /// True if all level faces in a cell are known now.
    fn level_faces(
        &mut self,
        cell: &Cell,
        program: &Program,
        level: &[Surface],
    ) -> bool {
        let [x, y, _] = cell.centre();
        level.iter().all(|surface| {
            let Some(z) = self.height(cell, program, surface) else {
                // The surface does not reach into the cell, or does so more
                // than once.
                return cell.width(2) <= self.options.tolerance
                    || !self.reaches(cell, program, surface);
            };
            let is_in = |all: &[Length]| {
                all.iter().any(|other| (other - z).abs() <= SAME)
            };
            if is_in(&self.faces) {
                return true;
            }
            // The face is a part of f = 0 if f changes its sign there.
            let step = OFF_FACE * (1.0 + z.abs());
            let [below, at, above] = [z - step, z, z + step].map(|z| {
                program.beside(surface, [x, y, z], &mut self.scratch)[0]
            });
            if (below < 0.0) != (above < 0.0) {
                self.faces.push(z);
                return true;
            }
            // Two bodies meet where f is negative on both sides of its zero.
            let meet = at.abs() < 0.5 * below.max(above).abs();
            if below < 0.0 && meet && !is_in(&self.joints) {
                self.joints.push(z);
            }
            is_in(&self.joints) && self.is_joint(cell, program, z)
        })
    }

    /// True if f has one sign just below the height `z` and just above it, all
    /// over a cell. That is proved only where both are inside. At the border a
    /// cell that is narrower than [`NARROW`] is judged by its corners.
    fn is_joint(&mut self, cell: &Cell, program: &Program, z: Length) -> bool {
        let step = OFF_FACE * (1.0 + z.abs());
        let sides = [z - step, z + step];
        let before = self.aside.work;
        let mut solid = sides.iter().all(|&z| {
            let mut slab = *cell;
            (slab.lo[2], slab.hi[2]) = (z, z);
            let f = program.enclose(&slab, &mut self.aside).range;
            f.hi < 0.0 && !f.nan
        });
        if !solid && cell.width(0).max(cell.width(1)) <= NARROW {
            let corners = [cell.lo, cell.hi].map(|[x, y, _]| [x, y]);
            solid = [0, 1, 2, 3].iter().all(|k| {
                let (x, y) = (corners[k % 2][0], corners[k / 2][1]);
                let [below, above] = sides
                    .map(|z| program.value([x, y, z], &mut self.aside) < 0.0);
                below == above
            });
        }
        self.scratch.work += self.aside.work - before;
        solid
    }

    /// True if a level surface may be in a cell although it has one sign at the
    /// cell's top and bottom: it may be there twice.
    fn reaches(
        &mut self,
        cell: &Cell,
        program: &Program,
        surface: &Surface,
    ) -> bool {
        let slope = surface.slope[2];
        let steady = slope.lo > 0.0 || slope.hi < 0.0;
        let [x, y, _] = cell.centre();
        let [a, b] = [cell.lo[2], cell.hi[2]]
            .map(|z| program.beside(surface, [x, y, z], &mut self.scratch)[1]);
        !(steady && a * b > 0.0)
    }

    /// The height at which a level surface crosses a cell.
    fn height(
        &mut self,
        cell: &Cell,
        program: &Program,
        surface: &Surface,
    ) -> Option<Length> {
        let [x, y, _] = cell.centre();
        let mut at = |z: Length| {
            program.beside(surface, [x, y, z], &mut self.scratch)[1]
        };
        let (mut lo, mut hi) = (cell.lo[2], cell.hi[2]);
        let ends = [at(lo), at(hi)];
        if let Some(end) = ends.iter().position(|f| *f == 0.0) {
            return Some([lo, hi][end]);
        }
        let [below, above] = ends.map(|f| f < 0.0);
        if below == above {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (lo + hi);
            if (at(middle) < 0.0) == below {
                lo = middle
            } else {
                hi = middle
            }
        }
        Some(0.5 * (lo + hi))
    }

    /// The axis across which to cut a cell, if a cut can tell more.
    /// `is_wide_enough` tells that one across z suffices.
    fn axis(
        &self,
        cell: &Cell,
        known: &Known,
        is_wide_enough: bool,
    ) -> Option<usize> {
        let bin = self.options.bin;
        let high = DONE_BINS * bin;
        let [x, y, z] = [0, 1, 2].map(|i| cell.width(i));
        let widest = usize::from(y > x);
        let in_plane = x.max(y);
        if z > high && (z >= 0.25 * in_plane || is_wide_enough) {
            return Some(2);
        }
        if in_plane > THIN && in_plane >= 4.0 * z {
            return Some(widest);
        }
        if z > high {
            return Some(2);
        }
        if in_plane > THIN {
            return Some(widest);
        }
        // Such exactness is worth its work only where a doubt may be forgiven.
        let unknown = known.least < self.options.most;
        (unknown && z > 0.5 * self.options.tolerance).then_some(2)
    }

    fn finish(mut self, top: Length) -> Lean {
        self.faces.sort_by(f64::total_cmp);
        let mut level = [self.faces.as_slice(), &self.joints].concat();
        level.sort_by(f64::total_cmp);
        let tolerance = self.options.tolerance;
        let ends = [self.bottom, top];
        let mut unproved = vec![false; self.found.len()];
        let mut unknown = unproved.clone();
        for ([lo, hi], most) in std::mem::take(&mut self.doubts) {
            let beside =
                |face: Length| lo >= face - tolerance && hi <= face + tolerance;
            let at = level.partition_point(|f| *f < lo - tolerance);
            let mut near = level[at..].iter().take(2).chain(&ends);
            if near.any(|f| beside(*f)) {
                continue;
            }
            let bins = self.bins(lo, hi);
            for k in bins {
                unproved[k] |= self.found[k] < most;
                unknown[k] |= self.found[k] < most && most >= self.options.most;
            }
            self.raise(lo, hi, most);
        }
        let height = |bins: &[bool]| {
            bins.iter().filter(|u| **u).count() as f64 * self.options.bin
        };
        Lean {
            bottom: self.bottom,
            bin: self.options.bin,
            most_level: self.found,
            faces: self.faces,
            unproved: height(&unproved),
            unknown: height(&unknown),
        }
    }
}
