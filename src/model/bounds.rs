//! The tight axis-aligned box of {f < 0}, found without being told where to
//! look.
//!
//! In: an expression. Out: a box outside of which the field is proved not to
//! be negative, each side within `tolerance` of a point that is inside.
//!
//! How: the region in which f can be negative is narrowed from ±1000 m by
//! proofs over a coarse grid; then each side is found by best-first branch and
//! bound. The box that reaches furthest out is looked at first: if intervals
//! prove it empty it is dropped, if its centre is inside the known extent
//! grows to the surface above that centre, else it is cut across the axis
//! along which f changes most.
//!
//! Guarantees: deterministic (the budget counts operations, not time), no
//! recursion, memory bounded by the budget. A side that the budget does not
//! allow to finish is returned on the safe side, and `slack_mm` says how far
//! it may be off.
//!
//! Not guaranteed: features thinner than `tolerance / 16` may be left out
//! (surfaces of no thickness are common: the shared face of a difference).
//! Arithmetic is f64; fidget's f32 evaluation may see the surface a few f32
//! roundings elsewhere (3·10⁻⁵ mm at 300 mm). NaN counts as outside.

use super::expand::{ExpandError, expand};
use super::program::{Cell, Program, Scratch};
use fidget::context::Tree;
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

/// An axis-aligned box, in millimetres of the model's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub min: DVec3,
    /// Upper corner.
    pub max: DVec3,
}

impl Bounds {
    /// Extent along each axis.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The middle.
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }
}

/// How to search.
#[derive(Clone, Copy, Debug)]
pub struct SearchOptions {
    /// The model must lie within ± this. Default: 10⁶ mm, beyond which f32
    /// coordinates are coarser than a nozzle.
    pub limit_mm: f64,
    /// Look only within this box; the part is what of f lies inside it.
    /// Default: none.
    pub within: Option<Bounds>,
    /// Largest error of a side as a share of the model's size (never above
    /// 10⁻⁴ mm). Default: 10⁻⁶.
    pub tolerance: f64,
    /// Budget, in interval operations. Default: 4·10⁷, a few seconds; a
    /// bear of 600 operations needs a sixth of it.
    pub max_work: u64,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            limit_mm: 1e6,
            within: None,
            tolerance: 1e-6,
            max_work: 40_000_000,
        }
    }
}

/// Bounds and how sure they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundBounds {
    /// The box.
    pub bounds: Bounds,
    /// Largest distance from a side of the box to a point known to be inside
    /// the model. Above the tolerance (10⁻⁴ mm) only if the budget ended.
    pub slack_mm: f64,
}

/// Why there are no bounds.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum BoundsError {
    /// The inside goes on to the edge of the search.
    #[error(
        "the model is unbounded: it goes on along {direction} at {at_mm} mm; \
         intersect it with a box or a ball, or cut it with \
         --bounds x0,y0,z0:x1,y1,z1{}",
        if *.flipped {
            " (its outside is bounded: is the sign flipped? f must be \
             negative inside)"
        } else {
            ""
        }
    )]
    Unbounded {
        /// `+x`, `-x`, `+y`, …
        direction: &'static str,
        /// How far out the model was still found to be solid.
        at_mm: f64,
        /// Whether -f would be a bounded model.
        flipped: bool,
    },
    /// f is nowhere negative.
    #[error(
        "the model is empty: f is nowhere negative within {searched}; \
         f must be negative inside the part (an unsigned distance needs a \
         thickness subtracted)"
    )]
    Empty {
        /// What was searched.
        searched: String,
    },
    /// f is negative everywhere.
    #[error(
        "everything is inside: f is negative all the way to ±{limit_mm} mm; \
         f must be positive outside the part (is the sign flipped?), or cut \
         it with --bounds x0,y0,z0:x1,y1,z1"
    )]
    EverythingInside {
        /// The searched extent.
        limit_mm: f64,
    },
    /// The budget ended before the field's extent was known.
    #[error(
        "the model's bounds were not found: the ranges of f along \
         {direction} say too little (NaN, infinite or wildly overestimated \
         values); give them with --bounds x0,y0,z0:x1,y1,z1"
    )]
    Undecided {
        /// `+x`, `-x`, `+y`, …
        direction: &'static str,
    },
    /// `--bounds` is not a box.
    #[error(
        "the given bounds are no box: every lower number must be finite and \
         less than its upper one (--bounds x0,y0,z0:x1,y1,z1), \
         got {min}:{max}"
    )]
    NoBox {
        /// Lower corner.
        min: DVec3,
        /// Upper corner.
        max: DVec3,
    },
    /// The expression itself is unusable.
    #[error(transparent)]
    Expression(#[from] ExpandError),
}

