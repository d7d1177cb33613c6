//! What sticks out by more than a lip in one layer: ledges, lids, bridges.
//!
//! In: boxes of a layer in which something sticks out, and the layer below.
//! Out: the gaps below the layer, and what hangs over each.

use super::reach::Limits;
use crate::skin::bridge::{direction, hung};
use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::clip::{crop, difference, intersection};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::hatch::Lines;
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Rect, Solid, edges};
use isoslice_settings::Settings;

/// What hangs over a gap.
#[derive(Clone, Debug, Default)]
pub(super) struct Gap {
    /// Where the gap is, without what the layer below holds.
    pub area: Area,
    /// Content of what no two ends hold, and its greatest distance from what
    /// holds it at one end.
    pub leans: Mm2,
    pub reach: Mm,
    /// The place at that distance.
    pub at: DVec2,
    /// Content of the bridges that are too long, and the length of the longest.
    pub bridges: Mm2,
    pub span: Mm,
    /// The middle of the longest bridge.
    pub middle: DVec2,
}

/// Tolerance of the offsets, mm.
const TOLERANCE: Mm = 0.02;
/// Least content of a gap, mm².
const SPECK: Mm2 = 0.05;
/// About how many points of a gap its reach is measured at.
const POINTS: f64 = 2000.0;
/// Greatest number of boxes that are kept apart.
const BOXES: usize = 200;

/// The gaps in some boxes of a layer.
pub(super) fn gaps(
    boxes: Vec<Rect>,
    here: &Area,
    below: &Solid<'_>,
    number: usize,
    limits: Limits,
    settings: &Settings,
) -> Vec<Gap> {
    let boxes = merged(boxes);
    let found = boxes.into_iter().flat_map(|rect| {
        if isoslice_base::limits::is_stopped() {
            return Vec::new();
        }
        let wide = Rect::new(
            rect.min - 3.0 - limits.held,
            rect.max + 3.0 + limits.held,
        );
        let under = crop(&below.area().rings, wide);
        let open = difference(&crop(&here.rings, rect), &under);
        let beyond = difference(&open, &offset(&under, limits.held, TOLERANCE));
        let beyond: Area = beyond
            .islands()
            .into_iter()
            .filter(|island| island.content() > SPECK)
            .collect();
        let around = offset(&beyond, limits.held + TOLERANCE, TOLERANCE);
        intersection(&open, &around).islands()
    });
    found
        .filter(|area| area.content() > SPECK)
        .map(|area| over(area, below.grid(), number, limits, settings))
        .collect()
}

/// Length and middle of the longest bridge over the gap around `need`, which is
/// what of a layer only bridges could hold; none if most of it is over no bridge
/// that is too long.
pub(super) fn bridge(
    need: &Area,
    here: &Area,
    below: &Solid<'_>,
    number: usize,
    settings: &Settings,
) -> Option<(Mm, DVec2)> {
    let limits = Limits::new(settings.thickest_layer(), settings);
    let around = offset(need, limits.held + TOLERANCE, TOLERANCE);
    let rect = around.bounds();
    let under = crop(&below.area().rings, rect);
    let open = difference(&crop(&here.rings, rect), &under);
    let gaps = intersection(&open, &around).islands().into_iter();
    let gaps =
        gaps.map(|gap| over(gap, below.grid(), number, limits, settings));
    let longest = gaps.max_by(|a, b| a.bridges.total_cmp(&b.bridges))?;
    let most = longest.bridges > 0.5 * need.content();
    most.then_some((longest.span, longest.middle))
}

/// Boxes that cover the given ones, and of which no two meet.
fn merged(mut boxes: Vec<Rect>) -> Vec<Rect> {
    if boxes.len() > BOXES {
        return vec![boxes.iter().fold(Rect::EMPTY, |r, b| r.union(*b))];
    }
    let mut done: Vec<Rect> = Vec::new();
    while let Some(mut rect) = boxes.pop() {
        // The grown box may meet boxes that it did not meet before.
        loop {
            let met: Vec<Rect> =
                done.extract_if(.., |d| d.meets(rect)).collect();
            if met.is_empty() {
                break;
            }
            rect = met.iter().fold(rect, |r, b| r.union(*b));
        }
        done.push(rect);
    }
    done
}

/// What hangs over one gap.
fn over(
    area: Area,
    below: &EdgeGrid,
    number: usize,
    limits: Limits,
    settings: &Settings,
) -> Gap {
    let width = settings.skin_width();
    let angle = if settings.bridges {
        direction(&area, below, width)
    } else {
        Some(settings.skin_direction(number))
    };
    let content = area.content();
    let spacing = width.max((content / POINTS).sqrt());
    let lines = Lines {
        angle: angle.unwrap_or(0.0),
        spacing,
        phase: 0.5 * spacing,
    };
    let lines = hung(&area, below, lines, width);
    let total: Mm = lines.iter().map(|(s, _)| s.from.distance(s.to)).sum();
    let share = content / total.max(1e-9);
    let is_held = |ends: &[bool; 2]| angle.is_some() && *ends == [true; 2];
    let (held, free): (Vec<_>, Vec<_>) =
        lines.into_iter().partition(|(_, ends)| is_held(ends));
    let mut gap = Gap {
        area,
        ..Gap::default()
    };
    for (line, _) in &held {
        let length = line.from.distance(line.to);
        if length > settings.bridge_max {
            gap.bridges += length * share;
            if length > gap.span {
                gap.span = length;
                gap.middle = line.from.midpoint(line.to);
            }
        }
    }
    let bridged = held.iter().map(|(s, _)| (0, (s.from, s.to)));
    let bridged = EdgeGrid::of(bridged, 1.0);
    let mut ask = |p: DVec2| {
        let away = |grid: &EdgeGrid| {
            grid.foot(p).map_or(f64::INFINITY, |(_, q)| q.distance(p))
        };
        let reach = away(below).min(away(&bridged));
        if reach.is_finite() && reach > gap.reach {
            gap.reach = reach;
            gap.at = p;
        }
    };
    let mut leans = 0.0;
    for (line, _) in &free {
        let length = line.from.distance(line.to);
        leans += length * share;
        let steps = (length / spacing).ceil().max(1.0);
        for k in 0..=steps as usize {
            ask(line.from.lerp(line.to, k as f64 / steps));
        }
    }
    if held.is_empty() {
        // The farthest point may be between the lines, at a corner.
        for ring in &gap.area.rings {
            let step = (ring.len() / 500).max(1);
            edges(ring).step_by(step).for_each(|(p, _)| ask(p));
        }
    }
    if gap.reach > limits.held + limits.lip {
        gap.leans = leans;
    } else {
        gap.reach = 0.0;
    }
    gap
}
