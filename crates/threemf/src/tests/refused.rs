//! Files in which something is wrong that the shape does not need, and files of
//! slicers that are wrong and read all the same.

use super::*;

const PIECES: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01";
const OPEN: &str =
    "http://schemas.openxmlformats.org/package/2006/relationships";

fn relations(all: &[(&str, &str)]) -> String {
    let one = |(target, kind): &(&str, &str)| {
        format!("<Relationship Target=\"{target}\" Id=\"a\" Type=\"{kind}\"/>")
    };
    let all: String = all.iter().map(one).collect();
    format!("<Relationships>{all}</Relationships>")
}

/// What is said of a sound cube with these relationships.
fn said(root: &[(&str, &str)], own: &[(&str, &str)]) -> Result<Body, String> {
    let kind = format!("{PIECES}/3dmodel");
    let root = [&[(ROOT, &*kind)], root].concat();
    let (root, own) = (relations(&root), relations(own));
    let cube = model("millimeter", &cube_object(1, ""), ITEM);
    let bytes = archive(&[
        ("_rels/.rels", &root),
        ("3D/_rels/3dmodel.model.rels", &own),
        (ROOT, &cube),
        ("3D/Textures/a.png", ""),
        ("Metadata/PT.xml", ""),
    ]);
    of(&bytes).map_err(|e| e.to_string())
}

#[test]
fn what_relationships_name_has_to_be_there() {
    let texture = format!("{PIECES}/3dtexture");
    let ticket = format!("{PIECES}/printticket");
    let thumbnail = format!("{OPEN}/metadata/thumbnail");
    // Names lead from the root, or from the folder, in letters of any size.
    for name in [
        "/3D/Textures/a.png",
        "Textures/A.png",
        "../3D/Textures/a.png",
    ] {
        said(&[], &[(name, &texture)]).unwrap();
    }
    said(&[], &[("/Metadata/PT.xml", &ticket)]).unwrap();
    let gone = said(&[], &[("C:/a.png", &texture)]).unwrap_err();
    assert!(gone.contains("3D/_rels/3dmodel.model.rels, byte"), "{gone}");
    assert!(gone.contains("C:/a.png is not in the archive"), "{gone}");
    let gone = said(&[("/Metadata/no.png", &thumbnail)], &[]).unwrap_err();
    assert!(gone.contains("/Metadata/no.png is not in the"), "{gone}");
    let tickets = [("/Metadata/PT.xml", &*ticket); 2];
    let two = said(&[], &tickets).unwrap_err();
    assert!(two.contains("a second print ticket"), "{two}");
    // What other programs add is their own matter.
    said(&[("/no", "http://schemas.bambulab.com/cover")], &[]).unwrap();
    let none = archive(&[
        ("_rels/.rels", &relations(&[])),
        (ROOT, &model("millimeter", &cube_object(1, ""), ITEM)),
    ]);
    let none = of(&none).unwrap_err().to_string();
    assert!(none.contains("no relationship names the model"), "{none}");
    let root = relations(&[("/3D/a.model", &format!("{PIECES}/3dmodel"))]);
    let none = of(&archive(&[("_rels/.rels", &root)])).unwrap_err();
    assert!(
        none.to_string()
            .contains("/3D/a.model is not in the archive")
    );
}

/// PrusaSlicer without a window, OrcaSlicer and Bambu Studio name pictures that they
/// do not write.
#[test]
fn pictures_that_slicers_do_not_write_may_be_missing() {
    let thumbnail = format!("{OPEN}/metadata/thumbnail");
    for name in [
        "/Metadata/thumbnail.png",
        "/Metadata/plate_.png",
        "/Metadata/plate_1.png",
        "/Auxiliaries/.thumbnails/thumbnail_3mf.png",
    ] {
        said(&[(name, &thumbnail)], &[]).unwrap();
    }
}

fn of_resources(resources: &str) -> Result<Body, String> {
    let resources = resources.to_owned() + &cube_object(1, "");
    let bytes = package(&model("millimeter", &resources, ITEM));
    of(&bytes).map_err(|e| e.to_string())
}

