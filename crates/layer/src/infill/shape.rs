//! Infill that is a user's own expression.
//!
//! ```text
//!   surface: beads on f = 0       solid: f < 0 printed like a part
//!     ╭──╮  ╭──╮  ╭──╮              ╔══╗  ╔══╗  ╔══╗
//!     │  ╰──╯  ╰──╯  │              ║░░╚══╝░░╚══╝░░║
//! ```
//!
//! An expression of x, y and z is a field, whose outlines in each layer are
//! found as the part's own outlines are, but less exactly. An expression that
//! asks for d, the distance to the part's surface, is no field. It is sampled
//! near the area that is to be filled, on a lattice of half a line's width
//! whose nodes keep their places from layer to layer. Places where it is not a
//! number are outside. Features thinner than the lattice may be missed.

use super::{InfillError, InfillPlan, Layer, Site};
use crate::walls::{Lay, lay, shrink};
use glam::DVec2;
use isoslice_base::timings::Timings;
use isoslice_base::units::Mm;
use isoslice_model::contour::{Detail, Field, field, outlines};
use isoslice_model::expressions::{QuantityError, Surroundings};
use isoslice_model::{Expression, Place, Source, load};
use isoslice_planar::bead::Stroke;
use isoslice_planar::border::{Cutter, LinePiece};
use isoslice_planar::clip::intersection;
use isoslice_planar::clusters::clusters;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::hatch::{Lines, hatch};
use isoslice_planar::zero::{self, Sampling, zero_lines};
use isoslice_planar::{Area, Rect, path_length};

/// An expression, ready to be evaluated.
pub(super) enum Shape {
    /// An expression of x, y and z.
    Field(Box<Field>),
    /// An expression that also asks for d.
    Deep(Expression),
}

/// Distance of the lattice's nodes, as a share of the line's width.
const NODE_STEP: f64 = 0.5;
/// Greatest error of lines, mm. Nobody sees it.
const CHORD: Mm = 0.05;
/// How far a field's box reaches beyond the part's, mm. The sides that close
/// the field's outlines lie there, outside of every layer.
const MARGIN: Mm = 1.0;
/// Tolerance of the offsets of a solid, mm.
const TOLERANCE: Mm = 0.01;

/// A layer's solid and place, for expressions that ask about them.
#[derive(Clone, Copy)]
pub(super) struct Around<'a> {
    pub surroundings: &'a Surroundings<'a>,
    /// The layer's solid, if it is known.
    pub solid: Option<&'a EdgeGrid>,
}

impl Shape {
    /// The shape of a formula.
    pub(super) fn of_formula(
        text: &str,
        site: &Site,
        width: Mm,
    ) -> Result<Shape, InfillError> {
        let bad = |error| InfillError::Expression {
            text: text.to_owned(),
            error,
        };
        let expression = Expression::parse(text).map_err(bad)?;
        if expression.uses_depth() {
            return Ok(Shape::Deep(expression));
        }
        match Shape::of_source(&formula(text.to_owned()), text, site, width) {
            // The formula names d and yet does not depend on it, as in 0·d.
            Err(InfillError::Shape { .. }) => Ok(Shape::Deep(expression)),
            made => made,
        }
    }

    /// The shape of a script, or of a formula that does not ask for d; `name`
    /// is the text of the setting.
    pub(super) fn of_source(
        source: &Source,
        name: &str,
        site: &Site,
        width: Mm,
    ) -> Result<Shape, InfillError> {
        let load = |source| {
            load(source, &[]).map_err(|e| InfillError::Shape {
                name: name.to_owned(),
                error: Box::new(e),
            })
        };
        let rect = Rect::new(site.part.min - MARGIN, site.part.max + MARGIN);
        // The field is cut by a box, so that its outlines close.
        let (middle, half) = (rect.centre(), 0.5 * rect.size());
        let walls = format!(
            "max(abs(x - ({})) - {}, abs(y - ({})) - {})",
            middle.x, half.x, middle.y, half.y
        );
        let drawn = load(source)?.seen_from(site.origin);
        let tree = drawn.tree.max(load(&formula(walls))?.tree);
        let field = field(&tree, 0.0, rect, width)?;
        Ok(Shape::Field(Box::new(field)))
    }

