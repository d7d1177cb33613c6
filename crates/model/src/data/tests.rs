use super::taken::Taken;
use super::{Files, Options, kind};
use crate::{
    BuildVolume, LoadError, Placement, ScriptLimits, Source, load, load_within,
    place,
};
use std::fs;
use std::hint::black_box;
use std::time::Duration;

fn script(text: &str) -> Source {
    Source::script("part", text)
}

/// A cube of 20 mm, as text, whose lower corner is at x.
fn cube(x: f64) -> String {
    let corner =
        |k: usize| [0, 1, 2].map(|i| if k >> i & 1 == 0 { 0.0 } else { 20.0 });
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let mut text = String::new();
    for k in 0..8 {
        let [a, b, c] = corner(k);
        text += &format!("v {} {b} {c}\n", a + x);
    }
    for [a, b, c, d] in faces.map(|face| face.map(|k| k + 1)) {
        text += &format!("f {a} {b} {c} {d}\n");
    }
    text
}

#[test]
fn a_mesh_far_from_the_origin_is_moved_there() {
    let folder = tempfile::tempdir().unwrap();
    let room = BuildVolume {
        x: 220.0,
        y: 220.0,
        z: 250.0,
    };
    for (x, is_far) in
        [(0.0, false), (10_000.0, false), (5e5, true), (1e7, true)]
    {
        let path = folder.path().join(format!("at{x}.obj"));
        fs::write(&path, cube(x)).unwrap();
        let loaded = load(&Source::File(path), &[]).unwrap();
        assert_eq!(loaded.moved.x != 0.0, is_far, "{x}");
        assert_eq!(loaded.notes.len(), usize::from(is_far), "{x}");
        let model = place(&loaded, &Placement::default(), room).unwrap();
        let off = model.bounds.size() - 20.0;
        assert!(off.abs().max_element() < 2e-3, "{x}: {off}");
        let middle = model.printed_bounds().centre() - 110.0;
        assert!(middle.truncate().abs().max_element() < 2e-3, "{x}");
        // Kept where it is, it is not on the bed.
        let kept = Placement {
            keep_position: true,
            ..Placement::default()
        };
        let error = place(&loaded, &kept, room).err().map(|e| e.to_string());
        let away = error.is_some_and(|e| e.contains("m away from the printer"));
        assert_eq!(away, is_far, "{x}");
        // A script may need it where it is.
        let script = folder.path().join("part.rhai");
        fs::write(&script, format!("mesh(\"at{x}.obj\")")).unwrap();
        let error = load(&Source::File(script), &[]).err();
        let error = error.map(|e| format!("{e:?}")).unwrap_or_default();
        assert_eq!(error.contains("from the origin"), is_far, "{error}");
    }
}

#[test]
fn a_script_is_not_blamed_for_the_making_of_data() {
    // The letters take a second, in a script that may take a third.
    let letters = "ABCDefgh".repeat(700);
    let limits = ScriptLimits {
        time: Duration::from_millis(300),
        ..ScriptLimits::default()
    };
    let text = format!("max(text(\"{letters}\"), abs(z) - 1)");
    load_within(&script(&text), &[], &limits).unwrap();
    let endless = "let t = 0; while true { t += 1; } x";
    assert!(load_within(&script(endless), &[], &limits).is_err());
}

#[test]
fn what_is_being_made_counts_at_once() {
    // The memory is that of the whole process, and other tests give some back
    // at the same time.
    let grew = (0..20).any(|_| {
        let taken = Taken::default();
        let held = taken.making(|| {
            assert_eq!(taken.bytes(), None);
            std::thread::sleep(Duration::from_millis(20));
            assert!(taken.time() >= Duration::from_millis(20));
            // Nobody reads it, so it might never be made.
            black_box(vec![1_u8; 50 << 20])
        });
        assert!(taken.time() >= Duration::from_millis(20));
        drop(held);
        taken.bytes().is_some_and(|bytes| bytes > 40 << 20)
    });
    assert!(grew);
}

#[test]
fn equal_calls_make_data_once() {
    let files = Files::default();
    let text = kind("text").unwrap();
    let made = |letters: &str| files.call(text, letters, &Options::new());
    for _ in 0..5 {
        made("one").unwrap();
        made("two").unwrap();
    }
    assert_eq!(files.times(), 2);
    // A missing letter is told of once for each text.
    for _ in 0..3 {
        made("\u{4e2d}a").unwrap();
    }
    assert_eq!(files.notes().len(), 1, "{:?}", files.notes());
}

/// A program that makes a part for each serial number makes many models.
#[test]
fn a_program_makes_data_as_often_as_it_likes() {
    let files = Files::anywhere();
    let text = kind("text").unwrap();
    for i in 0..1100 {
        files.call(text, &i.to_string(), &Options::new()).unwrap();
    }
    assert_eq!(files.times(), 1100);
}

