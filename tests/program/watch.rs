//! The server of `isoslice watch`, as a page and as strangers use it. What the
//! page makes of it is tested in a browser: tests/browser/watch.mjs.

use crate::served::Watch;
use serde_json::Value;
use std::fs;
use std::process::{Command, Stdio};

const CUP: &str = "let r = param(\"radius\", 4.0, \"mm\", #{ max: 9 });\n\
                   max(sqrt(x * x + y * y) - r, abs(z - 1) - 1)\n";

#[test]
fn an_edit_is_sliced_and_a_mistake_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("cup.rhai");
    fs::write(&model, CUP).unwrap();
    let watch = Watch::start(folder.path(), &["cup.rhai"]);
    let first = watch.done();
    assert!(first["fault"].is_null(), "{}", first["fault"]);
    assert_eq!(first["model"]["parameters"][0]["max"], 9.0);
    assert_eq!(first["model"]["size"][2], 2.0);

    fs::write(&model, CUP.replace("abs(z - 1) - 1", "abs(z - 2) - 2")).unwrap();
    let edited = watch.state(|state| {
        state["busy"].is_null() && state["model"]["size"][2] == 4.0
    });
    assert_eq!(edited["print"]["of_model"], edited["model"]["revision"]);
    // The G-code is what `slice` writes.
    let print = edited["print"]["revision"].as_u64().unwrap();
    let gcode = watch.get(&format!("gcode?print={print}"));
    assert!(gcode.head.contains("attachment; filename=\"cup.gcode\""));
    Command::new(assert_cmd::cargo::cargo_bin!("isoslice"))
        .args(["slice", "-q", "cup.rhai"])
        .current_dir(folder.path())
        .status()
        .unwrap();
    assert!(gcode.body == fs::read(folder.path().join("cup.gcode")).unwrap());
    // An older one is not given out as the newest.
    assert_eq!(watch.get("gcode?print=1").code, 409);

    fs::write(&model, "let r = 4.0;\nx - rr\n").unwrap();
    let wrong = watch.state(|state| state["fault"].is_object());
    let text = wrong["fault"]["text"].as_str().unwrap();
    assert!(text.contains("line 2"), "{text}");
    let excerpt = wrong["fault"]["excerpt"].as_str().unwrap();
    assert!(excerpt.contains("2 | x - rr"), "{excerpt}");
    assert_eq!(wrong["print"], edited["print"]);
    assert_eq!(watch.get("picture?width=40&height=30").code, 200);
}

