"""Bodies whose surface is moved by a picture, and patterns for it.

Every function calls the script's function of that name. docs/textures.md tells
their options, which have the same names and defaults here.
"""

from __future__ import annotations

from typing import Any

from ._native import Expr, call


def textured(
    self: Expr, depth: float, picture: Expr, **options: Any
) -> Expr:
    """The body, its surface moved out by the depth, mm, times a field from 0
    to 1."""
    return call("textured", self, depth, picture, **options)


def wrapped(self: Expr, radius: float) -> Expr:
    """A drawing wrapped round the z axis at a radius, mm: x becomes the way
    round, y the height and z the distance from the cylinder."""
    return call("wrapped", self, radius)


def knurl(**options: float) -> Expr:
    """Diamonds between two crossing sets of grooves."""
    return call("knurl", **options)


def hexagons(**options: float) -> Expr:
    """Honeycomb."""
    return call("hexagons", **options)


def weave(**options: float) -> Expr:
    """Strands that go over and under one another."""
    return call("weave", **options)


def wood(**options: float) -> Expr:
    """Grain along y."""
    return call("wood", **options)


def leather(**options: float) -> Expr:
    """Pebbles of different heights."""
    return call("leather", **options)


def voronoi(**options: float) -> Expr:
    """Cells around scattered points."""
    return call("voronoi", **options)


def waves(**options: float) -> Expr:
    """Ripples that meander along x."""
    return call("waves", **options)


def bricks(**options: float) -> Expr:
    """Bricks in rows, each shifted by half a brick."""
    return call("bricks", **options)


def dots(**options: float) -> Expr:
    """Round domes, three round each gap."""
    return call("dots", **options)


def ribs(**options: float) -> Expr:
    """Upright ribs."""
    return call("ribs", **options)


def scales(**options: float) -> Expr:
    """Scales that overlap, as those of a fish."""
    return call("scales", **options)


def checker(**options: float) -> Expr:
    """Squares that are raised and sunk in turn."""
    return call("checker", **options)


for _method in (textured, wrapped):
    setattr(Expr, _method.__name__, _method)
