//! A running `isoslice watch`, and requests to it.

// Each test file is a crate of its own and uses its share of this.
#![allow(dead_code, reason = "no test file uses everything")]

use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Time after which a test gives up: much longer than anything takes.
const PATIENCE: Duration = Duration::from_secs(120);

/// A running `isoslice watch`, which ends with it.
pub struct Watch {
    child: Child,
    pub port: u16,
    pub secret: String,
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// An answer: its code, its head and its body.
pub struct Answer {
    pub code: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    /// What JSON says.
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap()
    }
}

impl Watch {
    /// Starts the server in a folder, which also has the profiles and printers.
    pub fn start(folder: &Path, arguments: &[&str]) -> Watch {
        let mut child = Command::new(assert_cmd::cargo::cargo_bin!("isoslice"))
            .args(["watch", "--threads", "2"])
            .args(arguments)
            .current_dir(folder)
            .env("ISOSLICE_PROFILES", folder)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let address = lines.find_map(|line| {
            let line = line.unwrap();
            line.strip_prefix("http://127.0.0.1:").map(str::to_owned)
        });
        let address = address.unwrap();
        let (port, secret) = address.split_once('/').unwrap();
        Watch {
            port: port.parse().unwrap(),
            secret: secret.trim_end_matches('/').to_owned(),
            child,
        }
    }

    /// Sends bytes as they are, and reads the answer.
    pub fn raw(&self, bytes: &[u8]) -> Option<Answer> {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        // The server may answer, and close, before it has read everything.
        let _ = stream.write_all(bytes);
        let mut all = Vec::new();
        let _ = stream.read_to_end(&mut all);
        let end = all.windows(4).position(|w| w == b"\r\n\r\n")? + 4;
        let head = String::from_utf8_lossy(&all[..end]).to_lowercase();
        let mut body = all[end..].to_vec();
        if head.contains("chunked") {
            body = unchunked(&body);
        }
        Some(Answer {
            code: head.split(' ').nth(1)?.parse().ok()?,
            head,
            body,
        })
    }

    /// Asks with more lines of the head.
    pub fn ask(
        &self,
        method: &str,
        path: &str,
        head: &str,
        body: &str,
    ) -> Answer {
        let request = format!(
            "{method} /{}/{path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\
             Connection: close\r\nContent-Length: {}\r\n{head}\r\n{body}",
            self.secret,
            self.port,
            body.len()
        );
        self.raw(request.as_bytes()).unwrap()
    }

    /// Asks as the page does.
    pub fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, "", "")
    }

    /// Sends JSON as the page does.
    pub fn post(&self, path: &str, body: &str) -> Answer {
        self.ask("POST", path, "Content-Type: application/json\r\n", body)
    }

    /// Waits for a state.
    pub fn state(&self, until: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        let mut seen = 0;
        while start.elapsed() < PATIENCE {
            let state = self.get(&format!("state?seen={seen}")).json();
            if until(&state) {
                return state;
            }
            seen = state["revision"].as_u64().unwrap();
        }
        panic!("this state did not come");
    }

    /// Waits until all is done.
    pub fn done(&self) -> Value {
        self.state(|state| state["busy"].is_null())
    }
}

fn unchunked(mut body: &[u8]) -> Vec<u8> {
    let mut whole = Vec::new();
    loop {
        let end = body.windows(2).position(|w| w == b"\r\n").unwrap();
        let size = std::str::from_utf8(&body[..end]).unwrap();
        let size = usize::from_str_radix(size, 16).unwrap();
        if size == 0 {
            return whole;
        }
        whole.extend_from_slice(&body[end + 2..][..size]);
        body = &body[end + size + 4..];
    }
}
