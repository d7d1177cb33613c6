//! `isoslice watch`: a page that shows a model while it is edited.
//!
//! ```text
//!   files ──► session ◄──► server ◄──► pages
//!                ▲
//!                ▼
//!              work: read, draw, slice
//! ```
//!
//! `session` holds what is wanted and what there is, `work` makes it, `server`
//! tells the page of it, behind `guard` and in the words of `http`; `stamp` sees
//! that files have changed, `choice` holds what the page's user has changed, and
//! `subject` loads the model or the plate file with that. `job` has the
//! command's arguments.

mod choice;
mod guard;
mod http;
mod job;
mod server;
mod session;
mod stamp;
mod subject;
mod work;

use super::args::{ModelArgs, SettingsSource};
use super::limits::{LimitArgs, ThreadArgs};
use super::plates::PlateArgs;
use super::{plain, printers, terminal};
use anyhow::{Context, bail};
use choice::Choice;
use clap::Args;
use guard::Guard;
use isoslice::limits::enough_space;
use job::Job;
use server::Site;
use session::Session;
use stamp::Stamps;
use std::net::{Ipv4Addr, TcpListener};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::exit;
use std::sync::Arc;
use std::thread;
use work::work;

const EXAMPLES: &str = "\
Examples:
  isoslice watch part.rhai --open
  isoslice watch part.rhai --config part.toml --printer prusa-mk4
  isoslice watch plate.toml
  isoslice watch part.rhai -D radius=15 --port 8123";

/// Arguments of `isoslice watch`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = "isoslice watch [OPTIONS] <MODEL>\n       \
                      isoslice watch [OPTIONS] -e <FORMULA>",
    mut_arg("model", |arg| arg.help(
        "The model: a Rhai script (.rhai), a mesh (.stl, .obj, .ply, .3mf) or \
         fidget's text format (.vm); or a plate file (.toml)"
    )),
    mut_arg("format", |arg| arg.hide(true))
)]
pub(super) struct WatchArgs {
    #[command(flatten)]
    model: ModelArgs,

    #[command(flatten)]
    settings: SettingsSource,

    /// Port of the page's address [default: one that is free]
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u16).range(1..),
        help_heading = "Page"
    )]
    port: Option<u16>,

    /// Show the page in the browser, too
    #[arg(long, help_heading = "Page")]
    open: bool,

    #[command(flatten, next_help_heading = "Page")]
    threads: ThreadArgs,

    #[command(flatten)]
    limits: LimitArgs,
}

pub(super) fn run(args: WatchArgs) -> anyhow::Result<()> {
    enough_space()?;
    if args.model.is_stdin() {
        bail!(
            "watch shows a model again whenever its file changes; name a file \
             instead of standard input"
        );
    }
    let job = Arc::new(Job {
        model: args.model,
        settings: args.settings,
        limits: args.limits,
        threads: args.threads,
    });
    // What is wrong with the command line is an error at once; what is wrong
    // with the model and in the files is shown in the page, until it is mended.
    PlateArgs::default().refuse_beside_file(&job.model)?;
    let profiles = job.settings.profiles.find()?;
    let given = job.model.model.iter().chain(&job.settings.config);
    let files: Vec<_> = given.cloned().collect();
    for file in &files {
        if !file.is_file() {
            bail!("there is no file {}; check its name", file.display());
        }
    }

    let listener = listener(args.port)?;
    let port = listener.local_addr()?.port();
    let guard = Guard::new(port)?;
    let address = guard.address();
    let choice = Choice::of(&job.model, &job.settings);
    let session = Arc::new(Session::new(choice, files));
    let printers = printers::book(&job.settings.profiles)?;
    let printers = printers.printers().map(|p| p.name.clone()).collect();
    let site =
        Site::new(session.clone(), job.clone(), guard, &profiles, printers);
    {
        let session = session.clone();
        thread::Builder::new()
            .name("work".into())
            .spawn(move || or_end(|| work(&session, &job)))
            .context("cannot start a thread")?;
    }
    thread::Builder::new()
        .name("files".into())
        .spawn(move || or_end(|| watch_files(&session)))
        .context("cannot start a thread")?;

    if !terminal::is_quiet() {
        plain::print("Showing the model until you press Ctrl-C:\n")?;
    }
    plain::print(&format!("{address}\n"))?;
    if args.open {
        open::that_detached(&address).context(
            "cannot start a browser; open the address in one yourself",
        )?;
    }
    http::serve(&listener, move |asked| site.answer(asked));
    Ok(())
}

/// Does some work, and ends the program if the work panics. Otherwise the page
/// would wait for ever.
fn or_end(work: impl FnOnce()) {
    if catch_unwind(AssertUnwindSafe(work)).is_err() {
        exit(101);
    }
}

/// Waits for files to change.
fn watch_files(session: &Session) {
    let mut stamps = Stamps::new();
    loop {
        let files = session.lock().files.clone();
        if stamps.changed(&files) {
            session.want(|_| ());
        }
        thread::sleep(stamp::EVERY);
    }
}

/// Listens on the port that was asked for, or on one that is free.
fn listener(wanted: Option<u16>) -> anyhow::Result<TcpListener> {
    let port = wanted.unwrap_or(0);
    TcpListener::bind((Ipv4Addr::LOCALHOST, port)).with_context(|| {
        format!(
            "cannot use port {port} of 127.0.0.1; choose another with --port"
        )
    })
}
