//! PLY: a head that says what follows, and lists of vertices and faces.
//!
//! ```text
//! ply
//! format ascii 1.0                        or binary_little_endian, _big_endian
//! element vertex 8
//! property float x
//! property float y
//! property float z
//! element face 6
//! property list uchar int vertex_indices
//! end_header
//! 0 0 0                                   a line for each element, or its bytes
//! 4 0 1 2 3
//! ```
//!
//! Other elements and properties are skipped.

use super::polygon::{Face, add};
use super::words::{Words, shortened};
use crate::error::MeshError;
use crate::limits::MOST_TRIANGLES;
use crate::triangles::{Collector, Triangles};
use glam::DVec3;
use std::io::Read;

/// Greatest number of elements and properties in a head. Files have a dozen.
const MOST_PARTS: usize = 1000;

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn named(name: &[u8]) -> Option<Kind> {
        Some(match name {
            b"char" | b"int8" => Kind::I8,
            b"uchar" | b"uint8" => Kind::U8,
            b"short" | b"int16" => Kind::I16,
            b"ushort" | b"uint16" => Kind::U16,
            b"int" | b"int32" => Kind::I32,
            b"uint" | b"uint32" => Kind::U32,
            b"float" | b"float32" => Kind::F32,
            b"double" | b"float64" => Kind::F64,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        }
    }

    /// The number that bytes are, the lowest one first.
    fn number(self, bytes: [u8; 8]) -> f64 {
        let [a, b, c, d, ..] = bytes;
        match self {
            Kind::I8 => i8::from_le_bytes([a]).into(),
            Kind::U8 => a.into(),
            Kind::I16 => i16::from_le_bytes([a, b]).into(),
            Kind::U16 => u16::from_le_bytes([a, b]).into(),
            Kind::I32 => i32::from_le_bytes([a, b, c, d]).into(),
            Kind::U32 => u32::from_le_bytes([a, b, c, d]).into(),
            Kind::F32 => f32::from_le_bytes([a, b, c, d]).into(),
            Kind::F64 => f64::from_le_bytes(bytes),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// What a number means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meaning {
    /// A coordinate, by axis.
    Axis(usize),
    /// The corners of a face.
    Corners,
    /// The corners of a strip of triangles, strips being parted by −1.
    Strips,
    Other,
}

#[derive(Clone, Copy, Debug)]
struct Property {
    meaning: Meaning,
    kind: Kind,
    /// The type of its length, if it is a list.
    length: Option<Kind>,
}

#[derive(Debug)]
struct Element {
    name: Vec<u8>,
    count: u64,
    properties: Vec<Property>,
}

pub(super) fn read(source: impl Read) -> Result<Triangles, MeshError> {
    let mut words = Words::new(source);
    let (encoding, elements) = head(&mut words)?;
    let mut numbers = Numbers { encoding, words };
    let mut all = Collector::default();
    let mut vertices: Vec<u32> = Vec::new();
    let mut face = Face::default();
    for element in &elements {
        let is_vertex = element.name == b"vertex";
        let mut had = 0;
        for i in 0..element.count {
            if i % 4096 == 0 {
                isoslice_base::limits::go_on()?;
            }
            let mut p = DVec3::ZERO;
            for property in &element.properties {
                let Some(length) = property.length else {
                    let number = numbers.next(property.kind, element, i)?;
                    if let Meaning::Axis(axis) = property.meaning {
                        p[axis] = number;
                    }
                    continue;
                };
                let length = numbers.next(length, element, i)?;
                if !(0.0..=1e9).contains(&length) {
                    let what = format!("a list of {length} numbers");
                    return Err(wrong(element, i, &what));
                }
                for nth in 0..length as u64 {
                    if nth % 4096 == 4095 {
                        isoslice_base::limits::go_on()?;
                    }
                    let number = numbers.next(property.kind, element, i)?;
                    match property.meaning {
                        Meaning::Corners => {}
                        Meaning::Strips if number == -1.0 => {
                            strip(&mut all, &mut face)?;
                            continue;
                        }
                        Meaning::Strips => {}
                        _ => continue,
                    }
                    let corner = vertices.get(number as usize);
                    let corner = corner.filter(|_| number >= 0.0);
                    face.corners.push(*corner.ok_or_else(|| {
                        let count = vertices.len();
                        wrong(
                            element,
                            i,
                            &format!(
                                "there is no vertex {number}: {count} come \
                                 before, and the first is 0"
                            ),
                        )
                    })?);
                    if face.corners.len() > MOST_TRIANGLES {
                        return Err(MeshError::TooMany);
                    }
                }
                match property.meaning {
                    Meaning::Strips => strip(&mut all, &mut face)?,
                    Meaning::Corners => add(&mut all, &mut face)?,
                    _ => {}
                }
            }
            if is_vertex {
                had += 1;
                let place = || format!("vertex {had}");
                vertices.push(all.vertex(p, place)?);
                if vertices.len() > 3 * MOST_TRIANGLES {
                    return Err(MeshError::TooMany);
                }
            }
        }
    }
    all.finish()
}

/// Adds the triangles of a strip: each is turned against the one before.
fn strip(all: &mut Collector, face: &mut Face) -> Result<(), MeshError> {
    for (i, corners) in face.corners.windows(3).enumerate() {
        let (a, b, c) = (corners[0], corners[1], corners[2]);
        all.triangle(if i % 2 == 0 { [a, b, c] } else { [b, a, c] })?;
    }
    face.corners.clear();
    Ok(())
}

/// Numbers, one after another.
struct Numbers<R> {
    encoding: Encoding,
    words: Words<R>,
}

impl<R: Read> Numbers<R> {
    fn next(
        &mut self,
        kind: Kind,
        element: &Element,
        i: u64,
    ) -> Result<f64, MeshError> {
        if self.encoding == Encoding::Text {
            return self.words.number();
        }
        let mut bytes = [0; 8];
        let part = &mut bytes[..kind.bytes()];
        if let Err(e) = self.words.bytes(part) {
            return Err(if e.kind() == std::io::ErrorKind::UnexpectedEof {
                let what = format!(
                    "the file ends here, and the head promises {}: it is cut \
                     off; export it again",
                    element.count
                );
                wrong(element, i, &what)
            } else {
                e.into()
            });
        }
        if self.encoding == Encoding::Big {
            part.reverse();
        }
        Ok(kind.number(bytes))
    }
}

fn wrong(element: &Element, i: u64, what: &str) -> MeshError {
    let name = shortened(&element.name);
    MeshError::at(format_args!("{name} {}", i + 1), what)
}

/// Reads the head, up to its last line.
fn head<R: Read>(
    words: &mut Words<R>,
) -> Result<(Encoding, Vec<Element>), MeshError> {
    if words.next()? != Some(b"ply") {
        return Err(MeshError::File(
            "it does not begin with `ply`, so it is no PLY file".into(),
        ));
    }
    words.skip_line()?;
    let mut encoding = Encoding::Text;
    let mut elements: Vec<Element> = Vec::new();
    for _ in 0..MOST_PARTS {
        let Some(word) = words.next()? else {
            break;
        };
        match word {
            b"format" => {
                encoding = match words.next_in_line()? {
                    Some(b"ascii") => Encoding::Text,
                    Some(b"binary_little_endian") => Encoding::Little,
                    Some(b"binary_big_endian") => Encoding::Big,
                    _ => return Err(words.wrong("an unknown format")),
                };
            }
            b"element" => {
                let name = words.next_in_line()?.unwrap_or_default().to_vec();
                let count =
                    words.next_in_line()?.and_then(super::words::parsed);
                let Some(count) = count else {
                    return Err(words.wrong("an element without a number"));
                };
                elements.push(Element {
                    name,
                    count,
                    properties: Vec::new(),
                });
            }
            b"property" => {
                let mut property = property(words)?;
                let Some(element) = elements.last_mut() else {
                    return Err(words.wrong("a property of no element"));
                };
                if element.name == b"tristrips"
                    && property.meaning == Meaning::Corners
                {
                    property.meaning = Meaning::Strips;
                }
                element.properties.push(property);
            }
            b"end_header" => {
                words.skip_line()?;
                checked(&elements)?;
                return Ok((encoding, elements));
            }
            b"comment" | b"obj_info" => {}
            _ => return Err(words.wrong("an unknown line of a head")),
        }
        words.skip_line()?;
    }
    Err(MeshError::File(
        "its head has no end (`end_header`): it is cut off, or no PLY file"
            .into(),
    ))
}

/// Elements without properties take no bytes, so any number of them could be
/// promised.
fn checked(elements: &[Element]) -> Result<(), MeshError> {
    let has = |name: &[u8], meaning: Meaning| {
        let mut named = elements.iter().filter(|e| e.name == name);
        named.any(|e| e.properties.iter().any(|p| p.meaning == meaning))
    };
    for element in elements {
        if element.properties.is_empty() && element.count > 0 {
            return Err(MeshError::at(
                shortened(&element.name),
                "this element has no properties",
            ));
        }
    }
    if (0..3).all(|k| has(b"vertex", Meaning::Axis(k))) {
        Ok(())
    } else {
        Err(MeshError::File(
            "its vertices have no x, y and z; export it as a mesh".into(),
        ))
    }
}

fn property<R: Read>(words: &mut Words<R>) -> Result<Property, MeshError> {
    let kind = |words: &mut Words<R>| {
        let kind = words.next_in_line()?.and_then(Kind::named);
        kind.ok_or_else(|| words.wrong("an unknown type of numbers"))
    };
    let first = words.next_in_line()?.unwrap_or_default();
    let (length, kind) = if first == b"list" {
        (Some(kind(words)?), kind(words)?)
    } else {
        let Some(kind) = Kind::named(first) else {
            return Err(words.wrong("an unknown type of numbers"));
        };
        (None, kind)
    };
    let name = words.next_in_line()?.unwrap_or_default();
    let meaning = match (length.is_some(), name) {
        (false, b"x") => Meaning::Axis(0),
        (false, b"y") => Meaning::Axis(1),
        (false, b"z") => Meaning::Axis(2),
        (true, b"vertex_indices" | b"vertex_index") => Meaning::Corners,
        _ => Meaning::Other,
    };
    Ok(Property {
        meaning,
        kind,
        length,
    })
}
