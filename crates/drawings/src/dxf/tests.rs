use crate::tests::bounds_hold;
use crate::{Anchor, Drawing, DxfOptions};
use glam::{DAffine3, DVec2, DVec3};
use isocontour::Data;
use isoslice_base::problem::NamedProblem;
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2, TAU};
use std::time::{Duration, Instant};

/// Records, each as its kind and `code=value`, with semicolons between.
fn records(text: &str) -> String {
    let record = |record: &str| {
        let mut words = record.split_whitespace();
        let kind = words.next().map(|kind| format!("0\n{kind}\n"));
        let pairs = words.map(|word| word.replacen('=', "\n", 1) + "\n");
        kind.into_iter().chain(pairs).collect::<String>()
    };
    text.split(';').map(record).collect()
}

/// A file in mm of blocks and entities.
fn file(blocks: &str, entities: &str) -> String {
    whole(4, "", blocks, entities)
}

fn whole(unit: i32, layers: &str, blocks: &str, entities: &str) -> String {
    let section = |name: &str, inner: &str| {
        format!("0\nSECTION\n2\n{name}\n{inner}0\nENDSEC\n")
    };
    let header = format!("9\n$ACADVER\n1\nAC1015\n9\n$INSUNITS\n70\n{unit}\n");
    section("HEADER", &header)
        + &section("TABLES", &records(layers))
        + &section("BLOCKS", &records(blocks))
        + &section("ENTITIES", &records(entities))
        + "0\nEOF\n"
}

fn read(text: &str, options: &DxfOptions) -> Result<Drawing, NamedProblem> {
    Drawing::from_dxf("part.dxf", text.as_bytes(), options)
}

fn drawn(text: &str) -> Drawing {
    read(text, &DxfOptions::default()).unwrap()
}

fn refused(text: &str) -> String {
    let error = read(text, &DxfOptions::default()).unwrap_err();
    error.to_string()
}

fn value(drawing: &Drawing, p: DVec2) -> f64 {
    drawing.value(p.extend(7.0))
}

/// Compares with what the distance is, at places in a square, to 0.1 µm.
fn is(drawing: &Drawing, half: f64, distance: impl Fn(DVec2) -> f64) {
    let mut rng = fastrand::Rng::with_seed(3);
    for _ in 0..2000 {
        let p = DVec2::new(rng.f64() - 0.5, rng.f64() - 0.5) * (2.0 * half);
        let (value, expected) = (value(drawing, p), distance(p));
        assert!((value - expected).abs() < 1e-4, "{p} {value} {expected}");
    }
    bounds_hold(drawing, 300);
}

fn segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let way = b - a;
    let t = ((p - a).dot(way) / way.length_squared()).clamp(0.0, 1.0);
    p.distance(a + way * t)
}

/// The distance of a polygon, by its sides and by how often it goes round.
fn polygon(p: DVec2, corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let sides = corners.iter().zip(next);
    let far = sides.clone().map(|(a, b)| segment(p, *a, *b));
    let far = far.fold(f64::INFINITY, f64::min);
    let turn = |(a, b): (&DVec2, &DVec2)| (*a - p).angle_to(*b - p);
    let turns: f64 = sides.map(turn).sum();
    if turns.abs() > PI { -far } else { far }
}

/// The area of the section, mm².
fn area(drawing: &Drawing) -> f64 {
    let rings = drawing.section(&DAffine3::IDENTITY, 0.0).unwrap();
    let of = |ring: &Vec<DVec2>| -> f64 {
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum()
    };
    0.5 * rings.iter().map(of).sum::<f64>()
}

/// A slot of two lines and two arcs, in no order and in any direction.
const SLOT: &str = "LINE 8=cut 10=-10 20=5 11=10 21=5;\
    ARC 8=cut 10=-10 20=0 40=5 50=90 51=270;\
    LINE 8=cut 10=-10 20=-5 11=10 21=-5;\
    ARC 8=cut 10=10 20=0 40=5 50=-90 51=90";

#[test]
fn a_slot_of_lines_and_arcs() {
    let slot = |p: DVec2| {
        segment(p, DVec2::new(-10.0, 0.0), DVec2::new(10.0, 0.0)) - 5.0
    };
    let drawing = drawn(&file("", SLOT));
    is(&drawing, 20.0, slot);
    assert!((area(&drawing) - (200.0 + 25.0 * PI)).abs() < 0.03);
    assert!(drawing.warnings().is_empty());
    // A hole is what goes round inside, whichever way.
    let holed = format!("{SLOT}; CIRCLE 10=10 20=0 40=2");
    is(&drawn(&file("", &holed)), 20.0, |p| {
        slot(p).max(2.0 - p.distance(DVec2::new(10.0, 0.0)))
    });
}

