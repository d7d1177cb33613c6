//! An area: what is inside outlines, and its border.
//!
//! Outlines may cross, cover and touch one another. The sign of the distance
//! comes from the outlines as they are drawn ([`winding`]), so that it is right
//! whatever they do. The distance comes from the border: the outlines are cut
//! where they meet ([`meet`]), and of the parts those are kept that have the
//! inside on one side and the outside on the other.

mod meet;
mod nearest;
mod rings;
mod slopes;
mod winding;

use crate::curve::Curve;
use crate::outline::{Fill, Outline};
use crate::tree::Tree;
use glam::DVec2;
use isocontour::Rect;
use isoslice_base::problem::{Problem, go_on};
pub(crate) use nearest::Piece;
use rayon::prelude::*;
use std::sync::OnceLock;
use winding::Winding;

/// The most lines and curves of a drawing.
pub(crate) const MOST_CURVES: usize = 1 << 18;

/// What a shape does with the points that it covers.
#[derive(Clone, Debug)]
struct Shape {
    fill: Fill,
    cuts: bool,
    seen_in: Vec<u32>,
    window: Option<u32>,
}

/// A part of the border.
#[derive(Clone, Copy, Debug)]
struct Edge {
    piece: Piece,
    /// 1 if the outside is to the right of its way, -1 if to its left.
    out: f64,
    /// Whether the border goes on smoothly at its start and its end.
    smooth: [bool; 2],
}

/// What is inside outlines.
#[derive(Debug)]
pub(crate) struct Area {
    winding: Winding,
    edges: Vec<Edge>,
    tree: Tree,
    /// How far apart the ends of edges are at most that meet, mm.
    near: f64,
    /// The edges in rings, if they are ever asked for.
    chains: OnceLock<Option<Vec<Vec<u32>>>>,
}

/// The nearest point of the border.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// The square of its distance.
    pub(crate) far2: f64,
    edge: usize,
    t: f64,
}

impl Area {
    /// What is inside outlines, the last of which is on top.
    ///
    /// # Errors
    /// If they meet too often, or work was stopped.
    pub(crate) fn new(outlines: &[Outline]) -> Problem<Area> {
        let shapes: Vec<Shape> = outlines
            .iter()
            .map(|o| Shape {
                fill: o.fill,
                cuts: o.cuts,
                seen_in: o.seen_in.clone(),
                window: o.window,
            })
            .collect();
        let mut pieces: Vec<(Curve, u32)> = Vec::new();
        for (shape, outline) in outlines.iter().enumerate() {
            for curve in outline.curves() {
                let parts = curve.monotone();
                let parts = parts.into_iter().filter(|c| c.start() != c.end());
                pieces.extend(parts.map(|c| (c, shape as u32)));
            }
        }
        let winding = Winding::new(pieces.clone(), shapes);
        let bounds = winding.bounds();
        // Far below what can be printed, and far above rounding: 0.2 nm at
        // 200 mm.
        let flat = 1e-12 * bounds.size().max_element().max(1e-3)
            + 1e-13 * bounds.max.abs().max(bounds.min.abs()).max_element();
        let curves: Vec<Curve> = pieces.into_iter().map(|p| p.0).collect();
        let boxes = curves.iter().map(Curve::bounds).collect();
        let met = meet::meetings(&curves, &Tree::new(boxes), 100.0 * flat)?;
        let mut edges = border(&winding, &curves, &met, 1e4 * flat)?;
        smooth_ends(&mut edges);
        let boxes = edges.iter().map(|e| e.piece.curve.bounds()).collect();
        Ok(Area {
            winding,
            tree: Tree::new(boxes),
            edges,
            near: 1e4 * flat,
            chains: OnceLock::new(),
        })
    }

    /// The box around its border.
    pub(crate) fn bounds(&self) -> Rect {
        self.tree.bounds()
    }

    pub(crate) fn bytes(&self) -> usize {
        self.winding.bytes()
            + self.tree.bytes()
            + size_of_val(self.edges.as_slice())
    }

