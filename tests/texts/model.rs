//! Models from text to placement, against shapes whose extent is known.

use fidget::context::Tree;
use glam::DVec3;
use isocontour::{BoundsError, Cancel, FoundBounds, SearchOptions};
use isoslice::model::{
    Bounds, BuildVolume, LoadError, Loaded, Model, PlaceError, Placement,
    Source, SourceKind, load, place,
};
use std::time::Instant;

const PRINTER: BuildVolume = BuildVolume {
    x: 220.0,
    y: 220.0,
    z: 250.0,
};

fn source(kind: SourceKind, text: &str) -> Source {
    Source::Text {
        name: "test".to_owned(),
        kind,
        text: text.to_owned(),
    }
}

fn formula(text: &str) -> Loaded {
    load(&source(SourceKind::Formula, text), &[]).unwrap()
}

fn script(text: &str) -> Loaded {
    load(&source(SourceKind::Script, text), &[]).unwrap()
}

fn find_bounds(
    tree: &Tree,
    options: &SearchOptions,
) -> Result<FoundBounds, BoundsError> {
    isocontour::find_bounds(tree, options, &Cancel::NEVER)
}

/// What a user is told.
fn advice(e: BoundsError) -> String {
    PlaceError::from(e).to_string()
}

fn bounds_of(tree: &Tree) -> Result<FoundBounds, BoundsError> {
    find_bounds(tree, &SearchOptions::default())
}

/// Checks the found box against the true one: never smaller (but for f32
/// constants), and larger by less than 2e-4 mm and 4e-6 of the size.
#[track_caller]
fn assert_bounds(tree: &Tree, min: [f64; 3], max: [f64; 3]) {
    let found = bounds_of(tree).unwrap();
    let (min, max) = (DVec3::from(min), DVec3::from(max));
    let size = (max - min).max_element();
    let tolerance = (4e-6 * size).min(2e-4);
    let rounding = 2e-7 * (min.abs().max(max.abs()).max_element());
    for i in 0..3 {
        let below = min[i] - found.bounds.min[i];
        let above = found.bounds.max[i] - max[i];
        for off in [below, above] {
            assert!(
                -rounding <= off && off <= tolerance + rounding,
                "axis {i} is off by {off}: {found:?}, not {min} to {max}"
            );
        }
    }
    assert!(found.slack_mm <= tolerance, "{found:?}");
}

#[track_caller]
fn assert_formula(text: &str, min: [f64; 3], max: [f64; 3]) {
    assert_bounds(&formula(text).tree, min, max);
}

fn exact_box(tree: &Tree) -> Bounds {
    bounds_of(tree).unwrap().bounds
}

fn turned(loaded: &Loaded, rotate: [f64; 3]) -> Tree {
    let placement = Placement {
        rotate,
        ..Placement::default()
    };
    place(loaded, &placement, PRINTER).unwrap().tree
}

/// The cut of atan2 lies across the part, and is no border of it.
#[test]
fn bounds_are_tight_where_the_field_jumps() {
    let (x, y, z) = Tree::axes();
    let radius = (x.square() + y.square()).sqrt();
    let lobes = (y.atan2(x.clone()) * 5.0).cos() * 4.0 + 20.0;
    let slab = (z.clone() - 5.0).abs() - 5.0;
    let found = bounds_of(&(radius - lobes).max(slab)).unwrap();
    let (mut low, mut high) = ([0.0_f64; 2], [0.0_f64; 2]);
    for i in 0..1_000_000 {
        let turn = std::f64::consts::TAU * f64::from(i) / 1e6;
        let r = 20.0 + 4.0 * (5.0 * turn).cos();
        for (k, v) in [r * turn.cos(), r * turn.sin()].iter().enumerate() {
            low[k] = low[k].min(*v);
            high[k] = high[k].max(*v);
        }
    }
    let (min, max) = (found.bounds.min, found.bounds.max);
    for (k, (lo, hi)) in low.into_iter().zip(high).enumerate() {
        assert!((min[k] - lo).abs() < 1e-3, "{found:?} for {lo}");
        assert!((max[k] - hi).abs() < 1e-3, "{found:?} for {hi}");
    }
    assert!(found.slack_mm <= 1e-4, "{found:?}");
}

#[test]
fn sphere() {
    assert_formula("sqrt(x^2+y^2+z^2) - 15", [-15.0; 3], [15.0; 3]);
    assert_formula("x^2+y^2+z^2 - 225", [-15.0; 3], [15.0; 3]);
}

#[test]
fn far_off_centre_sphere() {
    assert_formula(
        "sqrt((x-500)^2+(y+300)^2+(z-7)^2) - 3",
        [497.0, -303.0, 4.0],
        [503.0, -297.0, 10.0],
    );
}

#[test]
fn unit_scale_sphere() {
    assert_formula("sqrt(x^2+y^2+z^2) - 0.5", [-0.5; 3], [0.5; 3]);
    assert_formula("sqrt(x^2+y^2+z^2) - 0.001", [-0.001; 3], [0.001; 3]);
}

#[test]
fn a_cube_is_exact() {
    let cube = formula("max(abs(x), abs(y), abs(z)) - 10").tree;
    let found = exact_box(&cube);
    assert_eq!(found.min, DVec3::splat(-10.0));
    assert_eq!(found.max, DVec3::splat(10.0));
    let cube = script("box([0, 0, 0.25], [20, 30, 40.5])").tree;
    let found = exact_box(&cube);
    assert_eq!(found.min, DVec3::new(0.0, 0.0, 0.25));
    assert_eq!(found.max, DVec3::new(20.0, 30.0, 40.5));
}

