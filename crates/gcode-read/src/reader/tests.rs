use super::parser::other;
use super::*;
use glam::DVec3;
use isoslice_base::units::filament_area;

fn events(text: &str) -> Vec<Event> {
    Reader::new(text.as_bytes()).map(Result::unwrap).collect()
}

fn moves(text: &str) -> Vec<Move> {
    events(text)
        .into_iter()
        .filter_map(|e| match e {
            Event::Move(step) => Some(step),
            _ => None,
        })
        .collect()
}

fn problems(text: &str) -> Vec<(Problem, u64, u64)> {
    let mut reader = Reader::new(text.as_bytes());
    for event in reader.by_ref() {
        event.unwrap();
    }
    reader.problems().iter().collect()
}

#[test]
fn moves_know_where_they_come_from() {
    let found = moves("G1 X10 Y20 Z0.2 F1200\nG1 X13 Y24 E1.5\nG0 X0\n");
    assert_eq!(found.len(), 3);
    let step = found[1];
    assert_eq!(step.line, 2);
    assert_eq!(step.from, DVec3::new(10.0, 20.0, 0.2));
    assert_eq!(step.to, DVec3::new(13.0, 24.0, 0.2));
    assert_eq!((step.filament, step.speed), (1.5, 20.0));
    assert_eq!((step.length(), step.prints()), (5.0, true));
    assert!(!found[0].prints() && !found[2].prints());
    // 1.5 mm of a filament of 1.75 mm are fed over 5 mm.
    assert!((step.area(1.75) - 0.3 * filament_area(1.75)).abs() < 1e-12);
}

#[test]
fn relative_and_absolute_places_and_filament() {
    let text = "G91\nG1 X1 E1\nG1 X1 E1\nG90\nG1 X5 E3\nM83\nG1 X6 E1\n\
                G90\nG1 X7 E1\nM82\nG92 E0\nG1 X8 E0.5\n";
    let found = moves(text);
    let x: Vec<f64> = found.iter().map(|m| m.to.x).collect();
    let e: Vec<f64> = found.iter().map(|m| m.filament).collect();
    assert_eq!(x, [1.0, 2.0, 5.0, 6.0, 7.0, 8.0]);
    // After two relative millimetres, E3 is one millimetre more.
    assert_eq!(e, [1.0, 1.0, 1.0, 1.0, 1.0, 0.5]);
}

#[test]
fn g92_moves_the_zero_and_not_the_head() {
    let found =
        moves("G1 X10\nG92 X0 E5\nG1 X5 E6\nG28 X\nG1 X1\nG92\nG1 X2 E1\n");
    assert_eq!(found[1].from.x, 10.0);
    assert_eq!(found[1].to.x, 15.0);
    assert_eq!(found[1].filament, 1.0);
    assert_eq!((found[2].from.x, found[2].to.x), (0.0, 1.0));
    assert_eq!((found[3].to.x, found[3].filament), (3.0, 1.0));
}

#[test]
fn inches_are_converted() {
    let found = moves("G20\nG1 X1 E1 F60\nG21\nG1 X1\n");
    assert_eq!((found[0].to.x, found[0].filament), (25.4, 25.4));
    assert_eq!((found[0].speed, found[1].to.x), (25.4, 1.0));
}

#[test]
fn arcs_become_chords_that_share_line_and_filament() {
    let text = "G1 X10 Y0 Z1\nM83\nG3 X-10 Y0 Z2 I-10 J0 E4\nG1 X0\n";
    let found = moves(text);
    let arc: Vec<&Move> = found.iter().filter(|m| m.line == 3).collect();
    assert!(arc.len() > 10);
    let fed: f64 = arc.iter().map(|m| m.filament).sum();
    assert!((fed - 4.0).abs() < 1e-9);
    for step in &arc {
        assert!((step.to.truncate().length() - 10.0).abs() < 1e-9);
        assert!(step.to.y > -1e-9);
    }
    assert_eq!(arc[arc.len() - 1].to, DVec3::new(-10.0, 0.0, 2.0));
    assert_eq!(found[found.len() - 1].from, DVec3::new(-10.0, 0.0, 2.0));
}

#[test]
fn an_arc_without_a_centre_is_straight_and_said_so() {
    let text = "G1 X10\nG2 X20 Y5\nG2 X30 R1\n";
    assert_eq!(moves(text).len(), 3);
    assert_eq!(problems(text), [(Problem::BadArc, 2, 2)]);
}

#[test]
fn an_upright_arc_is_straight_and_said_so() {
    let text = "G18\nG2 X30 Z0.2 I5 K0 E1\nG17\nG2 X20 I-5\n";
    let found = moves(text);
    assert_eq!(found[0].to, DVec3::new(30.0, 0.0, 0.2));
    assert!(found.len() > 4, "the second is an arc");
    assert_eq!(problems(text), [(Problem::UprightArc, 2, 1)]);
}

