//! Speeds, cooling and time: how fast each move of a layer is run.
//!
//! In: the [`Stretch`]es of each layer, in print order. [`Stretch::rated`] tells how
//! fast their beads may be, on any thread, and [`Pacer`] how fast they are, layer by
//! layer. Out: a [`PacedLayer`]
//! for each: the moves with their speeds and, between them, every step that the
//! machine needs: retractions, primings and moves of z.
//!
//! Guarantees:
//! - a bead runs at its role's speed and acceleration. It is no faster than
//!   `speed.first_layer` on the first layer, than `speed.small_wall` if it is a
//!   short closed wall, than the hot end melts (`filament.max_flow`), and than
//!   the firmware takes its moves (`printer.max_moves_per_second`). Along a
//!   stroke the flow changes no faster than `filament.max_flow_change`. If the
//!   layer would take less than `cooling.min_layer_time` beads are slower,
//!   down to `cooling.min_speed`: the fastest first, and outer walls last;
//! - the fan runs faster on layers that take little time, and comes up in steps
//!   above the layers without it;
//! - a retraction is primed before the next bead, at the latest at the layer's
//!   end, and is never repeated;
//! - z rises before the head travels, and is the layer's top while it prints, or
//!   what the levels of a bead tell;
//! - the head stands at a bead's first point when the bead begins;
//! - a layer depends on nothing of the layers before it but where the last of them
//!   has ended, and on nothing at all after [`Pacer::forget`];
//! - the same layers give the same numbers.
//!
//! Not guaranteed: that a layer takes `cooling.min_layer_time`; with all beads
//! at `cooling.min_speed` it may still be shorter. The times are without
//! heating, homing and the start and end templates.
//!
//! Times come from the [motion model](motion), for the points as they are
//! written, in micrometres, since these are the corners that firmware sees. A
//! layer starts and ends at rest, so its time does not depend on its
//! neighbours. This costs some milliseconds a layer, since the change of z
//! between layers is slow anyway. The `clock` reads the time of everything else
//! from the text.

mod bounds;
pub mod clock;
mod fan;
mod flow_smoothing;
pub mod motion;
mod move_rate;
mod moves;
mod plan;
pub mod rates;
mod slowing;
mod stretch;

pub use plan::{PacePlan, limits};
pub use stretch::{RatedStretch, Stretch};

pub use moves::Amount;
pub use moves::Cause;
pub use moves::{OfPart, PacedLayer, PacedMove, Sums};

use crate::travel::LayerPath;
use crate::travel::Travel;
use bounds::acceleration;
use fan::fan_speed;
use flow_smoothing::smoothed;
use glam::{DVec2, DVec3};
use isoslice_base::timings::Timings;
use isoslice_base::units::{
    MICRON, Mm, Mm2, MmPerSec, MmPerSec2, Percent, Seconds,
};
use isoslice_model::expressions::QuantityError;
use isoslice_planar::bead::{Bead, Role};
use isoslice_planar::path_length;
use isoslice_settings::layers::LayerSpan;
use motion::{Limits, Motion};
use move_rate::{Rated, slowed};
use rates::{Rater, Site};
use slowing::{Slowing, slow_down};
use std::ops::Range;
use stretch::Step;

/// Height above the first layer at which the head comes from where the start
/// template left it, mm. It clears what start templates leave on the bed.
pub const APPROACH: Mm = 2.0;

/// Distance up to which two points are one place: what the G-code resolves. A
/// move between such points would stop the head for nothing.
const SAME_PLACE: Mm = MICRON;

/// Difference up to which two heights are one: 0.1 of what the G-code resolves.
const SAME_HEIGHT: Mm = 0.1 * MICRON;

/// Share of `cooling.min_layer_time` below which a layer is told of as short.
const MUCH_LESS: f64 = 0.8;

/// Speed of a wipe as a share of that of travels. It is slower because it
/// touches what has just been printed.
const WIPE_SPEED: f64 = 0.8;

/// Gives speeds to one layer after another. Between two layers it knows where
/// the head stands.
pub struct Pacer<'a> {
    /// The plan of the stretch that is being paced.
    plan: &'a PacePlan,
    motion: Motion,
    /// Where the head is; none before the first move.
    xy: Option<DVec2>,
    z: Option<Mm>,
    retracted: bool,
    /// How far the highest bead of the layer so far reaches above the layer's
    /// top, mm.
    raised: Mm,
    /// True if the head stands where a bead ended that is not level.
    on_slope: bool,
    /// True during a hop and during the approach to the first layer.
    lifted: bool,
    /// The fan's speed as last set in the layer.
    fan: Percent,
    /// The layer's beads so far.
    printed: Vec<Printed>,
}

