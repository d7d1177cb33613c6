//! Parts that are printed one after the other: in which order, and whether the
//! head has room beside those that are finished.
//!
//! ```text
//!        ├─ radius ─┤               gantry
//!   ═════════════════════════════════════════
//!             ║ head ║       ┌─────┐      ┬
//!             ╚══╗╔══╝       │done │      │ gantry_height
//!   ─────────────╨┴──────────┴─────┴──────┴──
//!             nozzle
//! ```
//!
//! In: a plate whose parts have their places. Out: the order of the places, or
//! the two parts that are too near to each other, or the part that is too high.
//!
//! The head is a circle of `printer.head_clearance_radius` around the nozzle,
//! empty below the height that the setting gives it. The nozzle may be anywhere over
//! what stands on the bed of the part that is printed: its box with its brim or
//! raft, and with the room that its supports have. No finished part may be in
//! that circle. Whatever moves across the whole bed with the head is at
//! `printer.gantry_height`: only the last part may be higher, so the lower ones
//! come first. Between parts the head travels above all that is finished.
//!
//! ```text
//!           y ▲   ═══════ beam ═══════
//!             │          ┌────┐           The beam and the cables are behind
//!             │          │head│ nozzle    the nozzle. A higher part may stand
//!             │          └────┘   ┬       in front of all that is printed
//!             │   ┌────┐          │       after it, `printer.front_clearance`
//!             │   │done│          ┴       away.
//! ```
//!
//! Guaranteed: the order depends on the plate alone. Not guaranteed: that parts
//! could not stand nearer; boxes are larger than parts.

use super::{Part, Plate, PlateError};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Rect;
use isoslice_settings::{DraftShield, HeadRoom, PlateSequence, Supports};

/// How far above all that is finished the head travels from one part to the
/// next, mm: more than threads and blobs stand up.
const ABOVE: Mm = 2.0;

/// What rounding may take away, mm.
const ROUNDED: Mm = 1e-3;

/// True if a part is as high as what carries the head.
fn reaches_gantry(head: &HeadRoom, top: Mm) -> bool {
    top > head.gantry + ROUNDED
}

/// A part in its place.
struct Standing<'a> {
    name: &'a str,
    /// Where the nozzle may be while the part is printed, and what stands there
    /// afterwards.
    area: Rect,
    /// Height of the part's top above the bed.
    top: Mm,
}

/// How parts are arranged.
pub(super) struct Arrangement {
    /// The distance that they keep from one another.
    pub spacing: Mm,
    /// Parts that are higher than this have no other one beside them in x.
    pub alone_above: Mm,
}

impl Arrangement {
    /// The arrangement of the parts of a plate, each with the number of its
    /// places.
    pub(super) fn of<'a>(
        plate: &Plate,
        parts: impl Iterator<Item = (&'a Part, usize)>,
    ) -> Arrangement {
        let usual = plate.settings.plate.spacing;
        let mut all = Arrangement {
            spacing: usual,
            alone_above: Mm::INFINITY,
        };
        let head = plate.head().filter(|_| plate.is_one_by_one());
        let Some(head) = head else {
            return all;
        };
        let (mut high, mut supported, mut above) = (false, false, 0);
        for (part, count) in parts {
            high |= part.top() > head.free_below;
            supported |= part.settings.supports != Supports::Off;
            above += count * usize::from(reaches_gantry(&head, part.top()));
        }
        // Supports reach into the room between parts.
        let room = if supported { usual } else { 0.0 };
        if high {
            all.spacing = usual.max(head.radius + room);
        }
        if let (Some(front), 2..) = (head.front, above) {
            all.spacing = all.spacing.max(front + room);
            all.alone_above = head.gantry + ROUNDED;
        }
        all
    }
}

impl Plate {
    /// True if the parts are printed one by one.
    pub(super) fn is_one_by_one(&self) -> bool {
        self.settings.plate.sequence == PlateSequence::OneByOne
    }

    /// What the head needs, if the printer's settings tell it.
    fn head(&self) -> Option<HeadRoom> {
        self.settings.printer.head_room()
    }

