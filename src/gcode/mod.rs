//! The G-code: text only, every decision about geometry and speed is made.
//!
//! In: [`PacedLayer`]s in print order, the settings, and a [`Header`]. Out:
//! lines of G-code, written as they come, and the print's [`Totals`].
//!
//! Guarantees:
//! - coordinates have at most 3 decimals, filament 5, feed rates none; no
//!   exponent, no negative zero, no trailing zeros; the file ends in a line
//!   feed; the same print gives the same bytes;
//! - each line's filament is its bead's cross-section times the length between
//!   the *rounded* ends, so that rounding never shows as flow, and the rounding
//!   of the filament itself is carried on: the sum is right to half a unit of
//!   the last decimal however long the print is, with absolute and relative
//!   filament alike;
//! - a move whose end rounds to where the head stands is left out;
//! - the nozzle and the bed are waited for before the first layer;
//! - every command is one that the firmware knows;
//! - what is not a finite number is an error, never text;
//! - after [`Writer::restart`] the text does not depend on anything written
//!   before: layers written by several runs can be joined. Nothing in a layer
//!   tells how far the print has come, in time or filament, but the lines of
//!   `progress`, which only a file of the whole part has; the file's end has
//!   the totals.
//!
//! Not guaranteed: that the templates make sense to the firmware.
//!
//! | file | what it decides |
//! |---|---|
//! | `flavour` | what differs between firmwares |
//! | `comments` | the words that viewers and hosts read |
//! | `ends` | the file's head and foot |
//! | `thumbnail` | the pictures in the head |
//! | `label` | the part's name and outline, for hosts |
//! | `progress` | lines that need the whole print's time |
//! | `template` | the user's own lines; `placeholders`, what they may name; `scan`, what they do; `limits`, what they must not |
//! | `number` | how a number is written |

mod bounded;
mod comments;
mod ends;
mod flavour;
mod label;
mod limits;
mod number;
mod placeholders;
mod progress;
mod scan;
mod template;
mod thumbnail;

pub use comments::role_name;
pub use flavour::{default_end, default_start};
pub use placeholders::{PLACEHOLDERS, Placeholder, Scope};
pub use template::TemplateError;
pub use thumbnail::Thumbnail;

use crate::bead::{Bead, Role};
use crate::pace::{PacedLayer, PacedMove};
use crate::settings::{Comments, Emit, Flavour, Settings};
use crate::units::{
    Celsius, Mm, Mm3, MmPerSec, MmPerSec2, Percent, Seconds, feed_rate,
    filament_area,
};
use glam::{DVec2, DVec3};
use label::Label;
use number::{push_integer, push_scaled, scaled, text};
use placeholders::Moment;
use progress::Waiting;
use std::io::Write;
use std::ops::Range;
use std::time::SystemTime;
use template::Templates;

/// Decimals of coordinates: a micrometre.
const XYZ: u32 = 3;
/// Decimals of filament.
const E: u32 = 5;
/// Decimals of widths and heights in comments: at 0.1 mm a reader that
/// computes the flow from them is right to 0.05 %.
const WIDTH: u32 = 4;
/// Decimals of temperatures and accelerations.
const COARSE: u32 = 1;
/// Millimetres in a unit of the last decimal of a coordinate.
const MICRON: f64 = 1e-3;
/// Text after which the buffer is emptied, bytes: a large layer's is many
/// times that.
const FULL: usize = 1 << 16;
/// Units of the last decimal of filament in a millimetre.
const E_UNITS: f64 = 1e5;