#[test]
fn turned_cubes() {
    let r = 10.0 * 2f64.sqrt();
    let cube = formula("max(abs(x), abs(y), abs(z)) - 10");
    let tree = turned(&cube, [0.0, 0.0, 45.0]);
    assert_bounds(&tree, [-r, -r, -10.0], [r, r, 10.0]);
    // The cube stands on its corner, so its height is its diagonal.
    let tree = turned(&cube, [45.0, -(0.5f64.sqrt()).atan().to_degrees(), 0.0]);
    let h = 10.0 * 3f64.sqrt();
    let found = exact_box(&tree);
    let largest = found.max.max_element();
    assert!((largest - h).abs() < 1e-4, "{found:?}");
}

#[test]
fn torus_cone_and_ellipsoid() {
    assert_formula(
        "sqrt((sqrt(x^2+y^2) - 20)^2 + z^2) - 5",
        [-25.0, -25.0, -5.0],
        [25.0, 25.0, 5.0],
    );
    assert_formula(
        "max(sqrt(x^2+y^2) - (30 - z)/2, -z)",
        [-15.0, -15.0, 0.0],
        [15.0, 15.0, 30.0],
    );
    assert_formula(
        "x^2/400 + y^2/100 + z^2/25 - 1",
        [-20.0, -10.0, -5.0],
        [20.0, 10.0, 5.0],
    );
}

#[test]
fn a_turned_ellipsoid_has_its_analytic_box() {
    let loaded = formula("x^2/400 + y^2/100 + z^2/25 - 1");
    let angles = [20.0, 35.0, 50.0];
    let [x, y, z] = angles.map(f64::to_radians);
    let r = glam::DMat3::from_rotation_z(z)
        * glam::DMat3::from_rotation_y(y)
        * glam::DMat3::from_rotation_x(x);
    // Half extent along i: the length of (R_ij a_j) over j.
    let half: [f64; 3] = std::array::from_fn(|i| {
        (r.row(i) * DVec3::new(20.0, 10.0, 5.0)).length()
    });
    assert_bounds(&turned(&loaded, angles), half.map(|h| -h), half);
}

#[test]
fn gyroid_ball() {
    let text = "
        let k = TAU / 10.0;
        let g = sin(x*k)*cos(y*k) + sin(y*k)*cos(z*k) + sin(z*k)*cos(x*k);
        max(abs(g) - 0.55, sqrt(x*x + y*y + z*z) - 25)";
    let start = Instant::now();
    let found = bounds_of(&script(text).tree).unwrap();
    eprintln!("gyroid ball: {:?}, {found:?}", start.elapsed());
    assert!(found.slack_mm <= 1e-4, "{found:?}");
    for v in found.bounds.max.to_array() {
        assert!((24.5..=25.0001).contains(&v), "{found:?}");
    }
}

/// Balls of radius 2 in a heap, each blended with all before it. Those that
/// reach farthest up along each axis have no other one beside them.
#[test]
fn a_thousand_blends_have_the_box_of_what_they_blend() {
    let text = "
        let s = sphere([0, 0, 0], 2);
        for i in 0..1000 {
            let at = [i * 37 % 1000, i * 91 % 997, i * 53 % 499];
            s = blend(s, sphere([at[0] / 25.0, at[1] / 25.0, at[2] / 25.0], 2), 0.5);
        }
        s";
    let found = bounds_of(&script(text).tree).unwrap();
    assert!(found.slack_mm < 0.001, "{found:?}");
    let ends = [999.0, 996.0, 498.0].map(|end| end / 25.0 + 2.0);
    let max = found.bounds.max.to_array();
    for (max, end) in max.into_iter().zip(ends) {
        assert!((max - end).abs() < 0.001, "{found:?}");
    }
    // Where two are equally near they are a quarter of the radius nearer
    // together, and a third one adds less than that.
    for min in found.bounds.min.to_array() {
        assert!((-2.25..=-2.0).contains(&min), "{found:?}");
    }
}

#[test]
fn blends_and_twists() {
    // A polynomial smooth union of two balls.
    let text = "
        fn blend(a, b, k) {
            let h = max(k - abs(a - b), 0.0) / k;
            min(a, b) - h*h*k/4.0
        }
        let a = sqrt((x - 8)*(x - 8) + y*y + z*z) - 10;
        let b = sqrt((x + 8)*(x + 8) + y*y + z*z) - 10;
        blend(a, b, 4.0)";
    assert_bounds(
        &script(text).tree,
        [-18.0, -10.0, -10.0],
        [18.0, 10.0, 10.0],
    );
    // An exponential blend, whose parts overflow far away.
    let text = "-ln(exp(-4*(sqrt((x-8)^2+y^2+z^2)-10)) \
                + exp(-4*(sqrt((x+8)^2+y^2+z^2)-10)))/4";
    let found = bounds_of(&formula(text).tree).unwrap();
    assert!((found.bounds.max.x - 18.0).abs() < 1e-3, "{found:?}");
    // A twisted square prism: its sides are helical.
    let text = "
        let t = z * 0.05;
        let u = x*cos(t) + y*sin(t);
        let v = y*cos(t) - x*sin(t);
        max(max(abs(u), abs(v)) - 20, abs(z) - 30)";
    let start = Instant::now();
    let found = bounds_of(&script(text).tree).unwrap();
    eprintln!("twist: {:?}", start.elapsed());
    let r = 20.0 * 2f64.sqrt();
    assert!((found.bounds.max.x - r).abs() < 1e-3, "{found:?}");
    assert_eq!(found.bounds.max.z, 30.0);
}

