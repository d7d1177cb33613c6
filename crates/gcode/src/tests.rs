//! Pacing and the G-code writer together, on small jobs made by hand: the
//! text itself, and what a machine that reads it would do.

use crate::{Header, Totals, WriteError, Writer, WriterPlan};
use glam::{DVec2, DVec3};
use isoslice_base::units::filament_area;
use isoslice_path::pace::{PacePlan, PacedLayer, PacedMove, Pacer, Sums};
use isoslice_path::travel::{LayerPath, Move, Travel};
use isoslice_planar::bead::{Bead, Role, Stroke};
use isoslice_settings::layers::LayerSpan;
use isoslice_settings::testing::settings;

fn points(at: &[(f64, f64)]) -> Vec<DVec2> {
    at.iter().map(|&p| DVec2::from(p)).collect()
}

fn bead(role: Role, width: f64, closed: bool, at: &[(f64, f64)]) -> Bead {
    Bead::new(role, Stroke::new(points(at), closed, width), 0.2)
}

fn travel(at: &[(f64, f64)], retract: bool) -> Move {
    Move::Travel(Travel {
        points: points(at),
        retract,
        hop: retract,
        ..Travel::default()
    })
}

fn layer(index: usize, moves: Vec<Move>) -> LayerPath {
    LayerPath {
        span: LayerSpan {
            index,
            bottom: 0.2 * index as f64,
            top: 0.2 * (index + 1) as f64,
        },
        moves,
    }
}

/// Two layers with every kind of step.
fn tiny() -> Vec<LayerPath> {
    let wall = [(100.0, 100.0), (112.0, 100.0), (106.0, 110.0)];
    let within = [(101.5, 101.0), (110.5, 101.0), (106.0, 108.5)];
    let lines = [
        (104.0, 103.0),
        (108.0, 103.0),
        (107.5, 104.0),
        (104.5, 104.0),
    ];
    let first = vec![
        travel(&[(95.0, 95.0)], true),
        Move::Print(bead(
            Role::Skirt,
            0.45,
            false,
            &[(95.0, 95.0), (117.0, 95.0)],
        )),
        travel(&[(118.0, 98.0), (101.5, 101.0)], true),
        Move::Print(bead(Role::InnerWall, 0.45, true, &within)),
        travel(&[(100.0, 100.0)], false),
        Move::Print(bead(Role::OuterWall, 0.45, true, &wall)),
        travel(&[(104.0, 103.0)], false),
        Move::Print(bead(Role::BottomSkin, 0.5, false, &lines)),
    ];
    let second = vec![
        travel(&[(100.0, 100.0)], true),
        Move::Print(bead(Role::OuterWall, 0.45, true, &wall)),
        travel(&[(104.0, 103.0)], true),
        Move::Print(bead(Role::TopSkin, 0.5, false, &lines)),
    ];
    vec![layer(0, first), layer(1, second)]
}

/// Beads with coordinates off the grid of micrometres, many of them shorter
/// than it, and widths of their own.
fn rough(layers: usize) -> Vec<LayerPath> {
    let mut rng = fastrand::Rng::with_seed(1);
    let mut random = move || rng.f64();
    (0..layers)
        .map(|index| {
            let mut moves = Vec::new();
            for _ in 0..6 {
                let mut p = DVec2::new(random(), random()) * 50.0;
                let mut at = vec![p];
                for _ in 0..200 {
                    let size = 10f64.powf(random() * 4.5 - 4.0);
                    let turn =
                        DVec2::from_angle(random() * std::f64::consts::TAU);
                    p += size * turn;
                    at.push(p);
                }
                let retract = random() > 0.5;
                moves.push(Move::Travel(Travel {
                    hop: retract,
                    ..Travel::straight(at[0], retract)
                }));
                moves.push(Move::Print(Bead::new(
                    Role::SparseInfill,
                    Stroke::new(at, false, 0.35 + 0.2 * random()),
                    0.2,
                )));
            }
            layer(index, moves)
        })
        .collect()
}

