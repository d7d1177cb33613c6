//! Answers the page's requests.
//!
//! Guaranteed: an answer takes bounded time and memory, whatever is asked and
//! whoever asks. No request writes a file of the user's. The only files that
//! are read are the model or the plate file with its models, profiles and the
//! infill's script, if a setting names one. What comes from the model leaves as
//! JSON, which the page shows as text.

use super::guard::Guard;
use super::http::{Asked, Body, Reply};
use super::job::Job;
use super::session::{Look, Print, Sending, Session, State};
use super::work::{PICTURE, draw_within};
use crate::cli::hosts;
use crate::cli::send::outcome;
use crate::cli::{plain, printers};
use anyhow::bail;
use http::header::{
    CACHE_CONTROL, CONTENT_DISPOSITION, CONTENT_SECURITY_POLICY, CONTENT_TYPE,
    HeaderName, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use http::{HeaderValue, Method, Response, StatusCode};
use isoslice::limits::Watch;
use isoslice::preview::{View, live_html};
use isoslice::settings::{ProfileKind, Profiles};
use serde::Deserialize;
use serde_json::{Value, json};
use std::cell::Cell;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// How long a page waits for news before it asks again.
const PATIENCE: Duration = Duration::from_secs(15);

/// Greatest side of a picture, pixels.
const LARGEST_PICTURE: usize = 2048;

/// Makes the answers.
pub(super) struct Site {
    pub session: Arc<Session>,
    pub job: Arc<Job>,
    pub guard: Guard,
    page: String,
    profiles: Value,
    /// Names of the printers to which G-code can be sent.
    printers: Vec<String>,
    /// Locked while a picture is drawn. Only one is drawn at a time, which
    /// leaves processor time for slicing.
    drawing: Mutex<()>,
    /// Stops the fine picture that is being drawn, so that a rough one need not
    /// wait for it.
    fine: Mutex<Option<Watch>>,
}

/// An answer, or the error that is sent instead.
type Answer = Result<Reply, (StatusCode, String)>;

impl Site {
    pub(super) fn new(
        session: Arc<Session>,
        job: Arc<Job>,
        guard: Guard,
        profiles: &Profiles,
        printers: Vec<String>,
    ) -> Site {
        let names = |kind: ProfileKind| {
            let (profiles, _) = profiles.list(kind);
            let names: Vec<_> = profiles.into_iter().map(|p| p.name).collect();
            json!({ "kind": kind.name(), "names": names })
        };
        Site {
            page: live_html(&job.name()),
            session,
            job,
            guard,
            profiles: ProfileKind::ALL.map(names).to_vec().into(),
            printers,
            drawing: Mutex::new(()),
            fine: Mutex::new(None),
        }
    }

    /// Answers a request.
    pub(super) fn answer(&self, request: &Asked) -> Reply {
        let mut response =
            self.route(request).unwrap_or_else(|(code, text)| {
                let mut refusal = of_type("text/plain; charset=utf-8", text);
                *refusal.status_mut() = code;
                refusal
            });
        let policy = "frame-ancestors 'none'";
        for (name, value) in [
            (CACHE_CONTROL, "no-store"),
            (X_CONTENT_TYPE_OPTIONS, "nosniff"),
            (X_FRAME_OPTIONS, "DENY"),
            (REFERRER_POLICY, "no-referrer"),
            (CONTENT_SECURITY_POLICY, policy),
            (OPENER_POLICY, "same-origin"),
            (RESOURCE_POLICY, "same-origin"),
        ] {
            let headers = response.headers_mut();
            headers.insert(name, HeaderValue::from_static(value));
        }
        response
    }

    fn route(&self, request: &Asked) -> Answer {
        let uri = request.uri();
        let below = self
            .guard
            .admit(uri.path(), request.headers())
            .map_err(|code| (code, "this address is not known".to_owned()))?;
        let query = Query::of(uri.query().unwrap_or_default());
        let post = request.method() == Method::POST;
        if !post && request.method() != Method::GET {
            let words = "only GET and POST are allowed".to_owned();
            return Err((StatusCode::METHOD_NOT_ALLOWED, words));
        }
        match (post, below) {
            (false, "") => {
                Ok(of_type("text/html; charset=utf-8", self.page.clone()))
            }
            (false, "state") => self.state(&query),
            (false, "settings") => self.settings(),
            (false, "settings.toml") => self.toml(),
            (false, "picture") => self.picture(&query),
            (false, "print") => self.print(&query),
            (false, "glimpse") => self.glimpse(&query),
            (false, "gcode") => self.gcode(&query),
            (false, "line") => self.line(&query),
            (true, "change") => self.change(request),
            (true, "send") => self.send(request),
            (true, "layer") => self.layer(request),
            _ => {
                Err((StatusCode::NOT_FOUND, "this address is not known".into()))
            }
        }
    }

    /// The state as JSON, once it is newer than what the page has.
    fn state(&self, query: &Query) -> Answer {
        let seen = query.number("seen", 0.0)? as u64;
        let state = self.session.news(seen, PATIENCE);
        let told = self.told(&state).to_string();
        drop(state);
        Ok(of_type("application/json", told))
    }

    fn told(&self, state: &State) -> Value {
        json!({
            "revision": state.revision,
            "busy": state.busy,
            "progress": state.progress,
            "fault": state.fault,
            "warnings": state.warnings,
            "choice": state.choice,
            "profiles": self.profiles,
            "settings": state.settings.as_ref().map_or(0, |s| s.revision),
            "model": state.model.as_ref().map(|model| &model.told),
            "print": state.print.as_ref().map(|print| &print.told),
            "glimpse": state.glimpse.as_ref().map(|glimpse| &glimpse.told),
            "printers": self.printers,
            "sending": state.sending,
        })
    }

    fn settings(&self) -> Answer {
        let settings = self.session.lock().settings.clone();
        let json = settings.map_or("[]".into(), |s| s.json.clone());
        Ok(of_type("application/json", json))
    }

    fn toml(&self) -> Answer {
        let settings = self.session.lock().settings.clone();
        let settings = settings.ok_or_else(not_yet)?;
        let name = self.job.name();
        let head = format!(
            "# Settings of {} that are not the defaults, for --config.\n\n",
            plain::line(&name)
        );
        let response =
            of_type("application/toml", head + settings.toml.as_str());
        Ok(as_file(response, &name, "toml"))
    }

    /// Draws the part as a page wants it.
    fn picture(&self, query: &Query) -> Answer {
        let side = |name| -> Result<usize, (StatusCode, String)> {
            let side = query.number(name, 400.0)?.max(16.0) as usize;
            Ok(side.min(LARGEST_PICTURE))
        };
        let look = Look {
            view: View {
                azimuth: query.number("azimuth", View::ISO.azimuth)?,
                elevation: query.number("elevation", View::ISO.elevation)?,
            },
            size: [side("width")?, side("height")?],
            rough: query.number("rough", 0.0)? > 0.0,
        };
        let fine = || self.fine.lock().unwrap_or_else(PoisonError::into_inner);
        if look.rough
            && let Some(watch) = fine().take()
        {
            watch.cancel();
        }
        let drawing = self.drawing.lock();
        let _drawing = drawing.unwrap_or_else(PoisonError::into_inner);
        let (model, known) = {
            let mut state = self.session.lock();
            if look.rough {
                state.look = look;
            }
            let model = state.model.clone().ok_or_else(not_yet)?;
            let known = state.picture.as_ref().filter(|(revision, of, _)| {
                *revision == model.revision && *of == look
            });
            (model, known.map(|(_, _, picture)| picture.clone()))
        };
        let picture = match known {
            Some(picture) => picture,
            None => {
                let drawn = model.subject.drawn.as_ref().ok_or_else(|| {
                    let why = "the parts are too large together to be drawn";
                    (StatusCode::NOT_FOUND, why.to_owned())
                })?;
                let watch = Watch::new(PICTURE);
                *fine() = (!look.rough).then(|| watch.clone());
                let threads = self.job.threads;
                let drawn = draw_within(&watch, drawn, look, threads);
                fine().take();
                let drawn = drawn.map_err(|error| {
                    (StatusCode::SERVICE_UNAVAILABLE, format!("{error:#}"))
                })?;
                let drawn: Arc<[u8]> = drawn.into();
                self.session.lock().picture =
                    Some((model.revision, look, drawn.clone()));
                drawn
            }
        };
        Ok(of_type("image/png", picture))
    }

    fn print(&self, query: &Query) -> Answer {
        let print = self.session.lock().print.clone();
        moves(query, print.map(|p| (p.revision, p.moves.clone())))
    }

    fn glimpse(&self, query: &Query) -> Answer {
        let glimpse = self.session.lock().glimpse.clone();
        moves(query, glimpse.map(|g| (g.revision, g.moves.clone())))
    }

    /// Remembers which layer a page shows.
    fn layer(&self, request: &Asked) -> Answer {
        let looked: Looked = serde_json::from_slice(body(request)?)
            .map_err(|error| (StatusCode::BAD_REQUEST, error.to_string()))?;
        self.session.lock().layer = looked.layer;
        Ok(of_type("application/json", "{}"))
    }

    fn gcode(&self, query: &Query) -> Answer {
        let print = self.session.lock().print.clone();
        let print = print.ok_or_else(not_yet)?;
        query.must_be("print", print.revision)?;
        let mut response = of_type("text/x-gcode; charset=utf-8", "");
        *response.body_mut() = Body {
            length: print.gcode.length,
            source: Box::new(print.gcode.read()),
        };
        Ok(as_file(response, &print.file, "gcode"))
    }

    /// A line of the G-code.
    fn line(&self, query: &Query) -> Answer {
        let print = self.session.lock().print.clone();
        let print = print.ok_or_else(not_yet)?;
        query.must_be("print", print.revision)?;
        let number = query.number("line", 0.0)?.max(0.0) as usize;
        let line = print.gcode.line(number).ok_or_else(not_yet)?;
        Ok(of_type("text/plain; charset=utf-8", line))
    }

    fn change(&self, request: &Asked) -> Answer {
        let body = body(request)?;
        let mut changed = Ok(());
        // The changes are checked first, so that a mistake does not stop the
        // work.
        let mut choice = self.session.lock().choice.clone();
        if let Err(error) = choice.change(body) {
            return Err((StatusCode::BAD_REQUEST, error));
        }
        self.session
            .want(|state| changed = state.choice.change(body));
        changed.map_err(|error| (StatusCode::BAD_REQUEST, error))?;
        Ok(of_type("application/json", "{}"))
    }

    /// Begins to send the print, if it is the newest one and no other print is
    /// being sent. The state then tells how far the sending has come.
    fn send(&self, request: &Asked) -> Answer {
        let order: Order = serde_json::from_slice(body(request)?)
            .map_err(|error| (StatusCode::BAD_REQUEST, error.to_string()))?;
        let refuse = |words: &str| (StatusCode::CONFLICT, words.to_owned());
        let print = self.session.tell(|state| {
            let current = state.busy.is_none() && state.fault.is_none();
            let print = state
                .print
                .clone()
                .filter(|print| current && print.revision == order.print);
            let print = print.ok_or_else(|| {
                refuse("the part has changed since; look at the new one first")
            })?;
            if state.sending.busy {
                return Err(refuse("another file is on its way"));
            }
            state.sending.busy = true;
            state.sending.text = format!("sending to {} …", order.to);
            Ok(print)
        })?;
        let (session, job) = (self.session.clone(), self.job.clone());
        let sent =
            thread::Builder::new().name("send".into()).spawn(move || {
                let text = send(&session, &job, &order, &print)
                    .unwrap_or_else(|error| format!("{error:#}"));
                session.tell(|state| {
                    state.sending = Sending { busy: false, text };
                });
            });
        if sent.is_err() {
            self.session
                .tell(|state| state.sending = Sending::default());
            return Err(refuse("the system allows no more threads"));
        }
        Ok(of_type("application/json", "{}"))
    }
}

/// The moves that a page asks for, if there are any of that revision.
fn moves(query: &Query, made: Option<(u64, Arc<[u8]>)>) -> Answer {
    let (revision, moves) = made.ok_or_else(not_yet)?;
    query.must_be("revision", revision)?;
    Ok(of_type("application/octet-stream", moves))
}

/// The height of the layer that a page shows, mm; none if it shows none.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Looked {
    layer: Option<f64>,
}

