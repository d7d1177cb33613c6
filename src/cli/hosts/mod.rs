//! Sends files to the programs that run printers: OctoPrint, Moonraker (Klipper)
//! and PrusaLink.
//!
//! In: a [`Printer`], as [`PrinterBook`] keeps it, and a file. Out: the file on
//! the printer's host, and a print begun if that was asked for; or a
//! [`HostError`] that says what to do.
//!
//! A file is sent in four steps. First the host is asked whether it is the
//! expected program, takes the key and has room. Then the file is uploaded, and
//! the host is asked whether all of it has arrived. Only then is the print
//! started, by a request of its own. So a file that has arrived in part is
//! never printed, whatever happens on the way.
//!
//! Guaranteed: every request ends, with an answer or an error, within bounded
//! time without progress; answers are read up to a bounded size and believed
//! only as far as they are understood; the key goes to the printer's own address
//! and appears in no message. Not guaranteed: that the host prints the file.
//!
//! `client` speaks HTTP, `octoprint`, `moonraker` and `prusalink` know the
//! hosts' words.

mod address;
mod book;
mod client;
mod error;
mod moonraker;
mod multipart;
mod octoprint;
mod prusalink;
#[cfg(test)]
mod tests;

pub(crate) use book::{Key, Printer, PrinterBook};
pub(crate) use error::HostError;

use clap::ValueEnum;
use client::Client;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The program that runs a printer.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
#[value(rename_all = "lower")]
pub(crate) enum HostKind {
    // Descriptions here would make clap print a list.
    // OctoPrint's REST interface, <https://docs.octoprint.org/en/master/api/>.
    OctoPrint,
    // Moonraker, in front of Klipper, <https://moonraker.readthedocs.io>.
    Moonraker,
    // Version 1 of PrusaLink's interface,
    // <https://github.com/prusa3d/Prusa-Link-Web/tree/master/spec>.
    PrusaLink,
}

impl HostKind {
    /// The program's own name.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::OctoPrint => "OctoPrint",
            Self::Moonraker => "Moonraker",
            Self::PrusaLink => "PrusaLink",
        }
    }
}

/// What a host says about itself.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Status {
    /// The program, with its version.
    pub program: String,
    /// What the printer is doing, in the host's words.
    pub state: String,
    /// True if the printer could start a print now.
    pub ready: bool,
    /// Room for files, bytes, if the host tells.
    pub free: Option<u64>,
}

/// What became of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sent {
    /// The file's name on the host.
    pub name: String,
    /// True if the host has begun to print the file.
    pub started: bool,
}

/// How a file is sent.
pub(crate) struct Sending<'a> {
    /// Name that the file is to have; letters that hosts may not take become
    /// underscores.
    pub name: &'a str,
    /// True if the host is to print the file.
    pub start: bool,
    /// Is called with the progress: bytes sent, and bytes in all.
    pub on_progress: &'a dyn Fn(u64, u64),
}

/// The requests that every kind of host answers.
trait Host {
    /// Asks which program answers and how the printer is, and whether the host
    /// takes the key.
    fn status(&self, client: &Client) -> Result<Status, HostError>;
    /// Sends a file, and says what the host calls it.
    fn upload(
        &self,
        client: &Client,
        name: &str,
        file: &mut Upload<'_>,
    ) -> Result<String, HostError>;
    /// How much of a file the host has, bytes.
    fn size(&self, client: &Client, name: &str) -> Result<u64, HostError>;
    /// Prints a file.
    fn start(&self, client: &Client, name: &str) -> Result<(), HostError>;
}

/// A file that is sent.
struct Upload<'a> {
    source: &'a mut dyn Read,
    /// Bytes read so far, and in all.
    at: u64,
    length: u64,
    on_progress: &'a dyn Fn(u64, u64),
}

impl Read for Upload<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.source.read(buffer)?;
        self.at += read as u64;
        (self.on_progress)(self.at.min(self.length), self.length);
        Ok(read)
    }
}

fn host(printer: &Printer) -> Box<dyn Host> {
    match printer.kind {
        HostKind::OctoPrint => Box::new(octoprint::OctoPrint),
        HostKind::Moonraker => Box::new(moonraker::Moonraker),
        HostKind::PrusaLink => Box::new(prusalink::PrusaLink {
            storage: printer.storage.clone(),
        }),
    }
}

/// Asks a printer's host how it is.
///
/// # Errors
/// If the host does not answer, is another program, or refuses the key.
pub(crate) fn status(printer: &Printer) -> Result<Status, HostError> {
    host(printer).status(&Client::new(printer)?)
}

/// Sends a file to a printer's host.
///
/// # Errors
/// If the file cannot be read or sent, or, when it is to be printed, the
/// printer is busy. Nothing is started then, unless it is
/// [`HostError::Unsure`].
pub(crate) fn send(
    printer: &Printer,
    path: &Path,
    sending: &Sending<'_>,
) -> Result<Sent, HostError> {
    let unread = |source| HostError::File {
        file: path.display().to_string(),
        source,
    };
    let mut file = File::open(path).map_err(unread)?;
    let length = file.metadata().map_err(unread)?.len();
    send_from(printer, &mut file, length, sending)
}

/// Sends what a reader of `length` bytes holds, as [`send`] does with a file.
///
/// # Errors
/// Those of [`send`].
pub(crate) fn send_from(
    printer: &Printer,
    source: &mut dyn Read,
    length: u64,
    sending: &Sending<'_>,
) -> Result<Sent, HostError> {
    let host = host(printer);
    let client = Client::new(printer)?;
    let status = host.status(&client)?;
    if let Some(free) = status.free
        && free < length
    {
        return Err(HostError::Full {
            host: client.name(),
            free,
            length,
        });
    }
    if sending.start && !status.ready {
        return Err(HostError::NotReady {
            host: client.name(),
            state: status.state,
        });
    }
    let mut upload = Upload {
        source,
        at: 0,
        length,
        on_progress: sending.on_progress,
    };
    let name = plain_name(sending.name);
    let name = host.upload(&client, &name, &mut upload)?;
    let there = host.size(&client, &name)?;
    if there != length {
        return Err(HostError::Incomplete {
            host: client.name(),
            name,
            there,
            length,
        });
    }
    if sending.start {
        host.start(&client, &name).map_err(|error| match error {
            HostError::Vanished { host, why }
            | HostError::Stranger { host, why, .. } => {
                HostError::Unsure { host, why }
            }
            error => error,
        })?;
    }
    Ok(Sent {
        name,
        started: sending.start,
    })
}

/// The first letters of a text, with underscores for those that an address or a
/// header may not take.
pub(crate) fn plain_letters(text: &str, most: usize) -> String {
    let letter = |c: char| match c {
        '-' | '_' | '.' => c,
        c if c.is_ascii_alphanumeric() => c,
        _ => '_',
    };
    text.chars().take(most).map(letter).collect()
}

/// A name that every host takes, in any of their addresses.
fn plain_name(name: &str) -> String {
    /// Greatest length of a name, characters; printers' screens show fewer.
    const LONGEST: usize = 100;
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, "gcode"));
    let stem = plain_letters(stem.trim_start_matches('.'), LONGEST);
    let extension = plain_letters(extension, 10);
    let stem = if stem.is_empty() { "part" } else { &stem };
    format!("{stem}.{extension}")
}
