//! Looks along the lines of one column of tiles: tiles, blocks, boxes, samples.
//! Each is looked at only where the larger one is undecided.

use super::spans::{crossings, hits};
use super::{Grid, Hit, Sight};
use crate::field::FieldError;
use crate::field::boxes::Boxes;
use crate::field::calls::Calls;
use crate::field::expr::{Expr, Simplifier};
use crate::field::lanes::{Lanes, Seed, Slopes};
use crate::field::source::Source;
use crate::interval::Interval;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Samples along the side of a tile.
pub(super) const TILE: usize = 64;
/// Samples along the side of a block.
const BLOCK: usize = 16;
/// Samples along the side of a box. A box is one pass of [`Lanes`].
const BOX: usize = 4;

/// What is known of a cube of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Known {
    Empty,
    Full,
    Open,
}

/// Looks along the lines of one column of tiles.
pub(super) struct Eye<'a> {
    sight: &'a Sight,
    grid: &'a Grid,
    /// The column's first line.
    at: [usize; 2],
    /// What the lines meet, row by row of the tile.
    pub hits: Vec<Option<Hit>>,
    /// For each row of the tile a bit for each line that has met something or is not
    /// looked along. What is behind it is not looked at.
    met: [u64; TILE],
    /// Lines that have just met something, each with its sample.
    fresh: Vec<(usize, usize)>,
    calls: Calls<'a>,
    ranges: Boxes,
    lanes: Lanes,
    simplifier: Simplifier,
    points: [Vec<f32>; 3],
    values: Vec<f32>,
    slopes: [Vec<[f32; 3]>; 2],
    found: Vec<Option<Interval>>,
}

impl<'a> Eye<'a> {
    pub(super) fn new(sight: &'a Sight, grid: &'a Grid) -> Self {
        Eye {
            sight,
            grid,
            at: [0; 2],
            hits: vec![None; TILE * TILE],
            met: [0; TILE],
            fresh: Vec::new(),
            calls: Calls::new(&sight.calls),
            ranges: Boxes::default(),
            lanes: Lanes::default(),
            simplifier: Simplifier::default(),
            points: Default::default(),
            values: Vec::new(),
            slopes: Default::default(),
            found: Vec::new(),
        }
    }

    /// Looks through a column of tiles that stand behind one another, the nearest
    /// first. Its first line of sight is `at`. Lines that are not `wanted` meet
    /// nothing.
    pub(super) fn column(
        &mut self,
        at: [usize; 2],
        wanted: &(dyn Fn(usize, usize) -> u64 + Sync),
    ) -> Result<(), FieldError> {
        self.at = at;
        let [i, j] = at;
        let [rows, _] = self.sides([i, j, 0], TILE);
        for (row, met) in self.met[rows].iter_mut().enumerate() {
            *met = !wanted(i, j + row);
        }
        if !self.is_covered([i, j, 0], TILE) && !self.cross()? {
            self.tiles(at)?;
        }
        Ok(())
    }

    /// Looks along the lines of the column at once, if the part is a solid that
    /// knows where they cross it.
    fn cross(&mut self) -> Result<bool, FieldError> {
        let Some(solid) = &self.sight.solid else {
            return Ok(false);
        };
        let Grid {
            origin,
            steps,
            size,
        } = *self.grid;
        let [i, j] = self.at;
        let [width, height] = [0, 1].map(|a| TILE.min(size[a] - self.at[a]));
        let lines = Grid {
            origin: origin + steps[0] * i as f64 + steps[1] * j as f64,
            steps,
            size: [width, height, size[2]],
        };
        self.sight.cancel.check()?;
        self.spend(&self.sight.f, width * height)?;
        let Some(found) = crossings(solid, &lines) else {
            return Ok(false);
        };
        let (met, all) = (&self.met, &mut self.hits);
        hits(&found, &lines, &mut |line, hit| {
            let [row, column] = [line / width, line % width];
            if met[row] & 1 << column == 0 {
                all[row * TILE + column].get_or_insert(hit);
            }
        });
        Ok(true)
    }

