//! Beads each of which begins where the one before ends, as one path.

use super::profile::{Kind, Knot, thinned};
use crate::bead::{Bead, Level, Stroke};
use crate::plane::grid::EdgeGrid;
use crate::seam::ending::Ended;
use crate::units::Mm;
use glam::DVec2;

/// A level stretch shorter than this is printed with what is beside it, mm.
const SHORT: Mm = 1.0;

/// Lengths below this count as 0, mm.
const NOTHING: Mm = 1e-7;

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
    /// The segment that the place is on.
    segment: usize,
    /// True if the next layer does not cover the place.
    pub open: bool,
    /// True if the place is a point of the path.
    pub corner: bool,
}

/// True if the next layer leaves some of these beads open.
pub(super) fn any_open(beads: &[Ended], cover: Option<&EdgeGrid>) -> bool {
    let Some(cover) = cover else { return true };
    let open = |p: DVec2| !cover.contains(p);
    beads.iter().any(|ended| {
        let bead = &ended.bead;
        bead.points.first().copied().is_some_and(open)
            || bead.segments().any(|(a, b)| {
                let mut cuts = cover.crossings(a, b).into_iter();
                // Touching the border is not lying open, but costs little.
                cuts.next().is_some()
            })
    })
}

impl Chain {
    /// The chain of beads that have one width each.
    pub(super) fn new(beads: Vec<Ended>) -> Chain {
        let (mut points, mut lengths) = (Vec::new(), Vec::new());
        let mut owners = Vec::new();
        let mut length = 0.0;
        for (i, ended) in beads.iter().enumerate() {
            for (k, p) in ended.bead.path().enumerate() {
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
        let widths = self.beads.iter().map(|ended| ended.bead.width);
        widths.fold(0.0, f64::max)
    }

    /// The path's points, and more where it lies open: none farther from the
    /// next than `step`, and one wherever the next layer's border is crossed.
    pub(super) fn stops(
        &self,
        cover: Option<&EdgeGrid>,
        step: Mm,
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
                // One stop in the middle tells that it is covered.
                let count = if open {
                    (way / step).ceil().max(1.0)
                } else {
                    2.0
                };
                for k in 0..=count as usize {
                    let t = from + (to - from) * k as f64 / count;
                    self.push(&mut stops, segment, t, open);
                }
                from = to;
            }
        }
        stops
    }

    /// Adds a stop; if there is one already, an open one stays.
    fn push(&self, stops: &mut Vec<Stop>, segment: usize, t: f64, open: bool) {
        let (a, b) = (self.points[segment], self.points[segment + 1]);
        let (from, to) = (self.lengths[segment], self.lengths[segment + 1]);
        let stop = Stop {
            at: from + t * (to - from),
            point: a.lerp(b, t),
            segment,
            open,
            corner: t <= 0.0 || t >= 1.0,
        };
        match stops.last_mut() {
            Some(last) if stop.at - last.at <= NOTHING => {
                let corner = last.corner || stop.corner;
                if stop.open || !last.open {
                    *last = stop;
                }
                last.corner = corner;
            }
            _ => stops.push(stop),
        }
    }

    /// For a stop whose middle lies open: the share of the bead's width that
    /// lies open, and where the middle of that share is, from the stop.
    pub(super) fn open_share(
        &self,
        stop: &Stop,
        cover: Option<&EdgeGrid>,
    ) -> (f64, DVec2) {
        let Some(cover) = cover else {
            return (1.0, DVec2::ZERO);
        };
        let (a, b) = (self.points[stop.segment], self.points[stop.segment + 1]);
        let width = self.beads[self.owners[stop.segment]].bead.width;
        let across = width * (b - a).normalize_or_zero().perp();
        let ends = [-0.5, 0.5].map(|share| stop.point + share * across);
        let (mut low, mut high) = (0.0, 1.0);
        for t in cover.crossings(ends[0], ends[1]) {
            // A stop on the border lies open on the one side of it.
            let near = (t - 0.5_f64).abs() <= NOTHING;
            match t < 0.5 {
                _ if near => {}
                true => low = t.max(low),
                false => high = t.min(high),
            }
        }
        (high - low, (0.5 * (low + high) - 0.5) * across)
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
                let mut stroke = Stroke::new(Vec::new(), false, bead.width);
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
        [a, b] if a.kind == Kind::Open && b.kind == Kind::Open => Part::Open,
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