fn header(layer_count: usize) -> Header {
    Header {
        model_name: "tiny".to_owned(),
        layer_count,
        layers: 0..layer_count,
        timestamp: None,
        nozzle_temperature: 215.0,
        part_min: DVec3::new(100.0, 100.0, 0.0),
        part_max: DVec3::new(112.0, 110.0, 0.2 * layer_count as f64),
        parts: vec![super::Standing {
            name: "tiny".to_owned(),
            min: DVec2::splat(100.0),
            max: DVec2::new(112.0, 110.0),
            outline: Vec::new(),
        }],
        thumbnails: Vec::new(),
        format: crate::Format::Text,
        fingerprint: None,
        one_by_one: false,
    }
}

/// A job's G-code with some settings.
fn written(assignments: &[&str], job: Vec<LayerPath>) -> (String, Totals) {
    let settings = &settings(assignments);
    let mut out = Vec::new();
    let header = header(job.len());
    let mut nobody = |_: &[u8]| {};
    let mut writer =
        Writer::new(&mut out, WriterPlan::of(settings), &header, &mut nobody)
            .expect("templates");
    let plan = PacePlan::of(settings);
    let mut pacer = Pacer::new(&plan);
    for path in job {
        let paced = pacer.alone(path).unwrap();
        writer.layer(&paced).expect("layer");
    }
    let totals = writer.finish().expect("end");
    (String::from_utf8(out).expect("UTF-8"), totals)
}

/// A machine that reads the file.
#[derive(Default)]
struct Machine {
    at: [f64; 3],
    feed: f64,
    /// E word of absolute positions.
    e: f64,
    relative: bool,
    /// Net filament, and how far it is below its greatest.
    fed: f64,
    retracted: f64,
    retractions: usize,
    primes: usize,
    /// Worst relative error of the flow of a segment of 0.2 mm or more.
    flow_error: f64,
    width: f64,
    height: f64,
    waited: Vec<String>,
}

impl Machine {
    fn run(text: &str) -> Self {
        let mut m = Self::default();
        for line in text.lines() {
            m.line(line);
        }
        m
    }

    fn line(&mut self, line: &str) {
        if let Some(w) = line.strip_prefix(";WIDTH:") {
            self.width = w.parse().expect("width");
        } else if let Some(h) = line.strip_prefix(";HEIGHT:") {
            self.height = h.parse().expect("height");
        }
        let code = line.split(';').next().unwrap_or("");
        let mut words = code.split_whitespace();
        let word = |letter: char| {
            code.split_whitespace()
                .skip(1)
                .find_map(|w| w.strip_prefix(letter))
                .map(|v| v.parse::<f64>().expect("number"))
        };
        match words.next() {
            Some("M82") => self.relative = false,
            Some("M83") => self.relative = true,
            Some("M109" | "M190") => self.waited.push(code.to_owned()),
            Some("G92") => self.e = word('E').expect("E"),
            Some("G1") => {
                let to = [
                    word('X').unwrap_or(self.at[0]),
                    word('Y').unwrap_or(self.at[1]),
                    word('Z').unwrap_or(self.at[2]),
                ];
                let d: f64 = (0..3)
                    .map(|i| (to[i] - self.at[i]).powi(2))
                    .sum::<f64>()
                    .sqrt();
                if let Some(f) = word('F') {
                    self.feed = f;
                }
                assert!(self.feed > 0.0, "{line}");
                if let Some(e) = word('E') {
                    let step = if self.relative { e } else { e - self.e };
                    self.e = e;
                    self.filament(step, d, line);
                }
                self.at = to;
            }
            _ => {}
        }
    }

    fn filament(&mut self, step: f64, d: f64, line: &str) {
        self.fed += step;
        if step < 0.0 {
            assert_eq!(self.retracted, 0.0, "twice: {line}");
            assert_eq!(d, 0.0, "{line}");
            self.retracted = -step;
            self.retractions += 1;
        } else if self.retracted > 0.0 {
            assert_eq!(d, 0.0, "not primed: {line}");
            assert!(step > self.retracted - 1e-9, "half: {line}");
            self.retracted = 0.0;
            self.primes += 1;
        } else if d >= 0.2 {
            assert!(self.waited.len() == 2, "cold: {line}");
            let area =
                isoslice_planar::bead::cross_section(self.width, self.height);
            let error = step * filament_area(1.75) / d / area - 1.0;
            self.flow_error = self.flow_error.max(error.abs());
        }
    }
}