/// A tube that winds around a circle has the box that its middle says: around
/// the z axis, where all angles meet, too.
#[test]
fn knots_that_wind_round_the_z_axis() {
    use std::f64::consts::PI;
    for winds in [0.5_f64, 1.5, 4.5] {
        let knot = format!(
            "sqrt((abs((sqrt(x*x + y*y) - 15)*cos({winds}*atan2(y, x)) \
             + z*sin({winds}*atan2(y, x))) - 4)^2 \
             + (z*cos({winds}*atan2(y, x)) \
             - (sqrt(x*x + y*y) - 15)*sin({winds}*atan2(y, x)))^2) - 2.6"
        );
        let (mut min, mut max) = ([f64::INFINITY; 2], [-f64::INFINITY; 2]);
        for k in 0..=400_000 {
            let angle = PI * (f64::from(k) / 200_000.0 - 1.0);
            // The two middles of a cross-section, and its outer end.
            let out = 15.0 + (4.0 * (winds * angle).cos()).abs() + 2.6;
            for (i, v) in [angle.cos(), angle.sin()].into_iter().enumerate() {
                min[i] = min[i].min(out * v);
                max[i] = max[i].max(out * v);
            }
        }
        assert_formula(&knot, [min[0], min[1], -6.6], [max[0], max[1], 6.6]);
    }
}

/// A ball with ripples around three axes has the box that it has with ripples
/// around one of them: poles beside each other cost no more than they tell.
#[test]
fn ripples_around_several_axes() {
    let ball = "sqrt(x*x + y*y + z*z) - 10";
    let ripple = |y: f64| format!("0.1*sin(9*atan2(y - {y}, x))");
    let three = format!(
        "{ball} + {} + {} + {}",
        ripple(0.0),
        ripple(1.0),
        ripple(-1.0)
    );
    let found = bounds_of(&formula(&three).tree).unwrap();
    assert!(found.slack_mm < 1e-3, "{found:?}");
    let size = found.bounds.size();
    assert!(size.cmpgt(DVec3::splat(19.4)).all(), "{size}");
    assert!(size.cmplt(DVec3::splat(20.6)).all(), "{size}");
}

#[test]
fn unions_of_many_and_of_far_apart_bodies() {
    let text = "
        for i in 0..10 { for j in 0..10 {
            draw(sphere([10*i, 10*j, i], 2 + i*0.1));
        } }";
    let start = Instant::now();
    assert_bounds(&script(text).tree, [-2.0, -2.9, -2.0], [92.9, 92.9, 11.9]);
    eprintln!("100 balls: {:?}", start.elapsed());
    assert_formula(
        "min(sqrt((x-900)^2+y^2+z^2) - 1, sqrt((x+900)^2+y^2+z^2) - 2)",
        [-902.0, -2.0, -2.0],
        [901.0, 2.0, 2.0],
    );
}

#[test]
fn shared_faces_of_differences_do_not_count() {
    // What is cut off shares the face x = 10 with what it is cut from: the
    // field is 0 on that face, and nowhere negative near it.
    let tree = script(
        "difference(box([0, 0, 0], [10, 10, 10]), \
         box([5, 0, 0], [10, 10, 10]))",
    )
    .tree;
    let max = exact_box(&tree).max;
    assert_eq!(max, DVec3::new(5.0, 10.0, 10.0));
}

#[test]
fn fields_that_are_nan_in_places() {
    // The field is NaN for x < 0, which counts as outside.
    assert_formula(
        "max(sqrt(x) - 2, abs(y) - 1, abs(z) - 1)",
        [0.0, -1.0, -1.0],
        [4.0, 1.0, 1.0],
    );
    assert_formula(
        "max(asin(x/10), sqrt(x^2+y^2+z^2) - 30)",
        [-10.0, -30.0, -30.0],
        [0.0, 30.0, 30.0],
    );
    // This field is infinite at the origin.
    assert_formula("1 - 1/(x^2+y^2+z^2)", [-1.0; 3], [1.0; 3]);
}

#[test]
fn unbounded_models() {
    let direction = |text: &str| match bounds_of(&formula(text).tree) {
        Err(BoundsError::Unbounded {
            direction, flipped, ..
        }) => (direction, flipped),
        other => panic!("{text}: {other:?}"),
    };
    assert_eq!(direction("z - 3"), ("-z", false));
    assert_eq!(direction("3 - z"), ("+z", false));
    assert_eq!(direction("sqrt(x^2 + z^2) - 3").0, "-y");
    let gyroid = "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)";
    assert!(!direction(gyroid).1);
    // A ball inside out.
    let e = bounds_of(&formula("15 - sqrt(x^2+y^2+z^2)").tree).unwrap_err();
    let e = advice(e);
    assert!(e.contains("is the sign flipped?"), "{e}");
    assert!(e.contains("--bounds x0,y0,z0:x1,y1,z1"), "{e}");
}

