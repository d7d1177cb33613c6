"""Slicing, and what a notebook shows of it."""

from __future__ import annotations

import inspect
import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Optional, Union

from . import _native
from ._geo import Outline
from ._native import Expr, Sliced

Path = Union[str, "os.PathLike[str]"]
Model = Union[Expr, str, "os.PathLike[str]"]
Layers = Union[str, int, "tuple[int, int]"]


class SliceWarning(UserWarning):
    """What the user should know of a print, or of a file."""


@dataclass(frozen=True)
class Part:
    """A part of a plate, as a [[part]] of a plate file: docs/plates.md.

    model: an Expr, or the name of a script (.rhai) or a list of operations
        (.vm).
    copies: how many there are to be.
    params: values of the script's parameters, if the model is a file.
    at: where on the bed the middle of the part goes, mm. Default: it is
        arranged with the others.
    lay: lay a mesh on its largest flat side, before it is rotated.
    rotate: an angle about z, or angles about x, then y, then z, degrees.
    scale: factor on all lengths.
    size: length of the part's largest side, mm.
    settings: settings of this part; they win over those of the whole plate.
    name: the model's name in the G-code, if it is no file.
    """

    model: Model
    copies: int = 1
    params: Optional[Mapping[str, Any]] = None
    at: Optional[Sequence[float]] = None
    lay: bool = False
    rotate: Union[float, Sequence[float], None] = None
    scale: Optional[float] = None
    size: Optional[float] = None
    settings: Optional[Mapping[str, Any]] = None
    name: Optional[str] = None


def slice(
    model: Union[Model, Part, Sequence[Union[Model, Part]]],
    output: Optional[Path] = None,
    *,
    copies: Optional[int] = None,
    params: Optional[Mapping[str, Any]] = None,
    name: Optional[str] = None,
    settings: Optional[Mapping[str, Any]] = None,
    printer: Optional[Path] = None,
    filament: Optional[Path] = None,
    preset: Optional[Path] = None,
    profiles: Optional[Path] = None,
    config: Union[Path, Sequence[Path], None] = None,
    size: Optional[float] = None,
    scale: Optional[float] = None,
    height: Optional[float] = None,
    lay: bool = False,
    rotate: Optional[Sequence[float]] = None,
    at: Optional[Sequence[float]] = None,
    keep_position: bool = False,
    bounds: Optional[Sequence[Sequence[float]]] = None,
    layers: Optional[Layers] = None,
    format: Optional[str] = None,
    report: bool = False,
    check: bool = True,
    svg: Optional[Path] = None,
    threads: Optional[int] = None,
    time_limit: Optional[float] = None,
    memory_limit: Optional[float] = None,
    progress: Optional[Callable[[int, int], Any]] = None,
    **more: Any,
) -> Sliced:
    """Slices a model, or a plate of several, to a file or to bytes: the bytes
    that `isoslice slice` writes for these models and these settings.

    model: an Expr, or the name of a script (.rhai) or a list of operations
        (.vm). Or a plate: the name of a plate file (.toml), or a list of models
        and of Parts, which are arranged on the bed.
    output: the file to write; binary if its name ends in .bgcode, a plate for
        Bambu Lab's printers if it ends in .gcode.3mf. Without it the G-code is
        the result's `gcode`. The file is complete or not there at all.
    copies: print so many of the model, or of each model in a list that is no
        Part.
    params: values of the script's parameters, if the model is a file.
    name: the model's name in the G-code, if it is no file; of a list, the
        plate's.

    settings: settings by their names, as in {"layer_height": 0.15,
        "speed.outer_wall": 30} or {"speed": {"outer_wall": 30}}.
    **more: settings, as in layer_height=0.15. `isoslice.settings()` lists them.
    printer, filament, preset: profiles by name, or by a path that ends in
        .toml. `isoslice.profiles()` lists them.
    profiles: folder of your own profiles.
    config: file or files of settings. They win over profiles, and settings
        win over all.

    size: length of the part's largest side, mm.
    scale: factor on all lengths.
    height: height to which a model that does not depend on z is raised, mm.
    lay: lay a mesh on its largest flat side, before it is rotated.
    rotate: angles about x, then y, then z, degrees.
    at: where on the bed the middle of the part goes, mm.
    keep_position: take the model's coordinates as the printer's.
    bounds: two corners of a box that cuts the model, in its own coordinates,
        mm.

    layers: only these layers, from 1: "10..20", 10 or (10, 20).
    format: "gcode", "bgcode" or "gcode.3mf", without an output.
    report: measure every outline and wall against the model.
    check: check the G-code. What could hurt the printer is then an Error.
    svg: folder for a picture of each layer.
    threads: how many; the result is the same.
    time_limit: seconds after which the work ends with Stopped; math.inf for no
        limit. Default: none, but 4 h of processor time, or 36 s of it in which
        next to nothing is sliced.
    memory_limit: bytes that the whole process may hold; math.inf for no limit.
        Default: 4 GB.
    progress: is called with the number of layers done, and of all layers, some
        20 times a second. An exception in it ends the work, as Ctrl-C does.

    Other threads of Python go on meanwhile. What the user should know is a
    SliceWarning, and in the result's `warnings`.
    """
    keywords = _keywords(locals())
    parts = _parts(model, copies)
    sliced = _native.slice(
        model if parts is None else None,
        parts or [],
        output,
        layers,
        format,
        report,
        check,
        svg,
        keywords,
    )
    for text in dict.fromkeys(sliced.warnings):
        warnings.warn(text, SliceWarning, stacklevel=2)
    return sliced


