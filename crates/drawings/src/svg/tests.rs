use crate::tests::bounds_hold;
use crate::{Anchor, Drawing, SvgOptions, White};
use glam::{DVec2, DVec3};
use isocontour::Data;
use isoslice_base::problem::NamedProblem;

/// A page of 100 × 100 mm whose user units are mm.
fn page(inner: &str) -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' \
         xmlns:xlink='http://www.w3.org/1999/xlink' width='100mm' \
         height='100mm' viewBox='0 0 100 100'>{inner}</svg>"
    )
}

fn read(text: &str) -> Result<Drawing, NamedProblem> {
    Drawing::from_svg("logo.svg", text.as_bytes(), &SvgOptions::default())
}

fn drawn(inner: &str) -> Drawing {
    read(&page(inner)).unwrap()
}

/// The value at a place of the page, y downwards.
fn value(drawing: &Drawing, x: f64, y: f64) -> f64 {
    drawing.value(DVec3::new(x, 100.0 - y, 3.0))
}

/// Looks at the values at places.
fn values(inner: &str, expected: &[(f64, f64, f64)]) {
    let drawing = drawn(inner);
    for (x, y, v) in expected {
        let value = value(&drawing, *x, *y);
        assert!((value - v).abs() < 1e-4, "{inner}: {x} {y} {value} {v}");
    }
    bounds_hold(&drawing, 300);
}

#[test]
fn shapes_are_where_they_are() {
    let rect = "<rect x='10' y='20' width='30' height='40'/>";
    values(
        rect,
        &[(25.0, 40.0, -15.0), (5.0, 40.0, 5.0), (25.0, 15.0, 5.0)],
    );
    let round = "<rect x='10' y='20' width='30' height='40' rx='10'/>";
    let corner = libm::sqrt(200.0) - 10.0;
    values(round, &[(10.0, 20.0, corner), (25.0, 20.0, 0.0)]);
    values("<circle cx='50' cy='50' r='20'/>", &[(50.0, 20.0, 10.0)]);
    values(
        "<ellipse cx='50' cy='50' rx='20' ry='10'/>",
        &[(50.0, 30.0, 10.0), (80.0, 50.0, 10.0)],
    );
    let points = "points='10,10 30,10 30,30 10,30'";
    values(&format!("<polygon {points}/>"), &[(20.0, 20.0, -10.0)]);
    values(&format!("<polyline {points}/>"), &[(10.0, 20.0, 0.0)]);
    // All letters of path data.
    let path = "<path d='M10 10h20v20H10z m30 0 l20,0 0,20 -20 0z M10 50 \
        a10 10 0 0 1 20 0 10 10 0 0 1 -20 0z \
        M50 60 q5-10 10 0 t10 0 l0 10 h-20z'/>";
    values(
        path,
        &[
            (20.0, 20.0, -10.0),
            (50.0, 20.0, -10.0),
            (20.0, 50.0, -10.0),
            (20.0, 65.0, 5.0),
            (60.0, 70.0, 0.0),
            (60.0, 80.0, 10.0),
        ],
    );
    let large = "<path d='M40 50 A10 10 0 1 0 50 40 L50 50z'/>";
    values(
        large,
        &[(50.0, 70.0, 10.0), (70.0, 50.0, 10.0), (45.0, 45.0, 5.0)],
    );
    // Radii that are too small grow, and arcs may be turned.
    let small = "<path d='M30 50 A1 1 0 0 1 70 50 A1 1 90 0 1 30 50'/>";
    values(small, &[(50.0, 25.0, 5.0), (50.0, 80.0, 10.0)]);
}

#[test]
fn rules_styles_and_transforms_count() {
    let ring = "M10 10H50V50H10zM20 20H40V40H20z";
    values(&format!("<path d='{ring}'/>"), &[(30.0, 30.0, -20.0)]);
    for odd in [
        "fill-rule='evenodd'",
        "style='fill-rule: evenodd'",
        "class='odd'",
    ] {
        let sheet = "<style>.odd { fill-rule: evenodd; fill: red }</style>";
        let path = format!("{sheet}<g><path d='{ring}' {odd}/></g>");
        values(&path, &[(30.0, 30.0, 10.0)]);
    }
    let moved = "<g transform='translate(50 50) rotate(90) scale(2)'>\
        <rect width='10' height='5'/></g>";
    values(
        moved,
        &[(45.0, 60.0, -5.0), (50.0, 60.0, 0.0), (45.0, 75.0, 5.0)],
    );
    let skewed = "<rect width='10' height='10' transform='skewX(45)'/>";
    values(skewed, &[(25.0, 10.0, 5.0)]);
    let used = "<defs><rect id='r' width='10' height='10'/></defs>\
        <use href='#r' x='20' y='30'/><use xlink:href='#r' x='60'/>";
    values(
        used,
        &[(25.0, 35.0, -5.0), (65.0, 5.0, -5.0), (15.0, 35.0, 5.0)],
    );
    let symbol = "<symbol id='s' viewBox='0 0 1 1'><rect width='1' \
        height='1'/></symbol><use href='#s' width='20' height='20' y='40'/>";
    values(symbol, &[(10.0, 50.0, -10.0)]);
    let nested = "<svg x='50' y='50' width='50%' height='25' \
        viewBox='0 0 2 2'><circle cx='1' cy='1' r='1'/></svg>";
    values(nested, &[(75.0, 62.5, -12.5), (50.0, 62.5, 12.5)]);
}

