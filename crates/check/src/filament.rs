//! The rules about filament: how far it goes back, whether it is there again
//! when a bead begins, how much is pushed while the head stands, and how thick
//! beads are.
//!
//! Filament that goes back while the head moves is a wipe if the head then goes
//! elsewhere before the filament comes forward again. Not all slicers mark their
//! wipes.

use super::ground::{How, Wrong};
use super::rules::ROUNDING;
use super::{Checker, FindingKind, TOOLS, bit, place, sideways};
use glam::DVec3;
use isoslice_base::units::Mm;
use isoslice_gcode_read::reader::{Move, Role};

/// Way back of the filament while the head moved, if that was no wipe.
#[derive(Clone, Copy, Debug)]
pub(super) struct WayBack {
    line: u64,
    at: DVec3,
    length: Mm,
}

impl Checker<'_> {
    pub(super) fn filament(&mut self, step: &Move, template: bool) {
        let fed = step.filament;
        let rules = self.rules;
        if !step.travels()
            && let Some(most) = rules.feed
            && fed.abs() > most
        {
            let kind = if template {
                FindingKind::Purge
            } else {
                FindingKind::LongFeed
            };
            self.verdict.add(kind, step.line, step.to, || {
                format!(
                    "{fed:.1} mm of filament in one move; Klipper refuses \
                     more than {most} mm unless its max_extrude_only_distance \
                     says otherwise"
                )
            });
        }
        self.way_back(step, template);
        if fed < 0.0 {
            *self.back(step) -= fed;
            let back = *self.back(step);
            if back > rules.retraction && !template {
                let why =
                    format!("{back:.1} mm of filament are pulled back in all");
                self.hold(
                    FindingKind::LongRetraction,
                    "",
                    step.line,
                    step.to,
                    why,
                );
            }
        } else if fed > 0.0 {
            if step.prints() && sideways(step) && !template {
                self.begin(step);
            }
            let back = self.back(step);
            let more = fed - *back;
            *back = (-more).max(0.0);
            self.push(step, more, template);
        }
        if sideways(step) {
            self.pushed = 0.0;
        }
    }

    /// Finds filament that goes back while the head moves, without a wipe.
    fn way_back(&mut self, step: &Move, template: bool) {
        let fed = step.filament;
        // A move up or down is no wipe.
        if fed < 0.0 && sideways(step) && !step.wipe && !template {
            let (line, at, length) = (step.line, step.to, 0.0);
            let begun = WayBack { line, at, length };
            self.way_back.get_or_insert(begun).length -= fed;
        } else if fed > 0.0 {
            if let Some(back) = self.way_back.take() {
                let why = format!(
                    "{:.3} mm of filament go back while the head moves and \
                     does not wipe",
                    back.length
                );
                self.hold(FindingKind::Backwards, "", back.line, back.at, why);
            }
        } else if fed == 0.0 && step.travels() {
            self.way_back = None;
        }
    }

    /// Reports filament that is pushed beyond what was pulled back while the head
    /// stands, with `more` in this move, in the middle of the print.
    fn push(&mut self, step: &Move, more: Mm, template: bool) {
        let at_tower = step.role == Role::PrimeTower;
        let begun = self.ending.has_printed() && !self.fresh_tool;
        if sideways(step) || template || at_tower || !begun {
            return;
        }
        let most = self.rules.prime;
        let before = self.pushed;
        self.pushed += more.max(0.0);
        if before <= most && self.pushed > most {
            let why = format!(
                "{:.2} mm of filament are pushed while the head stands, beyond \
                 what was pulled back: a blob",
                self.pushed
            );
            self.hold(FindingKind::Blob, "", step.line, step.to, why);
        }
    }

    /// Reports a bead that begins without its filament.
    pub(super) fn begin(&mut self, step: &Move) {
        self.let_go();
        let missing = *self.back(step);
        let short = missing > self.rules.missing;
        if short || self.firmware_back & bit(step.tool) != 0 {
            let kind = FindingKind::Unprimed;
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
        if self.asleep & bit(step.tool) != 0 {
            self.asleep &= !bit(step.tool);
            let kind = FindingKind::Cold;
            self.verdict.add(kind, step.line, step.from, || {
                "a bead begins with a tool that M568 has let cool".into()
            });
        }
        // The missing filament counts for this bead only, which gets less.
        *self.back(step) = 0.0;
        self.laid -= missing;
        self.fresh_tool = false;
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
                FindingKind::Purge
            } else {
                FindingKind::ThickBead
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
                // The next part begins. Above its raft it begins no second time.
                self.begun_before = None;
                self.finished.next_part();
                self.ground.clear();
                self.top = rules.base;
                self.lowest_layer = step.layer;
            }
            self.finished.bead(step);
        }
        self.on_bed(step, area);
        // A layer is no higher than the nozzle is wide, including the air above
        // a raft. The first layer may lie on a thick sheet.
        let most = self.top + rules.nozzle + ROUNDING;
        if z > most {
            let top = self.top;
            self.verdict.add(FindingKind::Jump, step.line, step.to, || {
                format!(
                    "a bead at z = {z:.3}; the highest one below it is at \
                     {top:.3}, and nothing is printed between: what holds it \
                     may be thinner than a line there; scale the model up \
                     (--scale), or make that part of it thicker"
                )
            });
        }
        self.top = self.top.max(z);
        self.laid(step, area);
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
            // Which layer a bead belongs to is a guess then, and beads that rise may
            // end as low as the layer below. No layer is higher than the nozzle is wide.
            How::Low if self.untold && top - at.z < self.rules.nozzle => {}
            How::Low => {
                self.verdict.add(FindingKind::Sunk, step.line, at, || {
                    format!(
                        "a bead is laid into what is printed: at {place}, \
                         where the layers below reach up to {top:.3}"
                    )
                });
            }
            How::High => {
                self.verdict.add(FindingKind::InTheAir, step.line, at, || {
                    format!(
                        "a bead rises into the air: at {place}, where the \
                         layers below reach up to {top:.3} only"
                    )
                });
            }
        }
    }

    /// True if a bead is the first of its layer, and begins no higher than the
    /// layer before: layers of one part only go up. Skirts are not part of it, and
    /// supports have heights of their own.
    fn begins_lower(&mut self, role: Role, z: Mm) -> bool {
        let part = !matches!(role, Role::SkirtBrim) && !role.is_support();
        if !part || self.begun.is_some() {
            return false;
        }
        self.begun = Some(z);
        self.begun_before
            .is_some_and(|before| z < before + ROUNDING)
    }
}