/// A request to send a print.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Order {
    to: String,
    start: bool,
    print: u64,
}

/// Sends a print, and says what became of it.
fn send(
    session: &Session,
    job: &Job,
    order: &Order,
    print: &Print,
) -> anyhow::Result<String> {
    let book = printers::book(&job.settings.profiles)?;
    let printer = book.find(&order.to)?;
    if let Some(wanted) = &printer.model
        && *wanted != print.printer_model
    {
        let made = match &*print.printer_model {
            "" => "no printer of a known model".to_owned(),
            other => format!("another printer, {other}"),
        };
        bail!(
            "the part was sliced for {made}, and {} is {wanted}; choose the \
             right one (its profile sets printer.model)",
            printer.name
        );
    }
    let told = Cell::new(0);
    let on_progress = |sent: u64, total: u64| {
        let percent = sent * 100 / total.max(1);
        if told.replace(percent) != percent {
            let text = format!("sending to {}: {percent} %", printer.name);
            session.tell(|state| state.sending.text = text);
        }
    };
    let sending = hosts::Sending {
        name: &print.file,
        start: order.start,
        on_progress: &on_progress,
    };
    let mut source = print.gcode.read();
    let sent =
        hosts::send_from(printer, &mut source, print.gcode.length, &sending)?;
    Ok(outcome(printer, &sent))
}

