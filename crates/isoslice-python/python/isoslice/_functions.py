"""The coordinates, and functions of fields and numbers.

Functions of numbers alone are numbers. numpy's functions work on fields, too:
numpy.sqrt(x) is isoslice.sqrt(x).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce
from numbers import Real
from typing import Any, TypeGuard, TypeVar, Union

from ._native import Expr, binary, load, unary

Field = Union[Expr, int, float]
#: A number makes a number, and a field a field.
F = TypeVar("F", float, Expr)

x: Expr = load("formula", "x", "formula")
y: Expr = load("formula", "y", "formula")
z: Expr = load("formula", "z", "formula")


def _is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, Real) and not isinstance(value, bool)


def _one(of_number: Callable[[float], float], name: str, f: F) -> F:
    """A function of a number, or the function of a field with that name."""
    if _is_number(f):
        return of_number(f)  # type: ignore[return-value]
    return unary(name, f)  # type: ignore[return-value]


def sqrt(f: F) -> F:
    """Square root; a field is NaN, which counts as outside, below 0."""
    return _one(math.sqrt, "sqrt", f)


def sin(f: F) -> F:
    """Sine of an angle in radians."""
    return _one(math.sin, "sin", f)


def cos(f: F) -> F:
    """Cosine of an angle in radians."""
    return _one(math.cos, "cos", f)


def tan(f: F) -> F:
    """Tangent of an angle in radians."""
    return _one(math.tan, "tan", f)


def asin(f: F) -> F:
    """Angle in radians whose sine this is."""
    return _one(math.asin, "asin", f)


def acos(f: F) -> F:
    """Angle in radians whose cosine this is."""
    return _one(math.acos, "acos", f)


def atan(f: F) -> F:
    """Angle in radians whose tangent this is."""
    return _one(math.atan, "atan", f)


def atan2(f: Field, g: Field) -> Any:
    """Angle in radians of the point (g, f), from -pi to pi."""
    if _is_number(f) and _is_number(g):
        return math.atan2(f, g)
    return binary("atan2", f, g)


def exp(f: F) -> F:
    """e to the power of f."""
    return _one(math.exp, "exp", f)


def log(f: F) -> F:
    """Natural logarithm."""
    return _one(math.log, "log", f)


def abs(f: F) -> F:
    """Absolute value."""
    return _one(math.fabs, "abs", f)


def square(f: F) -> F:
    """f times f."""
    return _one(lambda v: v * v, "square", f)


def recip(f: F) -> F:
    """1 / f."""
    return _one(lambda v: 1 / v, "recip", f)


def floor(f: F) -> F:
    """The greatest whole number that is not above f."""
    return _one(math.floor, "floor", f)


def ceil(f: F) -> F:
    """The least whole number that is not below f."""
    return _one(math.ceil, "ceil", f)


def round(f: F) -> F:
    """The nearest whole number. Halves go away from 0."""

    def of_number(v: float) -> float:
        return math.copysign(math.floor(math.fabs(v) + 0.5), v)

    return _one(of_number, "round", f)


def sign(f: F) -> F:
    """-1, 0 or 1."""
    return _one(lambda v: (v > 0) - (v < 0), "sign", f)


def rand(f: Field) -> Expr:
    """A number from 0 to 1 that looks like chance, and depends on f only."""
    return unary("rand", f)


def compare(f: Field, g: Field) -> Any:
    """-1 where f < g, 0 where they are equal, 1 where f > g."""
    if _is_number(f) and _is_number(g):
        return (f > g) - (f < g)
    return binary("compare", f, g)


def mod(f: Field, g: Field) -> Any:
    """The remainder of f / g, which is not negative."""
    if _is_number(f) and _is_number(g):
        return f - math.fabs(g) * math.floor(f / math.fabs(g))
    return binary("mod", f, g)


def logical_and(f: Field, g: Field) -> Expr:
    """0 where f is 0, else g."""
    return binary("and", f, g)


def logical_or(f: Field, g: Field) -> Expr:
    """g where f is 0, else f."""
    return binary("or", f, g)


def logical_not(f: Field) -> Expr:
    """1 where f is 0, else 0."""
    return unary("not", f)


def min(first: Field, *others: Field) -> Any:
    """The least of fields and numbers: the union of parts."""
    return reduce(_lesser, others, first)


def max(first: Field, *others: Field) -> Any:
    """The greatest of fields and numbers: what parts have in common."""
    return reduce(_greater, others, first)


def _lesser(f: Field, g: Field) -> Any:
    if _is_number(f) and _is_number(g):
        return f if f <= g else g
    return binary("min", f, g)


def _greater(f: Field, g: Field) -> Any:
    if _is_number(f) and _is_number(g):
        return f if f >= g else g
    return binary("max", f, g)


# numpy's names for these functions. It looks them up on the elements of arrays
# of objects, and asks __array_ufunc__ about everything else.
_UFUNCS: dict[str, Callable[..., Any]] = {
    "negative": lambda f: -f,
    "positive": lambda f: f,
    "absolute": abs,
    "fabs": abs,
    "sqrt": sqrt,
    "cbrt": lambda f: sign(f) * exp(log(abs(f)) / 3),
    "square": square,
    "reciprocal": recip,
    "sin": sin,
    "cos": cos,
    "tan": tan,
    "arcsin": asin,
    "arccos": acos,
    "arctan": atan,
    "sinh": lambda f: (exp(f) - exp(-f)) / 2,
    "cosh": lambda f: (exp(f) + exp(-f)) / 2,
    "tanh": lambda f: 1 - 2 / (exp(2 * f) + 1),
    "exp": exp,
    "exp2": lambda f: exp(f * math.log(2)),
    "log": log,
    "log2": lambda f: log(f) / math.log(2),
    "log10": lambda f: log(f) / math.log(10),
    "floor": floor,
    "ceil": ceil,
    "rint": round,
    "sign": sign,
    "degrees": lambda f: f * (180 / math.pi),
    "rad2deg": lambda f: f * (180 / math.pi),
    "radians": lambda f: f * (math.pi / 180),
    "deg2rad": lambda f: f * (math.pi / 180),
    "logical_not": logical_not,
    "add": lambda f, g: f + g,
    "subtract": lambda f, g: f - g,
    "multiply": lambda f, g: f * g,
    "divide": lambda f, g: f / g,
    "true_divide": lambda f, g: f / g,
    "floor_divide": lambda f, g: f // g,
    "remainder": lambda f, g: f % g,
    "power": lambda f, g: f**g,
    "float_power": lambda f, g: f**g,
    "minimum": min,
    "maximum": max,
    "fmin": min,
    "fmax": max,
    "arctan2": atan2,
    "hypot": lambda f, g: sqrt(square(f) + square(g)),
    "logical_and": logical_and,
    "logical_or": logical_or,
    "bitwise_and": max,
    "bitwise_or": min,
    "invert": lambda f: -f,
}


def _array_ufunc(
    self: Expr, ufunc: Any, method: str, *inputs: Any, **options: Any
) -> Any:
    """numpy's functions on fields and numbers."""
    function = _UFUNCS.get(ufunc.__name__)
    if function is None or method != "__call__" or options:
        return NotImplemented
    values = []
    for given in inputs:
        if getattr(given, "ndim", 0) != 0:
            return _of_arrays(ufunc, inputs)
        # numpy's numbers would ask this function again.
        values.append(given.item() if hasattr(given, "item") else given)
    return function(*values)


