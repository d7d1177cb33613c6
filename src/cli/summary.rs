//! The summary of `isoslice slice`, for people and as JSON.

use super::info::{describe_steps, dimensions, flat_side, place};
use super::output::is_stream;
use super::plain;
use super::rows::{Rows, counted};
use glam::DVec3;
use isoslice::Figures;
use isoslice::check::{Finding, FindingKind, Verdict};
use isoslice::human_time;
use isoslice::pipeline::{PartSummary, Summary};
use isoslice::{Hanging, Plate, RoleSum, Sum};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

/// The results of a run, and what was sliced.
pub(super) struct Sums<'a> {
    pub(super) output: &'a Path,
    pub(super) plate: &'a Plate,
    pub(super) summary: &'a Summary,
    pub(super) took: Duration,
    /// Where the processor time went, if the summary tells it.
    pub(super) timings: Option<Vec<(&'static str, f64)>>,
}

impl Sums<'_> {
    /// Price of the filament, if the price of a kilogram is set.
    fn cost(&self) -> Option<f64> {
        let per_kg = self.plate.settings.filament_cost();
        (per_kg > 0.0).then(|| self.summary.filament_mass_g * per_kg / 1000.0)
    }

    pub(super) fn to_json(
        &self,
        warnings: &[String],
    ) -> serde_json::Result<String> {
        let summary = self.summary;
        let p99 = |figures: Option<Figures>| figures.map(|f| f.p99);
        let text = serde_json::to_string_pretty(&Json {
            model: &self.plate.name,
            output: self.output.display().to_string(),
            size_mm: summary.size.to_array(),
            layer_count: summary.layer_count,
            raft_layers: summary.raft_layers,
            first_layer: summary.layers.start + 1,
            last_layer: summary.layers.end,
            print_time_s: summary.time,
            filament_mm: summary.filament_length,
            filament_g: summary.filament_mass_g,
            filament_cost: self.cost(),
            outline_p99_um: p99(summary.outline_error),
            outer_wall_p99_um: p99(summary.wall_error),
            left_out: summary.dropped_rings,
            printing_moves: summary.printing_moves,
            slowed_moves: summary.slowed_moves,
            time_lost_s: &summary.time_lost,
            gaps_mm2: summary.unfilled_area,
            area_mm2: summary.solid_area,
            checked: summary.verdict.is_some(),
            islands_in_air: summary.verdict.as_ref().map(|verdict| {
                in_the_air(verdict).map_or(0, |(count, _)| count)
            }),
            hanging: &summary.hanging,
            roles: &summary.roles,
            parts: summary.parts.iter().map(PartJson::new).collect(),
            warnings,
            took_s: self.took.as_secs_f64(),
            timings_s: self
                .timings
                .as_ref()
                .map(|rows| rows.iter().copied().collect()),
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
    raft_layers: usize,
    first_layer: usize,
    last_layer: usize,
    print_time_s: f64,
    filament_mm: f64,
    filament_g: f64,
    filament_cost: Option<f64>,
    outline_p99_um: Option<f64>,
    outer_wall_p99_um: Option<f64>,
    left_out: usize,
    printing_moves: usize,
    slowed_moves: usize,
    time_lost_s: &'a BTreeMap<&'static str, f64>,
    gaps_mm2: f64,
    area_mm2: f64,
    checked: bool,
    islands_in_air: Option<u64>,
    hanging: &'a Hanging,
    roles: &'a BTreeMap<&'static str, RoleSum>,
    parts: Vec<PartJson<'a>>,
    warnings: &'a [String],
    took_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    timings_s: Option<BTreeMap<&'static str, f64>>,
}

/// A part of the plate.
#[derive(Serialize)]
struct PartJson<'a> {
    name: &'a str,
    copies: usize,
    size_mm: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    laid_mm2: Option<f64>,
    layer_count: usize,
    filament_mm: f64,
}

impl PartJson<'_> {
    fn new(part: &PartSummary) -> PartJson<'_> {
        PartJson {
            name: &part.name,
            copies: part.copies,
            size_mm: part.size.to_array(),
            laid_mm2: part.laid,
            layer_count: part.layer_count,
            filament_mm: part.filament_length,
        }
    }
}

/// A content in square millimetres; small ones have one more decimal.
fn content(area: f64) -> String {
    if area < 0.95 {
        format!("{area:.2}")
    } else {
        format!("{area:.1}")
    }
}

