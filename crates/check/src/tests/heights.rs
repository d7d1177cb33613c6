//! Beads and travels at the wrong height.

use super::*;

const HEAD: &str = "G28\nM109 S200\nM83\n;TYPE:Perimeter\n";

/// A layer of 12 lines, 0.4 mm apart and 20 mm long, which fill it. `rise` is
/// how far the nozzle is above the layer's top on each of them. Ways between
/// them lead over everything.
fn layer(top: f64, rise: impl Fn(usize) -> f64) -> String {
    let mut text =
        format!(";LAYER_CHANGE\n;Z:{top:.1}\n;HEIGHT:0.2\n;WIDTH:0.45\n");
    for k in 0..12 {
        let (x, z) = (50.0 + 0.4 * k as f64, top + rise(k));
        text += &format!(
            "G1 Z{:.3} F600\nG1 X{x:.3} Y50 F6000\nG1 Z{z:.3} F600\n\
             G1 Y70 E0.678 F900\n",
            top + 1.0
        );
    }
    text
}

fn level(_: usize) -> f64 {
    0.0
}

/// A line of its own beside the others.
fn alone(z: f64) -> String {
    format!(
        "G1 Z{:.3} F600\nG1 X80 Y50 F6000\nG1 Z{z:.3} F600\n\
         G1 Y70 E0.678 F900\n",
        z + 1.0
    )
}

/// What is wrong with some layers.
fn of_layers(layers: &[String]) -> Verdict {
    verdict(&format!("{HEAD}{}{END}", layers.concat()))
}

/// The line of a text at which a part of it begins.
fn line_of(layers: &[String], part: &str) -> u64 {
    let text = format!("{HEAD}{}", layers.concat());
    let at = text.find(part).unwrap();
    text[..at].lines().count() as u64 + 1
}

fn levels(tops: &[f64]) -> Vec<String> {
    tops.iter().map(|z| layer(*z, level)).collect()
}

#[test]
fn a_bead_that_rises_has_something_below_it() {
    let below = levels(&[0.2, 0.4]);
    let with = |rise: f64, line: usize| {
        let own = layer(0.6, |k| if k == line { rise } else { 0.0 });
        of_layers(&[below.clone(), vec![own]].concat())
    };
    for line in 1..12 {
        // As much as a surface may lift a bead, and more.
        assert!(with(0.1, line).counts.is_empty());
        let all = with(0.3, line);
        let found = &all.findings[..];
        assert_eq!(found.len(), 1, "{all:?}");
        assert_eq!((found[0].kind, found[0].count), (FindingKind::InTheAir, 1));
        assert!(found[0].line > 0);
        let x = 50.0 + 0.4 * line as f64;
        assert!((found[0].at - DVec3::new(x, 50.0, 0.9)).length() < 1e-6);
        assert!(found[0].message.contains("reach up to 0.400 only"));
    }
    // In the first layer the bed is below it.
    let first = layer(0.2, |k| if k == 5 { 0.3 } else { 0.0 });
    let island = format!("{}{}", layer(0.2, level), alone(0.5));
    // The bead is an island of its own, which is told once.
    assert_eq!(count(&of_layers(&[island]), FindingKind::InTheAir), 1);
    assert_eq!(count(&of_layers(&[first]), FindingKind::InTheAir), 1);
    // A bead that lies over a gap in the layer below bridges it.
    let gap = levels(&[0.2])
        .into_iter()
        .chain([layer(0.4, level).replace("Y70 E0.678", "Y52 E0.07")]);
    let gap: Vec<String> = gap.chain(levels(&[0.6])).collect();
    assert!(of_layers(&gap).counts.is_empty());
}

#[test]
fn an_island_stands_at_its_own_height() {
    let with = |z: f64| {
        let mut layers = levels(&[0.2, 0.4, 0.6]);
        layers[0] += &alone(0.2);
        layers[1] += &alone(z);
        layers[2] += &alone(0.6);
        of_layers(&layers)
    };
    assert!(with(0.4).counts.is_empty());
    // Half a layer lower, as walls that interlock.
    assert!(with(0.3).counts.is_empty());
    // The next bead begins above one that is sunk, which itself is laid into
    // what is below it.
    let all = with(0.1);
    assert_eq!(count(&all, FindingKind::InTheAir), 1, "{all:?}");
    assert_eq!(count(&all, FindingKind::Sunk), 1, "{all:?}");
}

#[test]
fn no_bead_is_laid_into_those_below() {
    let raised = layer(0.6, |k| if k == 5 { 0.3 } else { 0.0 });
    let mut layers = levels(&[0.2, 0.4]);
    layers.push(raised);
    layers.extend(levels(&[0.8]));
    let all = of_layers(&layers);
    let sunk = all
        .findings
        .iter()
        .find(|f| f.kind == FindingKind::Sunk)
        .unwrap();
    // The cells of the raised line are those of its neighbours, too.
    assert!(matches!(sunk.count, 1..=3), "{all:?}");
    assert!((sunk.at.x - 52.0).abs() < 0.7, "{sunk:?}");
    assert!(sunk.message.contains("reach up to 0.900"), "{sunk:?}");
    assert!(all.is_safe(), "it is a warning");
}

#[test]
fn no_travel_leads_through_what_is_printed() {
    let raised = layer(0.6, |k| if k == 5 { 0.1 } else { 0.0 });
    let layers = [levels(&[0.2, 0.4]), vec![raised]].concat();
    let with = |way: &str| {
        let layers = [&layers[..], &[way.to_owned()]].concat();
        (of_layers(&layers), line_of(&layers, way))
    };
    for (z, low) in [(0.7, false), (0.66, false), (0.6, true), (0.3, true)] {
        let way = format!(
            "G1 Z2 F600\nG1 X40 Y55 F6000\nG1 Z{z} F600\nG1 X70 Y60 F6000\n"
        );
        let (all, line) = with(&way);
        assert_eq!(
            count(&all, FindingKind::Low),
            u64::from(low),
            "{z} {all:?}"
        );
        if low {
            let found =
                all.findings.iter().find(|f| f.kind == FindingKind::Low);
            let found = found.unwrap();
            assert_eq!(found.line, line + 3);
            let said = "reaches up to 0.700";
            assert!(found.message.contains(said), "{found:?}");
        }
    }
    // Over the bed beside it nothing is in the way.
    let (all, _) = with("G1 Z3 F600\nG1 X90 F6000\nG1 Z0.6 F600\nG1 Y90\n");
    assert!(all.counts.is_empty(), "{all:?}");
}
