//! Beads each of which begins where the one before ends, as one path.

use super::profile::{Knot, KnotKind, thinned};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_layer::seam::ending::Ended;
use isoslice_planar::bead::{Bead, Level, Stroke, spacing};
use isoslice_planar::grid::EdgeGrid;

/// A level stretch shorter than this is printed with what is beside it, mm.
const SHORT: Mm = 1.0;

/// Lengths below this count as 0, mm.
const NOTHING: Mm = 1e-7;

/// How far from the ends of a stretch it is looked at across its way, mm. At an
/// end the border itself may run across.
const INSIDE: Mm = 1e-3;

/// Beads of one width each.
pub(super) struct Chain {
    beads: Vec<Ended>,
    /// The points of the beads. A point at which two beads meet is there once.
    points: Vec<DVec2>,
    /// Length of the path up to each point.
    lengths: Vec<Mm>,
    /// The bead of each segment.
    owners: Vec<usize>,
}

/// A place along a chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop {
    /// Length of the path up to the place, mm.
    pub at: Mm,
    /// The place.
    pub point: DVec2,
    /// True if the next layer does not cover the place.
    pub open: bool,
    /// What the next layer leaves open of the bead here.
    pub bare: Bare,
    /// True if the place is a point of the path.
    pub corner: bool,
}

/// The part of a bead's share of the plane, across its way, that lies open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bare {
    /// How much of the whole it is, 0 to 1.
    pub share: f64,
    /// Where its middle is.
    pub middle: DVec2,
}

/// True if the next layer leaves some of these beads open, be it on one side.
pub(super) fn any_open(
    beads: &[Ended],
    cover: Option<&EdgeGrid>,
    height: Mm,
) -> bool {
    let Some(cover) = cover else { return true };
    let open = |p: DVec2| !cover.contains(p);
    beads.iter().any(|ended| {
        let stroke = &ended.bead.stroke;
        let widths = stroke.widths.iter().copied().fold(stroke.width, f64::max);
        let half = 0.5 * spacing(widths, widths, height);
        stroke.points.first().copied().is_some_and(open)
            || stroke.segments().any(|(a, b)| !cover.clear(a, b, half))
    })
}

impl Chain {
    /// The chain of beads that have one width each.
    pub(super) fn new(beads: Vec<Ended>) -> Chain {
        let (mut points, mut lengths) = (Vec::new(), Vec::new());
        let mut owners = Vec::new();
        let mut length = 0.0;
        for (i, ended) in beads.iter().enumerate() {
            for (k, p) in ended.bead.stroke.path().enumerate() {
                match points.last() {
                    Some(_) if k == 0 => continue,
                    Some(last) => {
                        length += p.distance(*last);
                        owners.push(i);
                    }
                    None => {}
                }
                points.push(p);
                lengths.push(length);
            }
        }
        Chain {
            beads,
            points,
            lengths,
            owners,
        }
    }

    /// Greatest width of the chain's beads.
    pub(super) fn width(&self) -> Mm {
        let widths = self.beads.iter().map(|ended| ended.bead.stroke.width);
        widths.fold(0.0, f64::max)
    }

    /// True if the path ends where it begins.
    pub(super) fn is_closed(&self) -> bool {
        self.points.len() > 2 && self.points.first() == self.points.last()
    }

    /// The path's points, and more where a bead lies open, be it on one side:
    /// none farther from the next than `step`, and one wherever the next layer's
    /// border is crossed. `height` is the layer's. Near a bend, what lies open
    /// changes gradually from what it is on one side to what it is on the other.
    pub(super) fn stops(
        &self,
        cover: Option<&EdgeGrid>,
        step: Mm,
        height: Mm,
    ) -> Vec<Stop> {
        let mut stops: Vec<Stop> = Vec::new();
        for segment in 0..self.owners.len() {
            let (a, b) = (self.points[segment], self.points[segment + 1]);
            let length = a.distance(b);
            if length <= NOTHING {
                continue;
            }
            let mut cuts = cover.map_or(Vec::new(), |c| c.crossings(a, b));
            cuts.push(1.0);
            cuts.sort_by(f64::total_cmp);
            let mut from = 0.0;
            for to in cuts {
                let way = (to - from) * length;
                // The last cut is the segment's end, and is always reached.
                if way <= NOTHING && to < 1.0 {
                    continue;
                }
                let middle = a.lerp(b, 0.5 * (from + to));
                let open = cover.is_none_or(|c| !c.contains(middle));
                let width = self.beads[self.owners[segment]].bead.stroke.width;
                let reach = spacing(width, width, height);
                let ends = [from, to].map(|t| a.lerp(b, t));
                let beside =
                    |c: &EdgeGrid| !c.clear(ends[0], ends[1], 0.5 * reach);
                let near = cover.filter(|c| beside(c));
                // One stop in the middle tells that it is covered.
                let count = if open || near.is_some() {
                    (way / step).ceil().max(2.0)
                } else {
                    2.0
                };
                let across = reach / length * (b - a).perp();
                let inside = (INSIDE / length).min(0.5 * (to - from));
                for k in 0..=count as usize {
                    let t = from + (to - from) * k as f64 / count;
                    let at = a.lerp(b, t.clamp(from + inside, to - inside));
                    let bare = Bare::new(at, across, near, open);
                    self.push(&mut stops, segment, t, (open, bare));
                }
                from = to;
            }
        }
        rounded(
            &mut stops,
            0.5 * spacing(self.width(), self.width(), height),
        );
        stops
    }

