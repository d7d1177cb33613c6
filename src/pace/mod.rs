//! Speeds, cooling and time: how fast each move of a layer is run.
//!
//! In: [`LayerPath`]s in print order, and the settings. Out: a [`PacedLayer`]
//! for each, the moves with their speeds and, between them, every step the
//! machine needs: retractions and primings, and moves of z.
//!
//! Guarantees:
//! - a bead runs at its role's speed, no faster than `speed.first_layer` on
//!   the first layer, short closed walls no faster than
//!   `speed.small_perimeter`, none faster than the filament can be melted
//!   (`filament.max_flow`), slower if the layer would take less than
//!   `cooling.min_layer_time`, but not below `cooling.min_speed` for that;
//! - the fan runs faster on layers of little time, and comes up in steps
//!   above the layers without it;
//! - a retraction is primed before the next bead, at the latest at the
//!   layer's end, and never repeated;
//! - z rises before the head travels, and is the layer's top while it prints;
//! - the head stands at a bead's first point when the bead begins;
//! - after [`Pacer::restart`] nothing depends on the layers before;
//! - the same layers give the same numbers.
//!
//! Not guaranteed: that a layer takes `cooling.min_layer_time`; with all beads
//! at `cooling.min_speed` it may still be shorter. Heating, homing and what the
//! start and end templates do are in no time given here.
//!
//! Times come from the [motion model](motion), over a whole layer: the moves
//! of one layer are the window of its look-ahead, and a layer starts and ends
//! at rest. The change of z between layers is a corner taken at walking pace
//! anyway, so this costs some milliseconds a layer and makes a layer's time
//! its own.

mod fan;
pub mod motion;
pub mod rates;

use crate::bead::{Bead, Role};
use crate::layers::LayerSpan;
use crate::plane::grid::EdgeGrid;
use crate::plane::path_length;
use crate::settings::Settings;
use crate::travel::{LayerPath, Move, Travel};
use crate::units::{Celsius, Mm, MmPerSec, Percent, Seconds, filament_area};
use crate::vary::VaryError;
use fan::fan_speed;
use glam::{DVec2, DVec3};
use motion::{Limits, Motion};
use rates::{Rater, Rates};

/// Height above the first layer at which the head comes from wherever the
/// start template left it, mm: clears what start templates leave on the bed.
const APPROACH: Mm = 2.0;

/// How near the layer's time must come to the minimum, as a share of it.
const LAYER_TIME_TOLERANCE: f64 = 1e-3;

/// Trials of the slowing down; four are usual, and each of them takes the time
/// of a pass over the layer.
const MAX_TRIALS: usize = 12;

/// Distance below which two points are the same place, mm: a tenth of what the
/// G-code resolves.
const SAME_PLACE: Mm = 1e-4;

/// Speed of a wipe, as a share of that of travels: it touches what has just
/// been printed.
const WIPE_SPEED: f64 = 0.8;

/// One step of the machine, with its speed.
#[derive(Clone, Debug, PartialEq)]
pub enum PacedMove {
    /// Pull filament back.
    Retract {
        /// Length of filament.
        length: Mm,
        /// Speed of the filament.
        speed: MmPerSec,
    },
    /// Go on along what has been printed while filament is pulled back.
    Wipe {
        /// Way points.
        points: Vec<DVec2>,
        /// Length of filament, spread evenly over the way.
        length: Mm,
        /// Speed of the head.
        speed: MmPerSec,
    },
    /// Push filament forward again.
    Prime {
        /// Length of filament pulled back before, in the retraction and the
        /// wipe together; none after a travel that only oozed.
        length: Mm,
        /// Length pushed in addition, to make up for what oozed out.
        extra: Mm,
        /// Speed of the filament.
        speed: MmPerSec,
    },
    /// Move straight up or down.
    Lift {
        /// Where to.
        z: Mm,
        /// Speed.
        speed: MmPerSec,
    },
    /// Go through `points` at constant z without extruding.
    Travel {
        /// Way points, the last one the destination.
        points: Vec<DVec2>,
        /// Speed.
        speed: MmPerSec,
    },
    /// Print a bead; the head stands at its first point.
    Print {
        /// The bead.
        bead: Bead,
        /// Speed of the head.
        speed: MmPerSec,
        /// Material extruded, as a factor on the bead's volume.
        flow: f64,
    },
    /// Set the part's fan to this speed.
    Fan(Percent),
}

