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
//! - what is not a finite number is an error, never text;
//! - after [`Writer::restart`] the text does not depend on anything written
//!   before: layers written by several runs can be joined. Nothing in a layer
//!   tells how far the print has come, in time or filament; the file's end
//!   has the totals.
//!
//! Not guaranteed: that the templates make sense to the firmware.
//!
//! | file | what it decides |
//! |---|---|
//! | `flavour` | what differs between firmwares |
//! | `comments` | the words that viewers and hosts read |
//! | `template` | placeholders in the start and end lines |
//! | `number` | how a number is written |

mod comments;
mod flavour;
mod number;
mod template;

pub use comments::role_name;
pub use flavour::{default_end, default_start};
pub use template::{PLACEHOLDERS, Placeholder, TemplateError};

use crate::bead::{Bead, Role};
use crate::pace::{PacedLayer, PacedMove};
use crate::settings::Settings;
use crate::units::{
    Celsius, Mm, Mm3, MmPerSec, MmPerSec2, Percent, Seconds, feed_rate,
    filament_area, human_time,
};
use glam::{DVec2, DVec3};
use number::{push_integer, push_scaled, scaled, text};
use std::io::Write;
use std::ops::Range;
use template::{Heating, heating};

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
    /// Temperature of the nozzle on the first of them.
    pub nozzle_temperature: Celsius,
    /// Lower corner of the part, on the bed.
    pub part_min: DVec3,
    /// Upper corner of the part.
    pub part_max: DVec3,
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
    /// Rendered before the first line is written, so that a mistake in it
    /// does not turn up after hours of output.
    end: String,
    /// Text not yet handed on; reused.
    buffer: Vec<u8>,
    totals: Totals,
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
        let gcode = &settings.gcode;
        let own = |text: &'a str, default| match text.trim().is_empty() {
            true => default,
            false => text,
        };
        let start = own(&gcode.start, default_start(gcode.flavour));
        let end = own(&gcode.end, default_end(gcode.flavour));
        let rendered =
            template::render("gcode.start", start, settings, header)?;
        let mut end = template::render("gcode.end", end, settings, header)?;
        if gcode.end.trim().is_empty() && !bed_heated(settings) {
            end = end.replace("M140 S0\n", "");
        }
        let mut writer = Self {
            out,
            settings,
            end,
            buffer: Vec::with_capacity(2 * FULL),
            totals: Totals::default(),
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
                relative: gcode.relative_e,
                zero: Some(0),
                ..Filament::default()
            },
        };
        writer.begin(start, &rendered, header);
        writer.flush()?;
        Ok(writer)
    }

    /// Header to heating. `source` is the start template as written by the
    /// user, `rendered` what became of it.
    fn begin(&mut self, source: &str, rendered: &str, header: &Header) {
        let settings = self.settings;
        let filament = &settings.filament;
        self.line(concat!(
            "; generated by isoslice ",
            env!("CARGO_PKG_VERSION")
        ));
        let (Range { start, end }, count) =
            (&header.layers, header.layer_count);
        if header.layers != (0..count) {
            self.line(&format!("; layers {} to {end} of {count}", start + 1));
        }
        self.modes();

        let bed = match bed_heated(settings) {
            true => heating(
                source,
                "M140",
                "M190",
                &["bed_temperature", "first_layer_bed_temperature"],
            ),
            false => Heating::Waits,
        };
        let nozzle = heating(
            source,
            "M104",
            "M109",
            &["nozzle_temperature", "first_layer_nozzle_temperature"],
        );
        // The second layer changes the temperatures itself.
        let (bed_to, nozzle_to) = match header.layers.start {
            0 | 1 => (
                filament.first_layer_bed_temperature,
                filament.first_layer_nozzle_temperature,
            ),
            _ => (filament.bed_temperature, header.nozzle_temperature),
        };
        self.nozzle = Some(nozzle_to);
        if bed == Heating::Not {
            self.temperature("M140", bed_to);
        }
        if nozzle == Heating::Not {
            self.temperature("M104", nozzle_to);
        }
        self.type_comment(comments::CUSTOM);
        self.buffer.extend_from_slice(rendered.as_bytes());
        if bed != Heating::Waits {
            self.temperature("M190", bed_to);
        }
        if nozzle != Heating::Waits {
            self.temperature("M109", nozzle_to);
        }
        if template::may_change_modes(source) {
            self.modes();
        }
        self.line("G92 E0");
        if !flavour::one_acceleration(settings.gcode.flavour) {
            let printer = &settings.printer;
            let (p, t) = (printer.acceleration, printer.travel_acceleration);
            let words =
                format!("M204 P{} T{}", text(p, COARSE), text(t, COARSE));
            self.line(&words);
        }
        if flavour::print_stats(settings.gcode.flavour) {
            let count = header.layer_count;
            self.line(&format!("SET_PRINT_STATS_INFO TOTAL_LAYER={count}"));
        }
    }

    /// Writes a layer.
    ///
    /// # Errors
    /// If the output cannot be written, or a number is none.
    pub fn layer(&mut self, layer: &PacedLayer) -> Result<(), WriteError> {
        let before = self.filament.exact;
        self.compose(layer, Self::flush)?;
        self.totals.filament_length += self.filament.exact - before;
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
        self.line(";LAYER_CHANGE");
        let z = self.count("z", layer.span.top, XYZ)?;
        self.comment_number(";Z:", z, XYZ);
        let height = self.count("layer height", layer.span.height(), WIDTH)?;
        self.comment_number(";HEIGHT:", height, WIDTH);
        self.height = Some(height);
        // Readers that take a layer on its own want both in it.
        self.role = None;
        self.width = None;

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
        for step in &layer.moves {
            self.step(step)?;
            if self.buffer.len() >= FULL {
                pass_on(self)?;
            }
        }
        self.count("time", layer.time, XYZ)?;
        Ok(())
    }

    /// Ends the file: last retraction, fan off, end template, what the print
    /// takes.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn finish(mut self) -> Result<Totals, WriteError> {
        self.line(comments::END_OF_LAYERS);
        let retract = &self.settings.retract;
        if self.totals.layers > 0 && !self.retracted && retract.length > 0.0 {
            self.retract(retract.length, retract.speed)?;
        }
        self.set_fan(0.0);
        self.type_comment(comments::CUSTOM);
        let end = std::mem::take(&mut self.end);
        self.buffer.extend_from_slice(end.as_bytes());

        let filament = &self.settings.filament;
        let totals = &mut self.totals;
        totals.filament_volume =
            totals.filament_length * filament_area(filament.diameter);
        // Density is in g/cm³.
        totals.filament_mass_g =
            totals.filament_volume * 1e-3 * filament.density;
        self.footer();
        self.flush()?;
        self.out.flush()?;
        Ok(self.totals)
    }

    fn footer(&mut self) {
        let (s, t) = (self.settings, self.totals);
        self.line("; times are without heating and homing");
        let mut key = |name: &str, value: &str| {
            self.buffer
                .extend_from_slice(format!("; {name} = {value}\n").as_bytes());
        };
        key("filament used [mm]", &text(t.filament_length, 2));
        key("filament used [cm3]", &text(t.filament_volume * 1e-3, 2));
        key("filament used [g]", &text(t.filament_mass_g, 2));
        key("total filament used [g]", &text(t.filament_mass_g, 2));
        key("estimated printing time (normal mode)", &human_time(t.time));
        key("total layers count", &t.layers.to_string());
        key("layer_height", &text(s.layer_height, WIDTH));
        key("first_layer_height", &text(s.first_layer_height, WIDTH));
        key("nozzle_diameter", &text(s.printer.nozzle_diameter, 3));
        key("filament_diameter", &text(s.filament.diameter, 3));
        key("filament_density", &text(s.filament.density, 3));
        key(
            "first_layer_temperature",
            &text(s.filament.first_layer_nozzle_temperature, COARSE),
        );
        key(
            "first_layer_bed_temperature",
            &text(s.filament.first_layer_bed_temperature, COARSE),
        );
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
            self.role = Some(bead.role);
            self.type_comment(role_name(bead.role));
        }
        let width = self.count("bead width", bead.width, WIDTH)?;
        if self.width != Some(width) {
            self.width = Some(width);
            self.comment_number(";WIDTH:", width, WIDTH);
        }
        let height = self.count("bead height", bead.height, WIDTH)?;
        if self.height != Some(height) {
            self.height = Some(height);
            self.comment_number(";HEIGHT:", height, WIDTH);
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
        self.filament.back = self.count("retraction", length, E)?;
        self.retracted = true;
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
        self.line(comments::WIPE_START);
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
        self.line(comments::WIPE_END);
        Ok(())
    }

    fn prime(&mut self, extra: Mm, speed: MmPerSec) -> Result<(), WriteError> {
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
        // 0 to 255 for 0 to 100 %.
        let pwm = scaled(speed.clamp(0.0, 100.0) * 2.55, 0).unwrap_or(0);
        if self.fan == Some(pwm) {
            return;
        }
        self.fan = Some(pwm);
        if pwm == 0 {
            self.line("M107");
        } else {
            self.line(&format!("M106 S{pwm}"));
        }
    }

    /// Sets the acceleration where the firmware has one for all moves.
    fn accelerate(&mut self, to: MmPerSec2) {
        if !flavour::one_acceleration(self.settings.gcode.flavour) {
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

    fn type_comment(&mut self, name: &str) {
        self.buffer.extend_from_slice(b";TYPE:");
        self.line(name);
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
        self.out.write_all(&self.buffer)?;
        self.buffer.clear();
        Ok(())
    }
}

/// False if the bed stays cold: a printer without a heated bed may not know
/// the commands for one.
fn bed_heated(settings: &Settings) -> bool {
    let filament = &settings.filament;
    filament.bed_temperature > 0.0 || filament.first_layer_bed_temperature > 0.0
}
