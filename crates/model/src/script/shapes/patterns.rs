//! Patterns for textures: functions of x and y, mm, with values from 0 (deep)
//! to 1 (raised).
//!
//! Each repeats after a multiple of its `size` along x, and of another length
//! along y; docs/textures.md tells both. Other parameters are shares of the
//! size, so that a pattern of any size looks the same.
//!
//! What looks random is made of fidget's `rand` of whole numbers, which f32
//! holds exactly: a pattern is the same on any machine, and in f32 and f64.
//!
//! What is irregular is cut off at 1. A body's bounds are found quickly if many
//! places are equally high, and slowly if one of many peaks is the highest.

use super::rows::{argument, number, rows, whole};
use super::{Argument, ArgumentKind, Given, Row};
use fidget::context::Tree;

/// Cells after which a random pattern repeats, at most: numbers of cells, of all
/// seeds, stay below 2^24 and are exact in f32.
const MOST_CELLS: f64 = 256.0;
/// Greatest seed, for the same reason.
const MOST_SEED: f64 = 100.0;

const fn size(mm: f64) -> Argument {
    argument("size", ArgumentKind::Size, Some(mm))
}

const fn share(name: &'static str, default: f64) -> Argument {
    argument(name, ArgumentKind::Share, Some(default))
}

const fn repeat(cells: f64) -> Argument {
    number("repeat", Some(cells))
}

const SEED: Argument = number("seed", Some(0.0));

