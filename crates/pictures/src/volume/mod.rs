//! Volumes as functions: what stands at each place of a lattice in space, such
//! as the densities of a CT.

mod nifti;
mod nrrd;
#[cfg(test)]
mod tests;

use crate::lattice::{Border, Grid, Interpolation, Lattice, Layout, Place};
use crate::npy;
use crate::numbers::Numbers;
use crate::sheets::Sheets;
use glam::{DAffine3, DMat3, DVec3};
use isocontour::{Bounds, Data};
use isoslice_base::problem::{NamedProblem, Problem};
use std::sync::Arc;

/// What the axes of an array are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// `a[x, y, z]`, as formulas and most arrays made for them have it.
    #[default]
    Xyz,
    /// `a[z, y, x]`, as images and stacks of them have it.
    Zyx,
}

/// How a volume is read and laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VolumeOptions {
    /// How far apart samples are along each axis of the array, x first, mm.
    /// Without it, the file's header says it; arrays have 1.
    pub spacing_mm: Option<DVec3>,
    /// Where the first sample lies, mm. Without it, the file's header says it;
    /// arrays begin at the origin.
    pub origin_mm: Option<DVec3>,
    /// What the axes of an array or a `.npy` file are. Default:
    /// `a[x, y, z]`. Files with a header say it themselves.
    pub axes: Axes,
    /// How to go from sample to sample. Default: linear.
    pub interpolation: Interpolation,
    /// What is beyond the outermost samples, along each axis of the array.
    /// Default: the value of the outermost sample.
    pub border: [Border; 3],
    /// What stands where the file has NaN or the infinite. Without it, such a
    /// file is refused.
    pub missing: Option<f64>,
}

/// A volume as a function of x, y and z.
///
/// Its values are those of the file, in the file's unit (a NIfTI's slope and
/// intercept are applied). Its coordinates are those of the file's header, in
/// mm: NRRD says which way its axes point by its `space`, and NIfTI's point
/// right, front and up. Neither is turned.
#[derive(Debug)]
pub struct Volume {
    name: String,
    place: Place,
    from_lattice: DAffine3,
}

/// What a reader returns.
struct Read {
    numbers: Numbers,
    layout: Layout,
    /// A value is a number times the first plus the second.
    scale: [f64; 2],
    /// The way from each sample to the next along each axis, and the place of
    /// the first, mm. None: as for an array.
    lies: Option<DAffine3>,
}

impl Volume {
    /// Reads NRRD (attached; raw, gzip or text), NIfTI (`.nii`, `.nii.gz`), or
    /// a `.npy` file of two or three axes (with two, it is the same at all
    /// heights). Which of them it is, its first bytes say.
    ///
    /// # Errors
    /// If the file is none of these, broken, or too large, or an option makes
    /// no sense.
    pub fn read(
        name: &str,
        bytes: &[u8],
        options: &VolumeOptions,
    ) -> Result<Volume, NamedProblem> {
        let made = if bytes.starts_with(nrrd::MAGIC) {
            nrrd::read(bytes)
        } else if bytes.starts_with(npy::MAGIC) {
            npy::read(bytes).and_then(|array| of_array(array, options.axes))
        } else {
            nifti::read(bytes)
        };
        made.and_then(|read| Volume::laid_out(name, read, options))
            .map_err(|problem| NamedProblem::new(name, problem))
    }

    /// A volume of an array in memory, of two or three axes, the last of which
    /// runs fastest.
    ///
    /// # Errors
    /// If there are not as many numbers as the shape says, or an option makes
    /// no sense.
    pub fn from_numbers(
        name: &str,
        shape: &[usize],
        numbers: Numbers,
        options: &VolumeOptions,
    ) -> Result<Volume, NamedProblem> {
        let counted =
            shape.iter().try_fold(1_usize, |all, n| all.checked_mul(*n));
        let made = if counted != Some(numbers.len()) || numbers.is_empty() {
            Err(format!(
                "{} numbers are no array of the shape {shape:?}",
                numbers.len()
            ))
        } else {
            let array = npy::Array {
                numbers,
                shape: shape.to_vec(),
                fortran: false,
            };
            of_array(array, options.axes)
        };
        made.and_then(|read| Volume::laid_out(name, read, options))
            .map_err(|problem| NamedProblem::new(name, problem))
    }

