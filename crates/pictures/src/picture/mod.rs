//! Pictures as functions: brightness over x and y, the same at all heights.
//!
//! ```text
//!  y = height ┌───────────┐   The lower left corner is at the origin, and the
//!             │ ┌─┬─┐     │   picture spans its width along x and its height
//!             │ │·│·│ …   │   along y. A pixel's value is that at its centre.
//!           0 └───────────┘   Beyond the edges the border says what stands.
//!             0          width
//! ```

mod jpeg;
mod png;

use crate::lattice::{Border, Grid, Interpolation, Lattice, Layout, Place};
use crate::npy;
use crate::numbers::{Numbers, count};
use crate::sheets::Sheets;
use glam::{DAffine3, DMat3, DVec2, DVec3};
use isocontour::{Bounds, Data};
use isoslice_base::problem::{NamedProblem, Problem};
use std::sync::Arc;

/// The most pixels of a picture: 8192 × 8192.
const MOST_PIXELS: usize = 1 << 26;

/// What transparent pixels are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TransparentAs {
    /// A picture on paper of this brightness, 0 to 1.
    Paper(f64),
    /// The transparency itself: the function is 1 where the picture is opaque
    /// and 0 where it is transparent, whatever its colours.
    Mask,
}

/// How a picture is read and laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureOptions {
    /// Width, mm. Without it, it follows from the height; without either, a
    /// pixel is 1 mm wide.
    pub width_mm: Option<f64>,
    /// Height, mm. Without it, it follows from the width: pixels are square.
    pub height_mm: Option<f64>,
    /// How to go from pixel to pixel.
    pub interpolation: Interpolation,
    /// What is beyond the left and right, and the lower and upper edges.
    pub border: [Border; 2],
    /// What transparent pixels are. Default: white paper.
    pub transparent: TransparentAs,
    /// What stands where a `.npy` file has NaN or the infinite. Without it,
    /// such a file is refused.
    pub missing: Option<f64>,
}

impl Default for PictureOptions {
    fn default() -> Self {
        PictureOptions {
            width_mm: None,
            height_mm: None,
            interpolation: Interpolation::Linear,
            border: [Border::Clamp; 2],
            transparent: TransparentAs::Paper(1.0),
            missing: None,
        }
    }
}

/// A picture as a function: 0 where it is black, 1 where it is white.
///
/// Colours count by their brightness as it is stored (luma, 0.299 red + 0.587
/// green + 0.114 blue), which most programs show as "grey". Numbers of a `.npy`
/// file are divided by the greatest of their kind if they are whole and have 8 or 16
/// bits, and are taken as they are if not. True is white.
#[derive(Debug)]
pub struct Picture {
    name: String,
    place: Place,
    size_mm: DVec2,
}

impl Picture {
    /// Reads a PNG, a JPEG or a `.npy` file of two axes (rows from the top,
    /// columns). Which of them it is, its first bytes say.
    ///
    /// # Errors
    /// If the file is none of these, broken, or too large, or an option makes
    /// no sense.
    pub fn read(
        name: &str,
        bytes: &[u8],
        options: &PictureOptions,
    ) -> Result<Picture, NamedProblem> {
        let made = pixels(bytes, options)
            .and_then(|pixels| Picture::laid_out(name, pixels, options));
        made.map_err(|problem| NamedProblem::new(name, problem))
    }

    /// A picture of numbers in memory: rows from left to right, the topmost
    /// first. Whole numbers are divided by the greatest of their kind.
    ///
    /// # Errors
    /// If there are not as many numbers as the size says, or an option makes no
    /// sense.
    pub fn from_numbers(
        name: &str,
        [width, height]: [usize; 2],
        numbers: Numbers,
        options: &PictureOptions,
    ) -> Result<Picture, NamedProblem> {
        let layout = || {
            if width.checked_mul(height) != Some(numbers.len())
                || numbers.is_empty()
            {
                return Err(format!(
                    "{} numbers are no picture of {width} × {height}",
                    numbers.len()
                ));
            }
            Ok(Layout::picture(width, height))
        };
        let made = layout().and_then(|layout| {
            Picture::laid_out(name, Pixels { numbers, layout }, options)
        });
        made.map_err(|problem| NamedProblem::new(name, problem))
    }

    /// Its pixels once more, laid out otherwise. What is transparent or missing is
    /// as it was read.
    ///
    /// # Errors
    /// If an option makes no sense.
    pub fn again(
        &self,
        name: &str,
        options: &PictureOptions,
    ) -> Result<Picture, NamedProblem> {
        let grid = self.place.lattice.grid().clone();
        Picture::of(name, grid, self.pixels(), options)
            .map_err(|problem| NamedProblem::new(name, problem))
    }

    fn laid_out(
        name: &str,
        pixels: Pixels,
        options: &PictureOptions,
    ) -> Problem<Picture> {
        let Pixels {
            mut numbers,
            layout,
        } = pixels;
        numbers.without_nan(options.missing)?;
        let [columns, rows, _] = layout.size;
        let grid = Arc::new(Grid::new(numbers, layout));
        Picture::of(name, grid, [columns, rows], options)
    }

