//! A vase is one bead from its first turn to its end, whatever its form and its
//! height are, and whatever else is in the file.

use crate::common;
use crate::common::{Move, MoveKind, join, parse, slice, slice_layers};

/// Layer height, mm.
const HEIGHT: f64 = 0.2;

/// Vases by name, as fields of x, y and z.
const FORMS: [(&str, &str); 5] = [
    ("round", "sqrt(x^2 + y^2) - 5"),
    ("square", "max(abs(x), abs(y)) - 5"),
    ("leaning", "sqrt((x - z/2)^2 + y^2) - 4 - z/20"),
    (
        "twisted",
        "max(abs(x*cos(z/9) + y*sin(z/9)), abs(y*cos(z/9) - x*sin(z/9))) - 5",
    ),
    ("lobed", "sqrt(x^2 + y^2) - 6 - cos(5*atan2(y, x) + z/5)"),
];

/// The file of some layers of a vase that is this many layers high.
fn vase(form: &str, count: usize, more: &[&str], layers: &str) -> String {
    let mut all = vec![
        "spiral=true",
        "layer_height=0.2",
        "first_layer_height=0.2",
        "bottom_layers=2",
        "skirt.loops=0",
        "accuracy=0.03",
        "sample_spacing=0.225",
    ];
    all.extend(more);
    let settings = common::settings(&all);
    let top = HEIGHT * count as f64;
    let text = format!("max({form}, abs(z - {top}/2) - {top}/2)");
    let model = common::formula(&text, &settings);
    let (gcode, summary) = slice_layers(&model, &settings, layers, 2);
    assert_eq!(summary.layer_count, count);
    gcode
}

/// The moves from the first one that rises while it prints on.
fn climb(gcode: &str) -> Vec<Move> {
    let body = &gcode[..gcode.find("; end of layers").unwrap()];
    let moves = parse(body).into_iter().flat_map(|layer| layer.moves);
    let rises = |m: &Move| m.kind == MoveKind::Print && m.to.z > m.from.z;
    moves.skip_while(|m| !rises(m)).collect()
}

/// Each move begins where the move before ends, feeds, and goes up or stays.
#[track_caller]
fn assert_climbs(climb: &[Move], count: usize) {
    let first = climb[0].from;
    assert!((first.z - 2.0 * HEIGHT).abs() < 1e-9, "{first}");
    let mut at = first;
    for m in climb {
        assert_eq!((m.kind, m.from), (MoveKind::Print, at), "{m:?}");
        assert!(m.fed > 0.0 && m.to.z >= m.from.z, "{m:?}");
        assert!(m.to.z - m.from.z < 0.5 * HEIGHT, "{m:?}");
        at = m.to;
    }
    assert!((at.z - HEIGHT * count as f64).abs() < 1e-9, "{at}");
}

/// Two climbs lay the same beads.
#[track_caller]
fn assert_same(a: &[Move], b: &[Move]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert_eq!((a.from, a.to), (b.from, b.to));
        // A restart of the counter rounds once.
        assert!((a.fed - b.fed).abs() < 2.1e-5, "{a:?} {b:?}");
    }
}

#[test]
fn a_vase_is_one_bead_with_and_without_a_template() {
    let template =
        "gcode.layer=M117 layer {{ layer }}\nG92 E0\nM73 P{{ layer }}";
    for (name, form) in FORMS {
        for count in [40, 140] {
            let plain = climb(&vase(form, count, &[], ".."));
            assert_climbs(&plain, count);
            let told = climb(&vase(form, count, &[template], ".."));
            assert_climbs(&told, count);
            assert_same(&plain, &told);
            println!("{name}: {} moves", plain.len());
        }
    }
}

#[test]
fn a_vase_of_400_layers_is_one_bead() {
    for (_, form) in [FORMS[2], FORMS[4]] {
        assert_climbs(&climb(&vase(form, 400, &[], "..")), 400);
    }
}