/// Finds the box of {f < 0}.
pub fn find_bounds(
    tree: &Tree,
    options: &SearchOptions,
) -> Result<FoundBounds, BoundsError> {
    crate::limits::doing("bounds", || search(tree, options))
}

fn search(
    tree: &Tree,
    options: &SearchOptions,
) -> Result<FoundBounds, BoundsError> {
    let (context, root) = expand(tree)?;
    let program =
        Program::new(&context, root).map_err(|_| ExpandError::FreeVariable)?;
    drop(context);
    match Search::new(options)?.run(Rc::new(program)) {
        Err(BoundsError::Unbounded {
            direction, at_mm, ..
        }) => {
            // A closed model whose sign is flipped is solid at infinity.
            let mirrored = SearchOptions {
                max_work: options.max_work / 10,
                ..*options
            };
            let negated = -tree.clone();
            let (context, root) = expand(&negated)?;
            let flipped = Program::new(&context, root).is_ok_and(|p| {
                Search::new(&mirrored)
                    .and_then(|s| s.run(Rc::new(p)))
                    .is_ok()
            });
            Err(BoundsError::Unbounded {
                direction,
                at_mm,
                flipped,
            })
        }
        other => other,
    }
}

const DIRECTIONS: [[&str; 2]; 3] = [["-x", "+x"], ["-y", "+y"], ["-z", "+z"]];

/// One side of the box that is looked for.
#[derive(Clone, Copy)]
struct Side {
    axis: usize,
    up: bool,
}

impl Side {
    fn all() -> [Self; 6] {
        std::array::from_fn(|i| Self {
            // z first: it is the side the part stands on.
            axis: 2 - i / 2,
            up: i % 2 == 1,
        })
    }

    fn name(self) -> &'static str {
        DIRECTIONS[self.axis][usize::from(self.up)]
    }

    /// Turns a coordinate into "how far out", and back.
    fn outward(self, v: f64) -> f64 {
        if self.up { v } else { -v }
    }

    /// How far out a cell reaches.
    fn reach(self, cell: &Cell) -> f64 {
        if self.up {
            cell.hi[self.axis]
        } else {
            -cell.lo[self.axis]
        }
    }

    /// Coordinate of a cell's face opposite to this side.
    fn inner_face(self, cell: &Cell) -> f64 {
        if self.up {
            cell.lo[self.axis]
        } else {
            cell.hi[self.axis]
        }
    }

    /// Removes what is less far out than `from`.
    fn clip(self, cell: &mut Cell, from: f64) {
        if self.up {
            cell.lo[self.axis] = cell.lo[self.axis].max(from);
        } else {
            cell.hi[self.axis] = cell.hi[self.axis].min(-from);
        }
    }

    fn set_reach(self, cell: &mut Cell, reach: f64) {
        if self.up {
            cell.hi[self.axis] = reach;
        } else {
            cell.lo[self.axis] = -reach;
        }
    }
}

