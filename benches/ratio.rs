//! The cost of slicing, as a multiple of merely evaluating the field.
//!
//!     cargo bench --bench ratio [-- MODEL [LARGEST_SIDE_MM]]
//!
//! Y is the processor time for the field at every node of a 0.1 mm lattice
//! over each layer of the gyroid ball, on one thread, with fidget's
//! interpreter: 68 million samples. It is measured in the same run as the
//! slicing, so the ratio means the same on any machine, however busy.
//! Without a model the gyroid ball is sliced. Below the median of three runs
//! stand the stages, each the least of the three, on one thread, and what
//! follows from them for many threads.

use cpu_time::ProcessTime;
use fidget::context::Context;
use fidget::eval::{BulkEvaluator, Function, MathFunction};
use fidget::vm::VmFunction;
use isoslice::model::{self, BuildVolume, Placement, Source};
use isoslice::pipeline::{Options, Summary, slice};
use isoslice::settings::Builder;
use std::error::Error;
use std::io;
use std::path::PathBuf;

const BALL: &str = "examples/gyroid-ball.rhai";

fn load(path: &str, size: Option<f64>) -> Result<model::Model, Box<dyn Error>> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let loaded = model::load(&Source::File(root.join(path)), &[])?;
    let placement = Placement {
        size,
        ..Placement::default()
    };
    let volume = BuildVolume {
        x: 220.0,
        y: 220.0,
        z: 250.0,
    };
    Ok(model::place(&loaded, &placement, volume)?)
}

/// Processor seconds of the dense evaluation.
fn dense() -> Result<f64, Box<dyn Error>> {
    let ball = load(BALL, None)?;
    let mut ctx = Context::new();
    let root = ctx.import(&ball.tree);
    let f = VmFunction::new(&ctx, &[root])?;
    let tape = f.float_slice_tape(Default::default());
    let mut eval = VmFunction::new_float_slice_eval();
    let side = 521;
    let row: Vec<f32> = (0..side).map(|i| i as f32 * 0.1 - 26.0).collect();
    let start = ProcessTime::now();
    let mut inside = 0_usize;
    for layer in 0..250 {
        let z = vec![layer as f32 * 0.2 - 24.9; side];
        for &y in &row {
            let y = vec![y; side];
            // The expression's variables come in the order it uses them.
            let mut vars: Vec<&[f32]> = vec![&row; 3];
            for (axis, slice) in [
                (fidget::var::Var::X, &row),
                (fidget::var::Var::Y, &y),
                (fidget::var::Var::Z, &z),
            ] {
                if let Some(i) = f.vars().get(&axis) {
                    vars[i] = slice;
                }
            }
            let out = eval.eval(&tape, &vars)?;
            inside += out[0].iter().filter(|v| **v < 0.0).count();
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("dense evaluation: {inside} samples inside");
    Ok(seconds)
}

/// Processor seconds of a whole slicing run, and what it made.
fn whole(
    model: &model::Model,
    threads: usize,
) -> Result<(f64, Summary), Box<dyn Error>> {
    let options = Options {
        threads: Some(threads),
        ..Options::default()
    };
    let (settings, _) = Builder::new().finish()?;
    let start = ProcessTime::now();
    let mut sink = io::sink();
    let summary = slice(model, &settings, &options, &mut sink)?;
    Ok((start.elapsed().as_secs_f64(), summary))
}

/// Tells how much faster than one thread many are, if nothing but the stages'
/// times bounds them. Stages that run in order have a thread each, so none of
/// these takes less than its time; all other work is divided evenly.
fn on_paper(stages: &[&str], times: &[f64]) {
    const THREADS: f64 = 16.0;
    let ordered = ["pace", "gcode", "check"];
    let steps = stages.iter().zip(times);
    let steps = steps.filter(|(stage, _)| ordered.contains(stage));
    let whole: f64 = times.iter().sum();
    let divided = whole / THREADS;
    let Some((stage, longest)) = steps.max_by(|a, b| a.1.total_cmp(b.1)) else {
        return;
    };
    println!(
        "{THREADS} threads on paper: {:.1} times one thread; {stage} takes \
         {longest:.3} Y in order, and a thread's share of all is {divided:.3} Y",
        whole / longest.max(divided)
    );
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1).filter(|a| a != "--bench");
    let path = args.next().unwrap_or_else(|| BALL.into());
    let size = args.next().map(|s| s.parse()).transpose()?;
    let model = load(&path, size)?;
    let mut ratios = Vec::new();
    let mut profiles: Vec<Vec<f64>> = Vec::new();
    let mut stages: Vec<&str> = Vec::new();
    for _ in 0..3 {
        let y = dense()?;
        let (one, summary) = whole(&model, 1)?;
        let (two, _) = whole(&model, 2)?;
        println!(
            "Y {y:.2} s; {path}, {} layers: {one:.2} s on one thread \
             ({:.2} Y), {two:.2} s on two ({:.2} Y)",
            summary.layer_count,
            one / y,
            two / y
        );
        ratios.push(one / y);
        // Each thread's processor time, so the stages' sum is a little less
        // than the whole, which has start-up and waiting in it.
        profiles.push(summary.timings.iter().map(|t| t.1 / y).collect());
        stages = summary.timings.iter().map(|t| t.0.name()).collect();
    }
    ratios.sort_by(f64::total_cmp);
    println!("median: {:.2} Y", ratios[1]);
    let least = |i| profiles.iter().map(|p| p[i]).fold(f64::MAX, f64::min);
    let least: Vec<f64> = (0..stages.len()).map(least).collect();
    for (stage, least) in stages.iter().zip(&least) {
        println!("    {stage:<9} {least:6.3} Y");
    }
    on_paper(&stages, &least);
    Ok(())
}
