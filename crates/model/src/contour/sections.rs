//! Exact sections of solids made of data, such as meshes, and of half-spaces.
//!
//! In: what is inside an expression, a height. Out: the area inside there,
//! without a sample.

use glam::{DAffine3, DVec2, DVec3};
use isocontour::{Data, Solid};
use isoslice_base::units::Mm;
use isoslice_planar::clip::{difference, intersection, unite};
use isoslice_planar::{Area, Rect, Ring, clip};

/// The sections of a solid within a frame.
pub(super) struct Sections {
    solid: Solid,
    frame: Rect,
}

/// How far the frame of complements and half-planes reaches beyond the part,
/// mm.
const MARGIN: Mm = 1.0;

impl Sections {
    /// The sections of a solid, all of which lie within a box.
    pub(super) fn new(solid: Solid, within: Rect) -> Sections {
        Sections {
            solid,
            frame: within.grown(MARGIN),
        }
    }

    /// What is inside at a height; none if some of the data has no section
    /// there.
    pub(super) fn at(&self, z: Mm) -> Option<Area> {
        self.of(&self.solid, z)
    }

    fn of(&self, solid: &Solid, z: Mm) -> Option<Area> {
        Some(match solid {
            Solid::Data { data, place } => section(&**data, place, z)?,
            Solid::HalfSpace { normal, level } => {
                self.half_plane(*normal, level - normal.z * z)
            }
            Solid::Constant(true) => self.whole(),
            Solid::Constant(false) => Area::EMPTY,
            Solid::Union(both) => {
                let [a, b] = &**both;
                clip::union(&self.of(a, z)?, &self.of(b, z)?)
            }
            Solid::Common(both) => {
                let [a, b] = &**both;
                intersection(&self.of(a, z)?, &self.of(b, z)?)
            }
            Solid::Outside(of) => difference(&self.whole(), &self.of(of, z)?),
        })
    }

    fn whole(&self) -> Area {
        Area {
            rings: vec![self.frame.corners().to_vec()],
        }
    }

    /// Where normal · p is below a level, within the frame. A level face counts
    /// as inside: just above or just below it, it is.
    fn half_plane(&self, normal: DVec3, level: Mm) -> Area {
        let normal = normal.truncate();
        if normal == DVec2::ZERO {
            return if level >= 0.0 {
                self.whole()
            } else {
                Area::EMPTY
            };
        }
        let corners = self.frame.corners();
        let mut ring = Ring::new();
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let [u, v] = [a, b].map(|p| normal.dot(p) - level);
            if u <= 0.0 {
                ring.push(a);
            }
            if (u < 0.0 && v > 0.0) || (u > 0.0 && v < 0.0) {
                ring.push(a.lerp(b, u / (u - v)));
            }
        }
        let rings = if ring.len() > 2 {
            vec![ring]
        } else {
            Vec::new()
        };
        Area { rings }
    }
}

/// The area of a section.
fn section(data: &dyn Data, place: &DAffine3, z: Mm) -> Option<Area> {
    let rings = data.section(place, z)?;
    Some(unite(&Area { rings }))
}
