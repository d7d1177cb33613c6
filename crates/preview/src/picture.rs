//! Draws shaded pictures of a part straight from its field.
//!
//! In: a placed model. Out: pictures, for people and for the head of a file.
//! The part is drawn as it will be printed: scaled, turned, cut. A model and a
//! size give one picture on any number of threads and any machine of one
//! architecture; on others sines may differ in the last bit.

use super::image::{Picture, Rows, png_by_rows};
use super::raster::{PictureError, Subject};
use super::shade::{KEY_FROM, shade};
use super::slabs::{NONE, Slabs};
use super::view::View;
use isoslice_model::Model;
use isoslice_model::contour::FieldError;
use isoslice_settings::PictureSize;

/// Samples along each side of a pixel at an edge. A picture of a gyroid ball takes
/// 1.7 s with 2, 2.2 s with 3 and 3.0 s with 4, and one cannot tell 3 from 4.
const FINER: usize = 3;
/// What [`FINER`] is, for sketches and for pictures in a file's head.
const ROUGH_FINER: usize = 2;
/// Side of a pixel of the light's view, in pixels of the picture. Shadows are
/// softer than what casts them.
const MAP: f64 = 1.0;
/// What [`MAP`] is, for sketches. With [`MAP`] the light's view would be half
/// of their work.
const ROUGH_MAP: f64 = 4.0;
/// What [`MAP`] is, for pictures in a file's head, of which few are seen larger than
/// a thumb.
const HEAD_MAP: f64 = 2.0;
/// Least length of the longer side with which pictures in a file's head are
/// drawn, pixels.
const LEAST: f64 = 128.0;

/// Number of operations that a picture in a file's head may take. For a
/// function that oscillates, or is a sum of 1,000 waves, nothing can be proved
/// to be empty. Nearly every sample is evaluated, and a picture could take
/// longer than the print's outlines. No example takes so many operations.
const AFFORDABLE: u64 = 6_000_000_000;
/// Factors on the number of pixels along a side, which are tried in turn until
/// one picture is affordable. Half as many pixels mean an eighth of the
/// samples.
const COARSER: [f64; 3] = [1.0, 0.5, 0.25];

impl View {
    /// Draws a model and its supports, as a PNG file, in front of a colour
    /// (sRGB) or nothing. `size` is in pixels.
    ///
    /// # Errors
    /// If fidget refuses the model's expression, or a side is too large for
    /// PNG.
    pub fn draw(
        self,
        model: &Model,
        supports: &Slabs,
        size: [usize; 2],
        behind: Option<[u8; 3]>,
    ) -> Result<Vec<u8>, PictureError> {
        let subject = || Subject::new(model, supports, self);
        png(subject, size, behind, (FINER, MAP))
    }

    /// Draws a model without supports in a fraction of the time that
    /// [`View::draw`] takes. Edges are less smooth, and shadows are soft.
    ///
    /// # Errors
    /// Those of [`View::draw`].
    pub fn sketch(
        self,
        model: &Model,
        size: [usize; 2],
        behind: Option<[u8; 3]>,
    ) -> Result<Vec<u8>, PictureError> {
        let subject = || Subject::new(model, &NONE, self);
        png(subject, size, behind, (ROUGH_FINER, ROUGH_MAP))
    }
}

/// Draws a picture as a PNG file.
fn png<'a>(
    subject: impl FnOnce() -> Result<Subject<'a>, PictureError>,
    size: [usize; 2],
    behind: Option<[u8; 3]>,
    fineness: (usize, f64),
) -> Result<Vec<u8>, PictureError> {
    let size = size.map(|n| n.max(1));
    png_by_rows(size, behind, |rows| {
        drawn(&subject()?, size, fineness, rows)
    })
}

/// Hands over the picture some rows at a time. A pixel at an edge is made of
/// `finer` × `finer` samples, and one of the light's view has `map` of the
/// picture along its side.
fn drawn(
    subject: &Subject<'_>,
    [width, height]: [usize; 2],
    (finer, map): (usize, f64),
    each: &mut Rows<'_>,
) -> Result<(), PictureError> {
    let seen = subject.fitted(width, height)?;
    let lit = subject.seen_by(KEY_FROM.as_dvec3(), map * seen.pixel)?;
    shade(subject, &seen, lit, finer, each)
}