const OPENER_POLICY: HeaderName =
    HeaderName::from_static("cross-origin-opener-policy");
const RESOURCE_POLICY: HeaderName =
    HeaderName::from_static("cross-origin-resource-policy");

fn not_yet() -> (StatusCode, String) {
    (
        StatusCode::NOT_FOUND,
        "this has not been made yet".to_owned(),
    )
}

/// The JSON that a request brings.
fn body(request: &Asked) -> Result<&[u8], (StatusCode, String)> {
    let kind = request.headers().get(CONTENT_TYPE);
    if kind.is_none_or(|kind| kind != "application/json") {
        let words = "changes have to be JSON".to_owned();
        return Err((StatusCode::UNSUPPORTED_MEDIA_TYPE, words));
    }
    Ok(request.body())
}

fn of_type(kind: &'static str, body: impl AsRef<[u8]> + 'static) -> Reply {
    let mut response = Response::new(Body::of(body));
    let kind = HeaderValue::from_static(kind);
    response.headers_mut().insert(CONTENT_TYPE, kind);
    response
}

/// The response as a file to save. The header's name has plain letters only;
/// the page saves the file under its full name.
fn as_file(mut response: Reply, name: &str, extension: &str) -> Reply {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let stem = hosts::plain_letters(stem, 100);
    let value = format!("attachment; filename=\"{stem}.{extension}\"");
    if let Ok(value) = HeaderValue::try_from(value) {
        response.headers_mut().insert(CONTENT_DISPOSITION, value);
    }
    response
}

/// The numbers behind the question mark of an address, by their names.
struct Query<'a>(HashMap<&'a str, &'a str>);

impl Query<'_> {
    fn of(text: &str) -> Query<'_> {
        Query(text.split('&').filter_map(|p| p.split_once('=')).collect())
    }

    fn number(
        &self,
        name: &str,
        default: f64,
    ) -> Result<f64, (StatusCode, String)> {
        let Some(text) = self.0.get(name) else {
            return Ok(default);
        };
        let number = text.parse().ok().filter(|n: &f64| n.abs() < 1e15);
        number.ok_or_else(|| {
            (StatusCode::BAD_REQUEST, format!("{name} is not a number"))
        })
    }

    fn must_be(
        &self,
        name: &str,
        revision: u64,
    ) -> Result<(), (StatusCode, String)> {
        if self.number(name, -1.0)? == revision as f64 {
            return Ok(());
        }
        let words = "this is no longer the newest one".to_owned();
        Err((StatusCode::CONFLICT, words))
    }
}