#[test]
fn polylines_with_bulges() {
    // A square of 20 mm with corners of 3 mm: the tangent of 22.5°.
    let bulge = SQRT_2 - 1.0;
    let corners = [
        (7.0, -10.0, bulge),
        (10.0, -7.0, 0.0),
        (10.0, 7.0, bulge),
        (7.0, 10.0, 0.0),
        (-7.0, 10.0, bulge),
        (-10.0, 7.0, 0.0),
        (-10.0, -7.0, bulge),
        (-7.0, -10.0, 0.0),
    ];
    let square = |p: DVec2| {
        let off = p.abs() - 7.0;
        off.max(DVec2::ZERO).length() + off.max_element().min(0.0) - 3.0
    };
    let points = corners.map(|(x, y, b)| format!(" 10={x} 20={y} 42={b}"));
    let light = format!("LWPOLYLINE 90=8 70=1{}", points.concat());
    is(&drawn(&file("", &light)), 15.0, square);
    let old = points.map(|point| format!("; VERTEX{point}"));
    let old = format!("POLYLINE 66=1 70=1{}; SEQEND", old.concat());
    is(&drawn(&file("", &old)), 15.0, square);
    // Two half circles, and a quarter and the rest.
    let rest = libm::tan(3.0 * PI / 8.0);
    for circle in [
        "10=-4 20=0 42=1 10=4 20=0 42=1".to_owned(),
        format!("10=4 20=0 42={bulge} 10=0 20=4 42={rest}"),
        format!("10=4 20=0 42={} 10=0 20=4 42={}", -rest, -bulge),
    ] {
        let text = file("", &format!("LWPOLYLINE 70=1 {circle}"));
        is(&drawn(&text), 10.0, |p| p.length() - 4.0);
    }
    // An arc of 100 mm with a rise of 0.1 µm has its centre 12 km away.
    let flat = "LWPOLYLINE 70=1 10=-50 20=0 42=-2e-6 10=50 20=0 10=0 20=-40";
    let flat = value(&drawn(&file("", flat)), DVec2::new(0.0, 1.0));
    assert!((flat - (1.0 - 1e-4)).abs() < 1e-9, "{flat}");
}

/// An L, which is no mirror image of itself.
const L: [[f64; 2]; 6] = [
    [0.0, 0.0],
    [3.0, 0.0],
    [3.0, 1.0],
    [1.0, 1.0],
    [1.0, 4.0],
    [0.0, 4.0],
];

#[test]
fn blocks_are_inserted_turned_and_mirrored() {
    let l = L.map(|[x, y]| format!(" 10={x} 20={y}")).concat();
    let block = format!(
        "BLOCK 2=el 10=1 20=1; LWPOLYLINE 8=0 70=1{l}; ENDBLK; \
         BLOCK 2=Two 10=0 20=0; INSERT 2=EL 8=0 10=2 20=-3 41=-2 42=2 50=30; \
         INSERT 2=EL 8=0 10=-9 20=5 230=-1; ENDBLK"
    );
    let insert =
        "INSERT 2=TWO 8=cut 10=1 20=2 50=90 70=2 71=2 44=30 45=40; ATTDEF";
    let turned =
        |p: DVec2, angle: f64| DVec2::from_angle(angle.to_radians()).rotate(p);
    let corners = L.map(DVec2::from_array).map(|p| p - DVec2::ONE);
    let first = |p: DVec2| {
        let p = DVec2::new(-2.0 * p.x, 2.0 * p.y);
        turned(p, 30.0) + DVec2::new(2.0, -3.0)
    };
    // Seen from below, x of its place is mirrored as well.
    let second = |p: DVec2| DVec2::new(9.0 - p.x, p.y + 5.0);
    let expected = |p: DVec2| {
        let mut least = f64::INFINITY;
        for by in [[0.0, 0.0], [30.0, 0.0], [0.0, 40.0], [30.0, 40.0]] {
            let out = |p: DVec2| {
                turned(p + DVec2::from_array(by), 90.0) + DVec2::new(1.0, 2.0)
            };
            for l in [corners.map(first), corners.map(second)] {
                least = least.min(polygon(p, &l.map(out)));
            }
        }
        least
    };
    is(&drawn(&file(&block, insert)), 50.0, expected);
    // In inches.
    let inches = drawn(&whole(1, "", &block, insert));
    let p = DVec2::new(3.0, 1.0);
    let far = 25.4 * expected(p);
    assert!((value(&inches, p * 25.4) - far).abs() < 1e-4);
}

