//! Infill that is an expression of one's own.
//!
//! ```text
//!   surface: beads on f = 0       solid: f < 0 printed like a part
//!     ╭──╮  ╭──╮  ╭──╮              ╔══╗  ╔══╗  ╔══╗
//!     │  ╰──╯  ╰──╯  │              ║░░╚══╝░░╚══╝░░║
//! ```
//!
//! An expression of x, y and z is a field, whose outlines in each layer are
//! found as the part's own are, if less exactly. An expression that asks for d,
//! the distance to the part's surface, is no field: it is sampled near the area
//! that is to be filled, on a lattice of half a line's width whose nodes keep
//! their places from layer to layer. Places where it is not a number are
//! outside. Features thinner than the lattice may be missed.

use super::clusters::clusters;
use super::{InfillError, Layer, Site};
use crate::bead::Stroke;
use crate::contour::{Detail, Field, field, outlines};
use crate::model::{Expression, Place, Source, SourceKind, load};
use crate::plane::border::{Border, Cutter, Piece};
use crate::plane::clip::intersection;
use crate::plane::grid::EdgeGrid;
use crate::plane::hatch::{Lines, hatch};
use crate::plane::{Area, Rect, Ring, path_length};
use crate::region::{Lay, lay, shrink};
use crate::settings::Settings;
use crate::timings::Timings;
use crate::units::Mm;
use crate::vary::{Surroundings, VaryError};
use glam::DVec2;
use isocontour::level::{Lattice, thin, trace};

/// An expression, ready to be evaluated.
pub(super) enum Shape {
    /// An expression of x, y and z.
    Field(Box<Field>),
    /// An expression that also asks for d.
    Deep(Expression),
}

