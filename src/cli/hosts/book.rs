//! The user's printers: a file of their own, which nobody else may read.
//!
//! ```toml
//! [workshop]
//! kind = "octoprint"
//! url = "http://octopi.local"
//! key = "0123456789ABCDEF"
//! ```
//!
//! Guaranteed: the file is readable by its user only (0600, where the system
//! has such rights), and is changed in one step.

use super::address::address;
use super::{HostError, HostKind};
use isoslice::files::{FileError, read_text};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Greatest size of the file, bytes: some thousand printers.
const LARGEST: u64 = 1 << 20;

/// The name of the file in the folder of settings.
const NAME: &str = "printers.toml";

/// A key. No message and no log shows it.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Key(String);

impl Key {
    /// A key from text. Spaces around the key are left out.
    pub(crate) fn new(text: &str) -> Key {
        Key(text.trim().to_owned())
    }
}

/// True if a key can be sent. A line's end in it would begin another line of
/// the request.
fn can_be_sent(key: &str) -> bool {
    key.bytes().all(|b| b.is_ascii_graphic())
}

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Key(…)")
    }
}

/// A printer, and how to reach the program that runs it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Printer {
    /// The printer's name: the table's name in the file.
    #[serde(skip)]
    pub name: String,
    /// The program that runs the printer.
    pub kind: HostKind,
    /// The program's address.
    pub url: String,
    /// The key that the program asks for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key: Option<Key>,
    /// The environment variable that holds the key, if the file does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key_env: Option<String>,
    /// The setting `printer.model` of G-code for this printer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// File with the only certificates (PEM) to trust.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ca: Option<PathBuf>,
    /// Where PrusaLink is to store files: usb or local.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub storage: Option<String>,
}

impl Printer {
    /// The key, from the file or from the environment.
    pub(super) fn secret(&self) -> Result<Option<String>, HostError> {
        let secret = match (&self.key_env, &self.key) {
            (Some(variable), _) => match std::env::var(variable) {
                Ok(key) if !key.trim().is_empty() => {
                    Some(key.trim().to_owned())
                }
                _ => {
                    return Err(HostError::NoKey {
                        printer: self.name.clone(),
                        variable: variable.clone(),
                    });
                }
            },
            (None, key) => key.as_ref().map(|key| key.0.clone()),
        };
        match secret {
            Some(key) if !can_be_sent(&key) => Err(HostError::BadKey {
                printer: self.name.clone(),
            }),
            secret => Ok(secret.filter(|key| !key.is_empty())),
        }
    }
}

/// Why the file of printers cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum BookError {
    /// The file cannot be read.
    #[error("cannot read {}", .0.display())]
    Read(PathBuf, #[source] FileError),
    /// The file is malformed.
    #[error("{}: {}", .0.display(), .1)]
    Malformed(PathBuf, String),
    /// The file cannot be written.
    #[error("cannot write {}", .0.display())]
    Write(PathBuf, #[source] io::Error),
    /// A printer's name is not plain.
    #[error(
        "{0:?} cannot be a printer's name; use letters, digits, - and _, as \
         in workshop"
    )]
    Name(String),
    /// What is given as the printer's address is not an address, or what is
    /// given as the key is not a key.
    #[error(transparent)]
    Printer(#[from] HostError),
    /// No printer has this name.
    #[error(
        "there is no printer {name}{}",
        if known.is_empty() {
            "; `isoslice printers add` makes one known".to_owned()
        } else {
            format!("; there are {}", known.join(", "))
        }
    )]
    Unknown {
        /// The name that was asked for.
        name: String,
        /// The names of all printers.
        known: Vec<String>,
    },
}

/// The user's printers, as the file has them.
#[derive(Clone, Debug)]
pub(crate) struct PrinterBook {
    path: PathBuf,
    printers: BTreeMap<String, Printer>,
}

impl PrinterBook {
    /// The printers in the file of a folder, which need not be there.
    ///
    /// # Errors
    /// If the file cannot be read or understood.
    pub(crate) fn open(folder: &Path) -> Result<PrinterBook, BookError> {
        let path = folder.join(NAME);
        let text = match read_text(&path, LARGEST) {
            Ok(text) => text,
            Err(_) if !path.exists() => String::new(),
            Err(error) => return Err(BookError::Read(path, error)),
        };
        let read = toml::from_str::<BTreeMap<String, Printer>>(&text);
        let mut printers = read.map_err(|error| {
            // The parser's messages are not shown: the whole one quotes the
            // line, and the short one may quote a value, and either may hold a
            // key.
            let at = error.span().map_or(0, |span| span.start);
            let line = text.get(..at).unwrap_or_default().matches('\n').count();
            let said = error.message();
            let said = match said.split_once(", expected ") {
                Some((what, expected)) if what.starts_with("invalid ") => {
                    format!("expected {expected}")
                }
                _ => said.to_owned(),
            };
            let message = format!("line {}: {said}", line + 1);
            BookError::Malformed(path.clone(), message)
        })?;
        for (name, printer) in &mut printers {
            printer.name.clone_from(name);
        }
        Ok(PrinterBook { path, printers })
    }

    /// True if other users may read the file and its keys.
    pub(crate) fn is_open_to_others(&self) -> bool {
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let data = std::fs::metadata(&self.path);
            data.is_ok_and(|data| data.permissions().mode() & 0o077 != 0)
        }
        #[cfg(not(unix))]
        false
    }

    /// The file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// All printers, by name.
    pub(crate) fn printers(&self) -> impl Iterator<Item = &Printer> {
        self.printers.values()
    }

    /// The printer of a name.
    ///
    /// # Errors
    /// If there is no such printer.
    pub(crate) fn find(&self, name: &str) -> Result<&Printer, BookError> {
        self.printers.get(name).ok_or_else(|| self.unknown(name))
    }

    fn unknown(&self, name: &str) -> BookError {
        BookError::Unknown {
            name: name.to_owned(),
            known: self.printers.keys().cloned().collect(),
        }
    }

    /// Adds a printer, or replaces the one of the same name.
    ///
    /// # Errors
    /// If the name or the address is not allowed, or the file cannot be
    /// written.
    pub(crate) fn add(&mut self, printer: Printer) -> Result<(), BookError> {
        let letter = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
        let name = &printer.name;
        if name.is_empty() || name.len() > 64 || !name.chars().all(letter) {
            return Err(BookError::Name(name.clone()));
        }
        address(&printer.url)?;
        if printer.key.as_ref().is_some_and(|key| !can_be_sent(&key.0)) {
            let printer = name.clone();
            return Err(HostError::BadKey { printer }.into());
        }
        self.printers.insert(name.clone(), printer);
        self.write()
    }

    /// Forgets a printer.
    ///
    /// # Errors
    /// If there is no printer of this name, or the file cannot be written.
    pub(crate) fn remove(&mut self, name: &str) -> Result<(), BookError> {
        if self.printers.remove(name).is_none() {
            return Err(self.unknown(name));
        }
        self.write()
    }

    fn write(&self) -> Result<(), BookError> {
        let cannot = |error| BookError::Write(self.path.clone(), error);
        let text = toml::to_string(&self.printers)
            .map_err(|error| cannot(io::Error::other(error)))?;
        let folder = self.path.parent().unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder).map_err(cannot)?;
        // Temporary files are readable by their user only.
        let file = tempfile::NamedTempFile::new_in(folder);
        let mut file = file.map_err(cannot)?;
        file.write_all(text.as_bytes()).map_err(cannot)?;
        let kept = file.persist(&self.path);
        kept.map(drop).map_err(|error| cannot(error.error))
    }
}
