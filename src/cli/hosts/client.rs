//! Requests to one host, with its key, and errors in plain words.

use super::address::{address, shortened};
use super::book::Printer;
use super::{HostError, HostKind};
use serde_json::Value;
use std::io::{self, Read};
use std::time::Duration;
use ureq::http::Request;
use ureq::tls::{Certificate, PemItem, RootCerts, TlsConfig, parse_pem};
use ureq::{Agent, SendBody};

/// Greatest time to find the host and to connect.
const CONNECT: Duration = Duration::from_secs(10);
/// Greatest time in which the host takes nothing of what it is sent.
const STALL: Duration = Duration::from_secs(20);
/// Time for an answer. A host reads through a file before it answers, which
/// takes a small computer a while. Tests wait for less.
const ANSWER: Duration = Duration::from_secs(if cfg!(test) { 1 } else { 120 });
/// Time for the answer to the first question, which host it is. It needs no look
/// at files or at the printer.
const FIRST_ANSWER: Duration =
    Duration::from_secs(if cfg!(test) { 1 } else { 20 });
/// Greatest number of bytes of an answer that are read. Lists of files are
/// long.
const LARGEST: u64 = 16 << 20;

/// What the system says about a name that no computer has.
const NO_NAME: &str = "failed to lookup address";

/// The header that holds the key. All three hosts know it.
const KEY: &str = "X-Api-Key";

/// Speaks with one host.
pub(super) struct Client {
    agent: Agent,
    /// Address without a slash at its end.
    base: String,
    kind: HostKind,
    key: Option<String>,
}

/// An answer of the host, whatever its status.
pub(super) struct Answer {
    pub code: u16,
    /// The JSON in the answer; null if the answer has none.
    pub json: Value,
    text: String,
}

impl Client {
    pub(super) fn new(printer: &Printer) -> Result<Client, HostError> {
        let base = address(&printer.url)?;
        let mut tls = TlsConfig::builder();
        if let Some(file) = &printer.ca {
            let why = |why: String| HostError::Certificate {
                file: file.display().to_string(),
                why,
            };
            let pem = isoslice::files::read(file, 1 << 20)
                .map_err(|error| why(error.to_string()))?;
            let certificates: Vec<Certificate<'static>> = parse_pem(&pem)
                .filter_map(|item| match item {
                    Ok(PemItem::Certificate(certificate)) => Some(certificate),
                    _ => None,
                })
                .collect();
            if certificates.is_empty() {
                return Err(why("there is none in it".to_owned()));
            }
            tls = tls.root_certs(RootCerts::new_with_certs(&certificates));
        }
        let agent = Agent::config_builder()
            .http_status_as_error(false)
            // The key must not be sent to another host that the answer names.
            .max_redirects(0)
            .max_redirects_will_error(false)
            // The key must not go through a proxy either.
            .proxy(None)
            .user_agent(concat!("isoslice/", env!("CARGO_PKG_VERSION")))
            .tls_config(tls.build())
            .timeout_resolve(Some(CONNECT))
            .timeout_connect(Some(CONNECT))
            .timeout_per_write(Some(STALL))
            .build()
            .into();
        Ok(Client {
            agent,
            base,
            kind: printer.kind,
            key: printer.secret()?,
        })
    }

    /// The host's address, for messages.
    pub(super) fn name(&self) -> String {
        self.base.clone()
    }

    /// Asks for JSON.
    pub(super) fn get(&self, path: &str) -> Result<Answer, HostError> {
        self.request("GET", path, &[], SendBody::none(), ANSWER)
    }

    /// Asks for JSON that every host has at hand. It is the first question, so
    /// that a host that says nothing is not waited for.
    pub(super) fn first(&self, path: &str) -> Result<Answer, HostError> {
        self.request("GET", path, &[], SendBody::none(), FIRST_ANSWER)
    }

