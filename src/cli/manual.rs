//! `isoslice completions` and `isoslice man`: scripts by which shells ask this
//! program what may follow, and manual pages made of the command line's
//! description.

use super::output::{create, print};
use super::{Cli, complete};
use anyhow::{Context, bail};
use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};
use std::path::{Path, PathBuf};

const COMPLETIONS: &str = "\
Where shells look for it:
  isoslice completions bash > ~/.local/share/bash-completion/completions/isoslice
  isoslice completions zsh > ~/.zfunc/_isoslice      with ~/.zfunc in $fpath
  isoslice completions fish > ~/.config/fish/completions/isoslice.fish
  isoslice completions powershell >> $PROFILE
  isoslice completions elvish >> ~/.config/elvish/rc.elv";

const MAN: &str = "\
Examples:
  isoslice man | man -l -               read it
  isoslice man slice | man -l -
  isoslice man --dir ~/.local/share/man/man1";

/// Arguments of `isoslice completions`.
#[derive(Args, Debug)]
#[command(after_help = COMPLETIONS)]
pub(super) struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

/// Arguments of `isoslice man`.
#[derive(Args, Debug)]
#[command(after_help = MAN)]
pub(super) struct ManArgs {
    /// The page of this command instead of the whole program's
    command: Option<String>,

    /// Write all pages into this folder instead
    #[arg(long, value_name = "DIR", conflicts_with = "command")]
    dir: Option<PathBuf>,
}

pub(super) fn completions(args: &CompletionsArgs) -> anyhow::Result<()> {
    print(&complete::script(&args.shell.to_string())?)
}

pub(super) fn man(args: &ManArgs) -> anyhow::Result<()> {
    let mut program = Cli::command();
    program.build();
    if let Some(folder) = &args.dir {
        return write_all(&program, folder);
    }
    let command = match &args.command {
        None => &program,
        Some(name) => match program.find_subcommand(name) {
            Some(command) => command,
            None => bail!(
                "there is no command {name:?}; `isoslice help` lists them"
            ),
        },
    };
    print(&page(command)?.1)
}

/// File name and text of a command's page.
fn page(command: &Command) -> anyhow::Result<(String, Vec<u8>)> {
    let page = Man::new(command.clone());
    let mut text = Vec::new();
    page.render_title(&mut text)?;
    page.render_name_section(&mut text)?;
    page.render_synopsis_section(&mut text)?;
    page.render_options_section(&mut text)?;
    if command.has_subcommands() {
        page.render_subcommands_section(&mut text)?;
    }
    let more = command.get_after_help().map(ToString::to_string);
    sections(&more.unwrap_or_default()).to_writer(&mut text)?;
    Ok((page.get_filename(), text))
}

/// The text below a command's options. Each paragraph with a heading becomes a
/// section and keeps its lines.
fn sections(text: &str) -> Roff {
    let mut page = Roff::new();
    for paragraph in text.split("\n\n") {
        let mut lines = paragraph.lines();
        let heading = lines.next().unwrap_or_default().trim_end_matches(':');
        page.control("SH", [heading.to_uppercase().as_str()]);
        page.control("nf", []);
        for line in lines {
            page.text([roman(line.trim_start())]);
        }
        page.control("fi", []);
    }
    page
}

fn write_all(program: &Command, folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| {
        format!("cannot make the folder {}", folder.display())
    })?;
    let commands = program.get_subcommands().filter(|c| c.get_name() != "help");
    for command in std::iter::once(program).chain(commands) {
        let (name, text) = page(command)?;
        let path = folder.join(name);
        let mut file = create(&path, &[])?;
        file.put(&text)?;
        file.finish()?;
    }
    Ok(())
}
