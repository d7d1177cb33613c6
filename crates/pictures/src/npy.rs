//! Reads `.npy`, the files of NumPy's `save`: arrays of numbers.
//!
//! A file begins with a Python dictionary such as
//! `{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }`.

use crate::numbers::{Kind, Numbers, count};
use crate::stream;
use isoslice_base::problem::Problem;

/// How such files begin.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";

/// An array. Numbers are in the order of the file.
pub(crate) struct Array {
    pub(crate) numbers: Numbers,
    /// How many there are along each axis: two or three axes.
    pub(crate) shape: Vec<usize>,
    /// Whether the first axis runs fastest, not the last.
    pub(crate) fortran: bool,
}

pub(crate) fn read(bytes: &[u8]) -> Problem<Array> {
    let cut = || "it ends within its header; save it again".to_owned();
    let version = *bytes.get(6).ok_or_else(cut)?;
    let (at, length) = match version {
        1 => (
            10,
            bytes
                .get(8..10)
                .map(|b| u32::from(b[0]) | u32::from(b[1]) << 8),
        ),
        2 | 3 => (
            12,
            bytes
                .get(8..12)
                .and_then(|b| b.try_into().ok())
                .map(u32::from_le_bytes),
        ),
        _ => {
            return Err(format!(
                "version {version} of .npy is not known; save it with \
                 numpy.save"
            ));
        }
    };
    let end = at + length.ok_or_else(cut)? as usize;
    let header = bytes.get(at..end).ok_or_else(cut)?;
    // As much as NumPy itself reads.
    if header.len() > 10_000 {
        return Err("its header is longer than 10,000 bytes".into());
    }
    let header = String::from_utf8_lossy(header);
    let (kind, big) = kind(text(&header, "descr")?)?;
    let shape = shape(&header)?;
    let fortran = text(&header, "fortran_order")?.starts_with("True");
    let size = std::array::from_fn(|a| shape.get(a).copied().unwrap_or(1));
    let is_bool = kind == Kind::U8 && text(&header, "descr")?.contains("b1");
    let count = count(size, if is_bool { Kind::F32 } else { kind })?;
    let data = bytes.get(end..).unwrap_or_default();
    let numbers = match stream::raw(data, kind, big, count)? {
        // True is 1, in a picture as well, where 255 is white in bytes.
        Numbers::U8(all) if is_bool => {
            Numbers::F32(all.into_iter().map(|n| f32::from(n != 0)).collect())
        }
        numbers => numbers,
    };
    Ok(Array {
        numbers,
        shape,
        fortran,
    })
}

/// What follows a key of the header.
fn text<'a>(header: &'a str, key: &str) -> Problem<&'a str> {
    let after = |quote: char| {
        let (_, rest) = header.split_once(&format!("{quote}{key}{quote}"))?;
        Some(rest.trim_start().strip_prefix(':')?.trim_start())
    };
    after('\'').or_else(|| after('"')).ok_or_else(|| {
        format!("its header has no `{key}`; save it with numpy.save")
    })
}

/// The kind of the numbers, and whether their greatest byte is first.
fn kind(descr: &str) -> Problem<(Kind, bool)> {
    let name = descr
        .strip_prefix(['\'', '"'])
        .and_then(|rest| rest.split(['\'', '"']).next())
        .ok_or("it is an array of records; save an array of numbers")?;
    let big = name.starts_with('>');
    let kind = match name.trim_start_matches(['<', '>', '|', '=']) {
        "u1" | "b1" => Kind::U8,
        "i1" => Kind::I8,
        "u2" => Kind::U16,
        "i2" => Kind::I16,
        "u4" => Kind::U32,
        "i4" => Kind::I32,
        "u8" => Kind::U64,
        "i8" => Kind::I64,
        "f2" => Kind::F16,
        "f4" => Kind::F32,
        "f8" => Kind::F64,
        _ => {
            return Err(format!(
                "its numbers are of the kind {name:?}; save it as float32: \
                 numpy.save(…, a.astype(\"float32\"))"
            ));
        }
    };
    Ok((kind, big))
}

/// How many numbers there are along each axis.
fn shape(header: &str) -> Problem<Vec<usize>> {
    let text = text(header, "shape")?;
    let inner = text
        .strip_prefix('(')
        .and_then(|rest| rest.split(')').next())
        .ok_or("its header has a shape that is none")?;
    let axes = inner.split(',').map(str::trim).filter(|n| !n.is_empty());
    let shape: Result<Vec<usize>, _> = axes.map(str::parse).collect();
    let shape = shape.map_err(|_| format!("its shape is ({inner})"))?;
    match shape.len() {
        2 | 3 => Ok(shape),
        n => Err(format!(
            "it has {n} axes; two make a picture, and three a volume: use \
             reshape or squeeze"
        )),
    }
}
