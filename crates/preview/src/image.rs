//! Pictures made of pixels, and files of them.

use super::raster::PictureError;
use isoslice_settings::ImageFormat;
use std::io::Write;
use std::sync::LazyLock;

/// Colour behind the part in a format without transparency, sRGB. It is dark,
/// since the printers' hosts that show such pictures have dark pages.
const BEHIND: [u8; 3] = [32, 34, 38];
/// Quality of JPG files, of 100. With this one the edges of a small part stay
/// clean.
const QUALITY: u8 = 92;

/// A picture: colours in linear light, multiplied by their opacity.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Picture {
    /// Pixels in a row.
    pub(super) width: usize,
    /// Rows, from the top.
    pub(super) height: usize,
    /// Red, green, blue and opacity, row by row.
    pub(super) pixels: Vec<[f32; 4]>,
}

impl Picture {
    /// The picture in front of a colour, given as sRGB.
    fn over(mut self, background: [u8; 3]) -> Picture {
        self.pixels
            .iter_mut()
            .for_each(|p| *p = over(*p, background));
        self
    }

    /// The picture, smaller, in the middle of a frame that may have other
    /// proportions. Each new pixel is the mean of those that it covers.
    pub(super) fn shrunk(&self, width: usize, height: usize) -> Picture {
        let scale = (self.width as f64 / width as f64)
            .max(self.height as f64 / height as f64);
        let left = 0.5 * (self.width as f64 - scale * width as f64);
        let top = 0.5 * (self.height as f64 - scale * height as f64);
        let columns: Vec<_> = (0..width)
            .map(|i| shares(left + scale * i as f64, scale, self.width))
            .collect();
        let rows: Vec<_> = (0..height)
            .map(|j| shares(top + scale * j as f64, scale, self.height))
            .collect();
        let mut pixels = Vec::with_capacity(width * height);
        for row in &rows {
            for column in &columns {
                let mut sum = [0.0f32; 4];
                for &(y, of_row) in row {
                    for &(x, of_column) in column {
                        let pixel = self.pixels[x + y * self.width];
                        for k in 0..4 {
                            sum[k] += of_row * of_column * pixel[k];
                        }
                    }
                }
                pixels.push(sum);
            }
        }
        Picture {
            width,
            height,
            pixels,
        }
    }

    /// The picture as a file.
    ///
    /// # Errors
    /// If a side is 0 or too large for the format.
    pub(super) fn file(
        self,
        format: ImageFormat,
    ) -> Result<Vec<u8>, PictureError> {
        match format {
            ImageFormat::Png => self.png(),
            ImageFormat::Qoi => self.qoi(),
            ImageFormat::Jpg => self.over(BEHIND).jpg(),
        }
    }

    /// Red, green, blue and opacity of the pixels, as files have them.
    fn bytes(&self) -> Vec<u8> {
        self.pixels.iter().flat_map(|p| srgb(*p)).collect()
    }

    fn sides(&self) -> (u32, u32) {
        let side = |n: usize| u32::try_from(n).unwrap_or(0);
        (side(self.width), side(self.height))
    }

    fn qoi(&self) -> Result<Vec<u8>, PictureError> {
        let (width, height) = self.sides();
        Ok(qoi::encode_to_vec(self.bytes(), width, height)?)
    }

    fn jpg(&self) -> Result<Vec<u8>, PictureError> {
        let side = |n: usize| u16::try_from(n).unwrap_or(0);
        let (width, height) = (side(self.width), side(self.height));
        let mut file = Vec::new();
        let encoder = jpeg_encoder::Encoder::new(&mut file, QUALITY);
        let colours = jpeg_encoder::ColorType::Rgba;
        encoder.encode(&self.bytes(), width, height, colours)?;
        Ok(file)
    }

    fn png(&self) -> Result<Vec<u8>, PictureError> {
        let mut file = Vec::new();
        let mut writer = png_of(&mut file, self.width, self.height)?;
        writer.write_image_data(&self.bytes())?;
        writer.finish()?;
        Ok(file)
    }
}

/// Begins a PNG file.
fn png_of(
    file: &mut Vec<u8>,
    width: usize,
    height: usize,
) -> Result<png::Writer<&mut Vec<u8>>, PictureError> {
    let side = |n: usize| u32::try_from(n).unwrap_or(0);
    let mut encoder = png::Encoder::new(file, side(width), side(height));
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    Ok(encoder.write_header()?)
}

/// Takes the pixels of a picture, some rows at a time: linear colours
/// multiplied by their opacity, and the opacity.
pub(super) type Rows<'a> =
    dyn FnMut(&[[f32; 4]]) -> Result<(), PictureError> + 'a;

