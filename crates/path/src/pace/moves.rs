//! The steps of the machine that pacing makes, layer by layer.

use glam::DVec2;
use isoslice_base::units::{
    Celsius, Mm, MmPerSec, MmPerSec2, Percent, Seconds,
};
use isoslice_planar::arc::Turn;
use isoslice_planar::bead::{Bead, Role};
use isoslice_settings::layers::LayerSpan;
use std::collections::BTreeMap;
use std::ops::Range;

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
    /// Go on along a printed bead while filament is pulled back.
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
        /// Length of filament that the retraction and the wipe pulled back; 0
        /// after a travel without retraction.
        length: Mm,
        /// Length pushed in addition, to make up for what oozed out.
        extra: Mm,
        /// Speed of the filament.
        speed: MmPerSec,
    },
    /// Move straight up or down.
    Lift {
        /// The height to move to.
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
    /// Print a bead; the head stands at its first point. The levels of its
    /// points are above the layer's top.
    Print {
        /// The bead.
        bead: Bead,
        /// For each segment of the bead's path the arc in its place; empty if
        /// the bead has no arcs.
        turns: Vec<Option<Turn>>,
        /// Speed of the head.
        speed: MmPerSec,
        /// Acceleration of the head.
        acceleration: MmPerSec2,
        /// Material extruded, as a factor on the bead's volume.
        flow: f64,
    },
    /// Set the part's fan to this speed.
    Fan(Percent),
}

isoslice_base::named! {
    /// What takes time that the settings' speeds would not take, by its name in
    /// summaries.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Cause {
        /// A layer has to take its time (`cooling.min_layer_time`).
        Cooling = "cooling",
        /// The hot end melts no more (`filament.max_flow`), or not so suddenly.
        Flow = "flow",
        /// The printer takes no more moves (`printer.max_moves_per_second`).
        Moves = "moves",
        /// The machine speeds up and slows down.
        Acceleration = "acceleration",
    }
}

/// What some beads amount to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Amount {
    /// Length of the beads.
    pub length: Mm,
    /// Length of filament.
    pub filament: Mm,
    /// How long it takes to print the beads, without travels.
    pub time: Seconds,
}

/// What the beads of some layers amount to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sums {
    /// The number of moves that print.
    pub printing: usize,
    /// How many of them are slower than asked for, since the printer takes only
    /// so many in a second, and for no stronger reason.
    pub slowed: usize,
    /// Number of layers that take much less than `cooling.min_layer_time`, though they
    /// are slowed as far as they may be, and the time of the shortest one.
    pub short: Option<(usize, Seconds)>,
    /// Time that the layers take longer than at the speeds asked for. Where
    /// several causes slow a bead, the strongest one counts.
    pub lost: BTreeMap<Cause, Seconds>,
    /// What the beads of each role amount to.
    pub amounts: BTreeMap<Role, Amount>,
}

impl Sums {
    /// Adds those of another layer.
    pub fn add(&mut self, layer: &Sums) {
        self.printing += layer.printing;
        self.slowed += layer.slowed;
        if let Some((count, time)) = layer.short {
            let (all, least) = self.short.unwrap_or((0, time));
            self.short = Some((all + count, least.min(time)));
        }
        for (cause, time) in &layer.lost {
            *self.lost.entry(*cause).or_default() += time;
        }
        for (role, amount) in &layer.amounts {
            let sum = self.amounts.entry(*role).or_default();
            sum.length += amount.length;
            sum.filament += amount.filament;
            sum.time += amount.time;
        }
    }
}

/// Moves of a layer that belong to one part.
#[derive(Clone, Debug, PartialEq)]
pub struct OfPart {
    /// Which of the plate's places the part has; none if the moves belong to no
    /// part.
    pub place: Option<usize>,
    /// The moves, by their numbers.
    pub moves: Range<usize>,
}

/// A layer ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct PacedLayer {
    /// The layer.
    pub span: LayerSpan,
    /// Layers of parts that were finished before this one began.
    pub before: usize,
    /// True if nothing is known of where the head comes from.
    pub from_anywhere: bool,
    /// The layer's moves in order.
    pub moves: Vec<PacedMove>,
    /// Which moves belong to which part, in order.
    pub parts: Vec<OfPart>,
    /// Speed of the part's fan at the layer's beginning.
    pub fan: Percent,
    /// Temperature of the nozzle.
    pub nozzle_temperature: Celsius,
    /// How long the layer takes.
    pub time: Seconds,
    /// What the layer's beads amount to.
    pub sums: Sums,
}
