//! Reads JPEG: grey and colours, of which the brightness is kept.

use super::{Pixels, pixel_count};
use crate::error::Problem;
use crate::lattice::Layout;
use crate::numbers::Numbers;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

pub(super) fn read(bytes: &[u8]) -> Problem<Pixels> {
    // JPEG keeps colours as their brightness and two differences. Its own
    // brightness is that of all other pictures here.
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::Luma)
        .set_strict_mode(true)
        .set_max_width(1 << 16)
        .set_max_height(1 << 16);
    let mut decoder =
        JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    let broken = |e: zune_jpeg::errors::DecodeErrors| {
        format!("a JPEG that cannot be read ({e}); save it as PNG")
    };
    decoder.decode_headers().map_err(broken)?;
    let (width, height) = decoder.dimensions().unwrap_or((0, 0));
    let pixels = pixel_count(width as u32, height as u32)?;
    // A block of 8 × 8 pixels takes two bits at least.
    if bytes.len() < pixels / 64 / 4 {
        return Err(format!(
            "it has {} bytes, too few for {width} × {height} pixels; the file \
             is cut off or no picture",
            bytes.len()
        ));
    }
    let grey = decoder.decode().map_err(broken)?;
    if grey.len() != pixels {
        return Err("a JPEG with other colours; save it as PNG".into());
    }
    Ok(Pixels {
        numbers: Numbers::U8(grey),
        layout: Layout::picture(width, height),
    })
}

#[cfg(test)]
mod tests {
    use crate::{Picture, PictureOptions};
    use glam::DVec3;
    use isocontour::Data;
    use jpeg_encoder::{ColorType, Encoder};

    fn jpeg(colours: ColorType, data: &[u8], progressive: bool) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, 100);
        encoder.set_progressive(progressive);
        encoder.encode(data, 24, 16, colours).unwrap();
        file
    }

    #[test]
    fn greys_and_colours_are_read() {
        let ramp: Vec<u8> = (0..24 * 16).map(|i| (i % 24 * 10) as u8).collect();
        let colours: Vec<u8> = ramp.iter().flat_map(|v| [*v, 0, 0]).collect();
        for progressive in [false, true] {
            for (file, red) in [
                (jpeg(ColorType::Luma, &ramp, progressive), 1.0),
                (jpeg(ColorType::Rgb, &colours, progressive), 0.299),
            ] {
                let options = PictureOptions::default();
                let picture = Picture::read("x.jpg", &file, &options).unwrap();
                for i in 0..24 {
                    let p = DVec3::new(f64::from(i) + 0.5, 7.5, 0.0);
                    let value = picture.value(p);
                    let expected = red * f64::from(i) * 10.0 / 255.0;
                    assert!((value - expected).abs() < 0.01, "{value} {i}");
                }
            }
        }
    }

    #[test]
    fn broken_files_do_no_harm() {
        let grey: Vec<u8> = (0..24 * 16).map(|i| (i * 7 % 255) as u8).collect();
        for progressive in [false, true] {
            let good = jpeg(ColorType::Luma, &grey, progressive);
            let options = PictureOptions::default();
            let mut random = fastrand::Rng::with_seed(1);
            for cut in 0..good.len() {
                let _ = Picture::read("x.jpg", &good[..cut], &options);
                let mut bad = good.clone();
                for _ in 0..random.usize(1..4) {
                    let at = random.usize(..bad.len());
                    bad[at] = random.u8(..);
                }
                let _ = Picture::read("x.jpg", &bad, &options);
            }
        }
    }
}
