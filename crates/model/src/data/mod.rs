//! Data in models: meshes, drawings, text, pictures, volumes, samples.
//!
//! | file | what it does |
//! |---|---|
//! | `kinds` | the functions that make data, with their options |
//! | `options` | reads options by their names |
//! | `files` | finds files that a model may read, and reads each once |

mod files;
mod kinds;
mod options;

pub(crate) use files::Files;
pub(crate) use kinds::{KINDS, is_mesh, kind};
pub(crate) use options::{Given, Options};