#[test]
fn what_cannot_be_seen_is_not_there() {
    let seen = "<rect x='80' y='80' width='10' height='10'/>";
    for hidden in [
        "fill='none'",
        "style='display:none'",
        "visibility='hidden'",
        "opacity='0'",
        "fill-opacity='0'",
        "fill='transparent'",
    ] {
        let rect = format!("<rect width='50' height='50' {hidden}/>{seen}");
        values(&rect, &[(85.0, 60.0, 20.0), (20.0, 80.0, 60.0)]);
    }
}

#[test]
fn clip_paths_are_windows() {
    let clip = |inner: &str, rest: &str| {
        format!(
            "<clipPath id='c' {rest}>{inner}</clipPath><g \
             clip-path='url(#c)'><rect width='80' height='80'/></g>"
        )
    };
    let square = "<rect x='20' y='20' width='20' height='20' fill='none'/>";
    values(
        &clip(square, ""),
        &[(30.0, 30.0, -10.0), (10.0, 30.0, 10.0)],
    );
    let moved = "transform='translate(30)'";
    values(
        &clip(square, moved),
        &[(60.0, 30.0, -10.0), (40.0, 30.0, 10.0)],
    );
    let odd = "<path clip-rule='evenodd' \
        d='M10 10H50V50H10zM20 20H40V40H20z'/>";
    values(&clip(odd, ""), &[(30.0, 30.0, 10.0), (15.0, 30.0, -5.0)]);
    // Of two windows what is in both is seen.
    let two = format!(
        "<clipPath id='d'><rect width='30' height='90'/></clipPath><g \
         clip-path='url(#d)'>{}</g>",
        clip(square, "")
    );
    values(&two, &[(25.0, 30.0, -5.0), (35.0, 30.0, 5.0)]);
    let own = format!(
        "<clipPath id='d'><rect width='30' height='90'/></clipPath>{}",
        clip(square, "clip-path='url(#d)'")
    );
    values(&own, &[(25.0, 30.0, -5.0), (35.0, 30.0, 5.0)]);
    // None of the page's size matters.
    let empty = clip("", "");
    assert!(read(&page(&empty)).is_err());
    let itself = clip(square, "clip-path='url(#c)'");
    let error = read(&page(&itself)).unwrap_err();
    assert!(error.problem().contains("uses itself"));
}

