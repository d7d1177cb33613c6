//! Reads JPEG: grey and colours, of which the brightness is kept. Photographs
//! are turned as their camera was held.

use super::{Pixels, long_enough, pixel_count};
use crate::lattice::Layout;
use crate::numbers::Numbers;
use isoslice_base::problem::Problem;
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
    long_enough(bytes, pixels / 64 / 4, width as u32, height as u32)?;
    let grey = decoder.decode().map_err(broken)?;
    if grey.len() != pixels {
        return Err("a JPEG with other colours; save it as PNG".into());
    }
    let exif = decoder.exif().map(Vec::as_slice).unwrap_or_default();
    Ok(Pixels {
        numbers: Numbers::U8(grey),
        layout: turned(width, height, orientation(exif)),
    })
}

/// How a picture is to be turned, by its Exif data: 1 to 8. 1 is not at all.
fn orientation(exif: &[u8]) -> u16 {
    const TAG: u16 = 0x112;
    let big = exif.starts_with(b"MM");
    let byte = |at: usize| u32::from(exif.get(at).copied().unwrap_or(0));
    let word = |at: usize| {
        let [a, b] = [byte(at), byte(at.saturating_add(1))];
        (if big { a << 8 | b } else { b << 8 | a }) as u16
    };
    let [a, b] = [4, 6].map(|at| usize::from(word(at)));
    let from = if big { a << 16 | b } else { b << 16 | a };
    let from = from.min(exif.len());
    let entries = usize::from(word(from));
    let all = (0..entries).map(|i| from + 2 + 12 * i);
    let found = all
        .take_while(|at| *at < exif.len())
        .find(|at| word(*at) == TAG);
    found.map_or(1, |at| word(at + 8))
}

/// The layout of a picture whose rows are written from the upper left, and
/// which is shown turned or mirrored.
fn turned(width: usize, height: usize, orientation: u16) -> Layout {
    let row = width as isize;
    // How far the next pixels to the right and above are in the file.
    let (right, up) = match orientation {
        2 => (-1, -row),
        3 => (-1, row),
        4 => (1, row),
        5 => (row, -1),
        6 => (-row, -1),
        7 => (-row, 1),
        8 => (row, 1),
        _ => (1, -row),
    };
    let [columns, rows] = if matches!(orientation, 5..=8) {
        [height, width]
    } else {
        [width, height]
    };
    let back = |step: isize, n: usize| {
        if step < 0 {
            step.unsigned_abs() * (n - 1)
        } else {
            0
        }
    };
    Layout {
        size: [columns, rows, 1],
        start: back(right, columns) + back(up, rows),
        steps: [right, up, 0],
    }
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

    /// The dark corner, which is the upper left in the file, is where Exif says.
    #[test]
    fn photographs_are_turned() {
        let dark: Vec<u8> = (0..24 * 16)
            .map(|i| if i % 24 < 8 && i / 24 < 8 { 0 } else { 200 })
            .collect();
        let plain = jpeg(ColorType::Luma, &dark, false);
        for (orientation, right, top) in [
            (1, false, true),
            (2, true, true),
            (3, true, false),
            (4, false, false),
            (5, false, true),
            (6, true, true),
            (7, true, false),
            (8, false, false),
        ] {
            // Both orders of bytes; the first header is at the beginning, or
            // behind that of JFIF.
            let little: &[u8] =
                b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0";
            let big: &[u8] = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01";
            let jfif = 4 + usize::from(plain[5]);
            for (order, number, at) in [
                (little, [orientation, 0, 0, 0], 2),
                (big, [0, orientation, 0, 0], 2),
                (big, [0, orientation, 0, 0], jfif),
            ] {
                let exif =
                    [b"Exif\0\0", order, &number, &[0, 0, 0, 0]].concat();
                let mut file = plain[..at].to_vec();
                file.extend([0xff, 0xe1, 0, exif.len() as u8 + 2]);
                file.extend(exif);
                file.extend(&plain[at..]);
                let options = PictureOptions::default();
                let picture = Picture::read("x.jpg", &file, &options).unwrap();
                let [w, h] = picture.pixels();
                assert_eq!(orientation > 4, w == 16 && h == 24);
                let x = if right { w - 4 } else { 4 } as f64;
                let y = if top { h - 4 } else { 4 } as f64;
                let corner =
                    |x: f64, y: f64| picture.value(DVec3::new(x, y, 0.0));
                assert!(corner(x, y) < 0.1, "{orientation}");
                let far = corner(w as f64 - x, h as f64 - y);
                assert!(far > 0.7, "{orientation}");
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