/// A box in which the field may be negative.
struct Candidate {
    reach: f64,
    depth: u32,
    /// Order of creation: makes the order total, hence repeatable.
    number: u64,
    cell: Cell,
    program: Rc<Program>,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        // Of boxes that reach equally far the deepest first: that one is the
        // nearest to a decision.
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

struct Search<'a> {
    options: &'a SearchOptions,
    scratch: Scratch,
    /// Where f may be negative.
    region: Cell,
    /// Box of the points known to be inside.
    inside: Option<Cell>,
}

impl<'a> Search<'a> {
    fn new(options: &'a SearchOptions) -> Result<Self, BoundsError> {
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
            scratch: Scratch::default(),
            region,
            inside: None,
        })
    }

    fn empty(&self) -> BoundsError {
        BoundsError::Empty {
            searched: match self.options.within {
                None => format!("±{} mm", self.options.limit_mm),
                Some(_) => "the given bounds".to_owned(),
            },
        }
    }

    fn run(mut self, program: Rc<Program>) -> Result<FoundBounds, BoundsError> {
        let program = self.narrow(program)?;
        let mut slack_mm = f64::INFINITY;
        // The tolerance is a share of the size, which the coarse region may
        // overestimate: once more with what the first pass found.
        for _ in 0..3 {
            let before = largest_side(&self.region);
            slack_mm = self.all_sides(&program)?;
            if largest_side(&self.region) > 0.6 * before {
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
    fn all_sides(&mut self, program: &Rc<Program>) -> Result<f64, BoundsError> {
        let far = (0..3)
            .map(|i| self.region.lo[i].abs().max(self.region.hi[i].abs()))
            .fold(0.0, f64::max);
        // Not below what f64 coordinates can tell apart.
        let tolerance = (largest_side(&self.region) * self.options.tolerance)
            .min(1e-4)
            .max(far * 1e-13);
        let mut slack_mm: f64 = 0.0;
        let sides = Side::all();
        for (done, side) in sides.into_iter().enumerate() {
            let left = self.options.max_work.saturating_sub(self.scratch.work);
            let budget = left / (sides.len() - done) as u64;
            let reach = self.side(side, program, tolerance, budget)?;
            side.set_reach(&mut self.region, reach);
            if let Some(inside) = self.inside {
                slack_mm = slack_mm.max(reach - side.reach(&inside));
            }
        }
        Ok(slack_mm)
    }

    /// Narrows the region by a coarse grid as long as that helps, and returns
    /// the program simplified for it.
    fn narrow(
        &mut self,
        mut program: Rc<Program>,
    ) -> Result<Rc<Program>, BoundsError> {
        /// Cells per axis: an off-centre model loses three quarters of the
        /// region per round, a centred one half.
        const GRID: usize = 4;
        loop {
            crate::limits::check();
            let all = program.enclose(&self.region, &mut self.scratch);
            if all.range.is_empty() || all.range.lo >= 0.0 {
                return Err(self.empty());
            }
            if all.range.hi < 0.0
                && !all.range.nan
                && self.options.within.is_none()
            {
                return Err(BoundsError::EverythingInside {
                    limit_mm: self.options.limit_mm,
                });
            }
            if let Some(simple) = program.simplify(&self.scratch) {
                program = Rc::new(simple);
            }
            let edge = |axis: usize, i: usize| {
                // The ends exactly, so that no gap opens by rounding.
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
                crate::limits::check();
                let at = [i % GRID, i / GRID % GRID, i / GRID / GRID];
                let cell = Cell {
                    lo: std::array::from_fn(|a| edges[a][at[a]]),
                    hi: std::array::from_fn(|a| edges[a][at[a] + 1]),
                };
                let f = program.enclose(&cell, &mut self.scratch);
                if f.range.is_empty() || f.range.lo >= 0.0 {
                    continue;
                }
                if f.centre < 0.0 {
                    self.note_inside(cell.centre());
                }
                hull = Some(match hull {
                    None => cell,
                    Some(h) => joined(&h, &cell),
                });
            }
            let Some(hull) = hull else {
                return Err(self.empty());
            };
            let shrunk =
                (0..3).any(|i| hull.width(i) < 0.9 * self.region.width(i));
            self.region = hull;
            // A point-like region would be halved for ever.
            let tiny = (0..3)
                .all(|i| hull.width(i) <= 1e-9 * (1.0 + hull.lo[i].abs()));
            if !shrunk || tiny || self.scratch.work > self.options.max_work {
                return Ok(program);
            }
        }
    }

    fn note_inside(&mut self, p: [f64; 3]) {
        let point = Cell { lo: p, hi: p };
        self.inside = Some(match &self.inside {
            None => point,
            Some(known) => joined(known, &point),
        });
    }

    /// Finds how far the model reaches on one side.
    fn side(
        &mut self,
        side: Side,
        program: &Rc<Program>,
        tolerance: f64,
        budget: u64,
    ) -> Result<f64, BoundsError> {
        let stop = self.scratch.work + budget;
        let face = side.reach(&self.region);
        let thinnest = tolerance / 16.0;
        self.probe(side, program, tolerance);
        let mut number = 0;
        let mut queue = BinaryHeap::new();
        queue.push(Candidate {
            reach: face,
            depth: 0,
            number,
            cell: self.region,
            program: program.clone(),
        });
        while let Some(mut c) = queue.pop() {
            crate::limits::check();
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
                // No other candidate reaches further than this one.
                if c.reach <= known + tolerance {
                    break;
                }
                // Cut below what is still to be decided, so that no box gets
                // thinner than half the tolerance: over a rounded top whose
                // height lies right at the cut, thinner ones never end.
                side.clip(&mut c.cell, known + 0.5 * tolerance);
            }
            if self.scratch.work > stop {
                let beyond = c.reach >= 0.9 * self.options.limit_mm;
                if self.inside.is_none()
                    || (beyond && self.options.within.is_none())
                {
                    return Err(BoundsError::Undecided {
                        direction: side.name(),
                    });
                }
                return Ok(c.reach);
            }
            let f = c.program.enclose(&c.cell, &mut self.scratch);
            if f.range.is_empty() || f.range.lo >= 0.0 {
                continue;
            }
            // The middle of the inner face as well: where the surface has a
            // rounded top just above that face, the box's centre is over it
            // however small the box gets.
            let mut start = c.cell.centre();
            let mut is_inside = f.centre < 0.0;
            if !is_inside {
                start[side.axis] = side.inner_face(&c.cell);
                is_inside = c.program.value(start, &mut self.scratch) < 0.0;
            }
            if is_inside {
                self.note_inside(start);
                self.climb(side, &c.program, start, c.reach);
                // The same box again, cut at the new extent.
                queue.push(c);
                continue;
            }
            let Some(across) =
                split_axis(&c.cell, f.steepness, c.depth, thinnest)
            else {
                continue;
            };
            let program = match c.program.simplify(&self.scratch) {
                Some(simple) => Rc::new(simple),
                None => c.program,
            };
            for cell in c.cell.split(across) {
                number += 1;
                queue.push(Candidate {
                    reach: side.reach(&cell),
                    depth: c.depth + 1,
                    number,
                    cell,
                    program: program.clone(),
                });
            }
        }
        let Some(inside) = &self.inside else {
            return Err(self.empty());
        };
        let known = side.reach(inside);
        let proved = (known + tolerance).min(face).max(known);
        Ok(simplest_between(known, proved))
    }

    /// Looks for inside points far out, so that the search has a known extent
    /// to begin with. Where the part ends in a plateau or is cut by the given
    /// bounds, many boxes reach equally far, and a search of the deepest first
    /// could spend its budget on the corner it happened to begin with.
    fn probe(&mut self, side: Side, program: &Program, tolerance: f64) {
        /// Points along each of the face's two axes.
        const ACROSS: usize = 8;
        /// Depths below the face, as shares of the region; the face first.
        const DEPTHS: [f64; 4] = [0.0, 0.02, 0.1, 0.3];
        // Off the middles and quarters: planes of symmetry are where fields
        // are 0 or NaN.
        let part = |i: usize| (i as f64 + 0.38) / ACROSS as f64;
        let region = self.region;
        let face = side.reach(&region);
        let [u, v] = [(side.axis + 1) % 3, (side.axis + 2) % 3];
        for depth in DEPTHS {
            let reach = face - depth * region.width(side.axis);
            for i in 0..ACROSS * ACROSS {
                crate::limits::check();
                let known = self.inside.as_ref().map(|c| side.reach(c));
                if known.is_some_and(|k| reach <= k + tolerance) {
                    return;
                }
                let mut p = region.lo;
                p[side.axis] = side.outward(reach);
                p[u] += part(i % ACROSS) * region.width(u);
                p[v] += part(i / ACROSS) * region.width(v);
                if program.value(p, &mut self.scratch) < 0.0 {
                    self.note_inside(p);
                    self.climb(side, program, p, face);
                }
            }
        }
    }

    /// Moves the known extent from an inside point outwards to a surface.
    fn climb(
        &mut self,
        side: Side,
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

fn largest_side(cell: &Cell) -> f64 {
    (0..3).map(|i| cell.width(i)).fold(0.0, f64::max)
}

/// The box of two boxes.
fn joined(a: &Cell, b: &Cell) -> Cell {
    Cell {
        lo: std::array::from_fn(|i| a.lo[i].min(b.lo[i])),
        hi: std::array::from_fn(|i| a.hi[i].max(b.hi[i])),
    }
}

/// The axis to cut a box across: the one along which f changes most. `None`
/// if no cut can tell more: f is constant, or the box is thinner than
/// `thinnest` along every axis that matters.
fn split_axis(
    cell: &Cell,
    steepness: [f64; 3],
    depth: u32,
    thinnest: f64,
) -> Option<usize> {
    let jumps = |i: usize| !steepness[i].is_finite() && steepness[i] != 0.0;
    // Where f jumps, the box that holds the jump is never decided. Once it is
    // as thin as what may be left out, its neighbours tell what there is.
    if (0..3).any(|i| jumps(i) && cell.width(i) <= thinnest) {
        return None;
    }
    let can = |&i: &usize| {
        let middle = cell.centre()[i];
        steepness[i] != 0.0
            && cell.width(i) > thinnest
            && cell.lo[i] < middle
            && middle < cell.hi[i]
    };
    let widest = |axes: &mut dyn Iterator<Item = usize>| {
        axes.filter(can)
            .max_by(|&a, &b| cell.width(a).total_cmp(&cell.width(b)))
    };
    // Steepness is an upper bound and can be far too high along one axis;
    // now and then the widest axis gets its turn. Jumps are closed in on in
    // turn with the rest.
    if depth % 4 != 3
        && let Some(i) = widest(&mut (0..3).filter(|&i| jumps(i)))
    {
        return Some(i);
    }
    if depth % 8 == 7 || (0..3).any(jumps) {
        return widest(&mut (0..3));
    }
    (0..3).filter(can).max_by(|&a, &b| {
        let gain = |i: usize| cell.width(i) * steepness[i];
        gain(a).total_cmp(&gain(b))
    })
}

/// The roundest decimal within [lo, hi], down to 0.001; else `hi`.
///
/// The model's extent is known to lie in the interval and no better. Nearly
/// every drawn part ends at a multiple of a micrometre, and where the interval
/// holds one, that is the likeliest truth: a cube of 20 mm reads 20 and not
/// 20.00002.
fn simplest_between(lo: f64, hi: f64) -> f64 {
    for scale in [1.0, 10.0, 100.0, 1000.0] {
        // The extent is a point inside: the surface is at or beyond it, but
        // f64 may have rounded it over the decimal.
        let v = ((lo - 1e-11 * lo.abs()) * scale).ceil() / scale;
        if v <= hi {
            // No negative zero.
            return v + 0.0;
        }
    }
    hi
}
