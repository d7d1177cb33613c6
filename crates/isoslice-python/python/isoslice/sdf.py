"""Models written for Michael Fogleman's `sdf`, sliced without a mesh.

    from isoslice.sdf import *

    f = sphere(1) & box(1.5)
    c = cylinder(0.5)
    f -= c.orient(X) | c.orient(Y) | c.orient(Z)
    f.save("out.gcode", size=40)

The names are those of https://github.com/fogleman/sdf, and so are the lengths,
which have no unit there and are millimetres here, and the angles, which are
radians. `save` takes the keywords of `isoslice.slice`. docs/python.md lists
what is different, and what is not there.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable, Sequence
from types import SimpleNamespace
from typing import Any, Optional

from . import _functions as fn
from . import _shapes as shapes
from ._functions import x, y, z
from ._native import Expr, Sliced
from ._slice import slice as _slice

pi = math.pi
degrees = math.degrees
radians = math.radians


class Vec(tuple):  # type: ignore[type-arg]
    """A point or a direction, with arithmetic."""

    def __new__(cls, *numbers: Any) -> Vec:
        return super().__new__(cls, numbers)

    def __add__(self, other: Any) -> Vec:
        return Vec(*(a + b for a, b in zip(self, _spread(other, len(self)))))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Vec:
        return Vec(*(a - b for a, b in zip(self, _spread(other, len(self)))))

    def __rsub__(self, other: Any) -> Vec:
        return _spread(other, len(self)) - self

    def __mul__(self, other: Any) -> Vec:
        return Vec(*(a * b for a, b in zip(self, _spread(other, len(self)))))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Vec:
        return Vec(*(a / b for a, b in zip(self, _spread(other, len(self)))))

    def __neg__(self) -> Vec:
        return Vec(*(-a for a in self))


ORIGIN = Vec(0, 0, 0)
X = Vec(1, 0, 0)
Y = Vec(0, 1, 0)
Z = Vec(0, 0, 1)
UP = Z


def _spread(given: Any, count: int) -> Vec:
    """A vector, or one number for all of its parts."""
    if isinstance(given, Iterable):
        numbers = Vec(*given)
        if len(numbers) != count:
            raise ValueError(f"{tuple(numbers)}: {count} numbers are wanted")
        return numbers
    return Vec(*[given] * count)


def _dot(a: Iterable[Any], b: Iterable[Any]) -> Any:
    # A factor of 0 would leave its field in the sum.
    parts = [
        p * q
        for p, q in zip(a, b)
        if not any(isinstance(v, (int, float)) and v == 0 for v in (p, q))
    ]
    return functools.reduce(lambda p, q: p + q, parts) if parts else 0


def _length(v: Iterable[Any]) -> Any:
    return fn.sqrt(functools.reduce(lambda p, q: p + q, map(fn.square, v)))


def _unit(v: Iterable[float]) -> Vec:
    numbers = [float(part) for part in v]
    length = math.sqrt(sum(part * part for part in numbers))
    if not (length > 0 and math.isfinite(length)):
        raise ValueError(f"{tuple(numbers)} has no direction")
    return Vec(*(part / length for part in numbers))


def _clip(f: Any, low: float, high: float) -> Any:
    return fn.min(fn.max(f, low), high)


def _corner(w: Sequence[Any]) -> Any:
    """Distance from a corner, from the distances of its sides."""
    outside = _length([fn.max(part, 0) for part in w])
    return outside + fn.min(fn.max(*w), 0)


def _soft_min(f: Any, g: Any, k: float) -> Any:
    """The lesser of two, filled out by a parabola where they differ by less
    than k. The lesser itself is in it, since intervals know its range."""
    near = fn.max(k - fn.abs(f - g), 0)
    return fn.min(f, g) - near * near / (4 * k)


class _Sdf:
    """A field with the operators of `sdf`."""

    _k: Optional[float] = None

    def __init__(self, expr: Any) -> None:
        if isinstance(expr, _Sdf):
            expr = expr.expr
        #: The field, as isoslice has it.
        self.expr: Expr = expr + 0 * x if isinstance(expr, (int, float)) else expr

    def __isoslice__(self) -> Expr:
        return self.expr

    def k(self, k: Optional[float] = None) -> Any:
        """The shape, to be put to others softly: a | b.k(0.25)."""
        soft = type(self)(self.expr)
        soft._k = k
        return soft

    def __or__(self, other: Any) -> Any:
        return self.union(other)

    def __and__(self, other: Any) -> Any:
        return self.intersection(other)

    def __sub__(self, other: Any) -> Any:
        return self.difference(other)

    def _fold(
        self,
        others: tuple[Any, ...],
        k: Optional[float],
        sharp: Callable[[Any, Any], Any],
        soft: Callable[[Any, Any, float], Any],
    ) -> Any:
        found = self.expr
        for other in others:
            radius = k or other._k
            if radius:
                found = soft(found, other.expr, radius)
            else:
                found = sharp(found, other.expr)
        return type(self)(found)

    def union(self, *others: Any, k: Optional[float] = None) -> Any:
        """This shape and others."""
        return self._fold(others, k, fn.min, _soft_min)

    def difference(self, *others: Any, k: Optional[float] = None) -> Any:
        """This shape without others."""
        return self._fold(
            others,
            k,
            lambda f, g: fn.max(f, -g),
            lambda f, g, k: -_soft_min(-f, g, k),
        )

    def intersection(self, *others: Any, k: Optional[float] = None) -> Any:
        """What this shape and others have in common."""
        return self._fold(
            others, k, fn.max, lambda f, g, k: -_soft_min(-f, -g, k)
        )

    def blend(self, *others: Any, k: float = 0.5) -> Any:
        """Between this shape and others: k of the other one."""

        def mean(f: Any, g: Any, k: float) -> Any:
            return k * g + (1 - k) * f

        found = self.expr
        for other in others:
            found = mean(found, other.expr, other._k or k)
        return type(self)(found)

    def negate(self) -> Any:
        """All outside of the shape."""
        return type(self)(-self.expr)

    def dilate(self, r: float) -> Any:
        """The shape grown by r."""
        return type(self)(self.expr - r)

    def erode(self, r: float) -> Any:
        """The shape shrunk by r."""
        return type(self)(self.expr + r)

    def shell(self, thickness: float) -> Any:
        """A shell about the surface, half of it inside."""
        return type(self)(fn.abs(self.expr) - thickness / 2)

    def _axes(self) -> Vec:
        return Vec(x, y, z)

    def _at(self, place: Iterable[Any]) -> Expr:
        """The field at another place for each place."""
        moved = list(place)
        moved += list(Vec(x, y, z)[len(moved) :])
        return self.expr.remap(*moved)

    def translate(self, offset: Iterable[float]) -> Any:
        """The shape elsewhere."""
        return type(self)(self._at(self._axes() - Vec(*offset)))

    def scale(self, factor: Any) -> Any:
        """The shape larger by a factor, or by one along each axis."""
        axes = self._axes()
        factors = _spread(factor, len(axes))
        return type(self)(self._at(axes / factors) * min(factors))

    def repeat(
        self, spacing: Any, count: Any = None, padding: Any = 0
    ) -> Any:
        """Copies of the shape: endless ones, or `count` on each side. `padding`
        is how many neighbours are looked at."""
        axes = self._axes()
        steps = _spread(spacing, len(axes))
        counts = _spread(count, len(axes))
        paddings = _spread(padding, len(axes))
        places: list[list[Any]] = [[]]
        for axis, step, most, near in zip(axes, steps, counts, paddings):
            if step == 0:
                index = None
            else:
                index = fn.round(axis / step)
                if most is not None:
                    index = _clip(index, -most, most)
            around = range(-near, near + 1) if index is not None else (0,)
            places = [
                place + [axis if index is None else axis - step * (index + n)]
                for place in places
                for n in around
            ]
        return type(self)(fn.min(*(self._at(place) for place in places)))

    def elongate(self, size: Any) -> Any:
        """The shape cut apart at the origin, and drawn out by size."""
        axes = self._axes()
        beyond = [fn.abs(a) - s for a, s in zip(axes, _spread(size, len(axes)))]
        inside = fn.min(fn.max(*beyond), 0)
        return type(self)(self._at(fn.max(b, 0) for b in beyond) + inside)

    def save(self, path: Any = "out.gcode", **keywords: Any) -> Sliced:
        """Slices the shape to a file; the keywords are those of
        isoslice.slice."""
        return _slice(self.expr, path, **keywords)

    def __repr__(self) -> str:
        return f"{type(self).__name__}{repr(self.expr)[4:]}"


class SDF3(_Sdf):
    """A body."""

    def rotate(self, angle: float, vector: Iterable[float] = Z) -> SDF3:
        """The shape turned about a vector, radians, counter-clockwise seen
        from its tip."""
        u = _unit(vector)
        # Places are turned back.
        c, s = _exact(math.cos(angle)), _exact(-math.sin(angle))
        p = Vec(x, y, z)
        rows = [
            [c * (i == j) + (1 - c) * u[i] * u[j] for j in range(3)]
            for i in range(3)
        ]
        for i, j, n in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            rows[i][j] -= s * u[n]
            rows[j][i] += s * u[n]
        rows = [[_exact(number) for number in row] for row in rows]
        return SDF3(self._at(_dot(row, p) for row in rows))

    def _turned(self, a: Iterable[float], b: Iterable[float]) -> SDF3:
        """The shape turned so that direction a becomes direction b."""
        a, b = _unit(a), _unit(b)
        cosine = sum(p * q for p, q in zip(a, b))
        if cosine > 1 - 1e-12:
            return self
        if cosine < -1 + 1e-12:
            # Any axis across will do.
            least = min(range(3), key=lambda i: math.fabs(a[i]))
            return self.rotate(pi, _cross(a, (X, Y, Z)[least]))
        return self.rotate(math.acos(cosine), _cross(a, b))

    def rotate_to(self, a: Iterable[float], b: Iterable[float]) -> SDF3:
        """The shape turned so that direction b becomes direction a, as `sdf`
        turns it."""
        return self._turned(b, a)

    def orient(self, axis: Iterable[float]) -> SDF3:
        """The shape turned so that this direction becomes up, as `sdf` turns
        it: a line along z then lies along the axis."""
        return self.rotate_to(UP, axis)

    def circular_array(self, count: int, offset: float = 0) -> SDF3:
        """Copies round z, moved along x before."""
        moved = self.translate(X * offset)
        step = 2 * pi / count
        r = _length([x, y])
        angle = fn.mod(fn.atan2(y, x), step)
        return SDF3(
            fn.min(
                *(
                    moved._at([fn.cos(a) * r, fn.sin(a) * r])
                    for a in (angle - step, angle)
                )
            )
        )

    def twist(self, k: float) -> SDF3:
        """The shape turned about z by k radians per height."""
        c, s = fn.cos(k * z), fn.sin(k * z)
        return SDF3(self._at([c * x - s * y, s * x + c * y]))

    def bend(self, k: float) -> SDF3:
        """The shape bent along x by k radians per length."""
        c, s = fn.cos(k * x), fn.sin(k * x)
        return SDF3(self._at([c * x - s * y, s * x + c * y]))

    def bend_linear(
        self,
        p0: Iterable[float],
        p1: Iterable[float],
        v: Iterable[float],
        e: Optional[Callable[[Any], Any]] = None,
    ) -> SDF3:
        """The shape moved by nothing at p0, up to v at p1."""
        t = (e or ease.linear)(_between(p0, p1))
        return SDF3(self._at(p - t * q for p, q in zip((x, y, z), v)))

    def bend_radial(
        self,
        r0: float,
        r1: float,
        dz: float,
        e: Optional[Callable[[Any], Any]] = None,
    ) -> SDF3:
        """The shape raised by nothing at radius r0, up to dz at r1."""
        t = _clip((_length([x, y]) - r0) / (r1 - r0), 0, 1)
        return SDF3(self._at([x, y, z - dz * (e or ease.linear)(t)]))

    def transition_linear(
        self,
        other: SDF3,
        p0: Iterable[float] = -Z,
        p1: Iterable[float] = Z,
        e: Optional[Callable[[Any], Any]] = None,
    ) -> SDF3:
        """From this shape at p0 to another at p1."""
        t = (e or ease.linear)(_between(p0, p1))
        return SDF3(t * other.expr + (1 - t) * self.expr)

    def transition_radial(
        self,
        other: SDF3,
        r0: float = 0,
        r1: float = 1,
        e: Optional[Callable[[Any], Any]] = None,
    ) -> SDF3:
        """From this shape at radius r0 to another at r1."""
        t = _clip((_length([x, y]) - r0) / (r1 - r0), 0, 1)
        t = (e or ease.linear)(t)
        return SDF3(t * other.expr + (1 - t) * self.expr)

    def slice(self) -> SDF2:
        """The shape's section at z = 0."""
        return SDF2(self.expr.remap(x, y, 0))


