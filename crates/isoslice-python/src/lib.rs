//! The native half of the Python package `isoslice`.
//!
//! The other half, `python/isoslice`, has the functions with their signatures
//! and their words for people. This half has what Python cannot do: the class
//! `Expr`, and slicing.
//!
//! | file | what it does |
//! |---|---|
//! | `error` | the library's errors as exceptions |
//! | `value` | the class `Expr`; Python's values as fields, arguments and settings |
//! | `operation` | operations on fields, by their names |
//! | `expr` | the operators and functions of `Expr`, and its value at places |
//! | `pickle` | fields as plain values, for pickle |
//! | `request` | the keywords of `slice`: which model, how it is placed, settings |
//! | `work` | work without the GIL, with progress, that Ctrl-C ends |
//! | `output` | the file or the bytes that G-code goes to |
//! | `export` | fields as 3MF files |
//! | `sliced` | slicing, and its results |
//! | `outline` | outlines of layers |
//! | `list` | settings and profiles that there are |
//!
//! Guaranteed: any value leads to a result or to an exception. The bytes of a
//! file are those of the command line for that model and those settings. No
//! text of an error is written here if the library or the command line has it.

mod error;
mod export;
mod expr;
mod list;
mod operation;
mod outline;
mod output;
mod pickle;
mod request;
mod sliced;
mod value;
mod work;

use pyo3::prelude::*;

/// The native half of isoslice.
#[pymodule]
mod _native {
    use super::*;

    #[pymodule_export]
    use crate::error::{Error, ModelError, SettingsError, SliceError, Stopped};
    #[pymodule_export]
    use crate::expr::{call, evaluate, load, unpickled_expr};
    #[pymodule_export]
    use crate::list::{profiles, settings};
    #[pymodule_export]
    use crate::outline::{outlines, rings};
    #[pymodule_export]
    use crate::sliced::{Sliced, slice, unpickled_sliced};
    #[pymodule_export]
    use crate::value::Expr;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
