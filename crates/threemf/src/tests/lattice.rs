//! Beam lattices.

use super::*;

/// Three beams along the axes from the origin, 10 mm long, with a ball and sets.
pub(super) fn object(id: u32, more: &str) -> String {
    beams(
        id,
        more,
        "<b:beam v1=\"0\" v2=\"1\"/>\
         <b:beam v1=\"0\" v2=\"2\" r1=\"0.5\" cap2=\"butt\"/>\
         <b:beam v1=\"0\" v2=\"3\" r1=\"2\" r2=\"1\" cap1=\"hemisphere\"/>",
    )
}

fn beams(id: u32, more: &str, beams: &str) -> String {
    format!(
        "<object id=\"{id}\"><mesh><vertices>\
         <vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"10\" y=\"0\" z=\"0\"/>\
         <vertex x=\"0\" y=\"10\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"10\"/>\
         </vertices><b:beamlattice radius=\"1\" minlength=\"0.001\" {more}>\
         <b:beams>{beams}</b:beams>\
         <b2:balls><b2:ball vindex=\"1\"/><b2:ball vindex=\"2\" r=\"3\"/></b2:balls>\
         <b:beamsets><b:beamset name=\"a\"><b:ref index=\"0\"/></b:beamset>\
         </b:beamsets></b:beamlattice></mesh></object>"
    )
}

fn body(resources: &str, items: &str) -> Body {
    of(&package(&model("millimeter", resources, items))).unwrap()
}

#[track_caller]
fn is_at(body: &Body, p: [f64; 3], distance: f64) {
    let found = value(body, p.into());
    assert!((found - distance).abs() < 1e-5, "{p:?}: {found}");
}

#[test]
fn beams_have_their_radii_and_ends() {
    let body = body(&object(1, "cap=\"sphere\""), ITEM);
    assert_eq!(body.data.len(), 1);
    assert!(body.notes.is_empty());
    // The first one has the lattice's radius and ends.
    is_at(&body, [5.0, 0.0, 3.0], 2.0);
    is_at(&body, [13.0, 0.0, 0.0], 2.0);
    // The second one is thinner, and flat at its end.
    is_at(&body, [-2.5, 5.0, 0.0], 2.0);
    is_at(&body, [0.0, 12.0, 0.25], 2.0);
    is_at(&body, [0.0, 12.0, 1.5], 5f64.sqrt());
    // The third one is a cone, 1.5 thick in the middle.
    is_at(&body, [0.0, 0.0, 13.0], 2.0);
    is_at(&body, [-1.5, 0.0, 5.0], 0.0);
    is_at(&body, [-3.5, 0.0, 5.0], 2.0 * (1.01f64).sqrt().recip());
    // At its thick end a hemisphere does not stand out of its side.
    is_at(&body, [-1.9, 0.0, 1.0], 0.0);
}

#[test]
fn balls_are_as_the_mode_says() {
    let radius = "b2:ballradius=\"2\"";
    let none = body(&object(1, radius), ITEM);
    is_at(&none, [13.0, 0.0, 0.0], 2.0);
    let listed =
        body(&object(1, &format!("{radius} b2:ballmode=\"mixed\"")), ITEM);
    is_at(&listed, [13.0, 0.0, 0.0], 1.0);
    is_at(&listed, [0.0, 14.0, 0.0], 1.0);
    is_at(&listed, [0.0, 0.0, 13.0], 2.0);
    let all = body(&object(1, &format!("{radius} b2:ballmode=\"all\"")), ITEM);
    is_at(&all, [13.0, 0.0, 0.0], 1.0);
    is_at(&all, [0.0, 14.0, 0.0], 1.0);
    is_at(&all, [0.0, 0.0, 13.0], 1.0);
}

