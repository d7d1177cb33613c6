use crate::tests::bounds_hold;
use crate::{Align, Drawing, TextOptions, Vertical};
use glam::{DVec2, DVec3};
use isocontour::Data;

const OWN: &[u8] = include_bytes!("../../fonts/DejaVuSans.ttf");

fn text(text: &str, size_mm: f64) -> Drawing {
    let options = TextOptions {
        size_mm,
        ..TextOptions::default()
    };
    Drawing::from_text(text, None, &options).unwrap()
}

#[test]
fn letters_are_where_the_font_has_them() {
    // l is a bar from 193 to 377 and 0 to 1556, of 2048 units an em; its width
    // is 569.
    let l = text("l", 204.8);
    let [min, max] = l.bounds();
    let near = |a: DVec2, x: f64, y: f64| {
        assert!((a - DVec2::new(x, y)).length() < 1e-9, "{a}");
    };
    near(min, 19.3, 0.0);
    near(max, 37.7, 155.6);
    let value = l.value(DVec3::new(30.0, 50.0, 0.0));
    assert!((value + 7.7).abs() < 1e-9, "{value}");
    near(text("ll", 204.8).bounds()[1], 37.7 + 56.9, 155.6);
    bounds_hold(&l, 1000);
}

#[test]
fn pairs_are_kerned() {
    let width = |s: &str| {
        let [min, max] = text(s, 10.0).bounds();
        max.x - min.x
    };
    // V is moved under A.
    let (av, va) = (width("AV"), width("A") + width("V"));
    assert!(av < va - 0.2, "{av} {va}");
}

/// Against many points of the curves.
#[test]
fn letters_are_curves() {
    let drawn = text("Ø 12 &ß§8", 60.0);
    let font = super::font::Font::new(None).unwrap();
    let mut outline = crate::Outline::default();
    let options = TextOptions::default();
    let (letters, _) = super::lay_out(
        "Ø 12 &ß§8",
        &font,
        60.0 / font.em,
        &options,
        &mut vec![],
    );
    for (letter, x) in letters {
        let from = DVec2::new(x, 0.0);
        font.draw(letter, from, 60.0 / font.em, &mut outline)
            .unwrap();
    }
    let n = 4000;
    let dense: Vec<DVec2> = outline
        .curves()
        .iter()
        .flat_map(|c| (0..n).map(|i| c.at(f64::from(i) / f64::from(n))))
        .collect();
    let [min, max] = drawn.bounds();
    let mut random = fastrand::Rng::with_seed(5);
    for _ in 0..200 {
        let p = min - 5.0
            + (max - min + 10.0) * DVec2::new(random.f64(), random.f64());
        let near = |q: &DVec2| (p - *q).length_squared();
        let far = dense.iter().map(near).fold(f64::INFINITY, f64::min).sqrt();
        let value = drawn.value(p.extend(0.0)).abs();
        // A point of the curve is within 0.006 mm of one of the dense ones.
        let off = far - value;
        assert!(off > -1e-9 && off < 3.6e-5 / far, "{p} {value} {far}");
    }
    bounds_hold(&drawn, 20_000);
}

#[test]
fn lines_are_placed() {
    let bounds = |align, vertical| {
        let options = TextOptions {
            size_mm: 20.48,
            align,
            vertical,
            line_mm: Some(30.0),
            spacing_mm: 0.0,
        };
        Drawing::from_text("l\nll", None, &options)
            .unwrap()
            .bounds()
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
    let [min, max] = bounds(Align::Left, Vertical::Base);
    near(min.x, 1.93);
    near(min.y, -30.0);
    near(max.y, 15.56);
    let [min, max] = bounds(Align::Right, Vertical::Top);
    near(max.x, -1.92);
    near(max.y, 0.0);
    near(min.y, -45.56);
    let [min, max] = bounds(Align::Centre, Vertical::Centre);
    near(min.x, 1.93 - 5.69);
    near(max.x, -1.92 + 5.69);
    near(min.y, -max.y);
    let [min, _] = bounds(Align::Centre, Vertical::Bottom);
    near(min.y, 0.0);
}

#[test]
fn what_cannot_be_drawn_is_named() {
    let warnings = |s: &str| {
        let drawing = text(s, 10.0);
        drawing.warnings().to_vec()
    };
    assert!(warnings("Größe Ω Ж → ⌀").is_empty());
    assert!(warnings("a中")[0].contains('中'));
    assert!(warnings("aם").iter().any(|w| w.contains("not joined")));
    let error = |s: &str, font: Option<&[u8]>, size_mm: f64| {
        let options = TextOptions {
            size_mm,
            ..TextOptions::default()
        };
        let made = Drawing::from_text(s, font, &options);
        made.map(|_| ()).unwrap_err().to_string()
    };
    assert!(error("中", None, 10.0).contains("give a font file"));
    assert!(error(" \n", None, 10.0).contains("nothing in it"));
    assert!(error("a", None, 0.0).contains("size"));
    assert!(error("a", None, f64::NAN).contains("size"));
    assert!(error(&"a".repeat(20_000), None, 1.0).contains("in parts"));
    assert!(error("a", Some(b"wOF2"), 1.0).contains("WOFF"));
    assert!(error("a", Some(b"hello"), 1.0).contains("TTF or OTF"));
    assert!(error("a", Some(&[]), 1.0).contains("TTF or OTF"));
}

#[test]
fn broken_fonts_do_no_harm() {
    let mut random = fastrand::Rng::with_seed(1);
    let options = TextOptions::default();
    for round in 0..1500 {
        let mut bad = OWN.to_vec();
        // Tables' directory, or anywhere.
        let end = if round % 2 == 0 { 300 } else { bad.len() };
        for _ in 0..random.usize(1..40) {
            bad[random.usize(..end)] = random.u8(..);
        }
        if round % 5 == 0 {
            bad.truncate(random.usize(..bad.len()));
        }
        let _ = Drawing::from_text("AVé8", Some(&bad), &options);
    }
}
