//! The clients, against hosts that behave and hosts that do not.

use super::*;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

const ALL: [HostKind; 3] = [
    HostKind::OctoPrint,
    HostKind::Moonraker,
    HostKind::PrusaLink,
];

const SECRET: &str = "S3CRET-key";

/// A request that a host got.
#[derive(Clone, Debug, Default)]
struct Asked {
    method: String,
    path: String,
    head: String,
    body: Vec<u8>,
}

type Log = Arc<Mutex<Vec<Asked>>>;

/// Reads a request, or what there is of it.
fn read_request(stream: &TcpStream) -> Option<Asked> {
    let mut reader = BufReader::new(stream);
    let mut asked = Asked::default();
    loop {
        let mut line = String::new();
        if reader.read_line(&mut line).ok()? == 0 {
            return None;
        }
        if line == "\r\n" {
            break;
        }
        asked
            .head
            .push_str(&line.to_lowercase().replace("s3cret", "S3CRET"));
        if asked.path.is_empty() {
            let mut words = line.split(' ').map(str::to_owned);
            asked.method = words.next()?;
            asked.path = words.next()?;
        }
    }
    let length = asked.head.split_once("content-length: ");
    let length = length.map_or("0", |(_, rest)| rest.lines().next().unwrap());
    let mut body = vec![0; length.parse().unwrap()];
    reader.read_exact(&mut body).ok()?;
    asked.body = body;
    Some(asked)
}

/// A host that answers each request by itself.
fn serve(
    answer: impl Fn(&Asked) -> (u16, String) + Send + 'static,
) -> (String, Log) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", listener.local_addr().unwrap());
    let log = Log::default();
    let kept = log.clone();
    thread::spawn(move || {
        for stream in listener.incoming() {
            let Ok(mut stream) = stream else { return };
            let Some(asked) = read_request(&stream) else {
                continue;
            };
            let (code, text) = answer(&asked);
            kept.lock().unwrap().push(asked);
            let head = if (300..=399).contains(&code) {
                format!("Location: {text}\r\n")
            } else {
                String::new()
            };
            let _ = write!(
                stream,
                "HTTP/1.1 {code} X\r\n{head}Content-Length: {}\r\n\
                 Connection: close\r\n\r\n{text}",
                text.len()
            );
        }
    });
    (url, log)
}

fn printer(kind: HostKind, url: &str) -> Printer {
    Printer {
        name: "workshop".into(),
        kind,
        url: url.into(),
        key: Some(Key::new(SECRET)),
        key_env: None,
        model: None,
        ca: None,
        storage: None,
    }
}

/// The answer of a host of this kind that does all it should.
fn good(kind: HostKind, asked: &Asked, size: u64) -> (u16, Value) {
    let path = asked.path.as_str();
    let known = match (kind, asked.method.as_str()) {
        (HostKind::OctoPrint, "GET") => match path {
            "/api/version" => json!({"text": "OctoPrint 1.11"}),
            "/api/job" => json!({"state": "Operational"}),
            "/api/files" => json!({"free": 1_000_000, "files": []}),
            "/api/files/local/my%5Fpart%2Egcode" => json!({ "size": size }),
            _ => return (404, json!({})),
        },
        (HostKind::OctoPrint, _) => match path {
            "/api/files/local" => {
                json!({"files": {"local": {"path": "my_part.gcode"}}})
            }
            "/api/files/local/my%5Fpart%2Egcode" => return (204, json!(null)),
            _ => return (404, json!({})),
        },
        (HostKind::Moonraker, "GET") => match path {
            "/server/info" => json!({"result": {
                "klippy_state": "ready", "moonraker_version": "v0.9"}}),
            "/server/files/directory?path=gcodes" => {
                json!({"result": {"disk_usage": {"free": 1_000_000}}})
            }
            "/printer/objects/query?print_stats" => json!({"result": {
                "status": {"print_stats": {"state": "standby"}}}}),
            "/server/files/metadata?filename=my%5Fpart%2Egcode" => {
                json!({"result": {"size": size}})
            }
            _ => return (404, json!({})),
        },
        (HostKind::Moonraker, _) => match path {
            "/server/files/upload" => {
                json!({"item": {"path": "my_part.gcode"}})
            }
            "/printer/print/start" => json!({"result": "ok"}),
            _ => return (404, json!({})),
        },
        (HostKind::PrusaLink, "GET") => match path {
            "/api/version" => json!({"text": "PrusaLink", "api": "2.0.0"}),
            "/api/v1/status" => json!({"printer": {"state": "IDLE"}}),
            "/api/v1/storage" => json!({"storage_list": [
                {"path": "/local/", "read_only": true, "available": true},
                {"path": "/usb/", "free_space": 1_000_000, "available": true},
            ]}),
            "/api/v1/files/usb/my_part.gcode" => json!({ "size": size }),
            _ => return (404, json!({})),
        },
        (HostKind::PrusaLink, _) => match path {
            "/api/v1/files/usb/my_part.gcode" => return (201, json!({})),
            _ => return (404, json!({})),
        },
    };
    (200, known)
}

