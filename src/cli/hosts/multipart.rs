//! A form with one file, as browsers send it (RFC 7578).

use super::client::{Answer, Client};
use super::{HostError, Upload};
use std::io::{Cursor, Read};

/// The boundary between the parts of a form. No line of G-code is like it, and
/// in a binary file it is as unlikely as any other 30 letters.
const BOUNDARY: &str = "isoslice-7f3b1c9e52d84a60";

/// The header that announces such a form.
const TYPE: (&str, &str) = (
    "Content-Type",
    "multipart/form-data; boundary=isoslice-7f3b1c9e52d84a60",
);

/// Stores a file by such a form.
pub(super) fn store(
    client: &Client,
    path: &str,
    fields: &[(&str, &str)],
    name: &str,
    file: &mut Upload<'_>,
) -> Result<Answer, HostError> {
    let (mut form, length) = form(fields, name, file);
    let answer = client.send("POST", path, &[TYPE], length, &mut form)?;
    client.done(answer, "store the file")
}

/// A form of some fields and a file, and its length in bytes.
fn form<'a>(
    fields: &[(&str, &str)],
    name: &str,
    file: &'a mut Upload<'_>,
) -> (impl Read + 'a, u64) {
    let mut head = String::new();
    for (field, value) in fields {
        head.push_str(&format!(
            "--{BOUNDARY}\r\nContent-Disposition: form-data; \
             name=\"{field}\"\r\n\r\n{value}\r\n"
        ));
    }
    head.push_str(&format!(
        "--{BOUNDARY}\r\nContent-Disposition: form-data; name=\"file\"; \
         filename=\"{name}\"\r\nContent-Type: application/octet-stream\r\n\r\n"
    ));
    let tail = format!("\r\n--{BOUNDARY}--\r\n");
    let length = (head.len() + tail.len()) as u64 + file.length;
    let body = file.take(file.length);
    (
        Cursor::new(head).chain(body).chain(Cursor::new(tail)),
        length,
    )
}
