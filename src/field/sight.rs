//! What is met first along parallel lines of samples: a part as it is seen.
//!
//! In: an expression, a grid of samples in front of a viewer. Out: for each
//! line of samples towards the viewer the nearest one inside, with the place
//! of the surface before it and the gradient there.
//!
//! ```text
//!   viewer ◄── a line of samples        tile   64 × 64 × 64 samples
//!   ┌───────┬───────┬───────┐           block  16 × 16 × 16
//!   │ empty │   ?   │ full  │           box     4 ×  4 ×  4
//!   └───────┴───────┴───────┘
//!     what interval arithmetic proves need not be sampled, and for what it
//!     does not prove the expression is simplified; nothing is asked behind
//!     what is met
//! ```
//!
//! The result is that of sampling everything, but for rounding: what lies
//! between the samples is missed. It depends neither on the number of threads
//! nor on the processor.

use super::FieldError;
use super::blend::branched;
use super::lanes::{Lanes, Seed};
use super::ranges::Ranges;
use super::tapes::bug;
use crate::limits;
use crate::model::Interval;
use fidget::context::{Context, Tree};
use fidget::eval::{Function, MathFunction};
use fidget::var::Var;
use fidget::vm::VmFunction;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Samples along the side of a tile.
const TILE: usize = 64;
/// Samples along the side of a block.
const BLOCK: usize = 16;
/// Samples along the side of a box: those of one are a pass of [`Lanes`].
const BOX: usize = 4;

/// Samples in front of a viewer: columns, rows, and along each line of sight
/// towards the viewer.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    /// The first sample of the first column and row: the farthest one, mm.
    pub origin: DVec3,
    /// From one column, row or sample to the next, mm.
    pub steps: [DVec3; 3],
    /// Columns, rows, samples along a line.
    pub size: [usize; 3],
}

/// Where a line of sight meets the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// How far along the line, in samples.
    pub depth: f32,
    /// The field's gradient there, along x, y and z.
    pub gradient: Vec3,
}

/// A part to be looked at.
pub struct Sight {
    f: VmFunction,
    /// By input of the function, its coordinate.
    axes: Vec<usize>,
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
        let f = VmFunction::new(&ctx, &[root]).map_err(bug)?;
        let mut axes = vec![0; f.vars().len()];
        for (var, slot) in f.vars().iter() {
            let axis = match var {
                Var::X => 0,
                Var::Y => 1,
                Var::Z => 2,
                Var::V(_) => {
                    return Err(bug("it has variables besides x, y and z"));
                }
            };
            if let Some(known) = axes.get_mut(slot) {
                *known = axis;
            }
        }
        Ok(Sight { f, axes })
    }

    /// What each line of sight meets, row by row.
    ///
    /// # Errors
    /// If the evaluator fails, which is a bug.
    pub fn look(&self, grid: &Grid) -> Result<Vec<Option<Hit>>, FieldError> {
        let [width, height, _] = grid.size;
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let tiles: Result<Vec<Vec<Option<Hit>>>, FieldError> = (0..columns
            * rows)
            .into_par_iter()
            .map(|n| {
                let mut eye = Eye::new(self, grid);
                eye.column([n % columns * TILE, n / columns * TILE])?;
                Ok(eye.hits)
            })
            .collect();
        let tiles = tiles?;
        let mut out = Vec::with_capacity(width * height);
        for j in 0..height {
            for i in 0..columns {
                let tile = &tiles[j / TILE * columns + i];
                let count = TILE.min(width - i * TILE);
                let from = j % TILE * TILE;
                out.extend_from_slice(&tile[from..from + count]);
            }
        }
        Ok(out)
    }
}

/// What is known of a cube of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Known {
    Empty,
    Full,
    Open,
}

/// Looks along the lines of one column of tiles.
struct Eye<'a> {
    sight: &'a Sight,
    grid: &'a Grid,
    /// The column's first line.
    at: [usize; 2],
    hits: Vec<Option<Hit>>,
    /// Lines that have just met something, at which sample.
    fresh: Vec<(usize, usize)>,
    ranges: Ranges,
    lanes: Lanes,
    simplify: <VmFunction as Function>::Workspace,
    /// Memory of functions that are done with.
    storage: Vec<<VmFunction as Function>::Storage>,
    points: [Vec<f32>; 3],
    values: Vec<f32>,
    slopes: [Vec<[f32; 3]>; 2],
    found: Vec<Option<Interval>>,
}