/// What the file's start says about the print.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Name of the model, without folder and extension.
    pub model_name: String,
    /// How many layers the part has.
    pub layer_count: usize,
    /// Indices of those in this file.
    pub layers: Range<usize>,
    /// When it is written, if it is to say so.
    pub timestamp: Option<SystemTime>,
    /// Temperature of the nozzle on the first of them.
    pub nozzle_temperature: Celsius,
    /// Lower corner of the part, on the bed.
    pub part_min: DVec3,
    /// Upper corner of the part.
    pub part_max: DVec3,
    /// The part seen from above, on the bed: a convex ring around it. Where
    /// it is empty its box is taken.
    pub outline: Vec<DVec2>,
    /// Pictures of it.
    pub thumbnails: Vec<Thumbnail>,
}

/// What a print takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Length of filament fed.
    pub filament_length: Mm,
    /// Volume of it.
    pub filament_volume: Mm3,
    /// Mass of it, grams.
    pub filament_mass_g: f64,
    /// Time of all layers, without heating, homing and templates.
    pub time: Seconds,
    /// Number of layers written.
    pub layers: usize,
}

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The output could not be written to.
    #[error("cannot write the G-code")]
    Io(#[from] std::io::Error),
    /// A start or end template is wrong.
    #[error(transparent)]
    Template(#[from] TemplateError),
    /// A coordinate, speed or length that is no number, or beyond measure.
    #[error(
        "{what} of {value} on layer {layer}: this is a bug in isoslice, \
         please report it with the model"
    )]
    BadNumber {
        /// What it is.
        what: &'static str,
        /// The number.
        value: f64,
        /// Layer, from 1.
        layer: usize,
    },
}

/// Writes a print, layer by layer.
#[derive(Debug)]
pub struct Writer<'a, W: Write> {
    out: W,
    settings: &'a Settings,
    templates: Templates<'a>,
    label: Option<Label>,
    /// Where the text is until the whole time is known, if it has to be.
    waiting: Option<Waiting>,
    warnings: Vec<String>,
    /// Text not yet handed on; reused.
    buffer: Vec<u8>,
    totals: Totals,
    /// Filament that the firmware has fed by itself, mm.
    extra: Mm,
    layer: usize,

    // What the machine has been told so far, in units of last decimals;
    // nothing where a template may have changed it.
    xy: Option<(i64, i64)>,
    z: Option<i64>,
    feed: Option<i64>,
    fan: Option<i64>,
    nozzle: Option<Celsius>,
    acceleration: Option<i64>,
    role: Option<Role>,
    width: Option<i64>,
    height: Option<i64>,
    retracted: bool,
    filament: Filament,
}

/// The filament's position.
#[derive(Clone, Copy, Debug, Default)]
struct Filament {
    relative: bool,
    /// Fed into the print, exactly, mm.
    exact: f64,
    /// Pulled back at present, units of the last decimal.
    back: i64,
    /// Where the machine has been told to go since the start, units.
    told: i64,
    /// Where its last reset was, units; nothing if the next layer has to
    /// begin with one.
    zero: Option<i64>,
}

impl Filament {
    /// Brings the machine to where the filament should be: the number for an
    /// E word, or nothing if it is there.
    fn word(&mut self) -> Option<i64> {
        let goal = (self.exact * E_UNITS).round() as i64 - self.back;
        let step = goal - self.told;
        self.told = goal;
        let number = if self.relative {
            step
        } else {
            goal - self.zero.unwrap_or(0)
        };
        (step != 0).then_some(number)
    }
}

impl<'a, W: Write> Writer<'a, W> {
    /// Begins a file: header, start template, heating.
    ///
    /// # Errors
    /// If a template is wrong or the output cannot be written.
    pub fn new(
        out: W,
        settings: &'a Settings,
        header: &Header,
    ) -> Result<Self, WriteError> {
        let templates = Templates::new(settings, header)?;
        let start = templates.start()?;
        let whole = header.layers == (0..header.layer_count);
        let waiting = match whole && tells_progress(settings) {
            true => Some(Waiting::new()?),
            false => None,
        };
        let mut writer = Self {
            out,
            settings,
            templates,
            label: Label::new(settings, header),
            waiting,
            warnings: Vec::new(),
            buffer: Vec::with_capacity(2 * FULL),
            totals: Totals::default(),
            extra: 0.0,
            layer: 0,
            xy: None,
            z: None,
            feed: None,
            fan: None,
            nozzle: None,
            acceleration: None,
            role: None,
            width: None,
            height: None,
            retracted: false,
            filament: Filament {
                relative: settings.gcode.relative_e,
                zero: Some(0),
                ..Filament::default()
            },
        };
        writer.begin(&start, header)?;
        writer.flush()?;
        Ok(writer)
    }