    /// Sends JSON.
    pub(super) fn post(
        &self,
        path: &str,
        json: &Value,
    ) -> Result<Answer, HostError> {
        let text = json.to_string();
        let length = text.len().to_string();
        let headers = [
            ("Content-Type", "application/json"),
            ("Content-Length", length.as_str()),
        ];
        let mut bytes = text.as_bytes();
        let body = SendBody::from_reader(&mut bytes);
        self.request("POST", path, &headers, body, ANSWER)
    }

    /// Sends a body of a known length.
    pub(super) fn send(
        &self,
        method: &str,
        path: &str,
        headers: &[(&str, &str)],
        length: u64,
        body: &mut dyn Read,
    ) -> Result<Answer, HostError> {
        let length = length.to_string();
        let mut all = vec![("Content-Length", length.as_str())];
        all.extend(headers);
        let body = SendBody::from_reader(body);
        self.request(method, path, &all, body, ANSWER)
    }

    fn request(
        &self,
        method: &str,
        path: &str,
        headers: &[(&str, &str)],
        body: SendBody<'_>,
        patience: Duration,
    ) -> Result<Answer, HostError> {
        let mut request = Request::builder()
            .method(method)
            .uri(format!("{}/{path}", self.base))
            .header("Accept", "application/json");
        if let Some(key) = &self.key {
            request = request.header(KEY, key);
        }
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let request =
            request.body(body).map_err(|error| HostError::Address {
                url: self.name(),
                why: error.to_string(),
            })?;
        let request = self
            .agent
            .configure_request(request)
            .timeout_recv_response(Some(patience))
            .timeout_recv_body(Some(patience))
            .build();
        let answer = self.agent.run(request);
        let mut answer = answer.map_err(|error| self.failed(error))?;
        let code = answer.status().as_u16();
        let to = answer.headers().get("location").cloned();
        let body = answer.body_mut().with_config().limit(LARGEST);
        let bytes = body.read_to_vec().map_err(|e| self.failed(e))?;
        let text = String::from_utf8_lossy(&bytes).into_owned();
        match code {
            300..=399 => {
                let to = to.as_ref().and_then(|to| to.to_str().ok());
                Err(HostError::Elsewhere {
                    host: self.name(),
                    to: self.said(to.unwrap_or("another address")),
                })
            }
            401 | 403 => Err(HostError::Key {
                host: self.name(),
                kind: self.kind.name(),
            }),
            _ => Ok(Answer {
                code,
                json: serde_json::from_str(&text).unwrap_or_default(),
                text,
            }),
        }
    }

    /// What an error of the transport means.
    fn failed(&self, error: ureq::Error) -> HostError {
        use ureq::Error;
        let host = self.name();
        let why = shortened(&error.to_string());
        match error {
            Error::Tls(_) | Error::Rustls(_) | Error::Pem(_) => {
                HostError::Tls { host, why }
            }
            Error::Io(error) if of_tls(&error) => HostError::Tls { host, why },
            Error::HostNotFound => HostError::Unreachable {
                host,
                why: "no computer has this name".to_owned(),
            },
            Error::Timeout(ureq::Timeout::Resolve | ureq::Timeout::Connect) => {
                HostError::Unreachable {
                    host,
                    why: format!("it does not answer within {CONNECT:?}"),
                }
            }
            Error::ConnectionFailed => HostError::Unreachable { host, why },
            // The standard library has no kind for it.
            Error::Io(error) if error.to_string().contains(NO_NAME) => {
                HostError::Unreachable {
                    host,
                    why: format!("no computer has this name ({why})"),
                }
            }
            Error::Io(error)
                if error.kind() == io::ErrorKind::ConnectionRefused =>
            {
                HostError::Unreachable {
                    host,
                    why: "nothing answers at this port".to_owned(),
                }
            }
            Error::Io(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::NetworkUnreachable
                        | io::ErrorKind::HostUnreachable
                ) =>
            {
                HostError::Unreachable { host, why }
            }
            Error::BodyExceedsLimit(_) => {
                self.stranger("its answer is endless")
            }
            Error::Protocol(_) | Error::LargeResponseHeader(..) => {
                self.stranger(&why)
            }
            Error::Http(_) | Error::BadUri(_) => {
                HostError::Address { url: host, why }
            }
            _ => HostError::Vanished { host, why },
        }
    }

