//! Level sets, what they ask for, and where they are put.

use super::functions::{function, node};
use super::*;

/// A cube of 4 mm around the origin, as object 7.
fn around() -> String {
    let mut text = cube_object(7, "");
    for axis in ["x", "y", "z"] {
        text = text
            .replace(&format!("{axis}=\"1\""), &format!("{axis}=\"2\""))
            .replace(&format!("{axis}=\"0\""), &format!("{axis}=\"-2\""));
    }
    text
}

fn level(more: &str) -> String {
    format!(
        "{}<object id=\"1\"><v:levelset functionid=\"5\" channel=\"shape\" \
         meshid=\"7\" {more}/></object>",
        around()
    )
}

/// A ball of 2.5 mm.
fn ball() -> String {
    let nodes = node("constant value=\"2.5\"", "r", "", "scalar:value")
        + &node("length", "l", "vector:A=inputs.pos", "scalar:result")
        + &node(
            "subtraction",
            "n",
            "scalar:A=l.result scalar:B=r.value",
            "scalar:result",
        );
    function(5, &nodes, "n.result")
}

fn body(resources: &str, item: &str) -> Body {
    let bytes = package(&model("millimeter", resources, item));
    of(&bytes).unwrap()
}

#[track_caller]
fn is_at(body: &Body, p: [f64; 3], wanted: f64) {
    let found = value(body, p.into());
    assert!((found - wanted).abs() < 1e-5, "{p:?}: {found}");
}

#[test]
fn level_sets_lie_in_their_mesh() {
    let body = body(&(ball() + &level("")), ITEM);
    assert!(body.notes.is_empty());
    is_at(&body, [0.0, 0.0, 0.0], -2.0);
    is_at(&body, [1.9, 0.0, 0.0], -0.1);
    is_at(&body, [1.9, 1.9, 1.9], 3f64.sqrt() * 1.9 - 2.5);
    // A box needs no mesh.
    assert!(body.data.is_empty());
}

/// Without a corner the mesh is no box, unless only the box around it counts.
#[test]
fn the_box_around_a_mesh_may_count() {
    let cut = |more: &str| {
        let all = ball() + &level(more);
        // The corner (2, 2, 2) moves to (0, 0, 0).
        all.replace(
            "<vertex x=\"2\" y=\"2\" z=\"2\"/>",
            "<vertex x=\"0\" y=\"0\" z=\"0\"/>",
        )
    };
    let mesh = body(&cut(""), ITEM);
    assert_eq!(mesh.data.len(), 1);
    assert!(value(&mesh, DVec3::ONE) > 0.1);
    let whole = body(&cut("meshbboxonly=\"true\""), ITEM);
    assert!(whole.data.is_empty());
    assert!(value(&whole, DVec3::ONE) < -0.1);
}

/// Eight corners of a box and twelve triangles are no box yet: an edge that is
/// turned cuts a wedge off.
#[test]
fn a_box_with_a_turned_edge_is_no_box() {
    let text = |[a, b, c]: [u32; 3]| {
        format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\" />")
    };
    let turns = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]];
    let flat = |corners: [u32; 4]| {
        let [first, rest @ ..] = corners.map(corner);
        (0..3).any(|k| rest.iter().all(|p| p[k] == first[k]))
    };
    let faces = faces();
    let pairs = faces
        .iter()
        .flat_map(|f| faces.iter().map(move |g| (*f, *g)));
    let [(f, g), ..] = pairs
        .flat_map(|(f, g)| {
            let all = turns(f).into_iter();
            all.flat_map(move |a| turns(g).map(|b| (a, b)))
        })
        .filter(|(f, g)| f[..2] == [g[1], g[0]])
        .filter(|(f, g)| !flat([f[0], f[1], f[2], g[2]]))
        .take(1)
        .collect::<Vec<_>>()[..]
    else {
        panic!("no edge");
    };
    let of_cube = |wanted: [u32; 3]| {
        let own = faces.iter().find(|face| turns(**face).contains(&wanted));
        text(*own.unwrap())
    };
    let turned = (ball() + &level(""))
        .replacen(&of_cube(f), &text([f[0], g[2], f[2]]), 1)
        .replacen(&of_cube(g), &text([g[2], f[1], f[2]]), 1);
    assert_eq!(body(&turned, ITEM).data.len(), 1);
    assert!(body(&(ball() + &level("")), ITEM).data.is_empty());
}