const GCODE: &[u8] = b"G28\nG1 X1 E1\n";

/// Sends some G-code.
fn try_to_send(printer: &Printer, start: bool) -> Result<Sent, HostError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.gcode");
    std::fs::write(&path, GCODE).unwrap();
    let sending = Sending {
        name: "my part.gcode",
        start,
        on_progress: &|_, _| {},
    };
    send(printer, &path, &sending)
}

/// A host that does all it should, except where `odd` answers a request.
fn odd_host(
    kind: HostKind,
    odd: impl Fn(&Asked) -> Option<(u16, Value)> + Send + 'static,
) -> (Printer, Log) {
    let (url, log) = serve(move |asked| {
        let size = GCODE.len() as u64;
        let answer = odd(asked).unwrap_or_else(|| good(kind, asked, size));
        (answer.0, answer.1.to_string())
    });
    (printer(kind, &url), log)
}

fn is_upload(asked: &Asked) -> bool {
    asked.body.windows(GCODE.len()).any(|w| w == GCODE)
}

#[test]
fn a_file_arrives_whole_and_is_started_last() {
    for kind in ALL {
        let (printer, log) = odd_host(kind, |_| None);
        let sent = try_to_send(&printer, true).unwrap();
        assert!(sent.started, "{kind:?}");
        let log = log.lock().unwrap();
        let posts: Vec<_> = log.iter().filter(|a| a.method != "GET").collect();
        assert_eq!(posts.len(), 2, "{kind:?}");
        assert!(is_upload(posts[0]), "{kind:?}");
        let last = log.last().unwrap();
        assert_eq!(last.method, "POST", "{kind:?}");
        // The size is asked for between the upload and the start.
        assert_eq!(log[log.len() - 2].method, "GET", "{kind:?}");
        assert!(!is_upload(last), "{kind:?}");
        let key = format!("x-api-key: {SECRET}\r\n");
        assert!(log.iter().all(|asked| asked.head.contains(&key)));
    }
}

#[test]
fn a_form_is_what_servers_expect() {
    let (printer, log) = odd_host(HostKind::OctoPrint, |_| None);
    try_to_send(&printer, false).unwrap();
    let log = log.lock().unwrap();
    let upload = log.iter().find(|asked| is_upload(asked)).unwrap();
    let text = String::from_utf8(upload.body.clone()).unwrap();
    assert!(text.starts_with("--isoslice-"), "{text}");
    assert!(text.ends_with("--\r\n"), "{text}");
    assert!(text.contains("name=\"print\"\r\n\r\nfalse\r\n"), "{text}");
    assert!(text.contains("filename=\"my_part.gcode\"\r\n"), "{text}");
    assert!(
        log.iter()
            .all(|asked| !asked.path.ends_with("2Egcode")
                || asked.method == "GET")
    );
}

#[test]
fn a_wrong_key_is_said_and_not_shown() {
    for kind in ALL {
        for code in [401, 403] {
            let (printer, _) =
                odd_host(kind, move |_| Some((code, json!({"error": SECRET}))));
            let error = try_to_send(&printer, true).unwrap_err();
            assert!(matches!(error, HostError::Key { .. }), "{error}");
            assert!(!error.to_string().contains(SECRET), "{error}");
            assert!(!format!("{printer:?}").contains(SECRET));
        }
        for code in [400, 500] {
            let (printer, _) =
                odd_host(kind, move |_| Some((code, json!({"error": SECRET}))));
            let error = try_to_send(&printer, true).unwrap_err();
            assert!(!matches!(error, HostError::Key { .. }), "{error}");
            assert!(!error.to_string().contains(SECRET), "{error}");
        }
    }
}