#[test]
fn filament_may_be_a_volume() {
    // The bead is 50 mm long, 0.45 mm wide and 0.2 mm high.
    let area = filament_area(1.75);
    for (head, volumes) in [
        ("M200 D1.75\n", [true, true]),
        (";FLAVOR:UltiGCode\n", [true, true]),
        ("M200 D1.75\nM200 S0\n", [false, false]),
        ("M200 D1.75\nM200 D0\n", [false, false]),
    ] {
        let text = format!("{head}M82\nG1 X50 E4.5\nG92 E1\nG1 X0 E5.5\n");
        let found = moves(&text);
        for (step, volume) in found.iter().zip(volumes) {
            let exact = if volume { 4.5 / area } else { 4.5 };
            assert!((step.filament - exact).abs() < 1e-12, "{head} {step:?}");
        }
    }
}

#[test]
fn layers_and_roles_of_the_three_dialects() {
    let prusa = ";TYPE:Custom\nG1 X5 Z0.4 E1\n;LAYER_CHANGE\n;Z:0.2\n\
        ;HEIGHT:0.2\nG1 Z0.2\n;TYPE:External perimeter\n;WIDTH:0.45\n\
        G1 X9 E2\n;LAYER_CHANGE\n;HEIGHT:0.3\nG1 Z0.5\nG1 X1 E3\n";
    let orca = "G1 X5 Z0.4 E1\n; CHANGE_LAYER\n; LAYER_HEIGHT: 0.2\nG1 Z0.2\n\
        ; FEATURE: Outer wall\n; LINE_WIDTH: 0.45\nG1 X9 E2\n\
        ; CHANGE_LAYER\n; LAYER_HEIGHT: 0.3\nG1 Z0.5\nG1 X1 E3\n";
    // 1 mm of filament on 4 mm at 0.2 mm is wider than any bead. 0.15 mm is
    // not.
    let cura = ";LAYER_COUNT:2\n;LAYER:0\nG0 X5 Z0.2\n;TYPE:WALL-OUTER\n\
        G1 X9 E0.15\n;LAYER:1\nG0 Z0.5\nG1 X1 E0.3\n";
    for (name, text) in [("prusa", prusa), ("orca", orca), ("cura", cura)] {
        let printed: Vec<Move> = moves(text)
            .into_iter()
            .filter(|m| m.prints() && m.to.z != 0.4)
            .collect();
        assert_eq!(printed.len(), 2, "{name}");
        for (step, (layer, height)) in printed.iter().zip([(1, 0.2), (2, 0.3)])
        {
            assert_eq!(step.layer, layer, "{name}");
            assert_eq!(step.role, Role::OuterWall, "{name}");
            assert!((step.height - height).abs() < 1e-9, "{name}");
        }
        let width = match name {
            "cura" => 0.15 * filament_area(1.75) / 4.0 / 0.2 + 0.2 * 0.2146,
            _ => 0.45,
        };
        assert!((printed[0].width - width).abs() < 1e-4, "{name}");
        let layers: Vec<u32> = events(text)
            .iter()
            .filter_map(|e| match e {
                Event::Layer { number, .. } => Some(*number),
                _ => None,
            })
            .collect();
        // Where something is printed before the first mark, layers are counted
        // anew.
        let expected: &[u32] =
            if name == "cura" { &[1, 2] } else { &[1, 1, 2] };
        assert_eq!(layers, expected, "{name}");
    }
}

#[test]
fn plain_files_have_layers_too() {
    let text = "G1 Z0.2\nG1 X5 E1\nG1 Z0.6\nG1 X9\nG1 Z0.4\nG1 X1 E2\n";
    let layers: Vec<u32> = moves(text)
        .iter()
        .filter(|m| m.prints())
        .map(|m| m.layer)
        .collect();
    // The travel at 0.6 mm is a hop and no layer.
    assert_eq!(layers, [1, 2]);
}