#[test]
fn ellipses_and_what_is_seen_from_below() {
    // The upper half of an ellipse, turned by 90°, and its diameter.
    let half = "ELLIPSE 10=2 20=1 11=0 21=8 40=0.5 41=0 42=3.14159265358979; \
        LINE 10=2 20=9 11=2 21=-7";
    let drawing = drawn(&file("", half));
    for i in 1..50 {
        let angle = PI * f64::from(i) / 50.0;
        let on = DVec2::new(
            2.0 - 4.0 * libm::sin(angle),
            1.0 + 8.0 * libm::cos(angle),
        );
        assert!(value(&drawing, on).abs() < 1e-5, "{on}");
    }
    assert!((area(&drawing) - 16.0 * PI).abs() < 0.02);
    assert!(value(&drawing, DVec2::new(1.0, 1.0)) < 0.0);
    assert!(value(&drawing, DVec2::new(3.0, 1.0)) > 0.0);
    let disc = drawn(&file("", "ELLIPSE 10=1 20=2 11=3 21=4 40=1"));
    is(&disc, 10.0, |p| p.distance(DVec2::new(1.0, 2.0)) - 5.0);
    // An arc from below goes from 90° to 270° by way of 0°.
    let below = "ARC 10=-5 20=0 40=4 50=90 51=270 230=-1; \
        LINE 10=5 20=4 11=5 21=-4";
    let below = drawn(&file("", below));
    assert!(value(&below, DVec2::new(9.0, 0.0)).abs() < 1e-6);
    assert!((value(&below, DVec2::new(4.0, 0.0)) - 1.0).abs() < 1e-9);
}

/// The place of a spline by its definition (Cox and de Boor).
fn by_definition(
    degree: usize,
    knots: &[f64],
    points: &[[f64; 2]],
    u: f64,
) -> DVec2 {
    fn basis(i: usize, n: usize, knots: &[f64], u: f64) -> f64 {
        if n == 0 {
            return f64::from(knots[i] <= u && u < knots[i + 1]);
        }
        let share = |from: usize, to: usize, at: f64| {
            let length = knots[to] - knots[from];
            if length == 0.0 { 0.0 } else { at / length }
        };
        share(i, i + n, u - knots[i]) * basis(i, n - 1, knots, u)
            + share(i + 1, i + n + 1, knots[i + n + 1] - u)
                * basis(i + 1, n - 1, knots, u)
    }
    let of = |(i, p): (usize, &[f64; 2])| {
        DVec2::from_array(*p) * basis(i, degree, knots, u)
    };
    points.iter().enumerate().map(of).sum()
}

fn spline(degree: usize, knots: &[f64], points: &[[f64; 2]]) -> String {
    let knots: String = knots.iter().map(|k| format!(" 40={k}")).collect();
    let points: String = points
        .iter()
        .map(|[x, y]| format!(" 10={x} 20={y}"))
        .collect();
    format!("SPLINE 71={degree}{knots}{points}")
}

#[test]
fn splines_are_where_their_definition_says() {
    let points = [
        [0.0, 0.0],
        [3.0, 9.0],
        [8.0, -2.0],
        [12.0, 7.0],
        [15.0, 8.0],
    ];
    let points = [&points[..], &[[20.0, 0.0]]].concat();
    let knots: [&[f64]; 3] = [
        &[0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 5.0, 5.0, 5.0],
        &[0.0, 0.0, 0.0, 0.0, 1.0, 3.0, 4.0, 4.0, 4.0, 4.0],
        &[0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0],
    ];
    for (degree, knots) in (2..).zip(knots) {
        let line = "LINE 10=0 20=0 11=20 21=0";
        let line = format!("{line}; {}", spline(degree, knots, &points));
        let drawing = drawn(&file("", &line));
        let most = knots[knots.len() - 1];
        let mut worst: f64 = 0.0;
        for i in 0..500 {
            let u = most * f64::from(i) / 500.0;
            let on = by_definition(degree, knots, &points, u);
            worst = worst.max(value(&drawing, on).abs());
        }
        // 0.01 µm, and rounding where nothing is approximated.
        let most = if degree > 3 { 1e-5 } else { 1e-12 };
        assert!(worst < most, "{degree} {worst}");
    }
}

