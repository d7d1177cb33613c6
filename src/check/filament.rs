//! The rules about filament: how far it goes back, whether it is there again
//! when a bead begins, and how thick beads are.
//!
//! Filament that goes back is a fault only if something is printed after it, so
//! such findings are held until something is.

use super::ground::{How, Wrong};
use super::rules::ROUNDING;
use super::{Checker, Kind, TOOLS, bit, place, sideways};
use crate::reader::{Move, Role};
use crate::units::Mm;

/// Greatest number of findings that wait to see whether something is printed
/// after them.
const HELD: usize = 32;

impl Checker<'_> {
    pub(super) fn filament(&mut self, step: &Move, template: bool) {
        let fed = step.filament;
        let rules = self.rules;
        if !step.travels()
            && let Some(most) = rules.feed
            && fed.abs() > most
        {
            let kind = if template {
                Kind::Purge
            } else {
                Kind::LongFeed
            };
            self.verdict.add(kind, step.line, step.to, || {
                format!(
                    "{fed:.1} mm of filament in one move; Klipper refuses \
                     more than {most} mm unless its max_extrude_only_distance \
                     says otherwise"
                )
            });
        }
        if fed < 0.0 {
            *self.back(step) -= fed;
            // A move up or down is no wipe.
            if sideways(step) && !step.wipe && !template {
                let why = format!(
                    "{:.3} mm of filament go back while the head moves and \
                     does not wipe",
                    -fed
                );
                self.hold(Kind::Backwards, step, why);
            }
            let back = *self.back(step);
            if back > rules.retraction && !template {
                let why =
                    format!("{back:.1} mm of filament are pulled back in all");
                self.hold(Kind::LongRetraction, step, why);
            }
        } else if fed > 0.0 {
            if step.prints() && sideways(step) && !template {
                self.begin(step);
            }
            let back = self.back(step);
            *back = (*back - fed).max(0.0);
        }
    }

    /// Keeps a finding that counts only if something is printed after it.
    fn hold(&mut self, kind: Kind, step: &Move, why: String) {
        if self.held.len() == HELD {
            self.let_go();
        }
        self.held.push((kind, step.line, step.to, why));
    }

    /// Makes the findings that were held count, as something is printed.
    fn let_go(&mut self) {
        for (kind, line, at, why) in self.held.drain(..) {
            self.verdict.add(kind, line, at, || why);
        }
    }

    /// Reports a bead that begins without its filament.
    pub(super) fn begin(&mut self, step: &Move) {
        if !self.held.is_empty() {
            self.let_go();
        }
        let missing = *self.back(step);
        let short = missing > self.rules.missing;
        if short || self.firmware_back & bit(step.tool) != 0 {
            let kind = Kind::Unprimed;
            self.verdict.add(kind, step.line, step.from, || {
                if short {
                    format!(
                        "a bead begins with {missing:.2} mm of filament still \
                     pulled back"
                    )
                } else {
                    "a bead begins after G10, before G11".into()
                }
            });
        }
        // The missing filament counts for this bead only.
        *self.back(step) = 0.0;
    }

    /// The pulled-back filament of the tool that moves.
    pub(super) fn back(&mut self, step: &Move) -> &mut Mm {
        &mut self.back[step.tool.min(TOOLS - 1) as usize]
    }

    pub(super) fn bead(&mut self, step: &Move, template: bool) {
        let rules = self.rules;
        let area = step.area(rules.filament_diameter);
        if area > rules.cross_section {
            let kind = if template {
                Kind::Purge
            } else {
                Kind::ThickBead
            };
            self.verdict.add(kind, step.line, step.to, || {
                format!(
                    "{area:.2} mm² of plastic for each mm; {:.2} mm² are the \
                     most that a nozzle of {} mm can lay",
                    rules.cross_section, rules.nozzle
                )
            });
        }
        if template {
            return;
        }
        let z = step.from.z.max(step.to.z);
        if rules.head_room.is_some() {
            if self.begins_lower(step.role, z) || z < self.top - rules.nozzle {
                // The next part begins.
                self.finished.next_part();
                self.ground.clear();
                self.top = rules.base;
            }
            self.finished.bead(step);
        }
        // A layer is no higher than the nozzle is wide, including the air above
        // a raft. The first layer may lie on a thick sheet.
        let most = self.top + rules.nozzle + ROUNDING;
        if z > most {
            let top = self.top;
            self.verdict.add(Kind::Jump, step.line, step.to, || {
                format!(
                    "a bead at z = {z:.3}; the highest one below it is at \
                     {top:.3}, and nothing is printed between: what holds it \
                     may be thinner than a line there; scale the model up \
                     (--scale), or make that part of it thicker"
                )
            });
        }
        self.top = self.top.max(z);
        // Skirts stand alone, and ironing lays nothing.
        let lies = !matches!(step.role, Role::SkirtBrim | Role::Ironing);
        if lies
            && self.within(step)
            && let Some(wrong) = self.ground.bead(step, area)
        {
            self.lies_wrong(step, wrong);
        }
    }

    /// Reports a bead that is too low or too high for what lies below it.
    fn lies_wrong(&mut self, step: &Move, wrong: Wrong) {
        let Wrong { at, top, how } = wrong;
        let place = place(at);
        match how {
            How::Low => {
                self.verdict.add(Kind::Sunk, step.line, at, || {
                    format!(
                        "a bead is laid into what is printed: at {place}, \
                         where the layers below reach up to {top:.3}"
                    )
                });
            }
            How::High => {
                self.verdict.add(Kind::InTheAir, step.line, at, || {
                    format!(
                        "a bead rises into the air: at {place}, where the \
                         layers below reach up to {top:.3} only"
                    )
                });
            }
        }
    }

    /// True if a bead is the first of its layer, skirts left out, and begins no
    /// higher than the layer before: layers of one part only go up.
    fn begins_lower(&mut self, role: Role, z: Mm) -> bool {
        if role == Role::SkirtBrim || self.begun.is_some() {
            return false;
        }
        self.begun = Some(z);
        self.begun_before
            .is_some_and(|before| z < before + ROUNDING)
    }
}