    /// What the user should know about the templates.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Writes a layer.
    ///
    /// # Errors
    /// If the output cannot be written, or a number is none.
    pub fn layer(&mut self, layer: &PacedLayer) -> Result<(), WriteError> {
        let before = self.filament.exact + self.extra;
        self.compose(layer, Self::flush)?;
        let fed = self.filament.exact + self.extra - before;
        self.totals.filament_length += fed;
        self.totals.time += layer.time;
        self.totals.layers += 1;
        self.flush()
    }

    /// Does as if a layer were written, but writes and counts nothing: for
    /// the layers below the first one of the file.
    ///
    /// # Errors
    /// If a number is none.
    pub fn rehearse(&mut self, layer: &PacedLayer) -> Result<(), WriteError> {
        let forget = |writer: &mut Self| {
            writer.buffer.clear();
            Ok(())
        };
        self.compose(layer, forget)?;
        forget(self)
    }

    /// Forgets what the machine has been told, as if the next layer were
    /// written by a run of its own. The filament must be primed. Costs the
    /// filament half a unit of its last decimal.
    pub fn restart(&mut self) {
        self.xy = None;
        self.z = None;
        self.feed = None;
        self.fan = None;
        // Where it never changes it need not be told again.
        self.nozzle = self.settings.filament.nozzle_temperature.constant();
        self.acceleration = None;
        self.retracted = false;
        self.filament = Filament {
            relative: self.filament.relative,
            ..Filament::default()
        };
    }

    /// The text of a layer; `pass_on` empties the buffer whenever it is full.
    fn compose(
        &mut self,
        layer: &PacedLayer,
        pass_on: impl Fn(&mut Self) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        self.layer = layer.span.index;
        self.layer_comments(layer)?;
        // Readers that take a layer on its own want both in it.
        self.role = None;
        self.width = None;
        self.layer_template(layer)?;
        self.reset_filament();
        if flavour::print_stats(self.settings.gcode.flavour) {
            let current = self.layer + 1;
            self.line(&format!("SET_PRINT_STATS_INFO CURRENT_LAYER={current}"));
        }
        if self.layer == 1 {
            self.second_layer_temperature();
        }
        if self.layer > 0 && self.nozzle != Some(layer.nozzle_temperature) {
            self.nozzle = Some(layer.nozzle_temperature);
            self.temperature("M104", layer.nozzle_temperature);
        }
        self.set_fan(layer.fan);
        let labelled = labelled(&layer.moves);
        let label = match labelled.is_empty() {
            true => None,
            false => self.label.clone(),
        };
        let mut clock = Clock::new(layer);
        self.mark(clock.time());
        for (i, step) in layer.moves.iter().enumerate() {
            if i == labelled.start
                && let Some(label) = &label
            {
                self.line(&label.start);
            }
            self.step(step)?;
            if self.waiting.is_some() {
                clock.step(step);
                self.mark_if_due(clock.time());
            }
            if self.buffer.len() >= FULL {
                pass_on(self)?;
            }
        }
        if let Some(label) = &label {
            self.line(&label.end);
        }
        self.count("time", layer.time, XYZ)?;
        Ok(())
    }