/// Distance of the lattice's nodes, as a share of the line's width.
const STEP: f64 = 0.5;
/// Nodes of a lattice at most; beyond that they are farther apart.
const MOST: f64 = 4e6;
/// Cells along the side of a block; a block is sampled whole, or not at all.
const BLOCK: usize = 8;
/// Nodes evaluated at once: their places take little memory, and the time
/// between the calls does not matter.
const AT_ONCE: usize = 1 << 14;
/// Lines may be off by this, mm; nobody sees them.
const CHORD: Mm = 0.05;
/// A field's box is larger than the part's by this, mm: the sides that close
/// its outlines there are outside of every layer.
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
        let rect = Rect {
            min: site.part.min - MARGIN,
            max: site.part.max + MARGIN,
        };
        // The field is cut by a box, so that its outlines close.
        let (middle, half) =
            (rect.min.midpoint(rect.max), 0.5 * (rect.max - rect.min));
        let walls = format!(
            "max(abs(x - ({})) - {}, abs(y - ({})) - {})",
            middle.x, half.x, middle.y, half.y
        );
        let drawn = load(source)?.seen_from(site.origin).tree;
        let tree = drawn.max(load(&formula(walls))?.tree);
        let field = field(&tree, 0.0, rect, width)?;
        Ok(Shape::Field(Box::new(field)))
    }

    /// The parts of the zero set within the area.
    pub(super) fn lines(
        &self,
        layer: &Layer<'_>,
        around: Around<'_>,
        width: Mm,
    ) -> Result<Vec<Piece>, InfillError> {
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
                for cluster in clusters(layer.border.area()) {
                    let (border, bounds) = (layer.border, cluster.bounds);
                    let lines = curves(
                        expression, border, bounds, layer.z, around, width,
                        false,
                    )?;
                    let mut cutter = Cutter::new(border);
                    for (points, closed) in lines {
                        cutter.line(&points, closed);
                    }
                    // Its lattice reaches into the next one's box.
                    let own = |p: &Piece| {
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
        let mut rings = Vec::new();
        for cluster in clusters(area) {
            let (border, bounds) = (Border::new(&cluster.area), cluster.bounds);
            let lines =
                curves(expression, &border, bounds, z, around, width, true)?;
            let own = lines
                .into_iter()
                .filter(|(points, closed)| *closed && points.len() > 2);
            let own = Area {
                rings: own.map(|(points, _)| points).collect(),
            };
            rings.extend(intersection(&own, &cluster.area).rings);
        }
        Ok(Area { rings })
    }

    /// Centre lines of the solid in `area`: walls, and lines inside them.
    pub(super) fn solid(
        &self,
        area: &Area,
        layer: &Layer<'_>,
        around: Around<'_>,
        height: Mm,
        settings: &Settings,
    ) -> Result<Vec<Stroke>, InfillError> {
        let width = settings.infill_width();
        let mut inside = self.inside(area, layer.z, around, width)?;
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
        lines.extend(
            fill.into_iter()
                .map(|s| Stroke::new(vec![s.from, s.to], false, width)),
        );
        Ok(lines)
    }
}

/// A formula as a source.
fn formula(text: String) -> Source {
    Source::Text {
        name: "infill".into(),
        kind: SourceKind::Formula,
        text,
    }
}

/// Where a field is negative in the layer at height `z`.
fn negative(field: &Field, z: Mm, width: Mm) -> Result<Area, InfillError> {
    let detail = Detail {
        accuracy: CHORD,
        smallest: STEP * width,
    };
    // No time is noted here: it belongs to the infill, not to the part's
    // outlines.
    let timings = Timings::default();
    let found = outlines(field, &[z], detail, &timings)?;
    Ok(found.into_iter().next().map_or(Area::EMPTY, |o| o.area))
}

/// The zero lines of an expression near the part of a border that lies in a
/// box, and whether each is closed. There may be more lines elsewhere in the
/// box. `whole` closes lines along the box's sides.
fn curves(
    expression: &Expression,
    border: &Border<'_>,
    bounds: Rect,
    z: Mm,
    around: Around<'_>,
    width: Mm,
    whole: bool,
) -> Result<Vec<(Ring, bool)>, VaryError> {
    let extent = bounds.max - bounds.min;
    let step = (STEP * width).max((extent.x * extent.y / MOST).sqrt());
    // Nodes lie whole steps from the origin, so that every layer has them at
    // equal places.
    let origin = ((bounds.min / step).floor() - 1.0) * step;
    let size = (bounds.max - origin) / step;
    let lattice = Lattice {
        origin,
        step,
        size: [size.x as usize + 3, size.y as usize + 3],
        periodic: false,
    };
    let mut places: Vec<Place> = Vec::new();
    let mut failed = None;
    let mut eval = |points: &mut dyn Iterator<Item = DVec2>,
                    out: &mut Vec<f64>| {
        places.clear();
        let Around {
            surroundings,
            solid,
        } = around;
        match surroundings.places(points, z, true, solid, &mut places) {
            Ok(()) => expression.evaluate(&places, out),
            Err(e) => failed = Some(e),
        }
    };
    let [nx, ny] = lattice.size;
    let mut values = vec![f64::NAN; lattice.count()];
    let wanted = nodes_near(&lattice, border);
    let mut some = Vec::with_capacity(AT_ONCE);
    for nodes in wanted.chunks(AT_ONCE) {
        crate::limits::check();
        some.clear();
        let mut places = nodes.iter().map(|&k| {
            let k = k as usize;
            lattice.node(k % nx, k / nx)
        });
        eval(&mut places, &mut some);
        for (&k, &value) in nodes.iter().zip(&some) {
            values[k as usize] = value;
        }
    }
    if whole {
        for (k, value) in values.iter_mut().enumerate() {
            let (i, j) = (k % nx, k / nx);
            if i == 0 || j == 0 || i + 1 == nx || j + 1 == ny {
                *value = f64::INFINITY;
            }
        }
    }
    let curves = trace(&lattice, &values, 4, &mut |points, out| {
        eval(&mut points.iter().copied(), out);
        out.resize(points.len(), f64::NAN);
    });
    if let Some(e) = failed {
        return Err(e);
    }
    let thinned = curves.into_iter().map(|c| {
        let mut points = c.points;
        if c.closed {
            points.extend(points.first().copied());
        }
        let mut points = thin(&points, CHORD);
        if c.closed {
            points.pop();
        }
        (points, c.closed)
    });
    Ok(thinned.collect())
}

/// The numbers of the nodes that matter for what is within a border: those of
/// the blocks of cells that come near to it.
fn nodes_near(lattice: &Lattice, border: &Border<'_>) -> Vec<u32> {
    let [nx, ny] = lattice.size;
    let mut near = vec![false; nx * ny];
    for j in (0..ny).step_by(BLOCK) {
        crate::limits::check();
        for i in (0..nx).step_by(BLOCK) {
            let (right, top) =
                ((i + BLOCK).min(nx - 1), (j + BLOCK).min(ny - 1));
            // One step is added: lines end where no value is known, and such an
            // end must not come into the area when the lines are thinned.
            let block = Rect {
                min: lattice.node(i, j) - lattice.step,
                max: lattice.node(right, top) + lattice.step,
            };
            if border.touches(block) {
                for row in j..=top {
                    near[row * nx + i..=row * nx + right].fill(true);
                }
            }
        }
    }
    (0..near.len() as u32)
        .filter(|&k| near[k as usize])
        .collect()
}
