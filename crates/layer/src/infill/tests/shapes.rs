//! Infill that is an expression or a script.

use super::*;
use isoslice_settings::testing::usual_plan;

#[test]
fn an_expression_is_a_surface_or_a_solid() {
    let area = square(20.0);
    let surface = shape("sqrt(x*x + y*y) - 0.1*z - 9", false);
    let at = layer(24);
    let radius = 9.0 + 0.1 * at.sample_z();
    let beads = lay(&surface, HERE, &area, [at]).remove(0);
    assert_eq!(beads.len(), 1);
    assert!(beads[0].stroke.closed);
    for p in &beads[0].stroke.points {
        assert!((p.length() - radius).abs() < 0.05, "{p}");
    }
    // Printed as a solid, it has the volume of the disc.
    for walls in [0, 1, 3] {
        let solid = InfillPlan {
            solid: true,
            walls,
            ..surface.clone()
        };
        let beads = lay(&solid, HERE, &area, [at]).remove(0);
        let volume: f64 =
            beads.iter().map(|b| b.area() * b.stroke.length()).sum();
        let disc = std::f64::consts::PI * radius * radius * 0.2;
        // Without walls the lines' ends are round, and not counted.
        let slack = if walls == 0 { 0.05 } else { 0.03 };
        let off = volume / disc - 1.0;
        assert!(off.abs() < slack, "{walls}: {volume} {disc}");
        let rings = beads.iter().filter(|b| b.stroke.closed).count();
        assert_eq!(rings, walls as usize);
        let outermost = beads
            .iter()
            .flat_map(|b| &b.stroke.points)
            .fold(0.0, |far: f64, p| far.max(p.length()));
        assert!(outermost < radius - 0.05, "{outermost}");
        // Where a wall cuts the disc, the disc ends.
        let beads = lay(&solid, HERE, &square(6.0), [at]).remove(0);
        let volume: f64 =
            beads.iter().map(|b| b.area() * b.stroke.length()).sum();
        let square = 144.0 * 0.2;
        assert!((volume / square - 1.0).abs() < slack, "{walls}: {volume}");
    }
}

#[test]
fn expressions_have_both_sides_of_a_sheet() {
    // The example of the documentation: |f| = 0.2 on both sides of f = 0.
    let text = "abs(sin(x/2)*cos(y/2) + sin(y/2)*cos(z/2) \
                + sin(z/2)*cos(x/2)) - 0.2";
    let area = square(20.0);
    let at = layer(30);
    let beads = lay(&shape(text, false), HERE, &area, [at]).remove(0);
    let border = Border::new(&area);
    assert!(beads.len() > 1 && beads.iter().all(|b| b.stroke.points.len() > 1));
    let f = |p: &DVec2| {
        let (x, y, z) = (0.5 * p.x, 0.5 * p.y, 0.5 * at.sample_z());
        x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos()
    };
    for p in beads.iter().flat_map(|b| &b.stroke.points) {
        let inner = p.abs().max_element() < 19.5;
        assert!(border.contains(*p));
        assert!(!inner || (f(p).abs() - 0.2).abs() < 0.04, "{p}: {}", f(p));
    }
}

#[test]
fn an_expression_may_ask_for_the_distance_from_the_surface() {
    // 20 mm below the surface of a block of 100 mm: a square of 60 mm.
    let area = square(49.0);
    let at = layer(250);
    let lay = |solid| lay(&shape("20 - d", solid), HERE, &area, [at]).remove(0);
    let beads = lay(false);
    assert_eq!(beads.len(), 1);
    assert!(beads[0].stroke.closed);
    for p in &beads[0].stroke.points {
        let off = p.abs().max_element() - 30.0;
        // Corners are rounded by as much as the distances' lattice is wide.
        assert!(off.abs() < 0.4, "{p}");
    }
    let length = beads[0].stroke.length();
    assert!((length - 240.0).abs() < 2.0, "{length}");
    let solid = lay(true);
    let volume: f64 = solid.iter().map(|b| b.area() * b.stroke.length()).sum();
    assert!((volume / (3600.0 * 0.2) - 1.0).abs() < 0.02, "{volume}");
}

fn script(path: String) -> InfillPlan {
    InfillPlan {
        pattern: isoslice_settings::Infill::Script(path),
        ..usual_plan(InfillPlan::of)
    }
}

#[test]
fn a_script_is_a_shape() {
    let path = std::env::temp_dir()
        .join(format!("isoslice-infill-{}.rhai", std::process::id()));
    std::fs::write(&path, "sqrt(x*x + y*y) - 12").unwrap();
    let plan = script(path.display().to_string());
    let beads = lay(&plan, HERE, &square(20.0), [layer(3)]).remove(0);
    std::fs::remove_file(&path).unwrap();
    assert!(beads.len() == 1 && beads[0].stroke.closed);
    let length = beads[0].stroke.length();
    assert!(
        (length - 24.0 * std::f64::consts::PI).abs() < 0.3,
        "{length}"
    );
}

#[test]
fn mistakes_are_told() {
    let block = block();
    let around = Surroundings::new(&block);
    let error = |plan: InfillPlan| {
        let made = Infill::new(plan, &around, HERE);
        made.map(|_| ()).unwrap_err().to_string()
    };
    let e = error(shape("sin(x", false));
    assert!(e.starts_with("infill = \"expr: sin(x\""), "{e}");
    let e = error(script("nowhere.rhai".into()));
    assert!(e.contains("nowhere.rhai"), "{e}");
    let e = error(graded(InfillPattern::Hexagons, "x"));
    assert!(e.contains("hexagons") && e.contains("gyroid"), "{e}");
    let e = error(graded(InfillPattern::Gyroid, "10 +"));
    assert!(e.starts_with("infill_density"), "{e}");
}
