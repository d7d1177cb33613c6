//! Reads NIfTI, versions 1 and 2, in one file, compressed or not.

use super::Read;
use crate::lattice::Layout;
use crate::numbers::{Kind, count};
use crate::stream::{self, Unzipped};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use isoslice_base::problem::Problem;

/// The lengths of the headers of the two versions.
const LENGTHS: [usize; 2] = [348, 540];

/// A header, and how to read numbers in it.
struct Header {
    bytes: Vec<u8>,
    big: bool,
    version: usize,
}

/// Where fields are in the headers of versions 1 and 2.
mod at {
    pub(super) const SIZES: [usize; 2] = [40, 16];
    pub(super) const KIND: [usize; 2] = [70, 12];
    pub(super) const SPACINGS: [usize; 2] = [76, 104];
    pub(super) const DATA: [usize; 2] = [108, 168];
    pub(super) const SLOPE: [usize; 2] = [112, 176];
    pub(super) const OFFSET: [usize; 2] = [116, 184];
    pub(super) const UNITS: [usize; 2] = [123, 500];
    pub(super) const BY_ROTATION: [usize; 2] = [252, 344];
    pub(super) const BY_ROWS: [usize; 2] = [254, 348];
    pub(super) const ROTATION: [usize; 2] = [256, 352];
    pub(super) const ROWS: [usize; 2] = [280, 400];
    pub(super) const MAGIC: [usize; 2] = [344, 4];
}