/// A bead of the layer.
struct Printed {
    role: Role,
    /// Length and filament.
    amount: Amount,
    /// The segments of `motion`.
    segments: Range<usize>,
    /// Number of the bead's moves.
    moves: usize,
    /// The speed asked for, and what has made it less before cooling.
    wanted: MmPerSec,
    by: Option<Cause>,
}

impl<'a> Pacer<'a> {
    /// A pacer for a print from the bed up.
    pub fn new(plan: &'a PacePlan) -> Self {
        Self {
            plan,
            motion: Motion::new(plan.limits, plan.limits.travel_acceleration),
            xy: None,
            z: None,
            retracted: false,
            raised: 0.0,
            on_slope: false,
            lifted: false,
            fan: 0.0,
            printed: Vec::new(),
        }
    }

    /// Forgets where the head is in the plane, at height `z`. The way to the next
    /// layer's first point counts for no layer's time.
    pub fn forget(&mut self, z: Mm) {
        self.xy = None;
        self.z = Some(z);
        self.lifted = false;
        self.on_slope = false;
        self.motion.tell(self.plan.limits.travel_acceleration);
    }

    /// Gives the next layer of a single part its speeds, of which nothing varies.
    ///
    /// # Errors
    /// If a setting is an expression.
    pub fn alone(
        &mut self,
        path: LayerPath,
    ) -> Result<PacedLayer, QuantityError> {
        let rater = Rater::constant(self.plan)?;
        let stretch = Stretch {
            place: Some(0),
            moves: path.moves,
            rater: &rater,
            site: Site::default(),
        };
        let rated = stretch.rated(&path.span, &Timings::default())?;
        self.layer(path.span, vec![rated], &rater)
    }

    /// Gives the next layer its speeds. Layers must come in print order.
    /// `whole` has the rates that hold for all of the layer.
    ///
    /// # Errors
    /// If a setting that is an expression has no value somewhere.
    pub fn layer(
        &mut self,
        span: LayerSpan,
        stretches: Vec<RatedStretch<'a>>,
        whole: &Rater<'a>,
    ) -> Result<PacedLayer, QuantityError> {
        let from_anywhere = self.xy.is_none();
        self.motion.clear();
        self.printed.clear();
        self.raised = 0.0;
        let mut fan = whole.fan(&span).unwrap_or(f64::NAN);
        self.fan = fan;
        let count: usize = stretches.iter().map(|s| s.steps.len()).sum();
        let mut out = Vec::with_capacity(count + 8);
        let mut parts = Vec::with_capacity(stretches.len());
        for stretch in stretches {
            let (place, first) = (stretch.place, out.len());
            self.stretch(&span, stretch, &mut out);
            let moves = first..out.len();
            parts.push(OfPart { place, moves });
        }
        self.plan = whole.plan;
        if fan.is_nan() {
            // The fan's speed for the first bead holds from the layer's
            // beginning.
            let first = |m: &PacedMove| matches!(m, PacedMove::Fan(_));
            let at = out.iter().position(first);
            fan = match at.map(|i| out.remove(i)) {
                Some(PacedMove::Fan(speed)) => speed,
                _ => 0.0,
            };
            for OfPart { moves, .. } in &mut parts {
                let moved =
                    |k: usize| k - usize::from(at.is_some_and(|i| i < k));
                *moves = moved(moves.start)..moved(moves.end);
            }
        }
        self.prime(&mut out);
        if let Some(last) = parts.last_mut() {
            last.moves.end = out.len();
        }
        let cooling = &self.plan.cooling;
        let (slowing, time) = slow_down(&mut self.motion, cooling);
        let fan_at = |asked| fan_speed(asked, span.index, time, cooling);
        for step in &mut out {
            match step {
                PacedMove::Print { bead, speed, .. } => {
                    *speed = slowing.apply(*speed, is_spared(bead));
                }
                PacedMove::Fan(speed) => *speed = fan_at(*speed),
                _ => {}
            }
        }
        fan = fan_at(fan);
        let mut sums = self.sums(slowing);
        let is_short = time < MUCH_LESS * cooling.min_layer_time;
        sums.short = (is_short && sums.printing > 0).then_some((1, time));
        Ok(PacedLayer {
            span,
            before: 0,
            from_anywhere,
            moves: out,
            parts,
            fan,
            nozzle_temperature: whole.temperature(&span)?,
            time,
            sums,
        })
    }

