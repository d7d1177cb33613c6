"""The shapes that scripts have, with their names and their messages.

Every function calls the script's function of that name, so both make the same
field. Lengths are mm, angles degrees. Bodies stand along z, with their centre
in the middle of their height. docs/shapes.md says which ones are distances.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ._geo import polygons_of
from ._native import Expr, call

Point = Sequence[float]
_ORIGIN = (0, 0, 0)


# Bodies.


def sphere(radius: float, center: Point = _ORIGIN) -> Expr:
    """Ball."""
    return call("sphere", radius=radius, center=center)


def box(lower: Point, upper: Point) -> Expr:
    """Block between two corners."""
    return call("box", lower=lower, upper=upper)


def rounded_box(lower: Point, upper: Point, edge: float) -> Expr:
    """Block with round edges of the radius `edge`; 0 has sharp ones."""
    return call("rounded_box", lower=lower, upper=upper, edge=edge)


def cylinder(radius: float, height: float, center: Point = _ORIGIN) -> Expr:
    """Cylinder along z."""
    return call("cylinder", radius=radius, height=height, center=center)


def rounded_cylinder(
    radius: float, height: float, edge: float, center: Point = _ORIGIN
) -> Expr:
    """Cylinder with round rims of the radius `edge`."""
    return call(
        "rounded_cylinder",
        radius=radius,
        height=height,
        edge=edge,
        center=center,
    )


def tube(
    radius: float, inner: float, height: float, center: Point = _ORIGIN
) -> Expr:
    """Cylinder with a bore of the radius `inner`."""
    return call(
        "tube", radius=radius, inner=inner, height=height, center=center
    )


def cone(
    radius: float, height: float, top: float = 0, center: Point = _ORIGIN
) -> Expr:
    """Cone with the radius `radius` below and `top` at its top."""
    return call("cone", radius=radius, height=height, top=top, center=center)


def torus(radius: float, tube: float, center: Point = _ORIGIN) -> Expr:
    """Ring about z: radius of its middle line, and of its tube."""
    return call("torus", radius=radius, tube=tube, center=center)


def capsule(start: Point, end: Point, radius: float) -> Expr:
    """Line from start to end, with round ends."""
    return call("capsule", start=start, end=end, radius=radius)


def prism(
    sides: int, radius: float, height: float, center: Point = _ORIGIN
) -> Expr:
    """Regular prism with a corner towards x; radius to its corners."""
    return call(
        "prism", sides=sides, radius=radius, height=height, center=center
    )


def wedge(lower: Point, upper: Point) -> Expr:
    """Half a block: high where x is least."""
    return call("wedge", lower=lower, upper=upper)


def half_space(normal: Point, offset: float = 0) -> Expr:
    """All below a plane, `offset` from the origin along its normal."""
    return call("half_space", normal=normal, offset=offset)


def ellipsoid(radii: Point, center: Point = _ORIGIN) -> Expr:
    """Ellipsoid, by half its axes."""
    return call("ellipsoid", radii=radii, center=center)


# In the plane.


def circle(radius: float, center: Point = (0, 0)) -> Expr:
    """Disc in the plane."""
    return call("circle", radius=radius, center=center)


def rectangle(lower: Point, upper: Point) -> Expr:
    """Rectangle between two corners in the plane."""
    return call("rectangle", lower=lower, upper=upper)


def rounded_rectangle(lower: Point, upper: Point, edge: float) -> Expr:
    """Rectangle with round corners of the radius `edge`."""
    return call("rounded_rectangle", lower=lower, upper=upper, edge=edge)


def polygon(points: Any) -> Expr:
    """Any outline that does not cross itself, either way round: its corners, or
    an area of Shapely or of another library with `__geo_interface__`, which
    may have holes and several islands."""
    if not hasattr(points, "__geo_interface__"):
        return call("polygon", points)

    def island(rings: Sequence[Sequence[Point]]) -> Expr:
        outer, *holes = [call("polygon", ring) for ring in rings]
        return difference(outer, *holes) if holes else outer

    islands = [island(rings) for rings in polygons_of(points)]
    return union(*islands) if len(islands) > 1 else islands[0]


def extrude_z(shape: Expr, lower: float, upper: float) -> Expr:
    """A shape in the plane, raised from one height to another."""
    return call("extrude_z", shape=shape, lower=lower, upper=upper)


def loft_z(a: Expr, b: Expr, lower: float, upper: float) -> Expr:
    """From one shape in the plane to another, between two heights."""
    return call("loft_z", a=a, b=b, lower=lower, upper=upper)


# Sheets.


def gyroid(cell: float, thickness: float) -> Expr:
    """Endless gyroid, that repeats every `cell` mm."""
    return call("gyroid", cell=cell, thickness=thickness)


def schwarz_p(cell: float, thickness: float) -> Expr:
    """Endless Schwarz P surface, that repeats every `cell` mm."""
    return call("schwarz_p", cell=cell, thickness=thickness)


def diamond(cell: float, thickness: float) -> Expr:
    """Endless diamond surface, that repeats every `cell` mm."""
    return call("diamond", cell=cell, thickness=thickness)


# Putting together.


def union(*shapes: Any) -> Expr:
    """All of several shapes."""
    return call("union", _all(shapes))


def intersection(*shapes: Any) -> Expr:
    """What several shapes have in common."""
    return call("intersection", _all(shapes))


def difference(shape: Expr, *cutouts: Any) -> Expr:
    """A shape without others."""
    cutout = cutouts[0] if len(cutouts) == 1 else union(*cutouts)
    return call("difference", shape, cutout)


def inverse(shape: Expr) -> Expr:
    """All outside of a shape."""
    return call("inverse", shape)


def blend(a: Expr, b: Expr, radius: float) -> Expr:
    """A union whose seam is filled out softly where the two differ by less
    than `radius`."""
    return call("blend", a, b, radius)


def blend_intersection(a: Expr, b: Expr, radius: float) -> Expr:
    """A soft intersection."""
    return call("blend_intersection", a, b, radius)


def blend_difference(shape: Expr, cutout: Expr, radius: float) -> Expr:
    """A soft difference."""
    return call("blend_difference", shape, cutout, radius)


def _all(shapes: tuple[Any, ...]) -> list[Any]:
    """Shapes, whether they are arguments or in one list."""
    if len(shapes) == 1 and isinstance(shapes[0], (list, tuple)):
        return list(shapes[0])
    return list(shapes)


# Operations on a shape, which are methods.


def move(self: Expr, offset: Point) -> Expr:
    """The shape elsewhere, mm."""
    return call("move", self, offset)


def scale(self: Expr, factors: Point) -> Expr:
    """The shape larger along x, y and z; no distance any more."""
    return call("scale", self, factors)


def scale_uniform(self: Expr, factor: float) -> Expr:
    """The shape larger by a factor; a distance stays one."""
    return call("scale_uniform", self, factor)


def rotate(
    self: Expr,
    angle: float,
    axis: Point = (0, 0, 1),
    center: Point = _ORIGIN,
) -> Expr:
    """The shape turned about an axis, degrees, counter-clockwise seen from its
    end."""
    return call("rotate", self, angle=angle, axis=axis, center=center)


def rotate_x(self: Expr, angle: float, center: Point = _ORIGIN) -> Expr:
    """The shape turned about x, degrees, counter-clockwise seen from x's end."""
    return call("rotate_x", self, angle=angle, center=center)


