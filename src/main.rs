//! The command `isoslice`: parse, run, report.
//!
//! Exit codes: 0 done; 1 something is wrong with the input; 2 the command line
//! is wrong; 130 interrupted; 141 the reader of standard output has closed it
//! before the end, which needs no message.

#![warn(unreachable_pub)]

mod cli;

use std::io::ErrorKind::BrokenPipe;
use std::process::ExitCode;

/// Exit code that shells have for the signal of a pipe that nobody reads.
const BROKEN_PIPE: u8 = 141;

fn main() -> ExitCode {
    cli::complete::answer();
    match cli::run(cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_broken_pipe(&error) => ExitCode::from(BROKEN_PIPE),
        Err(error) => {
            cli::terminal::report_error(&error);
            ExitCode::FAILURE
        }
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == BrokenPipe)
    })
}
