//! Reads requests and writes answers (HTTP/1.1), one of each on a connection.
//!
//! Guaranteed: a request comes within [`TIME`], whole, with a bounded head and
//! body, or it is refused. Connections whose request has not come yet keep
//! nobody out: if there are [`WAITING`] of them, a new one takes the place of
//! the oldest. A browser opens a new connection for each request, which costs
//! little on one machine.

use http::header::{CONTENT_LENGTH, EXPECT, HOST, TRANSFER_ENCODING};
use http::{HeaderMap, Request, Response, StatusCode};
use std::collections::VecDeque;
use std::io::{self, BufWriter, Cursor, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Greatest time until a request has come, however little of it is missing, and
/// until the reader of an answer takes some more of it. Requests come from the
/// same machine.
const TIME: Duration = Duration::from_secs(10);

/// Time for which what follows a refused request is read, so that the answer
/// arrives.
const AFTERWARDS: Duration = Duration::from_secs(1);

/// Greatest size of a request's head, bytes, and number of its lines. Browsers
/// send less than 2 kB.
const LARGEST_HEAD: usize = 1 << 14;
const MOST_LINES: usize = 64;

/// Greatest size of a request's body, bytes.
const LARGEST_BODY: usize = 1 << 20;

/// Greatest number of connections whose request has not come yet, and of
/// requests that are being answered. A browser has six for all tabs of a page.
const WAITING: usize = 64;
const ANSWERING: usize = 64;

/// A request, with its body.
pub(super) type Asked = Request<Vec<u8>>;

/// An answer.
pub(super) type Reply = Response<Body>;

/// The body of an answer.
pub(super) struct Body {
    pub length: u64,
    pub source: Box<dyn Read>,
}

impl Body {
    pub(super) fn of(bytes: impl AsRef<[u8]> + 'static) -> Body {
        Body {
            length: bytes.as_ref().len() as u64,
            source: Box::new(Cursor::new(bytes)),
        }
    }
}

/// Answers whoever connects, for ever.
pub(super) fn serve(
    listener: &TcpListener,
    answer: impl Fn(&Asked) -> Reply + Send + Sync + 'static,
) {
    let server = Arc::new(Server {
        answer,
        waiting: Mutex::default(),
        answering: AtomicUsize::new(0),
    });
    for stream in listener.incoming() {
        // Too many files are open. Some will be closed.
        let Ok(stream) = stream else {
            thread::sleep(Duration::from_millis(20));
            continue;
        };
        let stream = Arc::new(stream);
        server.takes(&stream);
        let server = server.clone();
        let name = thread::Builder::new().name("answer".into());
        // Without a thread the connection is closed.
        let _ = name.spawn(move || server.talk(&stream));
    }
}

struct Server<F> {
    answer: F,
    /// Connections whose request has not come yet, the oldest first.
    waiting: Mutex<VecDeque<Arc<TcpStream>>>,
    /// Number of requests that are being answered.
    answering: AtomicUsize,
}

impl<F: Fn(&Asked) -> Reply> Server<F> {
    fn waiting(&self) -> MutexGuard<'_, VecDeque<Arc<TcpStream>>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes in a new connection.
    fn takes(&self, stream: &Arc<TcpStream>) {
        let mut waiting = self.waiting();
        waiting.push_back(stream.clone());
        if waiting.len() > WAITING
            && let Some(oldest) = waiting.pop_front()
        {
            // The thread that reads from it ends.
            let _ = oldest.shutdown(Shutdown::Both);
        }
    }

    /// Reads a request, and answers it. Errors of the connection are the other
    /// side's matter.
    fn talk(&self, stream: &Arc<TcpStream>) {
        let asked = request(stream, Instant::now() + TIME);
        self.waiting().retain(|other| !Arc::ptr_eq(other, stream));
        match asked {
            Ok(asked) => {
                let others = self.answering.fetch_add(1, Ordering::Relaxed);
                let reply = if others < ANSWERING {
                    (self.answer)(&asked)
                } else {
                    refusal(StatusCode::SERVICE_UNAVAILABLE)
                };
                let _ = write(stream, reply);
                self.answering.fetch_sub(1, Ordering::Relaxed);
            }
            Err(code) => {
                let _ = write(stream, refusal(code));
                let until = Instant::now() + AFTERWARDS;
                while more(stream, &mut Vec::new(), until).is_ok() {}
            }
        }
    }
}

fn refusal(code: StatusCode) -> Reply {
    let text = code.canonical_reason().unwrap_or_default();
    let mut reply = Response::new(Body::of(text));
    *reply.status_mut() = code;
    reply
}

/// The request that comes on a connection.
///
/// # Errors
/// The answer's code, if there is none.
fn request(stream: &TcpStream, until: Instant) -> Result<Asked, StatusCode> {
    let mut bytes = Vec::new();
    let (head, asked) = loop {
        if let Some(found) = head(&bytes)? {
            break found;
        }
        if bytes.len() > LARGEST_HEAD {
            return Err(StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE);
        }
        more(stream, &mut bytes, until)?;
    };
    let length = body_length(asked.headers())?;
    if asked.headers().contains_key(EXPECT) {
        let go_on = b"HTTP/1.1 100 Continue\r\n\r\n";
        { stream }
            .write_all(go_on)
            .map_err(|_| StatusCode::BAD_REQUEST)?;
    }
    let mut body = bytes.split_off(head);
    while body.len() < length {
        more(stream, &mut body, until)?;
    }
    body.truncate(length);
    Ok(asked.map(|()| body))
}

/// Reads some more bytes.
fn more(
    mut stream: &TcpStream,
    bytes: &mut Vec<u8>,
    until: Instant,
) -> Result<(), StatusCode> {
    let mut piece = [0; 1 << 14];
    let left = until.saturating_duration_since(Instant::now());
    if left.is_zero() {
        return Err(StatusCode::REQUEST_TIMEOUT);
    }
    let read = stream
        .set_read_timeout(Some(left))
        .and_then(|()| stream.read(&mut piece));
    match read {
        Ok(0) => Err(StatusCode::BAD_REQUEST),
        Ok(count) => {
            bytes.extend_from_slice(&piece[..count]);
            Ok(())
        }
        Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(()),
        Err(_) => Err(StatusCode::REQUEST_TIMEOUT),
    }
}

/// The head at the beginning of `bytes`, with its length, once it is whole.
fn head(bytes: &[u8]) -> Result<Option<(usize, Request<()>)>, StatusCode> {
    // Most pieces of a head are no end of one, and need not be read.
    if !bytes.ends_with(b"\n") && !bytes.windows(4).any(|w| w == b"\r\n\r\n") {
        return Ok(None);
    }
    let mut lines = [httparse::EMPTY_HEADER; MOST_LINES];
    let mut read = httparse::Request::new(&mut lines);
    let length = match read.parse(bytes) {
        Ok(httparse::Status::Complete(length)) => length,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(_) => return Err(StatusCode::BAD_REQUEST),
    };
    let mut asked = Request::builder()
        .method(read.method.unwrap_or_default())
        .uri(read.path.unwrap_or_default());
    for line in read.headers {
        asked = asked.header(line.name, line.value);
    }
    let asked = asked.body(()).map_err(|_| StatusCode::BAD_REQUEST)?;
    if asked.headers().get_all(HOST).iter().count() > 1 {
        return Err(StatusCode::BAD_REQUEST);
    }
    Ok(Some((length, asked)))
}

/// The length of the body that follows a head.
fn body_length(headers: &HeaderMap) -> Result<usize, StatusCode> {
    if headers.contains_key(TRANSFER_ENCODING) {
        return Err(StatusCode::LENGTH_REQUIRED);
    }
    let mut lengths = headers.get_all(CONTENT_LENGTH).iter();
    let Some(length) = lengths.next() else {
        return Ok(0);
    };
    let digits = length.to_str().ok().filter(|text| {
        !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
    });
    match (digits, lengths.next()) {
        (Some(digits), None) => digits
            .parse()
            .ok()
            .filter(|length| *length <= LARGEST_BODY)
            .ok_or(StatusCode::PAYLOAD_TOO_LARGE),
        _ => Err(StatusCode::BAD_REQUEST),
    }
}

fn write(stream: &TcpStream, reply: Reply) -> io::Result<()> {
    stream.set_write_timeout(Some(TIME))?;
    let (head, body) = reply.into_parts();
    let mut out = BufWriter::new(stream);
    write!(out, "HTTP/1.1 {}\r\n", head.status)?;
    for (name, value) in &head.headers {
        out.write_all(name.as_str().as_bytes())?;
        out.write_all(b": ")?;
        out.write_all(value.as_bytes())?;
        out.write_all(b"\r\n")?;
    }
    write!(out, "{CONTENT_LENGTH}: {}\r\n", body.length)?;
    out.write_all(b"connection: close\r\n\r\n")?;
    io::copy(&mut body.source.take(body.length), &mut out)?;
    out.flush()?;
    stream.shutdown(Shutdown::Write)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_refused(text: &str, code: StatusCode) {
        let refused = head(text.as_bytes()).and_then(|found| {
            let (_, asked) = found.unwrap();
            body_length(asked.headers())
        });
        assert_eq!(refused.unwrap_err(), code, "{text:?}");
    }

    #[test]
    fn a_head_is_read_once_it_is_whole() {
        let text =
            "GET /a?b=1 HTTP/1.1\r\nHost: c\r\nContent-Length: 5\r\n\r\n";
        for end in 0..text.len() {
            assert!(head(&text.as_bytes()[..end]).unwrap().is_none(), "{end}");
        }
        let bytes = format!("{text}hello");
        let (length, asked) = head(bytes.as_bytes()).unwrap().unwrap();
        assert_eq!(length, text.len());
        assert_eq!(asked.uri().query(), Some("b=1"));
        assert_eq!(body_length(asked.headers()), Ok(5));
    }

    #[test]
    fn heads_that_may_mean_two_things_are_refused() {
        let with = |lines: &str| format!("POST / HTTP/1.1\r\n{lines}\r\n");
        let many = "a: b\r\n".repeat(MOST_LINES + 1);
        for (lines, code) in [
            ("Host: a\r\nHost: a\r\n", StatusCode::BAD_REQUEST),
            (&*many, StatusCode::BAD_REQUEST),
            ("a b: c\r\n", StatusCode::BAD_REQUEST),
            ("Content-Length: +1\r\n", StatusCode::BAD_REQUEST),
            ("Content-Length: \r\n", StatusCode::BAD_REQUEST),
            (
                "Content-Length: 1\r\nContent-Length: 2\r\n",
                StatusCode::BAD_REQUEST,
            ),
            (
                "Content-Length: 99999999999999999999\r\n",
                StatusCode::PAYLOAD_TOO_LARGE,
            ),
            (
                "Transfer-Encoding: chunked\r\n",
                StatusCode::LENGTH_REQUIRED,
            ),
        ] {
            assert_refused(&with(lines), code);
        }
    }

    /// Half-sent requests are a connection each, and none is given up for 10 s.
    #[test]
    fn unfinished_requests_keep_nobody_out() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        thread::spawn(move || {
            serve(&listener, |asked| {
                Response::new(Body::of(asked.body().clone()))
            });
        });
        let begun = || {
            let mut stream = TcpStream::connect(address).unwrap();
            stream.write_all(b"POST / HTTP/1.1\r\nHost").unwrap();
            stream
        };
        let mut half: Vec<TcpStream> = Vec::new();
        for _ in 0..3 * WAITING {
            half.push(begun());
        }
        let mut stream = begun();
        let rest = b": a\r\nContent-Length: 5\r\n\r\nhello";
        stream.write_all(rest).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
        assert!(answer.ends_with("\r\n\r\nhello"), "{answer}");
        // The oldest ones have been given up.
        half[0].set_read_timeout(Some(TIME / 2)).unwrap();
        let mut byte = [0];
        let gone = half[0].read(&mut byte);
        assert!(gone.is_ok_and(|count| count == 0));
    }

    #[test]
    fn a_byte_now_and_then_is_not_enough() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        thread::spawn(move || {
            let mut stream = TcpStream::connect(address).unwrap();
            while stream.write_all(b"G").is_ok() {
                thread::sleep(Duration::from_millis(5));
            }
        });
        let (stream, _) = listener.accept().unwrap();
        let until = Instant::now() + Duration::from_millis(100);
        let refused = request(&stream, until).unwrap_err();
        assert_eq!(refused, StatusCode::REQUEST_TIMEOUT);
    }
}
