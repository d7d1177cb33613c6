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
    /// Triangles that were turned round, so that neighbours agree and bodies
    /// have their outside outside.
    pub turned: usize,
    /// Vertices of rims that were made one with another one, or put on an edge,
    /// since only rounding kept them apart.
    pub joined: usize,
    /// Holes that were closed.
    pub closed: usize,
    /// Edges at which a triangle has no neighbour. Without any the mesh is the
    /// surface of a body, and its plane sections are exact.
    pub open_edges: usize,
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

impl Facts {
    /// What was done to make the mesh the surface of a body, and what could not
    /// be done: "closed 5 holes, turned 12 triangles round". None if it was
    /// sound.
    pub fn repairs(&self) -> Option<String> {
        let done = [
            (self.closed, "closed", "hole", ""),
            (self.turned, "turned", "triangle", " round"),
            (self.joined, "joined", "crack", ""),
            (self.doubled, "left out", "doubled triangle", ""),
            (
                self.open_edges,
                "left",
                "edge",
                " open: it is no closed body",
            ),
        ];
        let words: Vec<String> = done
            .into_iter()
            .filter(|(count, ..)| *count > 0)
            .map(|(count, did, what, how)| {
                let s = if count == 1 { "" } else { "s" };
                format!("{did} {count} {what}{s}{how}")
            })
            .collect();
        (!words.is_empty()).then(|| words.join(", "))
    }
}

impl fmt::Display for Facts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} triangles", self.triangles)?;
        if let Some(unit) = self.unit {
            write!(f, ", in {unit}s")?;
        }
        if self.dropped > 0 {
            write!(f, ", {} without an area left out", self.dropped)?;
        }
        for what in &self.left_out {
            write!(f, ", without {what}")?;
        }
        if let Some(repairs) = self.repairs() {
            write!(f, "; {repairs}")?;
        }
        Ok(())
    }
}
