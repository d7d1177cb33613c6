//! The class of fields, and Python's values as fields, as arguments of shapes,
//! as settings and as parameters.

use fidget::context::Tree;
use isocontour::{Data, data_of};
use isoslice::model::{Argument, Loaded, Parameter};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use std::path::{PathBuf, absolute};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Lists and dictionaries inside one another. Places in lists of shapes need
/// three.
const DEEPEST: usize = 8;

/// The longest texts of settings are G-code templates.
const LONGEST: usize = 1 << 20;

/// A field f(x, y, z): negative inside the part, 0 on its surface. Lengths are
/// millimetres.
///
/// Operators and functions make new fields of fields and numbers. a | b is the
/// union (the lesser value), a & b the intersection (the greater one), ~a the
/// inverse.
#[pyclass(frozen, module = "isoslice")]
pub(crate) struct Expr {
    pub(crate) tree: Tree,
    /// True for what shapes make, and for what is made of shapes alone. Two of
    /// them are hardly meant to be added or subtracted.
    pub(crate) body: bool,
    /// Name of the file or text that the field was read from. Whatever is made
    /// of the field has none.
    pub(crate) name: Option<String>,
    /// Parameters of the script that the field was read from.
    pub(crate) parameters: Vec<Parameter>,
    /// Files that the field was read from. Whatever is made of the field has
    /// none but those of its data.
    pub(crate) files: Vec<PathBuf>,
}

impl From<Tree> for Expr {
    fn from(tree: Tree) -> Expr {
        Expr {
            tree,
            body: false,
            name: None,
            parameters: Vec::new(),
            files: Vec::new(),
        }
    }
}

impl Expr {
    /// The field as one that is a body, if `body` is true.
    pub(crate) fn with_body(self, body: bool) -> Expr {
        Expr { body, ..self }
    }
}

/// The data that fields read. It stays as long as Python runs, since nobody
/// knows which fields are made of which.
static KEPT: Mutex<Vec<Kept>> = Mutex::new(Vec::new());

/// Data, and the files that were read for it. Other data may be from some of
/// them.
struct Kept {
    data: Arc<dyn Data>,
    files: Vec<PathBuf>,
}

fn kept() -> MutexGuard<'static, Vec<Kept>> {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Files by paths that stay theirs when the program changes its folder.
fn whole(files: &[PathBuf]) -> Vec<PathBuf> {
    let whole = |file: &PathBuf| absolute(file).unwrap_or(file.clone());
    files.iter().map(whole).collect()
}

/// Keeps data, for which `files` were read.
pub(crate) fn keep(all: Vec<Arc<dyn Data>>, files: &[PathBuf]) {
    let files = whole(files);
    let mut kept = kept();
    for data in all {
        match kept.iter_mut().find(|k| Arc::ptr_eq(&k.data, &data)) {
            Some(known) => {
                let new = files.iter().filter(|f| !known.files.contains(f));
                let new: Vec<PathBuf> = new.cloned().collect();
                known.files.extend(new);
            }
            None => kept.push(Kept {
                data,
                files: files.clone(),
            }),
        }
    }
}

/// The files that were read for a field, or for its data.
pub(crate) fn files_of(field: &Expr) -> Vec<PathBuf> {
    let read = data_of(&field.tree);
    let is_read = |k: &&Kept| read.iter().any(|d| Arc::ptr_eq(d, &k.data));
    let kept = kept();
    let files = kept.iter().filter(is_read).flat_map(|k| &k.files);
    files.chain(&field.files).cloned().collect()
}

impl From<Loaded> for Expr {
    fn from(loaded: Loaded) -> Expr {
        keep(loaded.data, &loaded.files);
        Expr {
            tree: loaded.tree,
            body: false,
            name: Some(loaded.name),
            parameters: loaded.parameters,
            files: whole(&loaded.files),
        }
    }
}

/// A field: an `Expr`, what has a method `__isoslice__` that makes one, or a
/// number. It is the operand of an operator.
pub(crate) struct Field(pub(crate) Tree, pub(crate) Operand);

