//! How fast the flow of plastic changes along a stroke, read from every move of
//! the G-code.

use crate::common::{
    Move, MoveKind, filament_area, formula, parse, settings, slice,
};

/// A cylinder that leans far out, whose walls are overhangs on one side.
const LEANING: &str = "max(sqrt((x - 1.5*z)^2 + y^2) - 8, abs(z - 1) - 1)";
/// A star with fins that taper to nothing: beads of many widths.
const STAR: &str =
    "max(abs(x*y) - 2, max(max(abs(x), abs(y)) - 12, abs(z - 1) - 1))";

/// A ramp's steps last so long, s.
const TAU: f64 = 0.02;

/// A move's flow, mm³/s, and its duration.
fn flow(m: &Move) -> (f64, f64) {
    let time = m.from.distance(m.to) / (m.feed / 60.0);
    (m.fed * filament_area(1.75) / time, time)
}

/// By how much the flow changes too fast at worst, mm³/s, how many changes
/// there are, and how long it takes to print.
fn worst(text: &str, most: f64, more: &[&str]) -> (f64, usize, f64) {
    let limit = format!("filament.max_flow_change={most}");
    let mut all = vec![
        "sample_spacing=0.225",
        "cooling.min_layer_time=0",
        "speed.overhang=8",
        "speed.inner_wall=80",
        "gcode.relative_e=true",
        "gcode.progress=off",
        "gcode.arcs=false",
    ];
    all.push(&limit);
    all.extend(more);
    let settings = settings(&all);
    let (gcode, _) = slice(&formula(text, &settings), &settings, 2);
    let (mut off, mut changes, mut whole): (f64, usize, f64) =
        (f64::NEG_INFINITY, 0, 0.0);
    for layer in parse(&gcode) {
        let prints = |m: &Move| m.kind == MoveKind::Print && m.length() > 0.0;
        let all: Vec<Move> = layer
            .moves
            .into_iter()
            .filter(|m| m.from.is_finite())
            .collect();
        whole += all
            .iter()
            .filter(|m| prints(m))
            .map(|m| flow(m).1)
            .sum::<f64>();
        for pair in all.windows(2).filter(|p| p.iter().all(prints)) {
            let ((a, ta), (b, tb)) = (flow(&pair[0]), flow(&pair[1]));
            let time = if a < b { ta } else { tb };
            // Ends are rounded to micrometres, which matters in short moves.
            let least = pair[0].length().min(pair[1].length());
            let rounding = 3e-3 / least * a.max(b) + 0.02;
            let allowed = most.min(1e6) * time.min(TAU);
            off = off.max((a - b).abs() - allowed - rounding);
            changes += usize::from((a - b).abs() > rounding);
        }
    }
    (off, changes, whole)
}

#[test]
fn the_flow_changes_no_faster_than_asked_on_every_move() {
    for (text, more) in [
        (LEANING, &["infill_density=0", "top_layers=0"][..]),
        (LEANING, &["seam_scarf=5"][..]),
        (STAR, &["speed.gap_fill=80"][..]),
    ] {
        let (_, _, free) = worst(text, 0.0, more);
        for most in [20.0, 100.0] {
            let (off, changes, time) = worst(text, most, more);
            assert!(changes > 50, "{text}: {changes}");
            assert!(off <= 0.0, "{text}, {most}: {off} mm³/s too much");
            assert!(time > free && time < 2.0 * free, "{time} {free}");
        }
        // Without a limit it does change faster.
        let (off, ..) = worst(text, 0.0, more);
        assert!(off > 0.5, "{text}: {off}");
    }
}