def rotate_y(self: Expr, angle: float, center: Point = _ORIGIN) -> Expr:
    """The shape turned about y, degrees, counter-clockwise seen from y's end."""
    return call("rotate_y", self, angle=angle, center=center)


def rotate_z(self: Expr, angle: float, center: Point = _ORIGIN) -> Expr:
    """The shape turned about z, degrees, counter-clockwise seen from z's end."""
    return call("rotate_z", self, angle=angle, center=center)


def reflect_x(self: Expr, offset: float = 0) -> Expr:
    """The shape's mirror image at x = offset."""
    return call("reflect_x", self, offset=offset)


def reflect_y(self: Expr, offset: float = 0) -> Expr:
    """The shape's mirror image at y = offset."""
    return call("reflect_y", self, offset=offset)


def reflect_z(self: Expr, offset: float = 0) -> Expr:
    """The shape's mirror image at z = offset."""
    return call("reflect_z", self, offset=offset)


def mirror_x(self: Expr) -> Expr:
    """The half at x > 0, on both sides."""
    return call("mirror_x", self)


def mirror_y(self: Expr) -> Expr:
    """The half at y > 0, on both sides."""
    return call("mirror_y", self)


def mirror_z(self: Expr) -> Expr:
    """The half at z > 0, on both sides."""
    return call("mirror_z", self)


def shell(self: Expr, thickness: float) -> Expr:
    """The shape's outermost layer, mm."""
    return call("shell", self, thickness)


def grow(self: Expr, distance: float) -> Expr:
    """The shape grown by a distance, mm; a negative one shrinks it."""
    return call("grow", self, distance)


def twist(self: Expr, pitch: float) -> Expr:
    """The shape turned about z, once in `pitch` mm of height."""
    return call("twist", self, pitch)


def revolve_z(self: Expr) -> Expr:
    """A shape in the plane turned about z: x becomes the distance from the z
    axis, y the height."""
    return call("revolve_z", self)


def linear_array(self: Expr, step: Point, count: int) -> Expr:
    """Copies of the shape, each one step on, mm."""
    return call("linear_array", self, step, count)


def polar_array(self: Expr, count: int) -> Expr:
    """Copies of the shape round z."""
    return call("polar_array", self, count)


def repeat_x(self: Expr, radius: float, offset: float = 0) -> Expr:
    """Endless copies of the shape along x, two radii apart."""
    return call("repeat_x", self, radius=radius, offset=offset)


def repeat_y(self: Expr, radius: float, offset: float = 0) -> Expr:
    """Endless copies of the shape along y, two radii apart."""
    return call("repeat_y", self, radius=radius, offset=offset)


def repeat_z(self: Expr, radius: float, offset: float = 0) -> Expr:
    """Endless copies of the shape along z, two radii apart."""
    return call("repeat_z", self, radius=radius, offset=offset)


_METHODS: list[Callable[..., Expr]] = [
    move,
    scale,
    scale_uniform,
    rotate,
    rotate_x,
    rotate_y,
    rotate_z,
    reflect_x,
    reflect_y,
    reflect_z,
    mirror_x,
    mirror_y,
    mirror_z,
    shell,
    grow,
    twist,
    revolve_z,
    linear_array,
    polar_array,
    repeat_x,
    repeat_y,
    repeat_z,
    extrude_z,
    blend,
]
for _method in _METHODS:
    setattr(Expr, _method.__name__, _method)