/// A layer ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct PacedLayer {
    /// The layer.
    pub span: LayerSpan,
    /// Its moves in order.
    pub moves: Vec<PacedMove>,
    /// Speed of the part's fan at its beginning.
    pub fan: Percent,
    /// Temperature of the nozzle.
    pub nozzle_temperature: Celsius,
    /// How long the layer takes.
    pub time: Seconds,
}

/// Gives speeds to one layer after another; knows between two of them where
/// the head stands.
pub struct Pacer<'a> {
    settings: &'a Settings,
    rater: Rater<'a>,
    motion: Motion,
    /// Where the head is, unknown before the first move.
    xy: Option<DVec2>,
    z: Option<Mm>,
    retracted: bool,
    /// Filament that has oozed out since the last bead, mm, and is to be
    /// replaced before the next one.
    oozed: Mm,
    /// True while a hop (or the approach to the first layer) lasts.
    lifted: bool,
    /// Speed of the fan so far in the layer.
    fan: Percent,
}

impl<'a> Pacer<'a> {
    /// A pacer for a print from the bed up.
    pub fn new(settings: &'a Settings, rater: Rater<'a>) -> Self {
        Self {
            settings,
            rater,
            motion: Motion::new(Limits::new(settings)),
            xy: None,
            z: None,
            retracted: false,
            oozed: 0.0,
            lifted: false,
            fan: 0.0,
        }
    }

    /// Forgets where the head is: the next layer starts from anywhere in the
    /// plane, one at `z`. The way to its first point is in no layer's time.
    pub fn restart(&mut self, z: Mm) {
        self.xy = None;
        self.z = Some(z);
        self.lifted = false;
    }

    /// Gives the next layer its speeds. Layers must come in print order.
    /// `solid` is the layer's outline in the model's coordinates, if settings
    /// are to know how deep inside they are.
    ///
    /// # Errors
    /// If a setting that is an expression has no value somewhere.
    pub fn layer(
        &mut self,
        path: LayerPath,
        solid: Option<&EdgeGrid>,
    ) -> Result<PacedLayer, VaryError> {
        let LayerPath { span, moves } = path;
        self.motion.clear();
        let mut fan = self.rater.fan(&span).unwrap_or(f64::NAN);
        self.fan = fan;
        let mut out = Vec::with_capacity(moves.len() + 8);
        for step in moves {
            crate::limits::check();
            match step {
                Move::Travel(travel) => {
                    self.travel(&span, travel, &mut out);
                }
                Move::Print(bead) => {
                    let limit = speed_limit(&bead, &span, self.settings);
                    let pieces = self.rater.pieces(bead, &span, solid)?;
                    for (piece, mut rates) in pieces {
                        rates.speed = rates.speed.min(limit);
                        self.print(&span, piece, rates, &mut out);
                    }
                }
            }
        }
        if fan.is_nan() {
            // What the first bead wants holds from the layer's beginning.
            let first = |m: &PacedMove| matches!(m, PacedMove::Fan(_));
            fan = match out.iter().position(first).map(|i| out.remove(i)) {
                Some(PacedMove::Fan(speed)) => speed,
                _ => 0.0,
            };
        }
        self.prime(&mut out);
        let (slowing, time) = self.cool();
        let fan_at = |asked| fan_speed(asked, span.index, time, self.settings);
        for step in &mut out {
            match step {
                PacedMove::Print { speed, .. } => {
                    *speed = slowing.apply(*speed);
                }
                PacedMove::Fan(speed) => *speed = fan_at(*speed),
                _ => {}
            }
        }
        fan = fan_at(fan);
        Ok(PacedLayer {
            span,
            moves: out,
            fan,
            nozzle_temperature: self.rater.temperature(&span)?,
            time,
        })
    }