    /// The places in the order in which their parts are printed one by one, as
    /// [`Plate::shifts`] has them; nothing if all grow together.
    #[doc(hidden)]
    pub fn turns(&self) -> Option<Vec<usize>> {
        if !self.is_one_by_one() || self.place_count() < 2 {
            return None;
        }
        // Of those that are as high as what carries the head the front one
        // comes first, if it may be passed in front.
        let head = self.head().filter(|h| h.front.is_some());
        let key = |&(part, shift): &(usize, DVec2)| {
            let (part, top) = (&self.parts[part], self.parts[part].top());
            match head {
                Some(head) if reaches_gantry(&head, top) => {
                    (true, part.covers(shift).min.y)
                }
                _ => (false, top),
            }
        };
        let keys: Vec<(bool, Mm)> = self.shifts().iter().map(key).collect();
        let mut order: Vec<usize> = (0..keys.len()).collect();
        // Equal parts stay together.
        order.sort_by(|&a, &b| {
            let (a, b) = (keys[a], keys[b]);
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        Some(order)
    }

    /// The parts' names in the order in which they are printed one by one;
    /// nothing if all grow together.
    pub fn order(&self) -> Option<Vec<&str>> {
        let places = self.parts.iter().flat_map(|part| &part.places);
        let names: Vec<&str> = places.map(|place| &*place.name).collect();
        let turns = self.turns()?;
        Some(turns.into_iter().map(|place| names[place]).collect())
    }

    /// How high the head is to travel to a part, if one as high as `finished`
    /// stands on the bed.
    #[doc(hidden)]
    pub fn clear_of(finished: Mm) -> Mm {
        finished + ABOVE
    }

    /// Refuses settings that parts printed one by one cannot have.
    pub(super) fn check_alone(&self) -> Result<(), PlateError> {
        if self.settings.draft_shield != DraftShield::Off {
            return Err(PlateError::ShieldOneByOne);
        }
        match self.head() {
            Some(_) => Ok(()),
            None => Err(PlateError::UnknownHead),
        }
    }

    /// If parts are to be printed one by one, refuses a plate on which they
    /// cannot be.
    pub(super) fn check_sequence(&self) -> Result<(), PlateError> {
        let Some(turns) = self.turns() else {
            return Ok(());
        };
        let Some(head) = self.head() else {
            return Err(PlateError::UnknownHead);
        };
        let places = self.parts.iter().flat_map(|part| {
            part.places.iter().map(|place| Standing {
                name: &place.name,
                area: part.covers(place.shift),
                top: part.top(),
            })
        });
        let places: Vec<Standing<'_>> = places.collect();
        for (k, &first) in turns.iter().enumerate() {
            let first = &places[first];
            for &later in &turns[k + 1..] {
                let later = &places[later];
                let ahead = later.area.min.y - first.area.max.y;
                let passes =
                    head.front.is_some_and(|front| ahead >= front - ROUNDED);
                if reaches_gantry(&head, first.top) && !passes {
                    return Err(PlateError::TooHigh {
                        first: first.name.to_owned(),
                        height: first.top,
                        later: later.name.to_owned(),
                        gantry: head.gantry,
                        but: head.front.map_or_else(String::new, |front| {
                            format!(
                                ", unless it is {front:.1} mm in front of all \
                                 later ones (printer.front_clearance)"
                            )
                        }),
                    });
                }
                let apart = first.area.gap(later.area);
                if first.top > head.free_below + ROUNDED
                    && apart < head.radius - ROUNDED
                {
                    return Err(PlateError::TooNear {
                        first: first.name.to_owned(),
                        later: later.name.to_owned(),
                        apart,
                        radius: head.radius,
                    });
                }
            }
        }
        Ok(())
    }
}

impl Part {
    /// Height of the part's top above the bed, on its raft.
    pub(super) fn top(&self) -> Mm {
        let lift = self.settings.raft_height();
        self.model.printed_bounds().max.z + lift
    }

    /// What the part may cover of the bed in a place, with its supports.
    fn covers(&self, shift: DVec2) -> Rect {
        let foot = self.foot();
        let mut area = foot;
        if self.settings.supports != Supports::Off {
            area = area.union(self.room());
        }
        area.moved(shift)
    }
}
