//! The way through one island: its walls, what fills gaps between them, its
//! infill and its skin.

use super::begin::{begin_near, nearest_spot};
use super::islands::{Island, Loop};
use super::jobs::{Job, print};
use super::tour::{Stop, tour};
use super::{Context, OrderPlan, SEAM_REACH, sweep};
use glam::DVec2;
use isoslice_layer::skin::{Fill, Patch};
use isoslice_planar::bead::{Bead, Plane, Role};
use isoslice_planar::signed_area;

/// What is printed of an island, in its order.
#[derive(Clone, Default)]
pub(super) struct Inside {
    /// Walls that lie lower than the layer. The nozzle is low while it prints these:
    /// nothing may be beside them yet.
    low: Vec<Job>,
    /// Walls, gaps and infill, each with its stage.
    jobs: Vec<(u32, Job)>,
    skin: Vec<Patch>,
    /// Walls that nothing but the skin beside them holds.
    after_skin: Vec<(u32, Job)>,
}

impl Inside {
    pub(super) fn new(
        island: Island,
        context: Context<'_>,
        plan: &OrderPlan,
    ) -> Inside {
        let mut inside = Inside {
            skin: island.skin,
            ..Inside::default()
        };
        // Walls that pass no seam have a stage of their own, before all loops or
        // after them.
        let skin_holds = !context.supported && context.holds_some(&inside.skin);
        let stage = |inner_first| if inner_first { 0 } else { 2 };
        let away_stage = stage(plan.inner_first);
        for mut group in island.loops {
            group.walls.iter_mut().for_each(orient);
            let is_low = |wall: &mut Bead| wall.plane == Plane::HalfLower;
            let walls = group.walls.extract_if(.., is_low);
            inside.low.extend(walls.map(Job::of));
            let after_skin = skin_holds && context.hang_all_along(&group.walls);
            // The inner ones lie along the skin.
            let mut inner_first = plan.inner_first || after_skin;
            if plan.inner_first_at_overhangs || plan.turns_overhangs {
                let hangs =
                    group.walls.first().is_some_and(|w| context.hangs(w));
                inner_first |= hangs && plan.inner_first_at_overhangs;
                let odd = !context.here.span.index.is_multiple_of(2);
                if hangs && odd && plan.turns_overhangs {
                    group.walls.iter_mut().for_each(turn_round);
                }
            }
            let (job, away) =
                loop_job(group, inner_first, plan.begins_anywhere);
            let jobs = if after_skin {
                &mut inside.after_skin
            } else {
                &mut inside.jobs
            };
            jobs.extend(job.map(|job| (1, job)));
            let stage = stage(inner_first);
            jobs.extend(away.into_iter().map(|b| (stage, Job::of(b))));
        }
        // If there are such walls, gaps lie between them. Otherwise gaps can be
        // filled on the way through the infill.
        let jobs = &mut inside.jobs;
        let gap_stage = if jobs.iter().any(|j| j.0 == away_stage) {
            away_stage
        } else {
            3
        };
        let gaps = island.gaps.into_iter();
        jobs.extend(gaps.map(|b| (gap_stage, Job::of(b))));
        let infill = island.infill.into_iter();
        jobs.extend(infill.map(|b| (3, Job::of(b))));
        inside
    }

    /// Where printing is likely to start.
    pub(super) fn start(&self) -> Option<DVec2> {
        let first = self.jobs.iter().min_by_key(|job| job.0);
        let first = self.low.first().or(first.map(|job| &job.1))?;
        Some(first.ends()?.0)
    }

    /// Takes what is printed last and prints it on a short way to `to`, if the head
    /// comes from `at`.
    pub(super) fn print_last(
        &mut self,
        mut at: Option<DVec2>,
        to: Option<DVec2>,
    ) -> Vec<Bead> {
        let last = self.jobs.iter().map(|job| job.0).max();
        let jobs = if self.skin.is_empty() {
            self.jobs
                .extract_if(.., |job| Some(job.0) == last)
                .collect()
        } else {
            Vec::new()
        };
        let last = Inside {
            low: Vec::new(),
            jobs,
            skin: std::mem::take(&mut self.skin),
            after_skin: std::mem::take(&mut self.after_skin),
        };
        // The others are put in order once more when it is known where the head
        // comes from. Where they end now is a good guess of where they will end.
        self.clone().print(&mut at, None, &mut Vec::new());
        let mut out = Vec::new();
        last.print(&mut at, to, &mut out);
        out
    }

    /// Prints all of it on a short way from where the head is, `at`, to `to`.
    pub(super) fn print(
        self,
        at: &mut Option<DVec2>,
        to: Option<DVec2>,
        out: &mut Vec<Bead>,
    ) {
        let low = self.low.into_iter().map(|job| (0, job)).collect();
        print(low, at, None, out);
        let (jobs, skin) = (self.jobs, self.skin);
        if skin.is_empty() {
            return print(jobs, at, to, out);
        }
        print(jobs, at, None, out);
        if self.after_skin.is_empty() {
            return print_skin(skin, at, to, out);
        }
        print_skin(skin, at, None, out);
        print(self.after_skin, at, to, out);
    }
}