#[test]
fn lattices_are_placed_with_their_radii() {
    let resources = object(1, "")
        + "<object id=\"2\"><components><component objectid=\"1\" \
           transform=\"0 2 0 -2 0 0 0 0 2 0 0 5\"/></components></object>";
    let body = body(
        &resources,
        "<item objectid=\"2\"/><item objectid=\"1\" \
         transform=\"-1 0 0 0 1 0 0 0 1 -50 0 0\"/>",
    );
    // All struts are one leaf.
    assert_eq!(body.data.len(), 1);
    is_at(&body, [0.0, 10.0, 11.0], 4.0);
    is_at(&body, [-55.0, 0.0, 3.0], 2.0);
}

#[test]
fn uneven_scales_make_ellipses() {
    let body = body(
        &object(1, ""),
        "<item objectid=\"1\" transform=\"1 0 0 0 3 0 0 0 1 0 0 0\"/>",
    );
    assert!(value(&body, DVec3::new(8.0, 2.9, 0.0)) < 0.0);
    assert!(value(&body, DVec3::new(8.0, 3.1, 0.0)) > 0.0);
    assert!(value(&body, DVec3::new(8.0, 0.0, 0.9)) < 0.0);
    // It is never farther than it says.
    let far = value(&body, DVec3::new(8.0, 0.0, 4.0));
    assert!(far > 0.5 && far <= 3.0, "{far}");
}

#[test]
fn lattices_are_clipped_by_meshes() {
    // The cube reaches to 1 along each axis, or to 2.
    for (place, by) in [
        ("1 0 0 0 1 0 0 0 1 0 0 0", 1.0),
        ("2 0 0 0 2 0 0 0 2 0 0 0", 2.0),
        ("2 0 0 0 1 0 0 0 1 0 0 0", 2.0),
    ] {
        let item = format!("<item objectid=\"1\" transform=\"{place}\"/>");
        let clip = |mode: &str| {
            let more = format!("clippingmode=\"{mode}\" clippingmesh=\"7\"");
            body(&(cube_object(7, "") + &object(1, &more)), &item)
        };
        let (inside, outside) = (clip("inside"), clip("outside"));
        for (x, is_in) in [(0.9, true), (1.1, false), (-0.5, false)] {
            let p = DVec3::new(x * by, 0.1, 0.1);
            assert_eq!(value(&inside, p) < 0.0, is_in, "{place} {x}");
            assert_eq!(value(&outside, p) < 0.0, !is_in, "{place} {x}");
        }
    }
}

#[test]
fn triangles_and_beams_are_one_body() {
    let thin = object(1, "").replace("r1=\"2\" r2=\"1\"", "r1=\"0.3\"");
    let with_cube = thin.replace(
        "</vertices>",
        &cube_mesh()
            .replace("<mesh><vertices>", "")
            .replace("</mesh>", "")
            // Its vertices follow four others.
            .replace("\"7\"", "\"11\"")
            .replace("\"6\"", "\"10\"")
            .replace("\"5\"", "\"9\"")
            .replace("\"4\"", "\"8\"")
            .replace("v1=\"3\"", "v1=\"7\"")
            .replace("v2=\"3\"", "v2=\"7\"")
            .replace("v3=\"3\"", "v3=\"7\"")
            .replace("=\"2\"", "=\"6\"")
            .replace("v1=\"1\"", "v1=\"5\"")
            .replace("v2=\"1\"", "v2=\"5\"")
            .replace("v3=\"1\"", "v3=\"5\"")
            .replace("v1=\"0\"", "v1=\"4\"")
            .replace("v2=\"0\"", "v2=\"4\"")
            .replace("v3=\"0\"", "v3=\"4\""),
    );
    let body = body(&with_cube, ITEM);
    assert_eq!(body.data.len(), 2);
    assert_eq!(extent(&body), unit_cube());
    is_at(&body, [5.0, 0.0, 3.0], 2.0);
    is_at(&body, [0.9, 0.9, 1.5], 0.5);
}

#[test]
fn short_beams_are_ignored() {
    let text = object(1, "").replace("0.001", "11");
    let error = of(&package(&model("millimeter", &text, ITEM))).unwrap_err();
    let left = "nothing is left to build: its beams are too short";
    assert!(error.to_string().contains(left), "{error}");
    let longer = text.replace("x=\"10\"", "x=\"12\"");
    let body = body(&longer, ITEM);
    assert_eq!(
        body.notes,
        ["left out 2 beams that are shorter than their lattice allows"]
    );
    is_at(&body, [0.0, 5.0, 0.0], 4.0);
}

