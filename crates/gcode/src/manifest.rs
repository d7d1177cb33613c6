//! What a file of a range of layers says about itself, so that the files of all
//! ranges can be joined.
//!
//! In: the file's text while it is written, and what is known of its layers.
//! Out: a manifest, in comments behind the end template, and the file's last
//! line, which says where the manifest is and has a checksum of everything
//! before that line.
//!
//! ```text
//! ; {"fingerprint":{"version":"isoslice 0.1.0 of …","model":"6c0f…",…
//! ; …}
//! …
//! ; end of range: 481516 2342 9f3a01c7
//! ```
//!
//! Guaranteed: numbers are read as they were written, to the last bit; a manifest
//! that is read is consistent: its places follow one another in the file, and
//! there are as many texts as layers. Not guaranteed: that a manifest tells the
//! truth; the checksum shows a change that was not made on purpose.

use super::progress::Moment;
use super::{Header, Totals, WriterPlan};
use isoslice_base::units::{Mm, Seconds};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::time::{SystemTime, UNIX_EPOCH};

/// What the last line begins with.
const END: &str = "; end of range: ";
/// What the line in the head begins with.
const OF: &str = "; range of: ";
/// Characters in a line of the manifest. Firmware ignores comments, but its
/// buffers for lines are short.
const WIDTH: usize = 100;
/// Greatest length of the last line.
pub(super) const LAST_LINE: u64 = 128;
/// Greatest length of a manifest, bytes. For a print that takes a year the
/// manifest has some 1.4 GB.
pub(super) const LONGEST: u64 = 1 << 31;

/// What files must have in common to be joined. Equal text stands for equal
/// content.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fingerprint {
    /// The program's version, and what it was built for.
    pub version: String,
    /// The models' expressions, names and places.
    pub model: String,
    /// All settings.
    pub settings: String,
    /// The planned layers.
    pub layers: String,
}

impl Fingerprint {
    /// What differs, in words; nothing if both fingerprints are equal.
    pub(super) fn difference(&self, other: &Self) -> Option<&'static str> {
        [
            (
                &self.version,
                &other.version,
                "version or build of isoslice",
            ),
            (&self.model, &other.model, "model"),
            (&self.settings, &other.settings, "settings"),
            (&self.layers, &other.layers, "layers of the part"),
        ]
        .into_iter()
        .find_map(|(a, b, what)| (a != b).then_some(what))
    }

    /// The line in a file's head.
    pub(super) fn line(&self) -> String {
        let Self {
            version,
            model,
            settings,
            layers,
        } = self;
        format!(
            "{OF}{version}, model {model}, settings {settings}, layers {layers}"
        )
    }
}

/// What a file of a range says about itself. Places are in bytes from the
/// file's beginning, or, in a binary file, from that of its text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Manifest {
    pub fingerprint: Fingerprint,
    /// Indices of the file's layers.
    pub layers: Range<usize>,
    /// Number of the part's layers.
    pub layer_count: usize,
    pub head: Head,
    /// The layers' texts. The first one begins where the head ends.
    pub texts: Vec<LayerText>,
    /// Top of the highest layer, mm.
    pub height: Mm,
    pub foot: FootManifest,
    pub print: Print,
}

/// What joining needs to know of a file's head.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Head {
    /// The lines that only a range's file has.
    pub own: Range<u64>,
    /// The line with the number of the file's layers, if the head has one.
    pub count: Option<Range<u64>>,
    /// Where a line tells how far the print has come.
    pub mark: u64,
    /// Where the head ends.
    pub end: u64,
    /// Time of the head, and of the way to the first layer.
    pub time: Seconds,
}

/// What joining needs to know of a layer's text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct LayerText {
    /// Where the text ends.
    pub end: u64,
    pub time: Seconds,
    /// Filament fed, mm.
    pub fed: Mm,
    /// Places that may tell how far the print has come.
    pub moments: Vec<Moment>,
}

/// What joining needs to know of the foot, which begins where the last layer
/// ends.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct FootManifest {
    /// Where the end template begins.
    pub template: u64,
    /// Lines that bring a reader to the state of the machine at the foot's
    /// beginning.
    pub before: String,
}

/// What head and foot are made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Print {
    /// The settings that are not as by default, as TOML.
    pub settings: String,
    pub model_name: String,
    pub part_min: [Mm; 3],
    pub part_max: [Mm; 3],
    /// When the file was written, s since 1970, if the file says so.
    pub written: Option<u64>,
}

impl Print {
    fn new(plan: &WriterPlan<'_>, header: &Header) -> Self {
        let seconds = |at: SystemTime| {
            at.duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs())
        };
        Self {
            settings: plan.changed(),
            model_name: header.model_name.clone(),
            part_min: header.part_min.to_array(),
            part_max: header.part_max.to_array(),
            written: header.timestamp.map(seconds),
        }
    }
}

/// A manifest that is being made.
pub(super) struct Record {
    pub manifest: Manifest,
    /// Length and checksum of the text that has been handed on.
    length: u64,
    sum: crc32fast::Hasher,
    moments: Vec<Moment>,
    /// True if the whole print is to tell how far it has come.
    tells_progress: bool,
}