#[test]
fn materials_lead_to_materials_above_them() {
    let head = "<basematerials id=\"11\"/><basematerials id=\"12\"/>\
                <m:colorgroup id=\"13\"/><m:colorgroup id=\"14\"/>\
                <m:texture2d id=\"15\" path=\"a\" contenttype=\"image/png\"/>";
    let composite = |of: u32, id: u32| {
        format!(
            "<m:compositematerials id=\"{id}\" matid=\"{of}\" \
             matindices=\"0\"/>"
        )
    };
    let multi = |pids: &str| {
        format!(
            "{head}{}<m:multiproperties id=\"30\" pids=\"11 13\"/>\
             <m:multiproperties id=\"31\" pids=\"{pids}\"/>",
            composite(11, 21)
        )
    };
    let group =
        |of: u32| format!("{head}<m:texture2dgroup id=\"20\" texid=\"{of}\"/>");
    for sound in [
        head.to_owned() + &composite(12, 20),
        group(15),
        multi("11 13"),
        multi("21 14"),
        multi(""),
    ] {
        of_resources(&sound).unwrap();
    }
    let picture = |kind: &str| {
        head.replace("image/png", kind).replace("id=\"1", "id=\"4")
    };
    of_resources(&picture("image/JPEG")).unwrap();
    let cases = [
        (
            head.to_owned() + &composite(13, 20),
            "its matid is 13, and there is no basematerials 13 above it",
        ),
        (composite(11, 20) + head, "no basematerials 11 above it"),
        (group(13), "no texture2d 13 above it"),
        (group(99), "no texture2d 99 above it"),
        (multi("11 12"), "more than one material"),
        (multi("11 21"), "more than one material"),
        (multi("21 21"), "more than one material"),
        (multi("13 14"), "more than one group of colours"),
        (multi("11 30"), "its pids name 30, which is one of its own"),
        (multi("31"), "its pids name 31, and there is no such"),
        (multi("a"), "its pids name a, and there is no such"),
        (picture(""), "its contenttype is \"\"; textures are"),
        (picture("text/html"), "its contenttype is \"text/html\""),
        (
            cube_object(2, "pindex=\"0\""),
            "an object with pindex and without pid",
        ),
    ];
    for (resources, why) in cases {
        let said = of_resources(&resources).unwrap_err();
        assert!(said.contains(why), "{why:?}: {said:?}");
    }
    of_resources(
        &(head.to_owned() + &cube_object(2, "pid=\"11\" pindex=\"0\"")),
    )
    .unwrap();
}

/// What stands for the whole file, and where names are from.
#[test]
fn names_of_files_are_sound() {
    let cube = model("millimeter", &cube_object(1, ""), ITEM);
    let with_head =
        |head: &str| cube.replace("<resources>", &format!("{head}<resources>"));
    let title = "<metadata name=\"Title\">a</metadata>";
    let own = "<metadata name=\"DesignerUserId\"/><metadata name=\"w:a\"/>";
    let group = "<object id=\"9\"><metadatagroup><metadata name=\"w:a\"/>\
                 <metadata name=\"w:a\"/></metadatagroup></object><object";
    let strange = |more: &str, what: &str| {
        cube.replace("<model ", &format!("<model xmlns:w=\"urn:w\" {more} "))
            .replacen(&format!("<{what}"), &format!("<{what} w:a=\"b\""), 1)
    };
    let ignorable = "xmlns:mc=\"urn:mc\" mc:Ignorable=\"v w\"";
    for sound in [
        with_head(title),
        with_head(own),
        with_head(&title.replace("Title", "Description").repeat(2)),
        cube.replace("<resources>", "<resources><w:material/>"),
        cube.replacen("<object", group, 1),
        strange("", "object"),
        strange("", "triangle "),
        strange(ignorable, "vertices"),
    ] {
        of(&package(&sound)).unwrap();
    }
    let cases = [
        (with_head(&title.repeat(2)), "a second metadata Title"),
        (
            with_head("<w:created/>"),
            "the prefix \"w\" of an element is not declared",
        ),
        (
            cube.replace("<mesh>", "<w:created/><mesh>"),
            "the prefix \"w\" of an element is not declared",
        ),
        (strange("", "vertices"), "unknown namespace w"),
        (strange("", "triangles"), "unknown namespace w"),
        (
            cube.replace("<model ", "<model xml:space=\"default\" "),
            "xml:space, which 3MF does not allow",
        ),
        (
            cube.replace("<build", "<build xml:space=\"preserve\""),
            "xml:space, which 3MF does not allow",
        ),
    ];
    for (text, why) in cases {
        let said = of(&package(&text)).unwrap_err().to_string();
        assert!(said.contains(why), "{why:?}: {said:?}");
    }
}
