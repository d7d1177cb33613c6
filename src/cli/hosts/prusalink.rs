//! PrusaLink's words, version 1,
//! <https://github.com/prusa3d/Prusa-Link-Web/blob/master/spec/openapi.yaml>.

use super::client::{Answer, Client};
use super::{Host, HostError, Status, Upload};
use serde_json::{Value, json};
use std::io::Read;
use std::thread::sleep;
use std::time::{Duration, Instant};

pub(super) struct PrusaLink {
    /// Name of the storage to use. If none is given, the first storage that can
    /// be written is used.
    pub storage: Option<String>,
}

/// A place for files.
struct Storage {
    name: String,
    free: Option<u64>,
}

/// Greatest time until a file that has arrived is listed.
const LISTED: Duration = Duration::from_secs(if cfg!(test) { 1 } else { 10 });

/// Time between two looks at the list.
const AGAIN: Duration = Duration::from_millis(300);

impl PrusaLink {
    /// Waits until a file is listed with its whole length. PrusaLink on a
    /// Raspberry Pi looks for new files once a second; until then it knows
    /// nothing of a file that it has just stored, or an older one's length.
    fn wait_for(&self, client: &Client, name: &str, length: u64) {
        let start = Instant::now();
        let is_there = || {
            let there = self.size(client, name);
            there.is_ok_and(|there| there == length)
        };
        while !is_there() && start.elapsed() < LISTED {
            sleep(AGAIN);
        }
    }

    fn storage(&self, client: &Client) -> Result<Storage, HostError> {
        let answer =
            client.done(client.get("api/v1/storage")?, "list places")?;
        let list = answer.json.pointer("/storage_list");
        let list = list.and_then(Value::as_array);
        let list = list.ok_or_else(|| client.stranger("it has no storage"))?;
        let mut known = Vec::new();
        let mut away = Vec::new();
        for storage in list {
            let path = storage["path"].as_str().unwrap_or_default();
            let name = path.trim_matches('/');
            let plain = name.chars().all(|c| {
                c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | ' ')
            });
            let can = plain
                && !name.is_empty()
                && storage["available"] != json!(false)
                && storage["read_only"] != json!(true);
            if !can {
                if plain && storage["available"] == json!(false) {
                    away.push(name);
                }
                continue;
            }
            if self.storage.as_deref().is_none_or(|wanted| wanted == name) {
                return Ok(Storage {
                    name: name.to_owned(),
                    free: storage["free_space"].as_u64(),
                });
            }
            known.push(name);
        }
        let why = match &self.storage {
            Some(wanted) => {
                format!("there is no place {wanted} (only {known:?})")
            }
            // On a Raspberry Pi its own folder is away while no printer is
            // connected.
            None if !away.is_empty() => format!(
                "{} is not available; connect the printer, and put in a USB \
                 drive or a card",
                away.join(", ")
            ),
            None => "it has no place for files; put in a USB drive or a card"
                .to_owned(),
        };
        Err(HostError::Refused {
            host: client.name(),
            what: "store files".to_owned(),
            why,
        })
    }
}

impl Host for PrusaLink {
    fn status(&self, client: &Client) -> Result<Status, HostError> {
        let program = client.program(|text| text.contains("PrusaLink"))?;
        let status = client.get("api/v1/status")?;
        let state = client.text(&status, "/printer/state")?;
        let ready = ["IDLE", "READY", "FINISHED", "STOPPED"];
        let free = match self.storage(client) {
            Ok(storage) => storage.free,
            // The state is worth telling even so; the upload says what is
            // missing.
            Err(HostError::Refused { .. }) if self.storage.is_none() => None,
            Err(error) => return Err(error),
        };
        Ok(Status {
            program,
            ready: ready.contains(&state.as_str()),
            state: state.to_lowercase(),
            free,
        })
    }

    fn upload(
        &self,
        client: &Client,
        name: &str,
        file: &mut Upload<'_>,
    ) -> Result<String, HostError> {
        let storage = self.storage(client)?.name;
        let name = format!("{storage}/{name}");
        let length = file.length;
        // PrusaLink on a Raspberry Pi looks for the file's kind in the wrong
        // place if the kind is not said (0.8.1). The header
        // `Print-After-Upload` is left out. Nothing is printed without it, and
        // a server might misread it.
        let kind = if name.ends_with(".bgcode") {
            "application/octet-stream"
        } else {
            "text/x.gcode"
        };
        let headers = [("Content-Type", kind), ("Overwrite", "?1")];
        let mut body = file.take(length);
        let answer =
            client.send("PUT", &path(&name), &headers, length, &mut body)?;
        client.done(answer, "store the file")?;
        self.wait_for(client, &name, length);
        Ok(name)
    }

    fn size(&self, client: &Client, name: &str) -> Result<u64, HostError> {
        let answer = client.get(&path(name))?;
        let answer: Answer = client.done(answer, "show the file")?;
        client.bytes(&answer, "/size")
    }

    fn start(&self, client: &Client, name: &str) -> Result<(), HostError> {
        let answer = client.post(&path(name), &json!({}))?;
        client.done(answer, "start the print").map(drop)
    }
}

/// The address of a file. Its name has plain letters only; a storage's name may
/// have spaces.
fn path(name: &str) -> String {
    format!("api/v1/files/{}", name.replace(' ', "%20"))
}
