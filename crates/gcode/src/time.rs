//! How long the file's head, the way to the first bead and the file's foot
//! take.
//!
//! In: the text of head and foot. Out: time in the totals. Layers know their
//! own time.

use super::number::text;
use super::{E, Writer, XYZ, flavour};
use isoslice_base::units::{MICRON, Seconds};
use isoslice_path::pace::PacedMove;
use isoslice_path::pace::clock::time_of;
use isoslice_path::pace::motion::{Limits, Motion};
use std::io::Write;

impl<W: Write> Writer<'_, W> {
    /// Adds the time of the head, which is in the buffer, to the totals.
    pub(super) fn time_head(&mut self) {
        let (time, at) = time_of(&self.buffer, self.plan.limits);
        self.totals.time += time;
        self.start = at;
    }

    /// Adds the time of the way from the head's end to the first bead of some
    /// moves, or as far as they go without a bead. This
    /// time is no part of that layer's: a layer's speeds depend on its time,
    /// and must not depend on the layer at which a file begins.
    pub(super) fn time_approach(&mut self, moves: &[PacedMove]) {
        let limits = self.plan.limits;
        let acceleration = limits.travel_acceleration;
        let mut motion = Motion::new(limits, acceleration);
        let mut at = self.start;
        for step in moves {
            let (way, speed) = match step {
                PacedMove::Lift { z, speed } => {
                    (vec![at.truncate().extend(*z)], *speed)
                }
                PacedMove::Travel { points, speed } => {
                    (points.iter().map(|p| p.extend(at.z)).collect(), *speed)
                }
                _ => continue,
            };
            for to in way {
                motion.push(to - at, speed, acceleration, 0.0, false);
                at = to;
            }
            if matches!(step, PacedMove::Travel { .. }) {
                break;
            }
        }
        self.totals.time += motion.time(|s| s.speed);
    }

    /// Lines that bring a reader to the state that the machine is in.
    pub(super) fn place(&self) -> String {
        let mut lines = flavour::limits(&self.plan);
        lines.push(if self.filament.relative { "M83" } else { "M82" }.into());
        let mut line = String::from("G92");
        if let Some((x, y)) = self.xy {
            let [x, y] = [x, y].map(|n| text(n as f64 * MICRON, XYZ));
            line += &format!(" X{x} Y{y}");
        }
        if let Some(z) = self.z {
            line += &format!(" Z{}", text(z as f64 * MICRON, XYZ));
        }
        let zero = self.filament.zero.unwrap_or(self.filament.told);
        let fed = (self.filament.told - zero) as f64 / 10f64.powi(E as i32);
        line += &format!(" E{}", text(fed, E));
        lines.push(line);
        lines.join("\n") + "\n"
    }
}

/// Time that the foot takes: its own text, and the end template. `before` is
/// what [`Writer::place`] gave at the foot's beginning.
pub(super) fn of_foot(
    before: &str,
    text: &[u8],
    end: &str,
    limits: Limits,
) -> Seconds {
    let lines = [before.as_bytes(), text, end.as_bytes()].concat();
    time_of(&lines, limits).0
}
