//! Why a host could not be used.

use std::io;

/// Why a host could not be used, and what to do about it. No message has the
/// key in it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum HostError {
    /// The printer's address is none.
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
    /// The key is not there.
    #[error(
        "the key of {printer} is to come from the environment variable \
         {variable}, which is not set"
    )]
    NoKey {
        /// Printer.
        printer: String,
        /// The variable.
        variable: String,
    },
    /// The key cannot be sent.
    #[error("the key of {printer} has characters that no key has")]
    BadKey {
        /// Printer.
        printer: String,
    },
    /// The certificate to be trusted cannot be read.
    #[error("{file} is no certificate (PEM): {why}")]
    Certificate {
        /// File.
        file: String,
        /// What is wrong with it.
        why: String,
    },
    /// Nobody answers.
    #[error(
        "cannot reach {host}: {why}; is it switched on, and is this the \
         address?"
    )]
    Unreachable {
        /// Address.
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
        /// Address.
        host: String,
        /// The reason.
        why: String,
    },
    /// No answer in time.
    #[error(
        "{host} stopped answering ({why}); nothing was started; look whether \
         it is still running, and try again"
    )]
    Vanished {
        /// Address.
        host: String,
        /// What was noticed.
        why: String,
    },
    /// No answer to the order to print.
    #[error(
        "{host} did not answer when it was told to print ({why}); the print \
         may have begun: look at the printer before you send the file again"
    )]
    Unsure {
        /// Address.
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
        /// Address.
        host: String,
        /// The program.
        kind: &'static str,
    },
    /// The address leads elsewhere, where the key must not go.
    #[error(
        "{host} sends us on to {to}; if that is the printer, use its address"
    )]
    Elsewhere {
        /// Address.
        host: String,
        /// The other address.
        to: String,
    },
    /// Something else answers.
    #[error(
        "what answers at {host} is not {kind}: {why}; look at the address \
         and its port"
    )]
    Stranger {
        /// Address.
        host: String,
        /// The expected program.
        kind: &'static str,
        /// What was odd.
        why: String,
    },
    /// The host will not do it.
    #[error("{host} refuses to {what}: {why}")]
    Refused {
        /// Address.
        host: String,
        /// What the host was asked for.
        what: String,
        /// The host's words.
        why: String,
    },
    /// There is no room.
    #[error(
        "{host} has room for {:.1} MB, and the file has {:.1} MB; remove \
         files there",
        *.free as f64 / 1e6, *.length as f64 / 1e6
    )]
    Full {
        /// Address.
        host: String,
        /// Room, bytes.
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
        /// Address.
        host: String,
        /// What the printer is doing.
        state: String,
    },
    /// Not all of it arrived.
    #[error(
        "of {name}, {there} of {length} bytes have arrived at {host}; it was \
         not started; send it again"
    )]
    Incomplete {
        /// Address.
        host: String,
        /// The file's name there.
        name: String,
        /// Bytes there.
        there: u64,
        /// Bytes sent.
        length: u64,
    },
    /// The file cannot be read.
    #[error("cannot read {file}")]
    File {
        /// File.
        file: String,
        /// The system's reason.
        source: io::Error,
    },
}