#[test]
fn empty_and_full_models() {
    for text in [
        "sqrt(x^2+y^2+z^2) + 1",
        "abs(x) + 0.1",
        "x^2",
        "max(x - 1, 2 - x)",
    ] {
        let e = bounds_of(&formula(text).tree).unwrap_err();
        assert!(matches!(e, BoundsError::Empty { .. }), "{text}: {e}");
    }
    let e = bounds_of(&formula("-1 - x^2").tree).unwrap_err();
    assert!(matches!(e, BoundsError::EverythingInside { .. }), "{e}");
}

#[test]
fn hopeless_fields_end_with_advice() {
    let (x, _, _) = Tree::axes();
    let tree = x.mix(Tree::y()).max(Tree::z() - 1.0);
    let options = SearchOptions {
        max_work: 100_000,
        ..SearchOptions::default()
    };
    let e = find_bounds(&tree, &options).unwrap_err();
    let e = advice(e);
    assert!(e.contains("--bounds"), "{e}");
}

#[test]
fn plateaus_beside_poles_are_found_at_once() {
    // Every box along a face of the given bounds reaches equally far, and
    // those along the pole of 1/z and the planes f = 0 are never decided.
    let bounds = Bounds {
        min: DVec3::splat(-10.0),
        max: DVec3::splat(10.0),
    };
    let options = SearchOptions {
        within: Some(bounds),
        max_work: 20_000,
        ..SearchOptions::default()
    };
    for text in ["-y*x - y/z", "1/x + 1/y + 1/z - 0.1", "ln(x*y*z)"] {
        let found = find_bounds(&formula(text).tree, &options).unwrap();
        assert_eq!(found.bounds, bounds, "{text}");
        assert!(found.slack_mm < 1e-4, "{text}: {}", found.slack_mm);
    }
}

#[test]
fn given_bounds_cut_the_model() {
    let gyroid = formula("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)");
    let bounds = Bounds {
        min: DVec3::ZERO,
        max: DVec3::new(40.0, 30.0, 20.0),
    };
    let placement = Placement {
        bounds: Some(bounds),
        ..Placement::default()
    };
    let model = place(&gyroid, &placement, PRINTER).unwrap();
    assert_eq!(model.bounds, bounds);
    // The cut is part of the field.
    assert_eq!(exact_box(&model.tree), bounds);
    // Turned, it is the model's own box that cuts.
    let quarter = Placement {
        rotate: [0.0, 0.0, 90.0],
        ..placement
    };
    let model = place(&gyroid, &quarter, PRINTER).unwrap();
    assert_eq!(model.bounds.min, DVec3::new(-30.0, 0.0, 0.0));
    assert_eq!(model.bounds.max, DVec3::new(0.0, 40.0, 20.0));
    let no_box = Placement {
        bounds: Some(Bounds {
            min: DVec3::ZERO,
            max: DVec3::new(1.0, f64::NAN, 1.0),
        }),
        ..Placement::default()
    };
    assert!(matches!(
        place(&gyroid, &no_box, PRINTER),
        Err(PlaceError::Bounds(BoundsError::NoBox { .. }))
    ));
}

#[test]
fn a_model_rests_on_the_middle_of_the_bed() {
    let ball = formula("sqrt((x-3)^2+(y+4)^2+(z-50)^2) - 15");
    let model = place(&ball, &Placement::default(), PRINTER).unwrap();
    // Without a scale or a rotation the expression is the user's own.
    assert!(model.tree.ptr_eq(&ball.tree));
    assert_eq!(model.offset.z, -35.0);
    assert_eq!(model.printed_bounds().centre().x, 110.0);
    assert_eq!(model.printed_bounds().centre().y, 110.0);
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    assert_eq!(model.expression_size, ball.expression_size);
    let placement = Placement {
        at: Some((30.0, 40.0)),
        ..Placement::default()
    };
    let model = place(&ball, &placement, PRINTER).unwrap();
    assert_eq!(model.printed_bounds().centre().x, 30.0);
    assert_eq!(model.printed_bounds().min.z, 0.0);
}

#[test]
fn scale_and_size_keep_millimetres() {
    let ball = formula("sqrt(x^2+y^2+z^2) - 0.5");
    let check = |model: &Model| {
        assert!((model.bounds.size() - 60.0).abs().max_element() < 1e-3);
        // The field of the scaled ball is its distance in millimetres.
        let mut context = fidget::context::Context::new();
        let node = context.import(&model.tree);
        let f = context.eval_xyz(node, 40.0, 0.0, 0.0).unwrap();
        assert!((f - 10.0).abs() < 1e-4, "{f}");
        assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    };
    let sized = Placement {
        size: Some(60.0),
        ..Placement::default()
    };
    check(&place(&ball, &sized, PRINTER).unwrap());
    let scaled = Placement {
        scale: Some(60.0),
        ..Placement::default()
    };
    check(&place(&ball, &scaled, PRINTER).unwrap());
    let model = place(&ball, &Placement::default(), PRINTER).unwrap();
    assert!(model.warnings[0].contains("--size"), "{:?}", model.warnings);
}

#[test]
fn quarter_turns_keep_faces_exact() {
    let slab = script("box([0, 0, 0], [10, 20, 30])");
    let quarter = Placement {
        rotate: [90.0, 0.0, 0.0],
        ..Placement::default()
    };
    let model = place(&slab, &quarter, PRINTER).unwrap();
    assert_eq!(model.bounds.min, DVec3::new(0.0, -30.0, 0.0));
    assert_eq!(model.bounds.max, DVec3::new(10.0, 0.0, 20.0));
    let full = Placement {
        rotate: [360.0, 0.0, -720.0],
        ..Placement::default()
    };
    let model = place(&slab, &full, PRINTER).unwrap();
    assert!(model.tree.ptr_eq(&slab.tree));
}