impl<'a> Eye<'a> {
    fn new(sight: &'a Sight, grid: &'a Grid) -> Self {
        Eye {
            sight,
            grid,
            at: [0; 2],
            hits: vec![None; TILE * TILE],
            fresh: Vec::new(),
            ranges: Ranges::default(),
            lanes: Lanes::default(),
            simplify: Default::default(),
            storage: Vec::new(),
            points: Default::default(),
            values: Vec::new(),
            slopes: Default::default(),
            found: Vec::new(),
        }
    }

    /// The tiles behind each other that begin with line `at`, nearest first.
    fn column(&mut self, at: [usize; 2]) -> Result<(), FieldError> {
        self.at = at;
        let sight = self.sight;
        let f = &sight.f;
        let tiles = self.grid.size[2].div_ceil(TILE);
        let tiles = (0..tiles).rev().map(|k| [at[0], at[1], k * TILE]);
        let tiles: Vec<[usize; 3]> = tiles.collect();
        for (tile, known) in self.sift(f, &tiles, TILE) {
            limits::check();
            self.visit(f, tile, known, TILE)?;
        }
        Ok(())
    }

    /// One cube of a tile's or a block's size.
    fn visit(
        &mut self,
        f: &VmFunction,
        at: [usize; 3],
        known: Known,
        size: usize,
    ) -> Result<(), FieldError> {
        if known == Known::Empty || self.is_covered(at, size) {
            return Ok(());
        }
        if known == Known::Full {
            self.fill(at, size);
            self.arrive(f);
            return Ok(());
        }
        let axes = &self.sight.axes;
        let extent = self.extent(at, size);
        let (_, trace) = self.ranges.eval(f, |slot| extent[axes[slot]]);
        let own = match trace {
            Some(trace) => {
                let storage = self.storage.pop().unwrap_or_default();
                let simpler = f.simplify(trace, storage, &mut self.simplify);
                Some(simpler.map_err(bug)?)
            }
            None => None,
        };
        let g = own.as_ref().unwrap_or(f);
        let side = if size == TILE { BLOCK } else { BOX };
        let n = size / side;
        // Nearest first.
        let parts: Vec<[usize; 3]> = (0..n * n * n)
            .map(|m| [m % n, m / n % n, n - 1 - m / (n * n)])
            .map(|part| [0, 1, 2].map(|a| at[a] + part[a] * side))
            .filter(|part| (0..3).all(|a| part[a] < self.grid.size[a]))
            .filter(|part| !self.is_covered(*part, side))
            .collect();
        let parts = self.sift(g, &parts, side);
        if side == BLOCK {
            for (part, known) in parts {
                self.visit(g, part, known, side)?;
            }
        } else {
            for layer in parts.chunk_by(|a, b| a.0[2] == b.0[2]) {
                self.boxes(g, layer);
            }
            self.arrive(g);
        }
        if let Some(done) = own {
            self.storage.extend(done.recycle());
        }
        Ok(())
    }

    /// What is known of cubes of that size, where there may be something.
    fn sift(
        &mut self,
        f: &VmFunction,
        cubes: &[[usize; 3]],
        size: usize,
    ) -> Vec<([usize; 3], Known)> {
        let axes = &self.sight.axes;
        let extents: Vec<[Interval; 3]> =
            cubes.iter().map(|&at| self.extent(at, size)).collect();
        self.found.clear();
        let input = |slot: usize, k: usize| extents[k][axes[slot]];
        self.lanes.ranges(f, cubes.len(), input, &mut self.found);
        let mut out = Vec::with_capacity(cubes.len());
        for (k, found) in self.found.iter().enumerate() {
            let range = match found {
                Some(range) => *range,
                None => self.ranges.eval(f, |slot| input(slot, k)).0,
            };
            let known = match range {
                _ if range.lo >= 0.0 => Known::Empty,
                _ if range.hi < 0.0 && !range.nan => Known::Full,
                _ => Known::Open,
            };
            if known != Known::Empty {
                out.push((cubes[k], known));
            }
        }
        out
    }