    /// A host's words without the key, since some hosts repeat it.
    fn said(&self, text: &str) -> String {
        match &self.key {
            Some(key) if !key.is_empty() => {
                shortened(&text.replace(key.as_str(), "…"))
            }
            _ => shortened(text),
        }
    }

    /// The program that answers, if it is the expected one.
    pub(super) fn program(
        &self,
        is_own: impl Fn(&str) -> bool,
    ) -> Result<String, HostError> {
        let program = self.text(&self.first("api/version")?, "/text")?;
        if is_own(&program) {
            Ok(program)
        } else {
            Err(self.stranger(&format!("it is {program}")))
        }
    }

    /// The error that says that this kind of host answers otherwise.
    pub(super) fn stranger(&self, why: &str) -> HostError {
        HostError::Stranger {
            host: self.name(),
            kind: self.kind.name(),
            why: self.said(why),
        }
    }

    /// A text in an answer that must be there.
    pub(super) fn text(
        &self,
        answer: &Answer,
        pointer: &str,
    ) -> Result<String, HostError> {
        let text = answer.json.pointer(pointer).and_then(Value::as_str);
        let text = text.ok_or_else(|| self.odd(answer, pointer))?;
        Ok(shortened(text))
    }

    /// Checks that a file was stored under its name, as an answer tells it. A
    /// host that tells another name may have stored the file there, and would
    /// print what it has under that name.
    pub(super) fn stored(
        &self,
        answer: &Answer,
        pointer: &str,
        name: &str,
    ) -> Result<String, HostError> {
        let told = self.text(answer, pointer)?;
        if told == name {
            Ok(told)
        } else {
            Err(HostError::Renamed {
                host: self.name(),
                name: name.to_owned(),
                told: self.said(&told),
            })
        }
    }

    /// A number of bytes in an answer that must be there.
    pub(super) fn bytes(
        &self,
        answer: &Answer,
        pointer: &str,
    ) -> Result<u64, HostError> {
        let bytes = answer.json.pointer(pointer).and_then(Value::as_u64);
        bytes.ok_or_else(|| self.odd(answer, pointer))
    }

    fn odd(&self, answer: &Answer, pointer: &str) -> HostError {
        self.stranger(&format!(
            "its answer ({}) has no {}",
            answer.code,
            pointer.rsplit('/').next().unwrap_or(pointer)
        ))
    }

    /// Checks that the host has done what it was asked for.
    pub(super) fn done(
        &self,
        answer: Answer,
        what: &str,
    ) -> Result<Answer, HostError> {
        if (200..300).contains(&answer.code) {
            return Ok(answer);
        }
        Err(HostError::Refused {
            host: self.name(),
            what: what.to_owned(),
            why: self.said(&answer.words()),
        })
    }
}

impl Answer {
    /// The host's own words for what is wrong.
    fn words(&self) -> String {
        let places =
            ["/error/message", "/error", "/message", "/text", "/title"];
        let said = places.iter().find_map(|p| self.json.pointer(p)?.as_str());
        match (said, self.code) {
            (Some(said), code) => format!("{} ({code})", shortened(said)),
            (None, 404) => "it has no such file or address (404)".to_owned(),
            (None, 409) => {
                "it is busy with another file or print (409)".to_owned()
            }
            (None, 413) => "the file is too large (413)".to_owned(),
            (None, 415) => "it takes no such files (415)".to_owned(),
            (None, 507) => "it has no room left (507)".to_owned(),
            (None, code) if self.json.is_null() && !self.text.is_empty() => {
                let line = self.text.lines().next().unwrap_or_default();
                format!("{} ({code})", shortened(line))
            }
            (None, code) => format!("answer {code}"),
        }
    }
}

/// True if an error of reading or writing says that the connection is not safe.
fn of_tls(error: &io::Error) -> bool {
    let text = error.to_string();
    error.kind() == io::ErrorKind::InvalidData
        && ["certificate", "handshake", "tls", "corrupt message"]
            .iter()
            .any(|word| text.to_lowercase().contains(word))
}