    fn laid_out(
        name: &str,
        read: Read,
        options: &VolumeOptions,
    ) -> Problem<Volume> {
        let Read {
            mut numbers,
            layout,
            scale,
            lies,
        } = read;
        numbers.without_nan(options.missing)?;
        if !scale.iter().all(|s| s.abs() < 1e30) {
            let [a, b] = scale;
            return Err(format!("its values are to be {a} · n + {b}"));
        }
        let from_lattice =
            lies_at(lies.unwrap_or(DAffine3::IDENTITY), options)?;
        let lattice = Lattice::new(
            Arc::new(Grid::new(numbers, layout)),
            options.interpolation,
            options.border,
            scale,
        );
        Ok(Volume {
            name: format!("volume({name:?})"),
            place: Place {
                lattice,
                to_lattice: from_lattice.inverse(),
            },
            from_lattice,
        })
    }

    /// How many samples there are along each axis.
    pub fn samples(&self) -> [usize; 3] {
        self.place.lattice.size()
    }

    /// Its samples, as a sheet for each along the third axis.
    pub fn sheets(&self) -> Sheets<'_> {
        Sheets::of_place(&self.place)
    }

    /// The box around all samples, mm.
    pub fn bounds(&self) -> Bounds {
        let last = self.samples().map(|n| n as f64 - 1.0);
        let corner = |i: usize| {
            let at: [f64; 3] = std::array::from_fn(|a| {
                if i >> a & 1 == 1 { last[a] } else { 0.0 }
            });
            self.from_lattice.transform_point3(at.into())
        };
        Bounds::around((0..8).map(corner))
    }
}

/// Where the lattice lies after the options had their say.
fn lies_at(lies: DAffine3, options: &VolumeOptions) -> Problem<DAffine3> {
    let mut columns: [DVec3; 3] = std::array::from_fn(|a| lies.matrix3.col(a));
    if let Some(spacing) = options.spacing_mm {
        for (column, mm) in columns.iter_mut().zip(spacing.to_array()) {
            if !(1e-6..=1e6).contains(&mm) {
                return Err(format!(
                    "the spacing is to be {mm} mm; give one from 0.000001 to \
                     1000000"
                ));
            }
            *column = column.normalize_or_zero() * mm;
        }
    }
    let matrix3 = DMat3::from_cols(columns[0], columns[1], columns[2]);
    let translation = options.origin_mm.unwrap_or(lies.translation);
    let sizes: f64 = columns.iter().map(|c| c.length()).product();
    let flat = matrix3.determinant().abs() < 1e-6 * sizes;
    let odd = columns.iter().any(|c| !(1e-9..=1e9).contains(&c.length()));
    let far = !translation.is_finite() || translation.length() > 1e12;
    if flat || odd || far {
        return Err(format!(
            "its axes are {columns:?} from {translation}, which is no lattice; \
             mend the header, or give the spacing and the origin"
        ));
    }
    Ok(DAffine3::from_mat3_translation(matrix3, translation))
}

/// An array as a volume.
fn of_array(array: npy::Array, axes: Axes) -> Problem<Read> {
    let npy::Array {
        numbers,
        shape,
        fortran,
    } = array;
    if !(2..=3).contains(&shape.len()) {
        return Err(format!(
            "it has {} axes; a volume has two or three",
            shape.len()
        ));
    }
    // The number of numbers from one to the next along each axis of the array.
    let mut steps = vec![1; shape.len()];
    for axis in 1..shape.len() {
        if fortran {
            steps[axis] = steps[axis - 1] * shape[axis - 1];
        } else {
            let at = shape.len() - 1 - axis;
            steps[at] = steps[at + 1] * shape[at + 1];
        }
    }
    let mut all: Vec<(usize, usize)> = shape.into_iter().zip(steps).collect();
    if axes == Axes::Zyx {
        all.reverse();
    }
    all.resize(3, (1, 0));
    let layout = Layout {
        size: [all[0].0, all[1].0, all[2].0],
        start: 0,
        steps: [all[0].1, all[1].1, all[2].1].map(|step| step as isize),
    };
    Ok(Read {
        numbers,
        layout,
        scale: [1.0, 0.0],
        lies: None,
    })
}

impl Data for Volume {
    fn name(&self) -> &str {
        &self.name
    }

    fn at(&self, p: DVec3) -> (f64, DVec3) {
        self.place.at(p)
    }

    fn values(&self, places: [&[f32]; 3], out: &mut Vec<f32>) {
        self.place.values(places, out);
    }

    fn range(&self, over: &Bounds) -> [f64; 2] {
        self.place.range(over)
    }

    fn slopes(&self, over: &Bounds) -> [[f64; 2]; 3] {
        self.place.slopes(over)
    }

    fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        self.place.contents(tell);
    }

    fn bytes(&self) -> usize {
        self.place.lattice.bytes()
    }
}