#[test]
fn splines_of_strange_knots() {
    let points = [[0.0, 0.0], [5.0, 9.0], [8.0, 3.0], [10.0, 0.0]];
    let base = "LINE 10=0 20=0 11=10 21=0";
    // The first span is empty, so that the first point does not count.
    let knots = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let from = "LINE 10=5 20=9 11=10 21=0";
    let text = format!("{}; {from}", spline(2, &knots, &points));
    let drawing = drawn(&file("", &text));
    // A quadratic curve cuts off two thirds of the triangle of its points.
    let triangle = 0.5 * (3.0 * -9.0 - -6.0 * 5.0_f64).abs();
    assert!((area(&drawing) - triangle * 2.0 / 3.0).abs() < 1e-3);
    // It jumps from one point to the next.
    let knots = [0.0, 0.0, 1.0, 1.0, 2.0, 2.0];
    let jump = format!("{base}; {}", spline(1, &knots, &points));
    let error = refused(&file("", &jump));
    assert!(error.contains("is broken at a knot"), "{error}");
    // It could, but does not.
    let still = [points[0], points[1], points[1], points[3]];
    let still = format!("{base}; {}", spline(1, &knots, &still));
    assert!((area(&drawn(&file("", &still))) - 45.0).abs() < 1e-9);
}

#[test]
fn a_polyline_of_a_width_is_its_middle_line() {
    // A donut, as programs write it, and two where only one point is wide.
    let donut = "10=-4 20=0 42=1 10=4 20=0 42=1";
    for wide in [
        format!("LWPOLYLINE 43=2 70=1 {donut}"),
        format!("LWPOLYLINE 43=0 70=1 {donut} 40=0 41=1"),
        "POLYLINE 70=1; VERTEX 10=-4 20=0 42=1; \
         VERTEX 10=4 20=0 40=3 42=1; SEQEND"
            .to_owned(),
    ] {
        let drawing = drawn(&file("", &wide));
        is(&drawing, 10.0, |p| p.length() - 4.0);
        let said = drawing.warnings().join("; ");
        assert!(said.contains("not drawn: the width of"), "{said}");
    }
    let none = format!("LWPOLYLINE 43=0 70=1 {donut} 40=0 41=0");
    assert!(drawn(&file("", &none)).warnings().is_empty());
}

#[test]
fn a_circle_as_a_spline() {
    // Nine points of a square, those of its corners with less weight.
    let points = (0..9).map(|i| {
        let corner = i % 2 == 1;
        let far = if corner { 10.0 * SQRT_2 } else { 10.0 };
        let p = DVec2::from_angle(FRAC_PI_2 * 0.5 * f64::from(i)) * far;
        let weight = if corner { 0.5 * SQRT_2 } else { 1.0 };
        format!(" 10={} 20={} 41={weight}", p.x, p.y)
    });
    let points: String = points.collect();
    let knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4];
    let knots: String = knots.map(|k| format!(" 40={k}")).concat();
    let circle = format!("SPLINE 70=5 71=2{knots}{points}");
    let drawing = drawn(&file("", &circle));
    let mut worst: f64 = 0.0;
    for i in 0..1000 {
        let p = DVec2::from_angle(TAU * f64::from(i) / 1000.0) * 10.0;
        worst = worst.max(value(&drawing, p).abs());
    }
    assert!(worst < 3e-6, "{worst}");
    is(&drawing, 15.0, |p| p.length() - 10.0);
}

/// A square of four lines, of which one ends `apart` from the corner.
fn square(apart: f64) -> String {
    format!(
        "LINE 8=a 10=0 20=0 11=10 21=0; LINE 8=a 10=10 20=10 11=10 21=0; \
         LINE 8=a 10=10 20=10 11=0 21=10; LINE 8=a 10=0 20={apart} 11=0 21=10"
    )
}

#[test]
fn lines_are_joined_where_their_ends_meet() {
    for apart in [0.0, 1e-9, 0.004] {
        let drawing = drawn(&file("", &square(apart)));
        assert!((area(&drawing) - 100.0).abs() < 1e-9, "{apart}");
    }
    let error = refused(&file("", &square(0.1)));
    for part in [
        "part.dxf: an outline ends at x = 0, y = 0 mm",
        "0.1 mm from",
    ] {
        assert!(error.contains(part), "{error}");
    }
    let narrow = DxfOptions {
        gap_mm: Some(1e-300),
        ..DxfOptions::default()
    };
    let began = Instant::now();
    for text in [square(0.1), cloud(100_000, 50.0)] {
        let error = read(&file("", &text), &narrow).unwrap_err().to_string();
        assert!(error.contains("an outline ends"), "{error}");
    }
    assert!(began.elapsed() < Duration::from_secs(10));
    let wide = DxfOptions {
        gap_mm: Some(0.2),
        ..DxfOptions::default()
    };
    let closed = read(&file("", &square(0.1)), &wide).unwrap();
    assert!((area(&closed) - 100.0).abs() < 1e-9);
    // Each of these ends nearer to another's than the gap.
    let fine: Vec<String> = (0..400)
        .map(|i| {
            let at = |i: i32| {
                let angle = TAU * f64::from(i % 400) / 400.0;
                DVec2::new(libm::cos(angle), libm::sin(angle)) * 0.1
            };
            let (a, b) = (at(i), at(i + 1));
            format!("LINE 10={} 20={} 11={} 21={}", a.x, a.y, b.x, b.y)
        })
        .collect();
    let fine = drawn(&file("", &fine.join(";")));
    assert!((area(&fine) - 0.01 * PI).abs() < 1e-5);
}