#[test]
fn kept_positions_are_cut_by_the_bed() {
    let ball = formula("sqrt((x-100)^2+(y-100)^2+(z-10)^2) - 15");
    let keep = Placement {
        keep_position: true,
        ..Placement::default()
    };
    let model = place(&ball, &keep, PRINTER).unwrap();
    assert_eq!(model.offset, DVec3::ZERO);
    assert!(model.warnings[0].contains("5.000 mm below"));
    let sunk = formula("sqrt((x-100)^2+(y-100)^2+(z+20)^2) - 15");
    assert!(matches!(
        place(&sunk, &keep, PRINTER),
        Err(PlaceError::BelowBed { .. })
    ));
    let centred = formula("sqrt(x^2+y^2+(z-15)^2) - 15");
    let e = place(&centred, &keep, PRINTER).err().unwrap();
    assert!(e.to_string().contains("15.00 mm at -x"), "{e}");
}

#[test]
fn models_larger_than_the_printer_say_by_how_much() {
    let ball = formula("sqrt(x^2+y^2+z^2) - 120");
    let e = place(&ball, &Placement::default(), PRINTER).err().unwrap();
    let e = e.to_string();
    assert!(e.contains("20.00 mm too wide (x)"), "{e}");
    assert!(e.contains("20.00 mm too deep (y)"), "{e}");
    assert!(!e.contains("too high"), "{e}");
    assert!(e.contains("--size"), "{e}");
    // A part as large as the printer fits.
    let full = script("box([0, 0, 0], [220, 220, 250])");
    place(&full, &Placement::default(), PRINTER).unwrap();
}

#[test]
fn senseless_placements_are_refused() {
    let ball = formula("sqrt(x^2+y^2+z^2) - 15");
    let refused = |change: fn(&mut Placement), words: &str| {
        let mut placement = Placement::default();
        change(&mut placement);
        let e = place(&ball, &placement, PRINTER).err().unwrap();
        assert!(e.to_string().contains(words), "{e}");
    };
    refused(|p| p.scale = Some(0.0), "--scale 0");
    refused(|p| p.size = Some(f64::NAN), "--size NaN");
    refused(|p| p.rotate[1] = f64::INFINITY, "--rotate-y");
    refused(|p| (p.scale, p.size) = (Some(2.0), Some(9.0)), "together");
    refused(
        |p| (p.at, p.keep_position) = (Some((1.0, 1.0)), true),
        "together",
    );
}

#[test]
fn files_are_loaded_by_their_extension() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        Source::File(path)
    };
    let loaded = load(&file("ball.rhai", b"sphere(7)"), &[]).unwrap();
    assert_eq!(loaded.name, "ball");
    assert_bounds(&loaded.tree, [-7.0; 3], [7.0; 3]);
    let vm = b"_0 var-x\n_1 abs _0\n_2 const 3\n_3 sub _1 _2\n";
    let loaded = load(&file("slab.VM", vm), &[]).unwrap();
    assert_eq!(loaded.name, "slab");
    let error = |s: &Source| load(s, &[]).err().unwrap().to_string();
    let e = error(&file("a.step", b""));
    assert!(e.contains(".rhai") && e.contains(".vm"), "{e}");
    let e = error(&file("a", b""));
    assert!(e.contains("no extension"), "{e}");
    let e = error(&file("b.vm", b"_0 var-x\n_1 add _0\n"));
    assert!(e.contains("b.vm: line 2: `add`"), "{e}");
    let e = error(&file("c.rhai", b"let a = 1;\n\xff"));
    assert!(e.contains("line 2: not valid UTF-8"), "{e}");
    let e = error(&file("d.rhai", b"x +"));
    assert!(e.contains("d.rhai: line 1"), "{e}");
    let missing = Source::File(folder.path().join("none.vm"));
    assert!(matches!(load(&missing, &[]), Err(LoadError::Read { .. })));
}

#[test]
fn only_scripts_have_parameters() {
    let defines = [("n".to_owned(), "1".to_owned())];
    for (kind, text) in
        [(SourceKind::Formula, "x"), (SourceKind::Vm, "_0 var-x")]
    {
        let e = load(&source(kind, text), &defines).err().unwrap();
        assert!(e.to_string().contains("no parameters"), "{e}");
    }
}

#[test]
fn remap_bombs_are_refused() {
    let bomb = "let t = sin(x) + y;
                for i in 0..40 { t = t.remap(t, y + 1, t * 2); }
                t";
    let start = Instant::now();
    let e = load(&source(SourceKind::Script, bomb), &[]).err().unwrap();
    assert!(e.to_string().contains("remap"), "{e}");
    assert!(start.elapsed().as_secs() < 10);
}

#[test]
fn deep_models_are_loaded_and_bounded() {
    let deep = "let t = x; for i in 0..100000 { t = t + sin(t*0.001); } t";
    let loaded = script(deep);
    assert!(loaded.expression_size > 200_000);
    drop(loaded);
    let chain = "let t = sphere(5);
                 for i in 0..1000 { t = min(t, z + 3 + i); }
                 max(t, sphere(5))";
    assert_bounds(&script(chain).tree, [-5.0; 3], [5.0; 3]);
}