    /// What the layer's beads amount to, as they are slowed.
    fn sums(&mut self, slowing: Slowing) -> Sums {
        let times: Vec<Seconds> = slowing.times(&mut self.motion).collect();
        let segments = self.motion.segments();
        let cruising = segments.iter().map(|s| s.length / slowing.speed(s));
        let more = times.iter().sum::<Seconds>() - cruising.sum::<Seconds>();
        let mut sums = Sums::default();
        sums.lost.insert(Cause::Acceleration, more.max(0.0));
        for printed in &self.printed {
            let of_bead = times.get(printed.segments.clone());
            let sum = sums.amounts.entry(printed.role).or_default();
            sum.time += of_bead.unwrap_or_default().iter().sum::<Seconds>();
            sum.length += printed.amount.length;
            sum.filament += printed.amount.filament;
            let of_bead = segments.get(printed.segments.clone());
            let of_bead = of_bead.unwrap_or_default();
            let cools = of_bead.iter().any(|s| slowing.speed(s) < s.speed);
            let cause = if cools {
                Some(Cause::Cooling)
            } else {
                printed.by
            };
            sums.printing += printed.moves;
            if cause == Some(Cause::Moves) {
                sums.slowed += printed.moves;
            }
            let Some(cause) = cause else { continue };
            let lost = of_bead.iter().map(|s| {
                let speed = slowing.speed(s);
                s.length / speed - s.length / printed.wanted.max(speed)
            });
            *sums.lost.entry(cause).or_default() += lost.sum::<Seconds>();
        }
        sums
    }

    /// Paces a stretch of a layer.
    fn stretch(
        &mut self,
        span: &LayerSpan,
        stretch: RatedStretch<'a>,
        out: &mut Vec<PacedMove>,
    ) {
        self.plan = stretch.plan;
        // Beads that follow each other without a travel.
        let mut chain = Vec::new();
        for step in stretch.steps {
            if isoslice_base::limits::is_stopped() {
                break;
            }
            match step {
                Step::Travel(travel) => {
                    self.print_all(span, &mut chain, out);
                    self.travel(span, travel, out);
                }
                Step::Print(mut pieces) => chain.append(&mut pieces),
            }
        }
        self.print_all(span, &mut chain, out);
    }

    fn travel(
        &mut self,
        span: &LayerSpan,
        travel: Travel,
        out: &mut Vec<PacedMove>,
    ) {
        let Travel {
            wipe,
            points,
            retract,
            hop,
            clear,
        } = travel;
        // Without a retraction, no way is left of one that goes nowhere.
        let stays = |at: DVec2| points.iter().all(|p| near(at, *p));
        let nowhere = !retract && clear.is_none();
        if points.is_empty() || nowhere && self.xy.is_some_and(stays) {
            return;
        }
        let plan = self.plan;
        if std::mem::take(&mut self.on_slope) {
            // A level wipe would cut into what rises beside it.
            self.lift(span.top + self.raised, out);
        }
        if retract && !self.retracted {
            self.retract(wipe, out);
            self.lifted |= hop && plan.retract.z_hop > 0.0;
        }
        let mut hop = plan.retract.z_hop.max(0.0);
        if self.z.is_none() {
            self.lifted = true;
            hop = hop.max(APPROACH);
        } else if let (true, Some(z)) = (self.lifted, self.z) {
            // Further travels of a hop stay at its height.
            hop = hop.max(z - span.top - self.raised);
        }
        let low = span.top + self.raised;
        if let Some(clear) = clear {
            self.lifted = true;
            hop = hop.max(clear - low);
        }
        // A hop may not leave the machine.
        let ceiling = plan.height.max(low);
        let z = if self.lifted {
            (low + hop).min(ceiling)
        } else {
            low
        };
        self.lift(z, out);
        let speed = plan.travel_speed;
        let acceleration = plan.limits.travel_acceleration;
        for &to in &points {
            self.go(to, speed, acceleration, 0.0, false);
        }
        out.push(PacedMove::Travel { points, speed });
    }

