//! Answers the page's requests.
//!
//! Guaranteed: whatever is asked, by whomever, the answer takes bounded time and
//! memory, and no file of the user's is read or written for it. What comes from
//! the model leaves as JSON, which the page shows as text.

use super::guard::Guard;
use super::session::{Look, Session, State};
use super::work::{Job, draw_within, name_of};
use crate::cli::plain;
use isoslice::preview::{View, live_html};
use isoslice::settings::{ProfileKind, Profiles};
use oxhttp::model::header::{
    CACHE_CONTROL, CONTENT_DISPOSITION, CONTENT_SECURITY_POLICY, CONTENT_TYPE,
    HeaderName, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use oxhttp::model::{Body, HeaderValue, Method, Request, Response, StatusCode};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::io::{Cursor, Read};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How long a page waits for news before it asks again.
const PATIENCE: Duration = Duration::from_secs(15);

/// Bytes that a page may send at once.
const LARGEST_BODY: u64 = 1 << 20;

/// Greatest side of a picture, pixels.
const LARGEST_PICTURE: usize = 2048;

/// What the answers are made of.
pub(super) struct Site {
    pub session: Arc<Session>,
    pub job: Arc<Job>,
    pub guard: Guard,
    page: String,
    profiles: Value,
    /// Held while a picture is drawn: one at a time leaves time for slicing.
    drawing: Mutex<()>,
}

/// An answer, or why there is none.
type Answer = Result<Response<Body>, (StatusCode, String)>;

impl Site {
    pub(super) fn new(
        session: Arc<Session>,
        job: Arc<Job>,
        guard: Guard,
        profiles: &Profiles,
    ) -> Site {
        let kinds = [
            ProfileKind::Printer,
            ProfileKind::Filament,
            ProfileKind::Preset,
        ];
        let names = |kind: ProfileKind| {
            let (profiles, _) = profiles.list(kind);
            let names: Vec<_> = profiles.into_iter().map(|p| p.name).collect();
            json!({ "kind": kind.word(), "names": names })
        };
        Site {
            page: live_html(&name_of(&job)),
            session,
            job,
            guard,
            profiles: kinds.map(names).to_vec().into(),
            drawing: Mutex::new(()),
        }
    }

    /// Answers a request.
    pub(super) fn answer(&self, request: &mut Request<Body>) -> Response<Body> {
        let mut response = self.route(request).unwrap_or_else(|(code, text)| {
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

    fn route(&self, request: &mut Request<Body>) -> Answer {
        let uri = request.uri().clone();
        let below = self
            .guard
            .admit(uri.path(), request.headers())
            .map_err(|code| (code, "this address is not known".to_owned()))?;
        let query = Query::of(uri.query().unwrap_or_default());
        let post = request.method() == Method::POST;
        if !post && request.method() != Method::GET {
            let words = "there is only GET and POST".to_owned();
            return Err((StatusCode::METHOD_NOT_ALLOWED, words));
        }
        match (post, below) {
            (false, "") => Ok(of_type(
                "text/html; charset=utf-8",
                self.page.clone(),
            )),
            (false, "state") => self.state(&query),
            (false, "settings") => self.settings(),
            (false, "settings.toml") => self.toml(),
            (false, "picture") => self.picture(&query),
            (false, "print") => self.print(&query),
            (false, "gcode") => self.gcode(&query),
            (true, "change") => self.change(request),
            _ => Err((StatusCode::NOT_FOUND, "there is no such thing".into())),
        }
    }

    /// What there is to show, once it is news.
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
            "printers": [],
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
        let name = name_of(&self.job);
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
        };
        let drawing = self.drawing.lock();
        let _drawing = drawing.unwrap_or_else(PoisonError::into_inner);
        let (model, known) = {
            let mut state = self.session.lock();
            if query.number("rough", 0.0)? > 0.0 {
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
                let drawn = draw_within(&model.model, look, self.job.threads);
                let drawn = drawn.map_err(|error| {
                    (StatusCode::SERVICE_UNAVAILABLE, format!("{error:#}"))
                })?;
                let drawn: Arc<[u8]> = drawn.into();
                self.session.lock().picture =
                    Some((model.revision, look, drawn.clone()));
                drawn
            }
        };
        Ok(of_type("image/png", shared(picture)))
    }

    fn print(&self, query: &Query) -> Answer {
        let print = self.session.lock().print.clone();
        let print = print.ok_or_else(not_yet)?;
        query.must_be("revision", print.revision)?;
        let moves = shared(print.moves.clone());
        Ok(of_type("application/octet-stream", moves))
    }

    fn gcode(&self, query: &Query) -> Answer {
        let print = self.session.lock().print.clone();
        let print = print.ok_or_else(not_yet)?;
        query.must_be("print", print.revision)?;
        let text = Body::from_read(print.gcode.read());
        let response = of_type("text/x-gcode; charset=utf-8", text);
        Ok(as_file(response, &print.file, "gcode"))
    }

    fn change(&self, request: &mut Request<Body>) -> Answer {
        let body = body(request)?;
        let mut changed = Ok(());
        // Checked first, so that a mistake stops no work.
        let mut choice = self.session.lock().choice.clone();
        if let Err(error) = choice.change(&body) {
            return Err((StatusCode::BAD_REQUEST, error));
        }
        self.session.want(|state| changed = state.choice.change(&body));
        changed.map_err(|error| (StatusCode::BAD_REQUEST, error))?;
        Ok(of_type("application/json", "{}"))
    }
}

const OPENER_POLICY: HeaderName =
    HeaderName::from_static("cross-origin-opener-policy");
const RESOURCE_POLICY: HeaderName =
    HeaderName::from_static("cross-origin-resource-policy");

fn not_yet() -> (StatusCode, String) {
    (StatusCode::NOT_FOUND, "that is not there yet".to_owned())
}

/// The JSON that a request brings.
fn body(
    request: &mut Request<Body>,
) -> Result<Vec<u8>, (StatusCode, String)> {
    let kind = request.headers().get(CONTENT_TYPE);
    if kind.is_none_or(|kind| kind != "application/json") {
        let words = "changes are JSON".to_owned();
        return Err((StatusCode::UNSUPPORTED_MEDIA_TYPE, words));
    }
    let mut bytes = Vec::new();
    let read = request.body_mut().take(LARGEST_BODY + 1);
    let read = { read }.read_to_end(&mut bytes);
    read.map_err(|error| (StatusCode::BAD_REQUEST, error.to_string()))?;
    if bytes.len() as u64 > LARGEST_BODY {
        let words = "that is more than 1 MB".to_owned();
        return Err((StatusCode::PAYLOAD_TOO_LARGE, words));
    }
    Ok(bytes)
}

fn of_type(kind: &'static str, body: impl Into<Body>) -> Response<Body> {
    let mut response = Response::new(body.into());
    let kind = HeaderValue::from_static(kind);
    response.headers_mut().insert(CONTENT_TYPE, kind);
    response
}

fn shared(bytes: Arc<[u8]>) -> Body {
    Body::from_read(Cursor::new(bytes))
}

/// The response as a file to save. Its name has plain letters only; the page
/// asks for the whole one.
fn as_file(
    mut response: Response<Body>,
    name: &str,
    extension: &str,
) -> Response<Body> {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let letter = |c: char| match c {
        '-' | '_' | '.' => c,
        c if c.is_ascii_alphanumeric() => c,
        _ => '_',
    };
    let stem: String = stem.chars().take(100).map(letter).collect();
    let value = format!("attachment; filename=\"{stem}.{extension}\"");
    if let Ok(value) = HeaderValue::try_from(value) {
        response.headers_mut().insert(CONTENT_DISPOSITION, value);
    }
    response
}

/// What stands behind the question mark. All of it is numbers.
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
        let words = "there is a newer one by now".to_owned();
        Err((StatusCode::CONFLICT, words))
    }
}