#[test]
fn temperatures_fans_tools_and_waits() {
    let text = "M140 S60\nM109 R210\nM104 T1 S190\nM106 S127.5\nM106 P2\n\
                M107\nT1\nG4 P500\nG10\nG11\nG10 P1 S220 R150\nM204 P900 T1500\n\
                SET_VELOCITY_LIMIT ACCEL=2000\nM900 K0.05\nG28\n";
    let mut reader = Reader::new(text.as_bytes());
    let mut found = Vec::new();
    while let Some(event) = reader.next() {
        let event = event.unwrap();
        if let Event::Other {
            letter: 'M',
            tenths: 9000,
            ..
        } = event
        {
            assert_eq!(reader.words().get(b'K'), Some(0.05));
        }
        found.push(event);
    }
    let nozzle = |tool| Heater::Nozzle(tool);
    let heat = |line, heater, to, wait| Event::Heat {
        line,
        heater,
        to,
        wait,
    };
    let fan = |line, fan, speed| Event::Fan { line, fan, speed };
    let expected = [
        heat(1, Heater::Bed, 60.0, false),
        heat(2, nozzle(None), 210.0, true),
        heat(3, nozzle(Some(1)), 190.0, false),
        fan(4, 0, 50.0),
        fan(5, 2, 100.0),
        fan(6, 0, 0.0),
        Event::Tool { line: 7, tool: 1 },
        Event::Dwell { line: 8, time: 0.5 },
        Event::FirmwareRetract {
            line: 9,
            back: true,
        },
        Event::FirmwareRetract {
            line: 10,
            back: false,
        },
        heat(11, nozzle(Some(1)), 220.0, false),
        other(12, b'M', 2040),
        Event::Macro { line: 13 },
        other(14, b'M', 9000),
        Event::Home { line: 15 },
    ];
    assert_eq!(found, expected);
    let state = reader.state();
    assert_eq!((state.nozzle, state.bed), (Some(220.0), Some(60.0)));
    assert_eq!((state.fan, state.tool), (0.0, 1));
    assert_eq!(state.acceleration, Some(2000.0));
}

#[test]
fn what_makes_no_sense_is_counted_with_its_line() {
    let text = "G1 X Y5\nG1 XNaN\nG1 X1e300\nG1 X999999999999\nG1 X200000\n\
                G1 X1 %\nG1 X1\n";
    let expected = [
        (Problem::MissingNumber('X'), 1, 2),
        (Problem::OutOfReach, 4, 2),
        (Problem::Stray, 6, 1),
    ];
    assert_eq!(problems(text), expected);
    // X1e300 is X1 E300, as in firmware. A place out of reach is skipped.
    let found = moves(text);
    assert_eq!(found[2].filament, 300.0);
    assert!(found.iter().all(|m| m.to.abs().max_element() < 301.0));
    let warnings = {
        let mut reader = Reader::new(text.as_bytes());
        reader.by_ref().for_each(drop);
        reader.problems().warnings("a.gcode")
    };
    assert_eq!(
        warnings[0],
        "a.gcode:1: X without a number, the first of 2 such lines"
    );
}

/// Two blocks without compression or checksums: keys, and text.
fn binary(keys: &str, text: &str) -> Vec<u8> {
    let mut file = b"GCDE\x01\0\0\0\0\0".to_vec();
    for (kind, data) in [(3, keys), (1, text)] {
        file.extend([kind, 0, 0, 0]);
        file.extend((data.len() as u32).to_le_bytes());
        file.extend([0, 0]);
        file.extend(data.as_bytes());
    }
    file
}

#[test]
fn binary_files_are_read_and_their_lines_counted_from_the_text() {
    let keys = "Producer=Slicer 1.2\nfilament_diameter=2.85\n";
    let file = binary(keys, "G28\nG1 X5 E1 F600\n");
    let mut reader = Reader::new(&file[..]);
    let lines: Vec<u64> = reader
        .by_ref()
        .filter_map(|event| match event.unwrap() {
            Event::Move(step) => Some(step.line),
            _ => None,
        })
        .collect();
    assert_eq!(lines, [2]);
    assert_eq!(reader.lines(), 2);
    let info = reader.info();
    assert_eq!(info.generator.as_deref(), Some("Slicer 1.2"));
    assert_eq!(info.filament_diameter, Some(2.85));
}

#[test]
fn damaged_binary_files_say_what_to_do() {
    let file = binary("", "G28\n");
    let read: Result<Vec<_>, _> =
        Reader::new(&file[..file.len() - 1]).collect();
    let error = read.unwrap_err();
    assert!(matches!(error, ReadError::Binary(_)));
    assert_eq!(
        error.to_string(),
        "the binary G-code cannot be read: it is cut off in block 2; copy it \
         again, or slice again"
    );
}

#[test]
fn any_bytes_can_be_read() {
    // A fixed sequence (xorshift) of bytes, most of them such as G-code has.
    let mut x = 88_172_645_463_325_252_u64;
    let mut random = || {
        x ^= x << 13;
        x ^= x >> 7;
        x ^= x << 17;
        x
    };
    let signs = b"G01239 XYZEFIJRS.-+;:\n\nTMNLAYER_CHANGETYPE*(){}e\xff\x00\r";
    for _ in 0..200 {
        let text: Vec<u8> = (0..2000)
            .map(|_| match random() % 20 {
                0 => random() as u8,
                n => signs[(random() ^ n) as usize % signs.len()],
            })
            .collect();
        for event in Reader::new(&text[..]) {
            if let Event::Move(step) = event.unwrap() {
                assert!(step.to.is_finite() && step.from.is_finite());
                assert!(step.width.is_finite() && step.height.is_finite());
                assert!(step.filament.is_finite() && step.speed.is_finite());
                assert!(step.to.abs().max_element() < 3e5);
            }
        }
    }
}
