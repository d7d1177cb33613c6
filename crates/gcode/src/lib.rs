//! Writes the G-code. Every decision about geometry and speed has been made
//! before.
//!
//! In: [`PacedLayer`]s in print order, a [`WriterPlan`], and a [`Header`]. Out:
//! lines of G-code, written as they come, and the print's [`Totals`].
//!
//! Guarantees:
//! - coordinates have at most 3 decimals, filament 5, feed rates none; no
//!   exponent, no negative zero, no trailing zeros; the file ends in a line
//!   feed; the same print gives the same bytes;
//! - each line's filament is its bead's cross-section times the length between
//!   the *rounded* ends, so that rounding never shows as flow, and the rounding
//!   of the filament itself is carried on: the sum is right to half a unit of
//!   the last decimal for each layer, with absolute and relative filament alike;
//! - a move whose end rounds to where the head stands is left out;
//! - the nozzle and the bed are waited for before the first layer;
//! - every command is one that the firmware knows;
//! - a number that is not finite is an error, never text;
//! - the text of a layer does not depend on anything written before it: layers
//!   written by several runs can be joined. Only the lines of
//!   `progress` tell how far the print has come, and only a file of the whole
//!   part has them; the file's end has the totals. The file of a range has a
//!   manifest, from which [`Ranges`] makes both.
//!
//! Not guaranteed: that the templates make sense to the firmware.
//!
//! | file | what it decides |
//! |---|---|
//! | `flavour` | what differs between firmwares |
//! | `name` | the format, by the file's name |
//! | `comments` | the words that viewers and hosts read |
//! | `ends` | the file's head and foot; `facts`, `own`, what the foot says |
//! | `sink` | text, or the binary form of it |
//! | `layer` | what a layer's text consists of |
//! | `plan` | what is needed of the settings |
//! | `moves` | moves, as lines that say only what changes; `filament`, how far it has been fed; `lines`, `number`, how they are written |
//! | `thumbnail` | the pictures in the head |
//! | `label` | the parts' names and outlines, for hosts |
//! | `progress` | lines that need the whole print's time |
//! | `manifest` | what a range's file says about itself; `join`, one file of the files of all ranges |
//! | `time` | how long the file's head and foot take |
//! | `template` | the user's own lines; `placeholders`, what they may name; `scan`, what they do; `limits`, what they must not; `pauses`, what none of the layers had |

#![warn(unreachable_pub)]

mod comments;
mod ends;
mod facts;
mod filament;
mod flavour;
mod join;
mod label;
mod layer;
mod limits;
mod lines;
mod manifest;
mod moves;
mod name;
mod number;
mod own;
mod pauses;
mod placeholders;
mod plan;
mod progress;
mod scan;
mod sink;
mod template;
#[cfg(test)]
mod tests;
mod thumbnail;
mod time;

pub use ends::version;
pub use join::{JoinError, Joined, Ranges};
pub use manifest::Fingerprint;
pub use name::FormatError;
pub use own::settings_in_gcode;
pub(crate) use placeholders::PLACEHOLDERS;
pub use plan::WriterPlan;
pub use template::{TemplateError, is_placeholder, try_templates};
pub use thumbnail::Thumbnail;

use filament::Filament;
use glam::{DVec2, DVec3};
use isoslice_base::units::{Celsius, Mm, Mm3, Seconds};
use isoslice_gcode_read::bgcode;
use isoslice_gcode_read::package;
use isoslice_path::pace::PacedLayer;
use isoslice_planar::bead::Role;
use isoslice_settings::{Comments, Flavour};
use label::Labels;
use manifest::Record;
use number::text;
use pauses::Pauses;
use progress::Waiting;
use sink::Sink;
use std::io::Write;
use std::ops::Range;
use std::time::SystemTime;
use template::Templates;

/// Decimals of coordinates: a micrometre.
const XYZ: u32 = 3;
/// Decimals of filament.
const E: u32 = 5;
/// Decimals of widths and heights in comments. A reader that computes the flow
/// of a bead of 0.1 mm from them is right to 0.05 %.
const WIDTH: u32 = 4;
/// Decimals of temperatures and accelerations.
const COARSE: u32 = 1;
/// Length of text at which the buffer is emptied, bytes. The text of a large
/// layer is many times as long.
const FULL: usize = 1 << 16;