/// What an operand is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operand {
    Number,
    Field,
    Body,
}

impl<'py> FromPyObject<'_, 'py> for Field {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Some(expr) = expr(&given)? {
            let Expr { tree, body, .. } = expr.get();
            let operand = if *body { Operand::Body } else { Operand::Field };
            return Ok(Field(tree.clone(), operand));
        }
        let number = number(&given)?;
        Ok(Field(Tree::constant(number as f32), Operand::Number))
    }
}

/// The `Expr` that a value is or makes.
pub(crate) fn expr<'py>(
    given: &Bound<'py, PyAny>,
) -> PyResult<Option<Bound<'py, Expr>>> {
    if let Ok(expr) = given.cast::<Expr>() {
        return Ok(Some(expr.clone()));
    }
    let Some(make) = given.getattr_opt("__isoslice__")? else {
        return Ok(None);
    };
    let made = make.call0()?;
    match made.cast_into::<Expr>() {
        Ok(expr) => Ok(Some(expr)),
        Err(_) => Err(PyTypeError::new_err(
            "__isoslice__() is to return an isoslice.Expr",
        )),
    }
}

/// A number, of any type that has one value.
pub(crate) fn number(given: &Bound<'_, PyAny>) -> PyResult<f64> {
    let wrong = || {
        let name = given.get_type().name();
        let name = name.map_or_else(|_| "?".into(), |name| name.to_string());
        PyTypeError::new_err(format!(
            "here stands a value of type {name}, but a field (isoslice.Expr) \
             or a number is wanted"
        ))
    };
    // numpy takes an array of one number for a number.
    if given.is_instance_of::<PyBool>() || given.hasattr("__len__")? {
        return Err(wrong());
    }
    given.extract::<f64>().map_err(|error| {
        if error.is_instance_of::<PyTypeError>(given.py()) {
            wrong()
        } else {
            error
        }
    })
}

/// An argument of a shape.
pub(crate) fn argument(
    given: &Bound<'_, PyAny>,
    depth: usize,
) -> PyResult<Argument> {
    if depth > DEEPEST {
        return Err(PyValueError::new_err("lists nest too deeply"));
    }
    if let Some(expr) = expr(given)? {
        return Ok(Argument::Field(expr.get().tree.clone()));
    }
    if let Ok(flag) = given.cast::<PyBool>() {
        return Ok(Argument::Flag(flag.is_true()));
    }
    if given.is_instance_of::<PyInt>()
        && let Ok(whole) = given.extract::<i64>()
    {
        return Ok(Argument::Whole(whole));
    }
    if let Ok(named) = given.cast::<PyDict>() {
        let all = named.iter().map(|(name, value)| {
            Ok((name.extract::<String>()?, argument(&value, depth + 1)?))
        });
        return Ok(Argument::Named(all.collect::<PyResult<_>>()?));
    }
    if let Ok(text) = given.cast::<PyString>() {
        return Ok(Argument::Text(text.to_str()?.to_owned()));
    }
    if given.hasattr("__fspath__")? {
        let path: PathBuf = given.extract()?;
        return Ok(Argument::Text(path.to_string_lossy().into_owned()));
    }
    if given.hasattr("__len__")? {
        let all = given.try_iter()?;
        let all = all.map(|value| argument(&value?, depth + 1));
        return Ok(Argument::List(all.collect::<PyResult<_>>()?));
    }
    number(given).map(Argument::Number)
}