    /// Tells readers that a layer begins.
    fn layer_comments(&mut self, layer: &PacedLayer) -> Result<(), WriteError> {
        let z = self.count("z", layer.span.top, XYZ)?;
        let height = self.count("layer height", layer.span.height(), WIDTH)?;
        self.height = Some(height);
        match self.settings.gcode.comments {
            Comments::Prusa | Comments::Orca => {
                self.line(";LAYER_CHANGE");
                self.comment_number(";Z:", z, XYZ);
                self.comment_number(";HEIGHT:", height, WIDTH);
            }
            Comments::Cura => self.line(&format!(";LAYER:{}", self.layer)),
            Comments::None => {}
        }
        Ok(())
    }

    /// The user's own lines for a layer. The machine may be anywhere, and in
    /// any mode, after them.
    fn layer_template(&mut self, layer: &PacedLayer) -> Result<(), WriteError> {
        let moment = Moment {
            number: self.layer + 1,
            z: layer.span.top,
            height: layer.span.height(),
        };
        let Some(lines) = self.templates.layer(moment)? else {
            return Ok(());
        };
        self.buffer.extend_from_slice(lines.as_bytes());
        if scan::may_change_modes(&lines) {
            self.modes();
        }
        self.xy = None;
        self.z = None;
        self.feed = None;
        self.fan = None;
        self.acceleration = None;
        self.filament.zero = None;
        Ok(())
    }

    /// Marks a place that tells how far the print has come; `time` is that
    /// since the layer's beginning.
    fn mark(&mut self, time: Seconds) {
        let time = self.totals.time + time;
        if let Some(waiting) = &mut self.waiting {
            waiting.mark(self.buffer.len(), time);
        }
    }

    /// The same, if the last one was long ago.
    fn mark_if_due(&mut self, time: Seconds) {
        let last = self.waiting.as_ref().and_then(Waiting::last);
        let since = self.totals.time + time - last.unwrap_or(0.0);
        if since >= progress::BETWEEN {
            self.mark(time);
        }
    }