    /// Adds a stop. If there is one already, at a bend or at a border, it
    /// stands for both sides.
    fn push(
        &self,
        stops: &mut Vec<Stop>,
        segment: usize,
        t: f64,
        (open, bare): (bool, Bare),
    ) {
        let (a, b) = (self.points[segment], self.points[segment + 1]);
        let (from, to) = (self.lengths[segment], self.lengths[segment + 1]);
        let stop = Stop {
            at: from + t * (to - from),
            point: a.lerp(b, t),
            open,
            bare,
            corner: t <= 0.0 || t >= 1.0,
        };
        match stops.last_mut() {
            Some(last) if stop.at - last.at <= NOTHING => {
                last.corner |= stop.corner;
                last.open |= stop.open;
                last.bare = last.bare.with(stop.bare);
            }
            _ => stops.push(stop),
        }
    }

    /// The beads with the levels of the knots along them. Beads that stay level
    /// are as they were. `extra` is how much higher the material of a bead is
    /// counted for a fill.
    pub(super) fn levelled(
        self,
        knots: &[Knot],
        tolerance: Mm,
        extra: impl Fn(&Bead, Mm) -> Mm,
    ) -> Vec<Ended> {
        let mut out = Vec::with_capacity(self.beads.len());
        let mut first = 0;
        for (i, ended) in self.beads.iter().enumerate() {
            let count = self.owners[first..].iter().take_while(|o| **o == i);
            let last = first + count.count();
            let (from, to) = (self.lengths[first], self.lengths[last]);
            first = last;
            let begin = knots.partition_point(|k| k.at < from - NOTHING);
            let end = knots.partition_point(|k| k.at <= to + NOTHING);
            let own = &knots[begin..end];
            let parts = parts(own);
            let flat = parts.iter().all(|part| part.2);
            if flat || own.len() < 2 {
                out.push(ended.clone());
                continue;
            }
            for (a, b, flat) in parts {
                let bead = &ended.bead;
                let mut stroke =
                    Stroke::new(Vec::new(), false, bead.stroke.width);
                let mut own = own[a..=b].to_vec();
                for knot in &mut own {
                    knot.fill = extra(bead, knot.fill);
                }
                let thin = if flat {
                    ends_and_corners(&own)
                } else {
                    thinned(&own, tolerance)
                };
                for knot in thin {
                    stroke.points.push(self.point(knot.at));
                    if !flat {
                        stroke.levels.push(Level {
                            rise: knot.rise,
                            extra: knot.fill,
                        });
                    }
                }
                out.push(Ended::from(Bead { stroke, ..*bead }));
            }
            if let Some(last) = out.last_mut() {
                last.wipe = ended.wipe;
            }
        }
        out
    }

    /// The point at a length.
    fn point(&self, at: Mm) -> DVec2 {
        let next = self.lengths.partition_point(|l| *l < at - NOTHING);
        let next = next.clamp(1, self.lengths.len() - 1);
        let (from, to) = (self.lengths[next - 1], self.lengths[next]);
        // These are the very points that the beads had, so that pieces meet.
        if (at - to).abs() <= NOTHING {
            return self.points[next];
        }
        if (at - from).abs() <= NOTHING {
            return self.points[next - 1];
        }
        let t = ((at - from) / (to - from)).clamp(0.0, 1.0);
        self.points[next - 1].lerp(self.points[next], t)
    }
}