    /// Where the samples of a cube lie.
    fn extent(&self, at: [usize; 3], size: usize) -> [Interval; 3] {
        let Grid {
            origin,
            steps,
            size: all,
        } = self.grid;
        let (mut lo, mut hi) = (*origin, *origin);
        for a in 0..3 {
            let last = (at[a] + size).min(all[a]) - 1;
            let (p, q) = (steps[a] * at[a] as f64, steps[a] * last as f64);
            lo += p.min(q);
            hi += p.max(q);
        }
        [0, 1, 2].map(|c| Interval::new(lo[c], hi[c]))
    }

    /// The lines that pass through a cube.
    fn lines(
        &self,
        at: [usize; 3],
        size: usize,
    ) -> impl Iterator<Item = usize> + use<> {
        let [i, j] = [0, 1].map(|a| at[a] - self.at[a]);
        let [width, height] =
            [0, 1].map(|a| size.min(self.grid.size[a] - at[a]));
        (j..j + height)
            .flat_map(move |j| (i..i + width).map(move |i| j * TILE + i))
    }

    /// True if something is met before a cube all over.
    fn is_covered(&self, at: [usize; 3], size: usize) -> bool {
        self.lines(at, size).all(|line| self.hits[line].is_some())
    }

    /// Lines that have met nothing meet the front of a cube.
    fn fill(&mut self, at: [usize; 3], size: usize) {
        let front = (at[2] + size).min(self.grid.size[2]) - 1;
        for line in self.lines(at, size) {
            self.meet(line, front);
        }
    }

    /// A line meets its first sample inside.
    fn meet(&mut self, line: usize, sample: usize) {
        if self.hits[line].is_none() {
            self.hits[line] = Some(Hit {
                depth: sample as f32,
                gradient: Vec3::ZERO,
            });
            self.fresh.push((line, sample));
        }
    }

    /// Adds a sample to those to be evaluated.
    fn ask(&mut self, line: usize, sample: usize) {
        let Grid { origin, steps, .. } = self.grid;
        let (i, j) = (line % TILE + self.at[0], line / TILE + self.at[1]);
        let p = *origin
            + steps[0] * i as f64
            + steps[1] * j as f64
            + steps[2] * sample as f64;
        for (list, c) in self.points.iter_mut().zip(p.to_array()) {
            list.push(c as f32);
        }
    }

    /// Looks into boxes beside each other.
    fn boxes(&mut self, f: &VmFunction, boxes: &[([usize; 3], Known)]) {
        let mut asked: Vec<(usize, [usize; 2])> = Vec::new();
        self.points.iter_mut().for_each(Vec::clear);
        for &(at, known) in boxes {
            if known == Known::Full {
                self.fill(at, BOX);
                continue;
            }
            let end = (at[2] + BOX).min(self.grid.size[2]);
            for line in self.lines(at, BOX) {
                if self.hits[line].is_none() {
                    asked.push((line, [at[2], end]));
                    (at[2]..end).rev().for_each(|k| self.ask(line, k));
                }
            }
        }
        let count = self.points[0].len();
        let axes = &self.sight.axes;
        let inputs: Vec<&[f32]> =
            axes.iter().map(|&a| &self.points[a][..]).collect();
        self.values.clear();
        self.lanes.eval(f, &inputs, count, &mut self.values);
        let values = std::mem::take(&mut self.values);
        let mut rest = &values[..];
        for (line, [from, end]) in asked {
            let (own, after) = rest.split_at((end - from).min(rest.len()));
            rest = after;
            if let Some(n) = own.iter().position(|f| *f < 0.0) {
                self.meet(line, end - 1 - n);
            }
        }
        self.values = values;
    }

