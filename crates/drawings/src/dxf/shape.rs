//! Entities as lines and curves.

use super::pairs::Record;
use super::pen::Pen;
use super::spline::spline;
use crate::outline::{Fill, Outline};
use glam::{DAffine2, DMat2, DVec2};
use isoslice_base::problem::Problem;
use std::f64::consts::TAU;

/// What an entity draws.
pub(super) struct Shape {
    /// One line, which is not closed yet.
    pub(super) line: Outline,
    /// True if it is a ring.
    pub(super) is_closed: bool,
}

/// By how much an angle may be off a whole turn that is one, radians: files have
/// angles to 12 digits at least.
const WHOLE: f64 = 1e-9;

/// The greatest bulge that one cubic curve stands for: the tangent of a quarter of
/// a sixteenth of a turn, as for arcs of outlines.
const MOST_BULGE: f64 = 0.098_491_404;

/// What an entity draws, with the points of a polyline, which follow it. None if it
/// is not flat, or of a kind that is no line. At most `left` curves are drawn by
/// what may be long.
pub(super) fn shape(
    record: &Record<'_>,
    points: &[Record<'_>],
    left: usize,
) -> Problem<Option<Shape>> {
    let pen = Pen::new(left);
    Ok(Some(match record.kind {
        "LINE" => {
            let ends = [record.point(10)?, record.point(11)?];
            polyline(pen, &ends.map(|p| (p, 0.0)), false)?
        }
        "CIRCLE" => {
            let radius = radius(record)?;
            let mut line = Outline::new(Fill::EvenOdd);
            line.ellipse(record.point(10)?, DVec2::splat(radius));
            in_space(record, line, true)?
        }
        "ARC" => {
            let radius = radius(record)?;
            let [from, to] = [record.needed(50)?, record.needed(51)?];
            let circle = DAffine2 {
                matrix2: DMat2::from_diagonal(DVec2::splat(radius)),
                translation: record.point(10)?,
            };
            let from = from.rem_euclid(360.0).to_radians();
            let arc = arc(circle, from, to.rem_euclid(360.0).to_radians());
            in_space(record, arc.line, arc.is_closed)?
        }
        "ELLIPSE" => ellipse(record)?,
        "LWPOLYLINE" => {
            let line = corners(record, &pen)?;
            let line = polyline(pen, &line, record.has_flag(1)?)?;
            in_space(record, line.line, line.is_closed)?
        }
        "POLYLINE" => {
            /// Meshes and faces.
            const SOLID: i64 = 16 | 32 | 64;
            if record.has_flag(SOLID)? {
                return Ok(None);
            }
            let line = vertices(points, &pen)?;
            let line = polyline(pen, &line, record.has_flag(1)?)?;
            in_space(record, line.line, line.is_closed)?
        }
        "SPLINE" => Shape {
            line: spline(record, pen)?,
            // The flags of closed splines and of those that repeat.
            is_closed: record.has_flag(1 | 2)?,
        },
        _ => return Ok(None),
    }))
}

fn radius(record: &Record<'_>) -> Problem<f64> {
    let radius = record.needed(40)?;
    if radius < 0.0 {
        let (line, kind) = (record.line, record.kind);
        return Err(format!("line {line}: {kind} has the radius {radius}"));
    }
    Ok(radius)
}

/// From an entity's own coordinates to those of what it is in. Those of an entity
/// that is seen from below are mirrored.
pub(super) fn space(record: &Record<'_>) -> Problem<DAffine2> {
    /// How far the way up may be off, which is far below what people draw.
    const UPRIGHT: f64 = 1e-6;
    let [x, y] = [record.number(210)?, record.number(220)?];
    let [x, y] = [x, y].map(|v| v.unwrap_or(0.0));
    let z = record.number(230)?.unwrap_or(1.0);
    if x.abs().max(y.abs()) > UPRIGHT * z.abs() {
        return Err(format!(
            "line {}: {} is tilted out of the plane of x and y; flatten the \
             drawing",
            record.line, record.kind
        ));
    }
    let mirrored = DVec2::new(1.0_f64.copysign(z), 1.0);
    Ok(DAffine2::from_scale(mirrored))
}

fn in_space(
    record: &Record<'_>,
    line: Outline,
    is_closed: bool,
) -> Problem<Shape> {
    let line = line.mapped(space(record)?);
    Ok(Shape { line, is_closed })
}

/// A part of an ellipse, which is the image of the unit circle.
fn arc(ellipse: DAffine2, from: f64, to: f64) -> Shape {
    let mut by = (to - from).rem_euclid(TAU);
    if by < WHOLE {
        by += TAU;
    }
    let is_closed = by > TAU - WHOLE;
    let mut line = Outline::new(Fill::EvenOdd);
    let on = DVec2::new(libm::cos(from), libm::sin(from));
    line.move_to(ellipse.transform_point2(on));
    line.arc(ellipse, from, if is_closed { TAU } else { by });
    Shape { line, is_closed }
}

fn ellipse(record: &Record<'_>) -> Problem<Shape> {
    let major = record.point(11)?;
    let ratio = record.needed(40)?;
    let mirrored = space(record)?.matrix2.determinant();
    let ellipse = DAffine2::from_cols(
        major,
        major.perp() * ratio * mirrored,
        record.point(10)?,
    );
    let from = record.number(41)?.unwrap_or(0.0);
    let to = record.number(42)?.unwrap_or(TAU);
    Ok(arc(ellipse, from.rem_euclid(TAU), to.rem_euclid(TAU)))
}

/// The corners of a polyline, each with the bulge of the line to the next.
fn corners(record: &Record<'_>, pen: &Pen) -> Problem<Vec<(DVec2, f64)>> {
    let mut corners: Vec<(DVec2, f64)> = Vec::new();
    for pair in record.pairs() {
        match (pair.code, corners.last_mut()) {
            (10, _) => {
                pen.may_draw(corners.len())?;
                corners.push((DVec2::new(pair.number()?, 0.0), 0.0));
            }
            (20, Some((corner, _))) => corner.y = pair.number()?,
            (42, Some((_, bulge))) => *bulge = pair.number()?,
            _ => {}
        }
    }
    Ok(corners)
}

/// The same of the points that follow a polyline.
fn vertices(points: &[Record<'_>], pen: &Pen) -> Problem<Vec<(DVec2, f64)>> {
    /// Points that only steer a curve.
    const FRAME: i64 = 16;
    let mut corners = Vec::new();
    for point in points {
        pen.may_draw(corners.len())?;
        if !point.has_flag(FRAME)? {
            let bulge = point.number(42)?.unwrap_or(0.0);
            corners.push((point.point(10)?, bulge));
        }
    }
    Ok(corners)
}

/// Whether a polyline has a width, at some of its points or at all.
pub(super) fn is_wide(
    record: &Record<'_>,
    points: &[Record<'_>],
) -> Problem<bool> {
    if !matches!(record.kind, "LWPOLYLINE" | "POLYLINE") {
        return Ok(false);
    }
    let all = std::iter::once(record).chain(points);
    let widths = all
        .flat_map(Record::pairs)
        .filter(|pair| matches!(pair.code, 40 | 41 | 43));
    for width in widths {
        if width.number()? > 0.0 {
            return Ok(true);
        }
    }
    Ok(false)
}

fn polyline(
    mut pen: Pen,
    corners: &[(DVec2, f64)],
    is_closed: bool,
) -> Problem<Shape> {
    let first = corners.first();
    pen.move_to(first.map_or(DVec2::ZERO, |(p, _)| *p));
    let back = first.filter(|_| is_closed);
    let next = corners.iter().skip(1).chain(back);
    for ((from, bulge), (to, _)) in corners.iter().zip(next) {
        bulge_to(&mut pen, *from, *to, *bulge)?;
    }
    let line = pen.line();
    Ok(Shape { line, is_closed })
}

/// Goes along an arc to `to`. Its bulge is the tangent of a quarter of its angle,
/// positive to the left.
///
/// Neither centre nor angle is asked for, which would be far off where the arc is
/// nearly straight.
fn bulge_to(pen: &mut Pen, from: DVec2, to: DVec2, bulge: f64) -> Problem<()> {
    let chord = to - from;
    if bulge == 0.0 {
        pen.line_to(to)
    } else if bulge.abs() <= MOST_BULGE {
        let along = chord * (1.0 - bulge * bulge) / 3.0;
        let across = chord.perp() * (2.0 * bulge) / 3.0;
        pen.cubic_to(from + along - across, to - along - across, to)
    } else {
        let middle = from.midpoint(to) - chord.perp() * (0.5 * bulge);
        // The tangent of half the angle. A bulge of any size is 1 at most then, so
        // that five halvings are enough.
        let half = bulge / (1.0 + 1.0_f64.hypot(bulge));
        bulge_to(pen, from, middle, half)?;
        bulge_to(pen, middle, to, half)
    }
}
