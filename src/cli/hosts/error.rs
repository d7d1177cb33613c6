//! Why a host could not be used.

use std::io;

/// Why a host could not be used, and what to do about it. No message has the
/// key in it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum HostError {
    /// What is given as the printer's address is not an address.
    #[error(
        "{url} is no address of a printer: {why}; write it as in \
         http://octopi.local or http://192.168.1.20:7125"
    )]
    Address {
        /// The address.
        url: String,
        /// What is wrong with it.
        why: String,
    },
    /// The environment variable that should hold the key is not set.
    #[error(
        "the key of {printer} is to come from the environment variable \
         {variable}, which is not set"
    )]
    NoKey {
        /// The printer's name.
        printer: String,
        /// The variable.
        variable: String,
    },
    /// The key cannot be sent.
    #[error(
        "the key of {printer} has characters that no key has, such as line \
         breaks; enter it again with `isoslice printers add … --replace`"
    )]
    BadKey {
        /// The printer's name.
        printer: String,
    },
    /// The certificate to be trusted cannot be read.
    #[error("{file} is no certificate (PEM): {why}")]
    Certificate {
        /// The file's path.
        file: String,
        /// What is wrong with it.
        why: String,
    },
    /// Nothing answers at the address.
    #[error(
        "cannot reach {host}: {why}; check that it is switched on, and that \
         the address is right"
    )]
    Unreachable {
        /// The host's address.
        host: String,
        /// The reason.
        why: String,
    },
    /// The connection is not safe.
    #[error(
        "{host} cannot be trusted: {why}; if its certificate is one of your \
         own, name it with `isoslice printers add … --ca FILE`"
    )]
    Tls {
        /// The host's address.
        host: String,
        /// The reason.
        why: String,
    },
    /// The host gave no answer in time.
    #[error(
        "{host} stopped answering ({why}); no print was started; check that \
         the host is running, and try again"
    )]
    Vanished {
        /// The host's address.
        host: String,
        /// What was noticed.
        why: String,
    },
    /// The host did not answer the order to print.
    #[error(
        "{host} did not answer when it was told to print ({why}); the print \
         may have begun: look at the printer before you send the file again"
    )]
    Unsure {
        /// The host's address.
        host: String,
        /// What was noticed.
        why: String,
    },
    /// The key is refused.
    #[error(
        "{host} refuses the key; {kind} shows the right one in its own \
         settings: enter it with `isoslice printers add … --replace`"
    )]
    Key {
        /// The host's address.
        host: String,
        /// The program.
        kind: &'static str,
    },
    /// The address leads elsewhere, where the key must not go.
    #[error(
        "{host} redirects to {to}; if that is the printer, enter this address \
         with `isoslice printers add … --replace`"
    )]
    Elsewhere {
        /// The host's address.
        host: String,
        /// The other address.
        to: String,
    },
    /// Another program answers at the address.
    #[error(
        "what answers at {host} is not {kind}: {why}; check the address and \
         its port"
    )]
    Stranger {
        /// The host's address.
        host: String,
        /// The expected program.
        kind: &'static str,
        /// What was odd.
        why: String,
    },
    /// The host refuses what it was asked for.
    #[error("{host} refuses to {what}: {why}")]
    Refused {
        /// The host's address.
        host: String,
        /// What the host was asked for.
        what: String,
        /// The host's words.
        why: String,
    },
    /// The host has no room for the file.
    #[error(
        "{host} has room for {:.1} MB, and the file has {:.1} MB; remove \
         files there",
        *.free as f64 / 1e6, *.length as f64 / 1e6
    )]
    Full {
        /// The host's address.
        host: String,
        /// Room on the host, bytes.
        free: u64,
        /// Size of the file, bytes.
        length: u64,
    },
    /// The printer cannot start now.
    #[error(
        "the printer at {host} cannot start a print now: it is {state}; \
         wait until it is ready, or store the file only (without --start)"
    )]
    NotReady {
        /// The host's address.
        host: String,
        /// What the printer is doing.
        state: String,
    },
    /// The host tells of another file than the one that it was sent.
    #[error(
        "{host} says that it has stored {name} as {told}; no print was \
         started; look there what it has, or send the file under another name"
    )]
    Renamed {
        /// The host's address.
        host: String,
        /// The file's name.
        name: String,
        /// The name that the host tells.
        told: String,
    },
    /// Only a part of the file has arrived.
    #[error(
        "only {there} of {length} bytes of {name} have arrived at {host}; the \
         print was not started; send the file again"
    )]
    Incomplete {
        /// The host's address.
        host: String,
        /// The file's name on the host.
        name: String,
        /// Bytes that have arrived.
        there: u64,
        /// Bytes sent.
        length: u64,
    },
    /// The file cannot be read.
    #[error("cannot read {file}")]
    File {
        /// The file's path.
        file: String,
        /// The system's reason.
        source: io::Error,
    },
}
