//! Lines beside each other, joined to long strokes.
//!
//! ```text
//!   ════════════───╮   A turn runs along the border. It is narrower than the
//!                  │   lines, and so is a straight piece between it and each
//!   ════════════───╯   of them: so line, turn and line fill what two lines
//!   ════════════───╮   would, the corners as well, and nothing is laid twice.
//! ```
//!
//! In: lines in the order of their rows, and which of them wait for which.
//! Out: strokes of one line or many, and which strokes wait for which.
//!
//! If a turn's share of the plane is t, it takes t·a over a way a, and by that
//! much the lines end early. Ends are not joined across the border, nor where
//! the way is long: there the lines meet the border so flatly that they grow
//! wider beside it.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::{Stroke, narrowest};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::joints::Joints;

/// The turns between lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turns<'a> {
    /// The border of the area that the lines fill.
    pub border: &'a EdgeGrid,
    /// Distance of the lines.
    pub spacing: Mm,
    /// Height of the layer.
    pub height: Mm,
}

/// Strokes, and the order in which they have to be printed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Joined {
    /// The strokes, those that begin in lower rows first.
    pub strokes: Vec<Stroke>,
    /// For each stroke the strokes that it has to wait for, if the lines had to
    /// wait.
    pub after: Vec<Vec<u32>>,
    /// For each stroke whether it has to begin with its first line, if the
    /// lines had to wait.
    pub one_way: Vec<bool>,
}

impl Joined {
    /// Every line as a stroke of its own.
    pub(super) fn apart(
        lines: Vec<(i64, Stroke)>,
        after: Vec<Vec<u32>>,
    ) -> Joined {
        Joined {
            strokes: lines.into_iter().map(|l| l.1).collect(),
            after,
            one_way: Vec::new(),
        }
    }
}

/// Share of the plane that a turn takes, as a share of what a line takes. The
/// turn is so narrow that the lines' round ends reach the border's corners.
const NARROW: f64 = 0.5;
/// Length of a turn's straight piece from a line to a corner, as a share of the
/// way from end to end.
const STRAIGHT: f64 = 0.2;
/// How far a turn reaches beyond both lines, as a share of the same way. Simulated
/// on plates with holes: with 0 a place at a turn gets up to 1.4 times what belongs
/// there, and one between two turns 0.85 of it; with 0.06 1.3 and 0.9. Each 0.01
/// takes a plate 0.15 % longer, as the corners grow sharper.
const BEYOND: f64 = 0.06;
/// By how much deeper one corner lies than the other, where the lines meet the
/// border at an angle. The other one lies in the sharp corner, which nothing
/// else fills.
const LEAN: f64 = 0.6;
/// Longest way from end to end, in spacings.
const REACH: f64 = 2.3;

/// Length over which the width changes at both ends of a turn, mm.
const JUMP: Mm = 0.05;
/// A turn from the end of one line to that of another in the next row.
#[derive(Clone, Copy, Debug)]
struct Turn {
    length: Mm,
    lines: [usize; 2],
    /// Length by which each of the two lines ends early, mm.
    early: [Mm; 2],
    /// The turn's corners, beside the border.
    corners: [DVec2; 2],
    /// True if the turn is at the lines' last points, false if it is at their
    /// first ones.
    last: bool,
}

/// Joins lines. `after` is empty, or has for each line the lines that it has to
/// wait for. A waiting line is joined to the line that it waits for if it waits
/// for no other line. So only a stroke's first line waits for other strokes, and
/// these begin in lower rows.
pub(super) fn join(
    lines: Vec<(i64, Stroke)>,
    after: &[Vec<u32>],
    turns: Turns<'_>,
) -> Joined {
    let mut joints = Joints::new(lines.len());
    // The turn over which each line goes on to the next row, and the one over which
    // it is reached from the row before.
    let mut next: Vec<Option<Turn>> = vec![None; lines.len()];
    let mut before: Vec<Option<Turn>> = vec![None; lines.len()];
    for turn in links(&lines, after, turns) {
        let [i, k] = turn.lines;
        let last = usize::from(turn.last);
        joints.join(2 * i + last, 2 * k + last);
        next[i] = Some(turn);
        before[k] = Some(turn);
    }
    let mut stroke_of = vec![0; lines.len()];
    let mut strokes: Vec<Stroke> = Vec::new();
    for chain in joints.chains() {
        if isoslice_base::limits::is_stopped() {
            return Joined::default();
        }
        let first = chain.pieces[0].0;
        let mut stroke = Stroke::new(Vec::new(), false, lines[first].1.width);
        for (i, reversed) in chain.pieces {
            stroke_of[i] = strokes.len() as u32;
            let mut line = lines[i].1.clone();
            if reversed {
                line.reverse();
            }
            turns.append(&mut stroke, line, before[i], next[i]);
        }
        if next[first].is_none() {
            stroke.widths.clone_from(&lines[first].1.widths);
        }
        strokes.push(stroke);
    }
    let mut waits: Vec<Vec<u32>> = Vec::new();
    let mut one_way = Vec::new();
    if !after.is_empty() {
        let firsts = (0..lines.len()).filter(|&i| before[i].is_none());
        one_way.extend(firsts.map(|i| next[i].is_some()));
        waits.resize(strokes.len(), Vec::new());
        for (line, before) in after.iter().enumerate() {
            let own = stroke_of[line];
            let others = before.iter().map(|&k| stroke_of[k as usize]);
            waits[own as usize].extend(others.filter(|&k| k != own));
        }
        for waits in &mut waits {
            waits.sort_unstable();
            waits.dedup();
        }
    }
    Joined {
        strokes,
        after: waits,
        one_way,
    }
}