/// Pictures of a model in several sizes, as files. The largest is drawn, and
/// the others are made of it. There are none if even a coarse one would take
/// too long, which depends on the model and the sizes only.
///
/// # Errors
/// If fidget refuses the model's expression.
pub fn thumbnails(
    model: &Model,
    sizes: &[PictureSize],
) -> Result<Option<Vec<Vec<u8>>>, PictureError> {
    let whole = |size: &PictureSize| size.pixels.map(|n| n as usize);
    let largest = sizes.iter().map(whole).max_by_key(|[w, h]| w * h);
    let Some(largest) = largest else {
        return Ok(Some(Vec::new()));
    };
    let longest = largest[0].max(largest[1]) as f64;
    let larger = f64::max(1.0, LEAST / longest);
    for share in COARSER {
        let size = largest
            .map(|n| (share * larger * n as f64).ceil().max(1.0) as usize);
        let subject = Subject::at_most(AFFORDABLE, model, View::THUMBNAIL)?;
        let mut pixels = Vec::with_capacity(size[0] * size[1]);
        match drawn(&subject, size, (ROUGH_FINER, HEAD_MAP), &mut |some| {
            pixels.extend_from_slice(some);
            Ok(())
        }) {
            Err(PictureError::Field(FieldError::Costly { .. })) => continue,
            drawn => drawn?,
        }
        let [width, height] = size;
        let drawn = Picture {
            width,
            height,
            pixels,
        };
        let file = |size: &PictureSize| {
            let [width, height] = whole(size);
            drawn.shrunk(width, height).file(size.format)
        };
        return sizes.iter().map(file).collect::<Result<_, _>>().map(Some);
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use isoslice_model::{Placement, placed};
    use isoslice_settings::ImageFormat;

    /// A plate that lies askew.
    const PLATE: &str = "max(max(abs(0.96*x + 0.28*y) - 20, \
                         abs(0.96*y - 0.28*x) - 9), abs(z) - 1)";

    fn inside(p: DVec3) -> bool {
        let (x, y) = (0.96 * p.x + 0.28 * p.y, 0.96 * p.y - 0.28 * p.x);
        x.abs() < 20.0 && y.abs() < 9.0
    }

    /// Opacity of the pixels of a PNG file.
    fn opacity(file: &[u8]) -> Vec<f64> {
        let decoder = png::Decoder::new(std::io::Cursor::new(file));
        let mut reader = decoder.read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let pixels = bytes.chunks_exact(4);
        pixels.map(|p| f64::from(p[3]) / 255.0).collect()
    }

    /// Mean difference between opacity and the share of a pixel that the plate
    /// covers, at its edges.
    fn roughness(file: &[u8], view: View, size: [usize; 2]) -> f64 {
        let model = placed(PLATE, &Placement::default());
        let subject = Subject::new(&model, &NONE, view).unwrap();
        let seen = subject.fitted(size[0], size[1]).unwrap();
        let covered = |k: usize| {
            let (i, j) = ((k % size[0]) as f64, (k / size[0]) as f64);
            let at = |n: usize| (n as f64 + 0.5) / 10.0 - 0.5;
            let hits = (0..100).filter(|n| {
                let at = DVec3::new(i + at(n % 10), j + at(n / 10), 0.0);
                inside(seen.place(at))
            });
            hits.count() as f64 / 100.0
        };
        let opacity = opacity(file);
        assert_eq!(opacity.len(), size[0] * size[1]);
        let (mut off, mut edges) = (0.0, 0.0);
        for (k, opacity) in opacity.iter().enumerate() {
            let covered = covered(k);
            if covered > 0.0 && covered < 1.0 {
                off += (opacity - covered).abs();
                edges += 1.0;
            } else {
                assert!((opacity - covered).abs() < 0.01, "pixel {k}");
            }
        }
        assert!(edges > size[0] as f64, "{edges}");
        off / edges
    }

    /// One sample for a pixel is off by 0.25 in the mean.
    #[test]
    fn edges_are_smooth_in_all_pictures() {
        let model = placed(PLATE, &Placement::default());
        let top = View::of(-90.0, 90.0);
        for size in [[200, 100], [2400, 1300]] {
            let file = top.draw(&model, &NONE, size, None).unwrap();
            let rough = roughness(&file, top, size);
            assert!(rough < 0.08, "{size:?}: {rough}");
        }
        let size = [320, 200];
        let sketch = top.sketch(&model, size, None).unwrap();
        let rough = roughness(&sketch, top, size);
        assert!(rough < 0.12, "{rough}");
        let wanted = PictureSize {
            pixels: [220, 180],
            format: ImageFormat::Png,
        };
        let files = thumbnails(&model, &[wanted]).unwrap().unwrap();
        let size = [220, 180];
        let shown = opacity(&files[0]);
        let drawn = View::THUMBNAIL.sketch(&model, size, None).unwrap();
        assert_eq!(shown, opacity(&drawn));
        let partly = shown.iter().filter(|a| **a > 0.1 && **a < 0.9).count();
        assert!(partly > 200, "{partly}");
    }
}
