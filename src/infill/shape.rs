//! Infill that is an expression of one's own.
//!
//! ```text
//!   surface: beads on f = 0       solid: f < 0 printed like a part
//!     ╭──╮  ╭──╮  ╭──╮              ╔══╗  ╔══╗  ╔══╗
//!     │  ╰──╯  ╰──╯  │              ║░░╚══╝░░╚══╝░░║
//! ```
//!
//! f is sampled in every layer on a lattice of half a line's width, whose
//! nodes keep their places from layer to layer; where it is not a number is
//! outside. What is thinner than that may be missed.

use super::Layer;
use super::level::{Curve, Lattice, thin, trace};
use crate::model::{Expression, Place};
use crate::plane::border::{Cutter, Piece};
use crate::plane::clip::intersection;
use crate::plane::grid::EdgeGrid;
use crate::plane::hatch::{Lines, hatch};
use crate::plane::{Area, Rect};
use crate::region::line::Line;
use crate::region::{Lay, lay, shrink};
use crate::settings::Settings;
use crate::units::Mm;
use crate::vary::{Surroundings, VaryError};
use glam::DVec2;

/// An expression, and what it needs to be evaluated.
pub(super) struct Shape {
    pub expression: Expression,
}

/// Distance of the lattice's nodes, as a share of the line's width.
const STEP: f64 = 0.5;
/// Nodes of a lattice at most; beyond that they are farther apart.
const MOST: f64 = 4e6;
/// Chords may be off the line by this, as a share of its width.
const CHORD: f64 = 0.1;
/// Tolerance of the offsets of a solid, mm.
const TOLERANCE: Mm = 0.01;

/// What surrounds a layer's area.
#[derive(Clone, Copy)]
pub(super) struct Around<'a> {
    pub surroundings: &'a Surroundings<'a>,
    /// The layer's solid, if it is there to be asked.
    pub solid: Option<&'a EdgeGrid>,
}

impl Shape {
    /// What the area has of the zero set.
    pub(super) fn lines(
        &self,
        layer: &Layer<'_>,
        around: Around<'_>,
        width: Mm,
    ) -> Result<Vec<Piece>, VaryError> {
        let mut cutter = Cutter::new(layer.border);
        let tolerance = CHORD * width;
        for island in layer.border.area().islands() {
            let bounds = island.bounds();
            let curves = self.curves(bounds, layer.z, around, width, false)?;
            for curve in curves {
                let mut points = curve.points;
                if curve.closed {
                    points.extend(points.first().copied());
                }
                let mut points = thin(&points, tolerance);
                if curve.closed {
                    points.pop();
                }
                cutter.line(&points, curve.closed);
            }
        }
        let mut pieces = cutter.finish();
        pieces.retain(|p| {
            crate::plane::path_length(&p.points, p.closed) >= layer.shortest
        });
        Ok(pieces)
    }

    /// Centre lines of the solid in `area`: walls, and lines inside them.
    pub(super) fn solid(
        &self,
        area: &Area,
        layer: &Layer<'_>,
        around: Around<'_>,
        height: Mm,
        settings: &Settings,
    ) -> Result<Vec<Line>, VaryError> {
        let width = settings.infill_width;
        let mut rings = Vec::new();
        for island in area.islands() {
            let bounds = island.bounds();
            let curves = self.curves(bounds, layer.z, around, width, true)?;
            let own = curves.into_iter().filter(|c| c.closed).map(|c| {
                let mut points = c.points;
                points.extend(points.first().copied());
                let mut points = thin(&points, TOLERANCE);
                points.pop();
                points
            });
            let own = Area {
                rings: own.filter(|r| r.len() > 2).collect(),
            };
            rings.extend(intersection(&own, &island).rings);
        }
        let mut inside = Area { rings };
        let mut lines = Vec::new();
        let plan = Lay::inside(width, height, settings);
        let mut ends = layer.margin;
        for _ in 0..settings.infill_walls {
            if inside.is_empty() {
                break;
            }
            let laid = lay(&inside, plan, TOLERANCE);
            lines.extend(laid.lines);
            lines.extend(laid.thin);
            ends = 0.5 * settings.printer.nozzle_diameter - plan.centre;
            inside = shrink(&laid.rings, plan.centre, TOLERANCE);
        }
        let inside = shrink(&inside, ends, TOLERANCE);
        let rows = Lines {
            angle: layer.angle + 90.0 * (layer.number % 2) as f64,
            spacing: layer.solid,
            phase: 0.0,
        };
        let fill = hatch(&inside, rows, 0.5 * width);
        lines.extend(fill.into_iter().map(|s| Line {
            points: vec![s.from, s.to],
            closed: false,
            width,
            widths: Vec::new(),
        }));
        Ok(lines)
    }

    /// The zero lines in a box; `whole` closes them along its sides.
    fn curves(
        &self,
        bounds: Rect,
        z: Mm,
        around: Around<'_>,
        width: Mm,
        whole: bool,
    ) -> Result<Vec<Curve>, VaryError> {
        let extent = bounds.max - bounds.min;
        let step = (STEP * width).max((extent.x * extent.y / MOST).sqrt());
        // Whole steps from the origin: the same nodes in every layer.
        let origin = ((bounds.min / step).floor() - 1.0) * step;
        let size = (bounds.max - origin) / step;
        let lattice = Lattice {
            origin,
            step,
            size: [size.x as usize + 3, size.y as usize + 3],
            periodic: false,
        };
        let measure = self.expression.uses_depth();
        let mut places: Vec<Place> = Vec::new();
        let mut failed = None;
        let mut eval = |points: &mut dyn Iterator<Item = DVec2>,
                        out: &mut Vec<f64>| {
            places.clear();
            let Around {
                surroundings,
                solid,
            } = around;
            let made =
                surroundings.places(points, z, measure, solid, &mut places);
            match made {
                Ok(()) => self.expression.evaluate(&places, out),
                Err(e) => failed = Some(e),
            }
        };
        let mut values = Vec::with_capacity(lattice.count());
        let [nx, ny] = lattice.size;
        for j in 0..ny {
            let mut row = (0..nx).map(|i| lattice.node(i, j));
            eval(&mut row, &mut values);
        }
        values.resize(lattice.count(), f64::NAN);
        if whole {
            for k in 0..nx * ny {
                let (i, j) = (k % nx, k / nx);
                if i == 0 || j == 0 || i + 1 == nx || j + 1 == ny {
                    values[k] = f64::INFINITY;
                }
            }
        }
        let curves = trace(&lattice, &values, 4, &mut |points, out| {
            eval(&mut points.iter().copied(), out);
            out.resize(points.len(), f64::NAN);
        });
        match failed {
            Some(e) => Err(e),
            None => Ok(curves),
        }
    }
}