    /// Notes that a function is evaluated for `count` numbers.
    fn spend(&mut self, f: &Expr, count: usize) -> Result<(), FieldError> {
        let calls = self.calls.cost(f.read(&self.sight.sources));
        let of_one = f.f.size() as u64 + calls;
        self.sight.spend(of_one * count as u64)
    }

    /// Looks through the tiles of a column, which stand behind one another, the
    /// nearest first. The column's first line of sight is `at`.
    fn tiles(&mut self, at: [usize; 2]) -> Result<(), FieldError> {
        let sight = self.sight;
        let f = &sight.f;
        let tiles = self.grid.size[2].div_ceil(TILE);
        let tiles = (0..tiles).rev().map(|k| [at[0], at[1], k * TILE]);
        let tiles: Vec<[usize; 3]> = tiles.collect();
        for (tile, known) in self.sift(f, &tiles, TILE)? {
            sight.cancel.check()?;
            self.visit(f, tile, known, TILE)?;
        }
        Ok(())
    }

    /// Looks at one cube of a tile's or a block's size.
    fn visit(
        &mut self,
        f: &Expr,
        at: [usize; 3],
        known: Known,
        size: usize,
    ) -> Result<(), FieldError> {
        if known == Known::Empty || self.is_covered(at, size) {
            return Ok(());
        }
        if known == Known::Full {
            self.fill(at, size);
            return self.arrive(f);
        }
        let sources = &self.sight.sources;
        let extent = self.extent(at, size);
        self.calls.over(f.read(sources), std::iter::once(extent));
        let calls = &self.calls;
        let input = |slot: usize| match sources[slot] {
            Source::Coordinate(a) | Source::Part(a, _) => extent[a],
            Source::Call(c) => calls.range(c, 0),
        };
        let (_, trace) = self.ranges.range(&f.f, &input);
        let own = trace.map(|trace| self.simplifier.simpler(f, trace));
        let own = own.transpose()?;
        let g = own.as_ref().unwrap_or(f);
        let side = if size == TILE { BLOCK } else { BOX };
        let n = size / side;
        // The nearest parts come first.
        let parts: Vec<[usize; 3]> = (0..n * n * n)
            .map(|m| [m % n, m / n % n, n - 1 - m / (n * n)])
            .map(|part| [0, 1, 2].map(|a| at[a] + part[a] * side))
            .filter(|part| (0..3).all(|a| part[a] < self.grid.size[a]))
            .filter(|part| !self.is_covered(*part, side))
            .collect();
        let parts = self.sift(g, &parts, side)?;
        if side == BLOCK {
            for (part, known) in parts {
                self.visit(g, part, known, side)?;
            }
        } else {
            for layer in parts.chunk_by(|a, b| a.0[2] == b.0[2]) {
                self.boxes(g, layer)?;
            }
            self.arrive(g)?;
        }
        self.simplifier.recycle(own);
        Ok(())
    }

