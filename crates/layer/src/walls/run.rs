//! Balls in a row: what becomes an axis.
//!
//! In: the balls of a ring of the border, in order. Out: runs of neighbours,
//! joined where one ends and another begins.

use super::ball::{BALL_STEP, Ball};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::grid::EdgeGrid;

/// Balls that follow each other along the border.
pub(super) struct Run {
    pub balls: Vec<Ball>,
    pub closed: bool,
}

/// Cuts a ring's balls into runs of neighbours.
pub(super) fn split_runs(
    balls: &[Option<Ball>],
    grid: &EdgeGrid,
    runs: &mut Vec<Run>,
) {
    let n = balls.len();
    let follows = |i: usize| {
        let (a, b) = (&balls[i % n], &balls[(i + 1) % n]);
        match (a, b) {
            (Some(a), Some(b)) => a.follows(b, grid),
            _ => false,
        }
    };
    // The runs are cut from a break on. If there is no break, the run is
    // closed.
    let Some(start) = (0..n).find(|&i| !follows(i)) else {
        let all: Vec<Ball> = balls.iter().copied().flatten().collect();
        if !all.is_empty() {
            runs.push(Run {
                balls: all,
                closed: true,
            });
        }
        return;
    };
    let mut run = Vec::new();
    for i in start + 1..=start + n {
        run.extend(balls[i % n]);
        if !follows(i) && !run.is_empty() {
            runs.push(Run {
                balls: std::mem::take(&mut run),
                closed: false,
            });
        }
    }
}

/// Joins runs that end where another begins: along a strip the balls change
/// sides where the border's numbering begins anew. Returns where more than two runs
/// meet, and two of them have been joined.
pub(super) fn join(runs: &mut Vec<Run>, grid: &EdgeGrid) -> Vec<DVec2> {
    let mut ends = Ends::new(runs);
    let mut nodes = Vec::new();
    let mut i = 0;
    while i < runs.len() {
        let next = ends.beside(&runs[i], i).into_iter().find_map(|j| {
            let (this, other) = (&runs[i], &runs[j]);
            let meeting = this.meets(other, grid)?;
            let link = meeting.link(this, other)?;
            let turns_back = meeting.turns_back(this, other);
            (!turns_back && !ends.crosses(link)).then_some((j, meeting))
        });
        let Some((j, meeting)) = next else {
            i += 1;
            continue;
        };
        let mut other = std::mem::take(&mut runs[j].balls);
        if meeting.turn_other {
            other.reverse();
        }
        let run = &mut runs[i].balls;
        if meeting.turn_this {
            run.reverse();
        }
        if let (Some(&a), Some(&b)) = (run.last(), other.first()) {
            ends.add_link((a.centre, b.centre));
            let middle = a.centre.midpoint(b.centre);
            if ends.around(middle, a.far()) > 2 {
                nodes.push(middle);
            }
            run.extend(between(a, b, grid));
        }
        run.extend(other);
        ends.owner[j] = i;
    }
    runs.retain(|r| !r.balls.is_empty());
    for run in runs {
        let (Some(&a), Some(&b)) = (run.balls.last(), run.balls.first()) else {
            continue;
        };
        let meet = !run.closed
            && a.meets(&b, grid)
            && run.length() > 8.0 * BALL_STEP
            && !ends.crosses((a.centre, b.centre));
        if meet {
            ends.add_link((a.centre, b.centre));
            run.balls.extend(between(a, b, grid));
            run.closed = true;
        }
    }
    nodes
}

/// The balls on the way from one to another, where runs are joined: they can
/// be larger than both, where strips meet.
fn between(a: Ball, b: Ball, grid: &EdgeGrid) -> impl Iterator<Item = Ball> {
    let count = if a.close(&b) {
        1.0
    } else {
        (a.centre.distance(b.centre) / BALL_STEP)
            .ceil()
            .clamp(1.0, 1e3)
    };
    let far = a.thickness + b.thickness;
    (1..count as usize).map(move |k| {
        let centre = a.centre.lerp(b.centre, k as f64 / count);
        let radius = match grid.nearest_edge(centre, far) {
            Some((_, q)) => q.distance(centre),
            None => far,
        };
        Ball {
            centre,
            thickness: 2.0 * radius,
        }
    })
}

