//! Fewer walls around tops, read from the G-code of a tower on a plate.

use crate::common;
use crate::common::{INNER_WALL, Layer, OUTER_WALL, parse, slice};
use glam::DVec2;

/// A tower, 10 mm wide and 4 mm high, on a plate of 30 × 20 × 2 mm.
const TOWER: &str = "min(max(max(abs(x) - 15, abs(y) - 10), abs(z - 1) - 1), \
                     max(max(abs(x), abs(y)) - 5, abs(z - 2) - 2))";
/// A cone that loses 0.2 mm on all sides in each layer.
const CONE: &str = "max(max(sqrt(x^2 + y^2) - 10 + z, -z), z - 4)";
const HEIGHT: f64 = 0.2;
/// The plate's highest layer.
const TOP: usize = 9;

const BASE: [&str; 6] = [
    "walls=3",
    "infill_density=100",
    "first_layer_height=0.2",
    "skirt.loops=0",
    "gcode.relative_e=true",
    "gcode.progress=off",
];

fn asked<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&BASE[..], more].concat()
}

fn sliced(text: &str, more: &[&str]) -> Vec<Layer> {
    let (model, settings) = common::part(text, &asked(more));
    parse(&slice(&model, &settings, 2).0)
}

/// Volume of filament fed over volume of the part, in one layer.
fn share(layer: &Layer, area: f64) -> f64 {
    layer.fed() * common::filament_area(1.75) / (area * HEIGHT)
}

#[test]
fn inner_walls_go_around_what_the_next_layer_covers() {
    let usual = sliced(TOWER, &[]);
    let layers = sliced(TOWER, &["top_walls=1"]);
    assert_eq!(layers.len(), 20);
    for (i, layer) in layers.iter().enumerate() {
        let inner = layer.length(INNER_WALL);
        match i {
            // The plate's top: two walls around what is below the tower.
            TOP => {
                let side = 10.0 - 0.45;
                let spacing =
                    0.45 - HEIGHT * (1.0 - std::f64::consts::FRAC_PI_4);
                let exact = 4.0 * (2.0 * side - 4.0 * spacing);
                assert!((inner - exact).abs() < 1.0, "{inner} of {exact}");
                let walls = layer.prints().filter(|m| m.role == INNER_WALL);
                for m in walls {
                    let p = m.to.truncate() - DVec2::splat(110.0);
                    assert!(p.abs().max_element() < 0.5 * side, "{p}");
                }
            }
            // The tower's top has no inner walls at all.
            19 => assert_eq!(inner, 0.0),
            // Elsewhere nothing changes but where lines begin.
            _ => {
                assert!((inner - usual[i].length(INNER_WALL)).abs() < 0.01);
                assert!((layer.fed() - usual[i].fed()).abs() < 1e-3);
            }
        }
        // A wall to whose beginning an inner wall leads ends earlier by what the way
        // lays within it. The tops of plate and tower have no such way.
        let flat = HEIGHT * (1.0 - std::f64::consts::FRAC_PI_4);
        let way = 0.225 * (HEIGHT - flat) / (0.45 - flat);
        let more = if i == TOP || i == 19 { way } else { 0.0 };
        let outer = layer.length(OUTER_WALL) - more;
        assert!((outer - usual[i].length(OUTER_WALL)).abs() < 0.01);
        // Nothing is left out, and nothing is laid twice.
        let area = if i <= TOP { 600.0 } else { 100.0 };
        let share = share(layer, area);
        assert!((share - 1.0).abs() < 0.01, "{share} in layer {i}");
    }
}

#[test]
fn walls_of_slopes_and_other_numbers_stay() {
    let inner = |layers: &[Layer]| -> f64 {
        layers.iter().map(|l| l.length(INNER_WALL)).sum()
    };
    // Only the level end of the cone is a top.
    let usual = sliced(CONE, &[]);
    let layers = sliced(CONE, &["top_walls=1"]);
    let last = layers.len() - 1;
    assert!((inner(&layers[..last]) - inner(&usual[..last])).abs() < 0.01);
    assert_eq!(layers[last].length(INNER_WALL), 0.0);
    // Two walls around tops, and the third around what is covered.
    let two = sliced(TOWER, &["top_walls=2"]);
    let one = sliced(TOWER, &["top_walls=1"]);
    let three = sliced(TOWER, &[]);
    let at_top =
        [&one, &two, &three].map(|layers| layers[TOP].length(INNER_WALL));
    assert!(at_top[0] < at_top[1] && at_top[1] < at_top[2], "{at_top:?}");
    // As many as walls, and more, change nothing.
    for more in ["top_walls=3", "top_walls=9"] {
        let same = sliced(TOWER, &[more]);
        assert!((inner(&same) - inner(&three)).abs() < 0.01);
    }
}