/// A PNG file of a picture that is never in memory as a whole; `draw` hands
/// over its rows. It lies in front of the colour `behind`, sRGB, if there is
/// one.
///
/// # Errors
/// Those of `draw`; if a side is 0 or too large for PNG, or `draw` hands over
/// another number of pixels.
pub(super) fn png_by_rows(
    [width, height]: [usize; 2],
    behind: Option<[u8; 3]>,
    draw: impl FnOnce(&mut Rows<'_>) -> Result<(), PictureError>,
) -> Result<Vec<u8>, PictureError> {
    let mut file = Vec::new();
    let mut writer = png_of(&mut file, width, height)?;
    let mut stream = writer.stream_writer()?;
    let mut bytes: Vec<u8> = Vec::new();
    let laid = |p: &[f32; 4]| behind.map_or(*p, |b| over(*p, b));
    draw(&mut |pixels| {
        bytes.clear();
        bytes.extend(pixels.iter().flat_map(|p| srgb(laid(p))));
        let written = stream.write_all(&bytes);
        Ok(written.map_err(png::EncodingError::from)?)
    })?;
    stream.finish()?;
    writer.finish()?;
    Ok(file)
}

/// A pixel in front of a colour, given as sRGB.
fn over(mut pixel: [f32; 4], background: [u8; 3]) -> [f32; 4] {
    let through = 1.0 - pixel[3];
    for k in 0..3 {
        pixel[k] += through * linear(background[k].into());
    }
    pixel[3] = 1.0;
    pixel
}

/// Which of `count` pixels in a row a length covers that begins at `from`, and
/// the share of the length that each pixel has.
fn shares(from: f64, length: f64, count: usize) -> Vec<(usize, f32)> {
    let to = from + length;
    let first = from.floor().max(0.0) as usize;
    (first..count)
        .take_while(|&i| (i as f64) < to)
        .map(|i| {
            let covered = (i as f64 + 1.0).min(to) - (i as f64).max(from);
            (i, (covered / length) as f32)
        })
        .collect()
}

/// The least brightness, in linear light, of each byte of sRGB but 0. Looking a byte up
/// takes a quarter of the time that the curve's power does.
static STEPS: LazyLock<[f32; 255]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear(byte as f32 + 0.5)));

/// A pixel in sRGB, with colours that are not multiplied by the opacity.
fn srgb([r, g, b, a]: [f32; 4]) -> [u8; 4] {
    let opacity = (255.0 * a.clamp(0.0, 1.0)).round() as u8;
    if opacity == 0 {
        return [0; 4];
    }
    let steps = &*STEPS;
    let byte = |x: f32| steps.partition_point(|least| *least <= x / a) as u8;
    [byte(r), byte(g), byte(b), opacity]
}

/// A byte of sRGB, or what lies between two, in linear light.
fn linear(byte: f32) -> f32 {
    let x = byte / 255.0;
    if x <= 0.040_45 {
        x / 12.92
    } else {
        ((x + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back_as_they_were() {
        for byte in 0..=255 {
            let x = linear(byte.into());
            assert_eq!(srgb([x, x, x, 1.0]), [byte, byte, byte, 255]);
            let half = srgb([0.5 * x, 0.5 * x, 0.5 * x, 0.5]);
            assert_eq!(half, [byte, byte, byte, 128]);
        }
        assert_eq!(srgb([f32::NAN, 0.0, 9.0, 1.0]), [0, 0, 255, 255]);
    }

    #[test]
    fn a_file_made_row_by_row_is_the_same_picture() {
        let (width, height) = (50, 40);
        let pixels: Vec<[f32; 4]> = (0..width * height)
            .map(|k| [k as f32 / 4000.0, 0.1, 0.2, (k % 3) as f32 / 2.0])
            .collect();
        let pixels_of = |file: &[u8]| {
            let decoder = png::Decoder::new(std::io::Cursor::new(file));
            let mut reader = decoder.read_info().unwrap();
            let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut bytes).unwrap();
            bytes
        };
        let whole = Picture {
            width,
            height,
            pixels,
        };
        for behind in [None, Some([200, 100, 50])] {
            let file = png_by_rows([width, height], behind, |rows| {
                whole.pixels.chunks(3 * width).try_for_each(rows)
            });
            let laid = match behind {
                Some(colour) => whole.clone().over(colour),
                None => whole.clone(),
            };
            assert_eq!(pixels_of(&file.unwrap()), laid.bytes());
            assert_eq!(pixels_of(&laid.png().unwrap()), laid.bytes());
        }
    }

    #[test]
    fn shrinking_keeps_the_mean_and_the_middle() {
        let pixels: Vec<[f32; 4]> = (0..30 * 20)
            .map(|k| [(k % 30) as f32, (k / 30) as f32, 0.0, 1.0])
            .collect();
        let all = Picture {
            width: 30,
            height: 20,
            pixels,
        };
        let small = all.shrunk(7, 7);
        let mean = |k: usize| -> f32 {
            small.pixels.iter().map(|p| p[k]).sum::<f32>() / 49.0
        };
        // 30/7 pixels become one. There is nothing above and below.
        assert!((mean(0) - 14.5 * 20.0 / 30.0).abs() < 1e-3);
        assert!((mean(3) - 20.0 / 30.0).abs() < 1e-4);
        assert_eq!(all.shrunk(30, 20), all);
    }
}