#[test]
fn level_sets_are_placed_and_transformed() {
    let moved = level("transform=\"1 0 0 0 1 0 0 0 1 -1 0 0\"");
    let item = "<item objectid=\"1\" transform=\"0 3 0 -3 0 0 0 0 3 0 0 10\"/>\
                <item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 50 0 0\"/>";
    let body = body(&(ball() + &moved), item);
    // The ball's middle is at x = 1 of the object, and x goes to y.
    is_at(&body, [0.0, 3.0, 10.0], -3.0);
    is_at(&body, [0.0, -4.5, 10.0], 0.0);
    is_at(&body, [51.0, 0.0, 0.0], -1.0);
}

#[test]
fn what_is_undefined_has_the_fallback() {
    let nodes = node("log", "n", "scalar:A=p.x", "scalar:result");
    let log = function(5, &nodes, "n.result");
    let usual = body(&(log.clone() + &level("")), ITEM);
    is_at(&usual, [0.5, 0.0, 0.0], 0.5f64.ln());
    // Also if it is no number.
    let there = value(&usual, DVec3::new(-0.5, 0.0, 0.0));
    assert!(there.is_nan() || there >= 0.0);
    let filled = body(&(log + &level("fallbackvalue=\"-3\"")), ITEM);
    is_at(&filled, [0.5, 0.0, 0.0], 0.5f64.ln());
    is_at(&filled, [-0.5, 0.0, 0.0], -1.5);
    is_at(&filled, [0.0, 0.0, 0.0], -2.0);
}

/// The least of two numbers is undefined where one of them is.
#[test]
fn what_is_undefined_takes_nothing_off_other_bodies() {
    let nodes = node("log", "n", "scalar:A=p.x", "scalar:result");
    let all =
        function(5, &nodes, "n.result") + &level("") + &cube_object(9, "");
    let items = "<item objectid=\"1\"/>\
                 <item objectid=\"9\" transform=\"1 0 0 0 1 0 0 0 1 -9 0 0\"/>";
    let both = body(&all, items);
    is_at(&both, [-8.5, 0.5, 0.5], -0.5);
    is_at(&both, [0.5, 0.0, 0.0], 0.5f64.ln());
}

#[test]
fn functions_ask_for_meshes() {
    for (kind, inside) in [("mesh", -0.5), ("unsignedmesh", 0.5)] {
        let nodes =
            node("constresourceid value=\"7\"", "m", "", "resourceid:v")
                + &node(
                    kind,
                    "n",
                    "vector:pos=inputs.pos resource:mesh=m.v",
                    "scalar:distance",
                );
        let tree = function(5, &nodes, "n.distance");
        let body = body(&(tree + &level("")), ITEM);
        assert_eq!(body.data.len(), 1);
        is_at(&body, [1.5, 0.0, 0.0], inside);
        is_at(&body, [3.0, 0.0, 0.0], 1.0);
    }
}

/// A picture of two columns and two rows.
fn png(colours: png::ColorType, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(colours);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
    writer.finish().unwrap();
    bytes
}