    /// Prints beads that follow each other without a travel.
    fn print_all(
        &mut self,
        span: &LayerSpan,
        chain: &mut Vec<Rated>,
        out: &mut Vec<PacedMove>,
    ) {
        let plan = self.plan;
        let times = |chain: &[Rated]| times(chain, span, plan);
        let beads = slowed(std::mem::take(chain), plan.max_moves, times);
        for rated in smoothed(beads, self.plan.max_flow_change) {
            self.print(span, rated, out);
        }
    }

    fn print(
        &mut self,
        span: &LayerSpan,
        rated: Rated,
        out: &mut Vec<PacedMove>,
    ) {
        let Rated {
            bead,
            turns,
            rates,
            wanted,
            by,
        } = rated;
        let plan = self.plan;
        let stroke = &bead.stroke;
        let Some(&start) = stroke.points.first() else {
            return;
        };
        if stroke.points.len() < 2 {
            return;
        }
        if !self.xy.is_some_and(|at| near(at, start)) {
            // The travel stage should have left a travel here. A straight
            // travel is better than a bead drawn from the wrong place.
            self.travel(span, Travel::straight(start, false), out);
        }
        self.lifted = false;
        let level = |rise: Option<Mm>| span.top + rise.unwrap_or(0.0);
        self.lift(level(stroke.rise(0)), out);
        self.prime(out);
        if rates.fan != self.fan {
            self.fan = rates.fan;
            out.push(PacedMove::Fan(rates.fan));
        }
        let speed = rates.speed;
        let acceleration = acceleration(bead.role, span, plan);
        let filament = |area: Mm2| area * rates.flow / plan.filament_area;
        self.xy = Some(start);
        let first = self.motion.segments().len();
        let mut amount = Amount::default();
        for (i, (from, to)) in stroke.segments().enumerate() {
            let mut add = |way: Mm, filament: f64| {
                amount.length += way;
                amount.filament += way * filament;
            };
            if let Some(rise) = stroke.rise(i + 1) {
                let fed = filament(bead.area_along(i));
                let up = rise - stroke.rise(i).unwrap_or(rise);
                add(from.distance(to).hypot(up), fed);
                let to = to.extend(level(Some(rise)));
                self.go_up(to, speed, acceleration, fed, true);
                continue;
            }
            let filament = filament(bead.area());
            let Some(turn) = turns.get(i).copied().flatten() else {
                add(from.distance(to), filament);
                self.go(to, speed, acceleration, filament, true);
                continue;
            };
            add(turn.length(from), filament);
            let chord = self.motion.chord(turn.radius(from));
            let count = (turn.length(from) / chord).ceil().max(1.0);
            for p in turn.chords(from, to, count as usize) {
                self.go(p, speed, acceleration, filament, true);
            }
        }
        let segments = first..self.motion.segments().len();
        if is_spared(&bead) {
            self.motion.spare(segments.clone());
        }
        self.printed.push(Printed {
            role: bead.role,
            amount,
            segments,
            moves: stroke.segments().count(),
            wanted,
            by,
        });
        self.on_slope = !stroke.levels.is_empty();
        let rises = stroke.levels.iter().map(|l| l.rise);
        self.raised = rises.fold(self.raised, f64::max);
        out.push(PacedMove::Print {
            bead,
            turns,
            speed,
            acceleration,
            flow: rates.flow,
        });
    }

    /// Pulls the filament back, a part of it before the wipe and the rest
    /// during the wipe.
    fn retract(&mut self, wipe: Vec<DVec2>, out: &mut Vec<PacedMove>) {
        let retract = &self.plan.retract;
        if retract.length <= 0.0 {
            return;
        }
        self.retracted = true;
        let wiping = self.xy.filter(|_| !wipe.is_empty());
        let way = wiping.map_or(0.0, |from| {
            from.distance(wipe[0]) + path_length(&wipe, false)
        });
        // Firmware that retracts by itself does so while the head stands.
        let first = if way > SAME_PLACE && !retract.firmware {
            retract.length * retract.before_wipe / 100.0
        } else {
            retract.length
        };
        if first > 0.0 {
            self.motion.push_filament(-first, retract.speed);
            out.push(PacedMove::Retract {
                length: first,
                speed: retract.speed,
            });
        }
        if way <= SAME_PLACE {
            return;
        }
        let rest = retract.length - first;
        // The wipe is no faster than the filament may be pulled back.
        let speed = (WIPE_SPEED * self.plan.travel_speed)
            .min(retract.speed * way / rest);
        let acceleration = self.plan.limits.travel_acceleration;
        for &to in &wipe {
            self.go(to, speed, acceleration, -rest / way, false);
        }
        out.push(PacedMove::Wipe {
            points: wipe,
            length: rest,
            speed,
        });
    }