fn volume(job: &[LayerPath]) -> f64 {
    job.iter()
        .flat_map(|l| &l.moves)
        .map(|m| match m {
            Move::Print(b) => b.area() * b.stroke.length(),
            Move::Travel(_) => 0.0,
        })
        .sum()
}

fn redacted(text: &str) -> String {
    text.replace(env!("CARGO_PKG_VERSION"), "VERSION")
}

#[test]
fn a_tiny_job_for_marlin() {
    let (text, _) = written(&["retract.z_hop=0.4"], tiny());
    insta::assert_snapshot!(redacted(&text));
}

#[test]
fn a_tiny_job_for_klipper() {
    let klipper = ["gcode.flavour=klipper", "gcode.relative_e=true"];
    let (text, _) = written(&klipper, tiny());
    insta::assert_snapshot!(redacted(&text));
}

#[test]
fn the_filament_is_the_beads_volume_in_both_modes() {
    for relative_e in [false, true] {
        let relative_e = format!("gcode.relative_e={relative_e}");
        let flows = ["flow=103", "filament.flow=98", &relative_e];
        let job = tiny();
        let expected = volume(&job) * 1.03 * 0.98 / filament_area(1.75);
        let (text, totals) = written(&flows, job);
        let m = Machine::run(&text);
        let fed = m.fed + m.retracted;
        assert!((fed - totals.filament_length).abs() < 1e-5);
        // Every point is on the grid of micrometres: nothing is rounded.
        assert!((fed - expected).abs() < 1e-5, "{fed} {expected}");
        let mass = totals.filament_volume * 1.24e-3;
        assert!((totals.filament_mass_g - mass).abs() < 1e-12);
    }
}

#[test]
fn rounding_neither_adds_up_nor_shows_as_flow() {
    let mut fed = Vec::new();
    for relative_e in [false, true] {
        let relative_e = format!("gcode.relative_e={relative_e}");
        let (text, totals) = written(&[&relative_e], rough(10));
        let m = Machine::run(&text);
        assert!(m.flow_error < 0.003, "{}", m.flow_error);
        let sum = m.fed + m.retracted;
        // Half a unit of the last decimal for each of ten layers.
        assert!((sum - totals.filament_length).abs() < 10.0 * 0.5e-5);
        fed.push((totals, m.retractions));
    }
    assert_eq!(fed[0], fed[1]);
}

#[test]
fn numbers_are_plain() {
    for flavour in ["gcode.flavour=marlin", "gcode.flavour=klipper"] {
        for relative_e in ["gcode.relative_e=false", "gcode.relative_e=true"] {
            // Around the origin, where negative zero would be.
            let mut job = rough(2);
            for m in job.iter_mut().flat_map(|l| &mut l.moves) {
                let at = match m {
                    Move::Travel(travel) => &mut travel.points,
                    Move::Print(b) => &mut b.stroke.points,
                };
                for p in at {
                    *p = (*p - DVec2::splat(25.0)) * 1e-3;
                }
            }
            let (text, _) = written(&[flavour, relative_e], job);
            assert!(text.ends_with('\n') && !text.contains('\r'));
            assert!(text.starts_with("; generated by isoslice "));
            let mut last = None;
            for line in text.lines().filter(|l| !l.starts_with(';')) {
                assert!(!line.ends_with(' '));
                for w in
                    line.split(' ').skip(1).filter(|_| line.starts_with("G1 "))
                {
                    let number = &w[1..];
                    assert_ne!(number, "-0", "{line}");
                    assert!(
                        number
                            .chars()
                            .all(|c| c.is_ascii_digit() || "-.".contains(c)),
                        "{line}"
                    );
                    if let Some((_, decimals)) = number.split_once('.') {
                        let most = match w.as_bytes()[0] {
                            b'E' => 5,
                            b'F' => 0,
                            _ => 3,
                        };
                        assert!(decimals.len() <= most, "{line}");
                        assert!(!decimals.ends_with('0'), "{line}");
                    }
                }
                // A place is never gone to twice in a row.
                if line.starts_with("G1 X") {
                    let xy: Vec<_> = line.split(' ').take(3).collect();
                    assert_ne!(Some(&xy), last.as_ref(), "{line}");
                    last = Some(xy);
                }
            }
        }
    }
}