#[test]
fn lines_are_bands() {
    let line = |style: &str| {
        format!(
            "<path d='M20 50H60' fill='none' stroke='black' \
             stroke-width='10' {style}/>"
        )
    };
    let at = [(40.0, 50.0), (15.0, 50.0), (70.0, 45.0)];
    let with = |v: [f64; 3]| -> Vec<(f64, f64, f64)> {
        at.iter().zip(v).map(|((x, y), v)| (*x, *y, v)).collect()
    };
    values(&line(""), &with([-5.0, 5.0, 10.0]));
    values(&line("stroke-linecap='square'"), &with([-5.0, 0.0, 5.0]));
    let round = libm::sqrt(125.0) - 5.0;
    values(&line("stroke-linecap='round'"), &with([-5.0, 0.0, round]));
    let corner = |style: &str| {
        format!(
            "<path d='M20 60V20H60' fill='none' stroke='#000' \
             stroke-width='10' {style}/>"
        )
    };
    let s = libm::sqrt(50.0);
    values(&corner(""), &[(15.0, 15.0, 0.0), (10.0, 10.0, s)]);
    values(
        &corner("stroke-linejoin='round'"),
        &[(15.0, 15.0, s - 5.0), (10.0, 10.0, 2.0 * s - 5.0)],
    );
    values(
        &corner("stroke-linejoin='bevel'"),
        &[(15.0, 15.0, 0.5 * s), (10.0, 10.0, 1.5 * s)],
    );
    // A circle's line: two circles.
    let circle = "<circle cx='50' cy='50' r='30' fill='none' stroke='red' \
        stroke-width='4'/>";
    let drawing = drawn(circle);
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..2000 {
        let p = DVec2::new(random.f64(), random.f64()) * 100.0;
        let far = (p - 50.0).length();
        let expected = (far - 30.0).abs() - 2.0;
        let v = drawing.value(p.extend(0.0));
        assert!((v - expected).abs() < 2e-4, "{p} {v} {expected}");
    }
    bounds_hold(&drawing, 1000);
    // Curves: what is within half a width is inside.
    let curve = "<path d='M20 80C20 0 90 0 50 60S 0 10 90 90' fill='none' \
        stroke='red' stroke-width='6' stroke-linecap='round' \
        stroke-linejoin='round'/>";
    let drawing = drawn(curve);
    let (path, _) =
        super::path::Path::parse("M20 80C20 0 90 0 50 60S 0 10 90 90");
    let points: Vec<DVec2> = path.strands[0]
        .curves
        .iter()
        .flat_map(|c| (0..=20_000).map(|i| c.at(f64::from(i) / 20_000.0)))
        .collect();
    for _ in 0..200 {
        let p = DVec2::new(random.f64(), random.f64()) * 100.0;
        let far = points
            .iter()
            .map(|q| (p - *q).length_squared())
            .fold(f64::INFINITY, f64::min)
            .sqrt();
        let v = value(&drawing, p.x, p.y);
        assert!(
            (v < 0.0) == (far < 3.0) || (far - 3.0).abs() < 1e-4,
            "{p} {v} {far}"
        );
        assert!(far < 3.0 || (v - (far - 3.0)).abs() < 1e-4, "{p} {v} {far}");
    }
    bounds_hold(&drawing, 3000);
}

#[test]
fn units_are_those_of_the_trade() {
    let rect = |root: &str| {
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' {root}>\
             <rect width='48' height='96'/></svg>"
        );
        read(&text).unwrap().bounds()
    };
    let near = |[a, b]: [DVec2; 2], min: [f64; 2], max: [f64; 2]| {
        let off = (a - DVec2::from(min)).abs() + (b - DVec2::from(max)).abs();
        assert!(off.max_element() < 1e-9, "{a} {b}");
    };
    near(rect("width='96' height='96'"), [0.0; 2], [12.7, 25.4]);
    near(rect("width='2in' height='96px'"), [0.0; 2], [12.7, 25.4]);
    near(
        rect("width='192mm' height='192mm' viewBox='0 0 96 96'"),
        [0.0; 2],
        [96.0, 192.0],
    );
    near(rect("viewBox='0 0 96 96'"), [0.0; 2], [12.7, 25.4]);
    near(
        rect("width='100%' viewBox='0 0 96 192'"),
        [0.0, 25.4],
        [12.7, 50.8],
    );
    // The middle of the page, as `viewBox` is by default.
    near(
        rect("width='300mm' height='96mm' viewBox='0 0 96 96'"),
        [102.0, 0.0],
        [150.0, 96.0],
    );
    let options = SvgOptions {
        width_mm: Some(40.0),
        anchor: Anchor::Centre,
        ..SvgOptions::default()
    };
    let text = page("<rect x='7' y='9' width='20' height='10'/>");
    let logo = Drawing::from_svg("a", text.as_bytes(), &options).unwrap();
    near(logo.bounds(), [-20.0, -10.0], [20.0, 10.0]);
    assert_eq!(logo.name(), "svg(\"a\")");
}

#[test]
fn white_is_paper() {
    let text = "<rect width='50' height='50'/>\
        <circle cx='25' cy='25' r='10' fill='#fff'/>";
    values(text, &[(25.0, 25.0, 10.0)]);
    assert!(drawn(text).warnings()[0].contains("white"));
    let options = SvgOptions {
        white: White::Area,
        ..SvgOptions::default()
    };
    let all = Drawing::from_svg("a", page(text).as_bytes(), &options).unwrap();
    assert!((value(&all, 25.0, 25.0) + 25.0).abs() < 1e-9);
    let alone = "<circle cx='25' cy='25' r='10' fill='white'/>";
    values(alone, &[(25.0, 25.0, -10.0)]);
}