    /// The settings of the print.
    pub fn settings(&self) -> &'a Settings {
        self.settings
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
            prime,
        } = travel;
        if points.is_empty() {
            return;
        }
        let settings = self.settings;
        if retract && !self.retracted {
            self.retract(wipe, out);
            self.lifted |= hop && settings.retract.z_hop > 0.0;
        }
        self.oozed += prime;
        let mut hop = settings.retract.z_hop.max(0.0);
        if self.z.is_none() {
            self.lifted = true;
            hop = hop.max(APPROACH);
        } else if let (true, Some(z)) = (self.lifted, self.z) {
            // Further travels of a hop stay as high as it is.
            hop = hop.max(z - span.top);
        }
        // A hop may not leave the machine.
        let ceiling = settings.printer.height.max(span.top);
        let z = if self.lifted {
            (span.top + hop).min(ceiling)
        } else {
            span.top
        };
        self.lift(z, out);
        let speed = settings.speed.travel;
        let mut from = self.xy;
        for &to in &points {
            if let Some(from) = from {
                self.motion.push(
                    (to - from).extend(0.0),
                    speed,
                    settings.printer.travel_acceleration,
                    0.0,
                    false,
                );
            }
            from = Some(to);
        }
        self.xy = from;
        out.push(PacedMove::Travel { points, speed });
    }

    fn print(
        &mut self,
        span: &LayerSpan,
        bead: Bead,
        rates: Rates,
        out: &mut Vec<PacedMove>,
    ) {
        let settings = self.settings;
        let Some(&start) = bead.points.first() else {
            return;
        };
        if bead.points.len() < 2 {
            return;
        }
        if self.xy.is_none_or(|at| at.distance(start) > SAME_PLACE) {
            // The travel stage owes a travel here; a straight one is better
            // than a bead drawn from somewhere else.
            self.travel(span, Travel::straight(start, false), out);
        }
        self.lifted = false;
        self.lift(span.top, out);
        self.prime(out);
        if rates.fan != self.fan {
            self.fan = rates.fan;
            out.push(PacedMove::Fan(rates.fan));
        }
        let speed = print_speed(settings, &bead, &rates);
        let filament = bead.area() * rates.flow
            / filament_area(settings.filament.diameter);
        let mut from = start;
        for to in bead.path().skip(1) {
            self.motion.push(
                (to - from).extend(0.0),
                speed,
                settings.printer.acceleration,
                filament,
                true,
            );
            from = to;
        }
        self.xy = Some(from);
        out.push(PacedMove::Print {
            bead,
            speed,
            flow: rates.flow,
        });
    }

    /// Pulls the filament back, some of it before the wipe and the rest on it.
    fn retract(&mut self, wipe: Vec<DVec2>, out: &mut Vec<PacedMove>) {
        let retract = &self.settings.retract;
        if retract.length <= 0.0 {
            return;
        }
        self.retracted = true;
        let wiping = self.xy.filter(|_| !wipe.is_empty());
        let way = wiping.map_or(0.0, |from| {
            from.distance(wipe[0]) + path_length(&wipe, false)
        });
        // Firmware that retracts by itself does it at a stand.
        let first = match way > SAME_PLACE && !retract.firmware {
            true => retract.length * retract.before_wipe / 100.0,
            false => retract.length,
        };
        if first > 0.0 {
            self.motion.push_filament(first, retract.speed);
            out.push(PacedMove::Retract {
                length: first,
                speed: retract.speed,
            });
        }
        if way <= SAME_PLACE {
            return;
        }
        let rest = retract.length - first;
        // No faster than the filament may go back on it.
        let speed = (WIPE_SPEED * self.settings.speed.travel)
            .min(retract.speed * way / rest);
        let mut from = self.xy;
        for &to in &wipe {
            if let Some(from) = from {
                self.motion.push(
                    (to - from).extend(0.0),
                    speed,
                    self.settings.printer.travel_acceleration,
                    -rest / way,
                    false,
                );
            }
            from = Some(to);
        }
        self.xy = from;
        out.push(PacedMove::Wipe {
            points: wipe,
            length: rest,
            speed,
        });
    }

    fn prime(&mut self, out: &mut Vec<PacedMove>) {
        let retract = &self.settings.retract;
        let (length, extra) = match self.retracted {
            true => (retract.length, retract.extra_prime),
            false => (0.0, 0.0),
        };
        let extra = extra + std::mem::take(&mut self.oozed);
        if !std::mem::take(&mut self.retracted) && extra <= 0.0 {
            return;
        }
        self.motion
            .push_filament(length + extra, retract.prime_speed);
        out.push(PacedMove::Prime {
            length,
            extra,
            speed: retract.prime_speed,
        });
    }

    /// Moves to `z`, if the head is not there.
    fn lift(&mut self, z: Mm, out: &mut Vec<PacedMove>) {
        if self.z.is_some_and(|at| (at - z).abs() <= SAME_PLACE) {
            return;
        }
        let printer = &self.settings.printer;
        let speed = printer.max_speed_z;
        if let Some(at) = self.z {
            self.motion.push(
                DVec3::Z * (z - at),
                speed,
                printer.travel_acceleration,
                0.0,
                false,
            );
        }
        self.z = Some(z);
        out.push(PacedMove::Lift { z, speed });
    }

    /// How much to slow the layer's beads for it to take
    /// `cooling.min_layer_time`, and the time it then takes.
    ///
    /// The time grows with the slowness 1/factor: at first linearly, the
    /// cruising time, later less, where beads are at the floor. So a false
    /// position search for the slowness is at its goal in a few trials.
    fn cool(&mut self) -> (Slowing, Seconds) {
        let cooling = &self.settings.cooling;
        let target = cooling.min_layer_time;
        let at = |slowness: f64| Slowing {
            factor: 1.0 / slowness,
            floor: cooling.min_speed,
        };
        let full = self.time(&at(1.0));
        // Slowness at which the fastest bead is at the floor, and with it
        // every other.
        let slowest = self
            .motion
            .segments()
            .iter()
            .filter(|s| s.prints)
            .map(|s| s.speed / cooling.min_speed)
            .fold(1.0, f64::max);
        let too_short = |time: f64| time < target;
        if !too_short(full) || slowest <= 1.0 || !slowest.is_finite() {
            return (at(1.0), full);
        }
        let limit = self.time(&at(slowest));
        if too_short(limit) {
            return (at(slowest), limit);
        }
        // Invariant: too short at `low`, not at `high`.
        let (mut low, mut high) = ((1.0, full), (slowest, limit));
        let cruising: f64 = self
            .motion
            .segments()
            .iter()
            .filter(|s| s.prints)
            .map(|s| s.length / s.speed)
            .sum();
        let mut guess = 1.0 + (target - full) / cruising;
        for _ in 0..MAX_TRIALS {
            if (high.1 - target) <= LAYER_TIME_TOLERANCE * target {
                break;
            }
            if !(guess > low.0 && guess < high.0) {
                guess = 0.5 * (low.0 + high.0);
            }
            let time = self.time(&at(guess));
            if too_short(time) {
                low = (guess, time);
            } else {
                high = (guess, time);
            }
            // Aimed a little above the target, so that the side that is kept
            // as the answer is the one that moves.
            let aim = target * (1.0 + 0.5 * LAYER_TIME_TOLERANCE);
            guess = low.0 + (aim - low.1) / (high.1 - low.1) * (high.0 - low.0);
        }
        (at(high.0), high.1)
    }

    fn time(&mut self, slowing: &Slowing) -> Seconds {
        self.motion.time(|s| match s.prints {
            true => slowing.apply(s.speed),
            false => s.speed,
        })
    }
}

