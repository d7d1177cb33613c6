"""Areas as other libraries have them: the attribute `__geo_interface__`.

Shapely and others hand areas out and take them in by it
(https://gist.github.com/sgillies/2217756).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any


class Outline(list):
    """The outline of a layer: its closed rings, each island's outer ring
    followed by those of its holes."""

    def __init__(self, islands: Iterable[list[Any]] = ()):
        self._islands = list(islands)
        super().__init__(ring for rings in self._islands for ring in rings)

    def __reduce__(self) -> tuple[Any, ...]:
        return Outline, (self._islands,)

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        """The islands as a MultiPolygon."""
        polygons = [tuple(map(_closed, rings)) for rings in self._islands]
        return {"type": "MultiPolygon", "coordinates": tuple(polygons)}


def _closed(ring: Any) -> tuple[tuple[float, float], ...]:
    points = [(float(x), float(y)) for x, y in ring]
    return tuple(points + points[:1])


def polygons_of(area: Any) -> list[list[list[tuple[float, float]]]]:
    """The rings of each polygon of an area that has `__geo_interface__`: the
    outer one and those of its holes, without the last point, which repeats the
    first one."""
    given: Mapping[str, Any] = area.__geo_interface__
    if given["type"] == "Feature":
        given = given["geometry"] or {"type": "MultiPolygon"}
    kind, coordinates = given["type"], given.get("coordinates", ())
    if kind == "Polygon":
        coordinates = [coordinates]
    elif kind != "MultiPolygon":
        raise TypeError(f"a {kind} has no area; give a Polygon or MultiPolygon")
    polygons = [
        [[(float(p[0]), float(p[1])) for p in ring][:-1] for ring in rings]
        for rings in coordinates
        if rings
    ]
    if not polygons:
        raise ValueError("there is no polygon in it")
    return polygons
