//! Pictures of a part, shaded, straight from its field.
//!
//! In: a placed model. Out: pictures, for people and for the head of a file.
//! The part is drawn as it will be printed: scaled, turned, cut. The same
//! model and size give the same picture on any machine and number of threads
//! (on those of one architecture; elsewhere sines may differ in the last
//! bit).

use super::image::Picture;
use super::raster::{PictureError, Subject, View};
use super::shade::{KEY_FROM, shade};
use crate::model::Model;

/// Pixels that are looked at for one of the picture, along each side, up to
/// [`SMOOTHED`]: smooth edges cost the square of it.
const SMOOTH: usize = 2;
/// Longer side up to which edges are smooth.
const SMOOTHED: usize = 2000;
/// The same for pictures in a file's head, which every run pays for.
const THUMBNAIL: f64 = 1.5;
/// Pixels that are looked at along the side of one of the light's view:
/// shadows are softer than what casts them.
const MAP: f64 = 1.5;
/// Longer side that they are drawn with at least.
const LEAST: f64 = 128.0;

/// Draws a model, on a transparent background.
///
/// # Errors
/// If fidget refuses the model's expression.
pub fn draw(
    model: &Model,
    view: View,
    size: [usize; 2],
) -> Result<Picture, PictureError> {
    let [width, height] = size.map(|n| n.max(1));
    let longest = width.max(height);
    let block = if longest <= SMOOTHED { SMOOTH } else { 1 };
    drawn(model, view, [width, height], block)
}

/// The picture, of blocks of that many pixels.
fn drawn(
    model: &Model,
    view: View,
    [width, height]: [usize; 2],
    block: usize,
) -> Result<Picture, PictureError> {
    let subject = Subject::new(model, view)?;
    let seen = subject.fitted(width * block, height * block)?;
    let lit = subject.seen_by(KEY_FROM.as_dvec3(), MAP * seen.pixel)?;
    Ok(shade(&seen, &lit, block))
}

/// Pictures of a model in several sizes, as PNG files: the largest is drawn
/// and the others are made of it.
///
/// # Errors
/// If fidget refuses the model's expression.
pub fn thumbnails(
    model: &Model,
    sizes: &[[u32; 2]],
) -> Result<Vec<Vec<u8>>, PictureError> {
    let whole: Vec<[usize; 2]> =
        sizes.iter().map(|s| s.map(|n| n as usize)).collect();
    let Some(&largest) = whole.iter().max_by_key(|[w, h]| w * h) else {
        return Ok(Vec::new());
    };
    let longest = largest[0].max(largest[1]) as f64;
    let finer = THUMBNAIL.max(LEAST / longest);
    let size = largest.map(|n| (finer * n as f64).ceil() as usize);
    let drawn = drawn(model, View::THUMBNAIL, size, 1)?;
    whole
        .into_iter()
        .map(|[width, height]| drawn.shrunk(width, height).png())
        .collect()
}
