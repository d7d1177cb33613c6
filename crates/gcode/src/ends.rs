//! The file's head, from the first line to the first layer, and its foot.

use super::facts::{Fact, Of};
use super::label;
use super::scan::{self, Heating, heating};
use super::template::{TemplateError, Templates};
use super::time::of_foot;
use super::{
    Format, Header, Standing, Thumbnail, Totals, WriteError, Writer,
    WriterPlan, XYZ, flavour, limits, own, text, thumbnail,
};
use isoslice_gcode_read::bgcode::{About, Key};
use isoslice_gcode_read::package;
use isoslice_settings::{Comments, ImageFormat};
use std::fmt::Write as _;
use std::io::Write;
use std::time::SystemTime;

/// The program's name.
const MAKER: &str = concat!("isoslice ", env!("CARGO_PKG_VERSION"));
/// The day of this version, which stands in files without a timestamp. Some
/// hosts recognise a slicer's file by the date behind the slicer's name. The
/// clock does not change it.
const DAY: &str = "2026-11-24";

/// What the head of a text file says. Other formats keep it beside the text.
pub(super) struct Said {
    pub at: Option<SystemTime>,
    pub thumbnails: Vec<Thumbnail>,
    pub parts: Vec<Standing>,
    pub one_by_one: bool,
}

/// What the end of the file needs from the head.
pub(super) fn said(header: &Header) -> Option<Said> {
    (header.format != Format::Text).then(|| Said {
        at: header.timestamp,
        thumbnails: header.thumbnails.clone(),
        parts: header.parts.clone(),
        one_by_one: header.one_by_one,
    })
}

/// The tables and pictures before the text of binary G-code.
pub(super) fn about(said: Option<Said>, facts: &[Fact]) -> About {
    let key = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    let some = |is: &dyn Fn(&Fact) -> bool| -> Vec<Key> {
        let some = facts.iter().filter(|f| is(f));
        some.map(|f| key(f.key, &f.value)).collect()
    };
    let mut about = About {
        file: vec![key("Producer", MAKER)],
        printer: some(&|f| f.printer),
        print: some(&|f| f.of == Of::Print),
        slicer: some(&|f| f.of == Of::Slicer),
        pictures: Vec::new(),
    };
    let Some(said) = said else {
        return about;
    };
    if let Some((day, time)) = said.at.and_then(day_and_time) {
        let at = format!("{day} at {time} UTC");
        about.file.push(key("Produced on", &at));
    }
    let pictures = said.thumbnails.into_iter();
    about.pictures = pictures.map(|p| (p.size, p.file)).collect();
    about
}

/// What a plate for Bambu Lab's printers says of the print beside the text.
pub(super) fn of_plate(
    said: Option<Said>,
    plan: &WriterPlan<'_>,
    totals: &Totals,
    [labelled, supports]: [bool; 2],
) -> package::About {
    let (printer, filament) = (plan.printer, plan.filament);
    let one_by_one = said.as_ref().is_some_and(|said| said.one_by_one);
    let (parts, thumbnails) = match said {
        Some(said) => (said.parts, said.thumbnails),
        None => (Vec::new(), Vec::new()),
    };
    // Containers have no other pictures.
    let png = |p: &Thumbnail| p.size.format == ImageFormat::Png;
    let pictures = thumbnails.into_iter().filter(png);
    let pictures = pictures.map(|p| (p.size, p.file)).collect();
    let part = |part: Standing| package::PartBox {
        name: part.name,
        min: part.min,
        max: part.max,
    };
    package::About {
        maker: MAKER.to_owned(),
        printer: printer.model.trim().to_owned(),
        nozzle: printer.nozzle_diameter,
        material: filament.material.trim().to_owned(),
        filament_diameter: filament.diameter,
        density: filament.density,
        time: totals.time,
        length: totals.filament_length,
        volume: totals.filament_volume,
        mass_g: totals.filament_mass_g,
        layers: totals.layers,
        height: totals.height,
        layer_height: plan.layer_heights[1],
        supports,
        one_by_one,
        labelled,
        parts: parts.into_iter().map(part).collect(),
        pictures,
    }
}