#[test]
fn retractions_are_primed_and_the_last_one_stays() {
    let (text, _) = written(&[], tiny());
    let m = Machine::run(&text);
    // Two travels on each layer, and the end.
    assert_eq!((m.retractions, m.primes), (5, 4));
    assert!((m.retracted - 0.8).abs() < 1e-9);

    let m = Machine::run(&written(&["retract.length=0"], tiny()).0);
    assert_eq!((m.retractions, m.primes), (0, 0));

    let (text, totals) = written(&["retract.extra_prime=0.05"], tiny());
    let m = Machine::run(&text);
    let plain = volume(&tiny()) / filament_area(1.75);
    assert!((totals.filament_length - plain - 4.0 * 0.05).abs() < 1e-5);
    assert!((m.fed + m.retracted - totals.filament_length).abs() < 1e-5);
}

/// A bead, a wipe back along it, and another bead.
fn wiped() -> Vec<LayerPath> {
    let line = |y: f64| {
        let at = [(100.0, y), (110.0, y)];
        Move::Print(bead(Role::OuterWall, 0.45, false, &at))
    };
    let away = Move::Travel(Travel {
        wipe: points(&[(108.0, 100.0), (107.0, 100.0)]),
        points: points(&[(100.0, 104.0)]),
        retract: true,
        ..Travel::default()
    });
    let moves = vec![
        travel(&[(100.0, 100.0)], true),
        line(100.0),
        away,
        line(104.0),
    ];
    vec![layer(0, moves.clone()), layer(1, moves)]
}

#[test]
fn a_wipe_spreads_the_retraction_over_its_way() {
    for (before, relative_e) in
        [(25.0, true), (0.0, true), (100.0, true), (25.0, false)]
    {
        let assignments = [
            "retract.extra_prime=0.03",
            &format!("retract.before_wipe={before}"),
            &format!("gcode.relative_e={relative_e}"),
        ];
        let (text, totals) = written(&assignments, wiped());
        let (mut e, mut back, mut wiping) = (0.0, 0.0_f64, false);
        let (mut net, mut wipes, mut primes) = (0.0, 0, 0);
        let mut on_wipe = Vec::new();
        for line in text.lines() {
            match line {
                ";WIPE_START" => {
                    assert!((back - 0.008 * before).abs() < 1e-9, "{back}");
                    wiping = true;
                    on_wipe.clear();
                }
                ";WIPE_END" => {
                    assert!((back - 0.8).abs() < 1e-9, "{back}");
                    wiping = false;
                    wipes += 1;
                }
                "G92 E0" => e = 0.0,
                _ => {}
            }
            let words = || line.split(' ').skip(1);
            let word = words().find_map(|w| w.strip_prefix('E'));
            let across = words().any(|w| w.starts_with('X'));
            if !line.starts_with("G1") {
                continue;
            }
            let number = word.map(|w| w.parse::<f64>().unwrap());
            let step = match (number, relative_e) {
                (Some(n), true) => n,
                (Some(n), false) => n - std::mem::replace(&mut e, n),
                (None, _) => 0.0,
            };
            net += step;
            if wiping {
                assert!(across && step <= 0.0, "{line}");
                on_wipe.push(step);
                back -= step;
            } else if step < 0.0 {
                assert!(!across, "{line}");
                back -= step;
            } else if back > 0.0 && step > 0.0 {
                assert!((step - back - 0.03).abs() < 1e-9, "{line}");
                (back, primes) = (0.0, primes + 1);
            }
            if wiping && on_wipe.len() == 2 {
                // 2 mm and 1 mm.
                let of = (on_wipe[0], 2.0 * on_wipe[1]);
                assert!((of.0 - of.1).abs() < 2e-5, "{of:?}");
            }
        }
        assert_eq!((wipes, primes), (2, 4), "{text}");
        // What is back at the end has not been printed.
        assert!((net + back - totals.filament_length).abs() < 1e-5);
    }
}

