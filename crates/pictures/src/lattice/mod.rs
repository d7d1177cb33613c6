//! Numbers at the points of a lattice, and a function that goes between them.
//!
//! In: numbers, how far apart they are in memory along each axis, how to go
//! between them, and where in space the lattice lies. Out: values, gradients,
//! and bounds of both over boxes.
//!
//! Coordinates in the lattice, u, count samples: sample i is at u = i. Bounds
//! over a box that meets a few cells (what is between neighbouring samples) are
//! those of Bézier points of the pieces of the cells in the box, so that they
//! close in on the values as boxes get small. Bounds over larger boxes are
//! those of all samples that count there, from a [`Pyramid`], and for cubic
//! interpolation as much wider as it can go beyond samples.

mod border;
mod bounds;
mod kernel;
mod place;
mod pyramid;
#[cfg(test)]
mod tests;

pub use border::Border;
pub use kernel::Interpolation;
pub(crate) use place::Place;
pub(crate) use pyramid::Range;

use crate::numbers::{Numbers, with_numbers};
use glam::DVec3;
use kernel::{Taps, with_taps};
use pyramid::Pyramid;
use std::sync::{Arc, OnceLock};

/// Where the samples of a lattice are in memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Layout {
    /// How many samples there are along each axis.
    pub(crate) size: [usize; 3],
    /// The number of the sample from which all axes start.
    pub(crate) start: usize,
    /// How many numbers the next sample along each axis is away.
    pub(crate) steps: [isize; 3],
}

impl Layout {
    /// The first axis runs fastest.
    pub(crate) fn first_fastest(size: [usize; 3]) -> Layout {
        let [a, b, _] = size;
        Layout {
            size,
            start: 0,
            steps: [1, a as isize, (a * b) as isize],
        }
    }

    /// A picture: rows from left to right, the topmost first. The second axis
    /// points upwards.
    pub(crate) fn picture(width: usize, height: usize) -> Layout {
        Layout {
            size: [width, height, 1],
            start: width * (height - 1),
            steps: [1, -(width as isize), 0],
        }
    }

    /// The place of a sample in memory.
    pub(crate) fn at(&self, [i, j, k]: [usize; 3]) -> usize {
        let [a, b, c] = self.steps;
        let step = i as isize * a + j as isize * b + k as isize * c;
        self.start.wrapping_add_signed(step)
    }
}

/// Numbers at the points of a lattice. Many functions may share them.
#[derive(Debug)]
pub(crate) struct Grid {
    numbers: Numbers,
    layout: Layout,
    values: Pyramid,
}

impl Grid {
    /// The numbers have to be as many as the layout says.
    pub(crate) fn new(numbers: Numbers, layout: Layout) -> Grid {
        let values = with_numbers!(&numbers, data => {
            Pyramid::new(layout.size, |at| number(data, layout, at))
        });
        Grid {
            numbers,
            layout,
            values,
        }
    }

    fn bytes(&self) -> usize {
        self.numbers.bytes() + self.values.bytes()
    }

    pub(crate) fn numbers(&self) -> &Numbers {
        &self.numbers
    }

    pub(crate) fn layout(&self) -> Layout {
        self.layout
    }

    /// The number that stands for white.
    pub(crate) fn white(&self) -> f64 {
        self.numbers.white()
    }
}

/// A function on a lattice. Where it lies in space is for [`Place`] to say.
#[derive(Debug)]
pub(crate) struct Lattice {
    grid: Arc<Grid>,
    how: Interpolation,
    border: [Border; 3],
    /// A value is a number times the first plus the second.
    scale: [f64; 2],
    /// Of the differences of each sample and the next along each axis, if they
    /// are ever asked for.
    steps: [OnceLock<Pyramid>; 3],
    /// What rounding may do to values and to derivatives at most.
    rounding: f64,
}

impl Lattice {
    /// A function on a grid. A value is a number times the first of `scale` plus
    /// the second.
    pub(crate) fn new(
        grid: Arc<Grid>,
        how: Interpolation,
        border: [Border; 3],
        scale: [f64; 2],
    ) -> Lattice {
        let [a, b] = grid.values.all();
        // A value is a sum of 64 products, and their sizes sum to twice the
        // greatest number.
        let size = a.abs().max(b.abs()) * scale[0].abs() + scale[1].abs();
        Lattice {
            grid,
            how,
            border,
            scale,
            steps: Default::default(),
            rounding: 256.0 * f64::EPSILON * size,
        }
    }

    /// The numbers, for other functions of them.
    pub(crate) fn grid(&self) -> &Arc<Grid> {
        &self.grid
    }

    pub(crate) fn size(&self) -> [usize; 3] {
        self.grid.layout.size
    }

    pub(crate) fn interpolation(&self) -> Interpolation {
        self.how
    }