/// Cura's line that says how many layers a file has.
pub(super) fn layer_count(count: usize) -> String {
    format!(";LAYER_COUNT:{count}")
}

impl<W: Write> Writer<'_, W> {
    /// Writes the head, the start template, the heating, and what the firmware
    /// has to know before the first layer. `start` is the start template,
    /// filled in.
    pub(super) fn begin(
        &mut self,
        start: &str,
        header: &Header,
    ) -> Result<(), WriteError> {
        let flavour = self.plan.flavour;
        self.head_comments(header);
        self.lines(&flavour::checks(&self.plan));
        self.mark(0.0);
        let mark = self.at();
        if let Some(record) = &mut self.record {
            record.manifest.head.mark = mark;
        }
        let labels = std::mem::take(&mut self.labels.define);
        self.lines(&labels);
        self.modes();
        if let Some(select) = flavour.firmware().select_tool {
            self.line(select);
        }
        self.heated_start(start, header);
        self.line("G92 E0");
        self.lines(&flavour::limits(&self.plan));
        if let Some(advance) = flavour::pressure_advance(&self.plan) {
            self.line(&advance);
        }
        self.lines(&flavour::retraction(&self.plan));
        if flavour.firmware().print_stats {
            let count = header.layer_count;
            self.line(&format!("SET_PRINT_STATS_INFO TOTAL_LAYER={count}"));
        }
        let plan = &self.plan;
        self.warnings = limits::warnings("gcode.start", start, plan);
        self.warnings.extend(label::warning(plan, header));
        self.warnings.extend(plan.thick_beads());
        let end = self.templates.try_end()?;
        self.warnings
            .extend(limits::warnings("gcode.end", &end, plan));
        Ok(())
    }

    /// Writes what the file is, and its pictures.
    fn head_comments(&mut self, header: &Header) {
        let text = header.format == Format::Text;
        if header.format == Format::Plate {
            let head = package::blank(MAKER);
            self.buffer.extend_from_slice(head.as_bytes());
            self.line("; EXECUTABLE_BLOCK_START");
        }
        // The name stands before the pictures: hosts look for it in the first
        // 10,000 characters.
        if text {
            // Hosts know PrusaSlicer's words for the date.
            self.line(&match header.timestamp.and_then(day_and_time) {
                Some((day, time)) => {
                    format!("; generated by {MAKER} on {day} at {time} UTC")
                }
                None => format!(
                    "; generated by {MAKER} on {DAY} at 00:00:00 UTC (day of \
                     this version, not of the file)"
                ),
            });
        }
        let (layers, count) = (&header.layers, header.layer_count);
        let own = self.at();
        if *layers != (0..count) && self.plan.comments != Comments::None {
            let (first, last) = (layers.start + 1, layers.end);
            self.line(&format!("; layers {first} to {last} of {count}"));
        }
        if let Some(fingerprint) = &header.fingerprint {
            self.line(&fingerprint.line());
        }
        let end = self.at();
        if let Some(record) = &mut self.record {
            record.manifest.head.own = own..end;
        }
        for picture in header.thumbnails.iter().filter(|_| text) {
            let block = thumbnail::block(picture);
            self.buffer.extend_from_slice(block.as_bytes());
        }
        if self.plan.comments == Comments::Cura {
            let name = self.plan.flavour.firmware().cura_name;
            self.line(&format!(";FLAVOR:{name}"));
            let start = self.at();
            self.line(&layer_count(layers.len()));
            let end = self.at();
            if let Some(record) = &mut self.record {
                record.manifest.head.count = Some(start..end);
            }
        }
    }

    /// Where a range's file is.
    fn at(&self) -> u64 {
        self.record.as_ref().map_or(0, |r| r.at(self.buffer.len()))
    }

    /// Writes the start template, with the heating that the template leaves to
    /// the writer.
    fn heated_start(&mut self, start: &str, header: &Header) {
        let source = self.templates.start_source();
        // A printer without a heated bed may not know the commands for one.
        let [first_bed, bed_above] = self.plan.bed_temperatures;
        let bed = if first_bed > 0.0 || bed_above > 0.0 {
            heating(
                source,
                start,
                "M140",
                "M190",
                &["bed_temperature", "first_layer_bed_temperature"],
            )
        } else {
            Heating::Waits
        };
        let nozzle = heating(
            source,
            start,
            "M104",
            "M109",
            &["nozzle_temperature", "first_layer_nozzle_temperature"],
        );
        // Above the first layer, the second layer's text changes the
        // temperatures.
        let (bed_to, nozzle_to) = match header.layers.start {
            0 | 1 => (first_bed, self.plan.nozzle_temperatures.0),
            _ => (bed_above, header.nozzle_temperature),
        };
        self.nozzle = Some(nozzle_to);
        if bed == Heating::Not {
            self.temperature("M140", bed_to);
        }
        if nozzle == Heating::Not {
            self.temperature("M104", nozzle_to);
        }
        self.custom_comment();
        self.buffer.extend_from_slice(start.as_bytes());
        if bed != Heating::Waits {
            self.temperature("M190", bed_to);
        }
        if nozzle != Heating::Waits {
            self.temperature("M109", nozzle_to);
        }
        if scan::may_change_modes(start) {
            self.modes();
        }
    }

    fn lines(&mut self, lines: &[String]) {
        for line in lines {
            self.line(line);
        }
    }
}