/// The value of a parameter or a setting, as the command line has it. Texts are
/// put by `text`.
fn word(
    name: &str,
    given: &Bound<'_, PyAny>,
    text: impl Fn(&str) -> String,
) -> PyResult<String> {
    if let Ok(truth) = given.cast::<PyBool>() {
        return Ok(truth.is_true().to_string());
    }
    if let Ok(given) = given.cast::<PyString>() {
        let given = given.to_str()?;
        if given.len() > LONGEST {
            return Err(PyValueError::new_err(format!(
                "{name}: a text of {} bytes is too long",
                given.len()
            )));
        }
        return Ok(text(given));
    }
    if given.is_instance_of::<PyInt>() {
        return given.str()?.extract();
    }
    if given.is_instance_of::<PyFloat>() {
        return Ok(format!("{:?}", given.extract::<f64>()?));
    }
    // Numbers of numpy.
    let whole = given.hasattr("__index__")?;
    if whole && let Ok(number) = given.extract::<i64>() {
        return Ok(number.to_string());
    }
    match number(given) {
        Ok(number) => Ok(format!("{number:?}")),
        Err(_) => Err(PyTypeError::new_err(format!(
            "{name} is to be a number, a text, True or False, not {}",
            given.get_type().name()?
        ))),
    }
}

/// A script's parameters, as `-D name=value` on the command line has them.
pub(crate) fn parameters(
    given: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<(String, String)>> {
    let Some(given) = given else {
        return Ok(Vec::new());
    };
    let one = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let name: String = name.extract()?;
        let value = word(&name, &value, str::to_owned)?;
        Ok((name, value))
    };
    given.iter().map(one).collect()
}

/// Assignments as `--set key=value` on the command line has them. Groups may be
/// dictionaries.
pub(crate) fn assignments(
    given: &Bound<'_, PyDict>,
    group: &str,
    depth: usize,
    found: &mut Vec<String>,
) -> PyResult<()> {
    if depth > DEEPEST {
        return Err(PyValueError::new_err("settings nest too deeply"));
    }
    for (key, value) in given.iter() {
        let key: String = key.extract()?;
        let key = format!("{group}{key}");
        match value.cast::<PyDict>() {
            // An empty group says nothing, but has to be a group.
            Ok(inner) if inner.is_empty() && !is_group(&key) => {
                found.push(format!("{key}={{}}"));
            }
            Ok(inner) => {
                assignments(inner, &format!("{key}."), depth + 1, found)?;
            }
            Err(_) => {
                let value = word(&key, &value, quoted)?;
                found.push(format!("{key}={value}"));
            }
        }
    }
    Ok(())
}

fn is_group(name: &str) -> bool {
    let group = |key: &isoslice::settings::Key| {
        key.name
            .strip_prefix(name)
            .is_some_and(|rest| rest.starts_with('.'))
    };
    isoslice::settings::keys().iter().any(group)
}

/// Text as TOML has it. Escapes of JSON are escapes of TOML, and one character
/// more needs one.
fn quoted(text: &str) -> String {
    let text = serde_json::Value::from(text).to_string();
    text.replace('\u{7f}', "\\u007f")
}

/// What a JSON text says, in Python's own types.
pub(crate) fn from_json<'py>(
    py: Python<'py>,
    value: &serde_json::Value,
) -> PyResult<Bound<'py, PyAny>> {
    use serde_json::Value;
    Ok(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(truth) => PyBool::new(py, *truth).to_owned().into_any(),
        Value::Number(number) => match number.as_i64() {
            Some(whole) => whole.into_pyobject(py)?.into_any(),
            None => {
                let number = number.as_f64().unwrap_or(f64::NAN);
                number.into_pyobject(py)?.into_any()
            }
        },
        Value::String(text) => PyString::new(py, text).into_any(),
        Value::Array(all) => {
            let list = PyList::empty(py);
            for value in all {
                list.append(from_json(py, value)?)?;
            }
            list.into_any()
        }
        Value::Object(all) => {
            let dict = PyDict::new(py);
            for (name, value) in all {
                dict.set_item(name, from_json(py, value)?)?;
            }
            dict.into_any()
        }
    })
}

/// Names and values as keyword arguments have them, and values before them.
pub(crate) fn arguments(
    given: &Bound<'_, PyTuple>,
    named: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<Argument>> {
    let mut all: Vec<Argument> = Vec::with_capacity(given.len() + 1);
    for value in given.iter() {
        all.push(argument(&value, 0)?);
    }
    if let Some(named) = named.filter(|named| !named.is_empty()) {
        all.push(argument(named, 0)?);
    }
    Ok(all)
}