    /// Ends the file: last retraction, fan off, end template, what the print
    /// takes.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn finish(mut self) -> Result<Totals, WriteError> {
        if self.settings.gcode.comments != Comments::None {
            self.line(comments::END_OF_LAYERS);
        }
        let retract = &self.settings.retract;
        if self.totals.layers > 0 && !self.retracted && retract.length > 0.0 {
            // By the file even where the firmware retracts: it would take
            // the next print's first retraction for done.
            self.filament.back = self.count("retraction", retract.length, E)?;
            self.filament_move(retract.speed)?;
        }
        self.set_fan(0.0);
        self.custom_comment();
        let filament = &self.settings.filament;
        let totals = &mut self.totals;
        totals.filament_volume =
            totals.filament_length * filament_area(filament.diameter);
        // Density is in g/cm³.
        totals.filament_mass_g =
            totals.filament_volume * 1e-3 * filament.density;
        let end = self.templates.end(self.totals)?;
        self.buffer.extend_from_slice(end.as_bytes());
        self.mark(0.0);
        self.footer();
        self.flush()?;
        if let Some(waiting) = self.waiting.take() {
            let flavour = self.settings.gcode.flavour;
            let line = |p, m| flavour::progress(flavour, p, m);
            waiting.release(&mut self.out, self.totals.time, line)?;
        }
        self.out.flush()?;
        Ok(self.totals)
    }

    fn step(&mut self, step: &PacedMove) -> Result<(), WriteError> {
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
                self.accelerate(self.settings.printer.travel_acceleration);
                for &p in points {
                    self.go(p, *speed, None)?;
                }
                Ok(())
            }
            PacedMove::Print { bead, speed, flow } => {
                self.bead(bead, *speed, *flow)
            }
            PacedMove::Fan(speed) => {
                self.set_fan(*speed);
                Ok(())
            }
        }
    }

    fn bead(
        &mut self,
        bead: &Bead,
        speed: MmPerSec,
        flow: f64,
    ) -> Result<(), WriteError> {
        if self.role != Some(bead.role) {
            let dialect = self.settings.gcode.comments;
            let name = |role| role_name(dialect, role);
            // Several roles may have one name.
            if self.role.and_then(name) != name(bead.role) {
                self.type_comment(name(bead.role));
            }
            self.role = Some(bead.role);
        }
        let width = self.count("bead width", bead.width, WIDTH)?;
        let height = self.count("bead height", bead.height, WIDTH)?;
        if comments::has_sizes(self.settings.gcode.comments) {
            if self.width != Some(width) {
                self.width = Some(width);
                self.comment_number(";WIDTH:", width, WIDTH);
            }
            if self.height != Some(height) {
                self.height = Some(height);
                self.comment_number(";HEIGHT:", height, WIDTH);
            }
        }
        self.accelerate(self.settings.printer.acceleration);
        let area =
            bead.area() * flow / filament_area(self.settings.filament.diameter);
        let mut path = bead.path();
        // The head is there already, or the line is left out.
        if let Some(start) = path.next() {
            self.go(start, speed, None)?;
        }
        for p in path {
            self.go(p, speed, Some(area))?;
        }
        Ok(())
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

    fn lift(&mut self, z: Mm, speed: MmPerSec) -> Result<(), WriteError> {
        let z = self.count("z", z, XYZ)?;
        if self.z == Some(z) {
            return Ok(());
        }
        self.accelerate(self.settings.printer.travel_acceleration);
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
        if self.settings.retract.firmware {
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
        self.accelerate(self.settings.printer.travel_acceleration);
        let marked = comments::has_sizes(self.settings.gcode.comments);
        if marked {
            self.line(comments::WIPE_START);
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
        // What rounding has left, if the last points are one place.
        self.filament.back = before + back;
        self.retracted = true;
        self.filament_move(self.settings.retract.speed)?;
        if marked {
            self.line(comments::WIPE_END);
        }
        Ok(())
    }

    fn prime(&mut self, extra: Mm, speed: MmPerSec) -> Result<(), WriteError> {
        if self.settings.retract.firmware {
            // What is always fed in addition, the firmware knows.
            let mut own = 0.0;
            if std::mem::take(&mut self.retracted) {
                self.line("G11");
                own = self.settings.retract.extra_prime;
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

    /// Adds to what is fed into the print.
    fn feed_filament(&mut self, length: Mm) -> Result<(), WriteError> {
        self.filament.exact += length;
        self.count("filament length", self.filament.exact, E)
            .map(|_| ())
    }

    /// A move of the filament alone.
    fn filament_move(&mut self, speed: MmPerSec) -> Result<(), WriteError> {
        let Some(e) = self.filament.word() else {
            return Ok(());
        };
        self.buffer.extend_from_slice(b"G1");
        self.word(b" E", e, E);
        self.end_move(speed)
    }

    /// The feed rate if it changes, and the line's end.
    fn end_move(&mut self, speed: MmPerSec) -> Result<(), WriteError> {
        let feed = self.count("speed", feed_rate(speed), 0)?;
        // Zero would stop the print for good; the slowest is 1 mm/min.
        let feed = feed.max(1);
        if self.feed != Some(feed) {
            self.feed = Some(feed);
            self.word(b" F", feed, 0);
        }
        self.buffer.push(b'\n');
        Ok(())
    }

    /// Absolute positions of the filament start again from zero now and then:
    /// firmware keeps them in single precision.
    fn reset_filament(&mut self) {
        let filament = &mut self.filament;
        let zero = Some(filament.told);
        if !filament.relative && filament.zero != zero {
            filament.zero = zero;
            self.line("G92 E0");
        }
    }

    /// Units and modes this writer relies on.
    fn modes(&mut self) {
        self.line("G21");
        self.line("G90");
        self.line(match self.filament.relative {
            true => "M83",
            false => "M82",
        });
    }

    fn second_layer_temperature(&mut self) {
        let f = &self.settings.filament;
        if f.bed_temperature != f.first_layer_bed_temperature {
            self.temperature("M140", f.bed_temperature);
        }
    }

    fn temperature(&mut self, command: &str, to: Celsius) {
        self.line(&format!("{command} S{}", text(to, COARSE)));
    }

    fn set_fan(&mut self, speed: Percent) {
        let pwm = flavour::pwm(speed);
        if self.fan != Some(pwm) {
            self.fan = Some(pwm);
            self.line(&flavour::fan(self.settings.gcode.flavour, pwm));
        }
    }

    /// Sets the acceleration where the firmware has one for all moves.
    fn accelerate(&mut self, to: MmPerSec2) {
        let gcode = &self.settings.gcode;
        if !gcode.set_limits || !flavour::one_acceleration(gcode.flavour) {
            return;
        }
        let count = scaled(to, COARSE);
        if count.is_some() && self.acceleration != count {
            self.acceleration = count;
            self.buffer.extend_from_slice(b"M204");
            self.word(b" S", count.unwrap_or(0), COARSE);
            self.buffer.push(b'\n');
        }
    }

    fn type_comment(&mut self, name: Option<&str>) {
        if let Some(name) = name {
            self.buffer.extend_from_slice(b";TYPE:");
            self.line(name);
        }
    }

    /// What a template prints is not the part.
    fn custom_comment(&mut self) {
        self.type_comment(comments::custom(self.settings.gcode.comments));
    }

    fn comment_number(&mut self, tag: &str, count: i64, decimals: u32) {
        self.buffer.extend_from_slice(tag.as_bytes());
        push_scaled(&mut self.buffer, count, decimals);
        self.buffer.push(b'\n');
    }

    fn word(&mut self, letter: &[u8], count: i64, decimals: u32) {
        self.buffer.extend_from_slice(letter);
        match u64::try_from(count) {
            Ok(whole) if decimals == 0 => {
                push_integer(&mut self.buffer, whole);
            }
            _ => push_scaled(&mut self.buffer, count, decimals),
        }
    }

    fn line(&mut self, text: &str) {
        self.buffer.extend_from_slice(text.as_bytes());
        self.buffer.push(b'\n');
    }

    /// A number as a count of last decimals, or the error that it is none.
    fn count(
        &self,
        what: &'static str,
        value: f64,
        decimals: u32,
    ) -> Result<i64, WriteError> {
        scaled(value, decimals).ok_or(WriteError::BadNumber {
            what,
            value,
            layer: self.layer + 1,
        })
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        match &mut self.waiting {
            Some(waiting) => waiting.write(&self.buffer)?,
            None => self.out.write_all(&self.buffer)?,
        }
        self.buffer.clear();
        Ok(())
    }
}

/// True if layers are to tell how far the print has come.
fn tells_progress(settings: &Settings) -> bool {
    match settings.gcode.progress {
        Emit::On => true,
        Emit::Off => false,
        Emit::Auto => settings.gcode.flavour == Flavour::Prusa,
    }
}

/// Which of a layer's moves print the part, and not a skirt before it, with
/// the way there; none if nothing of the part is printed.
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

/// How far a layer has come in time: its share of the printing moves at their
/// speeds.
struct Clock {
    time: Seconds,
    printing: Seconds,
    passed: Seconds,
}

impl Clock {
    fn new(layer: &PacedLayer) -> Self {
        Self {
            time: layer.time,
            printing: layer.moves.iter().map(printing).sum(),
            passed: 0.0,
        }
    }

    fn step(&mut self, step: &PacedMove) {
        self.passed += printing(step);
    }

    fn time(&self) -> Seconds {
        match self.printing > 0.0 {
            true => self.time * self.passed / self.printing,
            false => 0.0,
        }
    }
}

fn printing(step: &PacedMove) -> Seconds {
    match step {
        PacedMove::Print { bead, speed, .. } => bead.length() / speed,
        _ => 0.0,
    }
}