    /// Tells all on which it depends.
    pub(crate) fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        self.winding.contents(tell);
    }

    /// Whether a point is inside.
    pub(crate) fn is_inside(&self, p: DVec2) -> bool {
        self.bounds().contains(p) && self.winding.is_inside(p)
    }

    /// The nearest point of the border, which is no farther away than a square
    /// of a distance; the last one if there is none.
    pub(crate) fn nearest(&self, p: DVec2, within2: f64) -> Nearest {
        let mut best = Nearest {
            far2: within2,
            edge: usize::MAX,
            t: 0.0,
        };
        self.tree.near(p, within2, |edge, far2| {
            let (far, t) = self.edges[edge].piece.nearest(p);
            if far < far2 || (far == far2 && edge < best.edge) {
                best = Nearest { far2: far, edge, t };
            }
            best.far2
        });
        best
    }

    /// The distance to the border, negative inside, and its gradient.
    pub(crate) fn at(&self, p: DVec2) -> (f64, DVec2) {
        let near = self.nearest(p, f64::INFINITY);
        let inside = self.is_inside(p);
        let sign = if inside { -1.0 } else { 1.0 };
        let far = near.far2.sqrt();
        let Some(edge) = self.edges.get(near.edge) else {
            return (far * sign, DVec2::ZERO);
        };
        let curve = &edge.piece.curve;
        let at_end = near.t <= 0.0 || near.t >= 1.0;
        let from = p - curve.at(near.t);
        // Close to the border the way out is told better by the border itself.
        let close = far < 1e-6;
        let gradient = if far > 0.0 && (at_end || !close) {
            from / far * sign
        } else {
            let way = if at_end {
                curve.way_at_end(near.t >= 1.0)
            } else {
                curve.way(near.t)
            };
            -way.perp() * edge.out
        };
        (far * sign, gradient)
    }
}

/// The parts of curves, which are cut where they meet, that are the border.
fn border(
    winding: &Winding,
    curves: &[Curve],
    met: &[Vec<f64>],
    step: f64,
) -> Problem<Vec<Edge>> {
    /// Curves after which it is asked whether to stop. They take some tens of
    /// milliseconds.
    const BLOCK: usize = 4096;
    let mut border = Vec::new();
    for (curves, met) in curves.chunks(BLOCK).zip(met.chunks(BLOCK)) {
        go_on()?;
        let parts = |(curve, at): (&Curve, &Vec<f64>)| {
            let parts = curve.cut(at).into_iter();
            parts.filter_map(|part| edge(winding, part, step))
        };
        let both = curves.par_iter().zip(met);
        border.par_extend(both.flat_map_iter(parts));
    }
    Ok(border)
}

/// A part of an outline as a part of the border, if it is one.
fn edge(winding: &Winding, part: Curve, step: f64) -> Option<Edge> {
    let middle = part.at(0.5);
    let way = part.way(0.5);
    if way == glam::DVec2::ZERO {
        return None;
    }
    let left = winding.is_inside(middle + way.perp() * step);
    let right = winding.is_inside(middle - way.perp() * step);
    (left != right).then(|| Edge {
        piece: Piece::new(part),
        out: if left { 1.0 } else { -1.0 },
        smooth: [false; 2],
    })
}

/// An end of an edge: where, which, and the way of the border there, with the
/// inside to its left.
struct End {
    at: [u64; 2],
    edge: usize,
    end: usize,
    way: DVec2,
}

/// Finds ends at which exactly two edges meet and go on in the same way.
fn smooth_ends(edges: &mut [Edge]) {
    let end = |(edge, e): (usize, &Edge)| {
        [0, 1].map(|end| {
            let curve = &e.piece.curve;
            let p = if end == 1 { curve.end() } else { curve.start() };
            End {
                // Adding 0 makes no difference but for -0.
                at: (p + 0.0).to_array().map(f64::to_bits),
                edge,
                end,
                way: curve.way_at_end(end == 1) * e.out,
            }
        })
    };
    let mut ends: Vec<End> = edges.iter().enumerate().flat_map(end).collect();
    ends.sort_by_key(|e| (e.at, e.edge, e.end));
    for same in ends.chunk_by(|a, b| a.at == b.at) {
        if let [a, b] = same
            && a.way.dot(b.way) > 0.0
            && a.way.perp_dot(b.way).abs() < SMOOTH
        {
            edges[a.edge].smooth[a.end] = true;
            edges[b.edge].smooth[b.end] = true;
        }
    }
}

/// By how much the way may turn where a border goes on smoothly, radians.
const SMOOTH: f64 = 1e-6;