    fn of(
        name: &str,
        grid: Arc<Grid>,
        [columns, rows]: [usize; 2],
        options: &PictureOptions,
    ) -> Problem<Picture> {
        let size_mm = size_mm(columns, rows, options)?;
        let pixels = DVec2::new(columns as f64, rows as f64);
        let [x, y] = options.border;
        let scale = [1.0 / grid.white(), 0.0];
        let lattice = Lattice::new(
            grid,
            options.interpolation,
            [x, y, Border::Clamp],
            scale,
        );
        let to_lattice = DAffine3 {
            matrix3: DMat3::from_diagonal((pixels / size_mm).extend(0.0)),
            translation: DVec3::new(-0.5, -0.5, 0.0),
        };
        Ok(Picture {
            name: format!("image({name:?})"),
            place: Place {
                lattice,
                to_lattice,
            },
            size_mm,
        })
    }

    /// Its pixels, as one sheet.
    pub fn sheets(&self) -> Sheets<'_> {
        Sheets::of_place(&self.place)
    }

    /// Width and height, mm.
    pub fn size_mm(&self) -> DVec2 {
        self.size_mm
    }

    /// Width and height, pixels.
    pub fn pixels(&self) -> [usize; 2] {
        let [width, height, _] = self.place.lattice.size();
        [width, height]
    }
}

/// The width and the height, mm.
fn size_mm(
    columns: usize,
    rows: usize,
    options: &PictureOptions,
) -> Problem<DVec2> {
    let of = |what: &str, given: Option<f64>| match given {
        Some(mm) if !(1e-6..=1e6).contains(&mm) => Err(format!(
            "its {what} is to be {mm} mm; give one from 0.000001 to 1000000"
        )),
        given => Ok(given),
    };
    let (columns, rows) = (columns as f64, rows as f64);
    let width = of("width", options.width_mm)?;
    let height = of("height", options.height_mm)?;
    Ok(match (width, height) {
        (Some(width), Some(height)) => DVec2::new(width, height),
        (Some(width), None) => DVec2::new(width, width / columns * rows),
        (None, Some(height)) => DVec2::new(height / rows * columns, height),
        (None, None) => DVec2::new(columns, rows),
    })
}

/// What a reader returns.
struct Pixels {
    numbers: Numbers,
    layout: Layout,
}

fn pixels(bytes: &[u8], options: &PictureOptions) -> Problem<Pixels> {
    if let TransparentAs::Paper(paper) = options.transparent
        && !(0.0..=1.0).contains(&paper)
    {
        return Err(format!(
            "the paper's brightness is {paper}; give one from 0 to 1"
        ));
    }
    if bytes.starts_with(b"\x89PNG") {
        png::read(bytes, options.transparent)
    } else if bytes.starts_with(b"\xff\xd8\xff") {
        jpeg::read(bytes)
    } else if bytes.starts_with(npy::MAGIC) {
        of_array(npy::read(bytes)?)
    } else {
        Err("neither a PNG, a JPEG nor a .npy file; save it as PNG".into())
    }
}

/// An array as a picture.
fn of_array(array: npy::Array) -> Problem<Pixels> {
    let [rows, columns] = array.shape[..] else {
        return Err(format!(
            "it has {} axes; a picture has two, rows and columns. For more, use \
             a volume",
            array.shape.len()
        ));
    };
    let layout = if array.fortran {
        Layout {
            size: [columns, rows, 1],
            start: rows - 1,
            steps: [rows as isize, -1, 0],
        }
    } else {
        Layout::picture(columns, rows)
    };
    Ok(Pixels {
        numbers: array.numbers,
        layout,
    })
}

/// How many pixels there are, if they are not too many.
fn pixel_count(width: u32, height: u32) -> Problem<usize> {
    let size = [width as usize, height as usize, 1];
    let pixels = count(size, crate::numbers::Kind::U8)?;
    if pixels > MOST_PIXELS {
        return Err(format!(
            "it has {width} × {height} pixels; scale it down to 8192 × 8192 at \
             most"
        ));
    }
    Ok(pixels)
}

/// Refuses a file with fewer bytes than its pixels take at least.
fn long_enough(
    bytes: &[u8],
    least: usize,
    width: u32,
    height: u32,
) -> Problem<()> {
    if bytes.len() < least {
        return Err(format!(
            "it has {} bytes, too few for {width} × {height} pixels; the file \
             is cut off or no picture",
            bytes.len()
        ));
    }
    Ok(())
}

/// Brightness of a colour, 0 to 255,000 for 8 bits.
fn luma([red, green, blue]: [u32; 3]) -> u32 {
    299 * red + 587 * green + 114 * blue
}

impl Data for Picture {
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

    fn is_flat(&self) -> bool {
        true
    }

    fn bytes(&self) -> usize {
        self.place.lattice.bytes()
    }

    fn shared(&self) -> Option<(usize, usize)> {
        Some(self.place.lattice.shared())
    }
}
