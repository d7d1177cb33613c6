//! A picture or a volume as sheets of grey pixels, which is how files of other
//! programs have one.
//!
//! ```text
//!   v ▲  row 0          A sheet holds the samples that have one place along the
//!     │  row 1          third axis. The stack lies from 0 to 1 along each axis,
//!     └──────▶ u        and a sample is in the middle of its share.
//! ```

use crate::lattice::{Border, Interpolation, Layout, Place};
use crate::numbers::Numbers;
use glam::{DAffine3, DVec3};

/// What a picture or a volume is made of.
#[derive(Clone, Copy, Debug)]
pub struct Sheets<'a> {
    place: &'a Place,
}

impl<'a> Sheets<'a> {
    pub(crate) fn of_place(place: &'a Place) -> Sheets<'a> {
        Sheets { place }
    }

    /// How many columns, rows and sheets there are.
    pub fn size(&self) -> [usize; 3] {
        self.layout().size
    }

    /// How to go from sample to sample.
    pub fn interpolation(&self) -> Interpolation {
        self.place.lattice.interpolation()
    }

    /// What is beyond the outermost samples, along each axis.
    pub fn border(&self) -> [Border; 3] {
        self.place.lattice.border()
    }

    /// From space, mm, to coordinates that are 0 to 1 along each axis of the
    /// stack.
    pub fn to_stack(&self) -> DAffine3 {
        let size = DVec3::from_array(self.size().map(|n| n as f64));
        let to_lattice = self.place.to_lattice;
        // A sample's own coordinate is that of its middle.
        DAffine3::from_scale(size.recip())
            * DAffine3::from_translation(DVec3::splat(0.5))
            * to_lattice
    }

    /// Bytes of a pixel; none of numbers that are not whole.
    pub fn depth(&self) -> Option<usize> {
        match self.numbers() {
            Numbers::U8(_) | Numbers::I8(_) => Some(1),
            Numbers::U16(_) | Numbers::I16(_) => Some(2),
            Numbers::F32(_) => None,
        }
    }

    /// The function's values where pixels are black, and by how much more they are
    /// where pixels are white.
    pub fn black_and_span(&self) -> [f64; 2] {
        let [scale, offset] = self.place.lattice.scale();
        let (black, span) = match self.numbers() {
            Numbers::U8(_) => (0.0, f64::from(u8::MAX)),
            Numbers::I8(_) => (f64::from(i8::MIN), f64::from(u8::MAX)),
            Numbers::U16(_) => (0.0, f64::from(u16::MAX)),
            Numbers::I16(_) => (f64::from(i16::MIN), f64::from(u16::MAX)),
            Numbers::F32(_) => (0.0, 1.0),
        };
        [offset + scale * black, scale * span]
    }

    /// The pixels of a sheet, the topmost row first, those of two bytes with the
    /// greater one first. None of numbers that are not whole.
    pub fn pixels(&self, sheet: usize) -> Vec<u8> {
        // The least number is black.
        match self.numbers() {
            Numbers::U8(all) => self.of(all, sheet, |n| [n]),
            Numbers::I8(all) => {
                self.of(all, sheet, |n| [n.cast_unsigned() ^ 1 << 7])
            }
            Numbers::U16(all) => self.of(all, sheet, u16::to_be_bytes),
            Numbers::I16(all) => self.of(all, sheet, |n| {
                (n.cast_unsigned() ^ 1 << 15).to_be_bytes()
            }),
            Numbers::F32(_) => Vec::new(),
        }
    }

    fn of<T: Copy, const N: usize>(
        &self,
        numbers: &[T],
        sheet: usize,
        bytes: impl Fn(T) -> [u8; N],
    ) -> Vec<u8> {
        let layout = self.layout();
        let [columns, rows, _] = layout.size;
        let places = (0..rows).rev().flat_map(|row| {
            (0..columns).map(move |column| [column, row, sheet])
        });
        let all = places.filter_map(|at| numbers.get(layout.at(at)));
        all.flat_map(|n| bytes(*n)).collect()
    }

    fn layout(&self) -> Layout {
        self.place.lattice.grid().layout()
    }

    fn numbers(&self) -> &Numbers {
        self.place.lattice.grid().numbers()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Picture, PictureOptions};
    use crate::volume::{Axes, Volume, VolumeOptions};
    use isocontour::Data;

    /// The value that the pixels of the stack say at a sample.
    fn said(sheets: &Sheets<'_>, [i, j, k]: [usize; 3]) -> f64 {
        let [columns, rows, _] = sheets.size();
        let depth = sheets.depth().unwrap();
        let pixels = sheets.pixels(k);
        let at = depth * ((rows - 1 - j) * columns + i);
        let pixel = &pixels[at..at + depth];
        let number = pixel.iter().fold(0.0, |n, b| 256.0 * n + f64::from(*b));
        let share = number / (256_f64.powi(depth as i32) - 1.0);
        let [black, span] = sheets.black_and_span();
        black + span * share
    }

    fn check(sheets: &Sheets<'_>, data: &dyn Data) {
        let size = sheets.size();
        let from_stack = sheets.to_stack();
        let is_flat = size[2] == 1;
        for k in 0..size[2] {
            for j in 0..size[1] {
                for i in 0..size[0] {
                    let at = [i, j, k].map(|n| n as f64 + 0.5);
                    let at = DVec3::from_array(at)
                        / DVec3::from_array(size.map(|n| n as f64));
                    // A picture is the same at all heights.
                    let mut to = from_stack;
                    if is_flat {
                        to.matrix3.z_axis.z = 1.0;
                        to.translation.z = 0.0;
                    }
                    let p = to.inverse().transform_point3(at);
                    let (own, said) = (data.at(p).0, said(sheets, [i, j, k]));
                    assert!((own - said).abs() < 1e-9, "{own} {said}");
                }
            }
        }
    }

    #[test]
    fn pixels_say_the_values_at_their_middles() {
        let options = PictureOptions {
            width_mm: Some(7.5),
            height_mm: Some(4.0),
            ..PictureOptions::default()
        };
        let narrow: Vec<u8> = vec![3, 255, 0, 17, 200, 99];
        let wide = narrow.iter().map(|n| u16::from(*n) * 250 + 3).collect();
        for numbers in [Numbers::U8(narrow.clone()), Numbers::U16(wide)] {
            let picture =
                Picture::from_numbers("p", [3, 2], numbers, &options).unwrap();
            check(&picture.sheets(), &picture);
        }
        let signed: Vec<i8> = narrow.iter().map(|n| n.cast_signed()).collect();
        let wide: Vec<i16> = (0..24).map(|n| n * 1300 + i16::MIN).collect();
        for axes in [Axes::Xyz, Axes::Zyx] {
            let options = VolumeOptions {
                spacing_mm: Some(DVec3::new(0.5, 2.0, 3.0)),
                origin_mm: Some(DVec3::new(-1.0, 4.0, 0.3)),
                axes,
                ..VolumeOptions::default()
            };
            let volume = |shape: &[usize], numbers: Numbers| {
                Volume::from_numbers("v", shape, numbers, &options).unwrap()
            };
            let narrow = volume(&[1, 3, 2], Numbers::I8(signed.clone()));
            check(&narrow.sheets(), &narrow);
            let wide = volume(&[2, 3, 4], Numbers::I16(wide.clone()));
            check(&wide.sheets(), &wide);
        }
        let floats = Numbers::F32(vec![0.5; 6]);
        let picture = Picture::from_numbers("p", [3, 2], floats, &options);
        assert_eq!(picture.unwrap().sheets().depth(), None);
    }
}