#[test]
fn a_script_makes_data_a_bounded_number_of_times() {
    // Another model has the same texts, and is no reason to allow more.
    let others = Files::anywhere();
    let text = kind("text").unwrap();
    for i in 0..1100 {
        others.call(text, &i.to_string(), &Options::new()).unwrap();
    }
    let many = "for i in 0..2000 { text(i.to_string()); } x";
    let error = load(&script(many), &[]).err().unwrap().to_string();
    assert!(error.contains("more than 1000 times"), "{error}");
    // Neither does it look for ever more files.
    let files = Files::default();
    let mesh = kind("mesh").unwrap();
    for i in 0..3000 {
        let name = format!("{i}.stl");
        assert!(files.call(mesh, &name, &Options::new()).is_err());
    }
    assert_eq!(files.read().len(), 1000);
}

#[test]
fn an_error_names_the_files_that_were_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.rhai");
    fs::write(&path, "max(svg(\"logo.svg\"), abs(z) - 1)").unwrap();
    let error = load(&Source::File(path), &[]).err().unwrap();
    assert!(matches!(error, LoadError::Script { .. }), "{error}");
    assert_eq!(error.data_files(), [folder.path().join("logo.svg")]);
    let formula = Source::formula("part", "max(svg(\"logo.svg\"), z)");
    let error = load(&formula, &[]).err().unwrap();
    assert_eq!(error.data_files().len(), 1, "{error}");
}

#[test]
fn a_drawing_is_no_model_but_becomes_one() {
    for name in ["plate.DXF", "logo.svg"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, "").unwrap();
        let error = load(&Source::File(path), &[]).err().unwrap().to_string();
        let kind = &name[name.len() - 3..].to_lowercase();
        let call = format!("-e '{kind}(\"{name}\")' --height 2");
        assert!(error.contains("is a drawing"), "{error}");
        assert!(error.contains(&call), "{error}");
    }
}

#[test]
fn messages_of_texts_name_the_function_once() {
    for (call, wanted) in [
        ("text(\"a\", #{sise: 3})", "text has no option"),
        ("text(\"a\", #{size: \"b\"})", "text: size is a number"),
        ("text(\" \")", "text: it has no letter"),
        ("text(\"a\", #{size: -1})", "text(\"a\"): its size is -1 mm"),
    ] {
        let error = load(&script(call), &[]).err().unwrap().to_string();
        assert!(error.contains(wanted), "{error}");
        assert!(!error.contains("text: text"), "{error}");
    }
}

#[test]
fn numbers_in_messages_are_short_and_options_are_maps() {
    for (call, wanted) in [
        ("text(\"a\", #{size: 1e300})", "the number 1e300"),
        ("text(\"a\", #{size: 1e30})", "its size is 1e30 mm"),
        ("sphere(-1e300)", "not the number -1e300"),
        ("sphere(-2.5)", "not the number -2.5"),
        ("mesh(\"a.stl\", 1)", "mesh: options are a map"),
        ("text(\"a\", \"b\")", "text: options are a map"),
    ] {
        let error = load(&script(call), &[]).err().unwrap().to_string();
        assert!(error.contains(wanted), "{error}");
    }
}

#[test]
fn data_alone_that_is_no_body_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let facet = |last: [u8; 3]| {
        let corner =
            |p: [u8; 3]| format!("vertex {} {} {}\n", p[0], p[1], p[2]);
        let corners = [[0, 0, 0], [9, 9, 0], last].map(corner).concat();
        format!("facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let facets = [facet([0, 9, 0]), facet([9, 0, 0])].concat();
    let stl = format!("solid a\n{facets}endsolid a\n");
    fs::write(folder.path().join("flat.stl"), stl).unwrap();
    fs::write(folder.path().join("a.csv"), "0,0,0,1\n9,0,0,1\n").unwrap();
    let path = folder.path().join("part.rhai");
    let error = |text: &str| {
        fs::write(&path, text).unwrap();
        let loaded = load(&Source::File(path.clone()), &[]).unwrap();
        let volume = BuildVolume {
            x: 200.0,
            y: 200.0,
            z: 200.0,
        };
        let placed = place(&loaded, &Placement::default(), volume);
        placed.err().unwrap().to_string()
    };
    let flat = error("mesh(\"flat.stl\")");
    assert!(flat.starts_with("mesh(\"flat.stl\") is flat"), "{flat}");
    let numbers = error("samples(\"a.csv\").move([1, 0, 0])");
    assert!(numbers.contains("samples(\"a.csv\") alone"), "{numbers}");
}
