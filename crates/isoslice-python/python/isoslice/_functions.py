"""The coordinates, and functions of fields and numbers.

Functions of numbers alone are numbers. numpy's functions work on fields, too:
numpy.sqrt(x) is isoslice.sqrt(x).
"""

from __future__ import annotations

import math
from functools import reduce
from numbers import Real
from typing import Any, Callable, Union

from ._native import Expr, binary, load, unary

Field = Union[Expr, int, float]

x: Expr = load("formula", "x", "x")
y: Expr = load("formula", "y", "y")
z: Expr = load("formula", "z", "z")


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def sqrt(f: Field) -> Any:
    """Square root; a field is NaN, which counts as outside, below 0."""
    return math.sqrt(f) if _is_number(f) else unary("sqrt", f)


def sin(f: Field) -> Any:
    """Sine of an angle in radians."""
    return math.sin(f) if _is_number(f) else unary("sin", f)


def cos(f: Field) -> Any:
    """Cosine of an angle in radians."""
    return math.cos(f) if _is_number(f) else unary("cos", f)


def tan(f: Field) -> Any:
    """Tangent of an angle in radians."""
    return math.tan(f) if _is_number(f) else unary("tan", f)


def asin(f: Field) -> Any:
    """Angle in radians whose sine this is."""
    return math.asin(f) if _is_number(f) else unary("asin", f)


def acos(f: Field) -> Any:
    """Angle in radians whose cosine this is."""
    return math.acos(f) if _is_number(f) else unary("acos", f)


def atan(f: Field) -> Any:
    """Angle in radians whose tangent this is."""
    return math.atan(f) if _is_number(f) else unary("atan", f)


def atan2(f: Field, g: Field) -> Any:
    """Angle in radians of the point (g, f), from -pi to pi."""
    if _is_number(f) and _is_number(g):
        return math.atan2(f, g)
    return binary("atan2", f, g)


def exp(f: Field) -> Any:
    """e to the power of f."""
    return math.exp(f) if _is_number(f) else unary("exp", f)


def log(f: Field) -> Any:
    """Natural logarithm."""
    return math.log(f) if _is_number(f) else unary("log", f)


def abs(f: Field) -> Any:
    """Absolute value."""
    return math.fabs(f) if _is_number(f) else unary("abs", f)


def square(f: Field) -> Any:
    """f times f."""
    return f * f if _is_number(f) else unary("square", f)


def recip(f: Field) -> Any:
    """1 / f."""
    return 1 / f if _is_number(f) else unary("recip", f)


def floor(f: Field) -> Any:
    """The greatest whole number that is not above f."""
    return math.floor(f) if _is_number(f) else unary("floor", f)


def ceil(f: Field) -> Any:
    """The least whole number that is not below f."""
    return math.ceil(f) if _is_number(f) else unary("ceil", f)


def round(f: Field) -> Any:
    """The nearest whole number. Halves of a field go away from 0."""
    if _is_number(f):
        return math.copysign(math.floor(math.fabs(f) + 0.5), f)
    return unary("round", f)


def sign(f: Field) -> Any:
    """-1, 0 or 1."""
    return (f > 0) - (f < 0) if _is_number(f) else unary("sign", f)


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


Expr.__array_ufunc__ = _array_ufunc  # type: ignore[method-assign]
for _name in (
    "sqrt square sin cos tan arcsin arccos arctan sinh cosh tanh exp exp2 log "
    "log2 log10 floor ceil rint sign degrees radians deg2rad rad2deg"
).split():
    setattr(Expr, _name, _UFUNCS[_name])
Expr.conjugate = lambda self: self  # type: ignore[attr-defined]
