//! Directions from which parts are seen.
//!
//! ```text
//!            u                 the viewer looks along −w, from infinitely
//!            │   w (viewer)    far away: no perspective, so that lengths
//!            │  ╱              compare
//!            │ ╱  elevation
//!   ─────────┼────────── r     azimuth: where the viewer stands, seen from
//!           ╱│                 above, counter-clockwise from the x axis
//! ```

use glam::{DMat3, DVec3};
use isoslice_base::units::{Degrees, sin_cos};

/// The direction from which a part is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the viewer stands, seen from above: counter-clockwise from the x
    /// axis.
    pub azimuth: Degrees,
    /// Angle of the viewer above the horizon.
    pub elevation: Degrees,
}

impl View {
    /// The view from the front, the right and above, at equal angles to all
    /// axes.
    pub const ISO: View = View {
        azimuth: -45.0,
        // The angle between a cube's diagonal and its faces.
        elevation: 35.264_389_682_754_654,
    };
    /// The view that most hosts have: more of the front, less of the top.
    pub const THUMBNAIL: View = View {
        azimuth: -60.0,
        elevation: 30.0,
    };

    /// Views that have names.
    pub const NAMED: [(&'static str, View); 7] = [
        ("iso", View::ISO),
        ("front", View::of(-90.0, 0.0)),
        ("back", View::of(90.0, 0.0)),
        ("left", View::of(180.0, 0.0)),
        ("right", View::of(0.0, 0.0)),
        ("top", View::of(-90.0, 90.0)),
        ("bottom", View::of(-90.0, -90.0)),
    ];

    pub(super) const fn of(azimuth: Degrees, elevation: Degrees) -> View {
        View { azimuth, elevation }
    }

    /// The directions right, up and towards the viewer, as columns.
    pub(super) fn axes(self) -> DMat3 {
        let (sa, ca) = sin_cos(self.azimuth);
        let (se, ce) = sin_cos(self.elevation);
        let right = DVec3::new(-sa, ca, 0.0);
        let towards = DVec3::new(ce * ca, ce * sa, se);
        DMat3::from_cols(right, towards.cross(right), towards)
    }
}