/// The lines of the summary about what hangs.
fn describe_hanging(hanging: &Hanging, rows: &mut Rows) {
    let mut line = |sum: &Sum, what: String| {
        if let Some(first) = sum.first.filter(|_| sum.is_told()).map(place) {
            let area = content(sum.area);
            let line = format!("{area} mm² {what}, the first at {first}");
            rows.add("hanging", line);
        }
    };
    let Hanging {
        begins,
        leans,
        bridges,
        ..
    } = hanging;
    let count = counted(begins.count, "island");
    let verb = if begins.count == 1 { "begins" } else { "begin" };
    line(begins, format!("in {count} that {verb} on nothing"));
    let reach = leans.reach;
    line(leans, format!("lean too far, by up to {reach:.1} mm"));
    let (count, span) = (counted(bridges.count, "bridge"), bridges.reach);
    let what = format!("in {count} too long, of up to {span:.1} mm");
    line(bridges, what);
    if let Some(foot) = hanging.foot {
        let good = if foot.holds_nothing() {
            "less than 1".to_owned()
        } else {
            format!("{:.0}", foot.holds)
        };
        let area = content(foot.area);
        let line = format!("{area} mm², good for a height of {good} mm");
        rows.add("foot", line);
    }
}

/// The lines of the summary about what makes the print take longer than at the
/// speeds that the settings ask for.
fn describe_lost(sums: &Sums<'_>, rows: &mut Rows) {
    /// Share of the print's time from which a cause is worth a line.
    const SHARE: f64 = 0.05;
    let summary = sums.summary;
    let moves = sums.plate.settings.max_moves_per_second();
    let causes = [
        ("cooling", "cooling (cooling.min_layer_time)".to_owned()),
        ("flow", "the hot end's flow (filament.max_flow)".to_owned()),
        (
            "moves",
            format!(
                "short moves, of which the printer takes {moves} a second \
                 (printer.max_moves_per_second)"
            ),
        ),
        (
            "acceleration",
            "acceleration (printer.acceleration)".to_owned(),
        ),
    ];
    for (cause, what) in causes {
        let lost = summary.time_lost.get(cause).copied().unwrap_or(0.0);
        if lost > SHARE * summary.time {
            let share = 100.0 * lost / summary.time;
            rows.add("of it lost", format!("{share:.0} % to {what}"));
        }
    }
}

/// The line of the summary about layers that have too little time to cool.
fn describe_short(sums: &Sums<'_>, rows: &mut Rows) {
    /// Fewer layers are the tip of a part, which is as it is.
    const FEW: usize = 10;
    let Some((count, time)) = sums.summary.short_layers else {
        return;
    };
    let cooling = &sums.plate.settings.cooling;
    let (least, slowest) = (cooling.min_layer_time, cooling.min_speed);
    if count >= FEW {
        let line = format!(
            "{count} layers take less than cooling.min_layer_time = {least} s, the \
             shortest {time:.1} s, at cooling.min_speed = {slowest} mm/s: print \
             several parts at once"
        );
        rows.add("short", line);
    }
}

/// The number of islands that begin in the air, and where the first of them
/// begins.
fn in_the_air(verdict: &Verdict) -> Option<(u64, DVec3)> {
    let count = *verdict.counts.get(&FindingKind::InTheAir)?;
    let is_one = |f: &&Finding| f.kind == FindingKind::InTheAir;
    let first = verdict.findings.iter().find(is_one)?;
    Some((count, first.at))
}

/// The lines of the summary about the parts, if there are several.
fn describe_parts(summary: &Summary, rows: &mut Rows) {
    if summary.parts.iter().map(|part| part.copies).sum::<usize>() < 2 {
        return;
    }
    for part in &summary.parts {
        let metres = part.filament_length / 1000.0;
        let (copies, name) = (part.copies, plain::line(&part.name));
        let size = dimensions(part.size);
        let line = format!("{copies} × {name}, {size}, {metres:.2} m each");
        rows.add("parts", line);
    }
}