class SDF2(_Sdf):
    """A shape in the plane."""

    def _axes(self) -> Vec:
        return Vec(x, y)

    def rotate(self, angle: float) -> SDF2:
        """The shape turned, radians, clockwise, as `sdf` turns it."""
        c, s = _exact(math.cos(angle)), _exact(-math.sin(angle))
        return SDF2(self._at([c * x + s * y, c * y - s * x]))

    def circular_array(self, count: int) -> SDF2:
        """Copies round the origin."""
        return SDF2(SDF3(self.expr).circular_array(count).expr)

    def extrude(self, h: float) -> SDF3:
        """A body of the height h, half of it below z = 0."""
        return SDF3(_corner([self.expr, fn.abs(z) - h / 2]))

    def extrude_to(
        self,
        other: SDF2,
        h: float,
        e: Optional[Callable[[Any], Any]] = None,
    ) -> SDF3:
        """A body of the height h, from this shape below to another on top."""
        t = (e or ease.linear)(_clip(z / h, -0.5, 0.5) + 0.5)
        between = self.expr + (other.expr - self.expr) * t
        return SDF3(_corner([between, fn.abs(z) - h / 2]))

    def revolve(self, offset: float = 0) -> SDF3:
        """The shape turned about z, its x as the distance from z."""
        return SDF3(self._at([_length([x, y]) - offset, z, 0]))


