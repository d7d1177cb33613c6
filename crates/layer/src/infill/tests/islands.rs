//! Islands: apart, and inside one another.

use super::*;
use isoslice_planar::shapes::{moved, square_ring};

/// Squares inside one another, each a frame 3 mm thick and 3 mm from the next.
fn nested() -> Area {
    let rings = (0..6).map(|i| {
        let mut ring = square(40.0 - 3.0 * f64::from(i)).rings.remove(0);
        if i % 2 == 1 {
            ring.reverse();
        }
        ring
    });
    rings.collect()
}

#[test]
fn islands_in_each_other_s_boxes_are_filled_once() {
    let area = nested();
    // There are also islands that are apart.
    let aside = |x: f64, y: f64, half: f64| -> Vec<DVec2> {
        let ring = square(half).rings.remove(0);
        ring.into_iter().map(|p| p + DVec2::new(x, y)).collect()
    };
    let mut apart = Area::EMPTY;
    apart.rings.push(aside(-30.0, -30.0, 8.0));
    apart.rings.push(aside(-21.5, -10.0, 0.4));
    apart.rings.push(aside(30.0, 30.0, 8.0));
    let shape = |text: &str, solid| InfillPlan {
        walls: 0,
        ..shape(text, solid)
    };
    // Lines 2 mm apart, whatever the depth.
    let text = "sin(1.5707963*x) + 1e-9*d";
    let surface = shape(text, false);
    let solid = shape(text, true);
    // An expression that names d without depending on it is sampled in the same
    // way.
    let vain = shape("sin(1.5707963*x) + 0*d", false);
    let beads =
        |plan: &InfillPlan| lay(plan, HERE, &area, [layer(7)]).remove(0);
    assert_eq!(beads(&vain).len(), beads(&surface).len());
    for area in [&area, &apart] {
        let content = area.content();
        let volume = |plan: &InfillPlan| {
            let beads = lay(plan, HERE, area, [layer(7)]).remove(0);
            beads
                .iter()
                .map(|b| b.area() * b.stroke.length())
                .sum::<f64>()
        };
        // The joins and the margin along the border are not part of the
        // pattern.
        let border =
            area.perimeter() * isoslice_planar::bead::cross_section(0.45, 0.2);
        let lines =
            0.5 * content * isoslice_planar::bead::cross_section(0.45, 0.2);
        let found = volume(&surface);
        assert!((found - lines).abs() < 0.6 * border, "{found} {lines}");
        let found = volume(&solid) / 0.2;
        let wanted = 0.5 * content;
        // The solid's bands of 2 mm lose a quarter of a line's width on both
        // sides.
        assert!((found / wanted - 0.85).abs() < 0.1, "{found} {wanted}");
    }
    // A surface whose cells vary is filled once, too.
    let plan = graded(InfillPattern::Gyroid, "20 + 0*x");
    let places = || (0..24).map(spread);
    let length = |area: &Area| -> f64 {
        let layers = lay(&plan, HERE, area, places());
        layers.iter().flatten().map(|b| b.stroke.length()).sum()
    };
    let single: f64 = area.islands().iter().map(length).sum();
    let together = length(&area);
    assert!(
        (together / single - 1.0).abs() < 0.01,
        "{together} {single}"
    );
}

#[test]
fn islands_continue_each_other() {
    // Two squares beside each other get the lines that one square around both
    // gets.
    let shifted = |x: f64| moved(square_ring(12.0), x, 0.0);
    let both = Area::from_iter([shifted(-20.0), shifted(20.0)]);
    for kind in InfillPattern::ALL {
        if kind == InfillPattern::Concentric {
            continue;
        }
        let plan = even(kind, 25.0);
        let beads = |area| lay(&plan, HERE, area, [layer(4)]).remove(0);
        let (whole, parts) = (beads(&square(40.0)), beads(&both));
        let all: Vec<(DVec2, DVec2)> = whole
            .iter()
            .flat_map(|b| b.stroke.segments().collect::<Vec<_>>())
            .collect();
        let grid = isoslice_planar::grid::EdgeGrid::of(
            all.into_iter().map(|s| (0, s)),
            0.5,
        );
        for p in parts.iter().flat_map(|b| &b.stroke.points) {
            // Only places away from the joins are compared.
            if (p.x.abs() - 20.0).abs() > 11.5 || p.y.abs() > 11.5 {
                continue;
            }
            let near = grid.nearest(*p).unwrap().1;
            assert!(near.distance(*p) < 1e-6, "{kind:?}: {p}");
        }
    }
}
