//! STL: triangles without shared vertices, as text or binary.
//!
//! ```text
//! solid name                        80 bytes, often a name
//!  facet normal 0 0 1               number of triangles (u32)
//!   outer loop                      for each triangle 50 bytes:
//!    vertex 0 0 0                     normal, three vertices (f32)
//!    vertex 1 0 0                     two bytes more
//!    vertex 0 1 0
//!   endloop
//!  endfacet
//! endsolid name
//! ```
//!
//! Binary files may begin with `solid`, too. They have the length that follows
//! from their number of triangles. Normals are not read: the order of the
//! vertices says what is outside.

use super::words::Words;
use crate::error::MeshError;
use crate::limits::MOST_TRIANGLES;
use crate::triangles::{Collector, Triangles};
use glam::DVec3;
use std::io::{BufReader, Read, Seek};

/// Bytes before the triangles of a binary file.
const HEAD: u64 = 84;
/// Bytes of a triangle.
const TRIANGLE: usize = 50;

pub(super) fn read(
    mut source: impl Read + Seek,
    length: u64,
) -> Result<Triangles, MeshError> {
    let mut head = Vec::new();
    source.by_ref().take(HEAD).read_to_end(&mut head)?;
    let count = head
        .get(80..84)
        .and_then(|bytes| bytes.try_into().ok())
        .map(u32::from_le_bytes);
    let promised = count.map(|n| HEAD + TRIANGLE as u64 * u64::from(n));
    let is_text = promised != Some(length) && begins_as_text(&head);
    if is_text {
        source.rewind()?;
        return text(source);
    }
    match (count, promised) {
        (Some(count), Some(promised)) if promised <= length => {
            binary(source, count)
        }
        (Some(count), _) if length >= HEAD => Err(MeshError::File(format!(
            "it promises {count} triangles and holds {}: it is cut off, or no \
             STL file; export it again",
            (length - HEAD) / TRIANGLE as u64
        ))),
        _ => Err(MeshError::File(
            "it is too short for an STL file; export it again".into(),
        )),
    }
}

/// True if a file begins with `solid`.
fn begins_as_text(head: &[u8]) -> bool {
    let head = head.strip_prefix("\u{feff}".as_bytes()).unwrap_or(head);
    let head = head.trim_ascii_start();
    head.get(..5)
        .is_some_and(|b| b.eq_ignore_ascii_case(b"solid"))
}

fn binary(source: impl Read, count: u32) -> Result<Triangles, MeshError> {
    if count as usize > MOST_TRIANGLES {
        return Err(MeshError::TooMany);
    }
    let mut source = BufReader::with_capacity(1 << 16, source);
    let mut all = Collector::default();
    let mut bytes = [0; TRIANGLE];
    for i in 1..=count {
        source.read_exact(&mut bytes)?;
        let place = || format!("triangle {i}");
        let vertex = |k: usize| {
            DVec3::from_array([0, 4, 8].map(|at| {
                let at = 12 * (k + 1) + at;
                let [a, b, c, d] = [0, 1, 2, 3].map(|byte| bytes[at + byte]);
                f64::from(f32::from_le_bytes([a, b, c, d]))
            }))
        };
        let corners = [
            all.vertex(vertex(0), place)?,
            all.vertex(vertex(1), place)?,
            all.vertex(vertex(2), place)?,
        ];
        all.triangle(corners)?;
    }
    all.finish()
}

fn text(source: impl Read) -> Result<Triangles, MeshError> {
    let mut words = Words::new(source);
    let mut all = Collector::default();
    let mut corners = Vec::new();
    while let Some(word) = words.next()? {
        let word = word.to_ascii_lowercase();
        match word.as_slice() {
            b"vertex" => {
                if corners.len() == 3 {
                    return Err(words.wrong(
                        "a facet of more than three vertices; export the part \
                         as triangles",
                    ));
                }
                let p = words.point()?;
                let line = words.line();
                corners.push(all.vertex(p, || format!("line {line}"))?);
            }
            b"endloop" => {
                if let [a, b, c] = corners[..] {
                    all.triangle([a, b, c])?;
                } else {
                    return Err(words.wrong(
                        "a facet of fewer than three vertices; export the file \
                         again",
                    ));
                }
                corners.clear();
            }
            // Names may be any words.
            b"solid" | b"endsolid" | b"facet" => words.skip_line()?,
            _ => {}
        }
    }
    if !corners.is_empty() {
        return Err(MeshError::File(
            "it ends within a facet: it is cut off; export it again".into(),
        ));
    }
    all.finish()
}