#[test]
fn places_where_more_than_two_lines_end() {
    // Two squares that touch at a corner.
    let both = square(0.0)
        + "; LINE 10=0 20=0 11=-5 21=0; LINE 10=-5 20=0 11=-5 21=-5; \
           LINE 10=-5 20=-5 11=0 21=-5; LINE 10=0 20=-5 11=0 21=0";
    let drawing = drawn(&file("", &both));
    assert!((area(&drawing) - 125.0).abs() < 1e-9);
    // A side that is drawn twice, once the other way.
    let twice = square(0.0) + "; LINE 10=10 20=0 11=0 21=0";
    let drawing = drawn(&file("", &twice));
    assert!((area(&drawing) - 100.0).abs() < 1e-9);
    assert_eq!(
        drawing.warnings(),
        ["1 line is drawn again where one is, and left out"]
    );
    let thrice = twice + "; LINE 10=10 20=0 11=0 21=0";
    assert_eq!(
        drawn(&file("", &thrice)).warnings(),
        ["2 lines are drawn again where one is, and left out"]
    );
    // A line from corner to corner.
    let error = refused(&file("", &(square(0.0) + "; LINE 11=10 21=10 10=0")));
    assert!(error.contains("3 lines meet at x = 0, y = 0"), "{error}");
}

#[test]
fn outlines_that_are_drawn_twice_count_once() {
    let plate = "LWPOLYLINE 70=1 10=0 20=0 10=40 20=0 10=40 20=30 10=0 20=30";
    let sides = "LINE 10=0 20=0 11=40; LINE 10=40 20=0 11=40 21=30; \
        LINE 10=40 20=30 11=0 21=30; LINE 10=0 20=30 11=0 21=0";
    let turned = "LWPOLYLINE 70=1 10=40 20=30 10=40 20=0 10=0 20=0 10=0 20=30";
    // Rounded otherwise, and with a point more.
    let rounded = "LWPOLYLINE 70=1 10=0 20=0.001 10=11 20=0 10=40 20=0 \
        10=40 20=30.001 10=0 20=30";
    let hole = "CIRCLE 10=20 20=15 40=5";
    let arcs = "ARC 10=20 20=15 40=5 50=10 51=200; \
        ARC 10=20 20=15 40=5 50=200 51=10";
    let once = 1200.0 - 25.0 * PI;
    for again in [sides, turned, rounded, arcs] {
        let text = file("", &format!("{plate}; {hole}; {again}"));
        let drawing = drawn(&text);
        assert!((area(&drawing) - once).abs() < 0.05, "{again}");
        assert_eq!(
            drawing.warnings(),
            ["1 outline is drawn again where one is, and left out"]
        );
    }
    // What is only near is another outline, and small ones may be nearer.
    for (radius, wall) in [(5.0, 0.01), (0.01, 0.001)] {
        let tube = format!(
            "CIRCLE 10=0 20=0 40={radius}; CIRCLE 10=0 20=0 40={}",
            radius - wall
        );
        let drawing = drawn(&file("", &tube));
        assert!(drawing.warnings().is_empty(), "{radius}");
        let middle = DVec2::new(radius - 0.5 * wall, 0.0);
        assert!((value(&drawing, middle) + 0.5 * wall).abs() < 1e-6);
    }
    // The same box, but another outline: two triangles of a square.
    let triangles = "LWPOLYLINE 70=1 10=0 20=0 10=9 20=0 10=9 20=9; \
        LWPOLYLINE 70=1 10=0 20=0 10=9 20=9 10=0 20=9";
    assert!((area(&drawn(&file("", triangles))) - 81.0).abs() < 1e-9);
    // Where nothing is left, what to do is said for a DXF.
    let flat = "LWPOLYLINE 70=1 10=0 20=0 10=9 20=9";
    let error = refused(&file("", flat));
    assert!(error.contains("an odd number of outlines"), "{error}");
    assert!(!error.contains("fill its shapes"), "{error}");
}

