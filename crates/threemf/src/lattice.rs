//! Beam lattices, as they are read.
//!
//! ```text
//!  <beamlattice radius="1" minlength="0.0001" cap="sphere">
//!    <beams> <beam v1="0" v2="1" r1="1.5" r2="1.6" cap2="butt"/> …
//!    <balls> <ball vindex="0" r="2"/> …
//!    <beamsets> …                                   names only: not read
//! ```
//!
//! The mesh that represents a lattice for display is not read.

use crate::space::Space;
use crate::xml::Element;
use glam::{DAffine3, DMat3, DVec3};
use isoslice_mesh::{Cap, MOST_STRUTS, MeshError, Strut};

/// Which vertices have balls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Balls {
    None,
    /// Those that are listed.
    Listed,
    /// All at which a beam ends.
    All,
}

/// What of a lattice is left of its clipping mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Inside,
    Outside,
}

#[derive(Clone, Copy, Debug)]
struct Beam {
    ends: [u32; 2],
    radii: [f64; 2],
    caps: [Cap; 2],
}

/// A beam lattice.
#[derive(Debug)]
pub(crate) struct Lattice {
    min_length: f64,
    radius: f64,
    cap: Cap,
    balls_at: Balls,
    ball_radius: Option<f64>,
    /// The object that clips it, and the side that stays.
    pub clipped: Option<(u32, Side)>,
    beams: Vec<Beam>,
    balls: Vec<(u32, Option<f64>)>,
}

/// Struts of a lattice, and what they are not.
pub(crate) struct Placed {
    pub struts: Vec<Strut>,
    /// Number of beams that are shorter than the lattice allows.
    pub short: usize,
    /// Number of beams and balls of no thickness.
    pub thin: usize,
}

impl Lattice {
    /// Number of its beams.
    pub(crate) fn len(&self) -> usize {
        self.beams.len()
    }

    /// A lattice without beams, of its element.
    pub(crate) fn new(element: &Element) -> Result<Lattice, MeshError> {
        let cap = cap(element, "cap")?.unwrap_or(Cap::Sphere);
        let modes = [
            ("none", Balls::None),
            ("mixed", Balls::Listed),
            ("all", Balls::All),
        ];
        let balls_at = match element.text_of_any("ballmode")? {
            None => Balls::None,
            Some(mode) => element.one_of(&mode, "mode of balls", &modes)?,
        };
        let ball_radius = match element.text_of_any("ballradius")? {
            None => None,
            Some(text) => Some(positive(element, "ballradius", &text)?),
        };
        if balls_at == Balls::All && ball_radius.is_none() {
            return Err(
                element.wrong("balls at all vertices, without a radius")
            );
        }
        Ok(Lattice {
            min_length: length(element, "minlength")?.unwrap_or(0.0),
            radius: length(element, "radius")?
                .ok_or_else(|| element.absent("radius"))?,
            cap,
            balls_at,
            ball_radius,
            clipped: clipped(element)?,
            beams: Vec::new(),
            balls: Vec::new(),
        })
    }

    /// Reads an element of the lattice, of which there are `vertices` so far.
    pub(crate) fn see(
        &mut self,
        element: &Element,
        vertices: usize,
    ) -> Result<(), MeshError> {
        match (element.space(), element.name()) {
            (Space::Beams, "beam") => self.beam(element, vertices),
            (Space::Beams | Space::Balls, "ball") => {
                let vertex = vertex(element, "vindex", vertices)?;
                self.balls.push((vertex, length(element, "r")?));
                within(self.balls.len())
            }
            _ => Ok(()),
        }
    }

    fn beam(
        &mut self,
        element: &Element,
        vertices: usize,
    ) -> Result<(), MeshError> {
        let ends = [
            vertex(element, "v1", vertices)?,
            vertex(element, "v2", vertices)?,
        ];
        if ends[0] == ends[1] {
            return Err(element
                .wrong(format!("a beam from vertex {} to itself", ends[0])));
        }
        let (first, second) = (length(element, "r1")?, length(element, "r2")?);
        let radii = match (first, second) {
            (Some(a), b) => [a, b.unwrap_or(a)],
            (None, None) => [self.radius; 2],
            (None, Some(_)) => {
                return Err(element.wrong("a radius r2 without r1"));
            }
        };
        let caps = [
            cap(element, "cap1")?.unwrap_or(self.cap),
            cap(element, "cap2")?.unwrap_or(self.cap),
        ];
        self.beams.push(Beam { ends, radii, caps });
        within(self.beams.len())
    }