fn stack(sheets: &[&[u8]], more: &str, level: &str) -> Vec<u8> {
    let names: Vec<String> =
        (0..sheets.len()).map(|i| format!("v/{i}.png")).collect();
    let listed: String = names
        .iter()
        .map(|name| format!("<v:imagesheet path=\"/{name}\"/>"))
        .collect();
    let resources = format!(
        "<v:image3d id=\"3\"><v:imagestack rowcount=\"2\" columncount=\"2\" \
         sheetcount=\"2\">{listed}</v:imagestack></v:image3d>\
         <v:functionfromimage3d id=\"5\" image3did=\"3\" {more}/>{level}"
    );
    let model = model("millimeter", &resources, ITEM);
    let mut files: Vec<(&str, &[u8])> = vec![(ROOT, model.as_bytes())];
    files.extend(names.iter().map(String::as_str).zip(sheets.iter().copied()));
    archive_of(&files)
}

#[test]
fn functions_are_of_stacks_of_pictures() {
    use png::ColorType::{Grayscale, Rgba};
    // The first row is on top.
    let low = png(Grayscale, &[0, 51, 102, 153]);
    let high = png(
        Rgba,
        &[255, 1, 2, 3, 255, 5, 6, 7, 255, 9, 10, 11, 255, 13, 14, 15],
    );
    let level = |channel: &str| {
        level("").replace("\"shape\"", &format!("\"{channel}\""))
    };
    let more = "tilestyleu=\"clamp\" tilestylev=\"clamp\" tilestylew=\"clamp\" \
                valuescale=\"10\" valueoffset=\"-20\"";
    let at = |more: &str, channel: &str, p: [f64; 3]| {
        let bytes = stack(&[&low, &high], more, &level(channel));
        value(&of(&bytes).unwrap(), p.into())
    };
    // Values below those of the box are as in the pictures.
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-4, "{a} {b}");
    let shifted = "valuescale=\"1\" valueoffset=\"0\" tilestyleu=\"clamp\" \
                   tilestylev=\"clamp\" tilestylew=\"clamp\"";
    near(at(shifted, "red", [0.25, 0.75, 0.25]), 0.0);
    near(at(shifted, "red", [0.75, 0.75, 0.25]), 0.2);
    near(at(shifted, "blue", [0.25, 0.25, 0.25]), 0.4);
    near(at(shifted, "red", [0.75, 0.25, 0.0]), 0.6);
    near(at(shifted, "red", [0.5, 0.25, 0.25]), 0.5);
    near(at(shifted, "red", [0.75, 0.75, 0.5]), 0.6);
    near(at(shifted, "alpha", [0.75, 0.75, 0.25]), 1.0);
    near(at(shifted, "alpha", [0.25, 0.25, 1.0]), 11.0 / 255.0);
    near(at(shifted, "green", [0.75, 0.75, 0.75]), 5.0 / 255.0);
    // Below −1.2, the box says more.
    near(at(more, "red", [0.75, 0.75, 0.25]), -1.25);
    let nearest = "filter=\"nearest\"";
    near(at(nearest, "red", [0.6, 0.4, 0.1]), 0.6);
    // Usually stacks repeat.
    near(at("", "red", [1.75, -0.25, 0.25]), 0.2);
    let mirrored = "tilestyleu=\"mirror\"";
    near(at(mirrored, "red", [1.75, 0.75, 0.25]), 0.0);
    // What is wrong has its place.
    let one = stack(&[&low], more, &level("red"));
    let said = of(&one).unwrap_err().to_string();
    assert!(said.contains("a stack of 2 sheets names 1"), "{said}");
    let broken = stack(&[&low, &high[..40]], more, &level("red"));
    let said = of(&broken).unwrap_err().to_string();
    assert!(said.contains("/v/1.png: no sound PNG"), "{said}");
    let absent = stack(&[&low, &high], more, &level("pink"));
    let said = of(&absent).unwrap_err().to_string();
    assert!(said.contains("function 5: it has no output pink"), "{said}");
}

