//! Packs a toolpath into few bytes.
//!
//! In: a [`Toolpath`]. Out: zlib-compressed bytes, and what is needed to read
//! them. Neighbouring values differ little, so the differences are kept. They
//! are folded, so that small differences of either sign are small numbers (0,
//! −1, 1, −2 become 0, 1, 2, 3). All low bytes of these come first, then all
//! high bytes, most of which are 0.
//!
//! The order: x, y and z of all points, in 2 bytes each; width, height,
//! cross-section, speed and heat of all moves, in 2 bytes each; the roles and
//! the fans, in 1 byte each, not as differences; the lines, in 4 bytes each; how
//! many moves were made before each retraction, in 4 bytes each.

use super::toolpath::Toolpath;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::{self, Write};

/// The compressed bytes, and where the points lie.
#[derive(Debug)]
pub(super) struct Packed {
    pub bytes: Vec<u8>,
    /// Number of bytes before compression.
    pub size: usize,
    /// Position of the point (0, 0, 0), mm.
    pub origin: [f64; 3],
    /// Length of a unit, mm.
    pub unit: f64,
}

/// Packs a toolpath.
///
/// # Errors
/// Never, since it writes to memory. The encoder's interface requires it.
pub(super) fn pack(path: &Toolpath) -> io::Result<Packed> {
    let mut min = [f32::INFINITY; 3];
    let mut max = [f32::NEG_INFINITY; 3];
    for p in &path.points {
        for i in 0..3 {
            min[i] = min[i].min(p[i]);
            max[i] = max[i].max(p[i]);
        }
    }
    let extent = (0..3).map(|i| f64::from(max[i]) - f64::from(min[i]));
    let extent = extent.fold(0.0, f64::max);
    // The unit is 1 µm if everything fits into 65 mm.
    let unit = (extent / f64::from(u16::MAX)).max(1e-3);
    let origin = min.map(|m| if m.is_finite() { f64::from(m) } else { 0.0 });

    let mut packer = Packer::default();
    for i in 0..3 {
        packer.put(
            path.points
                .iter()
                .map(|p| ((f64::from(p[i]) - origin[i]) / unit).round() as u16),
        )?;
    }
    let shorts = [
        &path.widths,
        &path.heights,
        &path.areas,
        &path.speeds,
        &path.heats,
    ];
    for numbers in shorts {
        packer.put(numbers.iter().copied())?;
    }
    packer.bytes(&path.roles)?;
    packer.bytes(&path.fans)?;
    packer.put_long(&path.lines)?;
    packer.put_long(&path.retracted)?;
    Ok(Packed {
        size: packer.size,
        bytes: packer.encoder.finish()?,
        origin,
        unit,
    })
}

struct Packer {
    encoder: ZlibEncoder<Vec<u8>>,
    size: usize,
}

impl Default for Packer {
    fn default() -> Self {
        Self {
            encoder: ZlibEncoder::new(Vec::new(), Compression::new(6)),
            size: 0,
        }
    }
}

impl Packer {
    fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.size += bytes.len();
        self.encoder.write_all(bytes)
    }

    fn put(
        &mut self,
        numbers: impl Iterator<Item = u16> + Clone,
    ) -> io::Result<()> {
        let folded = differences(numbers, |a, b| {
            let by = a.wrapping_sub(b) as i16;
            ((by << 1) ^ (by >> 15)) as u16
        });
        for shift in [0, 8] {
            let plane: Vec<u8> =
                folded.iter().map(|n| (n >> shift) as u8).collect();
            self.bytes(&plane)?;
        }
        Ok(())
    }

    fn put_long(&mut self, numbers: &[u32]) -> io::Result<()> {
        let folded = differences(numbers.iter().copied(), |a, b| {
            let by = a.wrapping_sub(b) as i32;
            ((by << 1) ^ (by >> 31)) as u32
        });
        for shift in [0, 8, 16, 24] {
            let plane: Vec<u8> =
                folded.iter().map(|n| (n >> shift) as u8).collect();
            self.bytes(&plane)?;
        }
        Ok(())
    }
}

fn differences<T: Copy + Default>(
    numbers: impl Iterator<Item = T>,
    fold: impl Fn(T, T) -> T,
) -> Vec<T> {
    let mut last = T::default();
    numbers
        .map(|number| fold(number, std::mem::replace(&mut last, number)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_gcode_read::reader::Reader;
    use std::io::Read;

    /// Unpacks as the page does.
    fn unpack(planes: &[u8]) -> Vec<u16> {
        let (low, high) = planes.split_at(planes.len() / 2);
        let mut last = 0_u16;
        low.iter()
            .zip(high)
            .map(|(low, high)| {
                let n = u16::from(*low) | u16::from(*high) << 8;
                last = last.wrapping_add((n >> 1) ^ (n & 1).wrapping_neg());
                last
            })
            .collect()
    }

    #[test]
    fn what_is_packed_can_be_unpacked() {
        let text = "G1 X0 Y0 Z0.2 F60000\nG1 X300 E9\nG1 X12 Y-9 E10 F60\n\
                    G1 X12.3 Y-8.7 E10.1\n";
        let path = Toolpath::read(Reader::new(text.as_bytes())).unwrap();
        let packed = pack(&path).unwrap();
        let mut bytes = Vec::new();
        flate2::read::ZlibDecoder::new(&packed.bytes[..])
            .read_to_end(&mut bytes)
            .unwrap();
        assert_eq!(bytes.len(), packed.size);
        let points = path.points.len();
        for axis in 0..3 {
            let found = unpack(&bytes[2 * axis * points..][..2 * points]);
            for (n, p) in found.iter().zip(&path.points) {
                let at = packed.origin[axis] + packed.unit * f64::from(*n);
                // The error is half a unit, and that of single precision.
                let error = (at - f64::from(p[axis])).abs();
                assert!(error < 0.501 * packed.unit + 1e-5, "{error}");
            }
        }
        assert!(packed.unit < 5e-3);
        let moves = path.len();
        let speeds = &bytes[6 * points + 6 * moves..][..2 * moves];
        assert_eq!(unpack(speeds), path.speeds);
        assert_eq!(path.speeds[1], 50);
    }

    #[test]
    fn nothing_can_be_packed_too() {
        let path = Toolpath::read(Reader::new(&b""[..])).unwrap();
        let packed = pack(&path).unwrap();
        assert_eq!(packed.size, 0);
    }
}