/// The specification allows radii of 0.
#[test]
fn beams_and_balls_of_no_thickness_are_left_out() {
    let text = object(1, "b2:ballmode=\"mixed\" b2:ballradius=\"0\"")
        .replace("r1=\"0.5\"", "r1=\"0\"");
    let body = body(&text, ITEM);
    assert_eq!(body.notes, ["left out 2 beams or balls of no thickness"]);
    is_at(&body, [5.0, 0.0, 0.0], -1.0);
    // An end may be sharp.
    let cone = object(1, "").replace("r1=\"0.5\"", "r1=\"0\" r2=\"1\"");
    of(&package(&model("millimeter", &cone, ITEM))).unwrap();
}

#[test]
fn wrong_lattices_are_refused_with_the_reason() {
    let beam = |beam: &str| beams(1, "", beam);
    let cases = [
        (beam("<b:beam v1=\"0\" v2=\"4\"/>"), "names vertex 4"),
        (beam("<b:beam v1=\"0\"/>"), "no attribute v2"),
        (beam("<b:beam v1=\"1\" v2=\"1\"/>"), "vertex 1 to itself"),
        (
            beam("<b:beam v1=\"0\" v2=\"1\" r2=\"1\"/>"),
            "r2 without r1",
        ),
        (beam("<b:beam v1=\"0\" v2=\"1\" r1=\"-1\"/>"), "no length"),
        (beam("<b:beam v1=\"0\" v2=\"1\" r1=\"nan\"/>"), "no length"),
        (
            beam("<b:beam v1=\"0\" v2=\"1\" r1=\"1e30\"/>"),
            "thicker than",
        ),
        (
            beam("<b:beam v1=\"0\" v2=\"1\" r1=\"0\"/>"),
            "nothing is left to build: its beams are too short or have no",
        ),
        (
            beam("<b:beam v1=\"0\" v2=\"1\" cap1=\"hat\"/>"),
            "no end of",
        ),
        (object(1, "b2:ballmode=\"some\""), "no mode of balls"),
        (object(1, "b2:ballmode=\"all\""), "without a radius"),
        (object(1, "b2:ballmode=\"mixed\""), "ball 0: neither"),
        (
            object(1, "b2:ballmode=\"mixed\" b2:ballradius=\"1\"")
                .replace("vindex=\"2\"", "vindex=\"3\"")
                .replace("v2=\"3\"", "v2=\"2\""),
            "ball 1: no beam ends",
        ),
        (object(1, "clippingmode=\"round\""), "no mode of clipping"),
        (
            object(1, "clippingmode=\"inside\""),
            "attribute clippingmesh",
        ),
        (
            object(1, "clippingmode=\"inside\" clippingmesh=\"1\""),
            "clipped by object 1",
        ),
        (
            object(1, "clippingmode=\"inside\" clippingmesh=\"2\"")
                + &cube_object(2, ""),
            "clipped by object 2",
        ),
        (
            object(2, "")
                + &object(1, "clippingmode=\"inside\" clippingmesh=\"2\""),
            "clipped by object 2",
        ),
        (
            object(1, "").replace("<b:beams>", "<b:beamlattice radius=\"1\">"),
            "a second lattice",
        ),
        ("<b:beamlattice/>".to_owned(), "part of no object"),
        (
            "<object id=\"1\"><b:beam/></object>".to_owned(),
            "part of no lattice",
        ),
        (
            object(1, "").replace("radius=\"1\"", ""),
            "no attribute radius",
        ),
    ];
    for (resources, why) in cases {
        let bytes = package(&model("millimeter", &resources, ITEM));
        let said = match of(&bytes) {
            Ok(body) => format!("{body:?}"),
            Err(e) => e.to_string(),
        };
        assert!(said.contains(why), "{why:?}: {said:?}");
    }
}