#[test]
fn a_vase_is_one_bead_whatever_else_is_in_the_file() {
    let (_, form) = FORMS[3];
    let plain = climb(&vase(form, 140, &[], ".."));
    for more in [
        &["gcode.relative_e=false"][..],
        &["gcode.relative_e=true"],
        &["gcode.flavour=klipper", "gcode.labels=on"],
        &["gcode.flavour=rrf", "gcode.labels=on", "gcode.arcs=true"],
        &["gcode.flavour=prusa", "retract.firmware=true"],
        &["gcode.flavour=bambu", "gcode.progress=on"],
        &["retract.z_hop=0.2", "retract.wipe=2", "seam_wipe=1"],
        &["seam_scarf=5", "contour_z=50"],
    ] {
        let other = climb(&vase(form, 140, more, ".."));
        assert_climbs(&other, 140);
        assert_same(&plain, &other);
    }
    for more in [
        "first_layer_height=0.3",
        "layer_height=0.1125",
        "layer_heights=adaptive",
        "speed.outer_wall=expr: 20 + z",
        "filament.max_flow_change=50",
        "bead_width=expr: 100 + 10*sin(z)",
        "xy_compensation=0.1",
    ] {
        let settings =
            common::settings(&["spiral=true", "skirt.loops=0", more]);
        let text = format!("max({form}, abs(z - 14) - 14)");
        let model = common::formula(&text, &settings);
        let climb = climb(&slice(&model, &settings, 2).0);
        for (a, b) in climb.iter().zip(&climb[1..]) {
            assert_eq!(
                (b.kind, b.from),
                (MoveKind::Print, a.to),
                "{more}: {b:?}"
            );
            assert!(b.to.z >= b.from.z, "{more}: {b:?}");
        }
    }
}

/// A template that moves the head is followed by the way back.
#[test]
fn the_head_comes_back_from_a_template() {
    let (_, form) = FORMS[1];
    let plain = climb(&vase(form, 40, &[], ".."));
    for away in ["G1 Z90 F600", "G1 X3 Y4 Z90 F6000", "G1 X3 F6000", "PARK"] {
        let template = format!("gcode.layer={away}");
        let moves = climb(&vase(form, 40, &[&template], ".."));
        let (beads, ways): (Vec<Move>, Vec<Move>) =
            moves.into_iter().partition(|m| m.kind == MoveKind::Print);
        assert_same(&plain, &beads);
        assert!(ways.len() >= 2 * 37, "{away}: {}", ways.len());
    }
}

/// The files of ranges have a whole climb each, and make the file of one run.
#[test]
fn ranges_of_a_vase_climb_alike() {
    let (_, form) = FORMS[4];
    let whole = vase(form, 140, &[], "..");
    let ranges = ["1..50", "51..128", "129.."];
    let files = ranges.map(|layers| vase(form, 140, &[], layers));
    assert!(join(&files).unwrap() == whole.as_bytes());
    let all = climb(&whole);
    let mut rest = all.as_slice();
    for (k, file) in files.iter().enumerate() {
        let moves = climb(file);
        let (of_file, above) = rest.split_at(moves.len());
        assert_same(of_file, &moves);
        rest = above;
        if k == 0 {
            continue;
        }
        // The head comes to its place from above before it prints.
        let layers = file.find(";LAYER_CHANGE").unwrap();
        let head: Vec<&str> = file[..layers]
            .lines()
            .filter(|l| l.starts_with("G1 X") || l.starts_with("G1 Z"))
            .collect();
        let [.., up, across, down] = head.as_slice() else {
            panic!("{head:?}");
        };
        assert!(up.starts_with("G1 Z") && across.starts_with("G1 X"));
        let z = format!("G1 Z{}", moves[0].from.z);
        assert!(down.starts_with(&z), "{down} {z}");
    }
    assert!(rest.is_empty());
}
