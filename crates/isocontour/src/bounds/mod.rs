//! Finds the tight axis-aligned box of {f < 0}, without a hint where to look.
//!
//! In: an expression. Out: a box outside of which the field is proved not to be
//! negative. Each of its sides is within `tolerance` of a point that is inside.
//!
//! How: proofs over slabs and a coarse grid narrow the region in which f can be
//! negative from ±1000 m. With long programs the region is divided among boxes
//! in which little of the program counts (`search`). Then each side is found by
//! best-first branch and bound (`reach`). The box that reaches farthest out is
//! looked at first. If intervals prove it empty, it is dropped. If its centre
//! is inside, the known extent grows to the surface above that centre. If an
//! operation jumps in it, as `floor`, `mod` and `atan2` do, it is looked at
//! once for each side of the jump (`program`). Otherwise it is cut across the
//! axis along which f changes most (`cut`). Where nothing is inside,
//! `undefined` finds out whether f is NaN, and which operation makes it so.
//!
//! Where the budget ends, the boxes that are left are looked at by points, close
//! enough for all that can be printed. If these boxes are too many, all of the
//! region is looked at so, in columns as close as the budget permits.
//!
//! Guarantees: the result is deterministic (the budget counts operations, not
//! time), there is no recursion, and the budget bounds the memory. A side that
//! the budget does not allow to finish, not even by points, is returned on the
//! safe side, and `slack_mm` says how far it may be off.
//!
//! Not guaranteed: features thinner than `tolerance / 16` may be left out
//! (surfaces of no thickness are common, such as the shared face of a
//! difference). Arithmetic is in f64. fidget's evaluation in f32 may see the
//! surface a few roundings elsewhere (3·10⁻⁵ mm at 300 mm). NaN counts as
//! outside.

mod cut;
mod reach;
mod search;
mod side;
mod undefined;

use crate::cancel::{Cancel, Cancelled};
use crate::ceiling::uncapped;
use crate::cuboid::Bounds;
use crate::expand::{ExpandError, expand};
use crate::program::Program;
use crate::solid::solid;
use fidget::context::Tree;
use glam::DVec3;
use search::Search;
use std::rc::Rc;

/// How to search.
#[derive(Clone, Copy, Debug)]
pub struct SearchOptions {
    /// Greatest distance of the part from the origin, along each axis. Default:
    /// 10⁶, beyond which f32 coordinates are coarser than 0.06.
    pub limit_mm: f64,
    /// A box within which to look. The part is what of f lies inside the box.
    /// Default: none.
    pub within: Option<Bounds>,
    /// Largest error of a side as a share of the model's size. The error is
    /// never above 10⁻⁴ mm. Default: 10⁻⁶.
    pub tolerance: f64,
    /// Budget, in interval operations. Default: 4·10⁷, which take a few
    /// seconds. A bear of 600 operations needs a sixth of the budget.
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
    /// the model. It is above the tolerance (10⁻⁴ mm) only if the budget ended.
    pub slack_mm: f64,
}