/// True for an open outer wall that goes round, as one does that is open at a
/// tip. Its ends are near each other, so that no way is saved by turning it
/// round.
fn goes_round(wall: &Bead) -> bool {
    /// Share of the wall's length up to which its ends are near.
    const NEAR: f64 = 0.25;
    let stroke = &wall.stroke;
    let near = |(a, b): (DVec2, DVec2)| a.distance(b) <= NEAR * stroke.length();
    wall.role == Role::OuterWall
        && !stroke.closed
        && stroke.ends().is_some_and(near)
}

/// Lets a wall that goes round do so in one direction in all layers.
fn orient(wall: &mut Bead) {
    if goes_round(wall) && signed_area(&wall.stroke.points) < 0.0 {
        wall.stroke.reverse();
    }
}

/// Turns a bead round; a closed one begins where it did.
fn turn_round(bead: &mut Bead) {
    let stroke = &mut bead.stroke;
    stroke.reverse();
    if stroke.closed {
        let last = stroke.points.len().saturating_sub(1);
        stroke.begin_at(last);
    }
}

/// A loop's walls that pass its seam, in their order, and the loop's other
/// walls. A closed outer wall may begin `anywhere`.
fn loop_job(
    group: Loop,
    inner_first: bool,
    anywhere: bool,
) -> (Option<Job>, Vec<Bead>) {
    let mut walls = group.walls.into_iter();
    let Some(outer) = walls.next() else {
        return (None, Vec::new());
    };
    let (mut beside, mut away) = (Vec::new(), Vec::new());
    let anywhere = outer.stroke.closed && anywhere;
    let seam = outer.stroke.points.first().copied();
    let seam = seam.filter(|_| outer.stroke.closed);
    for mut wall in walls {
        let spot = seam
            .filter(|_| wall.stroke.closed)
            .and_then(|seam| Some((seam, nearest_spot(&wall.stroke, seam)?)));
        match spot {
            Some((seam, spot)) if seam.distance(spot.at) <= SEAM_REACH => {
                begin_near(&mut wall.stroke, seam);
                beside.push(wall);
            }
            _ => away.push(wall),
        }
    }
    let leader = if inner_first { beside.len() } else { 0 };
    if inner_first {
        beside.reverse();
        beside.push(outer);
    } else {
        beside.insert(0, outer);
    }
    let job = match (anywhere, beside.as_slice()) {
        (true, _) => Job::rings(beside, leader),
        (false, [one]) if !one.stroke.closed && !goes_round(one) => {
            Job::of(beside.swap_remove(0))
        }
        // A ring without a seam of its own may begin anywhere, too.
        (false, [one]) if one.role != Role::OuterWall => Job::rings(beside, 0),
        _ => Job::Fixed(beside),
    };
    (Some(job), away)
}

/// Prints skins, one after the other.
fn print_skin(
    skin: Vec<Patch>,
    at: &mut Option<DVec2>,
    to: Option<DVec2>,
    out: &mut Vec<Bead>,
) {
    let mut stops = Vec::new();
    let mut patches = Vec::new();
    for patch in skin {
        let first = patch.first().and_then(|bead| bead.stroke.points.first());
        if let Some(&p) = first {
            stops.push(Stop::at(p));
            patches.push(Some(patch));
        }
    }
    let mut jobs: Vec<(u32, Job)> = Vec::new();
    let mut stage = 0;
    for visit in tour(&stops, *at, to) {
        let Some(patch) = patches[visit.stop].take() else {
            continue;
        };
        // The rings around a patch come first. Beads in the middle of thin
        // places can wait.
        for ring in patch.rings {
            let later = u32::from(!ring.stroke.closed);
            jobs.push((stage + later, Job::of(ring)));
        }
        stage += 1;
        for fill in patch.fills {
            if !fill.after.is_empty() {
                print(std::mem::take(&mut jobs), at, None, out);
                sweep::print(fill, at, out);
                continue;
            }
            stage += u32::from(!hidden(&fill));
            let beads = fill.lines.into_iter();
            jobs.extend(beads.map(|b| (stage, Job::of(b))));
        }
        stage += 1;
    }
    print(jobs, at, to, out);
}

/// True if a fill's beads may be printed together with the beads beside them:
/// they are neither seen nor do they hang.
fn hidden(fill: &Fill) -> bool {
    let hidden = |b: &Bead| {
        matches!(
            b.role,
            Role::InternalSkin | Role::BottomSkin | Role::GapFill
        )
    };
    fill.lines.iter().all(hidden)
}
