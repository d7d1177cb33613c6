//! Lines along a bead of varying width, each as long as its width and its path
//! permit together.
//!
//! ```text
//!        ______         Around each place of the path there is room for a line of
//!     __/      \__      a width: the less the nearer the bead's edges have to be,
//!    /  ‾‾‾‾‾‾‾‾  \     and the more its own width differs. A line leads through
//!                       the room of as many places as one line can.
//! ```

use super::way::Way;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::arc;
use isoslice_planar::bead::{Bead, Role, cross_section};
use isoslice_planar::simplify::longest;

/// By how much of itself the volume of half a piece may differ from what is
/// meant.
pub(super) const AREA: f64 = 0.03;

/// A length over which what is laid too early or too late along a bead of this
/// role may be made up for, mm. 3 mm take 50 ms at 60 mm/s, and the pressure in a
/// nozzle takes longer to change.
///
/// Inner walls lie against an outer wall, and have less: on a gyroid ball 1 % of
/// them are off by 0.040 mm or more with 0.8 mm, by 0.037 mm with 0.72 mm and by
/// 0.029 mm with 0.5 mm. From 0.72 to 0.5 mm it takes 2 % more moves, and the
/// width changes 9 % more often.
pub(super) fn evened(role: Role) -> Mm {
    match role {
        role if role.shows() => 0.0,
        Role::InnerWall => 0.72,
        _ => 3.0,
    }
}

/// Lines of a role are not made shorter than this for their width, mm. 0.2 mm
/// are 5 ms at 40 mm/s, and the pressure in a nozzle takes longer to change.
/// Longer pieces of inner walls would lie on the wall beside them where strips
/// meet, with the mean of a narrow and a wide place: with 0.6 mm, 1 % of a
/// honeycomb's inner walls are 0.15 mm too near, with 0.2 mm 0.08 mm, and the
/// pieces are as many.
///
/// What shows is within its tolerance on 0.1 mm unless its width changes by more
/// than 0.4 mm in 1 mm, as in wedges of more than 23°. With 0.2 mm, 1 % of the
/// outer walls of thin lidinoid sheets are 24 µm off or more instead of 14 µm; with
/// 0.05 mm they are 13 µm off, by 7 % more moves.
pub(super) fn shortest(role: Role) -> Mm {
    match role {
        role if role.shows() => 0.1,
        Role::InnerWall => 0.3,
        _ => 0.6,
    }
}

/// Distance of the places in which a line of a role may end, mm.
pub(super) fn step(role: Role) -> Mm {
    // Lines along bends with a radius of 0.2 mm are 0.15 mm long.
    (0.25 * shortest(role)).max(0.05)
}

/// Length of a bead's last line, in lengths of the shortest one, up to which it
/// is not cut.
const REST: f64 = 1.5;

/// Share of the tolerance up to which lines that do not show have one width with
/// those beside them: that saves comments and arcs but no moves, and is farther
/// off.
const ALIKE: f64 = 0.5;

/// How far a bead's pieces may be from what is meant.
struct Slack {
    height: Mm,
    /// The least width that counts: a share of next to nothing would be too
    /// little.
    narrowest: Mm,
    /// How far the middle of a line may be from the path; its edges, if they
    /// show.
    off: Mm,
    shows: bool,
    short: Mm,
    evened: Mm,
}

impl Slack {
    /// How far apart all widths along a piece of this length may be, `low` being
    /// the least of them.
    fn range(&self, low: Mm, length: Mm) -> Mm {
        let width = low.max(self.narrowest);
        // Where the width changes evenly by d along a piece, half of the piece
        // has d / 4 times its length too much or too little.
        let area = cross_section(width, self.height) / self.height;
        4.0 * AREA * area * (2.0 * self.evened / length).max(1.0)
    }

    /// How far a line of one width may be beside a place where another is meant.
    fn beside(&self, width: Mm, meant: Mm) -> Mm {
        if self.shows {
            self.off - 0.5 * (width - meant).abs()
        } else {
            self.off
        }
    }
}

/// A place where lines meet: a point near the path, and the number of the place
/// on the path beside it.
#[derive(Clone, Copy)]
pub(super) struct Joint {
    pub(super) at: DVec2,
    pub(super) place: usize,
}

/// The lines that replace a way.
pub(super) struct Lines<'a> {
    pub(super) way: &'a Way,
    slack: Slack,
}

