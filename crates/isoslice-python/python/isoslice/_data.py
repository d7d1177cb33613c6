"""Files, texts and arrays as functions: docs/data.md has what they take.

Every function calls the script's function of that name. A relative path is one
in the current folder. What was read stays in memory as long as Python runs.
"""

from __future__ import annotations

import os
import tempfile
from typing import Any, Union

from ._native import Expr, call

Path = Union[str, "os.PathLike[str]"]


def mesh(path: Path) -> Expr:
    """The distance to the surface of a mesh: STL, OBJ, PLY or 3MF."""
    return call("mesh", path)


def svg(path: Path, **options: Any) -> Expr:
    """The distance to the border of an SVG drawing, in the plane."""
    return call("svg", path, options)


def dxf(path: Path, **options: Any) -> Expr:
    """The distance to the border of a DXF drawing, in the plane."""
    return call("dxf", path, options)


def text(text: str, **options: Any) -> Expr:
    """The distance to the border of a text, in the plane."""
    return call("text", text, options)


def image(picture: Any, **options: Any) -> Expr:
    """The brightness of a picture, a file or an array of rows, from 0 to 1."""
    return _read("image", picture, options)


def volume(numbers: Any, **options: Any) -> Expr:
    """The numbers of a volume, a file or an array."""
    return _read("volume", numbers, options)


def samples(path: Path, **options: Any) -> Expr:
    """Numbers that are known at scattered places."""
    return call("samples", path, options)


def _read(kind: str, given: Any, options: dict[str, Any]) -> Expr:
    if not hasattr(given, "__array__"):
        return call(kind, given, options)
    import numpy

    # The file's name is another one each time, as is what it holds.
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "array.npy")
        numpy.save(path, numpy.asarray(given), allow_pickle=False)
        return call(kind, path, options)
