use super::super::{ScriptLimits, run_script};
use super::convex::area;
use super::*;
use fidget::context::Context;

pub(super) fn tree(text: &str) -> Result<Tree, String> {
    let limits = ScriptLimits {
        memory_bytes: u64::MAX,
        ..ScriptLimits::default()
    };
    let script = run_script(text, &[], &limits, &Default::default());
    script.map(|s| s.tree).map_err(|e| e.to_string())
}

/// Places all over a cube of 60 mm, equal in every run.
fn places() -> impl Iterator<Item = DVec3> {
    let mut rng = fastrand::Rng::with_seed(7);
    let mut next = move || 60.0 * rng.f64() - 30.0;
    std::iter::repeat_with(move || DVec3::new(next(), next(), next()))
        .take(2000)
}

/// Distance from a polygon, worked out side by side; negative inside.
fn of_polygon(points: &[[f64; 2]], x: f64, y: f64) -> f64 {
    let mut least = f64::INFINITY;
    let mut inside = false;
    for (i, &[ax, ay]) in points.iter().enumerate() {
        let [bx, by] = points[(i + 1) % points.len()];
        let (dx, dy) = (bx - ax, by - ay);
        let t = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy);
        let t = t.clamp(0.0, 1.0);
        least = least.min((x - ax - t * dx).hypot(y - ay - t * dy));
        if (ay > y) != (by > y) && x < ax + (y - ay) / dy * dx {
            inside = !inside;
        }
    }
    if inside { -least } else { least }
}

/// Distance from an extrusion, by the distance in the plane.
fn extruded(plan: f64, z: f64) -> f64 {
    plan.max(z).min(0.0) + plan.max(0.0).hypot(z.max(0.0))
}

#[track_caller]
fn assert_distance(text: &str, distance: impl Fn(DVec3) -> f64) {
    let mut context = Context::new();
    let node = context.import(&tree(text).unwrap());
    for p in places() {
        let [x, y, z] = p.to_array().map(|v| v as f32);
        let value = context.eval_xyz(node, x, y, z).unwrap();
        let wanted = distance(DVec3::new(x.into(), y.into(), z.into()));
        assert!(
            (f64::from(value) - wanted).abs() < 2e-4,
            "{text} at {p}: {value}, not {wanted}"
        );
    }
}

/// Distance from a body of revolution, by the polygon of its section, mirrored.
fn revolved(points: &'static [[f64; 2]]) -> impl Fn(DVec3) -> f64 {
    let mirrored = points.iter().rev().map(|[r, z]| [-r, *z]);
    let mut all: Vec<_> = points.iter().copied().chain(mirrored).collect();
    all.dedup();
    move |p| of_polygon(&all, p.x.hypot(p.y), p.z)
}

