//! Makes triangles the surface of a body, where that needs no guess.
//!
//! In: triangles as a file gives them. Out: triangles whose edges each lead as
//! often one way as the other, so that winding numbers are whole and plane
//! sections are closed. One step after another:
//!
//! ```text
//!  doubles   triangles with the same corners are one
//!  seams     rims that lie on one another are joined
//!  turning   neighbours go round the same way
//!  holes     what is missing is closed along its rim
//!  outside   bodies that are inside out are turned
//! ```
//!
//! A mesh without faults is only looked at. What stays open is left to winding
//! numbers (see `sign.rs`), and told.

mod doubles;
mod holes;
mod outside;
mod seams;
#[cfg(test)]
mod tests;
mod turning;

use crate::edges::each_edge;
use crate::error::MeshError;
use crate::facts::Facts;
use crate::limits::MOST_TRIANGLES;
use crate::triangles::Triangles;
use glam::DVec3;
use isoslice_base::limits::go_on;
use isoslice_base::sets::Sets;

/// Most triangles with those that are added. The tree numbers 2²⁷.
const MOST: usize = 2 * MOST_TRIANGLES;

/// Triangles that are being repaired.
struct Work {
    vertices: Vec<DVec3>,
    corners: Vec<[u32; 3]>,
    /// The triangles that were turned round.
    is_turned: Vec<bool>,
    /// This many triangles are the file's, the others are added.
    given: usize,
}

impl Work {
    fn new(vertices: Vec<DVec3>, corners: Vec<[u32; 3]>) -> Work {
        Work {
            vertices,
            is_turned: vec![false; corners.len()],
            given: corners.len(),
            corners,
        }
    }

    fn turn(&mut self, triangle: usize) {
        self.corners[triangle].swap(1, 2);
        self.is_turned[triangle] ^= true;
    }

    fn add(&mut self, corners: [u32; 3]) {
        self.corners.push(corners);
        self.is_turned.push(false);
    }

    /// Leaves triangles out, none of which is turned.
    fn leave_out(&mut self, is_out: impl Fn(&[u32; 3]) -> bool) {
        let given = &self.corners[..self.given];
        self.given -= given.iter().filter(|t| is_out(t)).count();
        self.corners.retain(|t| !is_out(t));
        self.is_turned.truncate(self.corners.len());
    }

    /// True if so many more triangles can be added.
    fn has_room(&self, count: usize) -> bool {
        self.corners.len() + count <= MOST
    }

    fn triangle(&self, i: usize) -> [DVec3; 3] {
        self.corners[i].map(|v| self.vertices[v as usize])
    }

    fn area(&self, i: usize) -> f64 {
        area(self.triangle(i))
    }

    fn turned(&self) -> usize {
        self.is_turned[..self.given].iter().filter(|t| **t).count()
    }
}

fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// Repairs triangles, and tells in `facts` what was done.
pub(crate) fn repair(
    mut triangles: Triangles,
    facts: &mut Facts,
) -> Result<Triangles, MeshError> {
    if is_sound(&triangles.vertices, &triangles.corners) {
        return Ok(triangles);
    }
    go_on()?;
    let mut corners = std::mem::take(&mut triangles.corners);
    let vertices = std::mem::take(&mut triangles.vertices);
    facts.doubled = doubles::leave_out(&mut corners, vertices.len());
    go_on()?;
    let mut work = Work::new(vertices, corners);
    facts.joined = seams::join(&mut work);
    go_on()?;
    turning::agree(&mut work);
    go_on()?;
    let holes = holes::close(&mut work)?;
    (facts.closed, facts.open_edges) = (holes.closed, holes.open_edges);
    outside::turn(&mut work)?;
    facts.turned = work.turned();
    triangles.vertices = work.vertices;
    triangles.corners = work.corners;
    Ok(triangles)
}

/// True if each edge has two triangles that agree, and no body is inside out.
/// Triangles for which this is true stay as they are.
fn is_sound(vertices: &[DVec3], corners: &[[u32; 3]]) -> bool {
    let mut bodies = Sets::new(corners.len());
    let mut is_sound = true;
    each_edge(corners, vertices.len(), |edge| {
        let mut sides = edge.sides();
        match (edge.count(), sides.next(), sides.next()) {
            (2, Some(a), Some(b)) if a.is_down != b.is_down => {
                bodies.join(a.triangle as usize, b.triangle as usize);
            }
            _ => is_sound = false,
        }
    });
    if !is_sound {
        return false;
    }
    let mut volumes = vec![0.0; corners.len()];
    for (i, corners) in corners.iter().enumerate() {
        let [a, b, c] = corners.map(|v| vertices[v as usize] - vertices[0]);
        volumes[bodies.of(i)] += a.dot(b.cross(c));
    }
    volumes.iter().all(|volume| *volume >= 0.0)
}
