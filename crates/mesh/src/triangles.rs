//! Triangles with shared vertices, as files give them.

use crate::error::MeshError;
use crate::limits::{FARTHEST, MOST_TRIANGLES};
use crate::merge::Merger;
use glam::{DAffine3, DVec3};
use isocontour::Bounds;

/// Triangles, their vertices merged: vertices at the same place are one.
#[derive(Clone, Debug, Default)]
pub struct Triangles {
    /// The vertices, mm.
    pub vertices: Vec<DVec3>,
    /// The corners of each triangle, counter-clockwise as seen from outside.
    pub corners: Vec<[u32; 3]>,
    /// Triangles that were left out, since two of their corners are one.
    pub dropped: usize,
    /// The unit that the file tells, if it tells one. The vertices are in mm.
    pub unit: Option<&'static str>,
    /// What of the file is no part of the body, and was left out.
    pub left_out: Vec<String>,
}

impl Triangles {
    /// The box around all vertices.
    pub fn bounds(&self) -> Bounds {
        Bounds::around(self.vertices.iter().copied())
    }

    /// Moves, turns or scales all. A mirror image keeps its outside outside.
    pub fn transform(&mut self, by: &DAffine3) {
        for v in &mut self.vertices {
            *v = by.transform_point3(*v);
        }
        if by.matrix3.determinant() < 0.0 {
            for corners in &mut self.corners {
                corners.swap(1, 2);
            }
        }
    }
}

/// Collects triangles.
#[derive(Debug, Default)]
pub struct Collector {
    merger: Merger,
    corners: Vec<[u32; 3]>,
    dropped: usize,
}

impl Collector {
    /// The number of a vertex. `place` says where in the file it is.
    ///
    /// # Errors
    /// If it is too far away, or not finite.
    pub fn vertex(
        &mut self,
        p: DVec3,
        place: impl FnOnce() -> String,
    ) -> Result<u32, MeshError> {
        if p.abs().max_element() <= FARTHEST && p.is_finite() {
            return Ok(self.merger.vertex(p));
        }
        let what = if p.is_finite() {
            "this coordinate is farther than 100 km from the origin; is the \
             file damaged?"
        } else {
            "this coordinate is not a finite number; export the file again"
        };
        Err(MeshError::at(place(), what))
    }

    /// Adds a triangle of vertices.
    ///
    /// # Errors
    /// If there are too many.
    pub fn triangle(&mut self, corners: [u32; 3]) -> Result<(), MeshError> {
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            self.dropped += 1;
            return Ok(());
        }
        if self.corners.len() >= MOST_TRIANGLES {
            return Err(MeshError::TooMany);
        }
        if self.corners.len().is_multiple_of(65_536) {
            isoslice_base::limits::go_on()?;
        }
        self.corners.push(corners);
        Ok(())
    }

    /// The vertices so far.
    pub(crate) fn vertices(&self) -> &[DVec3] {
        &self.merger.vertices
    }

    /// The triangles.
    ///
    /// # Errors
    /// If there are none.
    pub fn finish(self) -> Result<Triangles, MeshError> {
        if self.corners.is_empty() {
            return Err(MeshError::Empty);
        }
        Ok(Triangles {
            vertices: self.merger.vertices,
            corners: self.corners,
            dropped: self.dropped,
            unit: None,
            left_out: Vec::new(),
        })
    }
}