#[test]
fn the_same_input_gives_the_same_model() {
    let text = "max(sin(x)*cos(y) + z/9, sqrt(x^2+y^2+z^2) - 8)";
    let once = bounds_of(&formula(text).tree).unwrap();
    for _ in 0..3 {
        assert_eq!(bounds_of(&formula(text).tree).unwrap(), once);
    }
}

/// A part within 2 µm of a box that is known.
#[track_caller]
fn assert_box(tree: &Tree, min: [f64; 3], max: [f64; 3]) {
    let found = bounds_of(tree).unwrap();
    let off = (found.bounds.min - DVec3::from(min))
        .abs()
        .max((found.bounds.max - DVec3::from(max)).abs());
    assert!(
        off.max_element() < 2e-3,
        "{found:?}, not {min:?} to {max:?}"
    );
    assert!(found.slack_mm < 2e-3, "{found:?}");
}

/// Box in the plane of the points that a function of a share of the way gives.
fn box_of(way: impl Fn(f64) -> (f64, f64)) -> ([f64; 2], [f64; 2]) {
    const STEPS: i32 = 1_000_000;
    let (mut lo, mut hi) = ([f64::MAX; 2], [f64::MIN; 2]);
    for i in 0..=STEPS {
        let (x, y) = way(f64::from(i) / f64::from(STEPS));
        for (k, v) in [x, y].into_iter().enumerate() {
            lo[k] = lo[k].min(v);
            hi[k] = hi[k].max(v);
        }
    }
    (lo, hi)
}

const TAU: f64 = std::f64::consts::TAU;

/// Sixteen teeth, folded into one by the remainder of the angle, and blended
/// with the body.
#[test]
fn a_filleted_gear_is_as_large_as_its_teeth() {
    let gear = script(
        "let n = 16.0; let p = 6.283185307 / n;
         let r = sqrt(x*x + y*y);
         let w = (atan2(y, x) + p / 2.0) % p - p / 2.0;
         let u = r * cos(w); let v = r * sin(w);
         let tooth = max(abs(v) - 1.8, u - 22.0);
         let d = r - 18.0; let k = 1.5;
         let h = (0.5 + 0.5 * (d - tooth) / k).max(0.0).min(1.0);
         let blend = d + (tooth - d) * h - k * h * (1.0 - h);
         blend.max(4.0 - r).max(abs(z - 4.0) - 4.0)",
    );
    assert_box(&gear.tree, [-22.0, -22.0, 0.0], [22.0, 22.0, 8.0]);
    let model = place(&gear, &Placement::default(), PRINTER).unwrap();
    assert_eq!(model.warnings, Vec::<String>::new());
    let centre = model.printed_bounds().centre();
    assert!((centre.x - 110.0).abs() < 1e-3, "{centre}");
    assert!((centre.y - 110.0).abs() < 1e-3, "{centre}");
}

/// The strip is wound from 0.7 to 4.3 turns; its outer edge reaches furthest.
#[test]
fn a_spiral_strip_is_as_large_as_its_last_turn() {
    let spiral = script(
        "let r = sqrt(x*x + y*y); let a = atan2(y, x) / 6.283185307;
         let n = floor(r / 4.0 - a + 0.5);
         let d = abs(r / 4.0 - a - n) * 4.0 - 0.8;
         d.max(n + a - 4.3).max(0.7 - n - a).max(abs(z - 5.0) - 5.0)",
    );
    let ([x0, y0], [x1, y1]) = box_of(|t| {
        let turns = 0.7 + t * 3.6;
        let r = 4.0 * turns + 0.8;
        (r * (TAU * turns).cos(), r * (TAU * turns).sin())
    });
    assert_box(&spiral.tree, [x0, y0, 0.0], [x1, y1, 10.0]);
    // This strip is made by a remainder, in a disc: what is cut off is round.
    let disc = script(
        "let r = sqrt(x*x + y*y);
         let u = r - 5.0 * atan2(y, x) / 6.283185307;
         max(abs(u % 5.0 - 2.5) - 0.6, r - 25.0).max(abs(z) - 3.0)",
    );
    let ([x0, y0], [x1, y1]) = box_of(|t| {
        let angle = TAU * (t - 0.5);
        let u = |r: f64| r - 5.0 * angle / TAU;
        let part = |r: f64| ((u(r).rem_euclid(5.0)) - 2.5).abs() < 0.6;
        // The furthest out of the outer edge and the rim.
        let edge = 5.0 * ((25.0 - 3.1 - 5.0 * angle / TAU) / 5.0).floor();
        let r = if part(25.0) {
            25.0
        } else {
            edge + 3.1 + 5.0 * angle / TAU
        };
        (r * angle.cos(), r * angle.sin())
    });
    assert_box(&disc.tree, [x0, y0, -3.0], [x1, y1, 3.0]);
}

#[test]
fn a_star_ends_at_its_tips() {
    let star = script(
        "let p = 6.283185307 / 5.0; let r = sqrt(x*x + y*y);
         let w = abs((atan2(y, x) + p/2.0) % p - p/2.0);
         let u = r * cos(w); let v = r * sin(w);
         let ex = 8.0 * cos(p/2.0) - 20.0; let ey = 8.0 * sin(p/2.0);
         let d = ((u - 20.0) * ey - v * ex) / sqrt(ex*ex + ey*ey);
         d.max(abs(z - 3.0) - 3.0)",
    );
    let (s, c) = (TAU / 5.0).sin_cos();
    let left = 20.0 * (TAU / 2.5).cos();
    assert!(c > 0.0);
    assert_box(&star.tree, [left, -20.0 * s, 0.0], [20.0, 20.0 * s, 6.0]);
}