    fn prime(&mut self, out: &mut Vec<PacedMove>) {
        let retract = &self.plan.retract;
        if !std::mem::take(&mut self.retracted) {
            return;
        }
        let (length, extra) = (retract.length, retract.extra_prime);
        self.motion
            .push_filament(length + extra, retract.prime_speed);
        out.push(PacedMove::Prime {
            length,
            extra,
            speed: retract.prime_speed,
        });
    }

    /// Moves the head in the plane, from where it is, if that is known.
    fn go(
        &mut self,
        to: DVec2,
        speed: MmPerSec,
        acceleration: MmPerSec2,
        filament: f64,
        prints: bool,
    ) {
        let z = self.z.unwrap_or(0.0);
        self.go_up(to.extend(z), speed, acceleration, filament, prints);
    }

    /// Moves the head in space, from where it is, if that is known.
    fn go_up(
        &mut self,
        to: DVec3,
        speed: MmPerSec,
        acceleration: MmPerSec2,
        filament: f64,
        prints: bool,
    ) {
        if let Some(from) = self.xy {
            let from = from.extend(self.z.unwrap_or(to.z));
            let end = DVec3::from(to.to_array().map(count));
            let start = DVec3::from(from.to_array().map(count));
            let step = (end - start) * MICRON;
            self.motion
                .push(step, speed, acceleration, filament, prints);
        }
        self.xy = Some(to.truncate());
        if self.z.is_some() {
            self.z = Some(to.z);
        }
    }

    /// Moves to `z`, if the head is not there.
    fn lift(&mut self, z: Mm, out: &mut Vec<PacedMove>) {
        if self.z.is_some_and(|at| (at - z).abs() <= SAME_HEIGHT) {
            return;
        }
        let Limits {
            speed_z: speed,
            travel_acceleration,
            ..
        } = self.plan.limits;
        if let Some(at) = self.z {
            self.motion.push(
                DVec3::Z * (count(z) - count(at)) * MICRON,
                speed,
                travel_acceleration,
                0.0,
                false,
            );
        }
        self.z = Some(z);
        out.push(PacedMove::Lift { z, speed });
    }
}

/// True for a bead that gives way last if a layer is slowed: an outer wall.
fn is_spared(bead: &Bead) -> bool {
    bead.laid_as == Role::OuterWall
}

/// True if two points are one place.
fn near(a: DVec2, b: DVec2) -> bool {
    a.distance(b) <= SAME_PLACE
}

/// A coordinate as the G-code has it, in units of its last decimal.
fn count(at: Mm) -> f64 {
    (at / MICRON).round()
}

/// How long each move of a stroke takes from rest to rest, at the speeds asked for.
fn times(chain: &[Rated], span: &LayerSpan, plan: &PacePlan) -> Vec<Seconds> {
    let limits = plan.limits;
    let mut motion = Motion::new(limits, limits.acceleration);
    let mut counted = Vec::new();
    for rated in chain {
        let bead = &rated.bead;
        let acceleration = acceleration(bead.role, span, plan);
        let filament = bead.area() * rated.rates.flow / plan.filament_area;
        let ways = bead.stroke.segments().map(|(a, b)| b - a);
        for (way, length) in ways.zip(rated.lengths()) {
            let before = motion.segments().len();
            let step = (length * way.normalize_or_zero()).extend(0.0);
            let speed = rated.rates.speed;
            motion.push(step, speed, acceleration, filament, true);
            counted.push(motion.segments().len() > before);
        }
    }
    let mut times = motion.times(|segment| segment.speed);
    let counted = counted.into_iter();
    counted
        .map(|counts| counts.then(|| times.next()).flatten().unwrap_or(0.0))
        .collect()
}

#[cfg(test)]
mod tests;
