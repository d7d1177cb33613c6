//! Files that are damaged, or made to do harm.

use super::*;

#[test]
fn hostile_files_are_refused_with_the_reason() {
    let deep: String = (0..100).map(|_| "<a>").collect();
    let chain: String = (2..60)
        .map(|i| {
            format!(
                "<object id=\"{i}\"><components><component objectid=\"{}\"/>\
                 <component objectid=\"{}\"/></components></object>",
                i - 1,
                i - 1
            )
        })
        .collect::<String>()
        + &cube_object(1, "");
    let wide = &chain[..chain.len()];
    let laughs = |last: u32| {
        model("millimeter", wide, &format!("<item objectid=\"{last}\"/>"))
    };
    let of_model = |resources: &str, items: &str| {
        package(&model("millimeter", resources, items))
    };
    let circle = "<object id=\"1\"><components><component objectid=\"2\"/>\
        </components></object><object id=\"2\"><components><component \
        objectid=\"1\"/></components></object>";
    let required = |name: &str| {
        model("inch", "", "")
            .replace("unit=\"inch\"", &format!("requiredextensions=\"{name}\""))
    };
    let spaces = " ".repeat(40 << 20);
    let many: Vec<(String, String)> = (0..10_001)
        .map(|i| (i.to_string(), String::new()))
        .collect();
    let many: Vec<(&str, &str)> =
        many.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    let vertex = "<vertex x=\"1\" y=\"1\" z=\"1\"/>";
    let relation = |mode: &str| {
        format!(
            "<Relationship Target=\"/_rels/.rels\" Type=\"a/3dmodel\" \
             TargetMode=\"{mode}\"/>"
        )
    };
    let one = |inside: &str| {
        let object = format!(
            "<object id=\"1\"><mesh><vertices>{vertex}{vertex}{vertex}</vertices>\
             <triangles>{inside}</triangles></mesh></object>"
        );
        of_model(&object, ITEM)
    };
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (vec![], "archive is damaged"),
        (b"PK\x03\x04".to_vec(), "archive is damaged"),
        (archive(&[("a", "b")]), "there is no 3D/3dmodel.model"),
        (archive(&many), "more than 10000 files"),
        (package(""), "there is no model"),
        (package("<a/>"), "the first element is no model"),
        (package("<model><"), "byte 8"),
        (package("<model>"), "cut off"),
        (package("<model></a>"), "byte 8"),
        (
            package("<!DOCTYPE a [<!ENTITY b \"c\">]><model/>"),
            "document type",
        ),
        (package(&format!("<model>{deep}")), "elements inside"),
        (package("<model unit=\"mile\"/>"), "\"mile\" is no unit"),
        (package("<model unit=\"&b;\"/>"), "unit cannot be read"),
        (package("<model/>"), "nothing is to be built"),
        (package(&required("x")), "requires the extension"),
        (package(&required("w")), "without naming it"),
        (package(&required("p")), "nothing is to be built"),
        (
            package(&format!("<model>{spaces}</model>")),
            "byte 8: an element of more than 1 MB",
        ),
        (
            package(&format!("<model>{}</model>", "<a/>".repeat(10 << 20))),
            "unpacks to far more",
        ),
        (of_model("", ITEM), "there is no object 1"),
        (of_model("<object/>", ""), "no attribute id"),
        (of_model("<object id=\"-1\"/>", ""), "id is \"-1\""),
        (
            of_model("<object id=\"1\"/><object id=\"1\"/>", ""),
            "a second resource 1",
        ),
        (
            of_model("<object id=\"1\"><object id=\"2\"/></object>", ""),
            "inside an object",
        ),
        (of_model("<object id=\"1\"/>", ITEM), "no triangles"),
        (of_model(circle, ITEM), "holds itself"),
        (package(&laughs(59)), "too many objects inside"),
        (package(&laughs(30)), "more than 100000 objects"),
        (
            of_model("", "<item objectid=\"1\" transform=\"1 2\"/>"),
            "twelve finite numbers",
        ),
        (
            of_model(
                &cube_object(1, ""),
                "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0 inf\"/>",
            ),
            "twelve finite numbers",
        ),
        (
            of_model(
                &cube_object(1, ""),
                "<item objectid=\"1\" transform=\"1e300 0 0 0 1 0 0 0 1 0 0 0\"/>",
            ),
            "object 1, vertex 1: this coordinate is farther",
        ),
        (
            of_model("", "<item objectid=\"1\" p:path=\"/../../etc/passwd\"/>"),
            "there is no /../../etc/passwd",
        ),
        (
            of_model("<object id=\"1\" type=\"bear\"/>", ITEM),
            "\"bear\" is no type of objects",
        ),
        (
            of_model("<object id=\"1\" type=\"other\"/>", ITEM),
            "object 1 is to be built, and",
        ),
        (
            archive(&[("_rels/.rels", &relation("").repeat(2))]),
            "two models",
        ),
        (
            archive(&[("_rels/.rels", &relation("External"))]),
            "not in the archive",
        ),
        (
            one("<triangle v1=\"0\" v2=\"1\" v3=\"3\"/>"),
            "triangle 0: it names a vertex that there is not",
        ),
        (one("<triangle v1=\"0\" v2=\"1\"/>"), "no attribute v3"),
        (
            one("<triangle v1=\"0\" v2=\"1\" v3=\"4294967296\"/>"),
            "v3 is \"4294967296\"",
        ),
        (
            one("<triangle v1=\"0\" v2=\"1\" v3=\"2\"/>"),
            "no triangles",
        ),
        (
            of_model(&cube_object(1, "type=\"support\""), ITEM),
            "no triangles",
        ),
        (
            of_model("<m:colorgroup id=\"1\"/><object id=\"1\"/>", ITEM),
            "a second resource 1",
        ),
        (
            of_model("<m:color/>", ITEM),
            "no attribute color, which each",
        ),
        (
            of_model("<m:texture2d id=\"1\"/>", ITEM),
            "no attribute path",
        ),
        (
            of_model("<metadata>a</metadata>", ITEM),
            "no attribute name",
        ),
    ];
    for (bytes, why) in cases {
        let said = match of(&bytes) {
            Ok(body) => format!("{body:?}"),
            Err(e) => e.to_string(),
        };
        assert!(said.contains(why), "{why:?}: {said:?}");
    }
}

