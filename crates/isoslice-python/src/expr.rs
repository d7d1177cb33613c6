//! What Python does with a field, an `Expr`: operators, functions, values.

use crate::error::plain;
use crate::export::{self, warn};
use crate::operation::name_of;
use crate::pickle::{Step, steps, tree};
use crate::request::loaded;
use crate::value::{
    Expr, Field, Operand, arguments, from_json, keep, parameters,
};
use crate::work::at_work;
use fidget::context::{Tree, TreeOp};
use fidget::var::Var;
use isocontour::{FieldError, Values, data_of, expand, known_data};
use isoslice::limits::Limits;
use isoslice::model::{self, Allowed, Argument, Parameter, Source};
use pyo3::basic::CompareOp;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Python binds `^` weaker than `+`.
const NO_POWER: &str = "`^` is no power in Python: write x**2";

impl Expr {
    /// True if a body stays one when a number is added or subtracted: it is grown
    /// or shrunk. Of two bodies `word` is meant, which is an error.
    fn moved_by(&self, sign: char, word: &str, by: Operand) -> PyResult<bool> {
        if self.body && by == Operand::Body {
            let or = if sign == '+' { " or a | b" } else { "" };
            return Err(PyTypeError::new_err(format!(
                "a {sign} b of two bodies is no {word}: it would calculate with \
                 the fields' values. Write isoslice.{word}(a, b){or}; where the \
                 values are meant, write a {sign} 1 * b"
            )));
        }
        Ok(self.body && by == Operand::Number)
    }
}

#[pymethods]
impl Expr {
    fn __add__(&self, other: Field) -> PyResult<Expr> {
        let body = self.moved_by('+', "union", other.1)?;
        Ok(Expr::from(self.tree.clone() + other.0).with_body(body))
    }

    fn __radd__(&self, other: Field) -> PyResult<Expr> {
        self.moved_by('+', "union", other.1)?;
        Ok((other.0 + self.tree.clone()).into())
    }

    fn __sub__(&self, other: Field) -> PyResult<Expr> {
        let body = self.moved_by('-', "difference", other.1)?;
        Ok(Expr::from(self.tree.clone() - other.0).with_body(body))
    }

    fn __rsub__(&self, other: Field) -> PyResult<Expr> {
        self.moved_by('-', "difference", other.1)?;
        Ok((other.0 - self.tree.clone()).into())
    }

    fn __mul__(&self, other: Field) -> Expr {
        (self.tree.clone() * other.0).into()
    }

    fn __rmul__(&self, other: Field) -> Expr {
        (other.0 * self.tree.clone()).into()
    }

    fn __truediv__(&self, other: Field) -> Expr {
        (self.tree.clone() / other.0).into()
    }

    fn __rtruediv__(&self, other: Field) -> Expr {
        (other.0 / self.tree.clone()).into()
    }

    fn __floordiv__(&self, other: Field) -> Expr {
        (self.tree.clone() / other.0).floor().into()
    }

    fn __rfloordiv__(&self, other: Field) -> Expr {
        (other.0 / self.tree.clone()).floor().into()
    }

    fn __mod__(&self, other: Field) -> Expr {
        self.tree.modulo(other.0).into()
    }

    fn __rmod__(&self, other: Field) -> Expr {
        other.0.modulo(self.tree.clone()).into()
    }

