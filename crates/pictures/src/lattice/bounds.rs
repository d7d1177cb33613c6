//! Bounds of a lattice's values and derivatives over boxes.

use super::border::{Border, Stretch, floor};
use super::kernel::{Interpolation, Stretched};
use super::pyramid::{NONE, Pyramid, Range, both, widened};
use super::{Lattice, Layout, number};
use crate::numbers::{Numbers, with_numbers};

/// The most cells of a box that are looked at one by one.
const FEW_CELLS: i64 = 8;

/// A box in coordinates of the lattice: its ends along each axis.
pub(crate) type Ends = [Range; 3];

impl Lattice {
    /// The range of the values in a box.
    pub(crate) fn range(&self, over: Ends) -> Range {
        let over = self.near(over);
        let range = match self.cells(over) {
            Some(cells) => self.of_cells(&cells, over, false).0,
            None => {
                let all = self.stretches(over).map(|s| s.samples);
                let range = with_numbers!(&self.grid.numbers, data => {
                    let get = |at| number(data, self.grid.layout, at);
                    self.grid.values.range(all.map(|s| s[0]), all.map(|s| s[1]), get)
                });
                overshot(range, self.how.overshoot(self.axes())[0])
            }
        };
        let [factor, offset] = self.scale;
        let [a, b] = range.map(|v| v * factor + offset);
        widened([a.min(b), a.max(b)], self.rounding)
    }

    /// The ranges of the derivatives in a box, in coordinates of the lattice.
    pub(crate) fn slopes(&self, over: Ends) -> [Range; 3] {
        let over = self.near(over);
        let slopes = if self.how == Interpolation::Nearest {
            let [a, b] = self.range(over);
            let steps = self.grid.layout.size.map(|n| n > 1);
            let same = b - a <= 2.0 * self.rounding;
            let jumps = [f64::NEG_INFINITY, f64::INFINITY];
            return steps.map(|s| if s && !same { jumps } else { [0.0; 2] });
        } else if let Some(cells) = self.cells(over) {
            self.of_cells(&cells, over, true).1
        } else {
            self.of_differences(over)
        };
        let factor = self.scale[0];
        slopes.map(|slope| {
            let [a, b] = slope.map(|v| v * factor);
            widened([a.min(b), a.max(b)], self.rounding)
        })
    }

    /// The number of axes along which anything changes.
    fn axes(&self) -> i32 {
        self.grid.layout.size.iter().filter(|n| **n > 1).count() as i32
    }

    /// A box in which the same values stand, with ends that are not too far
    /// away to be counted.
    fn near(&self, over: Ends) -> Ends {
        std::array::from_fn(|a| {
            let n = self.grid.layout.size[a];
            let [from, to] = over[a];
            let border = self.border[a];
            match border {
                _ if n == 1 => [0.0; 2],
                Border::Clamp => [from, to].map(|u| border.near(u, n)),
                // All of it, with both of its borders.
                _ if to - from >= 2.0 * n as f64 => [0.0, 2.0 * n as f64],
                _ => {
                    let near = border.near(from, n);
                    [near, to - from + near]
                }
            }
        })
    }

    /// The cells that a box meets, if they are few.
    fn cells(&self, over: Ends) -> Option<[[i64; 2]; 3]> {
        if self.how == Interpolation::Nearest {
            return None;
        }
        let cells = over.map(|ends| ends.map(floor));
        let count = |[a, b]: [i64; 2]| b - a + 1;
        let few = cells.iter().try_fold(1, |all, &c| {
            let n = count(c);
            (n <= FEW_CELLS).then_some(all * n)
        });
        few.filter(|all| *all <= FEW_CELLS).map(|_| cells)
    }

    /// The samples that count in a box.
    fn stretches(&self, over: Ends) -> [Stretch; 3] {
        let [before, after] = self.how.reach();
        let half = match self.how {
            Interpolation::Nearest => 0.5,
            _ => 0.0,
        };
        std::array::from_fn(|a| {
            let [from, to] = over[a].map(|u| floor(u + half));
            let n = self.grid.layout.size[a];
            self.border[a].stretch([from + before, to + after], n)
        })
    }

    fn number(&self, at: [usize; 3]) -> f64 {
        with_numbers!(&self.grid.numbers, data => number(data, self.grid.layout, at))
    }

    /// The differences of samples and the next ones along an axis.
    fn steps(&self, axis: usize) -> &Pyramid {
        let (layout, border) = (self.grid.layout, self.border);
        self.steps[axis].get_or_init(|| {
            with_numbers!(&self.grid.numbers, data => {
                let step = step(data, layout, border[axis], axis);
                Pyramid::new(layout.size, step)
            })
        })
    }

    /// The range of some of the differences along an axis.
    fn steps_between(&self, axis: usize, samples: [[usize; 2]; 3]) -> Range {
        let (layout, border) = (self.grid.layout, self.border);
        let pyramid = self.steps(axis);
        with_numbers!(&self.grid.numbers, data => {
            let step = step(data, layout, border[axis], axis);
            pyramid.range(samples.map(|s| s[0]), samples.map(|s| s[1]), step)
        })
    }

