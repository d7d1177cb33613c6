//! Beads that follow the surface above them (`contour_z`), against the height
//! that the surface has by its formula.

use crate::common;
use crate::common::head::Head;
use glam::DVec3;

/// Layer height, mm.
const HEIGHT: f64 = 0.2;

/// A part, 40 mm long and 20 mm wide or round with a radius of 15 mm, and the
/// height at which it ends.
struct Part {
    formula: String,
    top: fn(f64, f64, f64) -> f64,
    /// What `top` depends on.
    parameter: f64,
    round: bool,
}

impl Part {
    fn height(&self, p: DVec3) -> f64 {
        (self.top)(p.x, p.y, self.parameter)
    }

    /// The part's volume, from 2 million columns.
    fn volume(&self) -> f64 {
        let step = 0.02;
        let mut volume = 0.0;
        for i in 0..2000 {
            for j in 0..1500 {
                let x = step * (f64::from(i) + 0.5) - 20.0;
                let y = step * (f64::from(j) + 0.5) - 15.0;
                let inside = if self.round {
                    x.hypot(y) < 15.0
                } else {
                    y.abs() < 10.0
                };
                if inside {
                    volume += (self.top)(x, y, self.parameter);
                }
            }
        }
        volume * step * step
    }
}

/// A ramp of an angle, °.
fn wedge(angle: f64) -> Part {
    let slope = angle.to_radians().tan();
    Part {
        formula: format!(
            "max(max(abs(x) - 20, abs(y) - 10), \
             max(-z, 7*(z - 2.03 - (x + 20)*{slope})))"
        ),
        top: |x, _, slope| 2.03 + (x + 20.0) * slope,
        parameter: slope,
        round: false,
    }
}

/// A cap of a ball, 22° steep at its edge, on a cylinder.
fn dome() -> Part {
    Part {
        formula: "max(max(sqrt(x^2 + y^2) - 15, -z), \
                  x^2 + y^2 + (z + 34)^2 - 1600)"
            .to_owned(),
        top: |x, y, _| (1600.0 - x * x - y * y).sqrt() - 34.0,
        parameter: 0.0,
        round: true,
    }
}

/// Waves, up to 13° steep.
fn waves() -> Part {
    Part {
        formula: "max(max(abs(x) - 20, abs(y) - 10), \
                  max(-z, z - 4 - 0.9*sin(0.25*x)*cos(0.2*y)))"
            .to_owned(),
        top: |x, y, _| 4.0 + 0.9 * (0.25 * x).sin() * (0.2 * y).cos(),
        parameter: 0.0,
        round: false,
    }
}

const BASE: [&str; 6] = [
    "layer_height=0.2",
    "first_layer_height=0.2",
    "infill_density=100",
    "gcode.relative_e=true",
    "gcode.progress=off",
    "skirt.loops=0",
];

fn asked<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&BASE[..], more].concat()
}

/// A nozzle that may follow all of these parts.
const STEEP: [&str; 3] = [
    "contour_z=100",
    "contour_z_angle=30",
    "printer.nozzle_flat=0.3",
];

/// A move that extrudes.
struct Step {
    from: DVec3,
    to: DVec3,
    /// Filament, mm.
    fed: f64,
    /// Top of the layer, mm.
    top: f64,
    /// Width of the line, mm.
    width: f64,
    /// True if the move is in the last layer.
    last: bool,
    /// True if the move is of a support.
    support: bool,
    /// True if no other move lies between this move and the one before.
    goes_on: bool,
}

/// The steps below a fin at the part's top. A fin is narrower than its bead, the thinnest
/// one, and the bead below makes room for it all along but at its ends.
fn below_fins(steps: Vec<Step>) -> Vec<Step> {
    let fins = steps.iter().filter(|step| step.width == 0.27);
    let lowest = fins.map(|step| step.top).fold(f64::INFINITY, f64::min);
    let below = steps.into_iter();
    below
        .filter(|step| step.top < lowest - 1.5 * HEIGHT)
        .collect()
}