impl<'a> Lines<'a> {
    /// The lines of a bead along its way. `off` is how far their middles may be
    /// from it; their edges, if they show.
    pub(super) fn of(way: &'a Way, bead: &Bead, off: Mm) -> Lines<'a> {
        let slack = Slack {
            height: bead.height,
            narrowest: 0.5 * bead.stroke.width,
            off,
            shows: bead.role.shows(),
            short: shortest(bead.role),
            evened: evened(bead.role),
        };
        Lines { way, slack }
    }

    /// All places where the lines meet. From each of them the next line leads as
    /// far as it can.
    pub(super) fn joints(&self) -> Vec<Joint> {
        let on = |place| Joint {
            at: self.way.points[place],
            place,
        };
        let mut from = on(0);
        let mut out = vec![from];
        for &corner in &self.way.corners {
            let mut like = 2;
            let first = out.len();
            while from.place < corner {
                let i = from.place;
                let (j, end) =
                    longest(i, corner, like, |j| self.reach(&from, j));
                from = Joint {
                    at: end.unwrap_or(self.way.points[j]),
                    place: j,
                };
                out.push(from);
                like = j - i;
            }
            if out.len() > first + 1 {
                self.share_last(&mut out);
            }
        }
        out
    }

    /// Where a line from a joint to the place `j` ends, if it can lead there.
    fn reach(&self, from: &Joint, j: usize) -> Option<DVec2> {
        let (way, i) = (self.way, from.place);
        let width = way.width(i, j);
        let [low, high] = self.slopes(from, way.points[j], j, width)?;
        let along = way.points[j] - from.at;
        // The next line has to begin here, and its width may change likewise.
        let next = way.widths[(j + (j - i) / 2).min(way.last())];
        let most = self.slack.beside(next, way.widths[j]).max(0.0);
        let most = if way.corners.binary_search(&j).is_ok() {
            0.0
        } else {
            most / along.length()
        };
        let slope = 0.0_f64.clamp(low, high);
        (slope.abs() <= most).then(|| way.points[j] + slope * along.perp())
    }

    /// How far a line between two places may be beside the path at least; none if
    /// their widths are too different for one line.
    fn least(&self, i: usize, j: usize) -> Option<Mm> {
        let (way, slack) = (self.way, &self.slack);
        let length = way.length(i, j);
        let [low, high] = way.extremes(i, j);
        if way.length(i, j - 1) < slack.short
            || j == way.last() && length < REST * slack.short
        {
            Some(0.5 * slack.off)
        } else {
            let fits = high - low <= slack.range(low, length);
            fits.then_some(f64::NEG_INFINITY)
        }
    }

    /// The places where arcs and lines along the path meet, each as long as it
    /// can be without being farther from it than `off`.
    pub(super) fn arcs(&self, off: Mm) -> Vec<usize> {
        let way = self.way;
        let arc = |i: usize, j: usize| {
            let width = way.width(i, j);
            let [low, high] = way.extremes(i, j);
            let beside = |meant| self.slack.beside(width, meant);
            let room = beside(low).min(beside(high)).max(self.least(i, j)?);
            arc::way(&way.points[i..=j], room.min(off))
        };
        let (mut at, mut like) = (0, 2);
        let mut out = vec![at];
        while at < way.last() {
            let (next, _) = longest(at, way.last(), like, |j| arc(at, j));
            like = next - at;
            at = next;
            out.push(at);
        }
        out
    }

    /// How far to the left a line of a width may end of the way from a joint to a
    /// point beside the place `j`, as the least and the greatest share of its
    /// length; none if it may not lead there.
    fn slopes(
        &self,
        from: &Joint,
        to: DVec2,
        j: usize,
        width: Mm,
    ) -> Option<[f64; 2]> {
        let (way, slack, i) = (self.way, &self.slack, from.place);
        let least = self.least(i, j)?;
        let room = |k: usize| slack.beside(width, way.widths[k]).max(least);
        if from.at.distance(way.points[i]) > room(i) {
            return None;
        }
        let along = (to - from.at).normalize_or_zero();
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut done = 0.0;
        for k in way.stops(i + 1, j) {
            let p = way.points[k] - from.at;
            let (on, left, room) = (along.dot(p), along.perp_dot(p), room(k));
            // A line must not lead back along the path.
            if on <= done {
                return None;
            }
            low = low.max((left - room) / on);
            high = high.min((left + room) / on);
            if low > high {
                return None;
            }
            done = on;
        }
        Some([low, high])
    }

    /// The least and the greatest width that a line may have.
    pub(super) fn widths(&self, ends: [Joint; 2]) -> [Mm; 2] {
        let (way, slack) = (self.way, &self.slack);
        let [i, j] = ends.map(|end| end.place);
        if !slack.shows {
            let [least, most] = way.extremes(i, j);
            let by = 0.5 * ALIKE * slack.range(least, way.length(i, j));
            return [most - by, least + by];
        }
        let along = (ends[1].at - ends[0].at).normalize_or_zero();
        let all = i..=j;
        all.fold([0.0, f64::INFINITY], |[low, high], k| {
            let left = along.perp_dot(way.points[k] - ends[0].at);
            let by = 2.0 * (slack.off - left.abs());
            let meant = way.widths[k];
            [low.max(meant - by), high.min(meant + by)]
        })
    }

    /// Makes the last two lines about equally long if the last one is short.
    fn share_last(&self, joints: &mut [Joint]) {
        let [.., a, b, c] = joints else {
            return;
        };
        let way = self.way;
        if way.length(b.place, c.place) >= 0.5 * way.length(a.place, b.place) {
            return;
        }
        let place = way.middle(a.place, c.place);
        let middle = Joint {
            at: way.points[place],
            place,
        };
        let fits = |a: &Joint, c: &Joint| {
            let width = way.width(a.place, c.place);
            let slopes = self.slopes(a, c.at, c.place, width);
            slopes.is_some_and(|[low, high]| low <= 0.0 && high >= 0.0)
        };
        if a.place < place
            && place < c.place
            && fits(a, &middle)
            && fits(&middle, c)
        {
            *b = middle;
        }
    }
}
