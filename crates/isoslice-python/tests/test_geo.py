"""Areas that other libraries take, and theirs as shapes."""

import pickle
from types import SimpleNamespace

import isoslice as iso
import pytest

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)]
HOLE = [(1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]


def given(kind, coordinates):
    return SimpleNamespace(
        __geo_interface__={"type": kind, "coordinates": coordinates}
    )


def content(ring):
    pairs = zip(ring, ring[1:])
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in pairs)


def test_an_outline_is_a_multipolygon():
    tube = iso.tube(radius=8, inner=3, height=20)
    ball = iso.sphere(1).move((20, 0, 0))
    outline = (tube | ball).outlines(0.5)
    assert len(outline) == 3
    area = outline.__geo_interface__
    assert area["type"] == "MultiPolygon"
    polygons = area["coordinates"]
    assert sorted(len(polygon) for polygon in polygons) == [1, 2]
    for outer, *holes in polygons:
        assert all(ring[0] == ring[-1] for ring in [outer, *holes])
        assert content(outer) > 0
        assert all(content(hole) < 0 for hole in holes)
    again = pickle.loads(pickle.dumps(outline))
    assert again.__geo_interface__ == area
    assert ball.outlines(9) == []
    empty = ball.outlines(9).__geo_interface__
    assert empty == {"type": "MultiPolygon", "coordinates": ()}


def test_an_area_becomes_a_shape():
    frame = iso.polygon(given("Polygon", [SQUARE, HOLE]))
    assert frame(0.5, 2, 0) < 0 < frame(2, 2, 0)
    assert frame(0.75, 2, 0) == pytest.approx(-0.25)
    beside = [[(x + 10, y) for x, y in SQUARE]]
    both = iso.polygon(given("MultiPolygon", [[SQUARE, HOLE], beside]))
    assert both(12, 2, 0) < 0 and both(0.5, 2, 0) < 0 < both(2, 2, 0)
    square = {"type": "Polygon", "coordinates": [SQUARE]}
    feature = {"type": "Feature", "geometry": square}
    assert iso.polygon(SimpleNamespace(__geo_interface__=feature))(2, 2, 0) < 0
    # Points may have a height.
    high = iso.polygon(given("Polygon", [[(x, y, 7) for x, y in SQUARE]]))
    assert high(2, 2, 0) < 0
    # What was an outline is one again.
    again = iso.polygon(iso.tube(radius=8, inner=3, height=20).outlines(0))
    assert again(5.5, 0, 0) == pytest.approx(-2.5, abs=0.01)
    assert again(0, 0, 0) == pytest.approx(3, abs=0.01)


@pytest.mark.parametrize(
    "kind, coordinates, error, words",
    [
        ("LineString", SQUARE, TypeError, "LineString has no area"),
        ("MultiPolygon", [], ValueError, "no polygon"),
    ],
)
def test_what_is_no_area(kind, coordinates, error, words):
    with pytest.raises(error, match=words):
        iso.polygon(given(kind, coordinates))


def test_shapely_takes_and_gives_areas():
    shapely = pytest.importorskip("shapely")
    ball = iso.sphere(5)
    disc = shapely.geometry.shape(ball.outlines(3))
    assert disc.is_valid
    assert disc.area == pytest.approx(3.141592653589793 * 16, rel=1e-3)
    ring = iso.polygon(disc.difference(disc.buffer(-1)))
    assert ring(3.5, 0, 0) < 0 < ring(0, 0, 0)