/// The turns, short ones first where several are possible. Each line has at
/// most one to a line before it and one, at its other end, to one behind it.
fn links(
    lines: &[(i64, Stroke)],
    after: &[Vec<u32>],
    turns: Turns<'_>,
) -> Vec<Turn> {
    let alone = |k: usize| after.get(k).is_none_or(|b| b.len() == 1);
    // The end at which a line is joined to the row before.
    let mut joined: Vec<Option<bool>> = vec![None; lines.len()];
    // What turns may take of each line. Some has to stay between them.
    let spare = |l: &(i64, Stroke)| l.1.length() - 0.25 * turns.spacing;
    let mut spare: Vec<Mm> = lines.iter().map(spare).collect();
    let mut links = Vec::new();
    let mut before = 0..0;
    let mut start = 0;
    for row in lines.chunk_by(|a, b| a.0 == b.0) {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let here = start..start + row.len();
        start = here.end;
        let mut possible: Vec<Turn> = Vec::new();
        let follows = |i: &usize| lines[*i].0 + 1 == lines[here.start].0;
        for i in before.clone().filter(follows) {
            for k in here.clone().filter(|&k| alone(k)) {
                let free = |last: &bool| joined[i] != Some(*last);
                possible.extend(
                    [true, false]
                        .into_iter()
                        .filter(free)
                        .filter_map(|last| turns.between([i, k], lines, last)),
                );
            }
        }
        possible.sort_by(|a, b| a.length.total_cmp(&b.length));
        let mut left = vec![false; before.len()];
        for turn in possible {
            let [i, k] = turn.lines;
            if !left[i - before.start]
                && joined[k].is_none()
                && spare[i] > turn.early[0]
                && spare[k] > turn.early[1]
            {
                spare[i] -= turn.early[0];
                spare[k] -= turn.early[1];
                left[i - before.start] = true;
                joined[k] = Some(turn.last);
                links.push(turn);
            }
        }
        before = here;
    }
    links
}