/// A small file may place an object of many vertices so often that nobody waits
/// for it, though nothing of it is left.
#[test]
fn what_is_placed_in_vain_is_counted_too() {
    let vertices = "<vertex x=\"0\" y=\"0\" z=\"0\"/>".repeat(3000);
    let resources = format!(
        "{}<object id=\"2\"><mesh><vertices>{vertices}</vertices><triangles>\
         <triangle v1=\"0\" v2=\"0\" v3=\"1\"/></triangles></mesh></object>",
        cube_object(1, "")
    );
    let file = |times: usize| {
        let items = ITEM.to_owned() + &"<item objectid=\"2\"/>".repeat(times);
        of(&package(&model("millimeter", &resources, &items)))
    };
    assert!(file(300).is_ok());
    let said = file(340).unwrap_err().to_string();
    assert!(said.contains("objects are placed so often"), "{said}");
}

/// An archive that is not packed: text that repeats packs better than models do.
fn stored(model: &str) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Stored);
    zip.start_file(ROOT, options).unwrap();
    zip.write_all(model.as_bytes()).unwrap();
    zip.finish().unwrap().into_inner()
}

/// Nothing has to be placed to take memory.
#[test]
fn what_is_held_is_counted_in_all_files() {
    let vertices = "<vertex x=\"0\" y=\"0\" z=\"0\"/>".repeat(200_000);
    let object = |id: u32| {
        format!(
            "<object id=\"{id}\"><mesh><vertices>{vertices}</vertices></mesh>\
             </object>"
        )
    };
    let other = model("millimeter", &(object(1) + &object(2)), "");
    let file = |objects: u32| {
        let own: String = (10..10 + objects).map(&object).collect();
        let items = "<item p:path=\"/b.model\" objectid=\"1\"/>".to_owned()
            + "<item p:path=\"/b.model\" objectid=\"1\"/><item objectid=\"9\"/>";
        let root = model("millimeter", &(own + &cube_object(9, "")), &items);
        of(&archive(&[(ROOT, &root), ("b.model", &other)]))
    };
    assert!(file(2).is_ok());
    let said = file(3).unwrap_err().to_string();
    assert!(said.starts_with("/b.model, byte"), "{said}");
    assert!(said.contains("1 million vertices, triangles and"), "{said}");
    let outs = "<i:scalar identifier=\"a\"/>".repeat(900);
    let node = |i: u32| {
        format!("<i:sin identifier=\"n{i}\"><i:out>{outs}</i:out></i:sin>")
    };
    let function = |id: u32| {
        let nodes: String = (0..500).map(node).collect();
        format!("<i:implicitfunction id=\"{id}\">{nodes}</i:implicitfunction>")
    };
    let file = |functions: u32| {
        let all: String = (1..=functions).map(function).collect();
        let all = model("millimeter", &(all + &cube_object(9, "")), ITEM)
            .replace("objectid=\"1\"", "objectid=\"9\"");
        of(&stored(&all))
    };
    assert!(file(2).is_ok());
    let said = file(3).unwrap_err().to_string();
    assert!(said.contains("1 million nodes, inputs and"), "{said}");
}