#[test]
fn distances_are_exact() {
    let cylinder = revolved(&[[5.0, -10.0], [5.0, 10.0]]);
    assert_distance("cylinder(5, 20)", &cylinder);
    assert_distance("cylinder([1, 2, 3], 5, 20)", |p| {
        cylinder(p - DVec3::new(1.0, 2.0, 3.0))
    });
    assert_distance(
        "cone(#{radius: 10, top: 4, height: 20})",
        revolved(&[[10.0, -10.0], [4.0, 10.0]]),
    );
    assert_distance(
        "cone(#{radius: 3, top: 12, height: 8})",
        revolved(&[[3.0, -4.0], [12.0, 4.0]]),
    );
    assert_distance(
        "cone(#{radius: 10, height: 20})",
        revolved(&[[10.0, -10.0], [0.0, 10.0]]),
    );
    let inner = revolved(&[[4.0, -9.0], [4.0, 9.0]]);
    assert_distance(
        "rounded_cylinder(#{radius: 5, height: 20, edge: 1})",
        |p| inner(p) - 1.0,
    );
    let wall = [[6.0, -10.0], [8.0, -10.0], [8.0, 10.0], [6.0, 10.0]];
    assert_distance("tube(8, 6, 20)", |p| {
        of_polygon(&wall, p.x.hypot(p.y), p.z)
    });
    assert_distance("torus(15, 4)", |p| {
        (p.x.hypot(p.y) - 15.0).hypot(p.z) - 4.0
    });
    assert_distance("capsule([1, 0, 0], [1, 5, 20], 3)", |p| {
        let (a, d) = (DVec3::X, DVec3::new(0.0, 5.0, 20.0));
        let t = ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0);
        (p - a - t * d).length() - 3.0
    });
    assert_distance("capsule([1, 0, 0], [1, 0, 0], 3)", |p| {
        (p - DVec3::X).length() - 3.0
    });
    for edge in [0.0, 2.0, 5.0] {
        let text = format!("rounded_box([0, 0, 0], [30, 20, 10], {edge})");
        assert_distance(&text, |p| {
            let half = DVec3::new(15.0, 10.0, 5.0) - edge;
            let q = (p - DVec3::new(15.0, 10.0, 5.0)).abs() - half;
            q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - edge
        });
    }
    for sides in [3, 6, 17] {
        let corners: Vec<_> = (0..sides)
            .map(|i| {
                let angle =
                    std::f64::consts::TAU * f64::from(i) / f64::from(sides);
                [10.0 * angle.cos(), 10.0 * angle.sin()]
            })
            .collect();
        assert_distance(&format!("prism({sides}, 10, 5)"), |p| {
            extruded(of_polygon(&corners, p.x, p.y), p.z.abs() - 2.5)
        });
    }
    let side = [[0.0, 0.0], [30.0, 0.0], [0.0, 10.0]];
    assert_distance("wedge([0, -10, 0], [30, 10, 10])", |p| {
        extruded(of_polygon(&side, p.x, p.z), p.y.abs() - 10.0)
    });
    assert_distance("half_space([0, 3, 4], 2)", |p| {
        (3.0 * p.y + 4.0 * p.z) / 5.0 - 2.0
    });
    let plan = [[2.0, 2.0], [28.0, 2.0], [28.0, 18.0], [2.0, 18.0]];
    assert_distance("rounded_rectangle([0, 0], [30, 20], 2)", |p| {
        of_polygon(&plan, p.x, p.y) - 2.0
    });
    let five = [[-20.0, -8.0], [15.0, -20.0], [25.0, 4.0], [3.0, 22.0]];
    for order in ["", ".reverse()"] {
        let text = format!(
            "let p = [[-20, -8], [15, -20], [25, 4], [3, 22]]; p{order}; \
             polygon(p)"
        );
        assert_distance(&text, |p| of_polygon(&five, p.x, p.y));
    }
}

/// Outside of corners that turn inwards only the sign is right.
#[test]
fn any_simple_polygon_has_its_inside() {
    let star: Vec<[f64; 2]> = (0..14)
        .map(|i| {
            let r = if i % 2 == 0 { 25.0 } else { 9.0 };
            let angle = f64::from(i) * std::f64::consts::TAU / 14.0;
            [r * angle.cos(), r * angle.sin()]
        })
        .collect();
    let spiral = [
        [-25.0, -25.0],
        [25.0, -25.0],
        [25.0, 25.0],
        [-20.0, 25.0],
        [-20.0, -15.0],
        [15.0, -15.0],
        [15.0, 15.0],
        [-10.0, 15.0],
        [-10.0, 10.0],
        [10.0, 10.0],
        [10.0, -10.0],
        [-15.0, -10.0],
        [-15.0, 20.0],
        [20.0, 20.0],
        [20.0, -20.0],
        [-25.0, -20.0],
    ];
    for points in [&star[..], &spiral[..]] {
        assert!((0..points.len()).any(|i| {
            area(&[0, 1, 2].map(|k| points[(i + k) % points.len()])) < 0.0
        }));
        let mut context = Context::new();
        let node =
            context.import(&tree(&format!("polygon({points:?})")).unwrap());
        for p in places() {
            let value =
                context.eval_xyz(node, p.x as f32, p.y as f32, 0.0).unwrap();
            let wanted = of_polygon(points, p.x, p.y);
            let agree = (f64::from(value) < 0.0) == (wanted < 0.0);
            assert!(agree || wanted.abs() < 1e-4, "{p}: {value}, {wanted}");
            assert!(f64::from(value).abs() <= wanted.abs() + 1e-4, "{p}");
        }
    }
}

pub(super) fn value(text: &str, x: f32, y: f32, z: f32) -> f32 {
    let mut context = Context::new();
    let node = context.import(&tree(text).unwrap());
    context.eval_xyz(node, x, y, z).unwrap()
}