/// How beads are slowed.
#[derive(Clone, Copy, Debug)]
struct Slowing {
    factor: f64,
    floor: MmPerSec,
}

impl Slowing {
    /// The slowed speed; a speed already below the floor stays.
    fn apply(&self, speed: MmPerSec) -> MmPerSec {
        (speed * self.factor).max(speed.min(self.floor))
    }
}

/// Greatest speed of a bead, whatever its role's: the first layer's, and that
/// of small walls.
fn speed_limit(bead: &Bead, span: &LayerSpan, settings: &Settings) -> MmPerSec {
    let speed = &settings.speed;
    let first = match span.index {
        0 => speed.first_layer,
        _ => f64::INFINITY,
    };
    match is_small_perimeter(bead, settings) {
        true => first.min(speed.small_perimeter),
        false => first,
    }
}

/// Speed of a bead before cooling: what its rates ask for, and what the
/// filament's flow allows, whichever is less.
fn print_speed(settings: &Settings, bead: &Bead, rates: &Rates) -> MmPerSec {
    let area = bead.area() * rates.flow;
    match area > 0.0 && settings.filament.max_flow > 0.0 {
        true => rates.speed.min(settings.filament.max_flow / area),
        false => rates.speed,
    }
}

/// True for a wall round a thin pin or a small hole; one with a gap at its
/// seam counts as closed.
fn is_small_perimeter(bead: &Bead, settings: &Settings) -> bool {
    if !matches!(bead.role, Role::OuterWall | Role::InnerWall) {
        return false;
    }
    let ends = bead.points.first().zip(bead.points.last());
    let closed = bead.closed
        || ends.is_some_and(|(a, b)| a.distance(*b) < 2.0 * bead.width);
    closed && bead.length() < settings.speed.small_perimeter_length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bead::cross_section;
    use crate::settings::Varying;

    impl<'a> Pacer<'a> {
        fn plain(settings: &'a Settings) -> Self {
            Pacer::new(settings, Rater::constant(settings).unwrap())
        }

        fn paced(&mut self, path: LayerPath) -> PacedLayer {
            self.layer(path, None).unwrap()
        }
    }

    fn span(index: usize) -> LayerSpan {
        LayerSpan {
            index,
            bottom: 0.2 * index as f64,
            top: 0.2 * (index as f64 + 1.0),
        }
    }

    fn square(role: Role, side: f64) -> Bead {
        Bead {
            role,
            points: [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]
                .map(|(x, y)| DVec2::new(x + 50.0, y + 50.0))
                .to_vec(),
            closed: true,
            width: 0.45,
            widths: Vec::new(),
            height: 0.2,
        }
    }

    /// A travel that is retracted and lifted.
    fn hop(points: Vec<DVec2>) -> Move {
        Move::Travel(Travel {
            points,
            retract: true,
            hop: true,
            ..Travel::default()
        })
    }

    fn layer(index: usize, beads: Vec<Bead>) -> LayerPath {
        let moves = beads
            .into_iter()
            .flat_map(|b| {
                let points = vec![b.points[0]];
                [hop(points), Move::Print(b)]
            })
            .collect();
        LayerPath {
            span: span(index),
            moves,
        }
    }

    fn speeds(layer: &PacedLayer) -> Vec<f64> {
        layer
            .moves
            .iter()
            .filter_map(|m| match m {
                PacedMove::Print { speed, .. } => Some(*speed),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn roles_first_layer_and_flow_set_the_speed() {
        let mut s = Settings::default();
        s.cooling.min_layer_time = 0.0;
        let beads = || {
            vec![
                square(Role::OuterWall, 20.0),
                square(Role::SparseInfill, 20.0),
            ]
        };
        let mut pacer = Pacer::plain(&s);
        let first = pacer.paced(layer(0, beads()));
        assert_eq!(speeds(&first), [20.0, 20.0]);
        assert_eq!(first.fan, 0.0);
        let second = pacer.paced(layer(1, beads()));
        assert_eq!(speeds(&second), [40.0, 80.0]);
        assert_eq!(second.fan, 100.0);

        s.filament.max_flow = 4.0;
        s.flow = Varying::Constant(110.0);
        s.filament.flow = 95.0;
        let mut pacer = Pacer::plain(&s);
        let slow = pacer.paced(layer(1, beads()));
        let limit = 4.0 / (cross_section(0.45, 0.2) * 1.1 * 0.95);
        assert!(limit > 40.0 && limit < 80.0);
        assert_eq!(speeds(&slow)[0], 40.0);
        assert!((speeds(&slow)[1] - limit).abs() < 1e-9);
    }

    #[test]
    fn short_walls_are_slower() {
        let mut s = Settings::default();
        s.cooling.min_layer_time = 0.0;
        let of = |s: &Settings, role, side| {
            let layer = layer(1, vec![square(role, side)]);
            speeds(&Pacer::plain(s).paced(layer))[0]
        };
        assert_eq!(of(&s, Role::OuterWall, 4.9), 25.0);
        assert_eq!(of(&s, Role::OuterWall, 5.1), 40.0);
        assert_eq!(of(&s, Role::SparseInfill, 2.0), 80.0);
        s.speed.outer_wall = Varying::Constant(20.0);
        assert_eq!(of(&s, Role::OuterWall, 4.9), 20.0);
        s.speed.small_perimeter_length = 0.0;
        assert_eq!(of(&s, Role::InnerWall, 4.9), 60.0);
    }

    #[test]
    fn bridges_have_their_own_speed_flow_and_fan() {
        let mut s = Settings::default();
        s.cooling.min_layer_time = 0.0;
        s.cooling.fan_speed = Varying::Constant(40.0);
        s.bridge_flow = 80.0;
        let roles = [Role::TopSkin, Role::Bridge, Role::Bridge, Role::Overhang];
        let beads = roles.map(|r| square(r, 20.0)).to_vec();
        let fed = |bead: Bead| -> f64 {
            let l = Pacer::plain(&s).paced(layer(1, vec![bead]));
            let of = |m: &PacedMove| match m {
                PacedMove::Print { bead, flow, .. } => bead.area() * flow,
                _ => 0.0,
            };
            l.moves.iter().map(of).sum()
        };
        let (bridge, top) = (Role::Bridge, Role::TopSkin);
        let share = fed(square(bridge, 20.0)) / fed(square(top, 20.0));
        assert!((share - 0.8).abs() < 1e-9);
        let mut pacer = Pacer::plain(&s);
        let l = pacer.paced(layer(1, beads.clone()));
        assert_eq!(speeds(&l), [40.0, 30.0, 30.0, 20.0]);
        let fans = |l: &PacedLayer| -> Vec<f64> {
            l.moves
                .iter()
                .filter_map(|m| match m {
                    PacedMove::Fan(speed) => Some(*speed),
                    _ => None,
                })
                .collect()
        };
        assert_eq!((l.fan, fans(&l)), (40.0, vec![100.0]));
        // Back for what comes after, and never on layers without a fan.
        let mut back = beads.clone();
        back.rotate_left(1);
        assert_eq!(fans(&pacer.paced(layer(2, back))), [100.0, 40.0]);
        assert!(fans(&pacer.paced(layer(0, beads))).is_empty());
        let ironed = Bead {
            width: 0.1,
            ..square(Role::Ironing, 20.0)
        };
        assert!((fed(ironed) - 0.1 * 0.1 * 0.2).abs() < 1e-12);
    }

    #[test]
    fn a_short_layer_is_slowed_to_the_minimum_time() {
        for flavour in [
            crate::settings::Flavour::Marlin,
            crate::settings::Flavour::Klipper,
        ] {
            let mut s = Settings::default();
            s.gcode.flavour = flavour;
            s.cooling.min_speed = 1.0;
            for target in [6.0, 8.0, 20.0, 60.0] {
                s.cooling.min_layer_time = target;
                let mut pacer = Pacer::plain(&s);
                let l = pacer.paced(layer(
                    1,
                    vec![
                        square(Role::OuterWall, 20.0),
                        square(Role::SparseInfill, 18.0),
                    ],
                ));
                assert!(l.time >= target, "{} {target}", l.time);
                assert!(
                    l.time <= target * (1.0 + LAYER_TIME_TOLERANCE),
                    "{} {target}",
                    l.time
                );
                // Slowed alike, as far as the floor lets them.
                let v = speeds(&l);
                assert!((v[1] / v[0] - 2.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn slowing_ends_at_the_floor() {
        let s = Settings::default();
        let mut pacer = Pacer::plain(&s);
        let l = pacer.paced(layer(
            1,
            vec![
                square(Role::OuterWall, 4.0),
                square(Role::SparseInfill, 4.0),
            ],
        ));
        assert!(l.time < s.cooling.min_layer_time);
        assert_eq!(speeds(&l), [10.0, 10.0]);
    }

    #[test]
    fn a_speed_below_the_floor_is_not_raised() {
        let mut s = Settings::default();
        s.speed.outer_wall = Varying::Constant(6.0);
        let mut pacer = Pacer::plain(&s);
        let l = pacer.paced(layer(1, vec![square(Role::OuterWall, 4.0)]));
        assert_eq!(speeds(&l), [6.0]);
    }

    #[test]
    fn travels_are_not_slowed() {
        let s = Settings::default();
        let mut pacer = Pacer::plain(&s);
        let l = pacer.paced(layer(1, vec![square(Role::OuterWall, 4.0)]));
        for m in &l.moves {
            if let PacedMove::Travel { speed, .. } = m {
                assert_eq!(*speed, s.speed.travel);
            }
        }
    }

    /// The machine's z and retraction along the moves, checked at each step.
    #[test]
    fn retractions_pair_and_z_is_right() {
        let mut s = Settings::default();
        s.retract.z_hop = 0.4;
        let mut pacer = Pacer::plain(&s);
        let (mut z, mut retracted) = (f64::NAN, false);
        let mut primes = 0;
        for index in 0..3 {
            let mut path = layer(
                index,
                vec![
                    square(Role::InnerWall, 9.0),
                    square(Role::OuterWall, 10.0),
                ],
            );
            // Two travels in a row retract once.
            path.moves.insert(
                1,
                hop(vec![DVec2::new(70.0, 70.0), DVec2::splat(50.0)]),
            );
            let top = path.span.top;
            for m in pacer.paced(path).moves {
                match m {
                    PacedMove::Retract { length, .. } => {
                        assert!(!retracted);
                        assert_eq!(length, 0.8);
                        retracted = true;
                    }
                    PacedMove::Prime { .. } => {
                        assert!(retracted);
                        assert_eq!(z, top);
                        retracted = false;
                        primes += 1;
                    }
                    PacedMove::Lift { z: to, .. } => z = to,
                    PacedMove::Fan(_) => panic!("the fan does not change"),
                    PacedMove::Wipe { .. } => panic!("nothing is wiped"),
                    PacedMove::Travel { .. } => {
                        assert!(retracted);
                        let hop = if index == 0 && primes == 0 {
                            APPROACH
                        } else {
                            0.4
                        };
                        assert!((z - top - hop).abs() < 1e-9);
                    }
                    PacedMove::Print { .. } => {
                        assert!(!retracted);
                        assert_eq!(z, top);
                    }
                }
            }
        }
        assert_eq!(primes, 6);
    }

    /// The steps between two beads with a travel in between.
    fn between(settings: &Settings, travel: Travel) -> Vec<PacedMove> {
        let mut path = layer(1, vec![square(Role::OuterWall, 10.0)]);
        path.moves.push(Move::Travel(travel));
        let mut next = square(Role::OuterWall, 10.0);
        next.points.iter_mut().for_each(|p| *p += 20.0);
        path.moves.push(Move::Print(next));
        let moves = Pacer::plain(settings).paced(path).moves;
        let print = |m: &PacedMove| matches!(m, PacedMove::Print { .. });
        let mut parts = moves.split(print);
        parts.nth(1).map(<[PacedMove]>::to_vec).unwrap_or_default()
    }

    #[test]
    fn filament_goes_back_and_forth_as_set() {
        let mut s = Settings::default();
        s.retract.length = 1.2;
        s.retract.speed = 40.0;
        s.retract.prime_speed = 25.0;
        s.retract.extra_prime = 0.1;
        let to = Travel::straight(DVec2::splat(70.0), true);
        let steps = between(&s, to);
        let [back, PacedMove::Travel { .. }, forth] = &steps[..] else {
            panic!("{steps:?}");
        };
        let (length, speed) = (1.2, 40.0);
        assert_eq!(*back, PacedMove::Retract { length, speed });
        let (extra, speed) = (0.1, 25.0);
        let prime = PacedMove::Prime {
            length,
            extra,
            speed,
        };
        assert_eq!(*forth, prime);
    }

    #[test]
    fn ooze_is_replaced_without_a_retraction() {
        let mut s = Settings::default();
        s.retract.extra_prime = 0.1;
        let steps = between(
            &s,
            Travel {
                prime: 0.02,
                ..Travel::straight(DVec2::splat(70.0), false)
            },
        );
        let [
            PacedMove::Travel { .. },
            PacedMove::Prime { length, extra, .. },
        ] = steps[..]
        else {
            panic!("{steps:?}");
        };
        assert_eq!((length, extra), (0.0, 0.02));
    }

    #[test]
    fn a_wipe_takes_the_rest_of_the_retraction() {
        let mut s = Settings::default();
        s.retract.before_wipe = 25.0;
        let wipe = |length: f64| Travel {
            wipe: vec![DVec2::new(50.0 + length, 50.0)],
            hop: true,
            ..Travel::straight(DVec2::splat(70.0), true)
        };
        let speeds = [30.0, 0.3].map(|way| {
            let steps = between(&s, wipe(way));
            let [
                PacedMove::Retract { length: first, .. },
                PacedMove::Wipe { length, speed, .. },
                PacedMove::Travel { .. },
                PacedMove::Prime { length: back, .. },
            ] = steps[..]
            else {
                panic!("{steps:?}");
            };
            assert!((first - 0.2).abs() < 1e-12);
            assert_eq!(first + length, back);
            speed
        });
        // A short one is as slow as the filament needs it.
        assert_eq!(speeds[0], WIPE_SPEED * s.speed.travel);
        assert!((speeds[1] - 0.3 * 35.0 / 0.6).abs() < 1e-9);
        // Nothing is pulled back where nothing is to be.
        s.retract.length = 0.0;
        assert!(matches!(
            between(&s, wipe(1.0))[..],
            [PacedMove::Travel { .. }]
        ));
    }

    #[test]
    fn z_rises_before_an_unretracted_travel() {
        let s = Settings::default();
        let mut pacer = Pacer::plain(&s);
        pacer.paced(layer(0, vec![square(Role::OuterWall, 10.0)]));
        let mut path = layer(1, vec![square(Role::OuterWall, 10.0)]);
        path.moves[0] =
            Move::Travel(Travel::straight(DVec2::splat(50.0), false));
        let l = pacer.paced(path);
        assert!(matches!(l.moves[0], PacedMove::Lift { z, .. } if z == 0.4));
        assert!(matches!(l.moves[1], PacedMove::Travel { .. }));
        assert!(matches!(l.moves[2], PacedMove::Print { .. }));
    }

    #[test]
    fn a_hop_stays_inside_the_machine() {
        let mut s = Settings::default();
        s.retract.z_hop = 1.0;
        s.printer.height = 0.5;
        let mut pacer = Pacer::plain(&s);
        pacer.paced(layer(0, vec![square(Role::OuterWall, 10.0)]));
        let l = pacer.paced(layer(1, vec![square(Role::OuterWall, 10.0)]));
        assert!(l.moves.iter().all(|m| match m {
            PacedMove::Lift { z, .. } => *z <= 0.5,
            _ => true,
        }));
    }

    #[test]
    fn a_missing_travel_is_made_up_for() {
        let s = Settings::default();
        let mut pacer = Pacer::plain(&s);
        let mut path = layer(0, vec![square(Role::OuterWall, 10.0)]);
        path.moves.remove(0);
        let l = pacer.paced(path);
        assert!(l.moves.iter().any(|m| matches!(
            m,
            PacedMove::Travel { points, .. } if points[0] == DVec2::splat(50.0)
        )));
    }

    #[test]
    fn an_empty_layer_takes_no_time() {
        let s = Settings::default();
        let l = Pacer::plain(&s).paced(layer(0, vec![]));
        assert_eq!((l.moves.len(), l.time), (0, 0.0));
    }
}
