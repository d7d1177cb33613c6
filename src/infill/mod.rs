//! Sparse infill: a pattern's lines inside the covered areas.
//!
//! One pattern per file, each a [`Pattern`]. A pattern's place depends on
//! the settings, the layer's height and where the part stands only, so that
//! layers stand on each other and islands continue each other.
//!
//! ```text
//!   pattern ──► pieces inside the area ──join──► long paths ──► beads
//! ```
//!
//! **Density** is the pattern's: the volume of its beads over the volume they
//! are in. The joins along the area's border come on top of it; they belong
//! to the wall they follow, and are as long as half of it.

mod concentric;
mod cubic;
mod diamond;
mod families;
mod grading;
mod grid;
mod gyroid;
mod hexagons;
mod join;
mod level;
mod lidinoid;
mod neovius;
mod rectilinear;
mod schwarz_p;
mod sheet;
mod triangles;

use crate::bead::{Bead, Role, spacing};
use crate::plane::border::{Border, Piece};
use crate::plane::offset::offset;
use crate::plane::{Area, Rect};
use crate::settings::{InfillCentre, InfillPattern, Settings};
use crate::units::{Degrees, Mm};
use glam::DVec2;
use grading::Grading;
use sheet::Sheet;

/// Which layer is to be filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Its number, from 0.
    pub number: usize,
    /// Height of its sample plane above the bed.
    pub z: Mm,
    /// Its own height.
    pub height: Mm,
}

/// How dense a layer's pattern is.
#[derive(Clone, Copy, Debug)]
enum Density<'a> {
    /// The same share of the plane everywhere, 0 to 1.
    Even(f64),
    /// A share that varies.
    Graded(&'a Grading),
}

/// What a pattern needs to know.
#[derive(Clone, Copy, Debug)]
struct Layer<'a> {
    /// Border of the area that the lines end at.
    border: &'a Border<'a>,
    /// How far that is inside the area to be filled.
    margin: Mm,
    /// Number of the layer.
    number: usize,
    /// Height of its sample plane above the bed.
    z: Mm,
    density: Density<'a>,
    /// Distance of parallel lines that would fill the plane.
    solid: Mm,
    /// The point that the pattern is laid out from.
    origin: DVec2,
    /// Direction of the pattern.
    angle: Degrees,
    /// Share of a period by which the pattern is moved, 0 to 1.
    phase: f64,
    /// Pieces shorter than this are not worth a travel.
    shortest: Mm,
}

/// A pattern's own coordinates.
#[derive(Clone, Copy, Debug)]
struct Frame {
    origin: DVec2,
    along: DVec2,
}

impl Frame {
    /// A point of the pattern in the plane.
    fn out(&self, p: DVec2) -> DVec2 {
        self.origin + self.along.rotate(p)
    }

    /// A way in the pattern as one in the plane.
    fn along(&self, way: DVec2) -> DVec2 {
        self.along.rotate(way)
    }

    /// The box in the pattern around one in the plane.
    fn bounds(&self, rect: Rect) -> Rect {
        let (a, b) = (rect.min, rect.max);
        let corners = [a, DVec2::new(b.x, a.y), b, DVec2::new(a.x, b.y)];
        let back = DVec2::new(self.along.x, -self.along.y);
        let inside = corners.map(|p| back.rotate(p - self.origin));
        Rect::around(&inside)
    }
}

impl Layer<'_> {
    fn frame(&self) -> Frame {
        Frame {
            origin: self.origin,
            along: DVec2::from_angle(self.angle.to_radians()),
        }
    }
}

/// A way to fill an area with lines.
trait Pattern: Send + Sync {
    /// The pattern's centre lines inside the area.
    fn pieces(&self, layer: &Layer<'_>) -> Vec<Piece>;

    /// The longest way along the border over which two pieces are joined.
    fn reach(&self, layer: &Layer<'_>) -> Mm {
        let share = match layer.density {
            Density::Even(share) => share,
            Density::Graded(grading) => grading.mean().max(0.01),
        };
        4.0 * layer.solid / share
    }
}

/// A part's sparse infill.
pub struct Infill {
    pattern: Box<dyn Pattern>,
    origin: DVec2,
}

impl Infill {
    /// The infill that the settings ask for, of a part whose middle, and that
    /// of the bed, are at these places in the layers' coordinates.
    pub fn new(settings: &Settings, part: DVec2, bed: DVec2) -> Infill {
        let graded = false;
        let pattern: Box<dyn Pattern> = match settings.infill_pattern {
            InfillPattern::Rectilinear => Box::new(rectilinear::Rectilinear),
            InfillPattern::Grid => Box::new(grid::Grid),
            InfillPattern::Triangles => Box::new(triangles::Triangles),
            InfillPattern::Hexagons => Box::new(hexagons::Hexagons),
            InfillPattern::Cubic => Box::new(cubic::Cubic),
            InfillPattern::Concentric => Box::new(concentric::Concentric),
            InfillPattern::Gyroid => {
                Box::new(Sheet::new(gyroid::Gyroid, graded))
            }
            InfillPattern::SchwarzP => {
                Box::new(Sheet::new(schwarz_p::SchwarzP, graded))
            }
            InfillPattern::Diamond => {
                Box::new(Sheet::new(diamond::Diamond, graded))
            }
            InfillPattern::Neovius => {
                Box::new(Sheet::new(neovius::Neovius, graded))
            }
            InfillPattern::Lidinoid => {
                Box::new(Sheet::new(lidinoid::Lidinoid, graded))
            }
        };
        Infill {
            pattern,
            origin: match settings.infill_centre {
                InfillCentre::Object => part,
                InfillCentre::Bed => bed,
            },
        }
    }

    /// Beads of a layer's sparse infill.
    ///
    /// Lines reach into the walls around the area by `infill_overlap` of their
    /// width: their round ends overlap the wall's bead by that much.
    pub fn beads(
        &self,
        sparse: &Area,
        place: Place,
        settings: &Settings,
    ) -> Vec<Bead> {
        let width = settings.infill_width;
        let share = settings.infill_density / 100.0;
        if sparse.is_empty() || share <= 0.0 {
            return Vec::new();
        }
        let margin = width * (0.5 - settings.infill_overlap / 100.0);
        let ends = offset(sparse, -margin, 0.02);
        let border = Border::new(&ends);
        let layer = Layer {
            border: &border,
            margin,
            number: place.number,
            z: place.z,
            density: Density::Even(share),
            solid: spacing(width, width, place.height),
            origin: self.origin,
            angle: settings.infill_angle,
            phase: settings.infill_phase / 100.0,
            shortest: width,
        };
        let mut pieces = self.pattern.pieces(&layer);
        pieces.retain(|p| p.points.len() > 1);
        let reach = self.pattern.reach(&layer);
        join::join(pieces, &border, reach)
            .into_iter()
            .map(|p| Bead {
                role: Role::SparseInfill,
                points: p.points,
                closed: p.closed,
                width,
                widths: Vec::new(),
                height: place.height,
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
