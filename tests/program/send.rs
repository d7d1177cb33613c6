//! `isoslice send` and `isoslice printers`, with a host that is as Moonraker
//! is. What the clients do with hosts that misbehave is tested in
//! src/cli/hosts/tests.rs.

use crate::program::isoslice;
use crate::served::Watch;
use serde_json::json;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpListener;
use std::path::Path;
use std::process::Output;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

const SECRET: &str = "S3CRET-key";

/// What a host was asked for: requests without their bodies, and the file.
#[derive(Default)]
struct Seen {
    requests: Vec<String>,
    file: Vec<u8>,
}

/// A host that takes files and prints them, if it gets the key.
fn moonraker() -> (String, Arc<Mutex<Seen>>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", listener.local_addr().unwrap());
    let seen = Arc::new(Mutex::new(Seen::default()));
    let kept = seen.clone();
    thread::spawn(move || {
        for mut stream in listener.incoming().flatten() {
            let mut reader = BufReader::new(&stream);
            let mut head = String::new();
            while !head.ends_with("\r\n\r\n") {
                if reader.read_line(&mut head).unwrap_or(0) == 0 {
                    break;
                }
            }
            let lower = head.to_lowercase();
            let length = lower.split_once("content-length: ");
            let length =
                length.and_then(|(_, l)| l.lines().next()?.parse().ok());
            let mut body = vec![0; length.unwrap_or(0)];
            let _ = reader.read_exact(&mut body);
            let first = head.lines().next().unwrap_or_default().to_owned();
            let path = first.split(' ').nth(1).unwrap_or_default();
            let mut seen = kept.lock().unwrap();
            let answer = match path {
                "/server/info" => json!({"result": {"klippy_state": "ready"}}),
                "/server/files/directory?path=gcodes" => {
                    json!({"result": {"disk_usage": {"free": 1_u64 << 40}}})
                }
                "/printer/objects/query?print_stats" => json!({"result":
                    {"status": {"print_stats": {"state": "standby"}}}}),
                "/server/files/upload" => {
                    let whole = body.windows(4).rposition(|w| w == b"\r\n--");
                    let begin =
                        body.windows(12).position(|w| w == b"octet-stream");
                    seen.file =
                        body[begin.unwrap() + 16..whole.unwrap()].into();
                    json!({"item": {"path": "part.gcode"}})
                }
                "/server/files/metadata?filename=part%2Egcode" => {
                    json!({"result": {"size": seen.file.len()}})
                }
                _ => json!({"result": "ok"}),
            };
            seen.requests.push(first);
            drop(seen);
            let key = format!("x-api-key: {}", SECRET.to_lowercase());
            let (code, text) = if lower.contains(&key) {
                (200, answer.to_string())
            } else {
                (401, "{}".to_owned())
            };
            let _ = write!(
                stream,
                "HTTP/1.1 {code} X\r\nContent-Length: {}\r\n\
                 Connection: close\r\n\r\n{text}",
                text.len()
            );
        }
    });
    (url, seen)
}

fn run(folder: &Path, arguments: &[&str], input: &str) -> Output {
    let output = isoslice(folder)
        .env("ISOSLICE_TEST_KEY", SECRET)
        .args(arguments)
        .write_stdin(input)
        .output()
        .unwrap();
    for text in [&output.stdout, &output.stderr] {
        assert!(!String::from_utf8_lossy(text).contains(SECRET));
    }
    output
}

fn works(folder: &Path, arguments: &[&str], input: &str) -> String {
    let output = run(folder, arguments, input);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

fn fails(folder: &Path, arguments: &[&str], words: &str) {
    let output = run(folder, arguments, "");
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {error}");
    assert!(error.contains(words), "{error}");
}

#[test]
fn from_a_model_to_the_printer() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (url, seen) = moonraker();
    let add = ["printers", "add", "shop", "--host", "moonraker", "--url"];
    let add = [&add[..], &[&url]].concat();
    works(folder, &[&add[..], &["--model", "MK4"]].concat(), SECRET);
    fails(folder, &add, "--replace");
    let list = works(folder, &["printers"], "");
    assert!(list.contains("shop") && list.contains(&url), "{list}");
    let test = works(folder, &["printers", "test", "shop"], "");
    assert!(test.contains("standby"), "{test}");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let file = folder.join("profiles/printers.toml");
        let mode = fs::metadata(file).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
    }

    let model = ["-e", "sqrt(x^2+y^2+z^2) - 4", "-o", "part.gcode", "-q"];
    let slice = [&["slice"], &model[..]].concat();
    // A name that is not known costs no time, and leaves no file.
    let wrong = [&slice[..], &["--send", "shed"]].concat();
    fails(folder, &wrong, "there is no printer shed; there are shop");
    assert!(!folder.join("part.gcode").exists());
    let right = ["--send", "shop", "--printer", "prusa-mk4"];
    works(folder, &[&slice[..], &right].concat(), "");
    let sent = fs::read(folder.join("part.gcode")).unwrap();
    assert!(seen.lock().unwrap().file == sent);
    let started = || {
        let seen = seen.lock().unwrap();
        seen.requests.iter().any(|r| r.contains("print/start"))
    };
    assert!(!started());
    let told = works(folder, &["send", "part.gcode", "--to", "shop"], "");
    assert_eq!(told, "part.gcode is stored on shop\n");
    assert!(!started());
    let start = ["send", "part.gcode", "--to", "shop", "--start"];
    let told = works(folder, &start, "");
    assert_eq!(told, "part.gcode is being printed on shop\n");
    assert!(started());

    // This file is made for another printer.
    let other = [&slice[..], &["--printer", "prusa-xl"]].concat();
    works(folder, &other, "");
    fails(folder, &start, "made for another printer");
    works(folder, &[&start[..], &["--force"]].concat(), "");
    // This file does not say for which printer it is made.
    works(folder, &slice, "");
    fails(folder, &start, "does not say for which printer it was made");
    works(folder, &[&start[..], &["--force"]].concat(), "");

    works(folder, &["printers", "remove", "shop"], "");
    fails(folder, &start, "there is no printer shop");
}

