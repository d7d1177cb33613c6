//! The work behind the page: read, draw, slice, over and over.
//!
//! What is to be shown may change at any time, and work that is then in vain is
//! stopped. If there is an error, the page shows it beside the model that was
//! made last.

use super::choice::Choice;
use super::job::Job;
use super::session::{
    Fault, Glimpse, Listed, Look, Print, Session, Shown, Text,
};
use super::subject::{Read, Subject};
use crate::cli::args::Gathered;
use crate::cli::excerpt::{excerpt, of_loading};
use crate::cli::limits::{GRACE, ThreadArgs};
use crate::cli::settings::origin;
use crate::cli::terminal;
use anyhow::Context;
use isoslice::files::{Output, read_text};
use isoslice::limits::{Limits, Reason, Stopped, Watch, doing};
use isoslice::model::{LoadError, Model};
use isoslice::pipeline::{self, Options, Summary};
use isoslice::plate::Plate;
use isoslice::preview::{Slabs, Toolpath};
use isoslice::reader::Reader;
use isoslice::settings::keys;
use serde::Serialize;
use serde_json::json;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, IntoInnerError};
use std::path::{Path, PathBuf};
use std::process::exit;
use std::sync::Arc;
use std::time::Duration;

/// Greatest processor time for a picture.
pub(super) const PICTURE: Limits = Limits {
    time: None,
    work: Some(Duration::from_secs(20)),
    memory_bytes: None,
    slow: None,
};

/// Greatest time for one layer ahead of the others. The part's picture, which
/// shows if there is no such layer, waits for so long. Nothing else depends on
/// this clock.
const GLIMPSE: Limits = Limits {
    time: Some(Duration::from_millis(250)),
    ..PICTURE
};

/// Reads, draws and slices what is to be shown, for ever.
pub(super) fn work(session: &Session, job: &Job) {
    let mut last = 0;
    loop {
        let (wanted, choice, watch) = {
            let mut state = session.next_wanted(last);
            let watch = job.limits.slicing_watch();
            state.watch = Some(watch.clone());
            (state.wanted, state.choice.clone(), watch)
        };
        last = wanted;
        let made = watch.last_resort(GRACE, &give_up, || {
            make(session, job, &choice, wanted)
        });
        let made = made.unwrap_or_else(|stopped| Err(stopped.into()));
        // The state is not locked meanwhile, since the script is read here.
        let fault = made.err().map(|error| fault(session, &error));
        session.tell(|state| {
            state.watch = None;
            // If the script fails, the next turn reports the error.
            if state.wanted == wanted {
                state.busy = None;
                state.fault = fault;
            }
        });
    }
}

/// Ends the program if it holds too much memory and does not free it. Work that
/// only takes too long is waited for.
fn give_up(stopped: &Stopped) {
    if matches!(stopped.reason, Reason::Memory | Reason::Space) {
        let _pending = Output::discard_all();
        terminal::report_error(&stopped.clone().into());
        exit(1);
    }
}

/// Greatest size of a script of which lines are shown, bytes.
const LARGEST_SCRIPT: u64 = 2 << 20;

/// The error, with the place in the script.
fn fault(session: &Session, error: &anyhow::Error) -> Fault {
    let files = session.lock().files.clone();
    let script = |name: &str| {
        let is_it = |file: &&PathBuf| file.display().to_string() == name;
        let file = files.iter().find(is_it).filter(|file| file.is_file())?;
        read_text(file, LARGEST_SCRIPT).ok()
    };
    Fault {
        text: terminal::causes(error).join("\nbecause: "),
        excerpt: excerpt(error, script).unwrap_or_default(),
    }
}