#[test]
fn comments_of_our_own_avoid_the_words_viewers_colour_by() {
    let (text, _) = written(&[], tiny());
    // Nothing comes after the foot that could be coloured.
    let foot = text.find("\n; times are").expect("there is a foot");
    for line in text[..foot].lines().filter(|l| !l.starts_with(";TYPE:")) {
        let Some((_, comment)) = line.split_once(';') else {
            continue;
        };
        let comment = comment.to_lowercase();
        for word in [
            "inner",
            "outer",
            "perimeter",
            "fill",
            "skin",
            "support",
            "skirt",
        ] {
            assert!(!comment.contains(word), "{line}");
        }
    }
}

#[test]
fn a_start_template_that_heats_is_left_to_it() {
    let macro_ = "gcode.start=START_PRINT \
                  BED={{ first_layer_bed_temperature }} \
                  NOZZLE={{ first_layer_nozzle_temperature }}";
    let (text, _) = written(&[macro_], tiny());
    assert!(text.contains("\nSTART_PRINT BED=60 NOZZLE=215\n"));
    assert!(!text.contains("M109") && !text.contains("M190"));
    // The modes are set again after what the template may have done.
    assert_eq!(text.matches("\nM82\n").count(), 2);

    let (text, _) = written(&["gcode.start=M104 S150\nG28"], tiny());
    assert!(!text.contains("M104 S215"));
    assert!(text.contains("G28\nM190 S60\nM109 S215\n"));
    assert_eq!(text.matches("\nM82\n").count(), 1);
}

#[test]
fn an_unheated_bed_is_never_spoken_of() {
    let cold = [
        "filament.bed_temperature=0",
        "filament.first_layer_bed_temperature=0",
    ];
    let (text, _) = written(&cold, tiny());
    assert!(text.contains("M104 S0\n"));
    assert!(!text.contains("M140") && !text.contains("M190"));
}

#[test]
fn the_firmware_retracts_if_asked() {
    for relative_e in [false, true] {
        let assignments = [
            "retract.firmware=true",
            "retract.extra_prime=0.05",
            &format!("gcode.relative_e={relative_e}"),
        ];
        let (text, totals) = written(&assignments, tiny());
        assert!(text.contains("\nM207 S0.8 F2100 Z0\nM208 S0.05 F2100\n"));
        let count = |c| text.lines().filter(|l| *l == c).count();
        assert_eq!((count("G10"), count("G11")), (4, 4));
        // The file pulls back once, at its end: a firmware that was left
        // retracted would not retract again in the next print.
        let m = Machine::run(&text);
        assert_eq!((m.retractions, m.primes), (1, 0));
        assert!((m.retracted - 0.8).abs() < 1e-9);
        let extra = 4.0 * 0.05;
        let fed = m.fed + m.retracted + extra;
        assert!((fed - totals.filament_length).abs() < 1e-5);
    }
}

#[test]
fn the_end_knows_what_the_print_took() {
    let end =
        "gcode.end=M117 {{ print_time }}, {{ filament_length | round }} mm";
    let (text, totals) = written(&[end], tiny());
    let time = isoslice_base::units::human_time(totals.time);
    let length = totals.filament_length.round();
    assert!(
        text.contains(&format!("\nM117 {time}, {length} mm\n")),
        "{text}"
    );
}

#[test]
fn template_errors_name_place_and_remedy() {
    let s = settings(&["gcode.end=M104 S0\nG1 Z{{ part_max }} F600"]);
    let error =
        Writer::new(Vec::new(), WriterPlan::of(&s), &header(2), &mut |_| {})
            .map(|_| ());
    let text = error.expect_err("unknown placeholder").to_string();
    insta::assert_snapshot!(text);
}

#[test]
fn templates_are_tried_with_what_a_print_may_have() {
    let layer = "gcode.layer=; {{ (100 / layer) | round }} %";
    let end = "gcode.end=; {{ (filament_length / print_seconds) | round(3) }} \
               mm/s";
    let (text, _) = written(&[layer, end], tiny());
    assert!(text.contains("; 100 %\n") && text.contains("; 50 %\n"));
    assert!(text.contains(" mm/s\n"));
}

