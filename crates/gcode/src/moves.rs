//! The moves: from steps of the machine to lines that say only what changes.
//!
//! In: [`PacedMove`]s. Out: lines in the writer's buffer.

use super::comments::{self, role_name};
use super::number::scaled;
use super::{COARSE, E, WIDTH, WriteError, Writer, XYZ, flavour};
use glam::{DVec2, DVec3};
use isoslice_base::units::{MICRON, Mm, Mm2, MmPerSec, MmPerSec2, feed_rate};
use isoslice_path::pace::PacedMove;
use isoslice_planar::arc::Turn;
use isoslice_planar::bead::{Bead, Role};
use std::io::Write;

impl<W: Write> Writer<'_, W> {
    pub(super) fn step(&mut self, step: &PacedMove) -> Result<(), WriteError> {
        match step {
            PacedMove::Retract { length, speed } => {
                self.retract(*length, *speed)
            }
            PacedMove::Wipe {
                points,
                length,
                speed,
            } => self.wipe(points, *length, *speed),
            PacedMove::Prime {
                length: _,
                extra,
                speed,
            } => self.prime(*extra, *speed),
            PacedMove::Lift { z, speed } => self.lift(*z, *speed),
            PacedMove::Travel { points, speed } => {
                self.accelerate_travel();
                self.on_way = false;
                for &p in points {
                    self.go(p, *speed, None)?;
                }
                Ok(())
            }
            PacedMove::Print {
                bead,
                turns,
                speed,
                acceleration,
                flow,
            } => self.bead(bead, turns, *speed, *acceleration, *flow),
            PacedMove::Fan(speed) => {
                self.set_fan(*speed);
                Ok(())
            }
        }
    }

    fn bead(
        &mut self,
        bead: &Bead,
        turns: &[Option<Turn>],
        speed: MmPerSec,
        acceleration: MmPerSec2,
        flow: f64,
    ) -> Result<(), WriteError> {
        if self.role != Some(bead.role) {
            let dialect = self.plan.comments;
            let name = |role| role_name(dialect, role);
            // Several roles may have one name.
            if self.role.and_then(name) != name(bead.role) {
                self.type_comment(name(bead.role));
            }
            self.role = Some(bead.role);
            self.on_way = false;
        }
        let width = self.count("bead width", bead.stroke.width, WIDTH)?;
        let height = self.count("bead height", bead.height, WIDTH)?;
        if let Some(words) = comments::words(self.plan.comments) {
            if self.shows_width(bead.role, width) {
                self.width = Some(width);
                self.comment_number(words.width, width, WIDTH);
            }
            self.on_way = true;
            if self.height != Some(height) {
                self.height = Some(height);
                self.comment_number(words.height, height, WIDTH);
            }
        }
        self.accelerate_printing(acceleration);
        let own = self.plan.filament_area;
        let filament = |area: Mm2| area * flow / own;
        let area = filament(bead.area());
        let mut path = bead.stroke.path();
        if let Some(start) = path.next() {
            self.begin_at(
                start,
                self.top + bead.stroke.rise(0).unwrap_or(0.0),
                speed,
            )?;
        }
        for (i, p) in path.enumerate() {
            if let Some(rise) = bead.stroke.rise(i + 1) {
                let area = filament(bead.area_along(i));
                self.go_up(p.extend(self.top + rise), speed, area)?;
                continue;
            }
            match turns.get(i) {
                Some(Some(turn)) => self.go_round(p, *turn, speed, area)?,
                _ => self.go(p, speed, Some(area))?,
            }
        }
        Ok(())
    }

    /// Brings the head to where a bead begins. It is there, unless a template
    /// may have moved it. Then z comes last, so that the head comes from above
    /// if the template has raised it.
    fn begin_at(
        &mut self,
        start: DVec2,
        z: Mm,
        speed: MmPerSec,
    ) -> Result<(), WriteError> {
        if self.z.is_some() {
            // Rounding may put one place on both sides of a step.
            let near = |at: DVec2| at.distance(start) <= 2.0 * MICRON;
            return match self.xy.map(|(x, y)| DVec2::new(x as f64, y as f64)) {
                Some(at) if near(at * MICRON) => Ok(()),
                _ => self.go(start, speed, None),
            };
        }
        self.go(start, self.plan.travel_speed, None)?;
        self.lift(z, self.plan.limits.speed_z)
    }

    /// Goes to a point in space, feeding `filament` mm for each mm.
    fn go_up(
        &mut self,
        p: DVec3,
        speed: MmPerSec,
        filament: f64,
    ) -> Result<(), WriteError> {
        let z = self.count("z", p.z, XYZ)?;
        if self.z == Some(z) {
            return self.go(p.truncate(), speed, Some(filament));
        }
        let x = self.count("x", p.x, XYZ)?;
        let y = self.count("y", p.y, XYZ)?;
        if let (Some((x0, y0)), Some(z0)) = (self.xy, self.z) {
            let step =
                DVec3::new((x - x0) as f64, (y - y0) as f64, (z - z0) as f64);
            self.feed_filament(filament * step.length() * MICRON)?;
        }
        self.xy = Some((x, y));
        self.z = Some(z);
        self.buffer.extend_from_slice(b"G1");
        self.word(b" X", x, XYZ);
        self.word(b" Y", y, XYZ);
        self.word(b" Z", z, XYZ);
        if let Some(e) = self.filament.word() {
            self.word(b" E", e, E);
        }
        self.end_move(speed)
    }

    /// True if a reader has to be told a width, counted in units of its last
    /// decimal. A width that changes along a bead is told as soon as a viewer
    /// shows the difference: for any change if the bead's edges are the part's,
    /// otherwise from a share of the width on. At a bead's beginning the width
    /// is told exactly.
    fn shows_width(&self, role: Role, width: i64) -> bool {
        /// This share of a width is 0.02 mm of an ordinary one: 10 µm on each
        /// edge, which no viewer shows.
        const SHARE: f64 = 0.04;
        self.width.is_none_or(|told| {
            if self.on_way && !role.shows() {
                (width - told).abs() as f64 > SHARE * told as f64
            } else {
                width != told
            }
        })
    }

    /// Moves to `p`, feeding `filament` mm for each mm.
    fn go(
        &mut self,
        p: DVec2,
        speed: MmPerSec,
        filament: Option<f64>,
    ) -> Result<(), WriteError> {
        let x = self.count("x", p.x, XYZ)?;
        let y = self.count("y", p.y, XYZ)?;
        if self.xy == Some((x, y)) {
            return Ok(());
        }
        if let (Some(per_mm), Some((x0, y0))) = (filament, self.xy) {
            let length = ((x - x0) as f64).hypot((y - y0) as f64) * MICRON;
            self.feed_filament(per_mm * length)?;
        }
        self.xy = Some((x, y));
        self.buffer.extend_from_slice(b"G1");
        self.word(b" X", x, XYZ);
        self.word(b" Y", y, XYZ);
        if filament.is_some()
            && let Some(e) = self.filament.word()
        {
            self.word(b" E", e, E);
        }
        self.end_move(speed)
    }

    /// Goes along an arc to `p`, feeding `filament` mm for each mm.
    fn go_round(
        &mut self,
        p: DVec2,
        turn: Turn,
        speed: MmPerSec,
        filament: f64,
    ) -> Result<(), WriteError> {
        let straight = |writer: &mut Self| writer.go(p, speed, Some(filament));
        let Some((x0, y0)) = self.xy else {
            return straight(self);
        };
        let x = self.count("x", p.x, XYZ)?;
        let y = self.count("y", p.y, XYZ)?;
        let i = self.count("i", turn.centre.x, XYZ)? - x0;
        let j = self.count("j", turn.centre.y, XYZ)? - y0;
        // The firmware sees an arc from rounded points round a rounded centre.
        let arm = |x: i64, y: i64| DVec2::new(x as f64, y as f64) * MICRON;
        let (from, to) = (arm(-i, -j), arm(x - x0 - i, y - y0 - j));
        let angle = from.angle_to(to);
        // Rounding may leave hardly anything of a short arc.
        if angle.is_nan() || angle * turn.angle <= 0.0 {
            return straight(self);
        }
        let radius = 0.5 * (from.length() + to.length());
        self.feed_filament(filament * radius * angle.abs())?;
        self.xy = Some((x, y));
        let command: &[u8] = if angle > 0.0 { b"G3" } else { b"G2" };
        self.buffer.extend_from_slice(command);
        self.word(b" X", x, XYZ);
        self.word(b" Y", y, XYZ);
        self.word(b" I", i, XYZ);
        self.word(b" J", j, XYZ);
        if let Some(e) = self.filament.word() {
            self.word(b" E", e, E);
        }
        self.end_move(speed)
    }

    pub(super) fn lift(
        &mut self,
        z: Mm,
        speed: MmPerSec,
    ) -> Result<(), WriteError> {
        let z = self.count("z", z, XYZ)?;
        if self.z == Some(z) {
            return Ok(());
        }
        self.accelerate_travel();
        self.z = Some(z);
        self.buffer.extend_from_slice(b"G1");
        self.word(b" Z", z, XYZ);
        self.end_move(speed)
    }

    fn retract(
        &mut self,
        length: Mm,
        speed: MmPerSec,
    ) -> Result<(), WriteError> {
        self.retracted = true;
        if self.plan.retract.firmware {
            self.line("G10");
            return Ok(());
        }
        self.filament.back = self.count("retraction", length, E)?;
        self.filament_move(speed)
    }

    /// Pulls filament back on the way through `points`.
    fn wipe(
        &mut self,
        points: &[DVec2],
        length: Mm,
        speed: MmPerSec,
    ) -> Result<(), WriteError> {
        self.accelerate_travel();
        let marks = comments::wipe(self.plan.comments);
        if let Some([start, _]) = marks {
            self.line(start);
        }
        let from = match self.xy {
            Some((x, y)) => DVec2::new(x as f64, y as f64) * MICRON,
            None => points.first().copied().unwrap_or_default(),
        };
        let before = self.filament.back;
        let back = self.count("retraction", length, E)?;
        let ends = || [from].into_iter().chain(points.iter().copied());
        let steps = || ends().zip(ends().skip(1)).map(|(p, q)| p.distance(q));
        let whole: f64 = steps().sum();
        let mut done = 0.0;
        for (&p, step) in points.iter().zip(steps()) {
            done += step;
            let share = (back as f64 * (done / whole).min(1.0)).round();
            self.filament.back = before + share as i64;
            self.go(p, speed, Some(0.0))?;
        }
        // If the last points are in one place, rounding leaves some filament.
        self.filament.back = before + back;
        self.retracted = true;
        self.filament_move(self.plan.retract.speed)?;
        if let Some([_, end]) = marks {
            self.line(end);
        }
        Ok(())
    }

    fn prime(&mut self, extra: Mm, speed: MmPerSec) -> Result<(), WriteError> {
        if self.plan.retract.firmware {
            // The firmware knows of filament that is fed in addition each time.
            let mut own = 0.0;
            if std::mem::take(&mut self.retracted) {
                self.line("G11");
                own = self.plan.retract.extra_prime;
            }
            self.extra += own;
            self.feed_filament(extra - own)?;
            return self.filament_move(speed);
        }
        self.filament.back = 0;
        self.retracted = false;
        self.feed_filament(extra)?;
        self.filament_move(speed)
    }

    /// Adds a length to the filament fed into the print.
    fn feed_filament(&mut self, length: Mm) -> Result<(), WriteError> {
        self.filament.exact += length;
        self.count("filament length", self.filament.exact, E)
            .map(|_| ())
    }

    /// Writes a move of the filament alone.
    pub(super) fn filament_move(
        &mut self,
        speed: MmPerSec,
    ) -> Result<(), WriteError> {
        let Some(e) = self.filament.word() else {
            return Ok(());
        };
        self.buffer.extend_from_slice(b"G1");
        self.word(b" E", e, E);
        self.end_move(speed)
    }

    /// Writes the feed rate if it changes, and the end of the line.
    fn end_move(&mut self, speed: MmPerSec) -> Result<(), WriteError> {
        let feed = self.count("speed", feed_rate(speed), 0)?;
        // A feed rate of 0 would stop the print for good. The slowest is 1
        // mm/min.
        let feed = feed.max(1);
        if self.feed != Some(feed) {
            self.feed = Some(feed);
            self.word(b" F", feed, 0);
        }
        self.buffer.push(b'\n');
        Ok(())
    }

    /// Makes absolute positions of the filament start again from 0 when they
    /// are large: firmware keeps them in single precision.
    pub(super) fn reset_filament(&mut self) {
        let filament = &mut self.filament;
        let zero = Some(filament.told);
        if !filament.relative && filament.zero != zero {
            filament.zero = zero;
            self.line("G92 E0");
        }
    }

    /// Sets the acceleration of a bead, if it changes.
    fn accelerate_printing(&mut self, to: MmPerSec2) {
        if !self.plan.sets_acceleration {
            return;
        }
        let count =
            scaled(to, COARSE).filter(|c| self.acceleration != Some(*c));
        if let Some(count) = count {
            self.acceleration = Some(count);
            self.tell_acceleration(count);
        }
    }

    pub(super) fn tell_acceleration(&mut self, count: i64) {
        let word = flavour::print_acceleration(self.plan.flavour);
        self.buffer.extend_from_slice(word);
        self.word(b"", count, COARSE);
        self.buffer.push(b'\n');
    }

    /// Sets the acceleration of travels, for firmware that keeps one
    /// acceleration for travels and beads.
    fn accelerate_travel(&mut self) {
        if self.plan.flavour.firmware().one_acceleration {
            self.accelerate_printing(self.plan.limits.travel_acceleration);
        }
    }
}