#[test]
fn changes_of_the_page_are_sliced() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cup.rhai"), CUP).unwrap();
    fs::write(folder.path().join("mine.toml"), "walls = 3\n").unwrap();
    let arguments = ["cup.rhai", "--config", "mine.toml", "-D", "radius=5"];
    let watch = Watch::start(folder.path(), &arguments);
    assert_eq!(watch.done()["model"]["size"][0], 10.0);
    let change =
        r#"{"define": {"radius": "3"}, "set": {"layer_height": "0.1"}}"#;
    assert_eq!(watch.post("change", change).code, 200);
    let state = watch.done();
    assert_eq!(state["model"]["size"][0], 6.0);
    let toml = String::from_utf8(watch.get("settings.toml").body).unwrap();
    assert!(toml.contains("\nlayer_height = 0.1\n"), "{toml}");
    assert!(toml.contains("\nwalls = 3\n"), "{toml}");
    // What is out of bounds is an error, and can be taken back.
    watch.post("change", r#"{"define": {"radius": "10"}}"#);
    let state = watch.state(|state| state["fault"].is_object());
    let text = state["fault"]["text"].as_str().unwrap();
    assert!(text.contains("at most 9"), "{text}");
    watch.post("change", r#"{"define": {"radius": null}}"#);
    let state = watch.done();
    assert!(state["fault"].is_null());
    assert_eq!(state["model"]["size"][0], 8.0);
    // A watched file of settings may have a mistake.
    fs::write(folder.path().join("mine.toml"), "walls = 1000000\n").unwrap();
    let state = watch.state(|state| state["fault"].is_object());
    let text = state["fault"]["text"].as_str().unwrap();
    assert!(text.contains("mine.toml"), "{text}");
    // Parameters that the script no longer has do not block it.
    fs::write(folder.path().join("mine.toml"), "walls = 2\n").unwrap();
    watch.post("change", r#"{"define": {"radius": "3", "old": "1"}}"#);
    let plain = CUP.replace("\"radius\"", "\"size\"");
    fs::write(folder.path().join("cup.rhai"), plain).unwrap();
    watch.state(|state| {
        state["busy"].is_null()
            && state["fault"].is_null()
            && state["model"]["parameters"][0]["name"] == "size"
    });
    // Once the parameter is back, it has the value that the page gave it. An
    // editor that empties the file before it writes it takes the parameter away
    // for a moment.
    fs::write(folder.path().join("cup.rhai"), "").unwrap();
    watch.state(|state| state["fault"].is_object());
    fs::write(folder.path().join("cup.rhai"), CUP).unwrap();
    let state = watch
        .state(|state| state["busy"].is_null() && state["fault"].is_null());
    assert_eq!(state["model"]["size"][0], 6.0);
}

/// While a part is sliced, there is a glimpse of the layer that a page shows.
#[test]
fn the_layer_that_is_shown_comes_first() {
    let folder = tempfile::tempdir().unwrap();
    // One layer is quickly made, and all of them are not.
    let script = "let r = param(\"radius\", 8.0);\n\
                  max(sqrt(x*x + y*y) - r, abs(z - 100) - 100)\n";
    fs::write(folder.path().join("rod.rhai"), script).unwrap();
    let watch = Watch::start(folder.path(), &["rod.rhai"]);
    assert!(watch.done()["glimpse"].is_null());
    // If no layer is asked for, there is no glimpse.
    watch.post("change", r#"{"define": {"radius": "7"}}"#);
    let state = watch.state(|state| state["model"]["size"][0] == 14.0);
    assert!(state["glimpse"].is_null());
    watch.done();
    assert_eq!(watch.post("layer", r#"{"layer": 30.1}"#).code, 200);
    // On a busy machine the layer may take too long.
    let found = (20..60).find_map(|tenths: u32| {
        let radius = 0.1 * f64::from(tenths);
        let change = format!(r#"{{"define": {{"radius": "{radius}"}}}}"#);
        watch.post("change", &change);
        let size = |state: &Value| state["model"]["size"][0].as_f64();
        let is_new = |of: f64| (of - 2.0 * radius).abs() < 1e-3;
        let state = watch.state(|state| size(state).is_some_and(is_new));
        let revision = state["glimpse"]["revision"].as_u64()?;
        let moves = watch.get(&format!("glimpse?revision={revision}"));
        (moves.code == 200).then_some((state, moves))
    });
    let (state, moves) = found.expect("no layer came before the others");
    let glimpse = &state["glimpse"];
    assert_eq!(glimpse["of_model"], state["model"]["revision"], "{state}");
    assert_eq!(glimpse["layer"], 150);
    assert_eq!(glimpse["layers"], 1000);
    let end = moves.body.iter().position(|b| *b == b'\n').unwrap();
    let told: Value = serde_json::from_slice(&moves.body[..end]).unwrap();
    assert_eq!(told["z"].as_array().unwrap().len(), 1);
    // All layers take the glimpse's place.
    assert!(watch.done()["glimpse"].is_null());
    assert_eq!(watch.get("glimpse?revision=1").code, 404);
    for (body, code) in [
        (r#"{"layer": null}"#, 200),
        (r#"{"layer": "x"}"#, 400),
        (r#"{"layer": 1e999}"#, 400),
        (r#"{"height": 1}"#, 400),
    ] {
        assert_eq!(watch.post("layer", body).code, code, "{body}");
    }
}

#[test]
fn hostile_requests_get_nothing_and_break_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("secret.txt"), "SECRET").unwrap();
    let watch = Watch::start(folder.path(), &["-e", "sqrt(x^2+y^2+z^2) - 5"]);
    let before = watch.done();

    for (method, path, head, body, code) in [
        ("GET", "nothing", "", "", 404),
        ("GET", "../secret.txt", "", "", 404),
        ("GET", "%2e%2e/secret.txt", "", "", 404),
        ("GET", "state?seen=x", "", "", 400),
        ("GET", "picture?width=nan", "", "", 400),
        ("DELETE", "state", "", "", 405),
        ("POST", "state", "", "", 404),
        ("POST", "change", "", "{}", 415),
        ("POST", "change", "Content-Type: text/plain\r\n", "{}", 415),
        ("GET", "state", "Origin: http://evil.example\r\n", "", 403),
        ("GET", "state", "Host: evil.example\r\n", "", 400),
    ] {
        let answer = watch.ask(method, path, head, body);
        assert_eq!(answer.code, code, "{method} {path} {head}");
        assert!(!String::from_utf8_lossy(&answer.body).contains("SECRET"));
    }
    // A name of another site may be made to lead here.
    let (secret, port) = (&watch.secret, watch.port);
    let rebound = format!(
        "GET /{secret}/state HTTP/1.1\r\nHost: evil.example:{port}\r\n\
         Connection: close\r\n\r\n"
    );
    assert_eq!(watch.raw(rebound.as_bytes()).unwrap().code, 421);
    let deep = "[".repeat(500_000);
    let large = format!("{{\"set\":{{\"a\":\"{}\"}}}}", "1".repeat(2 << 20));
    for (body, code) in [
        ("", 400),
        (r#"{"define":{"a":1}}"#, 400),
        (r#"{"model":"/etc/passwd"}"#, 400),
        (&*deep, 400),
        (&*large, 413),
    ] {
        assert_eq!(watch.post("change", body).code, code, "{body:.40}");
    }
    let order = r#"{"to":"x","start":true,"print":999999}"#;
    assert_eq!(watch.post("send", order).code, 409);
    // A picture is no larger than allowed, whatever is asked for.
    let png = watch.get("picture?width=1e9&height=16").body;
    assert_eq!(png[16..20], 2048_u32.to_be_bytes());

    for bytes in [
        &b"\0\0\0\0\r\n\r\n"[..],
        b"GET / HTTP/9.9\r\n\r\n",
        &[b'A'; 100_000],
        format!("GET / HTTP/1.1\r\nX: {}\r\n\r\n", "y".repeat(1 << 20))
            .as_bytes(),
        b"GET http://127.0.0.1/state HTTP/1.1\r\nHost: a\r\n\
          Connection: close\r\n\r\n",
    ] {
        let mut closing = bytes.to_vec();
        closing.extend_from_slice(b"\r\n\r\n");
        let answer = watch.raw(&closing);
        assert!(answer.is_none_or(|a| a.code >= 400), "{:.20?}", bytes);
    }
    // None of these requests was a change.
    let after = watch.done();
    assert_eq!(after["model"], before["model"]);
    assert_eq!(after["choice"], before["choice"]);
}

#[test]
fn many_requests_do_not_starve_a_run() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cup.rhai"), CUP).unwrap();
    let watch = Watch::start(folder.path(), &["cup.rhai"]);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..250 {
                    assert_eq!(watch.get("state?seen=0").code, 200);
                }
            });
        }
        watch.post("change", r#"{"define": {"radius": "6"}}"#);
        watch.state(|state| {
            state["busy"].is_null() && state["model"]["size"][0] == 12.0
        });
    });
}

#[test]
fn what_cannot_be_watched_is_said_at_once() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (&["-"][..], "standard input"),
        (&["none.rhai"], "there is no file none.rhai"),
        (&["plate.toml", "-D", "a=1"], "plate.toml is a plate file"),
        (
            &["-e", "x", "--config", "no.toml"],
            "there is no file no.toml",
        ),
    ] {
        let output = Command::new(assert_cmd::cargo::cargo_bin!("isoslice"))
            .arg("watch")
            .args(arguments)
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn a_file_of_data_that_is_missing_from_the_start_is_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("sign.rhai"), "max(svg(\"logo.svg\"), abs(z) - 1)").unwrap();
    let watch = Watch::start(folder.path(), &["sign.rhai"]);
    let wrong = watch.state(|state| state["fault"].is_object());
    let text = wrong["fault"]["text"].as_str().unwrap();
    assert!(text.contains("logo.svg"), "{text}");
    let page = "<svg xmlns='http://www.w3.org/2000/svg' width='9mm' \
        height='9mm' viewBox='0 0 9 9'><path d='M0 0H9V9H0Z'/></svg>";
    fs::write(file("logo.svg"), page).unwrap();
    watch.state(|state| {
        state["fault"].is_null() && state["model"]["size"][0] == 9.0
    });
}

/// The parts of a plate file are shown where they stand, each with its own
/// parameters, and whichever file changes, they are sliced again.
#[test]
fn a_plate_file_and_its_models_are_watched() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("cup.rhai"), CUP).unwrap();
    let plate = |params: &str| {
        format!(
            "settings = {{ walls = 3 }}\n\n[[part]]\nmodel = \"cup.rhai\"\n\
             copies = 2\n\n[[part]]\nmodel = \"cup.rhai\"\n{params}\n\
             at = [40, 40]\n"
        )
    };
    fs::write(file("plate.toml"), plate("params = { radius = 2 }")).unwrap();
    let watch = Watch::start(folder.path(), &["plate.toml"]);
    let state = watch.done();
    assert!(state["fault"].is_null(), "{}", state["fault"]);
    let told = |state: &Value, k: usize| {
        let one = &state["model"]["parameters"][k];
        let texts = ["key", "part"].map(|key| one[key].as_str().unwrap());
        (texts.join(" | "), one["value"].as_f64().unwrap())
    };
    assert_eq!(told(&state, 0), ("1.radius | 1. cup, 2 times".into(), 4.0));
    assert_eq!(told(&state, 1), ("2.radius | 2. cup".into(), 2.0));
    assert_eq!(state["print"]["file"], "plate.gcode");
    assert_eq!(watch.get("picture?width=40&height=30").code, 200);
    // The settings of the whole plate can be seen, and the page's win.
    let toml = String::from_utf8(watch.get("settings.toml").body).unwrap();
    assert!(toml.contains("\nwalls = 3\n"), "{toml}");
    // The G-code is what `slice` writes.
    let print = state["print"]["revision"].as_u64().unwrap();
    let gcode = watch.get(&format!("gcode?print={print}")).body;
    Command::new(assert_cmd::cargo::cargo_bin!("isoslice"))
        .args(["slice", "-q", "plate.toml"])
        .current_dir(folder.path())
        .status()
        .unwrap();
    assert!(gcode == fs::read(file("plate.gcode")).unwrap());
    // A change of one part leaves the other as it is.
    watch.post("change", r#"{"define": {"2.radius": "3", "1.old": "7"}}"#);
    let state = watch.done();
    assert!(state["fault"].is_null(), "{}", state["fault"]);
    assert_eq!([told(&state, 0).1, told(&state, 1).1], [4.0, 3.0]);
    watch.post("change", r#"{"set": {"layer_height": "0.1"}}"#);
    let of_page = String::from_utf8(watch.get("settings.toml").body).unwrap();
    assert!(of_page.contains("walls = 3\n"), "{of_page}");
    watch.done();
    // The script of a part changes.
    fs::write(file("cup.rhai"), CUP.replace("- 1)", "- 2)")).unwrap();
    watch.state(|state| {
        state["busy"].is_null() && state["model"]["size"][2] == 4.0
    });
    fs::write(file("cup.rhai"), "let r = 4.0;\nx - rr\n").unwrap();
    let wrong = watch.state(|state| state["fault"].is_object());
    let excerpt = wrong["fault"]["excerpt"].as_str().unwrap();
    assert!(excerpt.contains("2 | x - rr"), "{wrong}");
    fs::write(file("cup.rhai"), CUP).unwrap();
    watch.state(|state| state["fault"].is_null());
    // The plate file changes.
    fs::write(file("plate.toml"), plate("scael = 2")).unwrap();
    let wrong = watch.state(|state| state["fault"].is_object());
    let text = wrong["fault"]["text"].as_str().unwrap();
    assert!(text.contains("did you mean scale?"), "{text}");
    fs::write(file("plate.toml"), plate("scale = 2")).unwrap();
    let state = watch
        .state(|state| state["busy"].is_null() && state["fault"].is_null());
    assert_eq!(state["model"]["size"][2], 4.0);
}