#[test]
fn layers_are_chosen_by_name() {
    let layers = "LAYER 2=a 70=0 62=7; LAYER 2=Off 70=0 62=-7; \
        LAYER 2=cold 70=1 62=7";
    let blocks = "BLOCK 2=b 10=0 20=0; CIRCLE 8=0 10=0 20=0 40=1; ENDBLK";
    let entities = square(0.0)
        + "; CIRCLE 8=OFF 10=5 20=5 40=1; CIRCLE 8=Cold 10=5 20=5 40=2; \
           INSERT 2=b 8=a 10=5 20=5; INSERT 2=b 8=off 10=5 20=5 41=3 42=3; \
           TEXT 8=a 1=Hello; CIRCLE 8=a 67=1 10=5 20=5 40=4";
    let text = whole(4, layers, blocks, &entities);
    let round = |options: &[&str]| {
        let all = options.iter().map(|name| (*name).to_owned()).collect();
        let layers = (!options.is_empty()).then_some(all);
        let options = DxfOptions {
            layers,
            ..DxfOptions::default()
        };
        read(&text, &options)
    };
    let all = round(&[]).unwrap();
    assert!((area(&all) - (100.0 - PI)).abs() < 0.01);
    let said = all.warnings().join("; ");
    assert_eq!(
        said,
        "not drawn: `TEXT`; not drawn: what is on layers that are off (3 \
         times); not drawn: what is on paper only"
    );
    let named = round(&["off", "COLD"]).unwrap();
    // Circles of 1, 2 and 3 mm, one in the other.
    assert!((area(&named) - (9.0 - 4.0 + 1.0) * PI).abs() < 0.02);
    let error = round(&["of"]).unwrap_err().to_string();
    assert!(error.contains("no layer `of`; it has `0`, `Cold`, `OFF`"));
}

#[test]
fn sizes_and_units() {
    let text = whole(0, "", "", SLOT);
    let told = drawn(&text).warnings().join("");
    assert!(told.contains("it names no unit"), "{told}");
    let sized = |options: DxfOptions| {
        let [min, max] = read(&text, &options).unwrap().bounds();
        [min.x, min.y, max.x, max.y]
    };
    let near = |a: [f64; 4], b: [f64; 4]| {
        let far = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        assert!(far.fold(0.0, f64::max) < 1e-5, "{a:?} {b:?}");
    };
    let usual = DxfOptions::default;
    near(sized(usual()), [-15.0, -5.0, 15.0, 5.0]);
    let inches = DxfOptions {
        unit_mm: Some(25.4),
        ..usual()
    };
    near(sized(inches), [-381.0, -127.0, 381.0, 127.0]);
    let corner = DxfOptions {
        width_mm: Some(60.0),
        anchor: Anchor::Corner,
        ..usual()
    };
    near(sized(corner), [0.0, 0.0, 60.0, 20.0]);
}

/// Lines that begin one above the other, and end so.
fn cloud(n: usize, size: f64) -> String {
    let line = |i: usize| {
        let y = size * (i as f64) / (n as f64);
        format!("LINE 10=0 20={y} 11=9 21={}", y + 100.0)
    };
    (0..n).map(line).collect::<Vec<String>>().join(";")
}