#[test]
fn a_layers_own_temperature_has_the_last_word() {
    let layer = "gcode.layer={% if layer == 2 %}M104 S240{% endif %}";
    let (text, _) = written(&[layer], tiny());
    let set: Vec<&str> =
        text.lines().filter(|l| l.starts_with("M104")).collect();
    assert_eq!(set[1..3], ["M104 S210", "M104 S240"], "{set:?}");
}

#[test]
fn after_a_layers_own_moves_the_head_goes_across_before_it_comes_down() {
    let park = "gcode.layer={% if layer_bottom > 0 %}\nG1 Z40\nG1 X10 Y200 \
                F6000\nM0\n{% endif %}";
    let (text, _) = written(&[park], tiny());
    let (before, after) = text.split_once("\nM0\n").expect("a pause");
    assert!(!after.contains("\nM0\n"), "{text}");
    let mut printed = before.lines().rev();
    let last = printed.find(|l| l.starts_with("G1 X") && l.contains(" E"));
    let (last, _) = last.and_then(|l| l.split_once(" E")).expect("a bead");
    let travels = |l: &&str| l.starts_with("G1 X") || l.starts_with("G1 Z");
    let mut moves = after.lines().filter(travels);
    let across = moves.next().expect("a move");
    // A line says only what changes.
    let same = last.split(' ').all(|word| across.contains(word));
    assert!(same && across.ends_with(" F9000"), "{last}: {after}");
    let down = moves.next().expect("a move");
    assert!(down.starts_with("G1 Z"), "{after}");
}

#[test]
fn the_first_layer_is_as_hot_as_the_others_ask_for() {
    let hot = [
        "filament.nozzle_temperature=250",
        "filament.bed_temperature=90",
    ];
    let start = "gcode.start=; {{ filament.first_layer_nozzle_temperature }} \
                 {{ first_layer_bed_temperature }}";
    let (text, _) = written(&[hot[0], hot[1], start], tiny());
    assert!(text.contains("; 255 90\n"), "{text}");
    assert!(
        text.contains("M109 S255") && text.contains("M190 S90"),
        "{text}"
    );
}

#[test]
fn what_is_no_number_is_an_error() {
    let s = settings(&[]);
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        let mut nobody = |_: &[u8]| {};
        let mut writer = Writer::new(
            Vec::new(),
            WriterPlan::of(&s),
            &header(1),
            &mut nobody,
        )
        .expect("templates");
        let paced = PacedLayer {
            before: 0,
            from_anywhere: true,
            span: layer(7, vec![]).span,
            moves: vec![PacedMove::Travel {
                points: vec![DVec2::new(bad, 1.0)],
                speed: 100.0,
            }],
            parts: Vec::new(),
            fan: 0.0,
            nozzle_temperature: 210.0,
            time: 1.0,
            sums: Sums::default(),
        };
        let error = writer.layer(&paced);
        assert!(matches!(
            error,
            Err(WriteError::BadNumber {
                what: "x",
                layer: 8,
                ..
            })
        ));
    }
}

#[test]
fn a_point_that_is_no_number_passes_pacing_and_is_reported() {
    let s = settings(&[]);
    let mut path = tiny().remove(0);
    if let Some(Move::Print(b)) = path.moves.get_mut(3) {
        b.stroke.points[1].y = f64::NAN;
    }
    let paced = Pacer::new(&PacePlan::of(&s)).alone(path).unwrap();
    let mut nobody = |_: &[u8]| {};
    let mut writer =
        Writer::new(Vec::new(), WriterPlan::of(&s), &header(1), &mut nobody)
            .expect("templates");
    assert!(matches!(
        writer.layer(&paced),
        Err(WriteError::BadNumber { what: "y", .. })
    ));
}

#[test]
fn the_footer_says_what_the_print_takes() {
    let (text, totals) = written(&[], tiny());
    assert_eq!(totals.layers, 2);
    assert!(text.contains("; total layers count = 2\n"));
    let time = isoslice_base::units::human_time(totals.time);
    assert!(text.contains(&format!(
        "; estimated printing time (normal mode) = {time}\n"
    )));
    let used = format!("; filament used [mm] = {:.2}", totals.filament_length);
    assert!(text.contains(used.trim_end_matches('0')));
}
