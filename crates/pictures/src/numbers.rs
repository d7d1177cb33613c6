//! The numbers of a lattice, in as few bytes as they need.

use isoslice_base::problem::Problem;

/// Numbers of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// Whole numbers from 0 to 255.
    U8(Vec<u8>),
    /// Whole numbers from -128 to 127.
    I8(Vec<i8>),
    /// Whole numbers from 0 to 65535.
    U16(Vec<u16>),
    /// Whole numbers from -32768 to 32767.
    I16(Vec<i16>),
    /// Floating-point numbers.
    F32(Vec<f32>),
}

/// Does something with the numbers, whatever kind they are of.
macro_rules! with_numbers {
    ($numbers:expr, $data:ident => $do:expr) => {
        match $numbers {
            Numbers::U8($data) => $do,
            Numbers::I8($data) => $do,
            Numbers::U16($data) => $do,
            Numbers::I16($data) => $do,
            Numbers::F32($data) => $do,
        }
    };
}
pub(crate) use with_numbers;

impl Numbers {
    /// How many numbers there are.
    pub fn len(&self) -> usize {
        with_numbers!(self, data => data.len())
    }

    /// Whether there is no number.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Their memory, bytes.
    pub fn bytes(&self) -> usize {
        with_numbers!(self, data => size_of_val(data.as_slice()))
    }

    /// Tells their kind and their bytes.
    pub(crate) fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        let kind = match self {
            Numbers::U8(_) => 0,
            Numbers::I8(_) => 1,
            Numbers::U16(_) => 2,
            Numbers::I16(_) => 3,
            Numbers::F32(_) => 4,
        };
        tell(&[kind]);
        let mut part = Vec::new();
        with_numbers!(self, data => {
            for some in data.chunks(1 << 12) {
                part.clear();
                some.iter().for_each(|v| part.extend(v.to_le_bytes()));
                tell(&part);
            }
        });
    }

    /// The greatest value that numbers of this kind can have, which stands for
    /// white; 1 for floating-point numbers.
    pub(crate) fn white(&self) -> f64 {
        match self {
            Numbers::U8(_) => 255.0,
            Numbers::I8(_) => 127.0,
            Numbers::U16(_) => 65535.0,
            Numbers::I16(_) => 32767.0,
            Numbers::F32(_) => 1.0,
        }
    }

    /// Puts a number in the place of those that are NaN or infinite.
    pub(crate) fn without_nan(&mut self, fill: Option<f64>) -> Problem<()> {
        let Numbers::F32(data) = self else {
            return Ok(());
        };
        let Some(fill) = fill else {
            let bad = data.iter().position(|v| !v.is_finite());
            return bad.map_or(Ok(()), |i| {
                Err(format!(
                    "number {i} is {}; say with `missing` what stands there",
                    data.get(i).copied().unwrap_or(f32::NAN)
                ))
            });
        };
        if !(fill as f32).is_finite() {
            return Err(format!("`missing` is {fill}; it has to be a number"));
        }
        for v in data.iter_mut().filter(|v| !v.is_finite()) {
            *v = fill as f32;
        }
        Ok(())
    }
}

/// How numbers are written in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F16,
    F32,
    F64,
}

impl Kind {
    /// Bytes of one number in the file.
    pub(crate) fn size(self) -> usize {
        match self {
            Kind::U8 | Kind::I8 => 1,
            Kind::U16 | Kind::I16 | Kind::F16 => 2,
            Kind::U32 | Kind::I32 | Kind::F32 => 4,
            Kind::U64 | Kind::I64 | Kind::F64 => 8,
        }
    }

    /// Bytes of one number in memory.
    pub(crate) fn kept(self) -> usize {
        match self {
            Kind::U8 | Kind::I8 => 1,
            Kind::U16 | Kind::I16 => 2,
            _ => 4,
        }
    }

    /// An empty list with room for `n` such numbers.
    pub(crate) fn list(self, n: usize) -> Numbers {
        match self {
            Kind::U8 => Numbers::U8(Vec::with_capacity(n)),
            Kind::I8 => Numbers::I8(Vec::with_capacity(n)),
            Kind::U16 => Numbers::U16(Vec::with_capacity(n)),
            Kind::I16 => Numbers::I16(Vec::with_capacity(n)),
            _ => Numbers::F32(Vec::with_capacity(n)),
        }
    }