#[test]
fn operations_do_what_they_say() {
    assert_eq!(value("sphere(10).shell(2)", 9.0, 0.0, 0.0), -1.0);
    assert_eq!(value("sphere(10).grow(1)", 10.0, 0.0, 0.0), -1.0);
    let twisted = "x.twist(40)";
    assert!((value(twisted, 0.0, 3.0, 10.0) - 3.0).abs() < 1e-5);
    assert_eq!(value("x.mirror_x()", -3.0, 0.0, 0.0), 3.0);
    let ring = "circle([10, 0], 3).revolve_z()";
    assert_eq!(value(ring, 0.0, 14.0, 0.0), 1.0);
    let row = "sphere(2).linear_array([10, 0, 0], 4)";
    assert_eq!(value(row, 30.0, 0.0, 0.0), -2.0);
    assert_eq!(value(row, 40.0, 0.0, 0.0), 8.0);
    let around = "sphere([10, 0, 0], 2).polar_array(4)";
    assert!((value(around, 0.0, -10.0, 0.0) + 2.0).abs() < 1e-5);
    // Where both fields are near zero, the blend takes material away, or leaves
    // it, softly.
    let soft = value("blend_intersection(x, y, 3)", 0.0, 0.0, 0.0);
    assert_eq!(soft, 0.75);
    let soft = value("blend_difference(x, -y, 3)", 0.0, 0.0, 0.0);
    assert_eq!(soft, 0.75);
    assert!((value("gyroid(10, 1)", 0.0, 0.0, 0.0) + 0.5).abs() < 1e-6);
}

#[test]
fn every_example_works() {
    for row in rows() {
        let text = format!(
            "let f = sphere(3); let a = sphere(5); let b = sphere([4, 0, 0], \
             5); {}",
            row.example
        );
        assert!(tree(&text).is_ok(), "{text}: {:?}", tree(&text).err());
    }
}

#[test]
fn wrong_values_are_named() {
    for (text, words) in [
        (
            "cylinder(5)",
            "cylinder: height is missing; write for example",
        ),
        ("cylinder(#{radius: 5, hight: 3})", "there is no \"hight\""),
        ("cylinder(-5, 3)", "radius must be a number above 0"),
        ("cylinder(5, 3, 4)", "it does not take the number 4"),
        ("tube(6, 8, 20)", "inner must be less"),
        ("prism(2.5, 8, 20)", "sides must be a whole number"),
        ("rounded_box([0, 0, 0], [3, 3, 3], 2)", "1.5 at most"),
        ("polygon([[0, 0], [1, 1], [2, 2]])", "no area"),
        ("cylinder(\"5\", 3)", "it does not take a string"),
        ("sphere(3).polar_array(1e9)", "1 to 1000"),
        ("half_space([0, 0, 0])", "no direction"),
    ] {
        let e = tree(text).unwrap_err();
        assert!(e.contains(words), "{text}: {e}");
    }
}

/// Shapes that are fidget's have the same promise as the others: a name, a
/// value or a kind that is wrong has an error with a call that works.
#[test]
fn mistakes_in_fidgets_shapes_are_explained() {
    for (text, words) in [
        ("sphere(#{r: 10})", "no \"r\"; there are center, radius"),
        ("sphere(-5)", "radius must be a number above 0"),
        ("sphere(0)", "radius must be a number above 0"),
        ("sphere(1/0.0)", "radius must be"),
        ("circle(-5)", "radius must be a number above 0"),
        ("circle([0, 0, 5], 2)", "a place in the plane"),
        (
            "box(#{size: [10, 20, 30]})",
            "no \"size\"; there are lower, upper",
        ),
        ("box(#{lower: [0, 0, 0]})", "upper is missing"),
        ("box([0, 0, 0], [10, 0, 10])", "upper must be above lower"),
        ("rectangle([0, 0], [0, 5])", "upper must be above lower"),
        ("sphere(10).scale(2)", "f.scale_uniform(2)"),
        ("sphere(10).scale([1, 0, 1])", "none of them 0"),
        (
            "sphere(10).scale_uniform([1, 1, 2])",
            "does not take [1, 1, 2]",
        ),
        ("sphere(10).scale_uniform(0)", "above 0"),
        (
            "sphere(10).move(#{x: 5})",
            "no \"x\"; there are shape, offset",
        ),
        ("sphere(10).move(5)", "f.move([10, 0, 0])"),
        ("sphere(10).rotate_x(\"90\")", "does not take a string"),
        (
            "sphere(10).rotate(#{axis: [0, 0, 0], angle: 3})",
            "an axis such as",
        ),
        ("sphere(10).reflect(\"ab\")", "does not take a string"),
        ("sphere(10).repeat_x(0)", "above 0"),
        ("extrude_z(circle(5), 20, 0)", "upper must be above lower"),
        ("extrude_z(circle(5), 20)", "upper is missing"),
        (
            "loft_z(circle(5), circle(3), 9, 9)",
            "upper must be above lower",
        ),
        ("union(3, 4)", "does not take the number 3"),
        ("difference(sphere(3))", "cutout is missing"),
        ("blend(sphere(3), sphere(4), -1)", "a number of 0 or more"),
        ("blend(sphere(3), 4)", "b is missing"),
        ("inverse(3)", "does not take the number 3"),
        ("sphere()", "write for example sphere(#{center"),
        ("vec3(x, y, z)", "length(x, y, z)"),
        ("vec2(1, y)", "vec2(1, 2)"),
        (
            "sphere(3).remap(x, y, \"z\")",
            "remap does not take a string",
        ),
    ] {
        let told = tree(text).unwrap_err();
        assert!(told.starts_with("line 1"), "{text}: {told}");
        assert!(told.contains(words), "{text}: {told}");
    }
}