impl Turns<'_> {
    /// Share of the plane that a turn takes.
    fn share(&self) -> Mm {
        (NARROW * self.spacing)
            .max(narrowest(self.height))
            .min(self.spacing)
    }

    /// The turn between two lines in neighbouring rows, if there may be one.
    fn between(
        &self,
        pair: [usize; 2],
        lines: &[(i64, Stroke)],
        last: bool,
    ) -> Option<Turn> {
        let [a, b] = pair.map(|i| &lines[i].1);
        let end = |s: &Stroke| {
            if last {
                s.points.last().copied()
            } else {
                s.points.first().copied()
            }
        };
        let (p, q) = (end(a)?, end(b)?);
        let length = p.distance(q);
        if length > REACH * self.spacing {
            return None;
        }
        let along =
            (*a.points.last()? - *a.points.first()?).normalize_or_zero();
        let out = if last { along } else { -along };
        let lean = out.dot((q - p).normalize_or_zero());
        let (corners, early) = self.way([p, q], out, lean);
        let fits = self.border.crossings(corners[0], corners[1]).is_empty();
        fits.then_some(Turn {
            length,
            lines: pair,
            early,
            corners,
            last,
        })
    }

    /// The way of a turn between two ends of lines that run to `out`: its
    /// corners, and by how much both lines end early.
    fn way(
        &self,
        [p, q]: [DVec2; 2],
        out: DVec2,
        lean: f64,
    ) -> ([DVec2; 2], [Mm; 2]) {
        let share = self.share() / self.spacing;
        let length = p.distance(q);
        let depth = length * (0.5 * share - (1.0 - share) * STRAIGHT);
        let depths = [1.0, -1.0].map(|side| depth * (1.0 + side * LEAN * lean));
        let aside = (q - p) * BEYOND;
        let corners =
            [p - out * depths[0] - aside, q - out * depths[1] + aside];
        // Half of what the turn takes, with the slopes of its width.
        let half = share * 0.5 * corners[0].distance(corners[1])
            + (1.0 - share) * 0.5 * JUMP;
        let early = depths.map(|depth| {
            if share >= 1.0 {
                return depth;
            }
            let straight = (half - share * depth) / (1.0 - share) - depth;
            let straight = straight.max(0.0);
            let longer = straight.hypot(BEYOND * length) - straight;
            depth + straight + longer * share / (1.0 - share)
        });
        (corners, early)
    }

    /// Lets a stroke go on over the turn `before`, if there is one, and along a
    /// line up to the turn `after`, if there is one.
    fn append(
        &self,
        stroke: &mut Stroke,
        line: Stroke,
        before: Option<Turn>,
        after: Option<Turn>,
    ) {
        let early = |turn: Option<Turn>, k: usize| {
            turn.map_or(0.0, |t| t.early[k] / line.length())
        };
        let line = line.part(early(before, 1), 1.0 - early(after, 0));
        if let Some(turn) = before
            && let Some((&a, &b)) =
                stroke.points.last().zip(line.points.first())
        {
            let narrow = line.width - (self.spacing - self.share());
            let [c, d] = turn.corners;
            let jump = |from: DVec2, to: DVec2| {
                from + (to - from).clamp_length_max(JUMP)
            };
            stroke.points.extend([jump(a, c), c, d, jump(b, d)]);
            stroke.widths.extend([narrow; 4]);
        }
        stroke
            .widths
            .extend((0..line.points.len()).map(|i| line.width_at(i)));
        stroke.points.extend(line.points);
    }
}

#[cfg(test)]
mod tests {
    use super::super::strokes::strokes;
    use super::*;
    use crate::skin::sweep;
    use crate::skin::tests::{laid, shares};
    use isoslice_planar::Area;
    use isoslice_planar::bead::spacing;
    use isoslice_planar::clip::difference;
    use isoslice_planar::hatch::Lines;
    use isoslice_planar::shapes::rect;

    const WIDTH: f64 = 0.45;
    const HEIGHT: f64 = 0.2;

    fn apart() -> f64 {
        spacing(WIDTH, WIDTH, HEIGHT)
    }

    /// The lines that fill an area, and the strokes made of them, which lay as
    /// much as the lines do.
    fn joined(area: &Area, angle: f64, swept: bool) -> (usize, Joined) {
        let lines = Lines {
            angle,
            spacing: apart(),
            phase: 0.1,
        };
        let all = strokes(area, lines, WIDTH, 0.5 * WIDTH);
        let after = if swept {
            sweep::after(&all, angle, WIDTH)
        } else {
            Vec::new()
        };
        let border = EdgeGrid::new(area, 1.0);
        let turns = Turns {
            border: &border,
            spacing: apart(),
            height: HEIGHT,
        };
        let less = WIDTH - apart();
        let content = |s: &Stroke| laid(s, less);
        let lines: f64 = all.iter().map(|l| content(&l.1)).sum();
        let count = all.len();
        let found = join(all, &after, turns);
        let share = found.strokes.iter().map(content).sum::<f64>() / lines;
        assert!((share - 1.0).abs() < 2e-3, "{angle}: {share}");
        (count, found)
    }

    #[test]
    fn a_rectangle_is_one_stroke_and_gets_no_more_than_it_holds() {
        // Rows in the middle of 30 equal strips.
        let low = 0.1 - 0.4999 * apart();
        let area = rect(0.0, low, 20.0, low + 29.9998 * apart());
        let (count, found) = joined(&area, 0.0, true);
        assert_eq!((count, found.strokes.len()), (30, 1));
        assert_eq!(found.after, [Vec::<u32>::new()]);
        let share = laid(&found.strokes[0], WIDTH - apart()) / area.content();
        assert!((share - 1.0).abs() < 1e-4, "{share}");
        // Every other line runs backwards.
        let corners = found.strokes[0].points.iter().filter(|p| p.x < 0.5);
        assert_eq!(corners.count(), 1 + 14 * 6 + 1);
    }