    fn __pow__(
        &self,
        exponent: &Bound<'_, PyAny>,
        modulo: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Expr> {
        if modulo.is_some() {
            return Err(PyTypeError::new_err(
                "pow() of a field takes no modulus; write (f ** n) % m",
            ));
        }
        power(Argument::Field(self.tree.clone()), operand(exponent)?)
    }

    fn __rpow__(
        &self,
        base: &Bound<'_, PyAny>,
        _modulo: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Expr> {
        power(operand(base)?, Argument::Field(self.tree.clone()))
    }

    fn __or__(&self, other: Field) -> Expr {
        let body = self.body && other.1 == Operand::Body;
        Expr::from(self.tree.min(other.0)).with_body(body)
    }

    fn __ror__(&self, other: Field) -> Expr {
        other.0.min(self.tree.clone()).into()
    }

    fn __and__(&self, other: Field) -> Expr {
        let body = self.body && other.1 == Operand::Body;
        Expr::from(self.tree.max(other.0)).with_body(body)
    }

    fn __rand__(&self, other: Field) -> Expr {
        other.0.max(self.tree.clone()).into()
    }

    fn __xor__(&self, _other: &Bound<'_, PyAny>) -> PyResult<Expr> {
        Err(PyTypeError::new_err(NO_POWER))
    }

    fn __rxor__(&self, _other: &Bound<'_, PyAny>) -> PyResult<Expr> {
        Err(PyTypeError::new_err(NO_POWER))
    }

    fn __neg__(&self) -> Expr {
        self.tree.neg().into()
    }

    fn __invert__(&self) -> Expr {
        Expr::from(self.tree.neg()).with_body(true)
    }

    fn __pos__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __abs__(&self) -> Expr {
        self.tree.abs().into()
    }

    #[pyo3(signature = (digits = None))]
    fn __round__(&self, digits: Option<i32>) -> PyResult<Expr> {
        match digits {
            None | Some(0) => Ok(self.tree.round().into()),
            Some(_) => Err(PyValueError::new_err(
                "a field is rounded to whole numbers only",
            )),
        }
    }

    fn __floor__(&self) -> Expr {
        self.tree.floor().into()
    }

    fn __ceil__(&self) -> Expr {
        self.tree.ceil().into()
    }

    fn __richcmp__(
        &self,
        other: &Bound<'_, PyAny>,
        op: CompareOp,
    ) -> PyResult<Py<PyAny>> {
        let py = other.py();
        match op {
            // Two fields are equal if they are one object.
            CompareOp::Eq | CompareOp::Ne => Ok(py.NotImplemented()),
            _ => Err(PyTypeError::new_err(
                "a field cannot be compared: x, y and z have no values yet. \
                 max(f, g) is where both are, min(f, g) where either is, \
                 isoslice.max(f, -x) is f where x > 0, and \
                 isoslice.compare(x, 0) is -1, 0 or 1",
            )),
        }
    }

    fn __hash__(slf: &Bound<'_, Self>) -> isize {
        // The lowest bits of an address are always 0.
        (slf.as_ptr() as isize) >> 4
    }

    fn __bool__(&self) -> PyResult<bool> {
        Err(PyTypeError::new_err(
            "a field is neither true nor false: x, y and z have no values \
             yet; write isoslice.max, isoslice.min or isoslice.compare \
             instead of if, and and or",
        ))
    }

    fn __repr__(&self) -> String {
        let mut text = String::from("Expr(");
        write_tree(&self.tree, 0, &mut text);
        text.push(')');
        text
    }

    /// Value of the field at a place, without unit checks: mm if the field is a
    /// distance. It is computed in 32 bits, as all layers are.
    fn __call__(&self, x: f64, y: f64, z: f64) -> PyResult<f64> {
        let values = values(&self.tree, &[[x, y, z]])?;
        values.first().copied().ok_or_else(|| {
            PyValueError::new_err("the field has no value there")
        })
    }

    /// The field at another place for each place: f(x, y, z) of three fields.
    fn remap(&self, x: Field, y: Field, z: Field) -> Expr {
        self.tree.remap_xyz(x.0, y.0, z.0).into()
    }

    /// Name of the file or text that the field was read from, or None.
    #[getter]
    fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Parameters of the script that the field was read from, as dictionaries
    /// with name, default, value and description.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let one = |p: &Parameter| {
            serde_json::json!({
                "name": p.name,
                "default": p.default,
                "value": p.value,
                "description": p.description,
            })
        };
        let all = self.parameters.iter().map(one).collect();
        from_json(py, &serde_json::Value::Array(all))
    }

    /// What pickle writes: how the field is made again.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Pickled)> {
        let again = py.import("isoslice._native")?.getattr("unpickled_expr")?;
        let parameters = self.parameters.iter().map(|p| {
            let Parameter {
                name,
                default,
                value,
                description,
                ..
            } = p.clone();
            (name, default, value, description)
        });
        let parameters = parameters.collect();
        let name = self.name.clone();
        Ok((again, (steps(&self.tree)?, name, parameters, self.body)))
    }

    /// Writes the field to a 3MF file whose shape is a function of nodes; without
    /// a file its bytes are the result. What the user should know is a
    /// SliceWarning. The file must be none that the field's data was read from.
    #[pyo3(signature = (output = None))]
    fn to_3mf<'py>(
        &self,
        py: Python<'py>,
        output: Option<PathBuf>,
    ) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let (bytes, warnings) = export::to_3mf(py, self, output)?;
        warn(py, &warnings)?;
        Ok(bytes.map(|bytes| PyBytes::new(py, &bytes)))
    }

    /// Number of distinct operations, constants and variables.
    #[getter]
    fn size(&self) -> PyResult<usize> {
        Ok(expand(&self.tree).map_err(plain)?.0.len())
    }
}

/// A field as pickle has it: its steps, its name, for each parameter its
/// name, default, value and description, and whether it is a body.
type Pickled = (
    Vec<Step>,
    Option<String>,
    Vec<(String, String, String, String)>,
    bool,
);

/// A field that pickle has read. Pickles of earlier versions do not say whether
/// it is a body.
#[pyfunction]
#[pyo3(signature = (steps, name, parameters, body = false))]
pub(crate) fn unpickled_expr(
    steps: Vec<Step>,
    name: Option<String>,
    parameters: Vec<(String, String, String, String)>,
    body: bool,
) -> PyResult<Expr> {
    let parameters = parameters.into_iter();
    let parameters =
        parameters.map(|(name, default, value, description)| Parameter {
            name,
            default,
            value,
            description,
            allowed: Allowed::default(),
            counts: false,
        });
    Ok(Expr {
        body,
        tree: tree(&steps)?,
        name,
        parameters: parameters.collect(),
        files: Vec::new(),
    })
}