/// The summary for people.
pub(super) fn describe(sums: &Sums<'_>) -> Result<String, std::fmt::Error> {
    let summary = sums.summary;
    let head = if is_stream(sums.output) {
        format!("{} (on standard output)", plain::line(&sums.plate.name))
    } else {
        plain::value(sums.output.display())
    };
    let mut rows = Rows::default();
    rows.plain(head);
    rows.add("size", dimensions(summary.size));
    for part in &summary.parts {
        let Some(side) = part.laid.map(flat_side) else {
            continue;
        };
        let line = match summary.parts.len() {
            1 => side,
            _ => format!("{}: {side}", plain::line(&part.name)),
        };
        rows.add("lies on", line);
    }
    let (layers, count) = (&summary.layers, summary.layer_count);
    let which = if *layers == (0..count) {
        count.to_string()
    } else {
        format!("{} to {} of {count}", layers.start + 1, layers.end)
    };
    let turns = sums.plate.turns().map(|turns| turns.len());
    let raft = match (summary.raft_layers, turns) {
        (0, _) => String::new(),
        (n, None) => format!(", the lowest {n} of them the raft's"),
        (n, Some(parts)) => {
            format!(", {} of them rafts', {n} below each part", n * parts)
        }
    };
    rows.add("layers", which + &raft);
    if let Some(steps) = &summary.steps {
        // Parts that are printed one by one have their layers one after the other.
        let count = turns.is_none().then_some(count);
        describe_steps(steps, count, &mut rows);
    }
    describe_parts(summary, &mut rows);
    rows.add("print time", human_time(summary.time));
    describe_lost(sums, &mut rows);
    describe_short(sums, &mut rows);
    let (metres, grams) =
        (summary.filament_length / 1000.0, summary.filament_mass_g);
    let cost = sums.cost().map(|cost| {
        format!(
            ", {cost:.2} at {} per kg",
            sums.plate.settings.filament_cost()
        )
    });
    let cost = cost.unwrap_or_default();
    rows.add("filament", format!("{metres:.2} m, {grams:.1} g{cost}"));
    if summary.support_length > 0.0 {
        let metres = summary.support_length / 1000.0;
        let of = ["support", "support_interface"];
        let of_roles = of.iter().filter_map(|role| summary.roles.get(role));
        let time = human_time(of_roles.map(|sum| sum.time_s).sum());
        // A raft counts as a support.
        let any = sums.plate.settings.has_supports();
        let (title, with) = match (summary.raft_layers, any) {
            (0, _) => ("supports", ""),
            (_, true) => ("supports", ", the raft included"),
            (_, false) => ("raft", ""),
        };
        let line =
            format!("{metres:.2} m of that filament, {time} of the time{with}");
        rows.add(title, line);
    }
    let p99 =
        |f: Option<Figures>| f.map(|f| format!("{:.1} µm", f.p99.max(0.1)));
    if let Some(outline) = p99(summary.outline_error) {
        let walls = p99(summary.wall_error);
        let walls = walls.map(|w| format!(", outer wall within {w}"));
        let walls = walls.unwrap_or_default();
        let of = "99 % of the points measured";
        rows.add(
            "accuracy",
            format!("outline within {outline}{walls} ({of})"),
        );
    }
    if summary.dropped_rings > 0 {
        let small =
            "islands and holes smaller than a quarter of a line's width";
        rows.add("left out", format!("{} {small}", summary.dropped_rings));
    }
    // Rounding leaves smaller areas at sharp corners.
    if summary.unfilled_area >= 1.0 {
        let (gaps, all) = (summary.unfilled_area, summary.solid_area);
        let line = format!(
            "{gaps:.1} mm² too thin for a line, of {all:.0} mm² in all layers"
        );
        rows.add("gaps", line);
    }
    describe_hanging(&summary.hanging, &mut rows);
    if let Some(verdict) = &summary.verdict {
        let moves = verdict.moves;
        rows.add("checked", format!("{moves} moves, safe for this printer"));
        // If the lines above tell of islands that begin on nothing, these have
        // been counted. Others are tips and bits of infill.
        if let Some((count, first)) = in_the_air(verdict)
            && summary.hanging.begins.is_none()
        {
            let begin = match count {
                1 => "island begins on nothing",
                _ => "islands begin on nothing",
            };
            let first = place(first);
            let line = format!("{count} {begin}, the first at {first}");
            rows.add("in the air", line);
        }
    }
    rows.add("took", format!("{:.1} s", sums.took.as_secs_f64()));
    let mut text = rows.text;
    for (stage, seconds) in sums.timings.iter().flatten() {
        writeln!(text, "    {stage:<9} {seconds:8.2} s")?;
    }
    Ok(text)
}