fn steps(gcode: &str) -> Vec<Step> {
    let end = gcode.find("; end of layers").unwrap();
    let mut head = Head::new(DVec3::new(110.0, 110.0, 0.0));
    let (mut top, mut steps) = (0.0, Vec::new());
    let (mut goes_on, mut width, mut support) = (false, 0.0, false);
    for line in gcode[..end].lines() {
        if let Some(z) = line.strip_prefix(";Z:") {
            top = z.parse().unwrap();
        }
        if let Some(role) = line.strip_prefix(";TYPE:") {
            support = role.starts_with("Support");
        }
        if let Some(w) = line.strip_prefix(";WIDTH:") {
            width = w.parse().unwrap();
        }
        let Some(step) = head.step(line) else {
            continue;
        };
        let prints = step.prints();
        if prints && top > 0.0 {
            steps.push(Step {
                from: step.from,
                to: step.to,
                fed: step.fed,
                top,
                width,
                last: false,
                support,
                goes_on,
            });
        }
        goes_on = prints;
    }
    let highest = steps.iter().map(|s: &Step| s.top).fold(0.0, f64::max);
    steps.iter_mut().for_each(|s| s.last = s.top == highest);
    steps
}

fn print(part: &Part, more: &[&str]) -> Vec<Step> {
    let (model, settings) = common::part(&part.formula, &asked(more));
    let (gcode, summary) = common::slice(&model, &settings, 2);
    assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
    steps(&gcode)
}

/// What lies open of a bead, across its way.
struct Bare {
    /// The middle of it, at the nozzle's height.
    middle: DVec3,
    /// How wide it is, mm.
    width: f64,
    /// True if the next layer covers the bead's own middle.
    strip: bool,
    /// True if all of the bead lies open.
    whole: bool,
}

/// What lies open at a share of a step's way, by the formula; nothing if the
/// next layer covers all of it.
fn bare(part: &Part, step: &Step, t: f64) -> Option<Bare> {
    /// Places across a bead.
    const ACROSS: i32 = 48;
    let p = step.from.lerp(step.to, t);
    let way = (step.to - step.from).truncate().normalize();
    let across = way.perp().extend(0.0);
    // Beads lie beside one another at this distance.
    let spacing = step.width - HEIGHT * (1.0 - std::f64::consts::FRAC_PI_4);
    // Up to 2 µm below the next layer's middle.
    let next = step.top + 0.5 * HEIGHT - 0.002;
    let open = |p: DVec3| step.last || part.height(p) < next;
    let places = (0..ACROSS).map(|k| {
        let share = (f64::from(k) + 0.5) / f64::from(ACROSS) - 0.5;
        p + share * spacing * across
    });
    let bare: Vec<DVec3> = places.filter(|q| open(*q)).collect();
    (!bare.is_empty()).then(|| Bare {
        middle: bare.iter().sum::<DVec3>() / bare.len() as f64,
        width: spacing / f64::from(ACROSS) * bare.len() as f64,
        strip: !open(p),
        whole: bare.len() == ACROSS as usize,
    })
}

/// Where paths turn by more than a tenth of a right angle, and the layer's top.
fn bends(steps: &[Step]) -> Vec<DVec3> {
    let turns = |pair: &&[Step]| {
        let [a, b] = [0, 1].map(|k| (pair[k].to - pair[k].from).truncate());
        pair[1].goes_on && a.angle_to(b).abs() > 0.05 * std::f64::consts::PI
    };
    let places = steps.windows(2).filter(turns);
    places
        .map(|pair| pair[1].from.truncate().extend(pair[1].top))
        .collect()
}

/// The bends in the layer of a step.
fn in_layer(bends: &[DVec3], step: &Step) -> Vec<DVec3> {
    let own = bends.iter().filter(|b| b.z == step.top);
    own.copied().collect()
}

/// True if a bend of its layer is near to a share of a step's way.
fn near_bend(bends: &[DVec3], step: &Step, t: f64) -> bool {
    /// A bead's half width, and the distance of the places, mm.
    const NEAR: f64 = 0.35;
    let place = step.from.lerp(step.to, t).truncate();
    bends.iter().any(|b| b.truncate().distance(place) < NEAR)
}

/// How far the nozzle is above the surface at the middle of what a bead leaves
/// open, µm, every 0.1 mm along all beads.
#[derive(Default)]
struct Distances {
    /// Where a bead's own middle lies open.
    own: Vec<f64>,
    /// In strips of 20 µm and more where the next layer covers that.
    strips: Vec<f64>,
    /// Where all of a bead lies open, away from bends.
    straight: Vec<f64>,
}