/// Noise made of `floor`, `mix` and `rand` is smooth within its cells, and
/// continuous between them: the highest point is that of a fine grid.
#[test]
fn a_terrain_of_noise_is_as_high_as_its_summit() {
    let noise = "
        fn weight(ix, iy) {
            let fx = floor(x) + ix; let fy = floor(y) + iy;
            let angle = rand(hash(fx, fy)) * 2.0 * PI;
            (x - fx) * cos(angle) + (y - fy) * sin(angle)
        }
        fn smooth(v) { let t = v - floor(v); t * t * (3.0 - 2.0 * t) }
        let a = weight(0, 0); let b = weight(1, 0);
        let c = weight(0, 1); let d = weight(1, 1);
        let ab = a + smooth(x) * (b - a); let cd = c + smooth(x) * (d - c);
        let h = ab + smooth(y) * (cd - ab);";
    let text =
        format!("{noise} max(z - h, max(-2.0 - z, max(abs(x), abs(y)) - 2.0))");
    let (tree, height) =
        (script(&text).tree, script(&format!("{noise} h")).tree);
    let mut context = fidget::context::Context::new();
    let root = context.import(&height);
    let mut summit = f64::MIN;
    for i in 0..=400 {
        for j in 0..=400 {
            let at = |i: i32| -2.0 + f64::from(i) * 0.01;
            // Values are taken on the side on which the cell is, not on its
            // border.
            let (x, y) = (at(i) * (1.0 - 1e-6), at(j) * (1.0 - 1e-6));
            let h = context.eval_xyz(root, x as f32, y as f32, 0.0).unwrap();
            summit = summit.max(f64::from(h));
        }
    }
    let found = bounds_of(&tree).unwrap();
    assert!(found.slack_mm < 1e-4, "{found:?}");
    let top = found.bounds.max.z;
    assert!(
        top >= summit - 1e-6 && top < summit + 3e-4,
        "{top} {summit}"
    );
}

/// The bounds are found within the default budget, which bounds the time.
#[test]
fn twenty_thousand_balls_are_bounded() {
    let text = "
        for i in 0..20000 {
            let t = i.to_float();
            draw(sphere([t * 7.31 % 100.0, t * 3.77 % 90.0, t * 0.003], 1.0));
        }";
    assert_bounds(
        &script(text).tree,
        [-1.0, -1.0, -1.0],
        [100.99, 90.99, 60.997],
    );
}

/// Poles, towers and powers are answered without the whole budget.
#[test]
fn tiny_formulas_are_answered_at_once() {
    let start = Instant::now();
    for text in [
        "11/0*log(2%+y^2)",
        "max(1/x + 1/y + 1/z, sqrt(x^2+y^2+z^2) - 10)",
        "max(tan(x*y*z), sqrt(x^2+y^2+z^2) - 10)",
        "max((x%3)%(y%2+0.5) - 0.4, sqrt(x^2+y^2+z^2) - 10)",
        "exp(exp(x)) + y^2 + z^2 - 5",
        "log(log(log(x^2+y^2+z^2)))",
        "x^y - z^x",
        "tan(x*y)*z - 1",
        "sqrt(x)*sqrt(-x) + y^2 + z^2 - 1",
        "max(sin(atan2(y,x)*7 + sqrt(x^2+y^2)*3) - 0.3, \
         sqrt(x^2+y^2+z^2) - 20)",
    ] {
        let one = Instant::now();
        let found = bounds_of(&formula(text).tree);
        eprintln!("{text}: {:?}, {found:?}", one.elapsed());
    }
    // This is a hundred times what the search takes on an idle machine.
    assert!(start.elapsed().as_secs() < 40, "{:?}", start.elapsed());
}

#[test]
fn drawings_are_told_of_a_height_and_get_one() {
    let disc = formula("sqrt(x^2 + y^2) - 10");
    let e = bounds_of(&disc.tree).unwrap_err();
    assert_eq!(e, BoundsError::Flat { size: [20.0, 20.0] });
    let words = advice(e);
    for part in ["--height 3", "max(f, abs(z - 1.5) - 1.5)"] {
        assert!(words.contains(part), "{words}");
    }
    // To the micrometres that the bounds of a scaled part are known to.
    let size = |loaded: &Loaded, placement: Placement| {
        let model = place(loaded, &placement, PRINTER).unwrap();
        (model.bounds.size() * 1e3).round() / 1e3
    };
    let raised = Placement {
        height: Some(3.0),
        ..Placement::default()
    };
    assert_eq!(size(&disc, raised), DVec3::new(20.0, 20.0, 3.0));
    // The height is what is printed, whatever the drawing's units.
    let scaled = Placement {
        scale: Some(2.5),
        ..raised
    };
    assert_eq!(size(&disc, scaled), DVec3::new(50.0, 50.0, 3.0));
    let oval = formula("x^2/4 + y^2 - 1");
    let sized = Placement {
        size: Some(60.0),
        ..raised
    };
    assert_eq!(size(&oval, sized), DVec3::new(60.0, 30.0, 3.0));
    let turned = Placement {
        rotate: [90.0, 0.0, 0.0],
        ..raised
    };
    assert_eq!(size(&disc, turned), DVec3::new(20.0, 3.0, 20.0));
    // An endless drawing is cut in its plane.
    let stripes = formula("sin(x)");
    let cut = Placement {
        bounds: Some(Bounds {
            min: DVec3::new(-5.0, -5.0, 0.0),
            max: DVec3::new(5.0, 5.0, 100.0),
        }),
        ..raised
    };
    assert_eq!(size(&stripes, cut).z, 3.0);
    assert_eq!(
        place(&formula("sqrt(x^2+y^2+z^2) - 5"), &raised, PRINTER).err(),
        Some(PlaceError::HasHeight)
    );
    let negative = Placement {
        height: Some(-1.0),
        ..Placement::default()
    };
    assert!(matches!(
        place(&disc, &negative, PRINTER),
        Err(PlaceError::BadNumber {
            option: "--height",
            ..
        })
    ));
}

