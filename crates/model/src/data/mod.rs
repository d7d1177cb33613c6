//! Data in models: meshes, drawings, text, pictures, volumes, samples.
//!
//! | file | what it does |
//! |---|---|
//! | `kinds` | the functions that make data, with their options |
//! | `options` | reads options by their names |
//! | `folder` | the files that a model may read |
//! | `files` | reads each file once |
//! | `taken` | what the making of data takes |

mod files;
mod folder;
mod kinds;
mod options;
mod pictures;
mod taken;
#[cfg(test)]
mod tests;
mod version;

pub(crate) use files::Files;
pub use kinds::is_mesh;
pub(crate) use kinds::{KINDS, kind};
pub(crate) use options::{Given, Options};

use std::sync::{Mutex, MutexGuard, PoisonError};

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