    /// Finds the gradients where lines have just met something, and with them
    /// the surface itself, which is between two samples.
    fn arrive(&mut self, f: &VmFunction) {
        let fresh = std::mem::take(&mut self.fresh);
        self.points.iter_mut().for_each(Vec::clear);
        for &(line, sample) in &fresh {
            self.ask(line, sample);
        }
        // Slopes along x and y, then along z.
        for (slopes, along) in
            self.slopes.iter_mut().zip([[0, 1, 2], [1, 2, 0]])
        {
            let seeds: Vec<Seed<'_>> = self
                .sight
                .axes
                .iter()
                .map(|&a| Seed {
                    values: &self.points[a],
                    slopes: None,
                    axis: along[a],
                })
                .collect();
            slopes.clear();
            self.lanes.slopes(f, &seeds, fresh.len(), slopes);
        }
        let towards = self.grid.steps[2].as_vec3();
        let found = self.slopes[0].iter().zip(&self.slopes[1]);
        for (&(line, sample), (&[v, dx, dy], &[_, dz, _])) in
            fresh.iter().zip(found)
        {
            let gradient = Vec3::new(dx, dy, dz);
            let beyond = -v / gradient.dot(towards);
            let beyond = match beyond >= 0.0 {
                true => beyond.min(1.0),
                // It does not rise towards the viewer, or nobody knows.
                false => 0.5,
            };
            self.hits[line] = Some(Hit {
                depth: sample as f32 + beyond,
                gradient,
            });
        }
        self.fresh = fresh;
        self.fresh.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything sampled.
    fn dense(tree: &Tree, grid: &Grid) -> Vec<Option<usize>> {
        let mut ctx = Context::new();
        let root = ctx.import(tree);
        let [width, height, depth] = grid.size;
        let inside = |i: usize, j: usize, k: usize| {
            let [x, y, z] = (grid.origin
                + grid.steps[0] * i as f64
                + grid.steps[1] * j as f64
                + grid.steps[2] * k as f64)
                .to_array()
                .map(|c| c as f32);
            ctx.eval_xyz(root, x, y, z).unwrap() < 0.0
        };
        (0..width * height)
            .map(|n| {
                (0..depth).rev().find(|&k| inside(n % width, n / width, k))
            })
            .collect()
    }

    #[test]
    fn what_is_met_is_what_all_samples_say() {
        let (x, y, z) = Tree::axes();
        let wave = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
        let ball = x.square() + y.square() + z.square() - 30.0;
        let nowhere = x.clone() * 0.0 - (x.clone() - 9.0).sqrt();
        let shapes = [
            wave.max(ball.clone()),
            ball.clone().max(nowhere.neg()),
            // Not a number in half of space.
            ball.clone().max(x.sqrt().neg()),
            Tree::constant(-1.0),
            Tree::constant(1.0),
        ];
        let turn = glam::DMat3::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.2);
        let steps =
            turn.to_cols_array_2d().map(|c| DVec3::from_array(c) * 0.19);
        // Neither whole tiles nor whole boxes.
        let size = [69, 75, 90];
        let half: DVec3 =
            (0..3).map(|a| steps[a] * (0.5 * size[a] as f64)).sum();
        let grid = Grid {
            origin: -half,
            steps,
            size,
        };
        for (n, tree) in shapes.iter().enumerate() {
            let found = Sight::new(tree).unwrap().look(&grid).unwrap();
            let expected = dense(tree, &grid);
            assert_eq!(found.len(), expected.len());
            let mut other = 0;
            for (hit, sample) in found.iter().zip(&expected) {
                let same = match (hit, sample) {
                    (None, None) => true,
                    (Some(h), Some(k)) => {
                        let k = *k as f32;
                        (k..=k + 1.0).contains(&h.depth)
                    }
                    _ => false,
                };
                other += usize::from(!same);
            }
            // Sines may differ in the last bit.
            assert!(other <= 2, "shape {n}: {other}");
        }
    }

    /// On a ball the surface is known, and so is its gradient.
    #[test]
    fn surfaces_are_found_between_the_samples() {
        let (x, y, z) = Tree::axes();
        let ball = (x.square() + y.square() + z.square()).sqrt() - 5.0;
        let step = 0.25;
        let n = 50;
        let grid = Grid {
            origin: DVec3::splat(-0.5 * step * n as f64 + 0.01),
            steps: [DVec3::X * step, DVec3::Z * step, DVec3::NEG_Y * step],
            size: [n, n, n],
        };
        let grid = Grid {
            origin: grid.origin + DVec3::Y * (step * n as f64),
            ..grid
        };
        let found = Sight::new(&ball).unwrap().look(&grid).unwrap();
        let mut count = 0;
        for (line, hit) in found.iter().enumerate() {
            let Some(hit) = hit else { continue };
            let p = grid.origin
                + grid.steps[0] * (line % n) as f64
                + grid.steps[1] * (line / n) as f64
                + grid.steps[2] * f64::from(hit.depth);
            // Where it is not seen too flat.
            if p.y < -2.5 {
                assert!((p.length() - 5.0).abs() < 0.01, "{p}");
                let off = hit.gradient.as_dvec3() - p / 5.0;
                assert!(off.length() < 0.06, "{off} at {p}");
                count += 1;
            }
        }
        assert!(count > 800, "{count}");
    }
}
