//! Who may use the server: whoever knows its address, from this machine.
//!
//! The address holds a secret that is new in each run. The server listens on
//! the loopback interface only. A page of another site can neither read the
//! secret nor guess it; as a second fence, requests that name another host
//! (as after DNS rebinding) or come from another origin are refused.

use anyhow::Context;
use http::header::{HOST, HeaderName, ORIGIN};
use http::{HeaderMap, StatusCode};
use std::fmt::Write as _;

/// Length of the secret, bytes.
const BYTES: usize = 16;

/// Tells which requests are allowed.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    port: u16,
    secret: String,
}

impl Guard {
    /// A guard with a new secret.
    ///
    /// # Errors
    /// If the system has no random numbers.
    pub(super) fn new(port: u16) -> anyhow::Result<Guard> {
        let mut bytes = [0; BYTES];
        getrandom::fill(&mut bytes).context("cannot make a secret address")?;
        let mut secret = String::new();
        for byte in bytes {
            write!(secret, "{byte:02x}")?;
        }
        Ok(Guard { port, secret })
    }

    /// The page's address.
    pub(super) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.secret)
    }

    /// The path of a request below the secret.
    ///
    /// # Errors
    /// The answer to a request that is not allowed.
    pub(super) fn admit<'a>(
        &self,
        path: &'a str,
        headers: &HeaderMap,
    ) -> Result<&'a str, StatusCode> {
        let all = |name: HeaderName| headers.get_all(name).into_iter();
        let hosts = ["127.0.0.1", "localhost"];
        let hosts = hosts.map(|host| format!("{host}:{}", self.port));
        let mut given = all(HOST);
        let host = given.next().filter(|_| given.next().is_none());
        if !host.is_some_and(|host| hosts.iter().any(|own| own == host)) {
            return Err(StatusCode::MISDIRECTED_REQUEST);
        }
        let origins = hosts.map(|host| format!("http://{host}"));
        let of_site = HeaderName::from_static("sec-fetch-site");
        let alien = all(ORIGIN).any(|o| origins.iter().all(|own| own != o))
            || all(of_site).any(|s| s != "same-origin" && s != "none");
        if alien {
            return Err(StatusCode::FORBIDDEN);
        }
        let below = path.strip_prefix('/').and_then(|p| p.split_once('/'));
        match below {
            Some((secret, below)) if same(secret, &self.secret) => Ok(below),
            _ => Err(StatusCode::NOT_FOUND),
        }
    }
}

/// Compares in a time that does not depend on how many bytes are equal.
fn same(given: &str, secret: &str) -> bool {
    let differences = given.bytes().zip(secret.bytes()).map(|(a, b)| a ^ b);
    given.len() == secret.len() && differences.fold(0, |all, d| all | d) == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use http::HeaderValue;

    fn headers(pairs: &[(&'static str, &'static str)]) -> HeaderMap {
        let header = |(name, value): &(&'static str, &'static str)| {
            (
                HeaderName::from_static(name),
                HeaderValue::from_static(value),
            )
        };
        let mut headers = HeaderMap::new();
        for (name, value) in pairs.iter().map(header) {
            headers.append(name, value);
        }
        headers
    }

    #[test]
    fn only_whoever_knows_the_address_is_admitted() {
        let guard = Guard::new(8123).unwrap();
        let path = format!("/{}/state", guard.secret);
        let own = ("host", "127.0.0.1:8123");
        let admitted = |path: &str, pairs: &[_]| {
            guard.admit(path, &headers(pairs)).map(str::to_owned)
        };
        assert_eq!(admitted(&path, &[own]), Ok("state".to_owned()));
        assert!(admitted(&path, &[("host", "localhost:8123")]).is_ok());
        let origin = ("origin", "http://127.0.0.1:8123");
        let site = ("sec-fetch-site", "same-origin");
        assert!(admitted(&path, &[own, origin, site]).is_ok());

        let misdirected = Err(StatusCode::MISDIRECTED_REQUEST);
        for host in ["evil.example:8123", "127.0.0.1", "127.0.0.1:80", ""] {
            assert_eq!(admitted(&path, &[("host", host)]), misdirected);
        }
        assert_eq!(admitted(&path, &[]), misdirected);
        assert_eq!(admitted(&path, &[own, own]), misdirected);
        let forbidden = Err(StatusCode::FORBIDDEN);
        for alien in [
            ("origin", "http://evil.example"),
            ("origin", "null"),
            ("origin", "https://127.0.0.1:8123"),
            ("sec-fetch-site", "cross-site"),
            ("sec-fetch-site", "same-site"),
        ] {
            assert_eq!(admitted(&path, &[own, alien]), forbidden, "{alien:?}");
        }
        let unknown = Err(StatusCode::NOT_FOUND);
        let short = &guard.secret[1..];
        for path in ["/", "", "/state", "//state", &format!("/{short}/state")] {
            assert_eq!(admitted(path, &[own]), unknown, "{path}");
        }
    }

    #[test]
    fn secrets_differ() {
        let [a, b] = [(); 2].map(|()| Guard::new(1).unwrap().secret);
        assert_ne!(a, b);
        assert_eq!(a.len(), 2 * BYTES);
    }
}