    /// The parts of the zero set within the area.
    pub(super) fn lines(
        &self,
        layer: &Layer<'_>,
        around: Around<'_>,
        width: Mm,
    ) -> Result<Vec<LinePiece>, InfillError> {
        let mut pieces = Vec::new();
        match self {
            Shape::Field(field) => {
                let mut cutter = Cutter::new(layer.border);
                for ring in negative(field, layer.z, width)?.rings {
                    cutter.line(&ring, true);
                }
                pieces = cutter.finish();
            }
            Shape::Deep(expression) => {
                let mut places = Vec::new();
                for cluster in clusters(layer.border.area()) {
                    let (border, bounds) = (layer.border, cluster.bounds);
                    let lines = zero_lines(
                        border,
                        bounds,
                        sampling(width),
                        false,
                        |points, out| {
                            let z = layer.z;
                            deep(
                                expression,
                                around,
                                points,
                                z,
                                &mut places,
                                out,
                            )
                        },
                    )?;
                    let mut cutter = Cutter::new(border);
                    for (points, closed) in lines {
                        cutter.line(&points, closed);
                    }
                    // A cluster's lattice reaches into the next cluster's box.
                    let own = |p: &LinePiece| {
                        p.points.first().is_some_and(|&p| cluster.has(p))
                    };
                    pieces.extend(cutter.finish().into_iter().filter(own));
                }
            }
        }
        pieces.retain(|p| path_length(&p.points, p.closed) >= layer.shortest);
        Ok(pieces)
    }

    /// The part of `area` where the expression is negative.
    fn inside(
        &self,
        area: &Area,
        z: Mm,
        around: Around<'_>,
        width: Mm,
    ) -> Result<Area, InfillError> {
        let expression = match self {
            Shape::Field(field) => {
                return Ok(intersection(&negative(field, z, width)?, area));
            }
            Shape::Deep(expression) => expression,
        };
        let mut places = Vec::new();
        let found = zero::negative(area, sampling(width), |points, out| {
            deep(expression, around, points, z, &mut places, out)
        });
        Ok(found?)
    }

    /// Centre lines of the solid in `area`: walls, and lines inside them.
    pub(super) fn solid(
        &self,
        area: &Area,
        layer: &Layer<'_>,
        around: Around<'_>,
        height: Mm,
        plan: &InfillPlan,
    ) -> Result<Vec<Stroke>, InfillError> {
        let width = plan.width;
        let mut inside = self.inside(area, layer.z, around, width)?;
        let mut lines = Vec::new();
        let wall = Lay::inside(width, height, plan.thin);
        let mut ends = layer.margin;
        for _ in 0..plan.walls {
            if inside.is_empty() {
                break;
            }
            let laid = lay(&inside, wall, TOLERANCE);
            lines.extend(laid.lines);
            lines.extend(laid.thin);
            ends = plan.off_wall - wall.centre;
            inside = shrink(&laid.rings, wall.centre, TOLERANCE);
        }
        let inside = shrink(&inside, ends, TOLERANCE);
        let rows = Lines {
            angle: layer.angle + 90.0 * (layer.number % 2) as f64,
            spacing: layer.solid,
            phase: 0.0,
        };
        let fill = hatch(&inside, rows, 0.5 * width);
        lines.extend(
            fill.into_iter()
                .map(|s| Stroke::new(vec![s.from, s.to], false, width)),
        );
        Ok(lines)
    }
}

/// A formula as a source.
fn formula(text: String) -> Source {
    Source::formula("infill", text)
}

/// Where a field is negative in the layer at height `z`.
fn negative(field: &Field, z: Mm, width: Mm) -> Result<Area, InfillError> {
    let detail = Detail {
        accuracy: CHORD,
        smallest: NODE_STEP * width,
    };
    // These timings are dropped: the time belongs to the infill, not to the
    // part's outlines.
    let timings = Timings::default();
    let found = outlines(field, &[z], &(0..1), detail, &timings)?;
    Ok(found.into_iter().next().map_or(Area::EMPTY, |o| o.area))
}

/// The lattice on which an expression that asks for d is sampled.
fn sampling(width: Mm) -> Sampling {
    Sampling {
        step: NODE_STEP * width,
        chord: CHORD,
    }
}

/// Appends the values of an expression that asks for d at some points.
fn deep(
    expression: &Expression,
    around: Around<'_>,
    points: &mut dyn Iterator<Item = DVec2>,
    z: Mm,
    places: &mut Vec<Place>,
    out: &mut Vec<f64>,
) -> Result<(), QuantityError> {
    let Around {
        surroundings,
        solid,
    } = around;
    places.clear();
    surroundings.places(points, z, true, solid, places)?;
    expression.evaluate(places, out);
    Ok(())
}