    #[test]
    fn turns_lay_evenly_along_the_border() {
        for angle in [0.0, 30.0, 45.0, 60.0] {
            let area = rect(0.0, 0.0, 10.0, 8.0);
            let (_, found) = joined(&area, angle, false);
            // Lines along a border end there as their phase happens to be.
            let inner = rect(1.0, 0.0, 9.0, 8.0);
            let all = shares(&found.strokes, WIDTH - apart(), &area);
            for (p, share) in all {
                let even = (0.75..1.25).contains(&share);
                assert!(even || !inner.contains(p), "{angle}, {p}: {share}");
            }
        }
    }

    /// Every point of the area is under a stroke or within `slack` of one.
    fn covers(strokes: &[Stroke], area: &Area, slack: f64) {
        let bounds = area.bounds();
        let step = 0.03;
        let size = bounds.size() / step;
        for i in 0..size.x as usize {
            for k in 0..size.y as usize {
                let p = bounds.min
                    + DVec2::new(i as f64 + 0.5, k as f64 + 0.5) * step;
                let under = |s: &Stroke| {
                    s.segments().enumerate().any(|(i, (a, b))| {
                        let q = isoslice_planar::grid::nearest_on(p, a, b);
                        let w = s.width_at(i).min(s.width_at(i + 1));
                        p.distance(q) <= 0.5 * w + slack
                    })
                };
                assert!(!area.contains(p) || strokes.iter().any(under), "{p}");
            }
        }
    }

    #[test]
    fn no_corner_of_a_turn_stays_open() {
        for angle in [0.0, 45.0, 60.0] {
            let area = rect(0.0, 0.0, 6.0, 5.0);
            let (count, found) = joined(&area, angle, false);
            // The ring's side covers 25 µm of this area. Between two turns the
            // next 40 µm are open on less than 0.01 mm².
            let inner = rect(0.065, 0.25, 5.935, 4.75);
            let inner = if angle == 0.0 {
                inner
            } else {
                rect(0.3, 0.3, 5.7, 4.7)
            };
            covers(&found.strokes, &inner, 0.02);
            assert!(count > 12 && found.strokes.len() < 6, "{angle}");
        }
    }

    #[test]
    fn a_triangle_and_a_ring_get_few_strokes() {
        let triangle = Area::from(
            [(0.0, 0.0), (20.0, 0.0), (10.0, 17.0)]
                .map(DVec2::from)
                .to_vec(),
        );
        let ring = difference(
            &rect(-10.0, -10.0, 10.0, 10.0),
            &rect(-4.0, -4.0, 4.0, 4.0),
        );
        for (area, most) in [(&triangle, 8), (&ring, 9)] {
            for angle in [0.0, 45.0] {
                let (count, found) = joined(area, angle, false);
                let strokes = found.strokes.len();
                assert!(count > 30, "{count}");
                assert!(strokes <= most, "{angle}: {strokes} of {count}");
            }
        }
    }

    #[test]
    fn no_turn_crosses_the_border() {
        // Teeth 0.3 mm apart.
        let mut area = rect(0.0, 0.0, 10.0, 4.0);
        for k in 0..12 {
            let y = 0.3 * f64::from(k) + 0.2;
            area = difference(&area, &rect(9.5, y, 11.0, y + 0.05));
        }
        let border = EdgeGrid::new(&area, 1.0);
        let (_, found) = joined(&area, 0.0, false);
        for s in &found.strokes {
            // Turns are meant here, not lines that move over.
            for (a, b) in s.segments().filter(|(a, b)| a.x == b.x) {
                assert!(border.crossings(a, b).is_empty(), "{a} {b}");
            }
        }
    }

    #[test]
    fn swept_strokes_never_lie_between_older_ones() {
        let area =
            difference(&rect(0.0, 0.0, 20.0, 12.0), &rect(5.0, 4.0, 9.0, 8.0));
        let (count, found) = joined(&area, 0.0, true);
        // Below the hole and on one side of it, on the other side, above it.
        assert_eq!(found.strokes.len(), 3, "of {count}");
        assert_eq!(found.after[0], Vec::<u32>::new());
        assert_eq!(found.after[1], [0]);
        assert_eq!(found.after[2], [0, 1]);
        for s in &found.strokes {
            let rows = s.points.iter().map(|p| p.y);
            assert!(rows.is_sorted_by(|a, b| *b > a - 0.5 * apart()));
        }
    }
}