def _of_arrays(ufunc: Any, inputs: tuple[Any, ...]) -> Any:
    """An array of fields, element by element."""
    import numpy

    def as_array(given: Any) -> Any:
        if isinstance(given, Expr):
            array = numpy.empty((), dtype=object)
            array[()] = given
            return array
        return numpy.asarray(given, dtype=object)

    arrays = numpy.broadcast_arrays(*map(as_array, inputs))
    function = _UFUNCS[ufunc.__name__]
    found = numpy.empty(arrays[0].shape, dtype=object)
    for at in numpy.ndindex(found.shape):
        found[at] = function(*(array[at] for array in arrays))
    return found


def _conjugate(f: Expr) -> Expr:
    """The field: it has no imaginary part."""
    return f


def _method(name: str, function: Callable[..., Any]) -> Callable[[Expr], Any]:
    """A method that numpy looks up by the name of its own function."""

    def method(self: Expr) -> Any:
        return function(self)

    method.__name__ = name
    method.__qualname__ = f"Expr.{name}"
    method.__doc__ = f"What numpy.{name} makes of the field."
    return method


Expr.__array_ufunc__ = _array_ufunc  # type: ignore[method-assign]
Expr.conjugate = _conjugate  # type: ignore[method-assign, assignment]
for _name in (
    "sqrt square sin cos tan arcsin arccos arctan sinh cosh tanh exp exp2 log "
    "log2 log10 floor ceil rint sign degrees radians deg2rad rad2deg"
).split():
    setattr(Expr, _name, _method(_name, _UFUNCS[_name]))
