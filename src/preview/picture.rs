//! Pictures of a part, shaded, straight from its field.
//!
//! In: a placed model. Out: pictures, for people and for the head of a file.
//! The part is drawn as it will be printed: scaled, turned, cut. The same
//! model and size give the same picture on any machine and number of threads
//! (on those of one architecture; elsewhere sines may differ in the last
//! bit).

use super::image::Picture;
use super::raster::{PictureError, Subject, View};
use super::shade::shade;
use crate::model::Model;

/// Pixels that are looked at for one of the picture, along each side, for
/// pictures up to each size: smooth edges cost their square.
const SMOOTH: [(usize, usize); 3] = [(160, 4), (640, 2), (2000, 2)];

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
    let block = SMOOTH
        .iter()
        .find(|(most, _)| longest <= *most)
        .map_or(1, |(_, block)| *block);
    let subject = Subject::new(model, view)?;
    let seen = subject.fitted(width * block, height * block)?;
    Ok(shade(&seen, subject.axes(), block))
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
    let drawn = draw(model, View::THUMBNAIL, largest)?;
    whole
        .into_iter()
        .map(|[width, height]| drawn.shrunk(width, height).png())
        .collect()
}