    /// What is known of cubes of one size, where there may be something.
    fn sift(
        &mut self,
        f: &Expr,
        cubes: &[[usize; 3]],
        size: usize,
    ) -> Result<Vec<([usize; 3], Known)>, FieldError> {
        // A range has two ends.
        self.spend(f, 2 * cubes.len())?;
        let sources = &self.sight.sources;
        let extents: Vec<[Interval; 3]> =
            cubes.iter().map(|&at| self.extent(at, size)).collect();
        self.found.clear();
        self.calls.over(f.read(sources), extents.iter().copied());
        let calls = &self.calls;
        let input = |slot: usize, k: usize| match sources[slot] {
            Source::Coordinate(a) | Source::Part(a, _) => extents[k][a],
            Source::Call(c) => calls.range(c, k),
        };
        self.lanes
            .ranges(&f.f, cubes.len(), &input, &mut self.found);
        let mut out = Vec::with_capacity(cubes.len());
        for (k, found) in self.found.iter().enumerate() {
            let range = match found {
                Some(range) => *range,
                None => self.ranges.range(&f.f, &|slot| input(slot, k)).0,
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
        Ok(out)
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

    /// The rows and columns of the tile that a cube has.
    fn sides(&self, at: [usize; 3], size: usize) -> [Range<usize>; 2] {
        [1, 0].map(|a| {
            let first = at[a] - self.at[a];
            first..first + size.min(self.grid.size[a] - at[a])
        })
    }

    /// The lines that pass through a cube and are still looked along.
    fn lines(
        &self,
        at: [usize; 3],
        size: usize,
    ) -> impl Iterator<Item = usize> + use<> {
        let [rows, columns] = self.sides(at, size);
        let met = self.met;
        rows.flat_map(move |j| {
            let row = met[j];
            let open = columns.clone().filter(move |i| row & 1 << i == 0);
            open.map(move |i| j * TILE + i)
        })
    }

    /// True if no line is looked along that reaches a cube.
    fn is_covered(&self, at: [usize; 3], size: usize) -> bool {
        let [rows, columns] = self.sides(at, size);
        let all = u64::MAX >> (TILE - columns.len()) << columns.start;
        self.met[rows].iter().all(|met| met & all == all)
    }

    /// Lets lines that have met nothing meet the front of a cube.
    fn fill(&mut self, at: [usize; 3], size: usize) {
        let front = (at[2] + size).min(self.grid.size[2]) - 1;
        for line in self.lines(at, size) {
            self.meet(line, front);
        }
    }

    /// Notes that a line meets its first sample inside.
    fn meet(&mut self, line: usize, sample: usize) {
        let (row, bit) = (line / TILE, 1 << (line % TILE));
        if self.met[row] & bit == 0 {
            self.met[row] |= bit;
            self.fresh.push((line, sample));
        }
    }

    /// Where a line begins.
    fn start(&self, line: usize) -> DVec3 {
        let Grid { origin, steps, .. } = self.grid;
        let (i, j) = (line % TILE + self.at[0], line / TILE + self.at[1]);
        *origin + steps[0] * i as f64 + steps[1] * j as f64
    }

    /// Adds a place to those that are to be evaluated. It may lie between two
    /// samples.
    fn ask(&mut self, line: usize, sample: f64) {
        let p = self.start(line) + self.grid.steps[2] * sample;
        for (list, c) in self.points.iter_mut().zip(p.to_array()) {
            list.push(c as f32);
        }
    }

    /// Adds samples of a line, the last one first.
    fn ask_all(&mut self, line: usize, samples: Range<usize>) {
        let (start, step) = (self.start(line), self.grid.steps[2]);
        for (a, list) in self.points.iter_mut().enumerate() {
            let at = |k| (start[a] + step[a] * k as f64) as f32;
            list.extend(samples.clone().rev().map(at));
        }
    }

    /// Values at the points that were asked for.
    fn evaluate(&mut self, f: &Expr, count: usize) {
        let points = self.points.each_ref().map(|p| &p[..]);
        let sources = &self.sight.sources;
        self.calls.at(f.read(sources), &points);
        // Inputs that are not read may have any values, as long as there are
        // enough.
        let mut inputs: Vec<&[f32]> = vec![points[0]; sources.len()];
        for &slot in f.inputs() {
            inputs[slot] = match sources[slot] {
                Source::Coordinate(a) | Source::Part(a, _) => points[a],
                Source::Call(c) => self.calls.values(c),
            };
        }
        self.values.clear();
        self.lanes.eval(&f.f, &inputs, count, &mut self.values);
    }

    /// Looks into several boxes beside each other.
    fn boxes(
        &mut self,
        f: &Expr,
        boxes: &[([usize; 3], Known)],
    ) -> Result<(), FieldError> {
        let mut asked: Vec<(usize, [usize; 2])> = Vec::new();
        self.points.iter_mut().for_each(Vec::clear);
        for &(at, known) in boxes {
            if known == Known::Full {
                self.fill(at, BOX);
                continue;
            }
            let end = (at[2] + BOX).min(self.grid.size[2]);
            for line in self.lines(at, BOX) {
                asked.push((line, [at[2], end]));
                self.ask_all(line, at[2]..end);
            }
        }
        let count = self.points[0].len();
        self.spend(f, count)?;
        self.evaluate(f, count);
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
        Ok(())
    }

    /// Finds the gradients where lines have just met something, and with them
    /// the surface itself, which lies between two samples.
    fn arrive(&mut self, f: &Expr) -> Result<(), FieldError> {
        let mut fresh = std::mem::take(&mut self.fresh);
        self.points.iter_mut().for_each(Vec::clear);
        for &(line, sample) in &fresh {
            self.ask(line, sample as f64);
        }
        let found = self.gradients(f, fresh.len())?;
        let towards = self.grid.steps[2].as_vec3();
        let mut behind = Vec::new();
        for (&(line, sample), (v, gradient)) in fresh.iter().zip(found) {
            let beyond = -v / gradient.dot(towards);
            let faces_away = beyond.is_nan() || beyond < 0.0;
            if faces_away {
                behind.push((line, sample));
            }
            let beyond = if faces_away { 0.5 } else { beyond.min(1.0) };
            self.hits[line] = Some(Hit {
                depth: sample as f32 + beyond,
                gradient,
            });
        }
        fresh.clear();
        self.fresh = fresh;
        self.come_in(&behind)
    }

    /// Values and gradients at the points that were asked for.
    fn gradients(
        &mut self,
        f: &Expr,
        count: usize,
    ) -> Result<Vec<(f32, Vec3)>, FieldError> {
        // The gradient takes two evaluations, each of a value and two slopes.
        self.spend(f, 6 * count)?;
        let points = self.points.each_ref().map(|p| &p[..]);
        // Slopes along x and y come first, then the slope along z.
        for (slopes, along) in
            self.slopes.iter_mut().zip([[0, 1, 2], [1, 2, 0]])
        {
            let sources = &self.sight.sources;
            self.calls.at_with_slopes(f.read(sources), points, along);
            let coordinate = |a: usize| Seed {
                values: points[a],
                slopes: Slopes::Coordinate(along[a]),
            };
            let mut seeds: Vec<Seed<'_>> =
                sources.iter().map(|_| coordinate(0)).collect();
            for &slot in f.inputs() {
                seeds[slot] = match sources[slot] {
                    Source::Coordinate(a) | Source::Part(a, _) => coordinate(a),
                    Source::Call(c) => Seed {
                        values: self.calls.values(c),
                        slopes: self.calls.slopes(c),
                    },
                };
            }
            slopes.clear();
            self.lanes.slopes(&f.f, &seeds, count, slopes);
        }
        let both = self.slopes[0].iter().zip(&self.slopes[1]);
        let joined = |(&[v, x, y], &[_, z, _]): (&[f32; 3], &[f32; 3])| {
            (v, Vec3::new(x, y, z))
        };
        Ok(both.map(joined).collect())
    }

    /// Near an edge the first sample inside may lie below a face that is turned
    /// away, which nobody sees. The gradient is then that of the place where the
    /// line comes in.
    fn come_in(&mut self, lines: &[(usize, usize)]) -> Result<(), FieldError> {
        /// Each halves the length in which the line comes in.
        const HALVES: usize = 6;
        if lines.is_empty() {
            return Ok(());
        }
        // The simpler function of a cube does not hold in front of it.
        let sight = self.sight;
        let f = &sight.f;
        // How far beyond the sample the line is inside, and outside.
        let mut ends = vec![[0.0, 1.0]; lines.len()];
        for _ in 0..HALVES {
            self.points.iter_mut().for_each(Vec::clear);
            for (&(line, sample), [inside, outside]) in lines.iter().zip(&ends)
            {
                self.ask(line, sample as f64 + 0.5 * (inside + outside));
            }
            self.spend(f, lines.len())?;
            self.evaluate(f, lines.len());
            for (v, ends) in self.values.iter().zip(&mut ends) {
                let middle = 0.5 * (ends[0] + ends[1]);
                ends[usize::from(*v >= 0.0 || v.is_nan())] = middle;
            }
        }
        self.points.iter_mut().for_each(Vec::clear);
        for (&(line, sample), [_, outside]) in lines.iter().zip(&ends) {
            self.ask(line, sample as f64 + outside);
        }
        let towards = self.grid.steps[2].as_vec3();
        let found = self.gradients(f, lines.len())?;
        for ((&(line, sample), end), (_, gradient)) in
            lines.iter().zip(ends).zip(found)
        {
            if gradient.dot(towards) > 0.0 {
                self.hits[line] = Some(Hit {
                    depth: sample as f32 + end[0] as f32,
                    gradient,
                });
            }
        }
        Ok(())
    }
}
