//! Parts that are finished while others are printed: does the head hit them?
//!
//! In: the beads and travels of a file whose parts are printed one by one. Out:
//! what the head would hit. A part is finished once a bead lies well below its
//! top, or a layer begins no higher than the one before. From then on its box must
//! be out of the head's reach, and below whatever moves across the bed with the
//! head.

use isoslice_base::limits::MOST_PARTS;
use isoslice_base::units::Mm;
use isoslice_gcode_read::reader::{Move, Role};
use isoslice_planar::Rect;
use isoslice_settings::HeadRoom;

/// What rounding may add to a distance, or take away.
const ROUNDED: Mm = 1e-2;

/// Something that stands on the bed.
#[derive(Clone, Copy, Debug)]
struct Block {
    area: Rect,
    top: Mm,
}

impl Block {
    /// Grows to hold another block as well.
    fn add(&mut self, other: Block) {
        self.area = self.area.union(other.area);
        self.top = self.top.max(other.top);
    }
}

/// What is finished, and what is being printed.
#[derive(Debug, Default)]
pub(super) struct Finished {
    done: Vec<Block>,
    here: Option<Block>,
    /// Height of the part's first bead.
    lowest: Option<Mm>,
}

impl Finished {
    /// Takes a bead. Those of the lowest layer are no higher than the nozzle ever
    /// is; a skirt around all parts is among them, in files that do not name it.
    pub(super) fn bead(&mut self, step: &Move) {
        let top = step.from.z.max(step.to.z);
        let lowest = *self.lowest.get_or_insert(top);
        if matches!(step.role, Role::SkirtBrim) || top < lowest + ROUNDED {
            return;
        }
        let (from, to) = (step.from.truncate(), step.to.truncate());
        let area = Rect::new(from.min(to), from.max(to));
        let own = Block { area, top };
        self.here.get_or_insert(own).add(own);
    }

    /// The part being printed is finished.
    ///
    /// Moves are compared with each finished part, so there is a bound on their
    /// number: parts beyond it count as one with the last.
    pub(super) fn next_part(&mut self) {
        self.lowest = None;
        let Some(here) = self.here.take() else {
            return;
        };
        let full = self.done.len() as u64 >= MOST_PARTS;
        match self.done.last_mut() {
            Some(last) if full => last.add(here),
            _ => self.done.push(here),
        }
    }

    /// What a move would hit, in words.
    pub(super) fn hit(&self, step: &Move, room: &HeadRoom) -> Option<String> {
        let low = step.from.z.min(step.to.z);
        let (from, to) = (step.from.truncate(), step.to.truncate());
        let here = Rect::new(from.min(to), from.max(to));
        let height = |block: &Block| block.top - low;
        for block in &self.done {
            let Block { area, top } = block;
            let ahead = here.min.y - area.max.y;
            let passes =
                room.front.is_some_and(|front| ahead >= front - ROUNDED);
            if height(block) > room.gantry + ROUNDED && !passes {
                return Some(format!(
                    "the nozzle is at z = {low:.3} while a part of {top:.3} mm \
                     is finished, and what carries the head is only {} mm \
                     above it (printer.gantry_height)",
                    room.gantry
                ));
            }
            let apart = here.gap(*area);
            if height(block) > room.free_below + ROUNDED
                && apart < room.radius - ROUNDED
            {
                return Some(format!(
                    "the nozzle is {apart:.2} mm beside a finished part of \
                     {top:.3} mm, at z = {low:.3}, and the head reaches {} mm \
                     (printer.head_clearance_radius)",
                    room.radius
                ));
            }
        }
        None
    }
}
