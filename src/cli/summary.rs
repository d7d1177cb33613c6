//! What `isoslice slice` says when it is done: for people, and as JSON.

use super::args::is_stream;
use super::info::dimensions;
use super::plain;
use glam::DVec3;
use isoslice::check::{Finding, Kind, Verdict};
use isoslice::pipeline::Summary;
use isoslice::report::Figures;
use isoslice::settings::Settings;
use isoslice::timings::Stage;
use isoslice::units::human_time;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

/// What came of a run, and what it was a run of.
pub(super) struct Sums<'a> {
    pub(super) model: &'a str,
    pub(super) output: &'a Path,
    pub(super) settings: &'a Settings,
    pub(super) summary: &'a Summary,
    pub(super) took: Duration,
    /// Whether to tell where the processor time went.
    pub(super) timings: bool,
}

impl Sums<'_> {
    /// Price of the filament, if it is known what a kilogram costs.
    fn cost(&self) -> Option<f64> {
        let per_kg = self.settings.filament.cost;
        (per_kg > 0.0).then(|| self.summary.filament_mass_g * per_kg / 1000.0)
    }

    pub(super) fn to_json(
        &self,
        warnings: &[String],
    ) -> serde_json::Result<String> {
        let summary = self.summary;
        let p99 = |figures: Option<Figures>| figures.map(|f| f.p99);
        let of_stage = |(stage, s): &(Stage, f64)| (stage.name(), *s);
        let text = serde_json::to_string_pretty(&Json {
            model: self.model,
            output: self.output.display().to_string(),
            size_mm: summary.size.to_array(),
            layer_count: summary.layer_count,
            first_layer: summary.layers.start + 1,
            last_layer: summary.layers.end,
            print_time_s: summary.time,
            filament_mm: summary.filament_length,
            filament_g: summary.filament_mass_g,
            filament_cost: self.cost(),
            outline_p99_um: p99(summary.outline_error),
            outer_wall_p99_um: p99(summary.wall_error),
            left_out: summary.dropped_rings,
            gaps_mm2: summary.unfilled_area,
            area_mm2: summary.solid_area,
            checked: summary.verdict.is_some(),
            islands_in_air: summary.verdict.as_ref().map(|verdict| {
                in_the_air(verdict).map_or(0, |(count, _)| count)
            }),
            warnings,
            took_s: self.took.as_secs_f64(),
            timings_s: self
                .timings
                .then(|| summary.timings.iter().map(of_stage).collect()),
        })?;
        Ok(plain::json(&text) + "\n")
    }
}

/// The keys of `--json`; docs/command-line.md says what they mean.
#[derive(Serialize)]
struct Json<'a> {
    model: &'a str,
    output: String,
    size_mm: [f64; 3],
    layer_count: usize,
    first_layer: usize,
    last_layer: usize,
    print_time_s: f64,
    filament_mm: f64,
    filament_g: f64,
    filament_cost: Option<f64>,
    outline_p99_um: Option<f64>,
    outer_wall_p99_um: Option<f64>,
    left_out: usize,
    gaps_mm2: f64,
    area_mm2: f64,
    checked: bool,
    islands_in_air: Option<u64>,
    warnings: &'a [String],
    took_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    timings_s: Option<BTreeMap<&'static str, f64>>,
}

/// How many islands stand on nothing, and where the first of them begins.
fn in_the_air(verdict: &Verdict) -> Option<(u64, DVec3)> {
    let count = *verdict.counts.get(&Kind::InTheAir)?;
    let is_one = |f: &&Finding| f.kind == Kind::InTheAir;
    let first = verdict.findings.iter().find(is_one)?;
    Some((count, first.at))
}

/// The summary for people.
pub(super) fn describe(sums: &Sums<'_>) -> Result<String, std::fmt::Error> {
    let summary = sums.summary;
    let mut text = String::new();
    match is_stream(sums.output) {
        true => {
            writeln!(text, "{} (on standard output)", plain::line(sums.model))?
        }
        false => writeln!(text, "{}", plain::value(sums.output.display()))?,
    }
    writeln!(text, "  size        {}", dimensions(summary.size))?;
    let (layers, count) = (&summary.layers, summary.layer_count);
    match *layers == (0..count) {
        true => writeln!(text, "  layers      {count}")?,
        false => writeln!(
            text,
            "  layers      {} to {} of {count}",
            layers.start + 1,
            layers.end
        )?,
    }
    writeln!(text, "  print time  {}", human_time(summary.time))?;
    write!(
        text,
        "  filament    {:.2} m, {:.1} g",
        summary.filament_length / 1000.0,
        summary.filament_mass_g
    )?;
    match sums.cost() {
        Some(cost) => writeln!(
            text,
            ", {cost:.2} at {} per kg",
            sums.settings.filament.cost
        )?,
        None => writeln!(text)?,
    }
    let p99 =
        |f: Option<Figures>| f.map(|f| format!("{:.1} µm", f.p99.max(0.1)));
    if let Some(outline) = p99(summary.outline_error) {
        write!(text, "  accuracy    outline within {outline}")?;
        if let Some(walls) = p99(summary.wall_error) {
            write!(text, ", outer wall of even width within {walls}")?;
        }
        writeln!(text, " (99 % of the points measured)")?;
    }
    if summary.dropped_rings > 0 {
        writeln!(
            text,
            "  left out    {} islands and holes smaller than a quarter of a \
             line's width",
            summary.dropped_rings
        )?;
    }
    // Less is what rounding leaves at sharp corners.
    if summary.unfilled_area >= 1.0 {
        writeln!(
            text,
            "  gaps        {:.1} mm² too thin for a line, of {:.0} mm² in \
             all layers",
            summary.unfilled_area, summary.solid_area
        )?;
    }
    if let Some(verdict) = &summary.verdict {
        let moves = verdict.moves;
        writeln!(text, "  checked     {moves} moves, safe for this printer")?;
        if let Some((count, first)) = in_the_air(verdict) {
            writeln!(
                text,
                "  in the air  {count} {}, the first at x = {:.1}, y = {:.1}, \
                 z = {:.2} mm",
                match count {
                    1 => "island begins on nothing",
                    _ => "islands begin on nothing",
                },
                first.x,
                first.y,
                first.z
            )?;
        }
    }
    writeln!(text, "  took        {:.1} s", sums.took.as_secs_f64())?;
    if sums.timings {
        for (stage, seconds) in &summary.timings {
            writeln!(text, "    {:<9} {seconds:8.2} s", stage.name())?;
        }
    }
    Ok(text)
}