/// Two functions that scale one stack differently read its numbers once.
#[test]
fn a_stack_is_unpacked_once_for_all_functions_that_read_it_alike() {
    let sheet = png(png::ColorType::Grayscale, &[0, 51, 102, 153]);
    let first = level("")
        .replace("\"shape\"", "\"red\"")
        .replace("id=\"1\"", "id=\"11\"");
    let second = "<object id=\"12\"><v:levelset functionid=\"6\" \
                  channel=\"red\" meshid=\"7\"/></object>";
    let data = |more: &str| {
        let level = format!(
            "<v:functionfromimage3d id=\"6\" image3did=\"3\" {more}/>\
             {first}{second}<object id=\"1\"><components>\
             <component objectid=\"11\"/><component objectid=\"12\"/>\
             </components></object>"
        );
        of(&stack(&[&sheet, &sheet], "", &level))
            .unwrap()
            .data
            .len()
    };
    assert_eq!(data("valuescale=\"3\""), 1);
    assert_eq!(data("tilestyleu=\"mirror\""), 2);
}

#[test]
fn wrong_level_sets_are_refused_with_the_reason() {
    let all = ball() + &level("");
    let sheet = "<v:image3d id=\"3\"><v:imagestack rowcount=\"1\" \
                 columncount=\"1\" sheetcount=\"1\"><v:imagesheet/>\
                 </v:imagestack></v:image3d>";
    let stack = |size: &str| {
        sheet.replace("columncount=\"1\"", &format!("columncount=\"{size}\""))
    };
    let image = "<v:functionfromimage3d id=\"5\" image3did=\"4\"/>";
    let cases = [
        (
            all.replace("functionid=\"5\"", ""),
            "no attribute functionid",
        ),
        (
            all.replace("functionid=\"5\"", "functionid=\"6\""),
            "function 6: it is",
        ),
        (all.replace("channel=\"shape\"", ""), "no attribute channel"),
        (
            all.replace("channel=\"shape\"", "channel=\"a\""),
            "no output a",
        ),
        (all.replace("meshid=\"7\"", ""), "no attribute meshid"),
        (
            all.replace("meshid=\"7\"", "meshid=\"8\""),
            "object 8: it is named",
        ),
        (
            all.replace("meshid=\"7\"", "meshid=\"1\""),
            "lies in its own object",
        ),
        (
            all.replace("meshid=\"7\"", "meshid=\"7\" transform=\"1\""),
            "twelve finite numbers",
        ),
        (
            all.replace("meshid=\"7\"", "meshid=\"9\"") + "<object id=\"9\"/>",
            "object 9: it has no triangles",
        ),
        (
            all.replace("</object>", "<v:levelset/></object>"),
            "no attribute functionid",
        ),
        ("<v:levelset/>".to_owned(), "part of no object"),
        ("<v:imagestack/>".to_owned(), "part of no image3d"),
        ("<v:imagesheet/>".to_owned(), "part of no stack"),
        (
            "<v:volumedata id=\"2\"><v:boundary/></v:volumedata>".to_owned(),
            "earlier draft",
        ),
        (sheet.to_owned(), "it has no path"),
        (stack("0"), "it has no pixels"),
        (stack("18446744073709551615"), "more than 268 million"),
        (stack("1073741824"), "more than 268 million pixels"),
        (stack("-1"), "columncount is \"-1\""),
        (image.to_owned(), "no image3d 4 above it"),
        (
            image.replace("/>", " filter=\"soft\"/>"),
            "\"soft\" is no filter",
        ),
        (
            image.replace("/>", " tilestylev=\"a\"/>"),
            "\"a\" is no style",
        ),
        (image.replace("/>", " valuescale=\"inf\"/>"), "not finite"),
    ];
    for (resources, why) in cases {
        let bytes = package(&model("millimeter", &resources, ITEM));
        let said = match of(&bytes) {
            Ok(body) => format!("{body:?}"),
            Err(e) => e.to_string(),
        };
        assert!(said.contains(why), "{why:?}: {said:?}");
    }
    let flat = "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 0 0 0 0\"/>";
    let bytes = package(&model("millimeter", &all, flat));
    let said = of(&bytes).unwrap_err().to_string();
    assert!(
        said.contains("object 1: its transform makes it flat"),
        "{said}"
    );
}