#[test]
fn what_is_left_out_is_named() {
    let rect = "<rect width='50' height='50'/>";
    for (what, words) in [
        ("<text x='5' y='5'>Hi</text>", "text"),
        ("<image href='x.png'/>", "image"),
        ("<script>alert(1)</script>", "script"),
        ("<use href='other.svg#x'/>", "another file"),
        ("<use href='#none'/>", "`#none`"),
        ("<path d='M0 0 L5 x'/>", "mistake"),
        ("<rect mask='url(#c)' width='9' height='9'/>", "mask"),
        (
            "<path d='M0 0H9' stroke='red' stroke-dasharray='1'/>",
            "dashes",
        ),
        ("<g transform='spin(4)'><rect/></g>", "transform"),
        (
            "<rect width='9' height='9' style='transform: scale(2)'/>",
            "`transform` of a style",
        ),
        (
            "<rect width='9' height='9' transform='scale(2)' \
             transform-origin='4 4'/>",
            "`transform-origin`",
        ),
        (
            "<style>circle { r: 4px }</style><circle r='3'/>",
            "`r` of a style",
        ),
        (
            "<rect width='9' height='9' style='clip-path: inset(2px)'/>",
            "clip path of a basic shape",
        ),
        (
            "<path d='M0 0H9' stroke='red' \
             vector-effect='non-scaling-stroke'/>",
            "`vector-effect`",
        ),
        (
            "<rect width='20q' height='9'/>",
            "a length that cannot be read",
        ),
        (
            "<polygon points='0,0 9,0 9,9 x 4,4 5,6'/>",
            "a mistake in its points",
        ),
        (
            "<polygon points='0,0 9,0 9,9 4'/>",
            "a mistake in its points",
        ),
        (
            "<svg x='1' y='1' width='5' height='5'><circle r='4'/></svg>",
            "border of an inner svg",
        ),
    ] {
        let drawing = drawn(&format!("{rect}{what}"));
        let warnings = drawing.warnings();
        assert!(
            warnings.len() == 1 && warnings[0].contains(words),
            "{what}: {warnings:?}"
        );
    }
    // What editors write is no reason for warnings.
    let plain = drawn(&format!(
        "<title>x</title><metadata/><defs><linearGradient id='g'/></defs>\
         <g fill='url(#g)' transform-origin='3 3'>{rect}</g>\
         <svg x='1' y='1' width='5' height='5'><rect width='5' height='5'/></svg>\
         <svg width='5' height='5' style='overflow: visible'>\
         <rect width='9' height='5'/></svg>\
         <rect width='9' height='9' transform='scale(2)' \
         transform-origin='0 0' vector-effect='non-scaling-stroke'/>\
         <polyline points='0,0 10-5,3,3\n'/>"
    ));
    assert!(plain.warnings().is_empty(), "{:?}", plain.warnings());
    // The first child that a reader of English sees.
    let switch = drawn(
        "<switch><rect width='9' height='9' systemLanguage='de'/>\
         <rect x='20' width='9' height='9' systemLanguage='fr, en-GB'/>\
         <rect x='40' width='9' height='9'/></switch>",
    );
    let inside = [5.0, 25.0, 45.0].map(|x| value(&switch, x, 5.0) < 0.0);
    assert_eq!(inside, [false, true, false]);
    assert!(switch.warnings().is_empty());
}

