"""The coordinates, constants, and functions of fields and numbers.

Every function is the script's function of that name, so each name means the
same in scripts, formulas and Python: docs/functions.md. Functions of numbers
alone are numbers. numpy's functions work on fields, too: numpy.sqrt(x) is
isoslice.sqrt(x).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar, Union

from ._native import Expr, call, load

Field = Union[Expr, int, float]
#: A number makes a number, and a field a field.
F = TypeVar("F", float, Expr)

x: Expr = load("formula", "x", "formula")
y: Expr = load("formula", "y", "formula")
z: Expr = load("formula", "z", "formula")

pi = PI = math.pi
tau = TAU = math.tau
e = E = math.e


def sqrt(f: F) -> F:
    """Square root; NaN, which counts as outside, below 0."""
    return call("sqrt", f)  # type: ignore[no-any-return]


def cbrt(f: F) -> F:
    """Cube root."""
    return call("cbrt", f)  # type: ignore[no-any-return]


def square(f: F) -> F:
    """f times f."""
    return call("square", f)  # type: ignore[no-any-return]


def exp(f: F) -> F:
    """e to the power of f."""
    return call("exp", f)  # type: ignore[no-any-return]


def exp2(f: F) -> F:
    """2 to the power of f."""
    return call("exp2", f)  # type: ignore[no-any-return]


def ln(f: F) -> F:
    """Natural logarithm."""
    return call("ln", f)  # type: ignore[no-any-return]


def log(f: F) -> F:
    """Natural logarithm."""
    return call("log", f)  # type: ignore[no-any-return]


def log2(f: F) -> F:
    """Logarithm to the base 2."""
    return call("log2", f)  # type: ignore[no-any-return]


def log10(f: F) -> F:
    """Logarithm to the base 10."""
    return call("log10", f)  # type: ignore[no-any-return]


def sin(f: F) -> F:
    """Sine of an angle in radians."""
    return call("sin", f)  # type: ignore[no-any-return]


def cos(f: F) -> F:
    """Cosine of an angle in radians."""
    return call("cos", f)  # type: ignore[no-any-return]


def tan(f: F) -> F:
    """Tangent of an angle in radians."""
    return call("tan", f)  # type: ignore[no-any-return]


def asin(f: F) -> F:
    """Angle in radians whose sine this is."""
    return call("asin", f)  # type: ignore[no-any-return]


def acos(f: F) -> F:
    """Angle in radians whose cosine this is."""
    return call("acos", f)  # type: ignore[no-any-return]


def atan(f: F) -> F:
    """Angle in radians whose tangent this is."""
    return call("atan", f)  # type: ignore[no-any-return]


def sinh(f: F) -> F:
    """Hyperbolic sine."""
    return call("sinh", f)  # type: ignore[no-any-return]


def cosh(f: F) -> F:
    """Hyperbolic cosine."""
    return call("cosh", f)  # type: ignore[no-any-return]


def tanh(f: F) -> F:
    """Hyperbolic tangent."""
    return call("tanh", f)  # type: ignore[no-any-return]


def degrees(f: F) -> F:
    """An angle in degrees, of one in radians."""
    return call("degrees", f)  # type: ignore[no-any-return]


def radians(f: F) -> F:
    """An angle in radians, of one in degrees."""
    return call("radians", f)  # type: ignore[no-any-return]


def abs(f: F) -> F:
    """Absolute value."""
    return call("abs", f)  # type: ignore[no-any-return]


def sign(f: F) -> F:
    """-1, 0 or 1."""
    return call("sign", f)  # type: ignore[no-any-return]


def floor(f: F) -> F:
    """The greatest whole number that is not above f."""
    return call("floor", f)  # type: ignore[no-any-return]


def ceil(f: F) -> F:
    """The least whole number that is not below f."""
    return call("ceil", f)  # type: ignore[no-any-return]


def round(f: F) -> F:
    """The nearest whole number. Halves go away from 0."""
    return call("round", f)  # type: ignore[no-any-return]


def trunc(f: F) -> F:
    """The nearest whole number towards 0."""
    return call("trunc", f)  # type: ignore[no-any-return]


def fract(f: F) -> F:
    """f less the greatest whole number that is not above it."""
    return call("fract", f)  # type: ignore[no-any-return]


def recip(f: F) -> F:
    """1 / f."""
    return call("recip", f)  # type: ignore[no-any-return]


def neg(f: F) -> F:
    """-f."""
    return call("neg", f)  # type: ignore[no-any-return]


def rand(f: F) -> F:
    """A number from 0 to 1 that looks like chance, and depends on f only."""
    return call("rand", f)  # type: ignore[no-any-return]


def logical_not(f: F) -> F:
    """1 where f is 0, else 0."""
    return call("logical_not", f)  # type: ignore[no-any-return]


def pow(f: Field, g: Field) -> Any:
    """f to the power of g."""
    return call("pow", f, g)


def atan2(f: Field, g: Field) -> Any:
    """Angle in radians of the point (g, f), from -pi to pi."""
    return call("atan2", f, g)


def mod(f: Field, g: Field) -> Any:
    """The remainder of f / g, which is not negative."""
    return call("mod", f, g)


def compare(f: Field, g: Field) -> Any:
    """-1 where f < g, 0 where they are equal, 1 where f > g."""
    return call("compare", f, g)


def logical_and(f: Field, g: Field) -> Any:
    """0 where f is 0, else g."""
    return call("logical_and", f, g)


def logical_or(f: Field, g: Field) -> Any:
    """g where f is 0, else f."""
    return call("logical_or", f, g)


def hash(f: Field, g: Field) -> Any:
    """Mixes two values into one, for rand."""
    return call("hash", f, g)


def clamp(f: Field, lowest: Field, highest: Field) -> Any:
    """f, but not below the lowest and not above the highest value."""
    return call("clamp", f, lowest, highest)


def mix(f: Field, g: Field, t: Field) -> Any:
    """f where t is 0, g where t is 1, and in proportion between."""
    return call("mix", f, g, t)


def step(edge: Field, f: Field) -> Any:
    """0 where f is below the edge, else 1."""
    return call("step", edge, f)


def smoothstep(lowest: Field, highest: Field, f: Field) -> Any:
    """0 below the lowest, 1 above the highest value of f, and without a kink
    between."""
    return call("smoothstep", lowest, highest, f)


def min(first: Field, *others: Field) -> Any:
    """The least of fields and numbers: the union of parts."""
    return _folded("min", (first, *others))


def max(first: Field, *others: Field) -> Any:
    """The greatest of fields and numbers: what parts have in common."""
    return _folded("max", (first, *others))


def length(first: Field, *others: Field) -> Any:
    """Root of the sum of the squares."""
    return call("length", first, *others)


hypot = length


def _folded(name: str, values: tuple[Field, ...]) -> Any:
    """A function of any number of values, some at a time."""
    while len(values) > 8:
        values = (call(name, *values[:8]), *values[8:])
    return call(name, *values)


# numpy's names for these functions. It looks them up on the elements of arrays
# of objects, and asks __array_ufunc__ about everything else.
_UFUNCS: dict[str, Callable[..., Any]] = {
    "negative": neg,
    "positive": lambda f: f,
    "absolute": abs,
    "fabs": abs,
    "sqrt": sqrt,
    "cbrt": cbrt,
    "square": square,
    "reciprocal": recip,
    "sin": sin,
    "cos": cos,
    "tan": tan,
    "arcsin": asin,
    "arccos": acos,
    "arctan": atan,
    "sinh": sinh,
    "cosh": cosh,
    "tanh": tanh,
    "exp": exp,
    "exp2": exp2,
    "log": log,
    "log2": log2,
    "log10": log10,
    "floor": floor,
    "ceil": ceil,
    "rint": round,
    "sign": sign,
    "degrees": degrees,
    "rad2deg": degrees,
    "radians": radians,
    "deg2rad": radians,
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
    "hypot": hypot,
    "trunc": trunc,
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
