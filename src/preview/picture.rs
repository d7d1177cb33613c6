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
use crate::contour::FieldError;
use crate::model::Model;
use crate::settings::PictureSize;

/// Samples along each side of a pixel, for pictures up to [`SMOOTHED`]. Smooth
/// edges cost the square of this number.
const SMOOTH: usize = 2;
/// Longer side of a picture up to which edges are smooth, pixels.
const SMOOTHED: usize = 2000;
/// Samples along each side of a pixel, for pictures in a file's head, which
/// every run pays for.
const THUMBNAIL: f64 = 1.5;
/// Samples of the picture along the side of a pixel of the light's view.
/// Shadows are softer than what casts them.
const MAP: f64 = 1.5;
/// What [`MAP`] is, for sketches. With [`MAP`] the light's view would be half
/// of their work.
const ROUGH_MAP: f64 = 4.0;
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
        let longest = size[0].max(size[1]);
        let block = if longest <= SMOOTHED { SMOOTH } else { 1 };
        let subject = || Subject::new(model, supports, self);
        in_blocks(subject, size, behind, (block, MAP))
    }

    /// Draws a model without supports in a fraction of the time that
    /// [`View::draw`] takes. Edges are rough.
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
        in_blocks(subject, size, behind, (1, ROUGH_MAP))
    }
}

/// Draws a picture, each pixel of which is made of `block` × `block` samples,
/// with shadows of `map` samples each.
fn in_blocks<'a>(
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

/// Hands over the picture some rows at a time. Each pixel is made of a block of
/// `block` × `block` samples.
fn drawn(
    subject: &Subject<'_>,
    [width, height]: [usize; 2],
    (block, map): (usize, f64),
    each: &mut Rows<'_>,
) -> Result<(), PictureError> {
    let seen = subject.fitted(width * block, height * block)?;
    let lit = subject.seen_by(KEY_FROM.as_dvec3(), map * seen.pixel)?;
    shade(&seen, lit, block, each)
}

/// Pictures of a model in several sizes, as files. The largest is drawn, and
/// the others are made of it. There are none if even a coarse one would take
/// too long, which depends on the model and the sizes only.
///
/// # Errors
/// If fidget refuses the model's expression.
pub(crate) fn thumbnails(
    model: &Model,
    sizes: &[PictureSize],
) -> Result<Option<Vec<Vec<u8>>>, PictureError> {
    let whole = |size: &PictureSize| size.pixels.map(|n| n as usize);
    let largest = sizes.iter().map(whole).max_by_key(|[w, h]| w * h);
    let Some(largest) = largest else {
        return Ok(Some(Vec::new()));
    };
    let longest = largest[0].max(largest[1]) as f64;
    let finer = THUMBNAIL.max(LEAST / longest);
    for share in COARSER {
        let size = largest
            .map(|n| (share * finer * n as f64).ceil().max(1.0) as usize);
        let subject = Subject::at_most(AFFORDABLE, model, View::THUMBNAIL)?;
        let mut pixels = Vec::with_capacity(size[0] * size[1]);
        match drawn(&subject, size, (1, MAP), &mut |some| {
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
