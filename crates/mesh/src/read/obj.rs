//! OBJ: vertices and faces as text.
//!
//! ```text
//! v 0 0 0            a vertex; after x, y, z may be a weight or a colour
//! f 1 2 3            a face of the first three vertices
//! f 4/1/2 5//3 -1    numbers of textures and normals are not read;
//!                    −1 is the last vertex so far
//! ```
//!
//! All other lines are skipped: objects, groups and materials part the faces,
//! and here they are one body.

use super::polygon::{Face, add};
use super::words::{self, Words, shortened};
use crate::error::MeshError;
use crate::limits::MOST_TRIANGLES;
use crate::triangles::{Collector, Triangles};
use std::io::Read;

pub(super) fn read(source: impl Read) -> Result<Triangles, MeshError> {
    let mut words = Words::new(source);
    let mut all = Collector::default();
    // The merged vertices, by the file's numbers.
    let mut vertices: Vec<u32> = Vec::new();
    let mut face = Face::default();
    while let Some(word) = words.next()? {
        match word {
            b"v" => {
                let p = words.point()?;
                let line = words.line();
                vertices.push(all.vertex(p, || format!("line {line}"))?);
                // Three for each triangle, if no triangles share any.
                if vertices.len() > 3 * MOST_TRIANGLES {
                    return Err(MeshError::TooMany);
                }
            }
            b"f" => {
                let line = words.line();
                face.corners.clear();
                while let Some(word) = words.next_in_line()? {
                    // The line goes on in the next one.
                    if word == b"\\" {
                        words.join_line();
                        continue;
                    }
                    let corner = corner(word, &vertices);
                    face.corners.push(corner.map_err(|what| {
                        MeshError::at(format_args!("line {line}"), what)
                    })?);
                    if face.corners.len() > MOST_TRIANGLES {
                        return Err(MeshError::TooMany);
                    }
                }
                add(&mut all, &mut face)?;
                continue;
            }
            _ => {}
        }
        words.skip_line()?;
    }
    all.finish()
}

/// The merged vertex of a face's corner, such as `3/1/2`.
fn corner(word: &[u8], vertices: &[u32]) -> Result<u32, String> {
    let end = word.iter().position(|b| *b == b'/');
    let digits = &word[..end.unwrap_or(word.len())];
    let number: i64 = words::parsed(digits).ok_or_else(|| {
        format!("{:?} is no number of a vertex", shortened(word))
    })?;
    let count = vertices.len();
    let index = if number > 0 {
        usize::try_from(number - 1).ok()
    } else {
        usize::try_from(-(number + 1))
            .ok()
            .filter(|_| number < 0)
            .and_then(|back| count.checked_sub(back + 1))
    };
    index.and_then(|i| vertices.get(i)).copied().ok_or_else(|| {
        format!(
            "there is no vertex {number}; {count} are above this line, and the \
             first is 1"
        )
    })
}
