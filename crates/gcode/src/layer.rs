//! A layer's text: its marks, the user's own lines, the label and the steps.

use super::label::Around;
use super::placeholders::Moment;
use super::progress::Clock;
use super::{FULL, WIDTH, WriteError, Writer, XYZ, comments, flavour, scan};
use glam::DVec2;
use isoslice_base::units::{MICRON, Mm};
use isoslice_path::pace::{APPROACH, OfPart, PacedLayer, PacedMove};
use isoslice_planar::bead::{Bead, Role};
use isoslice_settings::Comments;
use std::io::Write;
use std::ops::Range;

impl<W: Write> Writer<'_, W> {
    /// Appends the text of a layer to the buffer. `pass_on` empties the buffer
    /// whenever it is full.
    pub(super) fn compose(
        &mut self,
        layer: &PacedLayer,
        pass_on: impl Fn(&mut Self) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        self.layer = layer.before + layer.span.index;
        self.top = layer.span.top;
        self.layer_comments(layer)?;
        // The user's own lines may set another temperature, so they come later.
        match layer.span.index {
            0 if layer.before > 0 => self.first_layer_again(),
            1 => self.second_layer_temperature(),
            _ => {}
        }
        if self.layer > 0 && self.nozzle != Some(layer.nozzle_temperature) {
            self.nozzle = Some(layer.nozzle_temperature);
            self.temperature("M104", layer.nozzle_temperature);
        }
        self.layer_template(layer)?;
        self.reset_filament();
        let flavour = self.plan.flavour;
        for line in flavour::layer_begins(flavour, self.layer + 1) {
            self.line(&line);
        }
        self.set_fan(layer.fan);
        let mut labels = self.labels_in(layer).into_iter().peekable();
        let mut open: Option<(usize, String)> = None;
        let forgetful = flavour.firmware().forgets_place;
        let mut lifted = None;
        let mut clock = Clock::new(layer);
        let tells = self.waiting.is_some() || self.record.is_some();
        if let Some(time) = clock.moment().filter(|_| tells) {
            self.moment(time);
        }
        for (i, step) in layer.moves.iter().enumerate() {
            if let Some((_, end)) = open.take_if(|(last, _)| *last == i) {
                self.line(&end);
            }
            if let Some((moves, label)) =
                labels.next_if(|(moves, _)| moves.start == i)
            {
                if let Some((z, speed)) = lifted.filter(|_| forgetful) {
                    // The machine may have left out the part that moved there.
                    self.z = None;
                    self.lift(z, speed)?;
                }
                self.line(&label.start);
                open = Some((moves.end, label.end));
            }
            if let PacedMove::Print { bead, .. } = step {
                self.supports |= bead.role.is_support();
            }
            if let PacedMove::Print { bead, .. } = step
                && (bead.plane.of_supports() - self.plane).abs() > MICRON
            {
                self.plane_comments(bead)?;
            }
            self.step(step)?;
            if let PacedMove::Lift { z, speed } = step {
                lifted = Some((*z, *speed));
            }
            if tells {
                clock.step(step);
                if let Some(time) = clock.moment() {
                    self.moment(time);
                }
            }
            if self.buffer.len() >= FULL {
                pass_on(self)?;
            }
        }
        if let Some((_, end)) = open {
            self.line(&end);
        }
        self.count("time", layer.time, XYZ)?;
        Ok(())
    }

    /// The labels of a layer's parts, each with the moves that it encloses.
    fn labels_in(&self, layer: &PacedLayer) -> Vec<(Range<usize>, Around)> {
        let around = |part: &OfPart| {
            let label = self.labels.around.get(part.place?)?;
            let of_part = layer.moves.get(part.moves.clone())?;
            let moves = labelled(of_part);
            let first = part.moves.start;
            (!moves.is_empty()).then(|| {
                let moves = first + moves.start..first + moves.end;
                (moves, label.clone())
            })
        };
        layer.parts.iter().filter_map(around).collect()
    }

    /// Brings the machine to where the layers below leave it, and tells it what
    /// they tell it, if those layers are in another file. `layer` is the first
    /// one of this file.
    pub(super) fn catch_up(
        &mut self,
        layer: &PacedLayer,
    ) -> Result<(), WriteError> {
        let (feed, acceleration) = (self.feed.take(), self.acceleration);
        let approach = self.approach(layer);
        self.time_approach(approach.as_ref().map_or(&*layer.moves, |a| &a[..]));
        if let Some(way) = approach {
            // The machine is where the file's head leaves it.
            (self.xy, self.z) = (None, None);
            way.iter().try_for_each(|step| self.step(step))?;
        }
        (self.feed, self.acceleration) = (feed, acceleration);
        let flavour = self.plan.flavour;
        if let Some(pwm) = self.fan.filter(|&pwm| pwm > 0) {
            self.line(&flavour::fan(flavour, pwm));
        }
        if let Some(count) = self.acceleration {
            self.tell_acceleration(count);
        }
        if let Some(feed) = self.feed {
            self.line(&format!("G1 F{feed}"));
        }
        Ok(())
    }

    /// The way to where the layers below leave the head, from above, if a layer
    /// goes on there without a travel.
    fn approach(&self, layer: &PacedLayer) -> Option<[PacedMove; 3]> {
        let first = layer.moves.iter().find(|step| {
            use PacedMove::{Print, Travel};
            matches!(step, Travel { .. } | Print { .. })
        });
        let goes_on = matches!(first, Some(PacedMove::Print { .. }));
        let ((x, y), z) = self.xy.zip(self.z).filter(|_| goes_on)?;
        let at = DVec2::new(x as f64, y as f64) * MICRON;
        let z = z as f64 * MICRON;
        let lift = |z| PacedMove::Lift {
            z,
            speed: self.plan.limits.speed_z,
        };
        let travel = PacedMove::Travel {
            points: vec![at],
            speed: self.plan.travel_speed,
        };
        Some([lift(z + APPROACH), travel, lift(z)])
    }

    /// Writes the comments that mark the beginning of a layer.
    pub(super) fn layer_comments(
        &mut self,
        layer: &PacedLayer,
    ) -> Result<(), WriteError> {
        if self.plan.comments == Comments::Cura {
            self.line(&format!(";LAYER:{}", self.layer));
        }
        self.plane = 0.0;
        let mut printed = layer.moves.iter().filter_map(|step| match step {
            PacedMove::Print { bead, .. } => Some(bead),
            _ => None,
        });
        match printed
            .next()
            .filter(|bead| bead.plane.of_supports() != 0.0)
        {
            Some(bead) => self.plane_comments(bead),
            None => self.height_comments(layer.span.height()),
        }
    }

    /// Writes the comments before a bead that lies at another height than those
    /// before it in its layer. Viewers show such beads as a layer of their own.
    fn plane_comments(&mut self, bead: &Bead) -> Result<(), WriteError> {
        self.plane = bead.plane.of_supports();
        self.height_comments(bead.height)
    }

    /// Writes the comments before beads of some height whose tops are in the
    /// plane.
    fn height_comments(&mut self, height: Mm) -> Result<(), WriteError> {
        let z = self.count("z", self.top + self.plane, XYZ)?;
        let height = self.count("layer height", height, WIDTH)?;
        self.height = Some(height);
        // Some readers look at a layer alone, so each layer names its first
        // role and width.
        self.role = None;
        self.width = None;
        if let Some(words) = comments::words(self.plan.comments) {
            self.line(words.layer);
            self.comment_number(words.z, z, XYZ);
            self.comment_number(words.height, height, WIDTH);
        }
        Ok(())
    }

    /// Writes the user's own lines for a layer. The machine may be in any mode
    /// after them, and anywhere if they may move it.
    pub(super) fn layer_template(
        &mut self,
        layer: &PacedLayer,
    ) -> Result<(), WriteError> {
        let moment = Moment {
            number: self.layer + 1,
            bottom: layer.span.bottom,
            z: layer.span.top,
            height: layer.span.height(),
        };
        let Some(lines) = self.templates.layer(moment)? else {
            return Ok(());
        };
        self.buffer.extend_from_slice(lines.as_bytes());
        if let Some(pauses) = &mut self.pauses {
            pauses.seen(&lines);
        }
        if scan::may_change_modes(&lines) {
            self.modes();
        }
        self.feed = None;
        self.fan = None;
        self.acceleration = None;
        self.filament.zero = None;
        if scan::may_move(&lines) {
            self.z = None;
            // Another part begins somewhere else, beside parts that are higher.
            if layer.before > 0 && layer.span.index == 0 {
                self.xy = None;
            }
            self.go_back()?;
        }
        Ok(())
    }

    /// Goes back across to where the machine was, if that is known, at the height at
    /// which lines of the user's own have left it. It comes down to the layer there, as
    /// nothing of the part is higher.
    fn go_back(&mut self) -> Result<(), WriteError> {
        let Some((x, y)) = self.xy.take() else {
            return Ok(());
        };
        let at = DVec2::new(x as f64, y as f64) * MICRON;
        let speed = self.plan.travel_speed;
        let points = vec![at];
        self.step(&PacedMove::Travel { points, speed })
    }

    /// Sets the temperatures of the first layer for a part that follows others.
    /// Nothing waits for them, since both temperatures are near each other.
    fn first_layer_again(&mut self) {
        let [first, above] = self.plan.bed_temperatures;
        if above != first {
            self.temperature("M140", first);
        }
    }

    pub(super) fn second_layer_temperature(&mut self) {
        let [first, above] = self.plan.bed_temperatures;
        if above != first {
            self.temperature("M140", above);
        }
    }
}

/// The moves that print a part, with the travel to the part, but without the
/// skirt before it. The range is empty if nothing of the part is printed.
fn labelled(moves: &[PacedMove]) -> Range<usize> {
    let is = |m: &PacedMove, skirt: bool| {
        matches!(m, PacedMove::Print { bead, .. }
            if (bead.role == Role::Skirt) == skirt)
    };
    if !moves.iter().any(|m| is(m, false)) {
        return 0..0;
    }
    let skirt = moves.iter().rposition(|m| is(m, true));
    skirt.map_or(0, |i| i + 1)..moves.len()
}