/// The ends of runs, for asking which are near each other.
struct Ends {
    /// The ends as edges without length.
    grid: EdgeGrid,
    /// Farthest distance of ends that meet.
    reach: Mm,
    /// For each run, the run that it has been joined to; the run itself, if
    /// there is none.
    owner: Vec<usize>,
    /// For each run, the ways across from its ends to the beginnings of others.
    links: Vec<Vec<Link>>,
    /// Length of the longest of these ways.
    longest: Mm,
}

/// The way across from the end of a run to where another begins.
type Link = (DVec2, DVec2);

impl Ends {
    fn new(runs: &[Run]) -> Ends {
        let open = || {
            let all = runs.iter().enumerate().filter(|(_, r)| !r.closed);
            all.flat_map(|(i, r)| {
                let ends = r.balls.first().into_iter().chain(r.balls.last());
                ends.map(move |ball| (i, ball))
            })
        };
        let reach = open().map(|(_, ball)| ball.far()).fold(0.0, f64::max);
        let points = open().map(|(i, ball)| (i, (ball.centre, ball.centre)));
        Ends {
            grid: EdgeGrid::of(points, reach),
            reach,
            owner: (0..runs.len()).collect(),
            links: vec![Vec::new(); runs.len()],
            longest: 0.0,
        }
    }

    fn add_link(&mut self, link: Link) {
        self.longest = self.longest.max(link.0.distance(link.1));
        let mut near = Vec::new();
        let reach = 1e-6 * self.reach;
        self.grid
            .visit_near(link.0, link.0, reach, |j| near.push(j));
        for j in near {
            self.links[j].push(link);
        }
    }

    /// The number of ends that are no farther than `reach` from a place.
    fn around(&self, place: DVec2, reach: Mm) -> usize {
        let mut count = 0;
        self.grid.visit_near(place, place, reach, |_| count += 1);
        count
    }

    /// True if a way across crosses another one: of four strips that meet,
    /// two go on in one another, and what the other two share with them is
    /// laid once.
    fn crosses(&self, (a, b): Link) -> bool {
        let mut crosses = false;
        let left = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a) > 0.0;
        // A way that crosses this one begins no farther away than this. Ends lie a
        // hair from where they are looked for.
        let reach = 1.01 * (a.distance(b) + self.longest);
        self.grid.visit_near(a, a, reach, |j| {
            crosses |= self.links[j].iter().any(|&(c, d)| {
                left(a, b, c) != left(a, b, d) && left(c, d, a) != left(c, d, b)
            });
        });
        crosses
    }

    /// The runs that end near to where the `i`th does, in order.
    fn beside(&mut self, run: &Run, i: usize) -> Vec<usize> {
        let mut found = Vec::new();
        if !run.closed {
            for ball in run.balls.first().into_iter().chain(run.balls.last()) {
                let c = ball.centre;
                self.grid.visit_near(c, c, ball.far(), |j| found.push(j));
            }
        }
        for j in &mut found {
            while self.owner[*j] != *j {
                *j = self.owner[*j];
            }
        }
        found.sort_unstable();
        found.dedup();
        found.retain(|&j| j != i);
        found
    }
}

/// The runs that have to be turned for one to go on in another.
struct Meeting {
    turn_this: bool,
    turn_other: bool,
}

impl Meeting {
    /// The way across from one run to the other.
    fn link(&self, this: &Run, other: &Run) -> Option<Link> {
        let end = |run: &Run, last: bool| {
            let ball = if last {
                run.balls.last()
            } else {
                run.balls.first()
            };
            ball.map(|b| b.centre)
        };
        let from = end(this, !self.turn_this)?;
        Some((from, end(other, self.turn_other)?))
    }

    /// True if the other run leads back where this one comes from: it has the
    /// same axis, seen from the other side.
    fn turns_back(&self, this: &Run, other: &Run) -> bool {
        /// Cosine of the turn.
        const BACK: f64 = -0.8;
        let out = this.inwards(!self.turn_this);
        let inwards = other.inwards(self.turn_other);
        out.dot(inwards) > -BACK
    }
}