/// Files that a stranger may send, each with a part of what is said of it.
fn hostile() -> Vec<(String, &'static str)> {
    let entities = |text: &str| file("", text);
    let nested = |n: usize| {
        let block = |i: usize| {
            let inner = format!("INSERT 2=b{} 10=0 20=0", i + 1);
            format!("BLOCK 2=b{i} 10=0 20=0; {inner}; {inner}; ENDBLK; ")
        };
        let blocks: String = (0..n).map(block).collect();
        let last = format!("BLOCK 2=b{n}; CIRCLE 10=0 20=0 40=1; ENDBLK");
        file(&(blocks + &last), "INSERT 2=b0 10=0 20=0")
    };
    let empty = "BLOCK 2=b 10=0 20=0; ENDBLK";
    let slot = || entities(SLOT);
    let many = |text: &str, n: usize| vec![text; n].join(";");
    // What is too much is said before what lies too far away.
    let round = |n: usize| {
        let points: String = (0..n)
            .map(|i| format!(" 10={} 20=0 42=9", 10_000_000 + i))
            .collect();
        entities(&format!("LWPOLYLINE 70=1{points}"))
    };
    let vertices = |n: usize| {
        let all = many("VERTEX 10=0", n);
        entities(&format!("POLYLINE; {all}; VERTEX 10=x"))
    };
    let corners =
        |n: usize| entities(&format!("LWPOLYLINE{} 10=x", " 10=0".repeat(n)));
    let weighted = |n: usize| {
        let point = |i: usize| {
            let weight = if i.is_multiple_of(2) { 1e-3 } else { 1.0 };
            format!(" 40={i} 10={}e7 20={} 41={weight}", i % 5, i % 3)
        };
        let all: String = (0..n).map(point).collect();
        let last: String = (n..n + 4).map(|i| format!(" 40={i}")).collect();
        entities(&format!("SPLINE 71=3{all}{last}"))
    };
    // A block that is inserted 10,000 times, of one thing that draws nothing.
    let often = |text: &str| {
        let block = format!("BLOCK 2=b 10=0 20=0; {text}; ENDBLK");
        file(&block, "INSERT 2=b 10=0 20=0 70=100 71=100")
    };
    let long = |n: usize| "l".repeat(n);
    // Outlines that are the same but for one corner, which has to be found.
    let like = |n: i32| {
        let side = (1..200).map(|i| 0.04 * f64::from(i));
        let side: String = side.map(|x| format!(" 10={x} 20=0")).collect();
        let one = |i: i32| {
            let low = 0.1 + 0.001 * f64::from(i);
            format!("LWPOLYLINE 70=1 10=0 20=0{side} 10=9 20={low} 10=9 20=9")
        };
        (0..n).map(one).collect::<Vec<String>>().join(";")
    };
    let repeated =
        |n: &str| file(empty, &format!("INSERT 2=b 10=0 20=0 70={n} 71={n}"));
    vec![
        (String::new(), "no section ENTITIES"),
        ("\n\n\n".into(), "no section ENTITIES"),
        ("0\nEOF\n".into(), "no section ENTITIES"),
        ("<svg/>".into(), "line 1: `<svg/>` is no group code"),
        ("0".into(), "line 1: it is cut off"),
        ("AutoCAD Binary DXF\r\n\u{1a}\0".into(), "binary DXF"),
        ("AC1032\0\0".into(), "it is a DWG"),
        (
            slot().split("0\nLINE").take(1).collect(),
            "within a section",
        ),
        (slot().replace("ENTITIES", "ENTITES"), "no section"),
        (" ".repeat(1 << 22), "no section"),
        ("\n".repeat(1 << 22), "no section"),
        ("0\nX\n".repeat(1_000_001), "more than 1000000 records"),
        (" ".repeat((1 << 25) + 1), "larger than 32 MB"),
        (entities(""), "no line is drawn"),
        (
            entities("TEXT 1=a; HATCH; 3DFACE"),
            "`3DFACE`; not drawn: `HATCH`",
        ),
        (entities("CIRCLE 10=0 20=0"), "no value of group code 40"),
        (entities("CIRCLE 10=0 20=0 40=NaN"), "`NaN` is no number"),
        (entities("CIRCLE 10=inf 20=0 40=1"), "`inf` is no number"),
        (entities("CIRCLE 10=0 20=0 40=-1"), "has the radius -1"),
        (entities("CIRCLE 10=0 20=0 40=0"), "no line is drawn"),
        (entities("CIRCLE 10=0 20=0 40=1e300"), "beyond 1 km"),
        (entities("CIRCLE 10=1e308 20=0 40=1e308"), "beyond 1 km"),
        (entities("ARC 10=0 20=0 40=1 50=x 51=9"), "`x` is no number"),
        (
            entities("ARC 10=0 20=0 40=1 50=1e300 51=9"),
            "an outline ends",
        ),
        (
            entities("ELLIPSE 10=0 20=0 11=0 21=0 40=1"),
            "no line is drawn",
        ),
        (
            entities("ELLIPSE 10=0 20=0 11=1 21=0 40=1e9"),
            "beyond 1 km",
        ),
        (entities("LINE 10=0 20=0 11=1 21=1"), "an outline ends"),
        (entities("LWPOLYLINE 70=1"), "no line is drawn"),
        (
            entities("LWPOLYLINE 70=x 10=0 20=0"),
            "`x` is no whole number",
        ),
        (
            entities("LWPOLYLINE 70=1 10=0 20=0 42=1e300 10=9 20=0"),
            "beyond 1 km",
        ),
        (
            entities("LWPOLYLINE 70=1 10=0 20=0 10=9 20=0"),
            "is an area",
        ),
        (entities("CIRCLE 10=0 20=0 40=1 210=1 230=0"), "is tilted"),
        (entities("SPLINE 71=3 11=0 21=0"), "no control points"),
        (entities("SPLINE 71=99 10=0 20=0"), "of degree 99"),
        (
            entities("SPLINE 71=1 40=0 10=0 20=0 10=1 20=0"),
            "the knots",
        ),
        (
            entities(
                "SPLINE 71=1 40=0 40=0 40=1 40=1 10=0 20=0 10=1 20=0 41=0 \
                 41=1",
            ),
            "the weights",
        ),
        (
            entities(
                "SPLINE 71=1 40=3 40=0 40=1 40=1 10=0 20=0 10=1 20=0 41=1 \
                 41=1",
            ),
            "the knots",
        ),
        (
            file("BLOCK 2=b; INSERT 2=b 10=0 20=0; ENDBLK", "INSERT 2=b 10=0"),
            "does block `b` hold itself?",
        ),
        (nested(30), "more than 262144 lines"),
        (nested(33), "more than 32 deep"),
        (repeated("32767"), "more than 200000 entities"),
        (repeated("99999999"), "inserted 99999999 times"),
        (repeated("99999999999999999999"), "is no whole number"),
        (entities("INSERT 2=nobody 10=0 20=0"), "which there is not"),
        (
            entities(&many("POINT 10=0 20=0", 200_001)),
            "more than 200000",
        ),
        (entities(&cloud(20_000, 50.0)), "an outline ends"),
        (entities(&cloud(100_000, 1.0)), "too many lines end within"),
        (
            often(&format!("LWPOLYLINE{}", " 10=0".repeat(1000))),
            "more than 8388608 pairs",
        ),
        (
            often(&format!("POLYLINE; {}", many("VERTEX 10=0", 500))),
            "more than 8388608 pairs",
        ),
        (
            often(&format!("INSERT{} 2=c", " 1=0".repeat(1000))),
            "more than 8388608 pairs",
        ),
        (
            often(&format!("CIRCLE{} 10=0 40=0", " 1=0".repeat(1000))),
            "more than 8388608 pairs",
        ),
        (
            entities(&format!("CIRCLE 8={} 10=0 40=1", long(256))),
            "line 34: the name `lllll",
        ),
        (
            entities(&format!("INSERT 2={} 10=0", long(256))),
            "more than 255 characters",
        ),
        (
            file(&format!("BLOCK 2={}; ENDBLK", long(256)), SLOT),
            "more than 255 characters",
        ),
        (
            whole(4, &format!("LAYER 2={}", long(256)), "", SLOT),
            "more than 255 characters",
        ),
        (
            entities(&format!("INSERT 2={} 10=0", long(255))),
            "which there is not",
        ),
        (entities(&like(300)), "cross one another too often"),
        (round(30_000), "more than 262144 lines"),
        (corners(300_000), "more than 262144 lines"),
        (vertices(300_000), "more than 262144 lines"),
        (weighted(12_000), "more than 262144 lines"),
        (whole(99, "", "", SLOT), "has the number `99`"),
    ]
}

