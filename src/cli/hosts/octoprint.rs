//! OctoPrint's words, <https://docs.octoprint.org/en/master/api/files.html>.

use super::client::Client;
use super::multipart::store;
use super::{Host, HostError, Status, Upload};
use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::json;

pub(super) struct OctoPrint;

impl Host for OctoPrint {
    fn status(&self, client: &Client) -> Result<Status, HostError> {
        let program = client.program(|text| text.starts_with("OctoPrint"))?;
        let job = client.get("api/job")?;
        let state = client.text(&job, "/state")?;
        let files = client.get("api/files")?;
        Ok(Status {
            ready: state == "Operational",
            program,
            state,
            free: client.bytes(&files, "/free").ok(),
        })
    }

    fn upload(
        &self,
        client: &Client,
        name: &str,
        file: &mut Upload<'_>,
    ) -> Result<String, HostError> {
        let fields = [("select", "false"), ("print", "false")];
        let path = "api/files/local";
        let answer = store(client, path, &fields, name, file)?;
        client.stored(&answer, "/files/local/path", name)
    }

    fn size(&self, client: &Client, name: &str) -> Result<u64, HostError> {
        let answer = client.get(&path(name))?;
        let answer = client.done(answer, "show the file")?;
        client.bytes(&answer, "/size")
    }

    fn start(&self, client: &Client, name: &str) -> Result<(), HostError> {
        let command = json!({ "command": "select", "print": true });
        let answer = client.post(&path(name), &command)?;
        client.done(answer, "start the print").map(drop)
    }
}

/// The address of a file, whatever name the host gave it.
fn path(name: &str) -> String {
    let parts = name.split('/');
    let parts =
        parts.map(|p| utf8_percent_encode(p, NON_ALPHANUMERIC).to_string());
    format!("api/files/local/{}", parts.collect::<Vec<_>>().join("/"))
}
