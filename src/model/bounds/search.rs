//! What a search knows of the model, and its coarse beginning: the region in
//! which the field may be negative, narrowed by proofs over a grid.

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

    /// Nothing is inside.
    pub(super) fn empty(&self) -> BoundsError {
        BoundsError::Empty {
            searched: match self.options.within {
                None => format!("±{} mm", self.options.limit_mm),
                Some(_) => "the given bounds".to_owned(),
            },
        }
    }

    /// Narrows the region by a coarse grid as long as that helps, and returns
    /// the program simplified for it.
    pub(super) fn narrow(
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
                    Some(h) => h.joined(&cell),
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

    /// A point is inside the model.
    pub(super) fn note_inside(&mut self, p: [f64; 3]) {
        let point = Cell { lo: p, hi: p };
        self.inside = Some(match &self.inside {
            None => point,
            Some(known) => known.joined(&point),
        });
    }
}