def outlines(
    model: Model,
    z: Union[float, Iterable[float]],
    *,
    params: Optional[Mapping[str, Any]] = None,
    name: Optional[str] = None,
    settings: Optional[Mapping[str, Any]] = None,
    printer: Optional[Path] = None,
    filament: Optional[Path] = None,
    preset: Optional[Path] = None,
    profiles: Optional[Path] = None,
    config: Union[Path, Sequence[Path], None] = None,
    size: Optional[float] = None,
    scale: Optional[float] = None,
    height: Optional[float] = None,
    lay: bool = False,
    rotate: Optional[Sequence[float]] = None,
    at: Optional[Sequence[float]] = None,
    keep_position: bool = False,
    bounds: Optional[Sequence[Sequence[float]]] = None,
    threads: Optional[int] = None,
    time_limit: Optional[float] = None,
    memory_limit: Optional[float] = None,
    progress: Optional[Callable[[int, int], Any]] = None,
    **more: Any,
) -> Any:
    """Outlines of the part as it stands on the printer, at a height above the
    bed, mm, or at several.

    Returns an `Outline`, a list of closed rings, or one for each of several
    heights. A ring is an array of shape (n, 2), or a list of (x, y) without
    numpy, in the printer's coordinates, mm: counter-clockwise round the part,
    clockwise round a hole. The last corner is joined to the first. Rings are
    within the setting `accuracy` of the true outline. Shapely and others take
    an outline as it is: shapely.geometry.shape(outline).

    The keywords are those of `slice`. A raft is not counted.
    """
    keywords = _keywords(locals())
    several, heights = _heights(z)
    rings = _native.outlines(model, heights, keywords)
    return _as_rings(rings, several)


def _outlines_of(
    self: Expr,
    z: Union[float, Iterable[float]],
    *,
    accuracy: float = 0.005,
    spacing: float = 0.1,
    bounds: Optional[Sequence[Sequence[float]]] = None,
) -> Any:
    """Outlines of the field at a height z, mm, or at several, in the field's
    own coordinates.

    accuracy: greatest distance of the rings from f = 0, mm.
    spacing: distance of the samples, mm. What is smaller may be left out.
    bounds: two corners of a box within which to look, mm. Default: the box of
        the part, which is found.

    Returns what `isoslice.outlines` returns.
    """
    several, heights = _heights(z)
    rings = _native.rings(self, heights, accuracy, spacing, bounds)
    return _as_rings(rings, several)


Expr.outlines = _outlines_of  # type: ignore[method-assign]
_outlines_of.__name__ = "outlines"
_outlines_of.__qualname__ = "Expr.outlines"