fn make(
    session: &Session,
    job: &Job,
    choice: &Choice,
    wanted: u64,
) -> anyhow::Result<()> {
    let read = Read::new(job, choice)?;
    let gathered = &read.gathered;
    let listed = list(gathered, choice);
    session.tell(|state| {
        // Files of data that the model read last time count until it is read
        // again.
        let mut files = read.files(job);
        let others = state.files.iter().filter(|file| !files.contains(file));
        let others: Vec<PathBuf> = others.cloned().collect();
        files.extend(others);
        state.files = files;
        state.warnings.clone_from(&gathered.warnings);
        let old = state.settings.as_ref();
        if old.is_none_or(|old| old.json != listed.0) {
            state.settings = Some(Arc::new(Listed {
                revision: state.revision,
                json: listed.0,
                toml: listed.1,
            }));
        }
    });
    let settings = &gathered.settings;
    // A parameter that the command line sets and no version of the script had is
    // a mistake. The session keeps the changes of lost parameters, since the
    // script may have them again: some editors empty a file before they write
    // it.
    let lenient = session.lock().model.is_some();
    let loaded = read.load(job, choice, lenient);
    session.tell(|state| {
        state.files = read.files(job);
        match &loaded {
            Ok(subject) => state.files.extend(subject.data_files()),
            // What is missing may appear.
            Err(error) => {
                let named = of_loading(error).map(LoadError::data_files);
                state.files.extend_from_slice(named.unwrap_or_default());
            }
        }
    });
    let subject = loaded?;
    let glimpse = glimpse(session, job, gathered, &subject.plate);
    let shown = show(session, job, subject, glimpse, wanted)?;
    let (gcode, summary) = slice(session, job, &shown.subject.plate)?;
    let name = job.name();
    let moves = moves(BufReader::new(gcode.read()), gathered, &name)?;
    let stem = Path::new(&name).file_stem().unwrap_or_default();
    let file = format!("{}.gcode", stem.to_string_lossy());
    session.tell(|state| {
        if state.wanted != wanted {
            return;
        }
        state.glimpse = None;
        state.print = Some(Arc::new(Print {
            revision: state.revision,
            told: json!({
                "revision": state.revision,
                "of_model": shown.revision,
                "file": file,
                "warnings": summary.warnings,
            }),
            moves: moves.into(),
            gcode,
            file,
            printer_model: settings.printer_model().to_owned(),
        }));
    });
    Ok(())
}

/// The moves of some G-code in the form that pages get.
fn moves(
    gcode: impl io::Read,
    gathered: &Gathered,
    name: &str,
) -> anyhow::Result<Vec<u8>> {
    let settings = &gathered.settings;
    let diameter = settings.filament_diameter();
    let reader = Reader::new(gcode).filament_diameter(diameter);
    let path = doing("reading", || Toolpath::read(reader))?;
    Ok(path.with_settings(settings).live_moves(name)?)
}

/// The layer of a new plate that a page shows, if it is quickly made. The
/// revisions of the layer and of the model are still to be filled in. An error
/// is not reported, since slicing the whole model reports it.
fn glimpse(
    session: &Session,
    job: &Job,
    gathered: &Gathered,
    plate: &Plate,
) -> Option<Glimpse> {
    let z = session.lock().layer?;
    let options = Options {
        threads: job.threads.count(),
        glimpse: Some(z),
        check: false,
        ..Options::default()
    };
    let mut gcode = Vec::new();
    let made = Watch::new(GLIMPSE).run(|| -> anyhow::Result<_> {
        let summary = pipeline::slice_plate(plate, &options, &mut gcode)?;
        let moves = moves(gcode.as_slice(), gathered, &job.name())?;
        Ok((summary, moves))
    });
    let (summary, moves) = made.ok()?.ok()?;
    Some(Glimpse {
        revision: 0,
        told: json!({
            "layer": summary.layers.start,
            "layers": summary.layer_count,
        }),
        moves: moves.into(),
    })
}