impl Record {
    /// The record of a file with this header; nothing if the file is not to be
    /// joined.
    pub(super) fn new(plan: &WriterPlan<'_>, header: &Header) -> Option<Self> {
        let fingerprint = header.fingerprint.clone()?;
        Some(Record {
            manifest: Manifest {
                fingerprint,
                layers: header.layers.clone(),
                layer_count: header.layer_count,
                head: Head::default(),
                texts: Vec::new(),
                height: 0.0,
                foot: FootManifest::default(),
                print: Print::new(plan, header),
            },
            length: 0,
            sum: crc32fast::Hasher::new(),
            moments: Vec::new(),
            tells_progress: plan.tells_progress,
        })
    }

    /// Length of the file so far. `ahead` bytes of it have not been handed on.
    pub(super) fn at(&self, ahead: usize) -> u64 {
        self.length + ahead as u64
    }

    /// Takes text that is handed on.
    pub(super) fn passed(&mut self, text: &[u8]) {
        self.length += text.len() as u64;
        self.sum.update(text);
    }

    /// Takes a layer's moment.
    pub(super) fn moment(&mut self, ahead: usize, time: Seconds) {
        if self.tells_progress {
            let at = self.at(ahead);
            self.moments.push(Moment { at, time });
        }
    }

    /// Forgets the moments of a layer that is not written.
    pub(super) fn forget(&mut self) {
        self.moments.clear();
    }

    /// Takes a layer, with what it has fed.
    pub(super) fn layer(&mut self, ahead: usize, time: Seconds, fed: Mm) {
        let text = LayerText {
            end: self.at(ahead),
            time,
            fed,
            moments: std::mem::take(&mut self.moments),
        };
        self.manifest.texts.push(text);
    }

    /// The manifest's lines.
    pub(super) fn lines(&self) -> Result<String, serde_json::Error> {
        let json = serde_json::to_string(&self.manifest)?;
        let mut text = String::with_capacity(json.len() + json.len() / 16);
        let mut rest = json.as_str();
        while !rest.is_empty() {
            let end = rest.char_indices().nth(WIDTH).map(|(at, _)| at);
            let (line, more) = rest.split_at(end.unwrap_or(rest.len()));
            text.push_str("; ");
            text.push_str(line);
            text.push('\n');
            rest = more;
        }
        Ok(text)
    }

    /// The file's last line, when all before it has been handed on. `lines` is
    /// where the manifest's lines are.
    pub(super) fn last_line(&self, lines: Range<u64>) -> String {
        let Range { start, end } = lines;
        let sum = self.sum.clone().finalize();
        format!("{END}{start} {} {sum:08x}", end - start)
    }
}

/// What the last line of a file says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Last {
    /// Where the manifest is.
    pub manifest: Range<u64>,
    /// Where the last line begins, and the checksum of all before it.
    pub at: u64,
    pub sum: u32,
}

impl Last {
    /// Reads the last line from the end of a file whose length is `length`.
    pub(super) fn read(end: &[u8], length: u64) -> Option<Last> {
        let text = end.strip_suffix(b"\n")?;
        let start = memchr::memrchr(b'\n', text).map_or(0, |at| at + 1);
        let line = std::str::from_utf8(&text[start..]).ok()?;
        let mut words = line.strip_prefix(END)?.split(' ');
        let mut word = || words.next();
        let from: u64 = word()?.parse().ok()?;
        let count: u64 = word()?.parse().ok()?;
        let sum = u32::from_str_radix(word()?, 16).ok()?;
        let at = length.checked_sub((end.len() - start) as u64)?;
        let to = from.checked_add(count)?;
        (to <= at && word().is_none()).then_some(Last {
            manifest: from..to,
            at,
            sum,
        })
    }
}

impl Manifest {
    /// Reads a manifest's lines; nothing if they are not as [`Record::lines`]
    /// writes them.
    pub(super) fn read(lines: &str) -> Option<Manifest> {
        let mut json = String::with_capacity(lines.len());
        for line in lines.strip_suffix('\n')?.lines() {
            json.push_str(line.strip_prefix("; ")?);
        }
        let manifest: Manifest = serde_json::from_str(&json).ok()?;
        manifest.is_consistent().then_some(manifest)
    }

    fn is_consistent(&self) -> bool {
        let Head {
            own,
            count,
            mark,
            end,
            time,
        } = &self.head;
        let layers = &self.layers;
        let last = own.end.max(count.as_ref().map_or(0, |c| c.end));
        let head = own.start <= own.end
            && count
                .as_ref()
                .is_none_or(|c| own.end <= c.start && c.start <= c.end)
            && last <= *mark
            && mark <= end
            && time.is_finite();
        let mut at = *end;
        let mut text = |text: &LayerText| {
            let mut ok = text.time.is_finite() && text.fed.is_finite();
            for moment in &text.moments {
                ok &= at <= moment.at && moment.time.is_finite();
                at = at.max(moment.at);
            }
            ok &= at <= text.end;
            at = at.max(text.end);
            ok
        };
        let texts = self.texts.iter().all(&mut text);
        head && texts
            && at <= self.foot.template
            && layers.start < layers.end
            && layers.end <= self.layer_count
            && layers.len() == self.texts.len()
    }

    /// Adds the file's layers to a print's totals. `tell` is called with each
    /// moment and with the time since the print's beginning.
    pub(super) fn add(
        &self,
        totals: &mut Totals,
        mut tell: impl FnMut(u64, Seconds),
    ) {
        for text in &self.texts {
            for moment in &text.moments {
                tell(moment.at, totals.time + moment.time);
            }
            totals.filament_length += text.fed;
            totals.time += text.time;
            totals.layers += 1;
        }
        totals.height = self.height;
    }
}