#[test]
fn what_is_no_number_anywhere_says_so_and_why() {
    let e = |text: &str| bounds_of(&formula(text).tree).unwrap_err();
    for (text, why) in [
        ("sqrt(-1 - x^2)", "the square root of -"),
        ("log(-1 - x^2 - z^2)", "the logarithm of -"),
        ("acos(2 + x^2) + z", "the arc cosine of "),
        ("(x - x)/(y - y) + z", "0 / 0"),
    ] {
        let error = e(text);
        assert!(matches!(error, BoundsError::NotANumber { .. }), "{text}");
        let words = advice(error);
        assert!(words.contains(why), "{text}: {words}");
        assert!(words.contains("NaN"), "{text}: {words}");
    }
    // The field is NaN in places only, which may be why there is nothing.
    let half = advice(e("sqrt(x) + y^2 + z^2 + 1"));
    assert!(half.contains("nowhere negative"), "{half}");
    assert!(half.contains("the square root of -"), "{half}");
    let none = advice(e("x^2 + y^2 + z^2 + 1"));
    assert!(!none.contains("NaN"), "{none}");
}

/// 30 m from the origin f32 counts in steps of 2 µm to 4 µm, and squares of
/// what is left of two large numbers in far worse ones.
#[test]
fn far_parts_are_moved_to_where_f32_has_digits() {
    let far = formula(
        "max(sqrt((x-30000)^2 + (y+20000.5)^2 + z^2) - 10, \
         sin(x + y) - 0.9, (x % 7) - 6)",
    );
    let model = place(&far, &Placement::default(), PRINTER).unwrap();
    assert_eq!(model.warnings, Vec::<String>::new());
    let off = model.origin - DVec3::new(30000.0, -20000.5, 0.0);
    assert!(off.abs().max_element() <= 1.0, "{}", model.origin);
    assert!(
        model.bounds.max.abs().max_element() < 11.0,
        "{:?}",
        model.bounds
    );
    let drawn = model.drawn_bounds().centre() - model.origin;
    assert!((drawn - model.bounds.centre()).length() < 1e-9);
    let printed = model.printed_bounds().centre();
    assert!((printed - DVec3::new(110.0, 110.0, 10.0)).length() < 1e-3);
    // The field is equal there and here, but for f32's steps.
    let value = |tree: &Tree, p: DVec3| {
        let mut context = fidget::context::Context::new();
        let root = context.import(tree);
        let [x, y, z] = p.as_vec3().to_array();
        f64::from(context.eval_xyz(root, x, y, z).unwrap())
    };
    for i in 0..100 {
        let turn = f64::from(i) * 0.37;
        let p = DVec3::new(turn.cos(), turn.sin(), 0.3) * (0.1 * turn);
        let (there, here) =
            (value(&far.tree, p + model.origin), value(&model.tree, p));
        assert!((there - here).abs() < 0.02, "{p}: {there} {here}");
    }
    // A part that is kept where it is stays as far out as it was drawn.
    let kept = Placement {
        keep_position: true,
        ..Placement::default()
    };
    let room = BuildVolume {
        x: 40_000.0,
        ..PRINTER
    };
    let ball = formula("sqrt((x-30000)^2 + (y-50)^2 + (z-10)^2) - 10");
    let model = place(&ball, &kept, room).unwrap();
    assert_eq!(model.offset, model.origin);
    assert!((model.printed_bounds().min.x - 29_990.0).abs() < 1e-3);
    // Nothing can be folded into a square that was multiplied out.
    let lost = formula("sqrt(x^2+y^2+z^2 - 60000*x + 900000000) - 10");
    let model = place(&lost, &Placement::default(), PRINTER).unwrap();
    let warned = model.warnings.concat();
    assert!(warned.contains("30 m from the origin"), "{warned}");
}

/// A million operations, of which a search can afford a few dozen looks.
#[test]
fn long_chains_are_called_unbounded_soon() {
    use std::fmt::Write;
    let mut text = String::from("a var-x\nb const 1\ny var-y\nc0 add a b\n");
    for i in 1..400_000 {
        let _ = writeln!(text, "d{i} add c{} b\nc{i} min d{i} y", i - 1);
    }
    let loaded = load(&source(SourceKind::Vm, &text), &[]).unwrap();
    let start = Instant::now();
    assert!(matches!(
        bounds_of(&loaded.tree),
        Err(BoundsError::Unbounded { .. })
    ));
    // It takes one second on an idle machine.
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}
