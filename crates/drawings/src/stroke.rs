//! Lines of some width as areas.
//!
//! Each piece of a line is a band between its two offset curves; between pieces
//! there are joins, and caps at the ends. All are shapes of their own, so that
//! they may overlap and fold in any way.

use crate::curve::Curve;
use crate::outline::{Fill, Outline};
use glam::{DAffine2, DVec2};

/// A line: curves that follow one another.
#[derive(Clone, Debug, Default)]
pub(crate) struct Strand {
    pub(crate) start: DVec2,
    pub(crate) curves: Vec<Curve>,
    pub(crate) closed: bool,
}

/// What is at the ends of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Cap {
    #[default]
    Butt,
    Round,
    Square,
}

/// What is at its corners.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Join {
    #[default]
    Miter,
    Round,
    Bevel,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pen {
    pub(crate) width: f64,
    pub(crate) cap: Cap,
    pub(crate) join: Join,
    /// Greatest length of a mitre, in widths.
    pub(crate) miter: f64,
    /// How far offset curves may be from the truth.
    pub(crate) accuracy: f64,
}

/// How often a curve is halved to offset it.
const DEEPEST: u32 = 10;

/// The area of a line.
pub(crate) fn stroke(strand: &Strand, pen: &Pen, out: &mut Vec<Outline>) {
    let half = 0.5 * pen.width;
    let mut curves = strand.curves.clone();
    let end = curves.last().map_or(strand.start, Curve::end);
    if strand.closed && end != strand.start {
        curves.push(Curve::new(&[end, strand.start]));
    }
    curves.retain(|c| c.way_at_end(false) != DVec2::ZERO);
    let (Some(first), Some(last)) = (curves.first(), curves.last()) else {
        // A dot.
        let mut dot = Outline::new(Fill::NonZero);
        match pen.cap {
            Cap::Butt => return,
            Cap::Round => dot.ellipse(strand.start, DVec2::splat(half)),
            Cap::Square => {
                dot.rectangle(strand.start - half, strand.start + half);
            }
        }
        out.push(dot);
        return;
    };
    for curve in &curves {
        for piece in curve.monotone() {
            bands(&piece, half, pen.accuracy, DEEPEST, out);
        }
    }
    for pair in curves.windows(2) {
        join(&pair[0], &pair[1], half, pen, out);
    }
    if strand.closed {
        join(last, first, half, pen, out);
    } else {
        cap(first.start(), -first.way_at_end(false), half, pen, out);
        cap(last.end(), last.way_at_end(true), half, pen, out);
    }
}

/// The bands along a piece.
fn bands(
    piece: &Curve,
    half: f64,
    accuracy: f64,
    deep: u32,
    out: &mut Vec<Outline>,
) {
    if piece.start() == piece.end() {
        return;
    }
    let sides = [half, -half].map(|by| offset(piece, by, accuracy));
    if let [Some(left), Some(right)] = sides {
        let mut band = Outline::new(Fill::NonZero);
        band.move_to(left[0]);
        if piece.degree() == 1 {
            band.line_to(left[3]);
            band.line_to(right[3]);
            band.line_to(right[0]);
        } else {
            band.cubic_to(left[1], left[2], left[3]);
            band.line_to(right[3]);
            band.cubic_to(right[2], right[1], right[0]);
        }
        band.close();
        out.push(band);
    } else if deep > 0 {
        for part in piece.split(0.5) {
            bands(&part, half, accuracy, deep - 1, out);
        }
    } else {
        // Around the tip of a cusp: no part is farther than half a width.
        let mut disc = Outline::new(Fill::NonZero);
        disc.ellipse(piece.at(0.5), DVec2::splat(half));
        out.push(disc);
    }
}

/// The curve beside a piece, to its left, if a cubic one is close to it.
fn offset(piece: &Curve, by: f64, accuracy: f64) -> Option<[DVec2; 4]> {
    let ways = [false, true].map(|end| piece.way_at_end(end));
    let [a, b] = [piece.start(), piece.end()];
    let at = [a + ways[0].perp() * by, b + ways[1].perp() * by];
    if piece.degree() == 1 {
        return Some([at[0], at[0], at[1], at[1]]);
    }
    let (slope, n) = piece.slope();
    let handles = [slope[0] / 3.0, slope[n - 1] / 3.0];
    let steps = (n - 1) as f64;
    let bends = [
        bend(slope[0], (slope[1] - slope[0]) * steps),
        bend(slope[n - 1], (slope[n - 1] - slope[n - 2]) * steps),
    ];
    let curve = [
        at[0],
        at[0] + handles[0] * (1.0 - by * bends[0]),
        at[1] - handles[1] * (1.0 - by * bends[1]),
        at[1],
    ];
    if !curve.iter().all(|p| p.is_finite()) {
        return None;
    }
    let made = Curve::new(&curve);
    let close = [0.25, 0.5, 0.75].into_iter().all(|t| {
        let out = piece.way(t).perp();
        let true_point = piece.at(t) + out * by;
        (made.at(t) - true_point).dot(out).abs() <= accuracy
    });
    let turned = ways[0].dot(ways[1]) > 0.7;
    (close && turned).then_some(curve)
}

/// The curvature of a curve by its first and second derivative.
fn bend(first: DVec2, second: DVec2) -> f64 {
    let length = first.length();
    first.perp_dot(second) / (length * length * length)
}

/// What is between two pieces at the outside of a corner.
fn join(a: &Curve, b: &Curve, half: f64, pen: &Pen, out: &mut Vec<Outline>) {
    let p = a.end();
    let (u, v) = (a.way_at_end(true), b.way_at_end(false));
    let turn = u.perp_dot(v);
    if turn.abs() < 1e-9 && u.dot(v) > 0.0 {
        return;
    }
    let side = if turn > 0.0 { -half } else { half };
    let (from, to) = (u.perp() * side, v.perp() * side);
    let mut corner = Outline::new(Fill::NonZero);
    corner.move_to(p);
    corner.line_to(p + from);
    match pen.join {
        Join::Round => sector(&mut corner, p, from, to),
        Join::Miter => {
            // The length of the mitre is 1 / cos of half the turn.
            let halfway = from + to;
            let cosine2 = 0.5 * (1.0 + u.dot(v));
            if cosine2 * pen.miter * pen.miter >= 1.0 {
                let tip = halfway / (2.0 * cosine2);
                corner.line_to(p + tip);
            }
        }
        Join::Bevel => {}
    }
    corner.line_to(p + to);
    corner.close();
    out.push(corner);
}

/// Goes along the arc around a centre from one vector to another.
fn sector(outline: &mut Outline, centre: DVec2, from: DVec2, to: DVec2) {
    let by = libm::atan2(from.perp_dot(to), from.dot(to));
    let circle = DAffine2::from_cols(from, from.perp(), centre);
    outline.arc(circle, 0.0, by);
}

/// What is at an end of a line that leaves it in some way.
fn cap(p: DVec2, way: DVec2, half: f64, pen: &Pen, out: &mut Vec<Outline>) {
    let right = -way.perp() * half;
    let mut cap = Outline::new(Fill::NonZero);
    cap.move_to(p + right);
    match pen.cap {
        Cap::Butt => return,
        Cap::Square => {
            cap.line_to(p + right + way * half);
            cap.line_to(p - right + way * half);
            cap.line_to(p - right);
        }
        Cap::Round => {
            let circle = DAffine2::from_cols(right, way * half, p);
            cap.arc(circle, 0.0, std::f64::consts::PI);
        }
    }
    cap.close();
    out.push(cap);
}