/// A factor of a power: numbers stay numbers, which have cheaper powers.
fn operand(given: &Bound<'_, PyAny>) -> PyResult<Argument> {
    match crate::value::expr(given)? {
        Some(expr) => Ok(Argument::Field(expr.get().tree.clone())),
        None => crate::value::number(given).map(Argument::Number),
    }
}

fn power(base: Argument, exponent: Argument) -> PyResult<Expr> {
    match model::call("pow", vec![base, exponent]).map_err(plain)? {
        Argument::Field(tree) => Ok(tree.into()),
        _ => Err(PyTypeError::new_err("a power of numbers is no field")),
    }
}

/// Calls a function that scripts have: docs/shapes.md, docs/textures.md,
/// docs/functions.md and docs/data.md list them. It makes a field, or a number of numbers alone.
#[pyfunction]
#[pyo3(signature = (name, *given, **named))]
pub(crate) fn call<'py>(
    py: Python<'py>,
    name: &str,
    given: &Bound<'py, PyTuple>,
    named: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let made = model::call(name, arguments(given, named)?).map_err(plain)?;
    let is_body = |value: Bound<'py, PyAny>| {
        value.cast::<Expr>().is_ok_and(|expr| expr.get().body)
    };
    let body = model::makes_body(name, given.iter().all(is_body));
    Ok(match made {
        Argument::Field(tree) => {
            let named = given.iter().filter_map(|v| v.extract().ok());
            let files: Vec<PathBuf> = named.collect();
            if !files.is_empty() {
                keep(data_of(&tree), &files);
            }
            let made = Expr::from(tree).with_body(body);
            made.into_pyobject(py)?.into_any()
        }
        Argument::Whole(whole) => whole.into_pyobject(py)?.into_any(),
        Argument::Number(number) => number.into_pyobject(py)?.into_any(),
        _ => return Err(PyTypeError::new_err("this function makes no field")),
    })
}

/// Reads a model from a file, or from text of a kind.
#[pyfunction]
#[pyo3(signature = (kind, text, name, params = None))]
pub(crate) fn load(
    py: Python<'_>,
    kind: &str,
    text: &Bound<'_, PyAny>,
    name: &str,
    params: Option<&Bound<'_, PyDict>>,
) -> PyResult<Expr> {
    let source = crate::request::source(kind, text, name)?;
    let defines = parameters(params)?;
    let limits = Limits::of_slicing();
    let loaded = at_work(py, limits, None, move |_| {
        let mut loaded = loaded(&source, &defines)?;
        if let Source::File(path) = source {
            loaded.files.push(path);
        }
        Ok(loaded)
    });
    loaded.map(Expr::from)
}

/// Values of a field at places.
#[pyfunction]
pub(crate) fn evaluate(of: Field, places: Vec<[f64; 3]>) -> PyResult<Vec<f64>> {
    values(&of.0, &places)
}

fn values(tree: &Tree, places: &[[f64; 3]]) -> PyResult<Vec<f64>> {
    expand(tree).map_err(plain)?;
    let failed = |e: FieldError| PyValueError::new_err(e.to_string());
    let values = Values::new(tree, None).map_err(failed)?;
    let columns = [0, 1, 2].map(|axis| -> Vec<f32> {
        places.iter().map(|p| p[axis] as f32).collect()
    });
    let columns = columns.each_ref().map(|c| &c[..]);
    let mut found = Vec::new();
    values.at(&columns, &mut found).map_err(failed)?;
    Ok(found.into_iter().map(f64::from).collect())
}

/// Levels of a field's text. What lies deeper is left out.
const LEVELS: usize = 5;

/// Writes the beginning of a field as a formula.
fn write_tree(tree: &TreeOp, level: usize, text: &mut String) {
    if level > LEVELS {
        text.push('…');
        return;
    }
    match tree {
        TreeOp::Input(Var::X) => text.push('x'),
        TreeOp::Input(Var::Y) => text.push('y'),
        TreeOp::Input(Var::Z) => text.push('z'),
        TreeOp::Input(v) => match known_data(*v) {
            Some(data) => text.push_str(data.name()),
            None => text.push('?'),
        },
        TreeOp::Const(c) => {
            let _ = write!(text, "{c}");
        }
        TreeOp::Unary(op, a) => {
            let _ = write!(text, "{}(", name_of(op));
            write_tree(a, level + 1, text);
            text.push(')');
        }
        TreeOp::Binary(op, a, b) => {
            let _ = write!(text, "{}(", name_of(op));
            write_tree(a, level + 1, text);
            text.push_str(", ");
            write_tree(b, level + 1, text);
            text.push(')');
        }
        TreeOp::RemapAxes { target, x, y, z } => {
            text.push_str("remap(");
            for (i, part) in [target, x, y, z].into_iter().enumerate() {
                if i > 0 {
                    text.push_str(", ");
                }
                write_tree(part, level + 1, text);
            }
            text.push(')');
        }
        TreeOp::RemapAffine { target, .. } => {
            text.push_str("moved(");
            write_tree(target, level + 1, text);
            text.push(')');
        }
    }
}