fn distances(part: &Part, steps: &[Step]) -> Distances {
    let bends = bends(steps);
    let mut off = Distances::default();
    for step in steps {
        let count = (step.from.distance(step.to) / 0.1).ceil();
        let here = in_layer(&bends, step);
        for i in 0..=count as usize {
            let t = i as f64 / count;
            let bare = bare(part, step, t);
            let wide = |b: &Bare| !b.strip || b.width > 0.02;
            let Some(bare) = bare.filter(wide) else {
                continue;
            };
            let above = 1000.0 * (bare.middle.z - part.height(bare.middle));
            let all = if bare.strip {
                &mut off.strips
            } else {
                &mut off.own
            };
            all.push(above);
            if bare.whole && !near_bend(&here, step, t) {
                off.straight.push(above);
            }
        }
    }
    off
}

fn rms(off: &[f64]) -> f64 {
    (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt()
}

fn worst(off: &[f64]) -> f64 {
    off.iter().fold(0.0, |most, d| d.abs().max(most))
}

/// Volume of the filament, mm³.
fn volume(steps: &[Step]) -> f64 {
    let fed: f64 = steps.iter().map(|s| s.fed).sum();
    fed * common::filament_area(1.75)
}

/// Greatest change of slope from a move to the next one in about the same
/// direction, where both lie open.
fn sharpest_bend(part: &Part, steps: &[Step]) -> f64 {
    let open = |s: &Step| {
        let low = |p: DVec3| part.height(p) < s.top + 0.5 * HEIGHT - 0.002;
        low(s.from) && low(s.to)
    };
    let mut most: f64 = 0.0;
    for pair in steps.windows(2) {
        let [a, b] = [0, 1].map(|i: usize| pair[i].to - pair[i].from);
        let [level_a, level_b] = [a, b].map(DVec3::truncate);
        let (la, lb) = (level_a.length(), level_b.length());
        let straight = level_a.dot(level_b) > 0.999 * la * lb;
        // The rounding of z alone bends shorter ones.
        let long = la.min(lb) > 0.05;
        let both = open(&pair[0]) && open(&pair[1]);
        if pair[1].goes_on && straight && long && both {
            most = most.max((a.z / la - b.z / lb).abs());
        }
    }
    most
}

#[test]
fn tops_lie_on_the_surface() {
    for part in [wedge(5.0), wedge(10.0), wedge(15.0), wedge(25.0)]
        .into_iter()
        .chain([dome(), waves()])
    {
        let steps = print(&part, &STEEP);
        let name = &part.formula;
        let share = volume(&steps) / part.volume() - 1.0;
        assert!(share.abs() < 0.005, "{name}: {share}");
        let steps = below_fins(steps);
        let Distances {
            own,
            strips,
            straight,
        } = distances(&part, &steps);
        assert!(own.len() > 10_000 && straight.len() > 5_000);
        // Hardly any strips of the wedges of 10° and 15° lie open.
        let has_strips = !(0.1..0.3).contains(&part.parameter);
        assert!(!has_strips || strips.len() > 100, "{name}");
        // `TOLERANCE`, the rounding of z and that of x and y.
        assert!(rms(&straight) < 1.5, "{name}: {}", rms(&straight));
        assert!(worst(&straight) < 3.0, "{name}: {}", worst(&straight));
        for off in [own, strips].iter().filter(|off| !off.is_empty()) {
            assert!(rms(off) < 2.5, "{name}: {}", rms(off));
            // At a bend a bead has one height for both of its sides.
            assert!(worst(off) < 18.0, "{name}: {}", worst(off));
        }
        // Thinned to 1.5 µm, a way of 0.1 mm bends by 4·1.5/50.
        let bend = sharpest_bend(&part, &steps);
        assert!(bend < 0.085, "{name}: {bend}");
        // Level layers are off by half of their height.
        let flat = print(&part, &[]);
        let Distances {
            own: off, strips, ..
        } = distances(&part, &flat);
        // There the next layer's edge is half a layer above the strip.
        assert!(strips.is_empty() || rms(&strips) > 40.0, "{name}");
        // Of a wedge of 25° only the middles of the outer walls lie open, all
        // at one height.
        assert!(rms(&off) > if part.parameter > 0.4 { 2.0 } else { 40.0 });
        assert!(flat.iter().all(|s| s.from.z == s.to.z));
    }
}

/// Height of the material of a step: as its volume fills the plane between its
/// neighbours, mm.
fn material(step: &Step) -> f64 {
    let section = |h: f64| {
        let w = step.width;
        (w - h) * h + std::f64::consts::PI * 0.25 * h * h
    };
    let length = step.from.distance(step.to);
    let laid = step.fed * common::filament_area(1.75) / length;
    HEIGHT * laid / section(HEIGHT)
}

/// A part and the height of its underside.
type Underside = (String, fn(DVec3) -> f64);

/// A block of 40 by 20 mm whose underside rises from the bed's by an angle, or
/// in waves.
fn undersides() -> [Underside; 3] {
    let block = |underside: &str| {
        format!(
            "max(max(abs(x) - 20, abs(y) - 10), \
             max(z - 9, max(-z, 3*({underside} - z))))"
        )
    };
    [
        (block("0.0874887*(x + 20)"), |p| 0.0874887 * (p.x + 20.0)),
        (block("0.176327*(x + 20)"), |p| 0.176327 * (p.x + 20.0)),
        (block("2 + 2*sin(0.08*x)*cos(0.02*y)"), |p| {
            2.0 + 2.0 * (0.08 * p.x).sin() * (0.02 * p.y).cos()
        }),
    ]
}

#[test]
fn undersides_lie_on_the_surface() {
    let below = [
        "contour_z=100",
        "contour_z_angle=30",
        "contour_z_below=true",
        "bridge_anchor=0",
    ];
    for (formula, surface) in undersides() {
        let mut worst = [0.0_f64; 2];
        let mut sums = [0.0_f64; 2];
        let mut laid = [0.0_f64; 2];
        let mut looks = 0;
        for (k, more) in [&[][..], &below[..]].into_iter().enumerate() {
            let (model, settings) = common::part(&formula, &asked(more));
            let (gcode, _) = common::slice(&model, &settings, 2);
            let steps = steps(&gcode);
            laid[k] = volume(&steps);
            looks = 0;
            for step in &steps {
                let p = step.from.lerp(step.to, 0.5);
                // Undersides that lie open on all of a line's width.
                let beside = [-0.23, 0.0, 0.23].map(|y| {
                    [-0.23, 0.23].map(|x| surface(p + DVec3::new(x, y, 0.0)))
                });
                let low = beside.as_flattened().iter().copied();
                let low = low.fold(f64::INFINITY, f64::min);
                let high = beside.as_flattened().iter().copied();
                let high = high.fold(0.0, f64::max);
                let bottom = step.top - HEIGHT;
                // Ends of lines at walls are narrower, or overlap.
                let inside = p.x.abs() < 18.5 && p.y.abs() < 8.5;
                let open = low > bottom - 0.5 * HEIGHT + 0.002
                    && high < bottom + 0.5 * HEIGHT - 0.002;
                let long = step.from.distance(step.to);
                if !inside || !open || bottom < 0.1 || long < 0.05 {
                    continue;
                }
                let off = p.z - material(step) - surface(p);
                worst[k] = worst[k].max(off.abs());
                sums[k] += off * off;
                looks += 1;
                // The nozzle stays in its layer.
                assert!((step.to.z - step.top).abs() < 1e-9);
            }
            sums[k] = (sums[k] / f64::from(looks)).sqrt();
        }
        assert!(looks > 20, "{formula}: {looks}");
        assert!(sums[0] > 0.008, "{sums:?}");
        assert!(sums[1] < 0.005 && worst[1] < 0.02, "{sums:?} {worst:?}");
        // Level layers are too low as often as too high.
        assert!((laid[1] / laid[0] - 1.0).abs() < 0.004, "{laid:?}");
    }
}

#[test]
fn undersides_stay_level_unless_asked_for() {
    let (formula, _) = &undersides()[0];
    let with = |more: &[&str]| {
        let (model, settings) = common::part(formula, &asked(more));
        common::slice(&model, &settings, 2).0
    };
    let end = |text: &str| {
        let from = text.find(";LAYER_CHANGE").unwrap();
        text[from..text.find("; end of layers").unwrap()].to_owned()
    };
    // The top is a level face at a layer's top. With gaps at their seams, walls do not
    // go on in one another, with or without beads that follow the surface.
    let seam = "seam_gap=0.01";
    let both = [with(&[seam]), with(&[seam, "contour_z=100"])];
    assert_eq!(end(&both[0]), end(&both[1]));
}

#[test]
fn tops_do_not_rise_into_the_gap_below_supports() {
    // A foot whose top lies 0.08 mm above a layer, and a table above it.
    let part = "min(max(max(abs(x) - 15, abs(y) - 10), abs(z - 1.54) - 1.54), \
                min(max(max(abs(x) - 2, abs(y) - 2), abs(z - 5) - 5), \
                max(max(abs(x) - 8, abs(y) - 8), abs(z - 9) - 1)))";
    let (model, settings) = common::part(
        part,
        &asked(&["contour_z=100", "bridge_max=1", "supports=auto"]),
    );
    let (gcode, _) = common::slice(&model, &settings, 2);
    let steps = steps(&gcode);
    let near = |p: DVec3, s: &Step| {
        let (a, way) = (s.from.truncate(), (s.to - s.from).truncate());
        let t = (p.truncate() - a).dot(way) / way.length_squared();
        p.truncate().distance(a + t.clamp(0.0, 1.0) * way)
    };
    // What stands on the foot, above a gap of 0.2 mm.
    let on_foot = |s: &&Step| {
        let p = s.from;
        s.support && s.top > 3.3 && s.top < 3.5 && p.x.abs() < 14.0
    };
    let posts: Vec<&Step> = steps.iter().filter(on_foot).collect();
    let (mut below, mut open) = (0, 0);
    let top = steps.iter().filter(|s| (s.top - 3.0).abs() < 1e-9);
    for step in top.filter(|s| !s.support) {
        for i in 0..=8 {
            let p = step.from.lerp(step.to, f64::from(i) / 8.0);
            let away = posts.iter().map(|s| near(p, s));
            let away = away.fold(f64::INFINITY, f64::min);
            // The stem and what it covers.
            let covered = p.truncate().abs().max_element() < 3.5;
            if away < 0.05 {
                // The way up may begin at the border of what the stem covers.
                assert!(p.z < 3.03, "{p}");
                below += usize::from(p.z < 3.001);
            } else if away > 2.0 && !covered {
                assert!((p.z - 3.08).abs() < 0.002, "{p} {away}");
                open += 1;
            }
        }
    }
    assert!(below > 50 && open > 500, "{below} {open}");
}

#[test]
fn what_is_added_is_what_is_below_the_surface() {
    // A wedge alone: what layers lay beside one another is the same in all of
    // them, and does not average out.
    for angle in [5.0, 7.0, 10.0, 13.0] {
        let part = wedge(angle);
        let [with, without] =
            [&STEEP[..], &[]].map(|more| volume(&print(&part, more)));
        let share = (with - without) / part.volume();
        assert!(share.abs() < 0.001, "{angle}: {share}");
    }
}

#[test]
fn closed_beads_end_as_high_as_they_begin() {
    // Waves so short that many walls are covered and open in turn, and seams
    // all over them.
    let part = Part {
        formula: "max(max(sqrt(x^2 + y^2) - 15, -z), \
                  z - 3 - 0.5*sin(0.8*x)*cos(0.7*y))"
            .to_owned(),
        top: |x, y, _| 3.0 + 0.5 * (0.8 * x).sin() * (0.7 * y).cos(),
        parameter: 0.0,
        round: true,
    };
    let more = [&STEEP[..], &["seam=random"]].concat();
    let steps = print(&part, &more);
    let mut raised = 0;
    for path in steps.chunk_by(|_, next| next.goes_on) {
        let (from, to) = (path[0].from, path[path.len() - 1].to);
        let apart = from.truncate().distance(to.truncate());
        if path.len() < 9 || apart > 0.002 {
            continue;
        }
        let rise = path.iter().map(|s| (s.to.z - s.top).abs());
        raised += usize::from(rise.fold(0.0, f64::max) > 0.02);
        assert!((from.z - to.z).abs() < 0.0015, "{from} {to}");
    }
    assert!(raised > 50, "{raised}");
}

#[test]
fn a_level_top_is_printed_at_its_height() {
    // 0.07 mm above the highest layer's top, and 0.07 mm below it.
    for top in [3.07, 2.93] {
        let formula =
            format!("max(max(abs(x) - 6, abs(y) - 6), max(-z, z - {top}))");
        let (model, settings) =
            common::part(&formula, &asked(&["contour_z=100"]));
        let (gcode, _) = common::slice(&model, &settings, 2);
        let steps = steps(&gcode);
        let last = steps.last().unwrap().top;
        for step in &steps {
            let z = if step.top == last { top } else { step.top };
            assert!((step.to.z - z).abs() < 1e-6, "{} {z}", step.to.z);
        }
        let full = volume(&steps) / (144.0 * top) - 1.0;
        assert!(full.abs() < 0.01, "{full}");
    }
}

#[test]
fn steep_faces_stay_as_they_are_and_nothing_begins_at_once() {
    // 22° at the dome's edge; full strength up to 8°, none from 18° on.
    let part = dome();
    let steps = print(&part, &["contour_z=100", "contour_z_angle=8"]);
    let radius = |angle: f64| 40.0 * angle.to_radians().sin();
    let mut faded = 0;
    let bends = bends(&steps);
    for step in &steps {
        let Some(bare) = bare(&part, step, 0.5).filter(|b| b.whole) else {
            continue;
        };
        let p = bare.middle;
        let at = p.truncate().length();
        let surface = part.height(p);
        let (rise, own) = (p.z - step.top, surface - step.top);
        match at {
            _ if at < radius(7.5) => {
                // In bends a bead is led by what both sides leave open.
                let bent = near_bend(&in_layer(&bends, step), step, 0.5);
                let most = if bent { 0.008 } else { 0.003 };
                assert!((rise - own).abs() < most, "{rise} {own}");
            }
            _ if at > radius(18.5) => assert!(rise.abs() < 1e-6, "{rise}"),
            _ => {
                let angle = (at / 40.0).asin().to_degrees();
                let t = ((angle - 8.0) / 10.0).clamp(0.0, 1.0);
                let share = 1.0 - t * t * (3.0 - 2.0 * t);
                assert!((rise - share * own).abs() < 0.004, "{rise} {own}");
                faded += 1;
            }
        }
    }
    assert!(faded > 1000);
    assert!(sharpest_bend(&part, &steps) < 0.08);
}

#[test]
fn a_flat_nozzle_follows_less() {
    // Half of the flat end is 0.5 mm: at 75 % of 0.2 mm it cuts as deep as it
    // may at 16.7°; at 26.7° nothing is left.
    let part = wedge(30.0);
    let asked = ["contour_z=100", "contour_z_angle=35"];
    let level = print(&part, &asked);
    assert!(level.iter().all(|s| s.from.z == s.to.z));
    // One with a finer end may.
    let fine = [&asked[..], &["printer.nozzle_flat=0.4"]].concat();
    let Distances {
        own: off, straight, ..
    } = distances(&part, &print(&part, &fine));
    assert!(off.len() > 100 && straight.len() > 100);
    assert!(worst(&straight) < 3.0, "{}", worst(&straight));
    // Bends are half as wide as the terraces between two layers' edges.
    assert!(rms(&off) < 3.0 && worst(&off) < 50.0, "{}", worst(&off));
}

#[test]
fn an_expression_says_where() {
    let part = wedge(8.0);
    let wanted = "contour_z=expr: 100*min(max(x/10, 0), 1)";
    let steps = print(&part, &[wanted]);
    let bends = bends(&steps);
    for step in &steps {
        if let Some(bare) = bare(&part, step, 0.5).filter(|b| b.whole) {
            let p = bare.middle;
            let own = part.height(p) - step.top;
            let share = (p.x / 10.0).clamp(0.0, 1.0);
            let rise = p.z - step.top;
            // In bends a bead is led by what both sides leave open.
            let bent = near_bend(&in_layer(&bends, step), step, 0.5);
            let most = if bent { 0.006 } else { 0.003 };
            assert!((rise - share * own).abs() < most, "{rise} {own}");
        }
    }
}

#[test]
fn travels_run_above_what_is_printed() {
    let part = waves();
    let (model, settings) = common::part(&part.formula, &asked(&STEEP));
    let (gcode, _) = common::slice(&model, &settings, 2);
    let end = gcode.find("; end of layers").unwrap();
    let (mut at, mut highest, mut travels) = (DVec3::ZERO, 0.0_f64, 0);
    for line in gcode[..end].lines() {
        if line.starts_with(";LAYER_CHANGE") {
            highest = 0.0;
        }
        if !line.starts_with("G1 ") && !line.starts_with("G0 ") {
            continue;
        }
        let (from, mut fed) = (at, 0.0);
        for word in line.split_whitespace().skip(1) {
            let value: f64 = word[1..].parse().unwrap();
            match &word[..1] {
                "X" => at.x = value,
                "Y" => at.y = value,
                "Z" => at.z = value,
                "E" => fed = value,
                _ => {}
            }
        }
        if fed > 0.0 {
            highest = highest.max(at.z).max(from.z);
        } else if at.truncate() != from.truncate() {
            assert!(at.z >= highest - 1e-9 && from.z >= highest - 1e-9);
            travels += 1;
        }
    }
    assert!(travels > 50);
}
