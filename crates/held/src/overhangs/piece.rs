//! What hangs in one place of a layer: how large it is, and why it hangs.
//!
//! In: an island of what the layer below does not hold ([`judge`](super::judge)).
//! Out: whether that is a bridge that is too long, its content and its reach.

use super::OverhangKind;
use super::across::{Across, Upper};
use super::held::Limits;
use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_layer::cover::neighbour::Neighbour;
use isoslice_planar::clip::{difference, intersection};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::hatch::{Lines, hatch};
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Solid, edges};

/// What hangs in one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct OverhangPiece {
    pub kind: OverhangKind,
    /// Content of the underside, seen from below. What is next to the layer below is
    /// part of it, though that layer holds it.
    pub area: Mm2,
    /// Greatest distance from what holds it, or a bridge's length.
    pub reach: Mm,
    /// The farthest place, or the middle of the longest bridge.
    pub at: DVec2,
}

/// Tolerance of the offsets, mm.
const TOLERANCE: Mm = 0.02;
/// About how many points of an area's rim its reach is measured at, and how many of
/// its inside.
const POINTS: f64 = 500.0;
/// Least distance of these points, mm.
const FINE: Mm = 0.1;
/// Least share of an island that is over bridges that are too long, if these are why
/// it hangs.
const SHARE_OF_LONG_BRIDGES: f64 = 0.5;

/// A layer and the one below it, sorted by place: there may be an island over each
/// of thousands of pins.
pub(super) struct Both<'a> {
    here: Neighbour<'a>,
    under: Neighbour<'a>,
    grid: &'a EdgeGrid,
}

impl<'a> Both<'a> {
    /// `here` is what the layer has around the islands that will be asked for.
    pub(super) fn new(here: &'a Area, below: &'a Solid<'_>) -> Both<'a> {
        Both {
            here: Neighbour::new(here),
            under: Neighbour::new(below.area()),
            grid: below.grid(),
        }
    }
}

/// What hangs in `island`.
pub(super) fn piece(
    island: &Area,
    both: &Both<'_>,
    upper: Upper<'_>,
) -> OverhangPiece {
    let limits = Limits::new(upper.height, upper.plan);
    let around = offset(island, limits.held + TOLERANCE, TOLERANCE);
    let rect = around.bounds();
    let under = both.under.within(rect);
    let open = difference(&both.here.within(rect), &under);
    let gaps = intersection(&open, &around);
    // Beside the island lies what bridges span, which does not hang.
    let held = intersection(&gaps, &offset(&under, limits.held, TOLERANCE));
    let area = island.content() + difference(&held, island).content();
    let mut piece = OverhangPiece {
        kind: OverhangKind::Leans,
        area,
        reach: 0.0,
        at: DVec2::ZERO,
    };
    let narrow = 2.0 * (limits.held + limits.harmless);
    (piece.reach, piece.at) = farthest(island, narrow, |p| away(both.grid, p));
    let long = rect.size().length() > upper.plan.bridge_max;
    if !long && !limits.harm(piece.reach) {
        return piece;
    }
    let lines = gaps.islands().into_iter();
    let lines = lines.filter_map(|gap| {
        Some((gap.content(), Across::new(&gap, both.grid, upper)?))
    });
    let lines: Vec<(Mm2, Across)> = lines.collect();
    let long = lines
        .iter()
        .map(|(content, across)| long_ones(*content, across));
    let long = long.max_by(|a, b| a.area.total_cmp(&b.area));
    if let Some(long) =
        long.filter(|l| l.area > SHARE_OF_LONG_BRIDGES * island.content())
    {
        piece.kind = OverhangKind::Bridge;
        (piece.reach, piece.at) = (long.span, long.middle);
        return piece;
    }
    let bridges = lines.iter().flat_map(|(_, across)| across.bridges());
    let bridges = bridges.map(|line| (0, (line.from, line.to)));
    let bridges = EdgeGrid::of(bridges, 1.0);
    let from_all = |p| away(both.grid, p).min(away(&bridges, p));
    (piece.reach, piece.at) = farthest(island, narrow, from_all);
    piece
}

/// The bridges over a gap that are too long.
struct Long {
    area: Mm2,
    /// Length of the longest, and its middle.
    span: Mm,
    middle: DVec2,
}

/// The bridges that are too long over a gap with this content.
fn long_ones(content: Mm2, across: &Across) -> Long {
    let mut long = Long {
        area: 0.0,
        span: 0.0,
        middle: DVec2::ZERO,
    };
    for line in across.too_long() {
        let length = line.from.distance(line.to);
        long.area += length * across.spacing;
        if length > long.span {
            long.span = length;
            long.middle = line.from.midpoint(line.to);
        }
    }
    long.area = long.area.min(content);
    long
}

/// Distance of a place from edges.
fn away(grid: &EdgeGrid, p: DVec2) -> Mm {
    grid.foot(p).map_or(f64::INFINITY, |(_, q)| q.distance(p))
}

/// The greatest finite distance of an area's places, and the place that has it. In the
/// middle of an area that is narrower than `narrow`, nothing is much farther away than
/// at its rim.
fn farthest(
    area: &Area,
    narrow: Mm,
    away: impl Fn(DVec2) -> Mm,
) -> (Mm, DVec2) {
    let (mut reach, mut at) = (0.0, DVec2::ZERO);
    let mut ask = |p: DVec2| {
        let far = away(p);
        if far.is_finite() && far > reach {
            (reach, at) = (far, p);
        }
    };
    let step = (area.perimeter() / POINTS).max(FINE);
    let mut along = |a: DVec2, b: DVec2| {
        let parts = (a.distance(b) / step).ceil().max(1.0);
        (0..parts as usize).for_each(|k| ask(a.lerp(b, k as f64 / parts)));
    };
    let mut since = f64::INFINITY;
    for (a, b) in area.rings.iter().flat_map(|ring| edges(ring)) {
        since += a.distance(b);
        if since >= step {
            along(a, b);
            since = 0.0;
        }
    }
    let size = area.bounds().size();
    if size.min_element() > narrow {
        let spacing = (area.content() / POINTS).sqrt().max(FINE);
        let lines = Lines {
            angle: 0.0,
            spacing,
            phase: 0.5 * spacing,
        };
        let lines = hatch(area, lines, FINE).into_iter();
        lines.for_each(|line| along(line.from, line.to));
    }
    (reach, at)
}