#[test]
fn fidgets_shapes_take_their_values_in_every_way() {
    let at = |text: &str, p: [f32; 3]| {
        let mut context = Context::new();
        let node = context.import(&tree(text).unwrap());
        context.eval_xyz(node, p[0], p[1], p[2]).unwrap()
    };
    for (text, p, wanted) in [
        ("sphere(3, [1, 2, 3])", [1.0, 2.0, 5.0], -1.0),
        (
            "sphere(#{radius: 3, center: [1, 2]})",
            [1.0, 2.0, 2.0],
            -1.0,
        ),
        ("circle([1, 2], 3)", [1.0, 2.0, 9.0], -3.0),
        ("union(sphere(3))", [0.0; 3], -3.0),
        ("union([sphere(3), sphere(4)], sphere(5))", [0.0; 3], -5.0),
        ("union(#{input: [sphere(3), x]})", [1.0, 0.0, 0.0], -2.0),
        ("intersection(sphere(3), x, y)", [1.0, 2.0, 0.0], 2.0),
        ("difference(z, x, [y])", [-1.0, -2.0, -9.0], 2.0),
        ("x.move([1, 2])", [3.0, 0.0, 0.0], 2.0),
        ("z.scale([1, 1])", [0.0, 0.0, 3.0], 3.0),
        ("x.rotate(90)", [1.0, 2.0, 3.0], 2.0),
        ("z.rotate(\"x\", 90)", [1.0, 2.0, 3.0], -2.0),
        ("z.rotate(#{axis: x, angle: 90})", [1.0, 2.0, 3.0], -2.0),
        ("x.reflect(\"yz\")", [1.0, 2.0, 3.0], -1.0),
        ("x.reflect_x()", [1.0, 2.0, 3.0], -1.0),
        ("extrude_z(x, 0, 5)", [-9.0, 0.0, 6.0], 1.0),
        ("blend(x, y, 0)", [1.0, 1.0, 0.0], 1.0),
        ("blend(#{a: x, b: y, radius: 4})", [1.0, 1.0, 0.0], 0.0),
        ("sphere([0, 2, 0], 1).repeat_y(5)", [0.0, -8.0, 0.0], -1.0),
        (
            "sphere([0, 0, 1], 1).repeat_z(5, 1)",
            [0.0, 0.0, 21.0],
            -1.0,
        ),
    ] {
        let found = at(text, p);
        assert!((found - wanted).abs() < 1e-4, "{text}: {found}");
    }
}