    /// Bounds of derivatives by the differences of samples.
    fn of_differences(&self, over: Ends) -> [Range; 3] {
        let stretches = self.stretches(over);
        let overshoot = self.how.overshoot(self.axes())[1];
        std::array::from_fn(|axis| {
            if self.grid.layout.size[axis] == 1 {
                return [0.0; 2];
            }
            let mut samples = stretches.map(|s| s.samples);
            let Stretch {
                samples: own,
                inside,
            } = stretches[axis];
            // The last sample's step leads out of the stretch.
            let [first, last] = own;
            if inside {
                samples[axis] = [first, last.saturating_sub(1).max(first)];
            }
            let [a, b] = self.steps_between(axis, samples);
            let range = match self.border[axis] {
                _ if inside => [a, b],
                Border::Clamp | Border::Repeat => [a.min(0.0), b.max(0.0)],
                Border::Mirror => [a.min(-b).min(0.0), b.max(-a).max(0.0)],
            };
            overshot(range, overshoot)
        })
    }

    /// Bounds by the Bézier points of the pieces of some cells in a box: of
    /// slopes if `steep`, or else of values.
    fn of_cells(
        &self,
        cells: &[[i64; 2]; 3],
        over: Ends,
        steep: bool,
    ) -> (Range, [Range; 3]) {
        let mut all = (NONE, [NONE; 3]);
        let [x, y, z] = *cells;
        for k in z[0]..=z[1] {
            for j in y[0]..=y[1] {
                for i in x[0]..=x[1] {
                    let (range, slopes) = self.of_cell([i, j, k], over, steep);
                    all.0 = both(all.0, range);
                    for (all, slope) in all.1.iter_mut().zip(slopes) {
                        *all = both(*all, slope);
                    }
                }
            }
        }
        all
    }

    fn of_cell(
        &self,
        cell: [i64; 3],
        over: Ends,
        steep: bool,
    ) -> (Range, [Range; 3]) {
        let size = self.grid.layout.size;
        let weights: [Stretched; 3] = std::array::from_fn(|a| {
            let corner = cell[a] as f64;
            let [from, to] = over[a].map(|u| (u - corner).clamp(0.0, 1.0));
            Stretched::new(self.how, from, to)
        });
        let [before, after] = self.how.reach();
        let n = (after - before + 1) as usize;
        let mut samples = [0.0; 64];
        let counts = size.map(|s| if s == 1 { 1 } else { n });
        for k in 0..counts[2] {
            for j in 0..counts[1] {
                for i in 0..counts[0] {
                    let tap = [i, j, k];
                    let at = std::array::from_fn(|a| {
                        let i = cell[a] + before + tap[a] as i64;
                        self.border[a].sample(i, size[a])
                    });
                    samples[i + 4 * (j + 4 * k)] = self.number(at);
                }
            }
        }
        let bezier = |slope: Option<usize>| {
            let mut points = samples;
            let mut counts = counts;
            for axis in 0..3 {
                if counts[axis] == 1 && size[axis] == 1 {
                    continue;
                }
                let value = self.points(&weights[axis], slope == Some(axis));
                combine(&mut points, &mut counts, axis, value);
            }
            let mut range = NONE;
            for k in 0..counts[2] {
                for j in 0..counts[1] {
                    for i in 0..counts[0] {
                        let v = points[i + 4 * (j + 4 * k)];
                        range = both(range, [v, v]);
                    }
                }
            }
            range
        };
        let slopes = [0, 1, 2].map(|a| {
            if !steep || size[a] == 1 {
                [0.0; 2]
            } else {
                bezier(Some(a))
            }
        });
        let values = if steep { [0.0; 2] } else { bezier(None) };
        (values, slopes)
    }

    /// The rows of weights that matter: a straight line's ends, and its one
    /// slope.
    fn points<'a>(
        &self,
        weights: &'a Stretched,
        slope: bool,
    ) -> (&'a [[f64; 4]], usize) {
        match (self.how, slope) {
            (Interpolation::Cubic, false) => (&weights.value, 1),
            (Interpolation::Cubic, true) => (&weights.slope, 1),
            (_, false) => (&weights.value, 3),
            (_, true) => (&weights.slope[..1], 1),
        }
    }
}

/// The difference of a sample and the next along an axis; of the last and the
/// first, if the axis repeats.
fn step<T: Copy + Into<f64>>(
    data: &[T],
    layout: Layout,
    border: Border,
    axis: usize,
) -> impl Fn([usize; 3]) -> f64 {
    move |at| {
        let n = layout.size[axis];
        let mut next = at;
        next[axis] = border.sample(at[axis] as i64 + 1, n);
        number(data, layout, next) - number(data, layout, at)
    }
}

/// Replaces the samples along an axis by points, each a weighed sum of them.
fn combine(
    samples: &mut [f64; 64],
    counts: &mut [usize; 3],
    axis: usize,
    (weights, every): (&[[f64; 4]], usize),
) {
    let step = 1 << (2 * axis);
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    let (step_a, step_b) = (1 << (2 * a), 1 << (2 * b));
    let n = counts[axis];
    let mut made = 0;
    for i in 0..counts[a] {
        for j in 0..counts[b] {
            let first = i * step_a + j * step_b;
            let old: [f64; 4] = std::array::from_fn(|t| {
                if t < n {
                    samples[first + t * step]
                } else {
                    0.0
                }
            });
            made = 0;
            for row in weights.iter().step_by(every) {
                let sum = row.iter().zip(old).map(|(w, v)| w * v).sum();
                samples[first + made * step] = sum;
                made += 1;
            }
        }
    }
    counts[axis] = made;
}

/// A range with what interpolation may go beyond it.
fn overshot([a, b]: Range, share: f64) -> Range {
    widened([a, b], share * (b - a))
}