/// Returns the end template, filled in. Adds to the totals the filament's
/// volume and mass and the foot's time. `before` is what [`Writer::place`] gave
/// at the foot's beginning, `text` the foot up to the template.
pub(super) fn end(
    totals: &mut Totals,
    templates: &Templates<'_>,
    plan: &WriterPlan<'_>,
    before: &str,
    text: &[u8],
) -> Result<String, TemplateError> {
    totals.filament_volume = totals.filament_length * plan.filament_area;
    // Density is in g/cm³.
    let density = plan.filament.density;
    totals.filament_mass_g = totals.filament_volume * 1e-3 * density;
    // The template may name the whole time, which includes the foot's own time.
    // So the template is filled in twice.
    let trial = templates.end(*totals)?;
    totals.time += of_foot(before, text, &trial, plan.limits);
    templates.end(*totals)
}

/// The end of a text file: what the print takes, in the words that hosts read.
pub(super) fn footer(
    plan: &WriterPlan<'_>,
    totals: &Totals,
    facts: &[Fact],
) -> String {
    if plan.comments == Comments::None {
        return String::new();
    }
    // Without this line Moonraker and RepRapFirmware would take the last
    // move upwards for the part's height. RepRapFirmware finds the line
    // only if there is more text behind it.
    let top = text(totals.height, XYZ);
    let mut lines = format!(
        "; times are without heating and homing\n\
         ;BEFORE_LAYER_CHANGE\n;{top}\n; END_LAYER_OBJECT z={top}\n"
    );
    for Fact { key, value, .. } in facts {
        lines += &format!("; {key} = {value}\n");
    }
    lines + &own::lines(plan)
}

/// The text that all files of one version have in common: the program's name,
/// its version, the version's day, and the system that it was built for. Builds
/// for other processors, or with another mathematical library, write other
/// digits.
pub fn version() -> String {
    use std::env::consts::{ARCH, OS};
    let library = if cfg!(target_env = "musl") {
        "-musl"
    } else {
        ""
    };
    format!("{MAKER} of {DAY} for {ARCH}-{OS}{library}")
}

/// `2026-01-31` and `12:00:00`, if the year has four digits.
fn day_and_time(at: SystemTime) -> Option<(String, String)> {
    let mut text = String::new();
    write!(text, "{}", humantime::format_rfc3339_seconds(at)).ok()?;
    let (day, time) = text.trim_end_matches('Z').split_once('T')?;
    Some((day.to_owned(), time.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::DAY;

    #[test]
    fn the_day_of_this_version_is_that_in_the_changelog() {
        let version = env!("CARGO_PKG_VERSION");
        let heading = format!("## [{version}] - {DAY}\n");
        assert!(include_str!("../../../CHANGELOG.md").contains(&heading));
    }
}