/// What a file is written as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// Text, which every printer reads.
    #[default]
    Text,
    /// Binary G-code for Prusa's printers: the text, packed.
    Binary,
    /// A sliced plate for Bambu Lab's printers: an archive with the text.
    Plate,
}

impl Format {
    /// A warning if printers with this firmware may not read such a file.
    pub fn unusual_for(self, flavour: Flavour) -> Option<String> {
        let firmware = flavour.firmware();
        let told = match self {
            Format::Binary if !firmware.reads_binary => {
                "binary G-code is for Prusa's printers from the MINI and \
                 MK3.5 on, but gcode.flavour is not \"prusa\""
            }
            Format::Plate if !firmware.reads_plates => {
                "a file .gcode.3mf is for Bambu Lab's printers, but \
                 gcode.flavour is not \"bambu\"; --printer bambu-a1 sets it"
            }
            _ => return None,
        };
        Some(told.to_owned())
    }

    /// The format of files for printers with this firmware, if nobody names
    /// another one.
    pub fn usual_for(flavour: Flavour) -> Format {
        if flavour.firmware().reads_plates {
            Format::Plate
        } else {
            Format::Text
        }
    }
}

/// A part on the plate, for its label.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// The part's name.
    pub name: String,
    /// Lower corner of what is printed of the part, on the bed.
    pub min: DVec2,
    /// Upper corner of what is printed of the part, on the bed.
    pub max: DVec2,
    /// The part seen from above, on the bed: a convex ring around it. If the
    /// ring is empty, the part's box is used.
    /// [`WriterPlan::needs_outline`] says whether the ring is needed.
    pub outline: Vec<DVec2>,
}

/// What the file's start says about the print.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Name of the model, without folder and extension.
    pub model_name: String,
    /// Number of the part's layers.
    pub layer_count: usize,
    /// Indices of the layers in this file.
    pub layers: Range<usize>,
    /// When the file is written; nothing if the file does not say so.
    pub timestamp: Option<SystemTime>,
    /// Temperature of the nozzle on the first layer of the file.
    pub nozzle_temperature: Celsius,
    /// Lower corner of the part, or of all parts, on the bed.
    pub part_min: DVec3,
    /// Upper corner of the part, or of all parts, on the bed.
    pub part_max: DVec3,
    /// The parts on the plate, which get a label each.
    pub parts: Vec<Standing>,
    /// Pictures of the part.
    pub thumbnails: Vec<Thumbnail>,
    /// True if parts are printed one by one.
    pub one_by_one: bool,
    /// What the file is written as.
    pub format: Format,
    /// What the file has in common with those of other ranges; nothing for a
    /// file that is not to be joined with others.
    pub fingerprint: Option<Fingerprint>,
}

/// What a print takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Length of filament fed.
    pub filament_length: Mm,
    /// Volume of filament fed.
    pub filament_volume: Mm3,
    /// Mass of filament fed, grams.
    pub filament_mass_g: f64,
    /// Time of all moves, also those of the templates, but without heating,
    /// homing and macros.
    pub time: Seconds,
    /// Number of layers written.
    pub layers: usize,
    /// Top of the highest layer written.
    pub height: Mm,
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
    /// What a range's file says about itself could not be written.
    #[error("cannot write what the file says of its layers")]
    Manifest(#[from] serde_json::Error),
    /// A coordinate, speed or length is not finite or too large.
    #[error(
        "{what} of {value} on layer {layer}: this is a bug in isoslice, \
         please report it with the model"
    )]
    BadNumber {
        /// What the number is: a coordinate, a speed or a length.
        what: &'static str,
        /// The number.
        value: f64,
        /// Layer, from 1.
        layer: usize,
    },
}

