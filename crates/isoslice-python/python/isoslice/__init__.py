"""isoslice: a slicer for implicit surfaces, from f(x, y, z) to G-code.

A model is a field f(x, y, z) that is negative inside the part, positive
outside and zero on its surface. Lengths are millimetres, angles degrees, times
seconds; z points up.

    import isoslice as iso
    from isoslice import x, y, z

    ball = iso.sqrt(x**2 + y**2 + z**2) - 15
    ring = iso.torus(radius=20, tube=4)
    part = ball | ring.move([0, 0, 3])
    print(iso.slice(part, "part.gcode", printer="prusa-mk4", layer_height=0.15))

Whatever goes wrong is an isoslice.Error, in the words of the command line.
"""

from __future__ import annotations

from . import _shapes
from ._functions import (
    E,
    PI,
    TAU,
    abs,
    acos,
    asin,
    atan,
    atan2,
    cbrt,
    ceil,
    clamp,
    compare,
    cos,
    cosh,
    degrees,
    e,
    exp,
    exp2,
    floor,
    fract,
    hash,
    hypot,
    length,
    ln,
    log,
    log10,
    log2,
    logical_and,
    logical_not,
    logical_or,
    max,
    min,
    mix,
    mod,
    neg,
    pi,
    pow,
    radians,
    rand,
    recip,
    round,
    sign,
    sin,
    sinh,
    smoothstep,
    sqrt,
    square,
    step,
    tan,
    tanh,
    tau,
    trunc,
    x,
    y,
    z,
)
from ._data import dxf, image, mesh, samples, svg, text, volume
from ._model import formula, load, script, vm
from ._native import (
    Error,
    Expr,
    ModelError,
    SettingsError,
    Sliced,
    SliceError,
    Stopped,
    __version__,
)
from ._shapes import (
    blend,
    blend_difference,
    blend_intersection,
    box,
    capsule,
    circle,
    cone,
    cylinder,
    diamond,
    difference,
    ellipsoid,
    extrude_z,
    gyroid,
    half_space,
    intersection,
    inverse,
    loft_z,
    polygon,
    prism,
    rectangle,
    rounded_box,
    rounded_cylinder,
    rounded_rectangle,
    schwarz_p,
    sphere,
    torus,
    tube,
    union,
    wedge,
)
from ._textures import (
    bricks,
    checker,
    dots,
    hexagons,
    knurl,
    leather,
    ribs,
    scales,
    voronoi,
    waves,
    weave,
    wood,
)
from ._geo import Outline
from ._slice import (
    Part,
    SliceWarning,
    outlines,
    profiles,
    settings,
    slice,
)

# Names of Python's own are left out: they are used as isoslice.min and so on.
__all__ = [
    name
    for name in dir()
    if not name.startswith("_")
    and name
    not in ("annotations", "abs", "hash", "max", "min", "pow", "round", "slice")
]