impl Ball {
    /// Greatest distance between the end of a run and the beginning of the run
    /// that continues it.
    fn far(&self) -> Mm {
        (1.5 * BALL_STEP).max(1.1 * self.thickness)
    }

    /// True if runs that end with these two are one.
    fn meets(&self, other: &Ball, grid: &EdgeGrid) -> bool {
        self.centre.distance_squared(other.centre) < self.far().powi(2)
            && (self.thickness - other.thickness).abs() < 0.4 * BALL_STEP
            && self.leads_to(other, grid)
    }

    /// True if two balls, one after the other along the border, are on one axis.
    pub(super) fn follows(&self, other: &Ball, grid: &EdgeGrid) -> bool {
        // Balls that are close together have only turned with the border.
        self.near(other) && (self.close(other) || self.leads_to(other, grid))
    }

    fn close(&self, other: &Ball) -> bool {
        let apart = self.centre.distance_squared(other.centre);
        apart < (1.5 * BALL_STEP).powi(2)
    }

    /// True if a bead from one to the other stays inside the border.
    fn leads_to(&self, other: &Ball, grid: &EdgeGrid) -> bool {
        /// Greatest length by which the bead may stick out, mm.
        const OUT: Mm = 0.01;
        let apart = self.centre.distance_squared(other.centre);
        let radius = 0.25 * (self.thickness + other.thickness) - OUT;
        apart < (0.5 * BALL_STEP).powi(2)
            || radius <= 0.0
            || grid
                .nearest_edge(self.centre.midpoint(other.centre), radius)
                .is_none()
    }
}

impl Run {
    /// The direction in which a run leads away from its last ball, or from its
    /// first; none if it is too short to tell.
    fn inwards(&self, last: bool) -> DVec2 {
        let n = self.balls.len();
        let at = |k: usize| self.balls[if last { n - 1 - k } else { k }].centre;
        let far = (0..n).find(|&k| at(k).distance(at(0)) > 0.5 * BALL_STEP);
        far.map_or(DVec2::ZERO, |k| (at(k) - at(0)).normalize_or_zero())
    }

    fn length(&self) -> Mm {
        self.balls
            .windows(2)
            .map(|w| w[0].centre.distance(w[1].centre))
            .sum()
    }

    /// True if a ball lies beside the run's last balls, or beside its first ones, and
    /// does not continue the run there.
    fn is_beside(&self, last: bool, ball: &Ball) -> bool {
        if last {
            behind(self.balls.iter().rev(), ball)
        } else {
            behind(self.balls.iter(), ball)
        }
    }

    fn meets(&self, other: &Run, grid: &EdgeGrid) -> Option<Meeting> {
        if self.closed || other.closed {
            return None;
        }
        let mine = (self.balls.first()?, self.balls.last()?);
        let theirs = (other.balls.first()?, other.balls.last()?);
        // Neither lies beside the other's end. A run of one ball has no direction of
        // its own: it must not continue the end of a run that it lies along.
        let meet = |turn_this: bool, turn_other: bool| {
            let this = if turn_this { mine.0 } else { mine.1 };
            let next = if turn_other { theirs.1 } else { theirs.0 };
            this.meets(next, grid)
                && !self.is_beside(!turn_this, next)
                && !other.is_beside(turn_other, this)
        };
        let ways = [false, true].map(|this| [false, true].map(|o| (this, o)));
        let mut ways = ways.into_iter().flatten();
        ways.find(|&(this, other)| meet(this, other)).map(
            |(turn_this, turn_other)| Meeting {
                turn_this,
                turn_other,
            },
        )
    }
}

/// True if a ball lies behind the first of some balls in a row, where the
/// others are.
fn behind<'a>(mut row: impl Iterator<Item = &'a Ball>, ball: &Ball) -> bool {
    let (Some(first), Some(second)) = (row.next(), row.next()) else {
        return false;
    };
    let away = ball.centre - first.centre;
    let back = second.centre - first.centre;
    // Corners of more than a right angle are axes, too.
    away.dot(back) > 0.5 * away.length() * back.length()
        && away.length_squared() > (0.5 * BALL_STEP).powi(2)
}
