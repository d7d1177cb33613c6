//! Work that is stopped ends with an error, wherever that is, not with a panic nor
//! with a result.
//!
//! Stages that cannot fail return what they have when they are stopped. So what
//! others get from them then may be unfinished, and they have to bear it.

use crate::common;
use isoslice::limits::{Limits, Reason, Watch};
use isoslice::pipeline::{self, Options};

/// The least growth of the number of questions from one run to the next.
const GROWTH: f64 = 1.3;

/// Slices a part again and again, each time stopped later, until it is done.
#[track_caller]
fn stops_everywhere(formula: &str, settings: &[&str]) {
    let coarse = ["sample_spacing=0.225", "layer_height=0.3"];
    let settings = common::settings(&[&coarse, settings].concat());
    let model = common::formula(formula, &settings);
    let pictures = tempfile::tempdir().unwrap();
    let options = Options {
        threads: Some(2),
        check: true,
        svg_dir: Some(pictures.path()),
        ..Options::default()
    };
    let mut questions = 1;
    let mut stopped = 0;
    loop {
        let watch = Watch::new(Limits::default());
        watch.cancel_after(questions);
        let mut result = None;
        let run = || {
            let mut bytes = Vec::new();
            let made = pipeline::slice(&model, &settings, &options, &mut bytes);
            result = Some(made);
        };
        let run = watch.run(run);
        let result = result.unwrap();
        let Err(why) = run else {
            result.unwrap();
            break;
        };
        assert_eq!(why.reason, Reason::Cancelled);
        assert!(result.is_err(), "stopped after {questions} questions");
        stopped += 1;
        questions = (questions as f64 * GROWTH) as u64 + 1;
    }
    assert!(stopped > 20, "{stopped}");
}

#[test]
fn a_box_with_a_hole_stops_everywhere() {
    let block = "max(max(max(abs(x) - 7, abs(y) - 6), abs(z - 3) - 3), \
                 2 - sqrt(x*x + (z - 3)^2))";
    stops_everywhere(block, &["infill=gyroid", "ironing=true", "seam_scarf=8"]);
    stops_everywhere(
        block,
        &[
            "supports=auto",
            "raft.layers=2",
            "skin_pattern=top: concentric",
            "xy_compensation=0.1",
        ],
    );
}

#[test]
fn a_lattice_stops_everywhere() {
    let sheet = "max(abs(sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)) - \
                 0.3, max(max(abs(x), abs(y)) - 5, abs(z - 2) - 2))";
    let more = [
        "brim.place=ears",
        "infill=cubic",
        "filament.max_flow_change=9",
    ];
    stops_everywhere(sheet, &more);
    stops_everywhere(sheet, &["walls_interlocked=true", "supports=auto"]);
}

#[test]
fn domes_and_vases_stop_everywhere() {
    let dome = "sqrt(x*x + y*y + z*z) - 6";
    let follows = ["contour_z=80", "contour_z_below=true", "supports=auto"];
    stops_everywhere(dome, &follows);
    let adaptive = ["layer_heights=adaptive", "fuzzy.thickness=0.2"];
    stops_everywhere(dome, &adaptive);
    let cone = "max(sqrt(x*x + y*y) - 5 - 0.2*z, abs(z - 3) - 3)";
    stops_everywhere(cone, &["spiral=true"]);
    let by_place = ["xy_compensation=expr: 0.02*z", "outer_wall_width=0.5"];
    stops_everywhere(cone, &by_place);
}