/// Writes a print, layer by layer.
pub struct Writer<'a, W: Write> {
    out: Sink<W>,
    /// What the head says of the file. The binary form has it in tables.
    said: Option<ends::Said>,
    /// Gets the text as soon as it is composed.
    copy: &'a mut dyn FnMut(&[u8]),
    plan: WriterPlan<'a>,
    templates: Templates<'a>,
    labels: Labels,
    /// Holds the text until the whole time is known, if a line in it tells the
    /// time left.
    waiting: Option<Waiting>,
    /// What a range's file will say about itself.
    record: Option<Record>,
    warnings: Vec<String>,
    /// Pauses that no layer has had, if the file is that of the whole part.
    pauses: Option<Pauses>,
    /// Text that has not been handed on.
    buffer: Vec<u8>,
    totals: Totals,
    /// Filament that the firmware has fed by itself in the layer, mm.
    extra: Mm,
    /// Where the head is after the file's head.
    start: DVec3,
    layer: usize,
    /// Height of the layer's top, mm.
    top: Mm,
    /// True once a bead of support has been written.
    supports: bool,

    // What the machine has been told so far, in units of the last decimal;
    // nothing where a template may have changed it.
    xy: Option<(i64, i64)>,
    z: Option<i64>,
    feed: Option<i64>,
    fan: Option<i64>,
    nozzle: Option<Celsius>,
    acceleration: Option<i64>,
    role: Option<Role>,
    width: Option<i64>,
    /// True if the head has come to its place printing beads of one role.
    on_way: bool,
    height: Option<i64>,
    /// Height of the plane of the marked beads above the layer's top, mm.
    plane: Mm,
    retracted: bool,
    filament: Filament,
}

impl<'a, W: Write> Writer<'a, W> {
    /// Begins a file: writes the head, the start template and the heating. All
    /// text is handed to `copy` as soon as it is composed, which may be long
    /// before it can be written. Only the lines that tell how far the print has
    /// come are written with other numbers in the end.
    ///
    /// # Errors
    /// If a template is wrong or the output cannot be written.
    pub fn new(
        out: W,
        plan: WriterPlan<'a>,
        header: &Header,
        copy: &'a mut dyn FnMut(&[u8]),
    ) -> Result<Self, WriteError> {
        let templates = Templates::new(&plan, header)?;
        let start = templates.start()?;
        let whole = header.layers == (0..header.layer_count);
        let [_, _, layer] = plan.templates;
        let waiting = if whole && plan.tells_progress {
            Some(Waiting::new(plan.flavour)?)
        } else {
            None
        };
        let mut writer = Self {
            out: Sink::new(out, header.format)?,
            said: ends::said(header),
            copy,
            templates,
            labels: Labels::new(&plan, header),
            waiting,
            record: Record::new(&plan, header),
            warnings: Vec::new(),
            pauses: whole.then(|| Pauses::of(layer, plan.flavour)),
            buffer: Vec::with_capacity(2 * FULL),
            totals: Totals::default(),
            extra: 0.0,
            start: DVec3::ZERO,
            layer: 0,
            top: 0.0,
            supports: false,
            xy: None,
            z: None,
            feed: None,
            fan: None,
            nozzle: None,
            acceleration: None,
            role: None,
            width: None,
            on_way: false,
            height: None,
            plane: 0.0,
            retracted: false,
            filament: Filament {
                relative: plan.relative_e,
                zero: Some(0),
                ..Filament::default()
            },
            plan,
        };
        writer.begin(&start, header)?;
        writer.time_head();
        writer.flush()?;
        Ok(writer)
    }

    /// What the user should know about the templates.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What the user should know about the templates after the last layer.
    pub fn warnings_of_layers(&self) -> impl Iterator<Item = String> {
        self.pauses.iter().flat_map(Pauses::missed)
    }