#[test]
fn what_cannot_be_read_is_refused_in_words_and_soon() {
    for (text, part) in hostile() {
        let began = Instant::now();
        let error = refused(&text);
        assert!(error.contains(part), "{part}: {error}");
        assert!(error.len() < 600, "{error}");
        let took = began.elapsed();
        assert!(took < Duration::from_secs(10), "{part}: {took:?}");
    }
    // Old files are in an encoding of one byte each.
    let text = file("", "CIRCLE 8=Rand 10=0 20=0 40=1; TEXT 8=Rand 1=@");
    let bytes: Vec<u8> = text
        .bytes()
        .map(|b| if b == b'@' { 0xe4 } else { b })
        .collect();
    assert!(Drawing::from_dxf("a", &bytes, &DxfOptions::default()).is_ok());
    // Line ends of Windows, remarks, and no end.
    let text = "999\r\nhello\r\n".to_owned()
        + &file("", SLOT)
            .replace('\n', "\r\n")
            .replace("0\r\nEOF\r\n", "");
    assert!((area(&drawn(&text)) - (200.0 + 25.0 * PI)).abs() < 0.03);
    let options = DxfOptions {
        gap_mm: Some(f64::NAN),
        ..DxfOptions::default()
    };
    assert!(read(&file("", SLOT), &options).is_err());
}

#[test]
fn the_middle_of_a_file_can_be_broken_anywhere() {
    // Any one character may be another: nothing panics, and it ends.
    let l = L.map(|[x, y]| format!(" 10={x} 20={y} 42=0.3")).concat();
    let blocks = format!("BLOCK 2=b 10=0 20=0; LWPOLYLINE 70=1{l}; ENDBLK");
    let all = format!(
        "{SLOT}; INSERT 2=b 10=1 20=1 70=2 44=9; {}",
        spline(
            2,
            &[0., 0., 0., 1., 1., 1.],
            &[[0., 0.], [1., 2.], [0., 0.]]
        )
    );
    let text = file(&blocks, &all);
    let mut rng = fastrand::Rng::with_seed(11);
    for _ in 0..3000 {
        let mut bytes = text.clone().into_bytes();
        for _ in 0..rng.usize(1..4) {
            let at = rng.usize(..bytes.len());
            bytes[at] = b"0123456789.-e\n XN"[rng.usize(..17)];
        }
        let made = Drawing::from_dxf("a", &bytes, &DxfOptions::default());
        if let Ok(drawing) = made {
            assert!(drawing.value(DVec3::new(1.0, 2.0, 3.0)).is_finite());
        }
    }
}
