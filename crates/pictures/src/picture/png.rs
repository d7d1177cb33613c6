//! Reads PNG: grey and colours, with and without transparency, 8 and 16 bits.

use super::{Pixels, TransparentAs, long_enough, luma, pixel_count};
use crate::lattice::Layout;
use crate::numbers::Numbers;
use isoslice_base::problem::Problem;
use png::{BitDepth, ColorType, Decoder, Limits, Transformations};
use std::io::Cursor;

/// The most memory for a whole picture as it is in the file, bytes.
const MOST_DECODED: usize = 1 << 29;

/// Deflate makes at most 1032 bytes of one. A few more are allowed for.
const DEFLATE_RATIO: usize = 1100;

pub(super) fn read(bytes: &[u8], clear: TransparentAs) -> Problem<Pixels> {
    let limits = Limits {
        bytes: MOST_DECODED,
    };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::EXPAND);
    let broken = |e: png::DecodingError| {
        format!("a broken PNG ({e}); open it in a picture editor and save it")
    };
    let mut reader = decoder.read_info().map_err(broken)?;
    let info = reader.info();
    let (width, height) = (info.width, info.height);
    let pixels = pixel_count(width, height)?;
    // Pixels of one bit and of palettes are fewer bytes here than decoded.
    let least = info.raw_bytes() / DEFLATE_RATIO;
    let (colours, depth) = reader.output_color_type();
    let needed = reader.output_buffer_size().unwrap_or(usize::MAX);
    if needed > MOST_DECODED {
        return Err(format!(
            "its {width} × {height} pixels take more than 512 MB; scale it \
             down, or save it with 8 bits"
        ));
    }
    long_enough(bytes, least, width, height)?;
    let mut decoded = vec![0; needed];
    let frame = reader.next_frame(&mut decoded).map_err(broken)?;
    decoded.truncate(frame.buffer_size());
    let wide = depth == BitDepth::Sixteen;
    let numbers = match (colours, wide) {
        (ColorType::Grayscale, false) if clear != TransparentAs::Mask => {
            Numbers::U8(decoded)
        }
        _ => Numbers::U16(values(colours, wide, &decoded, clear)),
    };
    if numbers.len() != pixels {
        return Err("it ends before its last pixel; save it again".into());
    }
    Ok(Pixels {
        numbers,
        layout: Layout::picture(width as usize, height as usize),
    })
}

/// Brightness of each pixel, 0 to 65535.
fn values(
    colours: ColorType,
    wide: bool,
    decoded: &[u8],
    clear: TransparentAs,
) -> Vec<u16> {
    let channels = colours.samples();
    let size = channels * if wide { 2 } else { 1 };
    let channel = |pixel: &[u8], c: usize| -> u32 {
        if wide {
            let at = |i: usize| pixel.get(i).copied().unwrap_or(0);
            u16::from_be_bytes([at(2 * c), at(2 * c + 1)]).into()
        } else {
            u32::from(pixel.get(c).copied().unwrap_or(0)) * 257
        }
    };
    let brightness = |pixel: &[u8]| -> u16 {
        let grey = if channels > 2 {
            let [r, g, b] = [0, 1, 2].map(|c| channel(pixel, c));
            (luma([r, g, b]) + 500) / 1000
        } else {
            channel(pixel, 0)
        };
        let cover = if channels.is_multiple_of(2) {
            channel(pixel, channels - 1)
        } else {
            65535
        };
        match clear {
            TransparentAs::Mask => cover as u16,
            TransparentAs::Paper(paper) => {
                let cover = f64::from(cover) / 65535.0;
                let paper = 65535.0 * paper;
                (f64::from(grey) * cover + paper * (1.0 - cover)).round() as u16
            }
        }
    };
    decoded.chunks_exact(size).map(brightness).collect()
}

#[cfg(test)]
mod tests {
    use crate::{Picture, PictureOptions, TransparentAs};
    use glam::DVec3;
    use isocontour::Data;
    use png::{BitDepth, ColorType};