#[test]
fn nothing_is_sent_to_a_full_or_busy_host() {
    let full: [(_, &'static str, Value); 3] = [
        (HostKind::OctoPrint, "/api/files", json!({"free": 5})),
        (
            HostKind::Moonraker,
            "/server/files/directory?path=gcodes",
            json!({"result": {"disk_usage": {"free": 5}}}),
        ),
        (
            HostKind::PrusaLink,
            "/api/v1/storage",
            json!({"storage_list": [{"path": "/usb/", "free_space": 5}]}),
        ),
    ];
    for (kind, path, answer) in full {
        let (printer, log) = odd_host(kind, move |asked| {
            (asked.path == path).then(|| (200, answer.clone()))
        });
        let error = try_to_send(&printer, false).unwrap_err();
        assert!(matches!(error, HostError::Full { free: 5, .. }), "{error}");
        assert!(!log.lock().unwrap().iter().any(is_upload));
    }
    let busy: [(_, &'static str, Value); 3] = [
        (
            HostKind::OctoPrint,
            "/api/job",
            json!({"state": "Printing"}),
        ),
        (
            HostKind::Moonraker,
            "/printer/objects/query?print_stats",
            json!({"result": {"status": {"print_stats":
                {"state": "printing"}}}}),
        ),
        (
            HostKind::PrusaLink,
            "/api/v1/status",
            json!({"printer": {"state": "PRINTING"}}),
        ),
    ];
    for (kind, path, answer) in busy {
        let (printer, log) = odd_host(kind, move |asked| {
            (asked.path == path).then(|| (200, answer.clone()))
        });
        let error = try_to_send(&printer, true).unwrap_err();
        assert!(matches!(error, HostError::NotReady { .. }), "{error}");
        assert!(!log.lock().unwrap().iter().any(is_upload));
        assert!(!try_to_send(&printer, false).unwrap().started);
    }
}

#[test]
fn a_place_that_is_away_is_told_before_anything_is_sent() {
    // PrusaLink 0.8.1 answers in this way without a printer.
    let (printer, log) = odd_host(HostKind::PrusaLink, |asked| {
        let answer = match asked.path.as_str() {
            "/api/v1/storage" => json!({"storage_list": [
                {"type": "LOCAL", "path": "/local", "available": false},
                {"type": "SDCARD", "path": "/sdcard", "available": false}]}),
            "/api/v1/status" => json!({"printer": {"state": "ERROR"}}),
            _ => return None,
        };
        Some((200, answer))
    });
    let error = try_to_send(&printer, false).unwrap_err().to_string();
    let said = "local, sdcard is not available; connect the printer";
    assert!(error.contains(said), "{error}");
    let error = try_to_send(&printer, true).unwrap_err();
    assert!(matches!(error, HostError::NotReady { .. }), "{error}");
    assert!(!log.lock().unwrap().iter().any(is_upload));
}

#[test]
fn a_file_that_is_listed_a_little_later_is_whole() {
    let looks = AtomicUsize::new(0);
    let (printer, log) = odd_host(HostKind::PrusaLink, move |asked| {
        let is_file = asked.method == "GET" && asked.path.ends_with(".gcode");
        let look = if is_file {
            looks.fetch_add(1, Ordering::SeqCst)
        } else {
            return None;
        };
        match look {
            0 => Some((404, json!({"message": "File you want was not found"}))),
            1 => Some((200, json!({"size": 1}))),
            _ => None,
        }
    });
    assert!(try_to_send(&printer, true).unwrap().started);
    assert_eq!(
        log.lock().unwrap().iter().filter(|a| is_upload(a)).count(),
        1
    );
}

/// A file of that name might be an older one, as long as the new one.
#[test]
fn a_host_that_tells_of_another_file_starts_none() {
    for told in ["old.gcode", "../my_part.gcode", "a/my_part.gcode", ""] {
        for kind in [HostKind::OctoPrint, HostKind::Moonraker] {
            let (printer, log) = odd_host(kind, move |asked| {
                let answer = json!({
                    "files": {"local": {"path": told}},
                    "item": {"path": told},
                });
                is_upload(asked).then_some((201, answer))
            });
            let error = try_to_send(&printer, true).unwrap_err();
            assert!(matches!(error, HostError::Renamed { .. }), "{error}");
            assert!(is_upload(log.lock().unwrap().last().unwrap()), "{told}");
        }
    }
}

#[test]
fn what_arrives_in_part_is_not_started() {
    for kind in ALL {
        let (url, log) = serve(move |asked| {
            let answer = good(kind, asked, GCODE.len() as u64 - 1);
            (answer.0, answer.1.to_string())
        });
        let error = try_to_send(&printer(kind, &url), true).unwrap_err();
        assert!(matches!(error, HostError::Incomplete { .. }), "{error}");
        let log = log.lock().unwrap();
        assert_eq!(log.iter().filter(|a| a.method != "GET").count(), 1);
    }
}

#[test]
fn a_refusal_is_told_in_the_hosts_words() {
    for (code, answer, words) in [
        (
            409,
            json!({"error": "Printer is\non fire"}),
            "Printer is on fire",
        ),
        (507, json!(null), "no room"),
        (500, json!({"error": {"message": "no card"}}), "no card"),
    ] {
        let (printer, log) = odd_host(HostKind::Moonraker, move |asked| {
            (asked.method == "POST").then(|| (code, answer.clone()))
        });
        let error = try_to_send(&printer, true).unwrap_err();
        assert!(matches!(error, HostError::Refused { .. }), "{error}");
        assert!(error.to_string().contains(words), "{error}");
        let log = log.lock().unwrap();
        assert_eq!(log.iter().filter(|a| a.method == "POST").count(), 1);
    }
}

#[test]
fn the_key_does_not_follow_to_another_address() {
    let (elsewhere, other) = serve(|_| (200, "{}".to_owned()));
    let (url, _) = serve(move |_| (302, elsewhere.clone()));
    let printer = printer(HostKind::OctoPrint, &url);
    let error = status(&printer).unwrap_err();
    assert!(matches!(error, HostError::Elsewhere { .. }), "{error}");
    assert!(other.lock().unwrap().is_empty());
}

#[test]
fn strangers_are_told_from_hosts() {
    let deep = "[".repeat(1_000_000);
    let long = "x".repeat(20 << 20);
    for answer in [
        "<html>",
        "{}",
        "{\"text\": \"OctoPreen 1\"}",
        "",
        &deep,
        &long,
    ] {
        let answer = answer.to_owned();
        let (url, _) = serve(move |_| (200, answer.clone()));
        for kind in ALL {
            let error = status(&printer(kind, &url)).unwrap_err();
            assert!(matches!(error, HostError::Stranger { .. }), "{error}");
            assert!(error.to_string().len() < 800);
        }
    }
}

/// A host that does with each connection what it is told, and no more.
fn bad_host(treat: impl Fn(TcpStream) + Send + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", listener.local_addr().unwrap());
    thread::spawn(move || listener.incoming().flatten().for_each(treat));
    url
}

#[test]
fn a_host_that_vanishes_or_is_silent_is_an_error_in_time() {
    let start = Instant::now();
    let gone = bad_host(drop);
    let silent = bad_host(|stream| {
        thread::spawn(move || {
            thread::sleep(Duration::from_secs(20));
            drop(stream);
        });
    });
    let slow = bad_host(|mut stream| {
        thread::spawn(move || {
            let _ = stream.write_all(b"HTTP/1.1 200 OK\r\nA: ");
            while stream.write_all(b"a").is_ok() {
                thread::sleep(Duration::from_millis(100));
            }
        });
    });
    for url in [gone, silent, slow] {
        let error = status(&printer(HostKind::OctoPrint, &url)).unwrap_err();
        assert!(matches!(error, HostError::Vanished { .. }), "{error}");
    }
    // Far from any limit on a slow machine, and from waiting for ever.
    assert!(start.elapsed() < Duration::from_secs(19));
}

#[test]
fn a_host_that_vanishes_during_the_upload_is_an_error() {
    let url = bad_host(|mut stream| {
        let mut line = String::new();
        let _ = BufReader::new(&stream).read_line(&mut line);
        let path = line.split(' ').nth(1).unwrap_or_default();
        let asked = Asked {
            method: line.split(' ').next().unwrap_or_default().into(),
            path: path.into(),
            ..Asked::default()
        };
        if asked.method == "POST" {
            return;
        }
        let text = good(HostKind::Moonraker, &asked, 0).1.to_string();
        let _ = write!(
            stream,
            "HTTP/1.1 200 OK\r\nContent-Length: {}\r\nConnection: close\
             \r\n\r\n{text}",
            text.len()
        );
    });
    let error =
        try_to_send(&printer(HostKind::Moonraker, &url), true).unwrap_err();
    assert!(matches!(error, HostError::Vanished { .. }), "{error:?}");
}

#[test]
fn faults_of_tls_and_of_addresses_are_told() {
    let (url, _) = serve(|_| (200, "{}".to_owned()));
    let secure = url.replace("http:", "https:");
    let error = status(&printer(HostKind::OctoPrint, &secure)).unwrap_err();
    assert!(
        matches!(error, HostError::Tls { .. } | HostError::Vanished { .. }),
        "{error:?}"
    );
    for url in [
        "",
        "octopi.local",
        "ftp://octopi.local",
        "http://",
        "http://me:secret@octopi.local",
        "http://octopi.local/?a=b",
        "http://octopi local",
        "http://octopi.local:99999",
        "http://octopi.local:0",
        "http://octopi.local:",
        "http://[::1]:70000",
    ] {
        let error = status(&printer(HostKind::OctoPrint, url)).unwrap_err();
        assert!(matches!(error, HostError::Address { .. }), "{url}: {error}");
    }
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", free.local_addr().unwrap());
    drop(free);
    // No computer has a name with this ending.
    for url in [&*url, "http://octopi.invalid"] {
        let error = status(&printer(HostKind::OctoPrint, url)).unwrap_err();
        assert!(matches!(error, HostError::Unreachable { .. }), "{error:?}");
    }
}

#[test]
fn names_are_plain() {
    for (given, plain) in [
        ("part.gcode", "part.gcode"),
        ("../../etc/passwd", "_.._etc_passwd"),
        ("ä b\r\n\".gcode", "__b____.gcode"),
        (".gcode", "part.gcode"),
        ("", "part.gcode"),
        ("part", "part.gcode"),
    ] {
        let name = plain_name(given);
        assert!(!name.contains(['/', '"', '\r', '\n', ' ']), "{name}");
        assert!(!name.starts_with('.'), "{name}");
        if !given.contains("..") && !given.contains('ä') {
            assert_eq!(name, plain);
        }
    }
    assert!(plain_name(&"x".repeat(999)).len() < 120);
}

#[test]
fn the_file_of_printers_is_private_and_keeps_what_it_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut book = PrinterBook::open(folder.path()).unwrap();
    let known = printer(HostKind::Moonraker, "http://192.168.1.20:7125/");
    book.add(known.clone()).unwrap();
    let mut other = known.clone();
    other.name = "no name".into();
    assert!(matches!(
        book.add(other),
        Err(super::book::BookError::Name(_))
    ));
    for bad in ["http://octopi.local:99999", "octopi.local"] {
        let url = bad.into();
        let printer = Printer {
            url,
            ..known.clone()
        };
        let error = book.add(printer).unwrap_err().to_string();
        assert!(error.contains("no address"), "{error}");
    }
    for bad in ["a\nb", "a\r\nX-Other: b", "a b", "ä"] {
        let printer = Printer {
            key: Some(Key::new(bad)),
            ..known.clone()
        };
        let error = book.add(printer).unwrap_err().to_string();
        assert!(error.contains("characters that no key has"), "{error}");
    }
    let again = PrinterBook::open(folder.path()).unwrap();
    assert_eq!(again.find("workshop").unwrap(), &known);
    assert!(!again.is_open_to_others());
    let error = again.find("workshed").unwrap_err().to_string();
    assert!(error.contains("there are workshop"), "{error}");
    book.remove("workshop").unwrap();
    assert_eq!(
        PrinterBook::open(folder.path()).unwrap().printers().count(),
        0
    );

    // A message about a mistake in the file leaves the line out, which may have
    // a key.
    let text = format!("[a]\nkind = \"moonraker\"\nkey = \"{SECRET}\" x\n");
    std::fs::write(folder.path().join("printers.toml"), text).unwrap();
    let error = PrinterBook::open(folder.path()).unwrap_err().to_string();
    assert!(error.contains("line 3"), "{error}");
    assert!(!error.contains(SECRET), "{error}");
    // A message about a value in a table's place leaves the value out, too.
    for key in [format!("\"{SECRET}\""), "12345678".to_owned()] {
        let text = format!("key = {key}\n");
        std::fs::write(folder.path().join("printers.toml"), text).unwrap();
        let error = PrinterBook::open(folder.path()).unwrap_err().to_string();
        assert!(error.contains("line 1"), "{error}");
        assert!(!error.contains(key.trim_matches('"')), "{error}");
    }
}

#[test]
fn keys_come_from_the_environment_too() {
    let mut printer = printer(HostKind::OctoPrint, "http://127.0.0.1:1");
    printer.key_env = Some("ISOSLICE_TEST_NO_SUCH_VARIABLE".into());
    let error = status(&printer).unwrap_err();
    assert!(matches!(error, HostError::NoKey { .. }), "{error}");
    printer.key_env = None;
    printer.key = Some(Key::new("a\nb"));
    let error = status(&printer).unwrap_err();
    assert!(matches!(error, HostError::BadKey { .. }), "{error}");
}
