//! What parallel lines of samples meet first: a part as it is seen.
//!
//! In: an expression, a grid of samples in front of a viewer. Out: for each
//! line of samples towards the viewer the nearest sample inside, with the place
//! of the surface before it and the gradient there.
//!
//! ```text
//!   viewer ◄── a line of samples        tile   64 × 64 × 64 samples
//!   ┌───────┬───────┬───────┐           block  16 × 16 × 16
//!   │ empty │   ?   │ full  │           box     4 ×  4 ×  4
//!   └───────┴───────┴───────┘
//!     What interval arithmetic proves need not be sampled. The expression is
//!     simplified for the rest. Nothing is evaluated behind what is met.
//! ```
//!
//! The result equals, but for rounding, that of sampling everything: features
//! between the samples are missed. Solids of data that knows where lines cross it
//! are not sampled: nothing is missed. It depends neither on the number of threads
//! nor on the processor.

mod eye;
mod spans;
#[cfg(test)]
mod tests;

use super::FieldError;
use super::blend::branched;
use super::calls::{Call, Called};
use super::expr::Expr;
use super::source::Source;
use crate::cancel::Cancel;
use crate::grid::Grid;
use crate::solid::{Solid, solid};
use eye::{Eye, TILE};
use fidget::context::{Context, Tree};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Where a line of sight meets the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the line, in samples.
    pub depth: f32,
    /// The field's gradient there, along x, y and z.
    pub gradient: Vec3,
}

/// A part to be looked at.
pub struct Sight {
    f: Expr,
    /// What is inside, if it is made of data and half-spaces.
    solid: Option<Solid>,
    /// For each input of the function, where its value is from.
    sources: Vec<Source>,
    /// The calls of data.
    calls: Vec<Call>,
    /// Operations that all looks together may take, and those that they have
    /// taken.
    most: u64,
    taken: AtomicU64,
    cancel: Cancel,
}

impl Sight {
    /// Prepares an expression of x, y and z.
    ///
    /// # Errors
    /// If fidget refuses it.
    pub fn new(tree: &Tree) -> Result<Sight, FieldError> {
        let mut ctx = Context::new();
        let root = ctx.import(tree);
        let root = branched(&mut ctx, root);
        let called = Called::new(ctx, root, None)?;
        let (f, sources) = called.function()?;
        Ok(Sight {
            f: Expr::new(f),
            solid: solid(tree).filter(Solid::has_crossings),
            sources,
            calls: called.calls,
            most: u64::MAX,
            taken: AtomicU64::new(0),
            cancel: Cancel::NEVER,
        })
    }

    /// Lets `cancel` stop the look.
    pub fn with_cancel(mut self, cancel: Cancel) -> Sight {
        self.cancel = cancel;
        self
    }

    /// Gives up once all looks together have taken more operations than this.
    /// Whether they do depends neither on time nor on the number of threads,
    /// since what each tile takes does not depend on the others.
    pub fn at_most(mut self, operations: u64) -> Sight {
        self.most = operations;
        self
    }

    /// Notes that so many operations are taken.
    fn spend(&self, now: u64) -> Result<(), FieldError> {
        let taken = self.taken.fetch_add(now, Ordering::Relaxed);
        let most = self.most;
        if taken.saturating_add(now) > most {
            Err(FieldError::Costly { most })
        } else {
            Ok(())
        }
    }

    /// What each line of sight meets, row by row.
    ///
    /// # Errors
    /// If it takes too many operations, or is stopped; or if fidget fails,
    /// which is a bug.
    pub fn look(&self, grid: &Grid) -> Result<Vec<Option<Hit>>, FieldError> {
        let mut out = Vec::with_capacity(grid.size[0] * grid.size[1]);
        let all = |_, _| u64::MAX;
        self.look_by_rows(grid, &all, &mut |row| out.extend_from_slice(row))?;
        Ok(out)
    }

    /// Passes on, a row at a time, what each line of sight meets. Only some
    /// rows are in memory at once. `wanted` is asked for 64 lines at a time, given
    /// by the first one's column, a multiple of 64, and by their row. Nothing is met
    /// by lines whose bit it does not set; the first line's bit is the lowest.
    ///
    /// # Errors
    /// Those of [`Sight::look`].
    pub fn look_by_rows(
        &self,
        grid: &Grid,
        wanted: &(dyn Fn(usize, usize) -> u64 + Sync),
        each: &mut dyn FnMut(&[Option<Hit>]),
    ) -> Result<(), FieldError> {
        /// Number of tiles in memory at once: enough for many threads.
        const TILES: usize = 256;
        let [width, height, _] = grid.size;
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let at_once = (TILES / columns.max(1)).max(1);
        let mut row: Vec<Option<Hit>> = Vec::with_capacity(width);
        for first in (0..rows).step_by(at_once) {
            let last = (first + at_once).min(rows);
            let tiles: Result<Vec<Vec<Option<Hit>>>, FieldError> =
                (first * columns..last * columns)
                    .into_par_iter()
                    .map(|n| {
                        let mut eye = Eye::new(self, grid);
                        let at = [n % columns * TILE, n / columns * TILE];
                        eye.column(at, wanted)?;
                        Ok(eye.hits)
                    })
                    .collect();
            let tiles = tiles?;
            for j in first * TILE..(last * TILE).min(height) {
                row.clear();
                for i in 0..columns {
                    let tile = &tiles[(j / TILE - first) * columns + i];
                    let count = TILE.min(width - i * TILE);
                    let from = j % TILE * TILE;
                    row.extend_from_slice(&tile[from..from + count]);
                }
                each(&row);
            }
        }
        Ok(())
    }
}