#[test]
fn limits_of_reading_are_told_in_words_of_the_file() {
    let names: String =
        (0..300).map(|i| format!(" xmlns:a{i}=\"b\"")).collect();
    let object = format!("<object id=\"1\"{names}/>");
    let many = package(&model("millimeter", &object, ITEM));
    let said = of(&many).unwrap_err().to_string();
    assert!(said.contains("declares too many namespaces"), "{said}");
    let items = ITEM.repeat(100_001);
    let many = package(&model("millimeter", &cube_object(1, ""), &items));
    let said = of(&many).unwrap_err();
    let why = "more than 100000 objects are placed; save fewer of them";
    assert!(said.to_string().contains(why), "{said}");
    let cube = model("millimeter", &cube_object(1, ""), ITEM);
    let relations = "<Relationship Target=\"a\" Type=\"b\"/>".repeat(100_001);
    let relations = format!("<Relationships>{relations}</Relationships>");
    let metadata: String = (0..10_001)
        .map(|i| format!("<metadata name=\"{i}\"/>"))
        .collect();
    let metadata =
        cube.replace("<resources>", &format!("{metadata}<resources>"));
    let groups: String = (10..1_000_010)
        .map(|i| format!("<m:colorgroup id=\"{i}\"/>"))
        .collect();
    let groups = cube.replace("<resources>", &format!("<resources>{groups}"));
    for (files, why) in [
        (
            [("_rels/.rels", &*relations), (ROOT, &*cube)],
            "more than 100000 relationships, and no file needs so many; save",
        ),
        (
            [("a", ""), (ROOT, &metadata)],
            "more than 10000 names of metadata, and no file needs so many; save",
        ),
        (
            [("a", ""), (ROOT, &groups)],
            "more than 1 million resources, and no file needs so many; save",
        ),
    ] {
        let said = of(&archive(&files)).unwrap_err().to_string();
        assert!(said.contains(why), "{why:?}: {said:?}");
    }
}

/// Any bytes end in a body or an error.
#[test]
fn changed_files_never_panic() {
    let mut rng = fastrand::Rng::with_seed(11);
    let text = model(
        "millimeter",
        &lattice::object(1, "b2:ballmode=\"mixed\" b2:ballradius=\"2\""),
        ITEM,
    );
    for _ in 0..2000 {
        let mut changed = text.clone().into_bytes();
        for _ in 0..rng.usize(1..6) {
            let at = rng.usize(..changed.len());
            match rng.u8(..4) {
                0 => changed[at] = rng.u8(..),
                1 => changed[at] ^= 1 << rng.u8(..8),
                2 => changed.truncate(at + 1),
                _ => changed.insert(at, b"0 -\n.e/\""[rng.usize(..8)]),
            }
        }
        let changed = String::from_utf8_lossy(&changed);
        if let Ok(body) = of(&package(&changed)) {
            let data = &body.data[0];
            let (d, gradient) = data.at(DVec3::splat(0.3));
            assert!(d.is_finite() && gradient.is_finite());
            let range = data.range(&unit_cube());
            assert!(range[0] <= d && d <= range[1], "{d} {range:?}");
        }
    }
}
