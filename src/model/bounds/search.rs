//! What a search knows of the model, and its coarse beginning: the region in
//! which the field may be negative, narrowed by proofs over a grid.

use super::side::Side;
use super::undefined::Undefined;
use super::{Bounds, BoundsError, SearchOptions};
use crate::model::cell::Cell;
use crate::model::program::{Program, Scratch};
use std::rc::Rc;

/// A search for the box of {f < 0}.
pub(super) struct Search<'a> {
    pub options: &'a SearchOptions,
    pub scratch: Scratch,
    /// Where f may be negative.
    pub region: Cell,
    /// Box of the points known to be inside.
    pub inside: Option<Cell>,
}

impl<'a> Search<'a> {
    pub(super) fn new(options: &'a SearchOptions) -> Result<Self, BoundsError> {
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

    /// Looks at a slice of a model that is the same at every height.
    pub(super) fn of_a_slice(mut self) -> Self {
        (self.region.lo[2], self.region.hi[2]) = (-0.5, 0.5);
        self
    }

    /// Nothing is inside, and why.
    pub(super) fn empty(&mut self, program: &Program) -> BoundsError {
        let searched = match self.options.within {
            None => format!("±{} mm", self.options.limit_mm),
            Some(_) => "the given bounds".to_owned(),
        };
        let Undefined { share, cause } = self.undefined(program);
        match cause {
            Some(cause) if share == 1.0 => {
                BoundsError::NotANumber { searched, cause }
            }
            cause => BoundsError::Empty { searched, cause },
        }
    }

    /// Narrows the region as far as coarse proofs go, and returns the program
    /// simplified for it.
    pub(super) fn narrow(
        &mut self,
        program: Rc<Program>,
    ) -> Result<Rc<Program>, BoundsError> {
        let all = program.enclose(&self.region, &mut self.scratch);
        if all.range.is_empty() || all.range.lo >= 0.0 {
            return Err(self.empty(&program));
        }
        if all.range.hi < 0.0
            && !all.range.nan
            && self.options.within.is_none()
        {
            return Err(BoundsError::EverythingInside {
                limit_mm: self.options.limit_mm,
            });
        }
        let program = self.peel(program);
        self.sift(program)
    }

    /// Takes slabs off the region's sides as long as one of them is proved to
    /// be empty: few boxes for much of the region, whatever the program's
    /// size.
    fn peel(&mut self, mut program: Rc<Program>) -> Rc<Program> {
        /// What is left of the way from the middle to the side; the most
        /// hopeful first.
        const LEAVES: [f64; 4] =
            [1.0 / 4096.0, 1.0 / 64.0, 1.0 / 8.0, 1.0 / 2.0];
        let most = self.scratch.work + self.options.max_work / 8;
        let mut least = 0;
        loop {
            let mut peeled = false;
            // Where much could not be taken off once, it will not be later.
            let mut best = LEAVES.len();
            for side in Side::all() {
                if self.region.width(side.axis) <= 1e-6 {
                    continue;
                }
                for (nth, leave) in LEAVES.iter().enumerate().skip(least) {
                    crate::limits::check();
                    if self.scratch.work > most {
                        return program;
                    }
                    let middle = side.outward(self.region.centre()[side.axis]);
                    let reach =
                        middle + leave * (side.reach(&self.region) - middle);
                    let mut slab = self.region;
                    side.clip(&mut slab, reach);
                    let f = program.enclose(&slab, &mut self.scratch);
                    if f.range.is_empty() || f.range.lo >= 0.0 {
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
            if let Some(simple) = program.simplify(&self.scratch) {
                program = Rc::new(simple);
            }
        }
    }

    /// Narrows the region to the hull of those boxes of a grid that may hold
    /// some of the model, as long as that helps.
    fn sift(
        &mut self,
        mut program: Rc<Program>,
    ) -> Result<Rc<Program>, BoundsError> {
        /// Cells per axis: an off-centre model loses three quarters of the
        /// region per round, a centred one half.
        const GRID: usize = 4;
        /// Share of the work that one round may take.
        const SHARE: u64 = 20;
        loop {
            let round = GRID.pow(3) as u64 * program.len() as u64;
            if round > self.options.max_work / SHARE {
                return Ok(program);
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
                    Some(h) => h.joined(&cell),
                });
            }
            let Some(hull) = hull else {
                return Err(self.empty(&program));
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
            program.enclose(&self.region, &mut self.scratch);
            if let Some(simple) = program.simplify(&self.scratch) {
                program = Rc::new(simple);
            }
        }
    }

    /// A point is inside the model.
    pub(super) fn note_inside(&mut self, p: [f64; 3]) {
        let point = Cell { lo: p, hi: p };
        self.inside = Some(match &self.inside {
            None => point,
            Some(known) => known.joined(&point),
        });
    }
}
