//! Balls in a row: what becomes a ridge.
//!
//! In: the balls of a ring of the border, in order. Out: runs of neighbours,
//! joined where one ends and another begins.

use super::ball::{Ball, STEP};
use crate::plane::grid::EdgeGrid;
use crate::units::Mm;

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
            // Close together, they have turned with the border.
            (Some(a), Some(b)) => {
                a.near(b) && (a.close(b) || a.leads_to(b, grid))
            }
            _ => false,
        }
    };
    // Begin behind a break; without one the run is closed.
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
/// sides where the border's numbering begins anew.
pub(super) fn join(runs: &mut Vec<Run>, grid: &EdgeGrid) {
    let mut ends = Ends::new(runs);
    let mut i = 0;
    while i < runs.len() {
        let next = ends
            .beside(&runs[i], i)
            .into_iter()
            .find_map(|j| Some((j, runs[i].meets(&runs[j], grid)?)));
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
        run.extend(other);
        ends.owner[j] = i;
    }
    runs.retain(|r| !r.balls.is_empty());
    for run in runs {
        let ends = (run.balls.first(), run.balls.last());
        let meet = matches!(ends, (Some(a), Some(b)) if a.meets(b, grid));
        run.closed |= meet && run.length() > 8.0 * STEP;
    }
}

/// Where runs end.
struct Ends {
    /// The ends as edges without length.
    grid: EdgeGrid,
    /// Farthest distance of ends that meet.
    reach: Mm,
    /// By run, the one it has been joined to; itself, if to none.
    owner: Vec<usize>,
}

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
        }
    }

    /// The runs that end near to where the `i`th does, in order.
    fn beside(&mut self, run: &Run, i: usize) -> Vec<usize> {
        let mut found = Vec::new();
        if !run.closed {
            for ball in run.balls.first().into_iter().chain(run.balls.last()) {
                let c = ball.centre;
                self.grid.visit_near(c, c, self.reach, |j| found.push(j));
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

/// What has to be turned for one run to go on in another.
struct Meeting {
    turn_this: bool,
    turn_other: bool,
}

impl Ball {
    /// How far the end of a run may be from where another goes on.
    fn far(&self) -> Mm {
        (1.5 * STEP).max(1.1 * self.thickness)
    }

    /// True if runs that end with these two are one.
    fn meets(&self, other: &Ball, grid: &EdgeGrid) -> bool {
        self.centre.distance_squared(other.centre) < self.far().powi(2)
            && (self.thickness - other.thickness).abs() < 0.4 * STEP
            && self.leads_to(other, grid)
    }

    fn close(&self, other: &Ball) -> bool {
        let apart = self.centre.distance_squared(other.centre);
        apart < (1.5 * STEP).powi(2)
    }

    /// True if a bead from one to the other stays inside the border.
    fn leads_to(&self, other: &Ball, grid: &EdgeGrid) -> bool {
        /// By how much it may stick out, mm.
        const OUT: Mm = 0.01;
        let apart = self.centre.distance_squared(other.centre);
        let radius = 0.25 * (self.thickness + other.thickness) - OUT;
        apart < (0.5 * STEP).powi(2)
            || radius <= 0.0
            || grid
                .nearest_edge(self.centre.midpoint(other.centre), radius)
                .is_none()
    }
}

impl Run {
    fn length(&self) -> Mm {
        self.balls
            .windows(2)
            .map(|w| w[0].centre.distance(w[1].centre))
            .sum()
    }

    /// True if a ball lies beside the run's last balls and does not continue
    /// the run.
    fn is_beside_end(&self, ball: &Ball) -> bool {
        behind(self.balls.iter().rev(), ball)
    }

    /// True if a ball lies beside the run's first balls and does not lead to
    /// them.
    fn is_beside_beginning(&self, ball: &Ball) -> bool {
        behind(self.balls.iter(), ball)
    }

    fn meets(&self, other: &Run, grid: &EdgeGrid) -> Option<Meeting> {
        if self.closed || other.closed {
            return None;
        }
        let mine = (self.balls.first()?, self.balls.last()?);
        let theirs = (other.balls.first()?, other.balls.last()?);
        let turned = |turn_this, turn_other| {
            Some(Meeting {
                turn_this,
                turn_other,
            })
        };
        let last = |ball: &Ball| !self.is_beside_end(ball);
        let first = |ball: &Ball| !self.is_beside_beginning(ball);
        if mine.1.meets(theirs.0, grid) && last(theirs.0) {
            turned(false, false)
        } else if mine.1.meets(theirs.1, grid) && last(theirs.1) {
            turned(false, true)
        } else if mine.0.meets(theirs.0, grid) && first(theirs.0) {
            turned(true, false)
        } else if mine.0.meets(theirs.1, grid) && first(theirs.1) {
            turned(true, true)
        } else {
            None
        }
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
    // Corners of more than a right angle are ridges, too.
    away.dot(back) > 0.5 * away.length() * back.length()
        && away.length_squared() > (0.5 * STEP).powi(2)
}
