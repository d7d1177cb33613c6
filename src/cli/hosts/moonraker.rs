//! Moonraker's words, <https://moonraker.readthedocs.io/en/latest/external_api/>.

use super::client::Client;
use super::multipart::store;
use super::{Host, HostError, Status, Upload};
use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::json;

pub(super) struct Moonraker;

impl Host for Moonraker {
    fn status(&self, client: &Client) -> Result<Status, HostError> {
        let info = client.first("server/info")?;
        let klippy = client.text(&info, "/result/klippy_state")?;
        let version = client.text(&info, "/result/moonraker_version");
        let folder = client.get("server/files/directory?path=gcodes")?;
        let free = client.bytes(&folder, "/result/disk_usage/free").ok();
        let program =
            format!("Moonraker {}", version.as_deref().unwrap_or_default());
        let mut status = Status {
            program: program.trim_end().to_owned(),
            ready: false,
            state: format!("not connected (Klipper is {klippy})"),
            free,
        };
        if klippy == "ready" {
            let print = client.get("printer/objects/query?print_stats")?;
            let place = "/result/status/print_stats/state";
            status.state = client.text(&print, place)?;
            let busy = ["printing", "paused"];
            status.ready = !busy.contains(&status.state.as_str());
        }
        Ok(status)
    }

    fn upload(
        &self,
        client: &Client,
        name: &str,
        file: &mut Upload<'_>,
    ) -> Result<String, HostError> {
        let fields = [("root", "gcodes"), ("print", "false")];
        let path = "server/files/upload";
        let answer = store(client, path, &fields, name, file)?;
        // Some versions put the answer into a result, as others are.
        let place = match answer.json.pointer("/result") {
            Some(_) => "/result/item/path",
            None => "/item/path",
        };
        client.stored(&answer, place, name)
    }

    fn size(&self, client: &Client, name: &str) -> Result<u64, HostError> {
        let name = utf8_percent_encode(name, NON_ALPHANUMERIC);
        let path = format!("server/files/metadata?filename={name}");
        let answer = client.done(client.get(&path)?, "show the file")?;
        client.bytes(&answer, "/result/size")
    }

    fn start(&self, client: &Client, name: &str) -> Result<(), HostError> {
        let answer =
            client.post("printer/print/start", &json!({ "filename": name }))?;
        client.done(answer, "start the print").map(drop)
    }
}