    /// The struts and balls where `by` puts them. It scales all lengths by
    /// `scale`.
    pub(crate) fn placed(
        &self,
        vertices: &[DVec3],
        by: &DAffine3,
        scale: f64,
    ) -> Result<Placed, MeshError> {
        let at = |v: u32| vertices.get(v as usize).copied().unwrap_or_default();
        let seen = |v: u32| by.transform_point3(at(v));
        let mut struts = Vec::new();
        let (mut short, mut thin) = (0, 0);
        for beam in &self.beams {
            let [a, b] = beam.ends;
            let length = at(a).distance(at(b));
            if length < self.min_length || length == 0.0 {
                short += 1;
                continue;
            }
            if beam.radii == [0.0; 2] {
                thin += 1;
                continue;
            }
            struts.push(Strut {
                ends: [seen(a), seen(b)],
                radii: beam.radii.map(|r| r * scale),
                caps: beam.caps,
            });
        }
        for (vertex, radius) in self.balls(vertices.len())? {
            if radius == 0.0 {
                thin += 1;
                continue;
            }
            struts.push(Strut::ball(seen(vertex), radius * scale));
        }
        Ok(Placed {
            struts,
            short,
            thin,
        })
    }

    /// The balls: their vertices and radii.
    fn balls(&self, vertices: usize) -> Result<Vec<(u32, f64)>, MeshError> {
        if self.balls_at == Balls::None {
            return Ok(Vec::new());
        }
        let mut is_end = vec![false; vertices];
        for v in self.beams.iter().flat_map(|beam| beam.ends) {
            is_end[v as usize] = true;
        }
        let wrong = |i: usize, what: &str| {
            Err(MeshError::at(format_args!("ball {i}"), what))
        };
        let mut balls = Vec::new();
        let mut is_listed = vec![false; vertices];
        for (i, (vertex, radius)) in self.balls.iter().enumerate() {
            let Some(radius) = radius.or(self.ball_radius) else {
                return wrong(i, "neither it nor its lattice has a radius");
            };
            if !is_end[*vertex as usize] {
                return wrong(i, "no beam ends at its vertex");
            }
            is_listed[*vertex as usize] = true;
            balls.push((*vertex, radius));
        }
        if let (Balls::All, Some(radius)) = (self.balls_at, self.ball_radius) {
            let rest = (0..vertices).filter(|&v| is_end[v] && !is_listed[v]);
            balls.extend(rest.map(|v| (v as u32, radius)));
        }
        Ok(balls)
    }
}

fn within(count: usize) -> Result<(), MeshError> {
    if count > MOST_STRUTS {
        Err(MeshError::TooManyStruts)
    } else {
        Ok(())
    }
}

/// By how much a matrix scales all lengths. None if it does not scale all by the
/// same.
pub(crate) fn scale(matrix: &DMat3) -> Option<f64> {
    let square = matrix.transpose() * *matrix;
    let mean = (square.x_axis.x + square.y_axis.y + square.z_axis.z) / 3.0;
    let off = square - DMat3::from_diagonal(DVec3::splat(mean));
    let most = off
        .to_cols_array()
        .into_iter()
        .fold(0.0, |a: f64, x| a.max(x.abs()));
    // Files have matrices of six digits or more. A strut of 100 mm is off by
    // half a micrometre with that.
    (mean > 0.0 && most <= 1e-5 * mean).then(|| mean.sqrt())
}

fn clipped(element: &Element) -> Result<Option<(u32, Side)>, MeshError> {
    let modes = [
        ("none", None),
        ("inside", Some(Side::Inside)),
        ("outside", Some(Side::Outside)),
    ];
    let side = element.word("clippingmode", "mode of clipping", &modes)?;
    match side.flatten() {
        None => Ok(None),
        Some(side) => Ok(Some((element.number("clippingmesh")?, side))),
    }
}

fn cap(element: &Element, name: &str) -> Result<Option<Cap>, MeshError> {
    let caps = [
        ("sphere", Cap::Sphere),
        ("hemisphere", Cap::Hemisphere),
        ("butt", Cap::Butt),
    ];
    element.word(name, "end of beams", &caps)
}

/// An attribute that is a length, if it is there.
fn length(element: &Element, name: &str) -> Result<Option<f64>, MeshError> {
    match element.text(name)? {
        None => Ok(None),
        Some(text) => positive(element, name, &text).map(Some),
    }
}

fn positive(
    element: &Element,
    name: &str,
    text: &str,
) -> Result<f64, MeshError> {
    let number = text.trim().parse().ok();
    let sound = number.filter(|x: &f64| x.is_finite() && *x >= 0.0);
    sound.ok_or_else(|| {
        element.wrong(format!(
            "the attribute {name} is {text:?}, which is no length"
        ))
    })
}

/// An attribute that is the number of a vertex.
fn vertex(
    element: &Element,
    name: &str,
    vertices: usize,
) -> Result<u32, MeshError> {
    let vertex: u32 = element.number(name)?;
    if (vertex as usize) < vertices {
        return Ok(vertex);
    }
    Err(element.wrong(format!(
        "it names vertex {vertex}; there are {vertices}, and the first is 0"
    )))
}