def _exact(number: float) -> float:
    """A sine or cosine without the rounding of pi."""
    near = round(number * 2) / 2
    return near if math.fabs(number - near) < 1e-15 else number


def _cross(a: Vec, b: Vec) -> Vec:
    return Vec(
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def _between(p0: Iterable[float], p1: Iterable[float]) -> Any:
    """How far a place is on the way from p0 to p1, from 0 to 1."""
    start = Vec(*p0)
    way = Vec(*p1) - start
    square = sum(part * part for part in way)
    return _clip(_dot(Vec(x, y, z) - start, way) / square, 0, 1)


# Bodies.


def sphere(radius: float = 1, center: Iterable[float] = ORIGIN) -> SDF3:
    """Ball."""
    return SDF3(_length(Vec(x, y, z) - Vec(*center)) - radius)


def plane(
    normal: Iterable[float] = UP, point: Iterable[float] = ORIGIN
) -> SDF3:
    """All on that side of a plane to which its normal points."""
    n, at = _unit(normal), Vec(*point)
    return SDF3(_dot(n, at) - _dot(n, Vec(x, y, z)))


def slab(
    x0: Optional[float] = None,
    y0: Optional[float] = None,
    z0: Optional[float] = None,
    x1: Optional[float] = None,
    y1: Optional[float] = None,
    z1: Optional[float] = None,
    k: Optional[float] = None,
) -> SDF3:
    """All between some planes across the axes."""
    sides = [
        plane(axis * side, axis * at)
        for side, ends in ((1, (x0, y0, z0)), (-1, (x1, y1, z1)))
        for axis, at in zip((X, Y, Z), ends)
        if at is not None
    ]
    if not sides:
        raise ValueError("a slab has a side at least, as in slab(z0=0)")
    return sides[0].intersection(*sides[1:], k=k)


def box(
    size: Any = 1,
    center: Iterable[float] = ORIGIN,
    a: Optional[Iterable[float]] = None,
    b: Optional[Iterable[float]] = None,
) -> SDF3:
    """Block, by its size and centre, or by two corners."""
    if a is not None and b is not None:
        low, high = Vec(*a), Vec(*b)
        size, center = high - low, (low + high) / 2
    p = Vec(x, y, z) - Vec(*center)
    half = _spread(size, 3) / 2
    return SDF3(_corner([fn.abs(q) - h for q, h in zip(p, half)]))


def rounded_box(size: Any, radius: float) -> SDF3:
    """Block with round edges."""
    return box(_spread(size, 3) - 2 * radius).dilate(radius)


def wireframe_box(size: Any, thickness: float) -> SDF3:
    """The twelve edges of a block, of square wire about its surface."""
    t = thickness / 2
    half = _spread(size, 3) / 2
    p = [fn.abs(q) - h - t for q, h in zip((x, y, z), half)]
    q = [fn.abs(v + t) - t for v in p]
    return SDF3(
        fn.min(
            *(
                _corner([p[j] if j == i else q[j] for j in range(3)])
                for i in range(3)
            )
        )
    )


def torus(r1: float, r2: float) -> SDF3:
    """Ring about z: radius of its middle line, and of its tube."""
    return SDF3(_length([_length([x, y]) - r1, z]) - r2)


def capsule(a: Iterable[float], b: Iterable[float], radius: float) -> SDF3:
    """Line with round ends."""
    start, end = Vec(*a), Vec(*b)
    t = _between(start, end)
    along = Vec(*(t * part for part in end - start))
    return SDF3(_length(Vec(x, y, z) - start - along) - radius)


def cylinder(radius: float) -> SDF3:
    """Endless cylinder about z."""
    return SDF3(_length([x, y]) - radius)


def _along(body: Expr, a: Iterable[float], b: Iterable[float]) -> SDF3:
    """A body about z, put on the way from a to b."""
    start, end = Vec(*a), Vec(*b)
    turned = SDF3(body)._turned(UP, end - start)
    return turned.translate((start + end) / 2)


def _distance(a: Iterable[float], b: Iterable[float]) -> float:
    return math.dist(tuple(a), tuple(b))


def capped_cylinder(
    a: Iterable[float], b: Iterable[float], radius: float
) -> SDF3:
    """Cylinder from a to b."""
    a, b = tuple(a), tuple(b)
    return _along(shapes.cylinder(radius, _distance(a, b)), a, b)


def rounded_cylinder(ra: float, rb: float, h: float) -> SDF3:
    """Cylinder about z with round rims of the radius rb."""
    d = [_length([x, y]) - ra + rb, fn.abs(z) - h / 2 + rb]
    return SDF3(_corner(d) - rb)


def capped_cone(
    a: Iterable[float], b: Iterable[float], ra: float, rb: float
) -> SDF3:
    """Cone from a to b, with a radius at each."""
    a, b = tuple(a), tuple(b)
    if ra < rb:
        a, b, ra, rb = b, a, rb, ra
    return _along(shapes.cone(ra, _distance(a, b), rb), a, b)


def rounded_cone(r1: float, r2: float, h: float) -> SDF3:
    """The hull of a ball at the origin and another at height h."""
    slope = (r1 - r2) / h
    if math.fabs(slope) >= 1:
        raise ValueError("one ball lies in the other: h is to be more")
    r = _length([x, y])
    # The place on the axis whose ball is nearest.
    s = _clip(z - r * (slope / math.sqrt(1 - slope * slope)), 0, h)
    return SDF3(_length([r, z - s]) - (r1 - slope * s))


def ellipsoid(size: Iterable[float]) -> SDF3:
    """Ellipsoid, by half its axes."""
    return SDF3(shapes.ellipsoid(tuple(size)))


def pyramid(h: float) -> SDF3:
    """Pyramid of the height h on a square of 1, whose foot is at z = 0."""
    n = math.hypot(h, 0.5)
    sides = [(h * fn.abs(a) + 0.5 * z - 0.5 * h) / n for a in (x, y)]
    return SDF3(fn.max(*sides, -z))


def tetrahedron(r: float) -> SDF3:
    """Tetrahedron."""
    least = fn.max(fn.abs(x + y) - z, fn.abs(x - y) + z)
    return SDF3((least - r) / math.sqrt(3))


def octahedron(r: float) -> SDF3:
    """Octahedron, with corners at r."""
    total = fn.abs(x) + fn.abs(y) + fn.abs(z)
    return SDF3((total - r) / math.sqrt(3))


_GOLDEN = (1 + math.sqrt(5)) / 2
_INRADIUS = _GOLDEN / math.hypot(_GOLDEN, 1)


def _faces(normal: Vec) -> Any:
    """The greatest distance along the turns of a normal."""
    p = [fn.abs(v) for v in (x, y, z)]
    a, b, c = _unit(normal)
    return fn.max(*(_dot(n, p) for n in ((a, b, c), (c, a, b), (b, c, a))))


def dodecahedron(r: float) -> SDF3:
    """Dodecahedron; 0.851 r is the radius of the ball in it."""
    return SDF3(_faces(Vec(_GOLDEN, 1, 0)) - _INRADIUS * r)


def icosahedron(r: float) -> SDF3:
    """Icosahedron, with corners at r."""
    r = r * _INRADIUS
    normal = Vec((math.sqrt(5) + 3) / 2, 1, 0)
    corner = (fn.abs(x) + fn.abs(y) + fn.abs(z)) / math.sqrt(3)
    inside = _unit(normal)[0] * r
    return SDF3(fn.max(_faces(normal), corner) - inside)


# In the plane.


def circle(radius: float = 1, center: Iterable[float] = (0, 0)) -> SDF2:
    """Disc."""
    return SDF2(_length(Vec(x, y) - Vec(*center)) - radius)


def line(
    normal: Iterable[float] = (0, 1), point: Iterable[float] = (0, 0)
) -> SDF2:
    """All on that side of a line to which its normal points."""
    n, at = _unit(normal), Vec(*point)
    return SDF2(_dot(n, at) - _dot(n, Vec(x, y)))


def rectangle(
    size: Any = 1,
    center: Iterable[float] = (0, 0),
    a: Optional[Iterable[float]] = None,
    b: Optional[Iterable[float]] = None,
) -> SDF2:
    """Rectangle, by its size and centre, or by two corners."""
    if a is not None and b is not None:
        low, high = Vec(*a), Vec(*b)
        size, center = high - low, (low + high) / 2
    p = Vec(x, y) - Vec(*center)
    half = _spread(size, 2) / 2
    return SDF2(_corner([fn.abs(q) - h for q, h in zip(p, half)]))


def rounded_rectangle(
    size: Any, radius: float, center: Iterable[float] = (0, 0)
) -> SDF2:
    """Rectangle with round corners of one radius."""
    return rectangle(_spread(size, 2) - 2 * radius, center).dilate(radius)


def equilateral_triangle() -> SDF2:
    """Triangle with sides of 2 about the origin, a corner up."""
    low = -1 / math.sqrt(3)
    return SDF2(shapes.polygon([(-1, low), (1, low), (0, -2 * low)]))


def hexagon(r: float) -> SDF2:
    """Regular hexagon with corners at r, one of them towards x."""
    corners = [
        (r * math.cos(i * pi / 3), r * math.sin(i * pi / 3)) for i in range(6)
    ]
    return SDF2(shapes.polygon(corners))


def rounded_x(w: float, r: float) -> SDF2:
    """An X: two lines between the corners of a square of the side w, with a
    radius of r."""
    p, q = fn.abs(x), fn.abs(y)
    at = fn.min(p + q, w) * 0.5
    return SDF2(_length([p - at, q - at]) - r)


def polygon(points: Iterable[Iterable[float]]) -> SDF2:
    """Any outline that does not cross itself."""
    return SDF2(shapes.polygon([tuple(point) for point in points]))


# Functions of one's own.


def _own(kind: type, count: int) -> Callable[..., Any]:
    def decorator(function: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(function)
        def made(*args: Any, **kwargs: Any) -> Any:
            import numpy

            of_places = function(*args, **kwargs)
            places = numpy.empty((1, count), dtype=object)
            places[0] = [x, y, z][:count]
            found = of_places(places)
            return kind(numpy.ravel(found)[0])

        return made

    return decorator


def sdf3(function: Callable[..., Any]) -> Callable[..., SDF3]:
    """Makes a shape of a function that returns f(p). p is an array with one
    row of three fields, so only arithmetic and numpy's functions of elements
    work on it. It needs numpy."""
    return _own(SDF3, 3)(function)


def sdf2(function: Callable[..., Any]) -> Callable[..., SDF2]:
    """As sdf3, in the plane: p has two fields."""
    return _own(SDF2, 2)(function)


# The operations as functions of their shape, as in union(a, b).


def union(a: Any, *bs: Any, k: Optional[float] = None) -> Any:
    """Shapes together."""
    return a.union(*bs, k=k)


def difference(a: Any, *bs: Any, k: Optional[float] = None) -> Any:
    """A shape without others."""
    return a.difference(*bs, k=k)


def intersection(a: Any, *bs: Any, k: Optional[float] = None) -> Any:
    """What shapes have in common."""
    return a.intersection(*bs, k=k)


def blend(a: Any, *bs: Any, k: float = 0.5) -> Any:
    """Between shapes."""
    return a.blend(*bs, k=k)


# How t goes from 0 to 1.


def _eases() -> SimpleNamespace:
    def smooth(rise: Callable[[Any], Any]) -> dict[str, Any]:
        def fall(t: Any) -> Any:
            return 1 - rise(1 - t)

        def both(t: Any) -> Any:
            first = rise(_clip(2 * t, 0, 1))
            return (first + fall(_clip(2 * t - 1, 0, 1))) / 2

        return {"in": rise, "out": fall, "in_out": both}

    found: dict[str, Any] = {"linear": lambda t: t}
    for name, rise in {
        "quad": lambda t: t * t,
        "cubic": lambda t: t * t * t,
        "quart": lambda t: (t * t) * (t * t),
        "quint": lambda t: (t * t) * (t * t) * t,
        "sine": lambda t: 1 - fn.cos(t * (pi / 2)),
        "circ": lambda t: 1 - fn.sqrt(fn.max(1 - t * t, 0)),
    }.items():
        for way, function in smooth(rise).items():
            found[f"{way}_{name}"] = function
    return SimpleNamespace(**found)


ease = _eases()

_MISSING = {
    "text": "letters are drawn by fonts, which isoslice does not read",
    "image": "isoslice does not read pictures",
    "measure_text": "isoslice does not read fonts",
    "measure_image": "isoslice does not read pictures",
    "generate": "it makes triangles, which isoslice does without",
    "write_binary_stl": "it writes triangles, which isoslice does without",
    "show_slice": "outlines(f, z) has a layer, and save(…) a preview",
    "sample_slice": "outlines(f, z) has a layer's outline",
    "wrap_around": "only texts and pictures need it",
}


def __getattr__(name: str) -> Any:
    why = _MISSING.get(name, "docs/python.md lists what there is")
    raise AttributeError(f"isoslice.sdf has no {name}: {why}")


__all__ = [
    name
    for name, value in list(globals().items())
    if not name.startswith("_")
    and (
        getattr(value, "__module__", None) == __name__
        or name in ("X", "Y", "Z", "UP", "ORIGIN")
        or name in ("pi", "degrees", "radians", "ease")
    )
]