pub(super) const ROWS: &[Row] = rows![
    "knurl" (size(2.0), number("angle", Some(30.0)), share("flat", 0.1))
        "knurl(#{size: 2, angle: 30, flat: 0.1})"
        |g| {
            let angle = g.number(1);
            if !(5.0..=85.0).contains(&angle) {
                return Err("angle must be from 5 to 85 degrees".to_owned());
            }
            let [u, v] = plane(g);
            let across = v * angle.to_radians().tan() as f32;
            let [a, b] = [u.clone() + across.clone(), u - across];
            let steep = over((1.0 - g.number(2)).max(0.01));
            Ok((zigzag(a).min(zigzag(b)) * steep).min(1.0))
        };
    "hexagons" (size(6.0), share("gap", 0.15), share("soft", 0.1))
        "hexagons(#{size: 6, gap: 0.15, soft: 0.1})"
        |g| {
            let [u, v] = plane(g);
            let side = |[x, y]: [Tree; 2]| {
                let (x, y) = (x.abs(), y.abs());
                x.clone().max(x * 0.5 + y * (0.75_f32).sqrt())
            };
            let [a, b] = honeycomb(&u, &v).map(side);
            Ok(raised(0.5 - a.min(b), g, 1))
        };
    "weave" (size(3.0),)
        "weave(#{size: 3})"
        |g| {
            // Strands lie beside each other and go up and down.
            let [u, v] = plane(g);
            let strand = |along: &Tree, across: &Tree, first: f32| {
                let round = 1.0 - (fraction(across) * 2.0 - 1.0).square();
                let way = along.clone() + across.floor() - first;
                round * (wave(way * 0.5) * 0.65 + 0.35)
            };
            Ok(strand(&u, &v, 0.5).max(strand(&v, &u, 1.5)))
        };
    "wood" (size(2.0), share("swing", 0.6), repeat(8.0), SEED)
        "wood(#{size: 2, swing: 0.6, repeat: 8, seed: 0})"
        |g| {
            // Grain along y: lines that bend around knots, and fibres.
            let cells = Cells::of(g, 2)?;
            let [u, v] = plane(g);
            let bend = cells.noise(&(u.clone() * 0.25), &(v.clone() * 0.0625));
            let way = u.clone() + bend * (4.0 * g.number(1)) as f32;
            let fibre = cells.noise(&(u * 4.0), &(v * 0.25));
            Ok((wave(way) * 0.9 + fibre * 0.25).min(1.0))
        };
    "leather" (size(3.0), repeat(16.0), SEED)
        "leather(#{size: 3, repeat: 16, seed: 0})"
        |g| {
            // Pebbles that are round on top, of different heights.
            let cells = Cells::of(g, 1)?;
            let [u, v] = plane(g);
            let [first, second] = cells.nearest(&u, &v);
            let rise = ((second - first) * 2.5).max(0.0).min(1.0);
            let pebble = 1.0 - (1.0 - rise).square();
            let height = cells.noise(&u, &v) * 0.6 + 0.7;
            Ok(pebble * height.min(1.0))
        };
    "voronoi" (size(6.0), share("gap", 0.15), share("soft", 0.1), repeat(16.0), SEED)
        "voronoi(#{size: 6, gap: 0.15, soft: 0.1, repeat: 16, seed: 0})"
        |g| {
            let cells = Cells::of(g, 3)?;
            let [u, v] = plane(g);
            let [first, second] = cells.nearest(&u, &v);
            Ok(raised((second - first) * 0.5, g, 1))
        };
    "waves" (size(4.0), share("swing", 0.5))
        "waves(#{size: 4, swing: 0.5})"
        |g| {
            let [u, v] = plane(g);
            Ok(wave(v + wave(u * (1.0 / 3.0)) * g.number(1) as f32))
        };
    "bricks" (size(8.0), share("height", 0.4), share("gap", 0.1),
        share("soft", 0.05))
        "bricks(#{size: 8, height: 0.4, gap: 0.1, soft: 0.05})"
        |g| {
            let height = g.number(1);
            if height < 0.05 {
                return Err("height must be 0.05 or more".to_owned());
            }
            let [u, v] = plane(g);
            let rows = v * over(height);
            let shift = rows.floor().modulo(2.0) * 0.5;
            let inside = edge(&(u + shift)).min(edge(&rows) * height as f32);
            Ok(raised(inside, g, 2))
        };
    "dots" (size(4.0), share("radius", 0.35))
        "dots(#{size: 4, radius: 0.35})"
        |g| {
            let [u, v] = plane(g);
            let apart = |[x, y]: [Tree; 2]| x.square() + y.square();
            let [a, b] = honeycomb(&u, &v).map(apart);
            let radius = g.number(1).max(0.01) as f32;
            Ok((1.0 - a.min(b) * radius.recip().powi(2)).max(0.0))
        };
    "ribs" (size(2.0), share("gap", 0.3), share("soft", 0.2))
        "ribs(#{size: 2, gap: 0.3, soft: 0.2})"
        |g| {
            let [u, _] = plane(g);
            Ok(raised(edge(&u), g, 1))
        };
    "scales" (size(5.0), share("soft", 0.1))
        "scales(#{size: 5, soft: 0.1})"
        |g| {
            // Discs in rows, each thickest at its lower end, where it lies on
            // the row below.
            let [u, v] = plane(g);
            let soft = g.number(1).clamp(0.01, 0.5);
            let (slope, highest) = (over(soft), over(1.0 - soft));
            let disc = |from: f32| {
                let x = nearest(&(u.clone() + from));
                let y = nearest(&(v.clone() + from));
                let out = (x.square() + y.square()).sqrt();
                let rim = ((0.5 - out) * slope).max(0.0).min(1.0);
                (rim * (0.5 - y) * highest).min(1.0)
            };
            Ok(disc(0.0).max(disc(0.5)))
        };
    "checker" (size(4.0), share("soft", 0.1))
        "checker(#{size: 4, soft: 0.1})"
        |g| {
            // Both directions change between -1 and 1.
            let soft = over(g.number(1).max(0.01));
            let side = |t: Tree| {
                ((zigzag(t * 0.5) * 2.0 - 1.0) * soft).max(-1.0).min(1.0)
            };
            let [u, v] = plane(g);
            Ok(side(u - 0.5) * side(v - 0.5) * 0.5 + 0.5)
        };
];

/// The coordinates in the plane, in units of the size.
fn plane(g: &Given) -> [Tree; 2] {
    let unit = over(g.number(0));
    let (x, y, _) = Tree::axes();
    [x * unit, y * unit]
}