/// Tells of a new model, with its picture, if that is quickly drawn, and with one
/// of its layers, if there is one already.
fn show(
    session: &Session,
    job: &Job,
    subject: Subject,
    glimpse: Option<Glimpse>,
    wanted: u64,
) -> anyhow::Result<Arc<Shown>> {
    let look = session.lock().look;
    // A rough picture is drawn before a page asks for it, unless a page shows a
    // layer instead.
    let drawn = subject.drawn.as_ref().filter(|_| glimpse.is_none());
    let picture = drawn.map(|model| {
        draw_within(&Watch::new(PICTURE), model, look, job.threads)
    });
    let told = subject.told()?;
    Ok(session.tell(|state| {
        let mut told = told;
        told["revision"] = state.revision.into();
        let shown = Arc::new(Shown {
            revision: state.revision,
            subject,
            told,
        });
        if state.wanted == wanted {
            state.model = Some(shown.clone());
            state.fault = None;
            state.busy = Some("slicing");
            state.glimpse = glimpse.map(|mut glimpse| {
                glimpse.revision = state.revision;
                glimpse.told["revision"] = state.revision.into();
                glimpse.told["of_model"] = state.revision.into();
                Arc::new(glimpse)
            });
            if let Some(Ok(picture)) = picture {
                let picture = (shown.revision, look, picture.into());
                state.picture = Some(picture);
            }
        }
        shown
    }))
}

/// Draws a model within bounded work, without a background.
pub(super) fn draw_within(
    watch: &Watch,
    model: &Model,
    look: Look,
    threads: ThreadArgs,
) -> anyhow::Result<Vec<u8>> {
    watch.run(|| {
        let pool = threads.workers()?;
        let (view, size) = (look.view, look.size);
        let draw = || {
            if look.rough {
                view.sketch(model, size, None)
            } else {
                view.draw(model, &Slabs::default(), size, None)
            }
        };
        let drawn = pool.install(|| doing("picture", draw));
        drawn.with_context(|| format!("cannot draw {}", model.name))
    })?
}

fn slice(
    session: &Session,
    job: &Job,
    plate: &Plate,
) -> anyhow::Result<(Arc<Text>, Summary)> {
    let options = Options {
        threads: job.threads.count(),
        on_layer: &|done, total| session.report(done, total),
        ..Options::default()
    };
    let no_file = "cannot make a temporary file for the G-code";
    let file: File = tempfile::tempfile().context(no_file)?;
    let mut gcode = BufWriter::new(file);
    let sliced = pipeline::slice_plate(plate, &options, &mut gcode);
    let summary =
        sliced.with_context(|| format!("cannot slice {}", plate.name))?;
    let text = gcode
        .into_inner()
        .map_err(IntoInnerError::into_error)
        .and_then(Text::new)
        .context(no_file)?;
    Ok((Arc::new(text), summary))
}

/// A setting as the page gets it.
#[derive(Serialize)]
struct Setting {
    name: &'static str,
    section: String,
    description: String,
    unit: &'static str,
    /// All words that the setting may be, if it takes nothing else.
    words: &'static [&'static str],
    /// Words that the setting may be, beside other values.
    some_words: &'static [&'static str],
    allowed: String,
    value: String,
    from: String,
    /// True if the page has set the setting.
    set: bool,
    /// True if the value differs from the default.
    differs: bool,
}

/// All settings as JSON, and those that are not the defaults as TOML.
fn list(gathered: &Gathered, choice: &Choice) -> (String, String) {
    let mut all = Vec::new();
    let mut toml = String::new();
    for key in keys() {
        let value = key.get(&gathered.settings);
        let differs = value != key.default();
        if differs {
            toml.push_str(&format!("{} = {value}\n", key.name));
        }
        all.push(Setting {
            name: key.name,
            section: key.section(),
            description: key.description(),
            unit: key.unit,
            words: key.words(),
            some_words: key.some_words(),
            allowed: key.allowed(),
            value: bare(value),
            from: origin(gathered, key),
            set: choice.set.contains_key(key.name),
            differs,
        });
    }
    (serde_json::to_string(&all).unwrap_or_default(), toml)
}

/// A value as `--set` takes it: a word without its quotes.
fn bare(value: String) -> String {
    let inner = value.strip_prefix('"').and_then(|v| v.strip_suffix('"'));
    match inner {
        Some(word) if !word.is_empty() && !word.contains(['"', '\\']) => {
            word.to_owned()
        }
        _ => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lose_their_quotes_and_texts_keep_theirs() {
        for (value, shown) in [
            ("\"auto\"", "auto"),
            ("0.2", "0.2"),
            ("\"\"", "\"\""),
            ("\"G28\\nG1\"", "\"G28\\nG1\""),
        ] {
            assert_eq!(bare(value.to_owned()), shown);
        }
    }
}