/// Smooths what lies open near bends, so that no height jumps there: at stops nearer
/// to a bend than `reach` it becomes the mean over that length of the path.
fn rounded(stops: &mut [Stop], reach: Mm) {
    let (Some(first), Some(last)) = (stops.first(), stops.last()) else {
        return;
    };
    let (start, end) = (first.at, last.at);
    let inner = |s: &&Stop| s.corner && s.at > start && s.at < end;
    let bends: Vec<Mm> = stops.iter().filter(inner).map(|s| s.at).collect();
    let mean = |i: usize| {
        let at = stops[i].at;
        let reach = reach.min(at - start).min(end - at);
        let next = bends.partition_point(|b| *b <= at - reach);
        if bends.get(next).is_none_or(|b| *b >= at + reach) {
            return stops[i].bare;
        }
        let from = stops.partition_point(|s| s.at <= at - reach);
        let (mut share, mut moment) = (0.0, DVec2::ZERO);
        for pair in stops[from.saturating_sub(1)..].windows(2) {
            if pair[0].at >= at + reach {
                break;
            }
            // The part of the way between the two that is within reach.
            let length = pair[1].at - pair[0].at;
            let low = pair[0].at.max(at - reach);
            let high = pair[1].at.min(at + reach);
            let t = (0.5 * (low + high) - pair[0].at) / length;
            for (stop, part) in [(&pair[0], 1.0 - t), (&pair[1], t)] {
                let weight = part * (high - low) * stop.bare.share;
                share += weight;
                moment += weight * (stop.bare.middle - stop.point);
            }
        }
        let off = if share > 0.0 {
            moment / share
        } else {
            DVec2::ZERO
        };
        Bare {
            share: share / (2.0 * reach),
            middle: stops[i].point + off,
        }
    };
    let all: Vec<Bare> = (0..stops.len()).map(mean).collect();
    for (stop, bare) in stops.iter_mut().zip(all) {
        stop.bare = bare;
    }
}

impl Bare {
    /// What lies open of a bead that reaches from `p` by half of `across` to
    /// both sides. `near` is the next layer, if its border is near; if not, all
    /// of the bead is as its middle is, open or not.
    fn new(
        p: DVec2,
        across: DVec2,
        near: Option<&EdgeGrid>,
        open: bool,
    ) -> Bare {
        let mut cuts = near.map_or(Vec::new(), |cover| {
            cover.crossings(p - 0.5 * across, p + 0.5 * across)
        });
        let Some(cover) = near.filter(|_| !cuts.is_empty()) else {
            return Bare {
                share: f64::from(u8::from(open)),
                middle: p,
            };
        };
        cuts.extend([0.0, 1.0]);
        cuts.sort_by(f64::total_cmp);
        let (mut share, mut moment) = (0.0, 0.0);
        for cut in cuts.windows(2) {
            let middle = 0.5 * (cut[0] + cut[1]) - 0.5;
            if !cover.contains(p + middle * across) {
                share += cut[1] - cut[0];
                moment += (cut[1] - cut[0]) * middle;
            }
        }
        let off = if share > 0.0 { moment / share } else { 0.0 };
        Bare {
            share,
            middle: p + off * across,
        }
    }

    /// What lies open of both sides of a place together.
    fn with(self, other: Bare) -> Bare {
        let both = self.share + other.share;
        let t = if both > 0.0 { other.share / both } else { 0.0 };
        Bare {
            share: 0.5 * both,
            middle: self.middle.lerp(other.middle, t),
        }
    }
}

/// The stretches of some knots, from one to another: level ones, those that
/// follow the surface, and the ways between these. True if the stretch is level.
fn parts(knots: &[Knot]) -> Vec<(usize, usize, bool)> {
    #[derive(Clone, Copy, PartialEq)]
    enum Part {
        Level,
        Open,
        Way,
    }
    let level = |k: &Knot| k.rise.abs() < 1e-9 && k.fill.abs() < 1e-9;
    let part = |w: &[Knot]| match w {
        [a, b] if level(a) && level(b) => Part::Level,
        [a, b] if a.kind == KnotKind::Open && b.kind == KnotKind::Open => {
            Part::Open
        }
        _ => Part::Way,
    };
    let mut parts: Vec<(usize, usize, Part)> = Vec::new();
    for (i, pair) in knots.windows(2).enumerate() {
        let part = part(pair);
        match parts.last_mut() {
            Some(last) if last.2 == part => last.1 = i + 1,
            _ => parts.push((i, i + 1, part)),
        }
    }
    let only = parts.len() == 1;
    let length = |a: usize, b: usize| knots[b].at - knots[a].at;
    let mut joined: Vec<(usize, usize, Part)> = Vec::new();
    for (a, b, part) in parts {
        let short = part == Part::Level && length(a, b) < SHORT && !only;
        let part = if short { Part::Way } else { part };
        match joined.last_mut() {
            Some(last) if last.2 == part => last.1 = b,
            _ => joined.push((a, b, part)),
        }
    }
    let level = |(a, b, part)| (a, b, part == Part::Level);
    joined.into_iter().map(level).collect()
}

/// The ends of some knots, and those at points of the path.
fn ends_and_corners(knots: &[Knot]) -> Vec<Knot> {
    let last = knots.len().saturating_sub(1);
    let keep = |i: usize, k: &Knot| i == 0 || i == last || k.corner;
    let all = knots.iter().enumerate();
    all.filter(|(i, k)| keep(*i, k)).map(|(_, k)| *k).collect()
}