fn over(by: f64) -> f32 {
    (1.0 / by) as f32
}

/// 0 up to half a gap from a border, then up to 1 within the soft edge. Both are
/// values of the call, the gap's first.
fn raised(inside: Tree, g: &Given, gap: usize) -> Tree {
    let soft = g.number(gap + 1).max(0.01);
    let up = (inside - (0.5 * g.number(gap)) as f32) * over(soft);
    up.max(0.0).min(1.0)
}

fn fraction(t: &Tree) -> Tree {
    t.modulo(1.0)
}

/// From the nearest whole number, -0.5 to 0.5.
fn nearest(t: &Tree) -> Tree {
    fraction(&(t.clone() + 0.5)) - 0.5
}

/// Distance from the nearest whole number.
fn edge(t: &Tree) -> Tree {
    nearest(t).abs()
}

/// 1 at whole numbers, 0 between two of them, straight lines between.
fn zigzag(t: Tree) -> Tree {
    1.0 - edge(&t) * 2.0
}

/// As `zigzag`, but smooth.
fn wave(t: Tree) -> Tree {
    smooth(&zigzag(t))
}

/// From 0 to 1 without a kink. The limit is for intervals, which would find 3.
fn smooth(t: &Tree) -> Tree {
    (t.square() * (3.0 - t.clone() * 2.0)).min(1.0)
}

/// The place as seen from the nearest centres of the two grids that make a
/// honeycomb. Centres are 1 apart.
fn honeycomb(u: &Tree, v: &Tree) -> [[Tree; 2]; 2] {
    let height = 3.0_f32.sqrt();
    [0.0, 0.5].map(|from| {
        let rows = v.clone() * height.recip() + from;
        [nearest(&(u.clone() + from)), nearest(&rows) * height]
    })
}

/// Cells of a grid with numbers that look random and repeat.
struct Cells {
    repeat: f32,
    seed: f32,
}

impl Cells {
    /// Those of a call whose values `at` and after it say the cells after which
    /// they repeat, and the seed.
    fn of(g: &Given, at: usize) -> Result<Cells, String> {
        let repeat = whole(g.number(at), "repeat", 1.0, MOST_CELLS)?;
        let seed = whole(g.number(at + 1), "seed", 0.0, MOST_SEED)?;
        Ok(Cells {
            repeat: repeat as f32,
            seed: seed as f32,
        })
    }

    /// A number from 0 to 1 of a cell; `which` tells several of one cell apart.
    fn random(&self, column: &Tree, row: &Tree, which: f32) -> Tree {
        let all = self.repeat * self.repeat;
        // 1, so that there is no zero, whose sign is random, too.
        let first = 1.0 + all * (2.0 * self.seed + which);
        let cell = column.modulo(self.repeat);
        (cell + row.modulo(self.repeat) * self.repeat + first).rand()
    }

    /// Smooth between random numbers at whole places.
    fn noise(&self, u: &Tree, v: &Tree) -> Tree {
        let (column, row) = (u.floor(), v.floor());
        let [s, t] = [u, v].map(|w| smooth(&fraction(w)));
        let corner = |i: f32, j: f32| {
            self.random(&(column.clone() + i), &(row.clone() + j), 0.0)
        };
        // Limited for intervals, which do not know that the shares' sum is 1.
        let between = |a: Tree, b: Tree, t: &Tree| {
            (a * (1.0 - t.clone()) + b * t.clone()).min(1.0)
        };
        let [low, high] =
            [0.0, 1.0].map(|j| between(corner(0.0, j), corner(1.0, j), &s));
        between(low, high, &t)
    }

