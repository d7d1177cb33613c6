//! Meshes, their units and transforms, and projects of slicers.

use super::*;

#[test]
fn units_transforms_and_components() {
    let resources = format!(
        "{}<object id=\"2\"><components>\
         <component objectid=\"1\" transform=\"2 0 0 0 2 0 0 0 2 5 0 0\"/>\
         <component objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>\
         </components></object>",
        cube_object(1, "")
    );
    let items = "<item objectid=\"2\" transform=\"0 1 0 -1 0 0 0 0 1 0 0 10\"/>\
         <item objectid=\"1\" printable=\"0\"/>";
    let bytes = package(&model("inch", &resources, items));
    let body = of(&bytes).unwrap();
    assert_eq!(body.notes, ["left out an object that is not printable"]);
    // x goes to y, y to −x.
    let bounds = extent(&body);
    let min = DVec3::new(-2.0, -1.0, 10.0) * 25.4;
    let max = DVec3::new(0.0, 7.0, 12.0) * 25.4;
    assert!(bounds.min.distance(min) < 1e-9, "{bounds:?}");
    assert!(bounds.max.distance(max) < 1e-9, "{bounds:?}");
    // The middles of both cubes, half as deep as they are wide.
    let depth = |x, y, z| value(&body, DVec3::new(x, y, z) * 25.4) / 25.4;
    assert!((depth(-1.0, 6.0, 11.0) + 1.0).abs() < 1e-6);
    assert!((depth(-0.5, -0.5, 10.5) + 0.5).abs() < 1e-6);
}

/// The elements of the core may have a prefix, and that of other namespaces are
/// not its own.
#[test]
fn prefixes_are_as_the_file_says() {
    let object = cube_object(1, "");
    let strange = "<w:object xmlns:w=\"urn:w\" id=\"1\"/><x:vertex/>";
    let plain = model("inch", &(strange.to_owned() + &object), ITEM);
    let prefixed = plain
        .replace("xmlns=", "xmlns:c=")
        .replace("</", "</c:")
        .replace('<', "<c:")
        .replace("<c:/c:", "</c:")
        .replace("<c:?", "<?")
        .replace("<c:w:", "<w:")
        .replace("<c:x:", "<x:");
    for text in [plain, prefixed] {
        let body = of(&package(&text)).unwrap();
        let depth = value(&body, DVec3::splat(12.7));
        assert!((depth + 12.7).abs() < 1e-5, "{text}");
    }
}

#[test]
fn production_and_projects_of_slicers() {
    let part = |name: &str| {
        format!(
            "<object id=\"8\"><components>\
             <component p:path=\"/3D/Objects/{name}\" objectid=\"1\"/>\
             <component p:path=\"/3D/Objects/{name}\" objectid=\"2\" \
             transform=\"1 0 0 0 1 0 0 0 1 3 0 0\"/></components></object>"
        )
    };
    let other = model(
        "millimeter",
        &(cube_object(1, "") + &cube_object(2, "")),
        "",
    );
    let config = "<config><object id=\"8\"><part id=\"1\" \
         subtype=\"normal_part\"/><part id=\"2\" subtype=\"negative_part\"/>\
         </object></config>";
    let item = "<item objectid=\"8\"/>";
    let bytes = archive(&[
        (
            "_rels/.rels",
            "<Relationships><Relationship Target=\"/3D/main.model\" Id=\"a\" \
             Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\
             </Relationships>",
        ),
        (
            "3D/main.model",
            &model("millimeter", &part("a.model"), item),
        ),
        ("3D/Objects/a.model", &other),
        ("Metadata/model_settings.config", config),
    ]);
    let body = of(&bytes).unwrap();
    assert_eq!(extent(&body), unit_cube());
    assert_eq!(body.notes, ["left out a negative volume"]);
    let of_prusa = "<config><object id=\"1\"><volume firstid=\"0\" \
         lastid=\"7\"/><volume firstid=\"8\" lastid=\"11\"><metadata \
         type=\"volume\" key=\"modifier\" value=\"1\"/><metadata type=\"volume\" \
         key=\"volume_type\" value=\"ParameterModifier\"/></volume></object>\
         </config>";
    let cube = model(
        "millimeter",
        &cube_object(1, "type=\"model\""),
        "<item objectid=\"1\"/>",
    );
    let bytes = archive(&[
        (ROOT, &cube),
        ("Metadata/Slic3r_PE_model.config", of_prusa),
    ]);
    let body = of(&bytes).unwrap();
    assert_eq!(
        body.notes,
        [
            "left 8 edges open: it is no closed body",
            "left out a modifier",
        ]
    );
    let of_cura = format!(
        "<object id=\"2\"><metadatagroup><metadata name=\"cura:infill_mesh\">\
         True</metadata></metadatagroup>{}</object>{}",
        cube_mesh(),
        cube_object(1, "")
    );
    let items = "<item objectid=\"1\"/><item objectid=\"2\"/>";
    let bytes = package(&model("millimeter", &of_cura, items));
    let body = of(&bytes).unwrap();
    assert_eq!(extent(&body), unit_cube());
    assert_eq!(body.notes, ["left out a modifier"]);
}

/// What slicers paint on triangles, and a project's settings, are not used.
#[test]
fn what_a_project_has_besides_the_body_is_told_of() {
    let cube = cube_object(1, "type=\"model\"");
    let painted = |attributes: &str| {
        let cube =
            cube.replacen("<triangle ", &format!("<triangle {attributes} "), 2);
        model("millimeter", &cube, ITEM)
    };
    for (attribute, told) in [
        ("paint_supports=\"4\"", "left out painted supports"),
        ("paint_seam=\"4\"", "left out painted seams"),
        ("paint_color=\"8\"", "left out painted filaments"),
    ] {
        let body = of(&package(&painted(attribute))).unwrap();
        assert_eq!(body.notes, [told]);
        assert_eq!(extent(&body), unit_cube());
    }
    let prusa = painted("slic3rpe:custom_supports=\"4\"").replacen(
        "<model ",
        "<model xmlns:slic3rpe=\"http://schemas.slic3r.org/3mf/2017/06\" ",
        1,
    );
    let bytes = archive(&[
        (ROOT, &prusa),
        ("Metadata/Slic3r_PE.config", "; perimeters = 4\n"),
    ]);
    assert_eq!(
        of(&bytes).unwrap().notes,
        [
            "left out painted supports",
            "the project's own settings (Metadata/Slic3r_PE.config) are not \
             used; isoslice profiles import makes profiles of them",
        ]
    );
    assert!(
        of(&package(&painted("pid=\"1\"")))
            .unwrap()
            .notes
            .is_empty()
    );
}
