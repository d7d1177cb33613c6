//! Density: even, or by an expression.

use super::*;

#[test]
fn density_is_the_share_of_the_volume_in_beads() {
    let area = square(50.0);
    for kind in InfillPattern::ALL {
        for density in [10.0, 15.0, 25.0, 60.0] {
            let plan = even(kind, density);
            // The window is off the walls, where the joins are, and spans
            // several cells.
            let half = match kind {
                InfillPattern::Concentric => 50.0,
                _ => 43.0,
            };
            // A window does not hold a whole number of cells. So the patterns
            // are laid out from many different places in a cell.
            let layers: Vec<Vec<Bead>> = (0..16)
                .flat_map(|k| {
                    let turn = |step: f64| (step * f64::from(k)).fract();
                    let aside = 40.0 * DVec2::new(turn(0.755), turn(0.570));
                    let site = Site {
                        part: HERE.part.moved(aside),
                        ..HERE
                    };
                    // Both directions of alternating lines are there equally
                    // often.
                    let places = (0..12).map(|i| spread(12 * k as usize + i));
                    lay(&plan, site, &area, places)
                })
                .collect();
            let share = share_at(&layers, DVec2::ZERO, DVec2::splat(half));
            assert!(
                (share / density - 1.0).abs() < 0.03,
                "{kind:?} {density}: {share}"
            );
        }
    }
}

#[test]
fn no_density_no_beads() {
    let area = square(15.0);
    let beads = |density| {
        let plan = even(InfillPattern::Rectilinear, density);
        lay(&plan, HERE, &area, [layer(0)]).remove(0)
    };
    assert!(!beads(5.0).is_empty());
    assert!(beads(0.0).is_empty());
    // An expression gives its own density.
    for solid in [false, true] {
        let shape = |density: f64| {
            let plan = InfillPlan {
                density: density.into(),
                ..shape("sin(x)", solid)
            };
            assert!(!plan.is_hollow());
            lay(&plan, HERE, &area, [layer(0)]).remove(0)
        };
        assert!(!shape(0.0).is_empty());
        assert_eq!(shape(0.0), shape(15.0));
        assert_eq!(shape(0.0), shape(100.0));
    }
}

#[test]
fn a_varying_density_is_met_everywhere() {
    // The density goes from 10 % on the left to 60 % on the right.
    let density = |x: f64| 35.0 + 0.6 * x;
    let area = square(48.0);
    let varied = |kind: &InfillPattern| pattern(*kind, false).can_vary();
    for kind in InfillPattern::ALL.into_iter().filter(varied) {
        let plan = graded(kind, "35 + 0.6*x");
        let places = (0..40).map(spread);
        let layers = lay(&plan, HERE, &area, places);
        let mut total = (0.0, 0.0);
        for x in [-30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0] {
            let half = DVec2::new(5.0, 26.0);
            let found = share_at(&layers, DVec2::new(x, 0.0), half);
            let off = found / density(x) - 1.0;
            // A window has four rings or more, at equal places in every layer.
            let slack = match kind {
                InfillPattern::Concentric => 0.5,
                _ => 0.10,
            };
            assert!(off.abs() < slack, "{kind:?} at {x}: {found}");
            total = (total.0 + found, total.1 + density(x));
        }
        let off: f64 = total.0 / total.1 - 1.0;
        let slack = match kind {
            InfillPattern::Concentric => 0.06,
            _ => 0.03,
        };
        assert!(off.abs() < slack, "{kind:?}: {off}");
    }
}

#[test]
fn a_varying_density_has_no_steps() {
    // Over a narrow range of densities the lines must not change at once: the
    // length of lines in thin slices follows the density.
    let area = square(48.0);
    // Straight lines are there or not, about eight of them in a slice.
    for (kind, slack) in [
        (InfillPattern::Gyroid, 0.08),
        (InfillPattern::Rectilinear, 0.13),
    ] {
        let plan = graded(kind, "18 + 0.1*x");
        let places = (0..60).map(spread);
        let layers = lay(&plan, HERE, &area, places);
        for k in -5..=5 {
            let x = 6.0 * f64::from(k);
            let half = DVec2::new(6.0, 30.0);
            let found = share_at(&layers, DVec2::new(x, 0.0), half);
            let off = found / (18.0 + 0.1 * x) - 1.0;
            assert!(off.abs() < slack, "{kind:?} at {x}: {found}");
        }
    }
}

#[test]
fn density_by_the_distance_from_the_surface() {
    // This is the example of the documentation.
    let area = square(48.0);
    for kind in [InfillPattern::Gyroid, InfillPattern::Rectilinear] {
        let plan = graded(kind, "10 + 60*exp(-d/3)");
        let places = (0..30).map(|i| layer(200 + 3 * i));
        let layers = lay(&plan, HERE, &area, places);
        let at = |h: f64| share_at(&layers, DVec2::ZERO, DVec2::splat(h));
        let middle = at(20.0);
        assert!((middle / 10.0 - 1.0).abs() < 0.05, "{kind:?}: {middle}");
        // The strip runs along the surface, between 3 and 7 mm from it.
        let strip = |from: f64, to: f64| {
            let (lo, hi) = (50.0 - to, 50.0 - from);
            let inside = |h: f64| at(h) * h * h / 100.0;
            100.0 * (inside(hi) - inside(lo)) / (hi * hi - lo * lo)
        };
        let expected = |from: f64, to: f64| {
            let n = 1000;
            let (mut sum, mut weight) = (0.0, 0.0);
            for i in 0..n {
                let d = from + (to - from) * (i as f64 + 0.5) / n as f64;
                sum += (50.0 - d) * (10.0 + 60.0 * (-d / 3.0).exp());
                weight += 50.0 - d;
            }
            sum / weight
        };
        let (found, wanted) = (strip(3.0, 7.0), expected(3.0, 7.0));
        assert!(
            (found / wanted - 1.0).abs() < 0.1,
            "{kind:?}: {found} {wanted}"
        );
    }
}