    /// Distances from the two nearest of points that are scattered, one in each
    /// cell.
    fn nearest(&self, u: &Tree, v: &Tree) -> [Tree; 2] {
        /// Points are so far from the borders of their cells. So all that are
        /// nearer than 1 + `MARGIN` are in the cells around.
        const MARGIN: f32 = 0.2;
        let (column, row) = (u.floor(), v.floor());
        let [s, t] = [fraction(u), fraction(v)];
        let farthest = (1.0 + MARGIN).powi(2);
        let [mut first, mut second] =
            [(); 2].map(|()| Tree::constant(farthest));
        for j in [-1.0, 0.0, 1.0] {
            for i in [-1.0, 0.0, 1.0] {
                let apart = |from: &Tree, step: f32, which: f32| {
                    let (column, row) = (column.clone() + i, row.clone() + j);
                    let at = self.random(&column, &row, which);
                    let at = at * (1.0 - 2.0 * MARGIN) + (step + MARGIN);
                    (at - from.clone()).square()
                };
                let d = apart(&s, i, 0.0) + apart(&t, j, 1.0);
                second = second.min(first.max(d.clone()));
                first = first.min(d);
            }
        }
        [first.sqrt(), second.sqrt()]
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::tree;
    use super::*;
    use fidget::context::{Context, Node};
    use isocontour::{Cancel, SearchOptions, find_bounds};
    use std::path::Path;

    /// For each pattern how many sizes it repeats after along x and y, as
    /// docs/textures.md has it.
    const REPEATS: [(&str, [f32; 2]); 12] = [
        ("knurl", [1.0, 1.732_050_8]),
        ("hexagons", [1.0, 1.732_050_8]),
        ("weave", [2.0, 2.0]),
        ("wood", [32.0, 128.0]),
        ("leather", [16.0, 16.0]),
        ("voronoi", [16.0, 16.0]),
        ("waves", [3.0, 1.0]),
        ("bricks", [1.0, 0.8]),
        ("dots", [1.0, 1.732_050_8]),
        ("ribs", [1.0, 7.25]),
        ("scales", [1.0, 1.0]),
        ("checker", [2.0, 2.0]),
    ];

    struct Pattern {
        context: Context,
        root: Node,
    }

    impl Pattern {
        /// That of a call, with sizes of 1 mm.
        fn of(name: &str) -> Pattern {
            let mut context = Context::new();
            let made = tree(&format!("{name}(#{{size: 1}})")).unwrap();
            let root = context.import(&made);
            Pattern { context, root }
        }

        fn at(&self, x: f32, y: f32) -> f32 {
            self.context.eval_xyz(self.root, x, y, 0.5).unwrap()
        }
    }

    fn places() -> impl Iterator<Item = [f32; 2]> {
        let mut rng = fastrand::Rng::with_seed(3);
        let mut next = move || 40.0 * rng.f32() - 20.0;
        std::iter::repeat_with(move || [next(), next()]).take(3000)
    }

    #[test]
    fn patterns_reach_from_0_to_1_and_repeat() {
        for (name, [across, along]) in REPEATS {
            let pattern = Pattern::of(name);
            let mut range = [1.0_f32, 0.0];
            for [x, y] in places() {
                let v = pattern.at(x, y);
                assert!((0.0..=1.0).contains(&v), "{name}: {v} at {x}, {y}");
                range = [range[0].min(v), range[1].max(v)];
                for [dx, dy] in [[across, 0.0], [0.0, along]] {
                    let again = pattern.at(x + dx, y + dy);
                    let off = (again - v).abs();
                    assert!(off < 3e-3, "{name}: {v}, {again} at {x}, {y}");
                }
            }
            assert!(range[0] < 0.05 && range[1] > 0.95, "{name}: {range:?}");
        }
        assert_eq!(ROWS.len(), REPEATS.len());
    }

    /// Also where a share is nothing or all, and of the least and the greatest
    /// size.
    #[test]
    fn patterns_are_numbers_at_the_ends_of_their_shares() {
        for row in ROWS {
            let shares = row
                .arguments
                .iter()
                .filter(|argument| argument.kind == ArgumentKind::Share);
            let mut calls = vec![
                format!("{}(#{{size: 0.001}})", row.name),
                format!("{}(#{{size: 1000000}})", row.name),
            ];
            for share in shares {
                for end in [0, 1] {
                    let name = share.name;
                    calls.push(format!(
                        "{}(#{{size: 1, {name}: {end}}})",
                        row.name
                    ));
                }
            }
            for call in calls {
                let made = match tree(&call) {
                    Ok(made) => made,
                    Err(e) if e.to_string().contains("must be") => continue,
                    Err(e) => panic!("{call}: {e}"),
                };
                let mut context = Context::new();
                let root = context.import(&made);
                let pattern = Pattern { context, root };
                let ends = [[0.0, 0.0], [1.0, 0.5], [0.5, 0.25]];
                for [x, y] in places().take(300).chain(ends) {
                    let v = pattern.at(x, y);
                    assert!((0.0..=1.0).contains(&v), "{call}: {v} {x} {y}");
                }
            }
            for size in ["0", "1e-4", "1e7", "1e300"] {
                let call = format!("{}(#{{size: {size}}})", row.name);
                assert!(tree(&call).is_err(), "{call}");
            }
        }
    }

    /// No pattern jumps: neither at the borders of cells nor at seams.
    #[test]
    fn patterns_have_no_jumps() {
        for (name, _) in REPEATS {
            let pattern = Pattern::of(name);
            for [x, y] in places() {
                // Cells begin at fractions of the size.
                for at in [[x, y], [x.round(), y], [x, (2.0 * y).round() / 2.0]]
                {
                    let [v, near] =
                        [-1e-4, 1e-4].map(|d| pattern.at(at[0] + d, at[1] + d));
                    let off = (v - near).abs();
                    assert!(off < 0.02, "{name}: {v}, {near} at {at:?}");
                }
            }
        }
    }

    /// These are the values on any machine.
    #[test]
    fn random_patterns_are_always_the_same() {
        const WANTED: [[f32; 3]; 3] = [
            [1.0, 0.040_409_416, 0.809_646_7],
            [1.0, 0.634_222_7, 0.951_522_23],
            [0.196_972_34, 0.616_833_27, 0.751_476_1],
        ];
        let found = ["voronoi", "leather", "wood"].map(|name| {
            let pattern = Pattern::of(name);
            [[0.4, 0.4], [-7.4, 3.2], [12.6, -9.1]]
                .map(|[x, y]| pattern.at(x, y))
        });
        let mut pairs = found.as_flattened().iter().zip(WANTED.as_flattened());
        let same = pairs.all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(same, "{found:?}");
        let other = tree("leather(#{size: 1, seed: 4})").unwrap();
        let mut context = Context::new();
        let other = context.import(&other);
        let other = context.eval_xyz(other, 0.3, 0.7, 0.0).unwrap();
        let first = Pattern::of("leather").at(0.3, 0.7);
        assert!((other - first).abs() > 1e-3);
    }

    /// In a quarter of the work that a search may do, which takes less than a
    /// second.
    #[test]
    fn bounds_of_a_textured_ball_are_found_soon() {
        for (name, _) in REPEATS {
            let ball = tree(&format!(
                "sphere(20).textured(0.5, {name}(), #{{projection: \
                 \"sphere\", radius: 20, size: 10}})"
            ));
            let options = SearchOptions {
                max_work: SearchOptions::default().max_work / 4,
                ..SearchOptions::default()
            };
            let found =
                find_bounds(&ball.unwrap(), &options, &Cancel::default())
                    .unwrap();
            assert!(found.slack_mm <= 1e-4, "{name}: {}", found.slack_mm);
            let size = found.bounds.max - found.bounds.min;
            assert!(size.max_element() <= 41.001, "{name}: {size}");
            assert!(size.min_element() >= 39.999, "{name}: {size}");
        }
    }

    #[test]
    fn the_page_has_every_pattern_with_its_picture() {
        let page = include_str!("../../../../../docs/textures.md");
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for row in ROWS {
            let picture = format!("assets/textures/{}.png", row.name);
            let cells = format!(
                "| `{}` | ![{}](../{picture}) |",
                row.example, row.name
            );
            assert!(page.contains(&cells), "{cells}");
            let size = root.join(&picture).metadata().unwrap().len();
            assert!((500..50_000).contains(&size), "{picture}: {size}");
        }
    }
}