    pub(crate) fn border(&self) -> [Border; 3] {
        self.border
    }

    /// A value is a number times the first plus the second.
    pub(crate) fn scale(&self) -> [f64; 2] {
        self.scale
    }

    /// Tells all on which it depends.
    pub(crate) fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        let Layout { size, start, steps } = self.grid.layout;
        let layout = [size, [start; 3], steps.map(isize::cast_unsigned)];
        for n in layout.as_flattened() {
            tell(&(*n as u64).to_le_bytes());
        }
        let borders = self.border.map(|b| b as u8);
        tell(&[self.how as u8, borders[0], borders[1], borders[2]]);
        for v in self.scale {
            tell(&v.to_le_bytes());
        }
        self.grid.numbers.contents(tell);
    }

    /// Its memory, bytes, with that of the grid, which others may share.
    pub(crate) fn bytes(&self) -> usize {
        let steps = self.steps.iter().filter_map(|steps| steps.get());
        self.grid.bytes() + steps.map(Pyramid::bytes).sum::<usize>()
    }

    /// The grid's address and its memory, bytes.
    pub(crate) fn shared(&self) -> (usize, usize) {
        (Arc::as_ptr(&self.grid).addr(), self.grid.bytes())
    }

    /// The samples around a place with their weights, along each axis.
    #[inline(always)]
    fn taps<const N: usize>(
        &self,
        how: Interpolation,
        u: DVec3,
    ) -> [Taps<N>; 3] {
        let (size, border) = (self.grid.layout.size, self.border);
        [
            Taps::new(how, border[0], u.x, size[0]),
            Taps::new(how, border[1], u.y, size[1]),
            Taps::new(how, border[2], u.z, size[2]),
        ]
    }

    /// The value and the gradient in coordinates of the lattice.
    pub(crate) fn at(&self, u: DVec3) -> (f64, DVec3) {
        let (value, slope) = with_taps!(self.how, N, how => {
            let taps = self.taps::<N>(how, u);
            with_numbers!(&self.grid.numbers, data => {
                weighed(&taps, |at| number(data, self.grid.layout, at))
            })
        });
        (value * self.scale[0] + self.scale[1], slope * self.scale[0])
    }

    /// The values at places.
    pub(crate) fn values(
        &self,
        places: impl Iterator<Item = Option<DVec3>>,
        out: &mut Vec<f32>,
    ) {
        let [factor, offset] = self.scale;
        with_taps!(self.how, N, how => with_numbers!(&self.grid.numbers, data => {
            out.extend(places.map(|place| {
                place.map_or(f32::NAN, |u| {
                    let taps = self.taps::<N>(how, u);
                    let value = sum(&taps, |at| number(data, self.grid.layout, at));
                    (value * factor + offset) as f32
                })
            }));
        }));
    }
}

/// A sample's number.
#[inline]
fn number<T: Copy + Into<f64>>(
    data: &[T],
    layout: Layout,
    at: [usize; 3],
) -> f64 {
    data.get(layout.at(at)).map_or(0.0, |v| (*v).into())
}

/// The weighed sum of samples, and its gradient.
#[inline]
fn weighed<const N: usize>(
    [x, y, z]: &[Taps<N>; 3],
    get: impl Fn([usize; 3]) -> f64,
) -> (f64, DVec3) {
    let (mut value, mut slope) = (0.0, DVec3::ZERO);
    for k in 0..z.n.min(N) {
        let (mut v, mut s) = (0.0, DVec3::ZERO);
        for j in 0..y.n.min(N) {
            let (mut row, mut along) = (0.0, 0.0);
            for i in 0..x.n.min(N) {
                let at = get([x.sample[i], y.sample[j], z.sample[k]]);
                row += x.weight[i] * at;
                along += x.slope[i] * at;
            }
            v += y.weight[j] * row;
            s.x += y.weight[j] * along;
            s.y += y.slope[j] * row;
        }
        value += z.weight[k] * v;
        slope.x += z.weight[k] * s.x;
        slope.y += z.weight[k] * s.y;
        slope.z += z.slope[k] * v;
    }
    (value, slope)
}

/// The weighed sum of samples, as [`weighed`] has it.
#[inline]
fn sum<const N: usize>(
    [x, y, z]: &[Taps<N>; 3],
    get: impl Fn([usize; 3]) -> f64,
) -> f64 {
    let mut value = 0.0;
    for k in 0..z.n.min(N) {
        let mut v = 0.0;
        for j in 0..y.n.min(N) {
            let mut row = 0.0;
            for i in 0..x.n.min(N) {
                let at = get([x.sample[i], y.sample[j], z.sample[k]]);
                row += x.weight[i] * at;
            }
            v += y.weight[j] * row;
        }
        value += z.weight[k] * v;
    }
    value
}
