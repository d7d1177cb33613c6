//! Features meet changes that may not change what is printed.
//!
//! Each feature is printed on a small part, once as it is and once with each
//! change: another way to write the file, the same body written otherwise, or
//! another way to run. The beads must be the same, or the filament where pieces
//! may differ. A failure names the feature and the change.

mod changes;
mod features;
mod printed;

use changes::{How, Plain};
use features::FEATURES;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;

/// What the features print without a change.
static PLAIN: [OnceLock<Plain>; FEATURES.len()] =
    [const { OnceLock::new() }; FEATURES.len()];

/// A change meets every feature.
fn check(change: &str, how: &How) {
    let mut wrong = Vec::new();
    for (feature, plain) in FEATURES.iter().zip(&PLAIN) {
        let plain = plain.get_or_init(|| Plain::of(feature));
        let differs = AssertUnwindSafe(|| how.differs(feature, plain));
        let differs = catch_unwind(differs)
            .unwrap_or_else(|_| Some("it cannot be sliced".into()));
        if let Some(what) = differs {
            wrong.push(format!("{} and {change}: {what}", feature.name));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Makes a test of each change.
macro_rules! changes {
    ($($name:ident: $how:expr;)*) => {
        $(#[test]
        fn $name() {
            check(&stringify!($name).replace('_', " "), &$how);
        })*
    };
}

changes! {
    a_layer_template: How::Written(&["gcode.layer=M117 layer {{ layer }}"]);
    relative_e: How::Written(&["gcode.relative_e=true"]);
    klipper: How::Written(&["gcode.flavour=klipper", "gcode.labels=on"]);
    reprapfirmware: How::Written(&["gcode.flavour=rrf"]);
    prusas_firmware: How::Written(&["gcode.flavour=prusa"]);
    f_times_two: How::Formula(|f| format!("2*({f})"));
    f_divided_by_eight: How::Formula(|f| format!("({f})/8"));
    f_united_with_itself: How::Formula(|f| format!("min({f}, {f})"));
    a_level_cut_within_a_layer: How::Cut("z - 1.95");
    a_level_cut_between_layers: How::Cut("z - 2.1");
    an_upright_cut: How::Cut("x + 0.37");
    a_slanted_cut: How::Cut("y - 0.3*x - 0.21*z");
    a_right_angle: How::Turned;
    another_place: How::Moved;
    more_threads: How::Threads;
    ranges: How::Ranges;
    company: How::Plate;
}