    /// Appends the numbers that some bytes are.
    pub(crate) fn append(self, bytes: &[u8], big: bool, to: &mut Numbers) {
        macro_rules! each {
            ($n:literal, $list:expr, $from:expr) => {{
                let (all, _) = bytes.as_chunks::<$n>();
                $list.extend(all.iter().map(|&b| {
                    let mut b = b;
                    if big {
                        b.reverse();
                    }
                    $from(b)
                }))
            }};
        }
        match (to, self) {
            (Numbers::U8(to), _) => to.extend_from_slice(bytes),
            (Numbers::I8(to), _) => each!(1, to, i8::from_le_bytes),
            (Numbers::U16(to), _) => each!(2, to, u16::from_le_bytes),
            (Numbers::I16(to), _) => each!(2, to, i16::from_le_bytes),
            (Numbers::F32(to), Kind::F16) => {
                each!(2, to, |b| half(u16::from_le_bytes(b)));
            }
            (Numbers::F32(to), Kind::U32) => {
                each!(4, to, |b| u32::from_le_bytes(b) as f32);
            }
            (Numbers::F32(to), Kind::I32) => {
                each!(4, to, |b| i32::from_le_bytes(b) as f32);
            }
            (Numbers::F32(to), Kind::U64) => {
                each!(8, to, |b| u64::from_le_bytes(b) as f32);
            }
            (Numbers::F32(to), Kind::I64) => {
                each!(8, to, |b| i64::from_le_bytes(b) as f32);
            }
            (Numbers::F32(to), Kind::F64) => {
                each!(8, to, |b| f64::from_le_bytes(b) as f32);
            }
            (Numbers::F32(to), _) => each!(4, to, f32::from_le_bytes),
        }
    }
}

/// A floating-point number of 16 bits.
fn half(bits: u16) -> f32 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, part) = (bits >> 10 & 31, f32::from(bits & 1023));
    // Powers of two down to 2⁻²⁴, exact.
    let power = |e: u16| f32::from_bits(u32::from(e + 127 - 25) << 23);
    sign * match exponent {
        0 => part * power(1),
        31 if part == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        e => (1024.0 + part) * power(e),
    }
}

/// The number of samples and bytes of a lattice of some size, if it may be.
pub(crate) fn count(size: [usize; 3], kind: Kind) -> Problem<usize> {
    let [a, b, c] = size;
    if size.contains(&0) {
        return Err(format!("it is empty: its size is {a} × {b} × {c}"));
    }
    let all = a.checked_mul(b).and_then(|n| n.checked_mul(c));
    let most = crate::MOST_BYTES / kind.kept().max(kind.size().min(4));
    all.filter(|n| *n <= most).ok_or_else(|| {
        format!(
            "its header says {a} × {b} × {c} samples, which take more than \
             1 GiB; crop it, take every other sample, or write it with 8 or 16 \
             bits"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_what_they_are() {
        for (bits, value) in [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0001, 5.960_464_5e-8),
            (0x0400, 6.103_515_6e-5),
            (0, 0.0),
        ] {
            assert_eq!(half(bits), value, "{bits:x}");
        }
        assert!(half(0x7c00).is_infinite() && half(0x7e00).is_nan());
    }

    #[test]
    fn kinds_and_orders_of_bytes() {
        let read = |kind: Kind, bytes: &[u8], big| {
            let mut list = kind.list(0);
            kind.append(bytes, big, &mut list);
            list
        };
        let big = [1, 2, 3, 4, 0xff, 0, 0, 1];
        assert_eq!(
            read(Kind::I16, &big, true),
            Numbers::I16(vec![0x102, 0x304, -256, 1])
        );
        assert_eq!(
            read(Kind::U16, &big[..2], false),
            Numbers::U16(vec![0x201])
        );
        assert_eq!(
            read(Kind::F64, &2.5_f64.to_be_bytes(), true),
            Numbers::F32(vec![2.5])
        );
        assert_eq!(
            read(Kind::I32, &(-7_i32).to_le_bytes(), false),
            Numbers::F32(vec![-7.0])
        );
    }
}