/// A blend keeps the faces that both bodies have in common, and fills corners
/// as much as it ever did.
#[test]
fn blends_keep_flush_faces() {
    let plates = "let a = box([0, 0, 0], [40, 20, 4]); \
                  let b = box([0, 0, 0], [4, 20, 30]); ";
    let rounded = "let a = rounded_box([0, 0, 0], [40, 20, 4], 0); \
                   let b = extrude_z(polygon([[0, 0], [4, 0], [4, 20], \
                   [0, 20]]), 0, 30); ";
    let formulas = "let a = max(max(abs(x - 20) - 20, abs(y - 10) - 10), \
                    abs(z - 2) - 2); \
                    let b = max(max(-x, x - 4), max(max(-y, y - 20), \
                    max(-z, z - 30))); ";
    for bodies in [plates, rounded, formulas] {
        let field = |text: &str| {
            let mut context = Context::new();
            let node = context.import(&tree(text).unwrap());
            move |x: f32, y: f32, z: f32| {
                context.eval_xyz(node, x, y, z).unwrap()
            }
        };
        let soft = field(&format!("{bodies} blend(a, b, 8)"));
        // Near the bed, the back, and the sides, the faces are where they were.
        for (x, y, z, wanted) in [
            (2.0, 10.0, -0.5, 0.5),
            (2.0, 10.0, 0.1, -0.1),
            (-0.5, 10.0, 2.0, 0.5),
            (0.1, 10.0, 2.0, -0.1),
            (2.0, -0.5, 2.0, 0.5),
            (5.0, 20.5, 5.0, 0.5),
        ] {
            let found = soft(x, y, z);
            assert!((found - wanted).abs() < 1e-3, "{bodies}: {found}");
        }
        // The corner is filled: min + (8 - 0)² / 32 is 0 at 2 mm from both.
        assert!(soft(5.9, 10.0, 5.9) < 0.0, "{bodies}");
        assert!(soft(6.1, 10.0, 6.1) > 0.0, "{bodies}");
        let turn = ".rotate(#{axis: [1, 2, 3], angle: 33}).move([5, 6, 7])";
        let turned = field(&format!("{bodies} blend(a{turn}, b{turn}, 8)"));
        let after = field(&format!("{bodies} blend(a, b, 8){turn}"));
        for p in places() {
            let [x, y, z] = p.to_array().map(|v| v as f32);
            let (turned, after) = (turned(x, y, z), after(x, y, z));
            assert!((turned - after).abs() < 1e-3, "{turned} {after} at {p}");
        }
    }
}

#[test]
fn polygons_that_cross_themselves_are_refused() {
    for (corners, sides) in [
        // A star in one stroke.
        (
            "[0, 9], [5, -7], [-8, 3], [8, 3], [-5, -7]",
            "from [0.0, 9.0] and from [-8.0, 3.0]",
        ),
        (
            "[0, 0], [9, 0], [3, 5], [6, -4], [0, 8]",
            "from [0.0, 0.0] and from [3.0, 5.0]",
        ),
    ] {
        let error = tree(&format!("polygon([{corners}])")).unwrap_err();
        assert!(error.contains("crosses itself"), "{error}");
        assert!(error.contains(sides), "{error}");
    }
    // Many corners on one straight side, turned.
    let (sin, cos) = 0.37_f64.sin_cos();
    let side = (0..=30).map(|i| [f64::from(i), 0.0]);
    let all = side.chain([[30.0, 10.0], [0.0, 10.0]]);
    let turned = all.map(|[x, y]| {
        format!("[{}, {}]", x * cos - y * sin - 27.3, x * sin + y * cos)
    });
    let turned: Vec<String> = turned.collect();
    assert!(tree(&format!("polygon([{}])", turned.join(", "))).is_ok());
    // What only touches itself does not cross.
    assert!(tree("polygon([[0, 0], [9, 0], [9, 9], [5, 0], [0, 9]])").is_ok());
}

/// Bodies without common faces blend as fidget has it.
#[test]
fn blends_of_other_bodies_are_as_they_were() {
    for (a, b) in [
        ("sphere(10)", "sphere([8, 0, 0], 10)"),
        ("z - 5", "x - 5"),
        ("box([0, 0, 0], [20, 20, 4])", "sphere([10, 10, 4], 6)"),
        ("box([0, 0, 0], [20, 20, 4])", "box([5, 5, -1], [9, 9, 9])"),
        ("union(sphere(3), box([0, 0, 0], [9, 9, 4]))", "-z"),
        ("abs(z) - 2", "3 - z"),
    ] {
        let blend = fidget::shapes::Blend {
            a: tree(a).unwrap(),
            b: tree(b).unwrap(),
            radius: 5.0,
        };
        let blended = tree(&format!("blend({a}, {b}, 5)")).unwrap();
        assert!(blended == Tree::from(blend), "{a}, {b}");
    }
}
