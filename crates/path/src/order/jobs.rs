//! Jobs, and the order in which they are printed.
//!
//! A job is what is printed without choice once it has begun: a bead that may
//! be turned round, a ring that may begin anywhere, a few beads one after the
//! other.

use super::begin::{Spot, begin_at, begin_near, nearest_spot, spot_between};
use super::tour::{Stop, tour};
use glam::DVec2;
use isoslice_planar::bead::{Bead, Role};

/// Something to print.
#[derive(Clone)]
pub(super) enum Job {
    /// An open bead, printed from either end.
    Line(Bead),
    /// Beads in this order. The closed ones begin near one place of the
    /// `leader`th bead, wherever it is.
    Rings {
        beads: Vec<Bead>,
        leader: usize,
        spot: Option<Spot>,
    },
    /// Beads in this order, unchanged.
    Fixed(Vec<Bead>),
}

impl Job {
    /// A bead that may begin at either end, or anywhere if it is closed.
    pub(super) fn of(bead: Bead) -> Job {
        if bead.stroke.closed {
            Job::rings(vec![bead], 0)
        } else {
            Job::Line(bead)
        }
    }

    /// Beads that may begin anywhere, but all near one place.
    pub(super) fn rings(beads: Vec<Bead>, leader: usize) -> Job {
        Job::Rings {
            beads,
            leader,
            spot: None,
        }
    }

    /// Where the job begins and ends; nothing if that is not known yet.
    pub(super) fn ends(&self) -> Option<(DVec2, DVec2)> {
        match self {
            Job::Line(bead) => bead.stroke.ends(),
            Job::Rings {
                beads,
                leader,
                spot,
            } => {
                let first = beads.get(*leader)?.stroke.points.first();
                let at = spot.map(|s| s.at).or(first.copied())?;
                Some((at, at))
            }
            Job::Fixed(beads) => {
                let from = beads.first()?.stroke.points.first()?;
                Some((*from, end(beads.last()?)?))
            }
        }
    }

    /// Lets rings begin between two places, or near one if only one is known.
    fn settle(&mut self, before: Option<DVec2>, after: Option<DVec2>) {
        let Job::Rings {
            beads,
            leader,
            spot,
        } = self
        else {
            return;
        };
        let Some(ring) = beads.get(*leader) else {
            return;
        };
        // A wall begins where the nozzle comes from, whatever follows.
        let after = after.filter(|_| ring.role != Role::OuterWall);
        *spot = match (before, after) {
            (Some(a), Some(b)) => spot_between(&ring.stroke, a, b),
            (Some(p), None) | (None, Some(p)) => nearest_spot(&ring.stroke, p),
            (None, None) => None,
        };
    }

    /// The job's beads in print order.
    fn beads(self, turned: bool) -> Vec<Bead> {
        match self {
            Job::Line(mut bead) => {
                if turned {
                    bead.stroke.reverse();
                }
                vec![bead]
            }
            Job::Rings {
                mut beads,
                leader,
                spot,
            } => {
                let Some(spot) = spot else { return beads };
                for (i, bead) in beads.iter_mut().enumerate() {
                    if bead.stroke.closed && i == leader {
                        begin_at(&mut bead.stroke, spot);
                    } else if bead.stroke.closed {
                        begin_near(&mut bead.stroke, spot.at);
                    }
                }
                beads
            }
            Job::Fixed(beads) => beads,
        }
    }
}

/// Where a bead ends.
pub(super) fn end(bead: &Bead) -> Option<DVec2> {
    bead.stroke.ends().map(|ends| ends.1)
}

/// Prints jobs, those of lower stages first, on a short way from where the
/// head is, `at`, to `to`.
pub(super) fn print(
    jobs: Vec<(u32, Job)>,
    at: &mut Option<DVec2>,
    to: Option<DVec2>,
    out: &mut Vec<Bead>,
) {
    let mut jobs: Vec<(u32, Job)> =
        jobs.into_iter().filter(|j| j.1.ends().is_some()).collect();
    let anywhere = |j: &(u32, Job)| matches!(j.1, Job::Rings { .. });
    if jobs.iter().any(anywhere) {
        // At first each ring begins as if it came right after the head. Then it
        // begins where it suits the jobs before and after it.
        for (_, job) in &mut jobs {
            job.settle(*at, None);
        }
        let order = tour_of(&jobs, *at, to);
        settle_rings(&mut jobs, &order, *at, to);
    }
    let order = tour_of(&jobs, *at, to);
    settle_rings(&mut jobs, &order, *at, to);
    let mut jobs: Vec<Option<Job>> =
        jobs.into_iter().map(|j| Some(j.1)).collect();
    for (i, turned) in order {
        let beads = jobs[i].take().map(|job| job.beads(turned));
        for bead in beads.into_iter().flatten() {
            finish(bead, at, out);
        }
    }
}

/// Prints one bead.
pub(super) fn finish(bead: Bead, at: &mut Option<DVec2>, out: &mut Vec<Bead>) {
    if let Some(p) = end(&bead) {
        *at = Some(p);
        out.push(bead);
    }
}

/// The jobs' indices in print order, and for each whether it is turned round.
fn tour_of(
    jobs: &[(u32, Job)],
    at: Option<DVec2>,
    to: Option<DVec2>,
) -> Vec<(usize, bool)> {
    let stops: Vec<Stop> = jobs
        .iter()
        .filter_map(|(stage, job)| {
            let (from, to) = job.ends()?;
            Some(Stop {
                from,
                to,
                turns: matches!(job, Job::Line(_)),
                stage: *stage,
            })
        })
        .collect();
    let visits = tour(&stops, at, to).into_iter();
    visits
        .map(|v| (v.stop, v.turned && stops[v.stop].turns))
        .collect()
}

/// Lets rings begin where the ways to and from them are shortest.
fn settle_rings(
    jobs: &mut [(u32, Job)],
    order: &[(usize, bool)],
    at: Option<DVec2>,
    to: Option<DVec2>,
) {
    let ends = |jobs: &[(u32, Job)], (i, turned): (usize, bool)| {
        jobs[i]
            .1
            .ends()
            .map(|(a, b)| if turned { (b, a) } else { (a, b) })
    };
    let mut before = at;
    for (k, &visit) in order.iter().enumerate() {
        let after = match order.get(k + 1) {
            Some(&next) => ends(jobs, next).map(|e| e.0),
            None => to,
        };
        jobs[visit.0].1.settle(before, after);
        before = ends(jobs, visit).map(|e| e.1);
    }
}