    /// A PNG of 2 × 1 pixels.
    fn png(colours: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 2, 1);
        encoder.set_color(colours);
        encoder.set_depth(depth);
        if colours == ColorType::Indexed {
            encoder.set_palette(vec![255, 0, 0, 0, 0, 255]);
            encoder.set_trns(vec![255, 0]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        file
    }

    fn values(file: &[u8], transparent: TransparentAs) -> [f64; 2] {
        let options = PictureOptions {
            transparent,
            ..PictureOptions::default()
        };
        let picture = Picture::read("x.png", file, &options).unwrap();
        [0.5, 1.5].map(|x| picture.value(DVec3::new(x, 0.5, 0.0)))
    }

    #[test]
    fn colours_depths_and_transparency() {
        use BitDepth::{Eight, One, Sixteen};
        let near = |a: [f64; 2], b: [f64; 2]| {
            assert!(
                a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5),
                "{a:?} {b:?}"
            );
        };
        let white = TransparentAs::Paper(1.0);
        let black = TransparentAs::Paper(0.0);
        let mask = TransparentAs::Mask;
        let grey = png(ColorType::Grayscale, Eight, &[0, 51]);
        near(values(&grey, white), [0.0, 0.2]);
        near(values(&grey, mask), [1.0, 1.0]);
        let deep = png(ColorType::Grayscale, Sixteen, &[0, 1, 0x80, 0]);
        near(values(&deep, white), [1.0 / 65535.0, 32768.0 / 65535.0]);
        let rgb = png(ColorType::Rgb, Eight, &[255, 0, 0, 7, 7, 7]);
        near(values(&rgb, white), [0.299, 7.0 / 255.0]);
        let rgba = png(ColorType::Rgba, Eight, &[0, 0, 0, 0, 0, 255, 0, 51]);
        near(values(&rgba, white), [1.0, 0.587 * 0.2 + 0.8]);
        near(values(&rgba, black), [0.0, 0.587 * 0.2]);
        near(values(&rgba, mask), [0.0, 0.2]);
        let bits = png(ColorType::Grayscale, One, &[0b0100_0000]);
        near(values(&bits, white), [0.0, 1.0]);
        let palette = png(ColorType::Indexed, One, &[0b0100_0000]);
        near(values(&palette, white), [0.299, 1.0]);
        near(values(&palette, mask), [1.0, 0.0]);
    }

    #[test]
    fn broken_files_are_refused() {
        let good = png(ColorType::Rgb, BitDepth::Eight, &[1, 2, 3, 4, 5, 6]);
        let read = |file: &[u8]| {
            Picture::read("x.png", file, &PictureOptions::default())
        };
        for cut in 0..good.len() {
            let _ = read(&good[..cut]);
            let mut bad = good.clone();
            bad[cut] ^= 0x55;
            let _ = read(&bad);
        }
        // A header that promises more than the file can hold.
        let mut huge = good.clone();
        huge[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
        let crc = crc(&huge[12..29]);
        huge[29..33].copy_from_slice(&crc.to_be_bytes());
        let e = read(&huge).unwrap_err().to_string();
        assert!(e.starts_with("x.png: "), "{e}");
        assert!(e.contains("65535 × 65535"), "{e}");
        huge[16..24].copy_from_slice(&[0, 0, 0x20, 0, 0, 0, 0x10, 0]);
        let crc = self::crc(&huge[12..29]);
        huge[29..33].copy_from_slice(&crc.to_be_bytes());
        let e = read(&huge).unwrap_err().to_string();
        assert!(e.contains("too few for 8192 × 4096"), "{e}");
    }

    /// Such files are an eighth of the size of others, and less by a thousandth
    /// if all is white.
    #[test]
    fn white_pictures_of_one_bit_are_read() {
        for colours in [ColorType::Grayscale, ColorType::Indexed] {
            let mut file = Vec::new();
            let mut encoder = png::Encoder::new(&mut file, 4096, 2048);
            encoder.set_color(colours);
            encoder.set_depth(BitDepth::One);
            encoder.set_compression(png::Compression::High);
            if colours == ColorType::Indexed {
                encoder.set_palette(vec![0, 0, 0, 255, 255, 255]);
            }
            let mut writer = encoder.write_header().unwrap();
            writer.write_image_data(&vec![255; 512 * 2048]).unwrap();
            writer.finish().unwrap();
            assert!(file.len() < 7000, "{}", file.len());
            let [a, b] = values(&file, TransparentAs::Paper(1.0));
            assert_eq!([a, b], [1.0, 1.0]);
        }
    }

    fn crc(bytes: &[u8]) -> u32 {
        let mut crc = flate2::Crc::new();
        crc.update(bytes);
        crc.sum()
    }
}