def settings() -> list[dict[str, str]]:
    """All settings: name, default as TOML has it, what is allowed, with its
    unit, and description."""
    return _native.settings()


def profiles(folder: Optional[Path] = None) -> list[dict[str, Any]]:
    """All profiles: kind (printer, filament or preset), name, description, and
    file, which is None for those that are part of isoslice.

    folder: that of your own profiles. Default: as on the command line.
    """
    return _native.profiles(folder)


def _parts(model: Any, copies: Optional[int]) -> Optional[list[Part]]:
    """The parts of a plate, or None for one model or a plate file."""
    if isinstance(model, (list, tuple)):
        several = list(model)
    elif isinstance(model, Part) or copies is not None:
        several = [model]
    else:
        return None
    if isinstance(model, Part) and copies is not None:
        raise TypeError("give a Part its copies itself: Part(model, copies=3)")
    count = 1 if copies is None else copies

    def plain(given: Optional[Mapping[str, Any]]) -> Optional[dict[str, Any]]:
        return None if given is None else dict(given)

    def part(given: Any) -> Part:
        if not isinstance(given, Part):
            return Part(given, copies=count)
        params, settings = plain(given.params), plain(given.settings)
        return replace(given, params=params, settings=settings)

    return [part(given) for given in several]


# The keywords that all functions share: those of `outlines`.
_SHARED = list(inspect.signature(outlines).parameters)[2:]


def _keywords(given: dict[str, Any]) -> dict[str, Any]:
    """The keywords that all functions share, of all that were given."""
    keywords = {name: given[name] for name in _SHARED}
    for name in ("params", "settings"):
        if keywords[name] is not None:
            keywords[name] = dict(keywords[name])
    return keywords


def _heights(z: Any) -> tuple[bool, list[float]]:
    try:
        return False, [float(z)]
    except TypeError:
        return True, [float(height) for height in z]


def _as_rings(found: list[list[list[bytes]]], several: bool) -> Any:
    """Outlines of rings from x and y by turns, in native order."""
    try:
        import numpy
    except ImportError:
        from array import array

        def ring(data: bytes) -> Any:
            numbers = array("d", data)
            return list(zip(numbers[::2], numbers[1::2]))
    else:

        def ring(data: bytes) -> Any:
            numbers = numpy.frombuffer(data, dtype=numpy.float64)
            return numbers.reshape(-1, 2).copy()

    def outline(islands: list[list[bytes]]) -> Outline:
        return Outline([ring(data) for data in rings] for rings in islands)

    outlines = [outline(islands) for islands in found]
    return outlines if several else outlines[0]


# A page beyond this would make a notebook slow, bytes.
_MOST = 48 << 20


def _repr_html(self: Sliced) -> str:
    """The preview, for notebooks."""
    from html import escape

    page = self.preview_html()
    summary = escape(repr(self))
    if len(page) > _MOST:
        return (
            f"<p>{summary}</p><p>The preview has {len(page) >> 20} MB, too much "
            "for a notebook: save_preview('part.html') writes it to a file.</p>"
        )
    # The page is an origin of its own, which cannot reach the notebook.
    return (
        f"<p>{summary}</p>"
        '<iframe sandbox="allow-scripts" style="width:100%;height:600px;'
        f'border:0" title="{summary}" srcdoc="{escape(page)}"></iframe>'
    )


def _save_preview(self: Sliced, path: Path) -> None:
    """Writes the page of `isoslice preview` to an HTML file."""
    with open(path, "w", encoding="utf-8", newline="") as file:
        file.write(self.preview_html())


def _save(self: Sliced, path: Path) -> None:
    """Writes the G-code to a file."""
    gcode = self.gcode
    with open(path, "wb") as file:
        file.write(gcode)


for _name, _method in {
    "_repr_html_": _repr_html,
    "save_preview": _save_preview,
    "save": _save,
}.items():
    _method.__name__ = _name
    _method.__qualname__ = f"Sliced.{_name}"
    setattr(Sliced, _name, _method)
