//! How the cost grows: with features, with empty space, with height.
//!
//!     cargo bench --bench growth
//!
//! Processor time, on one thread, so that a busy machine shows little; the
//! least of three runs, or of one that takes long. Memory is the most that
//! the process has held since the case began, where the system tells (Linux),
//! which includes what an earlier case has left in the allocator's hands: so
//! the small ones come first.
//!
//! What to expect: the same time per hole, island and layer however many
//! there are; next to no time for emptiness; no memory for height.

use cpu_time::ProcessTime;
use isoslice::model::{self, BuildVolume, Model, Placement, Source};
use isoslice::pipeline::{Options, slice};
use isoslice::settings::Builder;
use std::error::Error;
use std::{fs, io};

/// A run that is not repeated takes more than so many seconds.
const LONG: f64 = 2.0;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn model(formula: &str) -> Outcome<Model> {
    let source = Source::formula("growth", formula);
    // Cost is what matters here, not whether a printer is large enough.
    let volume = BuildVolume {
        x: 2000.0,
        y: 2000.0,
        z: 2000.0,
    };
    let loaded = model::load(&source, &[])?;
    Ok(model::place(&loaded, &Placement::default(), volume)?)
}

/// Peak memory since [`forget_peak`], megabytes.
fn peak() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

fn forget_peak() {
    // Where this fails, the peak is that of all cases so far.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Slices, and tells processor seconds, layers and peak memory.
fn measure(model: &Model) -> Outcome<(f64, usize, Option<f64>)> {
    let options = Options {
        threads: Some(1),
        // Some of the parts are larger than any bed.
        check: false,
        ..Options::default()
    };
    let mut builder = Builder::new();
    // Pictures cost as much for every part.
    builder.set("gcode.thumbnails=")?;
    let (settings, _) = builder.finish()?;
    let (mut best, mut layers) = (f64::INFINITY, 0);
    forget_peak();
    for _ in 0..3 {
        let start = ProcessTime::now();
        let summary = slice(model, &settings, &options, &mut io::sink())?;
        best = best.min(start.elapsed().as_secs_f64());
        layers = summary.layer_count;
        if best > LONG {
            break;
        }
    }
    Ok((best, layers, peak()))
}

fn show(
    what: &str,
    model: &Model,
    share: &dyn Fn(usize) -> (f64, &'static str),
) -> Outcome<f64> {
    let (seconds, layers, memory) = measure(model)?;
    let (count, unit) = share(layers);
    let memory = memory.map_or("–".into(), |m| format!("{m:.0} MB"));
    println!(
        "  {what:<22} {seconds:7.3} s  {:9.2} µs per {unit}  {memory}",
        seconds / count * 1e6
    );
    Ok(seconds)
}

/// A field of `n` × `n` places 4 mm apart, 2 mm high.
fn places(n: usize, holes: bool) -> Outcome<Model> {
    let half = 2 * n;
    // Where the sum of cosines exceeds 1: round spots of 1.3 mm radius.
    let spots = "cos(x * 1.5707963) + cos(y * 1.5707963) - 1";
    let spots = if holes {
        spots.to_owned()
    } else {
        format!("-({spots})")
    };
    // With their middle in the middle of a cell.
    model(&format!(
        "max(max(max(abs(x - 2) - {half}, abs(y - 2) - {half}), \
         abs(z) - 1), {spots})"
    ))
}

fn main() -> Outcome<()> {
    println!("a pillar, higher and higher");
    for height in [20, 80, 320] {
        let pillar = format!(
            "max(sqrt(x^2 + y^2) - 8 - sin(z / 5), abs(z) - {})",
            height / 2
        );
        show(&format!("{height} mm"), &model(&pillar)?, &|layers| {
            (layers as f64, "layer")
        })?;
    }
    println!("two balls, farther and farther apart");
    let mut before: Option<f64> = None;
    for apart in [25, 50, 100, 200] {
        let ball =
            |at: i32| format!("sqrt((x - {at})^2 + (y - {at})^2 + z^2) - 10");
        let balls = format!("min({}, {})", ball(-apart / 2), ball(apart / 2));
        let what = format!("{apart} mm each way");
        let seconds =
            show(&what, &model(&balls)?, &|layers| (layers as f64, "layer"))?;
        if let Some(before) = before {
            let growth = 100.0 * (seconds / before - 1.0);
            println!("  {:<22} {growth:+7.1} %", "for twice the side");
        }
        before = Some(seconds);
    }
    for (name, holes) in [("islands", false), ("holes in a plate", true)] {
        println!("{name}");
        for n in [10, 20, 40, 80] {
            let count = n * n;
            show(&count.to_string(), &places(n, holes)?, &|layers| {
                ((layers * count) as f64, "place and layer")
            })?;
        }
    }
    Ok(())
}
