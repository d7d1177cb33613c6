//! What is known of a mesh.

use crate::triangles::Triangles;
use std::fmt;

/// What is known of a mesh, to be told to its user.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices at different places.
    pub vertices: usize,
    /// The unit that the file tells, if it tells one.
    pub unit: Option<&'static str>,
    /// Triangles that were left out, since two of their corners are one.
    pub dropped: usize,
    /// Triangles that were left out, since others have the same corners.
    pub doubled: usize,
    /// Triangles that were turned round.
    pub turned: usize,
    /// Edges at which a triangle has no neighbour. Without any the mesh is the
    /// surface of a body.
    pub open_edges: usize,
    /// Those of them that are about holes so large that nothing tells what is
    /// missing there. Planes through them have no exact sections.
    pub wide_open: usize,
    /// What of the file is no part of the body, and was left out.
    pub left_out: Vec<String>,
}

impl Facts {
    pub(crate) fn of(triangles: &Triangles) -> Facts {
        Facts {
            triangles: triangles.corners.len(),
            vertices: triangles.vertices.len(),
            unit: triangles.unit,
            dropped: triangles.dropped,
            left_out: triangles.left_out.clone(),
            ..Facts::default()
        }
    }

    /// True if the mesh is the surface of a body.
    pub fn is_sound(&self) -> bool {
        self.open_edges == 0
    }
}

impl fmt::Display for Facts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} triangles", self.triangles)?;
        if let Some(unit) = self.unit {
            write!(f, ", in {unit}s")?;
        }
        let counts = [
            (self.dropped, "without an area left out"),
            (self.doubled, "doubled ones left out"),
            (self.turned, "turned round"),
            (
                self.open_edges - self.wide_open,
                "edges of small holes closed",
            ),
            (self.wide_open, "edges of large holes left open"),
        ];
        for (count, what) in counts {
            if count > 0 {
                write!(f, ", {count} {what}")?;
            }
        }
        for what in &self.left_out {
            write!(f, ", without {what}")?;
        }
        Ok(())
    }
}