    /// Writes a layer.
    ///
    /// # Errors
    /// If the output cannot be written, or a number is not finite.
    pub fn layer(&mut self, layer: &PacedLayer) -> Result<(), WriteError> {
        self.begin_layer(layer);
        if self.totals.layers == 0 {
            self.catch_up(layer)?;
            if let Some(record) = &mut self.record {
                let end = record.at(self.buffer.len());
                let head = &mut record.manifest.head;
                head.end = end;
                head.time = self.totals.time;
            }
        }
        self.compose(layer, Self::flush)?;
        let fed = self.filament.exact + self.extra;
        if let Some(record) = &mut self.record {
            record.layer(self.buffer.len(), layer.time, fed);
            record.manifest.height = layer.span.top;
        }
        self.totals.filament_length += fed;
        self.totals.time += layer.time;
        self.totals.layers += 1;
        self.totals.height = self.totals.height.max(layer.span.top);
        self.flush()
    }

    /// Goes through a layer without writing or counting anything: for the layer
    /// below the first one of the file.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn rehearse(&mut self, layer: &PacedLayer) -> Result<(), WriteError> {
        let forget = |writer: &mut Self| {
            writer.buffer.clear();
            Ok(())
        };
        self.begin_layer(layer);
        self.compose(layer, forget)?;
        if let Some(record) = &mut self.record {
            record.forget();
        }
        forget(self)
    }

    /// Begins a layer that depends on nothing before it but what the layer below has
    /// told the machine, or on nothing at all if that has no moves. The print's first
    /// layer goes on from the file's head.
    fn begin_layer(&mut self, layer: &PacedLayer) {
        if layer.before + layer.span.index == 0 {
            return;
        }
        if layer.from_anywhere {
            (self.xy, self.z) = (None, None);
            (self.feed, self.fan, self.acceleration) = (None, None, None);
        }
        self.extra = 0.0;
        self.filament = Filament {
            relative: self.filament.relative,
            ..Filament::default()
        };
    }

    /// Ends the file: retracts, turns the fan off, writes the end template and
    /// what the print takes.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn finish(mut self) -> Result<Totals, WriteError> {
        let before = self.place();
        if self.plan.comments != Comments::None {
            self.line(comments::END_OF_LAYERS);
        }
        let retract = self.plan.retract;
        if self.totals.layers > 0 && !self.retracted && retract.length > 0.0 {
            // The file retracts here even if the firmware retracts elsewhere:
            // that firmware would take the next print's first retraction for
            // done.
            self.filament.back = self.count("retraction", retract.length, E)?;
            self.filament_move(retract.speed)?;
        }
        self.set_fan(0.0);
        self.custom_comment();
        let end = ends::end(
            &mut self.totals,
            &self.templates,
            &self.plan,
            &before,
            &self.buffer,
        )?;
        if let Some(record) = &mut self.record {
            record.manifest.foot = manifest::FootManifest {
                template: record.at(self.buffer.len()),
                before,
            };
        }
        self.buffer.extend_from_slice(end.as_bytes());
        self.mark(0.0);
        let mut manifest = 0..0;
        if let Some(record) = &self.record {
            manifest.start = record.at(self.buffer.len());
            let lines = record.lines()?;
            self.buffer.extend_from_slice(lines.as_bytes());
            manifest.end = record.at(self.buffer.len());
        }
        let facts = facts::facts(&self.plan, &self.totals);
        if let Sink::Plate(_) = self.out {
            self.line("; EXECUTABLE_BLOCK_END");
        }
        // Binary files have the totals in their tables.
        if !matches!(self.out, Sink::Binary(_)) {
            let footer = ends::footer(&self.plan, &self.totals, &facts);
            self.buffer.extend_from_slice(footer.as_bytes());
        }
        self.flush()?;
        if let Some(record) = &self.record {
            let line = record.last_line(manifest);
            self.line(&line);
            self.flush()?;
        }
        if let Some(waiting) = self.waiting.take() {
            waiting.release(&mut self.out, self.totals.time)?;
        }
        let said = self.said.take();
        let labelled = !self.labels.around.is_empty();
        let (plan, totals) = (&self.plan, &self.totals);
        match &self.out {
            Sink::Plate(_) => {
                let has = [labelled, self.supports];
                let about = ends::of_plate(said, plan, totals, has);
                self.out.finish(bgcode::About::default, || about)?;
            }
            _ => {
                let about = || ends::about(said, &facts);
                self.out.finish(about, package::About::default)?;
            }
        }
        Ok(self.totals)
    }
}