#[test]
fn hostile_files_are_refused_with_words() {
    let deep = format!("{}{}", "<g>".repeat(3000), "</g>".repeat(3000));
    let deeper = "<g>".repeat(300_000) + &"</g>".repeat(300_000);
    let bomb: String = (0..20)
        .map(|i| {
            format!(
                "<g id='b{}'><use href='#b{i}'/><use href='#b{i}'/></g>",
                i + 1
            )
        })
        .collect();
    let bomb = format!("<rect id='b0' width='1' height='1'/>{bomb}");
    let many = format!("<path d='{}'/>", "M0 0H5V5z".repeat(100_000));
    let star: String = {
        let mut random = fastrand::Rng::with_seed(6);
        (0..60_000)
            .map(|_| format!("{:.3} {:.3} ", random.f64(), random.f64()))
            .collect()
    };
    let star = format!("<polygon points='{star}'/>");
    let laughs: String = (1..12)
        .map(|i| {
            let each = format!("&l{};", i - 1).repeat(10);
            format!("<!ENTITY l{i} '{each}'>")
        })
        .collect();
    let laughs = format!(
        "<!DOCTYPE svg [<!ENTITY l0 'ha'>{laughs}]><svg><text>&l11;</text>\
         </svg>"
    );
    let external = "<!DOCTYPE svg [<!ENTITY x SYSTEM \
        'file:///etc/passwd'>]><svg><path d='&x;'/></svg>";
    let cases: Vec<(&str, String, &str)> = vec![
        ("nothing", String::new(), "no XML"),
        ("text", "solid cube".into(), "no XML"),
        ("cut off", "<svg><path d='M0 0".into(), "no XML"),
        ("html", "<html></html>".into(), "no SVG"),
        ("empty", page(""), "nothing in it is an area"),
        ("line", page("<path d='M0 0L50 50'/>"), "nothing in it"),
        ("deep", page(&deep), "deep"),
        ("deeper", page(&deeper), "deep"),
        (
            "use of itself",
            page("<g id='a'><use href='#a'/></g>"),
            "uses itself",
        ),
        (
            "use in a circle",
            page(
                "<g id='a'><use href='#b'/></g><g id='b'><use \
                 href='#a'/></g>",
            ),
            "uses itself",
        ),
        ("use bomb", page(&bomb), "200000 elements"),
        ("many curves", page(&many), "lines and curves"),
        ("star", page(&star), "cross one another too often"),
        ("laughs", laughs, "no XML"),
        ("external", external.into(), "no XML"),
        (
            "infinite",
            page("<rect width='1e999' height='5'/>"),
            "nothing in",
        ),
        ("far", page("<rect width='1e30' height='5'/>"), "1 km"),
        (
            "NaN",
            page("<rect width='NaN' height='5'/>"),
            "nothing in it",
        ),
        (
            "no size",
            "<svg width='0' height='5'><rect/></svg>".into(),
            "size",
        ),
        ("only text", page("<text>Hi</text>"), "turn it into paths"),
        (
            "rules",
            page(&format!("<style>{}</style>", "a{fill:red}".repeat(2000))),
            "1000 rules",
        ),
    ];
    for (what, text, words) in cases {
        let error = read(&text).map(|_| ()).unwrap_err().to_string();
        assert!(
            error.starts_with("logo.svg: ") && error.contains(words),
            "{what}: {error}"
        );
    }
    let zipped = b"\x1f\x8b\x08";
    let options = SvgOptions::default();
    let error = Drawing::from_svg("a", zipped, &options).unwrap_err();
    assert!(error.problem().contains("SVGZ"));
}

#[test]
fn any_text_does_no_harm() {
    let good = page(
        "<style>.a{fill:red}</style><g transform='rotate(5 1 2)'><path \
         class='a' stroke='red' d='M5 5c1 2 3 4 5 6a5 5 0 0 1 9 9z'/><circle \
         id='c' r='5'/><use href='#c' x='9'/></g>",
    );
    let mut random = fastrand::Rng::with_seed(3);
    let letters = b"<>/='\"0123456789.-e aMzC#%&";
    for _ in 0..4000 {
        let mut bad = good.clone().into_bytes();
        for _ in 0..random.usize(1..6) {
            let at = random.usize(200..bad.len());
            bad[at] = letters[random.usize(..letters.len())];
        }
        let options = SvgOptions::default();
        if let Ok(drawing) = Drawing::from_svg("a", &bad, &options) {
            let _ = drawing.at(DVec3::new(3.0, 90.0, 0.0));
        }
    }
}

#[test]
fn style_sheets_that_would_take_long_are_refused() {
    let square = "<path d='M0 0H10V10H0Z'/>";
    let deep = format!("{}{square}{}", "<g>".repeat(60), "</g>".repeat(60));
    let refused = |inner: &str, wanted: &str| {
        let e = read(&page(inner)).unwrap_err().to_string();
        assert!(e.contains(wanted), "{e}");
    };
    // Whether this matches takes 60 over 24 steps.
    let long = format!("x {} path", "* ".repeat(24));
    let sheet = format!("<style>{long}{{fill:red}}</style>{deep}");
    refused(&sheet, "`x * * *");
    let most = "g > g + g > g g g g path{fill:none}";
    drawn(&format!("<style>{most}</style>{square}"));
    // Rules, and how they are written: one sheet, many, and a list.
    let rules: Vec<String> =
        (0..20_000).map(|i| format!(".c{i}{{fill:red}}")).collect();
    let one = format!("<style>{}</style>{square}", rules.concat());
    refused(&one, "more than 1000 rules");
    let sheet = |rule: &String| format!("<style>{rule}</style>");
    let many: String = rules.iter().map(sheet).collect();
    refused(&(many + square), "more than 1000 rules");
    let list = vec![".a"; 20_000].join(",");
    refused(
        &format!("<style>{list}{{fill:red}}</style>{square}"),
        "more than 1000 rules",
    );
    let large = "/* */".repeat(1 << 20);
    refused(&format!("<style>{large}</style>{square}"), "4 MB");
}
