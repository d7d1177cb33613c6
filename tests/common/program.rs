//! The program, as tests run it.

// Each test binary uses its share of this.
#![allow(dead_code, reason = "not every test runs the program")]

use assert_cmd::Command;
use std::path::Path;

/// The program in `folder`, on a terminal of known width. Its profiles are in
/// the folder `profiles` there, since whoever runs the tests may have some.
pub fn isoslice(folder: &(impl AsRef<Path> + ?Sized)) -> Command {
    let mut command = assert_cmd::cargo::cargo_bin_cmd!("isoslice");
    command
        .current_dir(folder)
        .env("COLUMNS", "80")
        .env("ISOSLICE_PROFILES", folder.as_ref().join("profiles"))
        .env_remove("ISOSLICE_COMPLETE")
        .env_remove("NO_COLOR");
    command
}