/// Why there are no bounds.
#[derive(Debug, thiserror::Error, PartialEq)]
#[non_exhaustive]
pub enum BoundsError {
    /// The inside reaches the edge of the search.
    #[error("it goes on along {direction} at {at_mm}")]
    Unbounded {
        /// `+x`, `-x`, `+y`, …
        direction: &'static str,
        /// How far out the model was still found to be solid.
        at_mm: f64,
        /// True if -f would be a bounded model.
        flipped: bool,
    },
    /// f is nowhere negative.
    #[error("f is nowhere negative within {searched}")]
    Empty {
        /// What was searched.
        searched: String,
        /// The operation that makes f NaN somewhere, if there is one.
        cause: Option<String>,
    },
    /// f is NaN everywhere.
    #[error("f is NaN everywhere within {searched}: {cause}")]
    NotANumber {
        /// What was searched.
        searched: String,
        /// Which operation makes f NaN, and of what.
        cause: String,
    },
    /// f does not depend on z.
    #[error("f does not depend on z")]
    Flat {
        /// Extent of {f < 0} along x and y.
        size: [f64; 2],
    },
    /// f is negative everywhere.
    #[error("f is negative all the way to ±{limit_mm}")]
    EverythingInside {
        /// The searched extent.
        limit_mm: f64,
    },
    /// The budget ended before the field's extent was known.
    #[error("the ranges of f along {direction} say too little")]
    Undecided {
        /// `+x`, `-x`, `+y`, …
        direction: &'static str,
    },
    /// The corners to search between make no box.
    #[error("{min} to {max} is no box")]
    NoBox {
        /// Lower corner.
        min: DVec3,
        /// Upper corner.
        max: DVec3,
    },
    /// The search was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The expression itself is unusable.
    #[error(transparent)]
    Expression(#[from] ExpandError),
}

/// Finds the box of {f < 0}.
///
/// # Errors
/// If there is no such box, it was not found, or `cancel` asked to stop.
pub fn find_bounds(
    tree: &Tree,
    options: &SearchOptions,
    cancel: &Cancel,
) -> Result<FoundBounds, BoundsError> {
    let found = search(tree, options, cancel);
    cancel.check()?;
    found
}

/// True if f does not depend on z.
///
/// # Errors
/// If the expression cannot be used.
pub fn is_flat(tree: &Tree) -> Result<bool, BoundsError> {
    Ok(!flattened(tree)?.depends_on(2))
}

fn search(
    tree: &Tree,
    options: &SearchOptions,
    cancel: &Cancel,
) -> Result<FoundBounds, BoundsError> {
    if options.within.is_none()
        && let Some(bounds) = solid(tree).and_then(|s| s.extent())
        && bounds.min.cmplt(bounds.max).all()
        && bounds.min.abs().max(bounds.max.abs()).max_element()
            <= options.limit_mm
    {
        return Ok(FoundBounds {
            bounds,
            slack_mm: 0.0,
        });
    }
    let program = flattened(tree)?;
    if options.within.is_none() && !program.depends_on(2) {
        let found = Search::new(options, cancel)?
            .of_a_slice()
            .run(program.clone());
        match found {
            Ok(found) => {
                let size = found.bounds.size();
                return Err(BoundsError::Flat {
                    size: [size.x, size.y],
                });
            }
            Err(BoundsError::Unbounded { .. }) => {}
            Err(other) => return Err(other),
        }
    }
    match Search::new(options, cancel)?.run(program.clone()) {
        Err(BoundsError::Unbounded {
            direction, at_mm, ..
        }) => {
            // A closed model whose sign is flipped is solid at infinity.
            let mirrored = SearchOptions {
                max_work: options.max_work / 10,
                ..*options
            };
            let negated = Rc::new(program.negated());
            let flipped = Search::new(&mirrored, cancel)
                .is_ok_and(|s| s.run(negated).is_ok());
            Err(BoundsError::Unbounded {
                direction,
                at_mm,
                flipped,
            })
        }
        other => other,
    }
}

fn flattened(tree: &Tree) -> Result<Rc<Program>, ExpandError> {
    let (mut context, root) = expand(tree)?;
    let root = uncapped(&mut context, root);
    let program = Program::new(&context, root);
    Ok(Rc::new(program.map_err(|_| ExpandError::FreeVariable)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ranges say too little of these fields, however small the boxes are.
    #[test]
    fn what_cannot_be_proved_is_looked_at() {
        let (x, y, z) = Tree::axes();
        let r = (x.square() + y.square()).sqrt();
        let wave = r.sin() / r.clone();
        let square = |half: f32| x.abs().max(y.abs()) - half;
        // A bowl whose underside hangs down in the middle.
        let near = (x.square() + y.square()).sqrt() + 1e-6;
        let under = -z.clone() - 2.0 * (near.sin() / near) - 2.0;
        let bowl = square(12.0).max((z.clone() - 5.0).max(under));
        // A sheet that rises to a peak, which ends at 11.
        let sheet = (z.clone() - 10.0 * wave).abs() - 1.0;
        let sheet = sheet.max(square(20.0).max(-z));
        for (tree, min, max) in [
            (bowl, [-12.0, -12.0, -4.0], [12.0, 12.0, 5.0]),
            (sheet, [-20.0, -20.0, 0.0], [20.0, 20.0, 11.0]),
        ] {
            let options = SearchOptions {
                max_work: 20_000_000,
                ..SearchOptions::default()
            };
            let found = find_bounds(&tree, &options, &Cancel::NEVER).unwrap();
            let Bounds {
                min: low,
                max: high,
            } = found.bounds;
            let off = (low - DVec3::from_array(min)).abs();
            let off = off.max((high - DVec3::from_array(max)).abs());
            assert!(off.max_element() < 0.01, "{found:?}");
            assert!(found.slack_mm < 0.01, "{found:?}");
        }
    }

    fn cube(half: f32) -> Tree {
        let (x, y, z) = Tree::axes();
        x.abs().max(y.abs()).max(z.abs()) - half
    }

    /// The bounds of a part that fills a cube.
    fn fill(name: &str, tree: &Tree, half: f64, max_work: u64) {
        let options = SearchOptions {
            max_work,
            ..SearchOptions::default()
        };
        let found = find_bounds(tree, &options, &Cancel::NEVER).unwrap();
        let low = (found.bounds.min + half).abs().max_element();
        let high = (found.bounds.max - half).abs().max_element();
        assert!(low.max(high) < 1e-4, "{name}: {found:?}");
        assert!(found.slack_mm < 1e-4, "{name}: {found:?}");
    }

    /// The struts of body-centred cells, cut by a cube that often ends where
    /// the field jumps from one cell to the next.
    #[test]
    fn lattices_end_where_a_cube_cuts_them() {
        let (x, y, z) = Tree::axes();
        for (size, cell, shift) in [
            (60.0, 15.0, 0.0),
            (60.0, 20.0, 0.5),
            (90.0, 10.0, 0.5),
            (90.0, 12.0, 0.5),
            (120.0, 30.0, 0.0),
            (150.0, 15.0, 0.0),
            (150.0, 20.0, 0.0),
            (180.0, 30.0, 0.0),
            (240.0, 30.0, 0.0),
        ] {
            let within = |v: &Tree| {
                let in_cell = (v.clone() + shift * cell).modulo(cell);
                (in_cell - 0.5 * cell).abs()
            };
            let p = [&x, &y, &z].map(within);
            let along = (p[0].clone() + p[1].clone() + p[2].clone()) / 3.0;
            let [a, b, c] = p.map(|p| (p - along.clone()).square());
            let struts = (a + b + c).sqrt() - 0.08 * cell;
            let part = struts.max(cube(0.5 * size));
            let name = format!("{size} {cell} {shift}");
            fill(&name, &part, f64::from(0.5 * size), 10_000_000);
        }
    }

    /// The smooth union of shaders: a mixture, with a parabola taken off.
    #[test]
    fn mixtures_are_bounded() {
        let (x, y, z) = Tree::axes();
        let ball = |at: f32, radius: f32| {
            let off = (x.clone() - at).square();
            (off + y.square() + z.square()).sqrt() - radius
        };
        let (a, b) = (ball(-4.0, 6.0), ball(4.0, 6.0));
        let share = 0.5 + 0.5 * (b.clone() - a.clone()) / 3.0;
        let t = share.max(0.0).min(1.0);
        let rest = 1.0 - t.clone();
        let mixed = b * rest.clone() + a * t.clone();
        let part = mixed - 3.0 * t * rest;
        let options = SearchOptions {
            max_work: 10_000_000,
            ..SearchOptions::default()
        };
        let found = find_bounds(&part, &options, &Cancel::NEVER).unwrap();
        let half = DVec3::new(10.0, 6.0, 6.0);
        let low = (found.bounds.min + half).abs().max_element();
        let high = (found.bounds.max - half).abs().max_element();
        assert!(low.max(high) < 1e-3, "{found:?}");
        assert!(found.slack_mm < 1e-3, "{found:?}");
    }

    /// The field has two values, or is the same all over a piece of what jumps.
    #[test]
    fn parts_that_only_jump_are_whole() {
        let (x, y, z) = Tree::axes();
        let least = |v: Tree, edge: f32| (v.compare(edge) + 1.0).min(1.0);
        let box_of = [&x, &y, &z].map(|v| least(-v.abs(), -1.0));
        let [a, b, c] = box_of;
        let halves = least(x.abs(), 1.0 / 3.0);
        let drawn = 0.5 - a * b * c * halves.clone();
        fill("two values", &drawn, 1.0, 4_000_000);
        fill("cut", &cube(1.0).max(0.5 - halves), 1.0, 4_000_000);
    }
}