#[test]
fn keys_and_files_that_are_wrong_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (url, seen) = moonraker();
    let add = ["printers", "add", "shop", "--host", "moonraker", "--url"];
    let add = [&add[..], &[&url, "--replace"]].concat();
    fails(folder, &add, "there is no key on standard input");
    works(folder, &add, "wrong");
    fs::write(folder.join("part.gcode"), "G28\n").unwrap();
    fs::write(folder.join("part.stl"), "solid\n").unwrap();
    let send = ["send", "part.gcode", "--to", "shop"];
    fails(folder, &send, "refuses the key");
    let keyed = [&add[..], &["--key-env", "ISOSLICE_TEST_KEY"]].concat();
    works(folder, &keyed, "");
    works(folder, &send, "");
    assert_eq!(seen.lock().unwrap().file, b"G28\n");
    let unset = [&add[..], &["--key-env", "ISOSLICE_TEST_NONE"]].concat();
    works(folder, &unset, "");
    fails(folder, &send, "ISOSLICE_TEST_NONE, which is not set");
    fails(
        folder,
        &["send", "part.stl", "--to", "shop"],
        "does not end in .gcode",
    );
    fails(
        folder,
        &["send", "no.gcode", "--to", "shop"],
        "there is no file",
    );
    let bad = ["printers", "add", "a b", "--host", "moonraker", "--url"];
    fails(
        folder,
        &[&bad[..], &["http://a", "--no-key"]].concat(),
        "name",
    );
    let bad = ["printers", "add", "a", "--host", "moonraker", "--no-key"];
    fails(
        folder,
        &[&bad[..], &["--url", "a.local"]].concat(),
        "no address",
    );
}

/// Who sends a file is told whom it waits for, and how to end that.
#[test]
fn a_host_that_says_nothing_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // The system takes connections in for a program that never does.
    let silent = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", silent.local_addr().unwrap());
    let add = ["printers", "add", "shop", "--host", "moonraker", "--url"];
    works(folder, &[&add[..], &[&url]].concat(), SECRET);
    fs::write(folder.join("part.gcode"), "G28\n").unwrap();
    let output = isoslice(folder)
        .args(["send", "part.gcode", "--to", "shop"])
        // The first message comes after 10 s.
        .timeout(Duration::from_secs(16))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success());
    assert!(told.contains("shop") && told.contains("Ctrl-C"), "{told}");
}

#[test]
fn the_page_sends_what_it_shows() {
    let folder = tempfile::tempdir().unwrap();
    let (url, seen) = moonraker();
    let add = ["printers", "add", "shop", "--host", "moonraker", "--url"];
    works(folder.path(), &[&add[..], &[&url]].concat(), SECRET);
    fs::write(folder.path().join("part.rhai"), "sphere(4)").unwrap();
    let profiles = ["--profiles", "profiles"];
    let watch =
        Watch::start(folder.path(), &[&["part.rhai"], &profiles[..]].concat());
    let state = watch.done();
    assert_eq!(state["printers"], json!(["shop"]));
    let print = state["print"]["revision"].as_u64().unwrap();
    let order = json!({ "to": "shop", "start": true, "print": print });
    assert_eq!(watch.post("send", &order.to_string()).code, 200);
    let state = watch.state(|state| state["sending"]["busy"] == false);
    assert_eq!(
        state["sending"]["text"],
        "part.gcode is being printed on shop"
    );
    let gcode = watch.get(&format!("gcode?print={print}")).body;
    assert!(seen.lock().unwrap().file == gcode);
    let order = json!({ "to": "shed", "start": true, "print": print });
    assert_eq!(watch.post("send", &order.to_string()).code, 200);
    let state = watch.state(|state| state["sending"]["busy"] == false);
    let text = state["sending"]["text"].as_str().unwrap();
    assert!(text.contains("there is no printer shed"), "{text}");
}