impl Header {
    fn bytes<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut bytes = [0; N];
        if let Some(there) = self.bytes.get(at..at + N) {
            bytes.copy_from_slice(there);
        }
        if self.big {
            bytes.reverse();
        }
        bytes
    }

    fn short(&self, at: usize) -> i64 {
        i16::from_le_bytes(self.bytes(at)).into()
    }

    /// A whole number: 16 bits in version 1, `wide` in version 2.
    fn size(&self, at: usize, i: usize) -> i64 {
        match self.version {
            0 => self.short(at + 2 * i),
            _ => i64::from_le_bytes(self.bytes(at + 8 * i)),
        }
    }

    /// A code: 16 bits in version 1, 32 bits in version 2.
    fn code(&self, at: usize) -> i64 {
        match self.version {
            0 => self.short(at),
            _ => i32::from_le_bytes(self.bytes(at)).into(),
        }
    }

    fn float(&self, at: usize, i: usize) -> f64 {
        match self.version {
            0 => f32::from_le_bytes(self.bytes(at + 4 * i)).into(),
            _ => f64::from_le_bytes(self.bytes(at + 8 * i)),
        }
    }

    /// A header is known by its length, which is its first field.
    fn new(bytes: Vec<u8>) -> Problem<Header> {
        let mut first = [0; 4];
        if let Some(there) = bytes.get(..4) {
            first.copy_from_slice(there);
        }
        for big in [false, true] {
            let length = if big {
                u32::from_be_bytes(first)
            } else {
                u32::from_le_bytes(first)
            };
            let version = LENGTHS.iter().position(|l| *l as u32 == length);
            if let Some(version) = version {
                return Header {
                    bytes,
                    big,
                    version,
                }
                .checked();
            }
        }
        Err(
            "neither NRRD, NIfTI nor a .npy file; save it as one of these. \
             DICOM is converted by dcm2niix"
                .into(),
        )
    }

    fn checked(self) -> Problem<Header> {
        let at = at::MAGIC[self.version];
        let magic = self.bytes.get(at..at + 3);
        if magic.is_some_and(|m| m == b"ni1" || m == b"ni2") {
            return Err("its numbers are in a second file (.img); save it in \
                        one file, as .nii"
                .into());
        }
        if !magic.is_some_and(|m| m == b"n+1" || m == b"n+2") {
            return Err("its header is no NIfTI's; save it as .nii".into());
        }
        Ok(self)
    }

    fn kind(&self) -> Problem<Kind> {
        Ok(match self.short(at::KIND[self.version]) {
            2 => Kind::U8,
            4 => Kind::I16,
            8 => Kind::I32,
            16 => Kind::F32,
            64 => Kind::F64,
            256 => Kind::I8,
            512 => Kind::U16,
            768 => Kind::U32,
            1024 => Kind::I64,
            1280 => Kind::U64,
            other => {
                return Err(format!(
                    "its numbers are of the type {other}, which are colours, \
                     bits or complex; save it with whole or floating-point \
                     numbers"
                ));
            }
        })
    }

    /// How many samples there are along each axis.
    fn sizes(&self) -> Problem<[usize; 3]> {
        let at = at::SIZES[self.version];
        let axes = self.size(at, 0);
        if !(1..=7).contains(&axes) {
            return Err(format!("its header says that it has {axes} axes"));
        }
        let size = |axis: usize| {
            if axis as i64 <= axes {
                usize::try_from(self.size(at, axis)).unwrap_or(0)
            } else {
                1
            }
        };
        if (4..8).any(|axis| size(axis) > 1) {
            return Err("it has more than three axes; save one volume of it, \
                        without time and colours"
                .into());
        }
        Ok([size(1), size(2), size(3)])
    }

    /// Where samples lie, mm.
    fn lies(&self) -> DAffine3 {
        let v = self.version;
        let unit = match self.bytes.get(at::UNITS[v]).unwrap_or(&0) & 7 {
            1 => 1000.0,
            3 => 0.001,
            _ => 1.0,
        };
        let spacing = |i: usize| self.float(at::SPACINGS[v], i);
        let mut lies = if self.code(at::BY_ROWS[v]) > 0 {
            let row = |r: usize, c: usize| self.float(at::ROWS[v], 4 * r + c);
            let column = |c| DVec3::new(row(0, c), row(1, c), row(2, c));
            DAffine3::from_cols(column(0), column(1), column(2), column(3))
        } else if self.code(at::BY_ROTATION[v]) > 0 {
            let [b, c, d, x, y, z] =
                std::array::from_fn(|i| self.float(at::ROTATION[v], i));
            let a = (1.0 - (b * b + c * c + d * d)).max(0.0).sqrt();
            let flip = if spacing(0) < 0.0 { -1.0 } else { 1.0 };
            let size = DVec3::new(spacing(1), spacing(2), spacing(3) * flip);
            let turn = DQuat::from_xyzw(b, c, d, a).normalize();
            DAffine3 {
                matrix3: DMat3::from_quat(turn) * DMat3::from_diagonal(size),
                translation: DVec3::new(x, y, z),
            }
        } else {
            DAffine3::from_scale(DVec3::new(spacing(1), spacing(2), spacing(3)))
        };
        // Axes of one sample may have no spacing.
        let sizes = self.sizes().unwrap_or([1; 3]);
        for (axis, size) in sizes.into_iter().enumerate() {
            if size == 1 && lies.matrix3.col(axis) == DVec3::ZERO {
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                let across = lies.matrix3.col(a).cross(lies.matrix3.col(b));
                *lies.matrix3.col_mut(axis) = across.normalize_or_zero();
            }
        }
        let scale = DAffine3::from_scale(DVec3::splat(unit));
        scale * lies
    }

    /// What values are made of numbers.
    fn scale(&self) -> [f64; 2] {
        let slope = self.float(at::SLOPE[self.version], 0);
        let offset = self.float(at::OFFSET[self.version], 0);
        if slope == 0.0 || !slope.is_finite() || !offset.is_finite() {
            return [1.0, 0.0];
        }
        [slope, offset]
    }

    /// Where numbers begin.
    fn data(&self) -> Problem<usize> {
        let at = at::DATA[self.version];
        let from = match self.version {
            0 => self.float(at, 0),
            _ => i64::from_le_bytes(self.bytes(at)) as f64,
        };
        // Less is no place, and headers' extensions have no megabytes.
        let length = LENGTHS[self.version] as f64;
        if (length..=1e8).contains(&from) {
            Ok(from as usize)
        } else {
            Err(format!("its header says that its numbers begin at {from}"))
        }
    }
}

pub(super) fn read(bytes: &[u8]) -> Problem<Read> {
    let zipped = bytes.starts_with(b"\x1f\x8b");
    let mut unzipped = Unzipped::new(bytes);
    let header = if zipped {
        let mut header = vec![0; LENGTHS[0]];
        unzipped.bytes(&mut header)?;
        if header.starts_with(&[28, 2]) || header.starts_with(&[0, 0, 2, 28]) {
            header.resize(LENGTHS[1], 0);
            let rest = header.get_mut(LENGTHS[0]..).unwrap_or_default();
            unzipped.bytes(rest)?;
        }
        header
    } else {
        bytes.iter().copied().take(LENGTHS[1]).collect()
    };
    let length = header.len();
    let header = Header::new(header)?;
    let kind = header.kind()?;
    let size = header.sizes()?;
    let count = count(size, kind)?;
    let from = header.data()?;
    let numbers = if zipped {
        unzipped.skip(from.saturating_sub(length))?;
        unzipped.numbers(kind, header.big, count)?
    } else {
        let data = bytes.get(from..).unwrap_or_default();
        stream::raw(data, kind, header.big, count)?
    };
    Ok(Read {
        numbers,
        layout: Layout::first_fastest(size),
        scale: header.scale(),
        lies: Some(header.lies()),
    })
}
