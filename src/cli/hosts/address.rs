//! Addresses of hosts, and words of strangers.

use super::HostError;
use isoslice_base::units::human_start;
use ureq::http::Uri;

/// Greatest number of characters of a stranger's words that are shown.
const LONGEST: usize = 300;

/// The text without a slash at its end, if it is an address.
pub(super) fn address(url: &str) -> Result<String, HostError> {
    let wrong = |why: &str| HostError::Address {
        url: shortened(url),
        why: why.to_owned(),
    };
    let uri: Uri = url
        .parse()
        .map_err(|error| wrong(&format!("{error}").to_lowercase()))?;
    if !matches!(uri.scheme_str(), Some("http" | "https")) {
        return Err(wrong("it must begin with http:// or https://"));
    }
    let authority = uri.authority().ok_or_else(|| wrong("it has no host"))?;
    if authority.as_str().contains('@') {
        return Err(wrong("a name or password in it would be seen by others"));
    }
    // A port that is no number of 16 bits is not understood.
    let host = authority.host();
    let with_port = authority.as_str().len() > host.len();
    if with_port && authority.port_u16().is_none_or(|port| port == 0) {
        return Err(wrong("its port must be a number from 1 to 65535"));
    }
    if uri.query().is_some() {
        return Err(wrong("it must end before the question mark"));
    }
    Ok(url.trim_end_matches('/').to_owned())
}

/// A host's words, no longer than people read, in one line.
pub(super) fn shortened(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    human_start(&line, LONGEST)
}
