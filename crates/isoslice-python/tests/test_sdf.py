"""isoslice.sdf: models written for fogleman's sdf."""

import math
import random

import isoslice as iso
import numpy as np
import pytest
from isoslice import sdf
from isoslice.sdf import X, Y, Z

PLACES = [
    tuple(random.Random(seed).uniform(-2, 2) for _ in range(3))
    for seed in range(40)
]


def length(*v):
    return math.hypot(*v)


def same(shape, function, tolerance=2e-6):
    for place in PLACES:
        found = shape.expr(*place)
        assert found == pytest.approx(function(*place), abs=tolerance), place


def clip(v, low, high):
    return min(max(v, low), high)


def test_bodies():
    same(sdf.sphere(1.5, (1, 0, 0)), lambda x, y, z: length(x - 1, y, z) - 1.5)
    same(sdf.plane(Z, (0, 0, 1)), lambda x, y, z: 1 - z)
    same(sdf.cylinder(0.5), lambda x, y, z: length(x, y) - 0.5)
    same(sdf.torus(1, 0.25), lambda x, y, z: length(length(x, y) - 1, z) - 0.25)

    def block(x, y, z):
        q = [abs(x) - 0.5, abs(y) - 1, abs(z) - 0.75]
        return length(*(max(v, 0) for v in q)) + min(max(q), 0)

    same(sdf.box((1, 2, 1.5)), block)
    same(sdf.box(a=(-0.5, -1, -0.75), b=(0.5, 1, 0.75)), block)
    same(sdf.box((1, 2, 1.5), center=(3, 0, 0)).translate((-3, 0, 0)), block)
    assert sdf.rounded_box(2, 0.25).expr(2, 0, 0) == pytest.approx(1)
    assert sdf.rounded_box(2, 0.25).expr(1, 1, 0) == pytest.approx(
        0.25 * (math.sqrt(2) - 1), abs=1e-6
    )
    rod = sdf.capsule((0, 0, -1), (0, 0, 1), 0.5)
    same(rod, lambda x, y, z: length(x, y, z - clip(z, -1, 1)) - 0.5)
    # Along any axis, the same distance.
    for make in (
        lambda a, b: sdf.capped_cylinder(a, b, 0.5),
        lambda a, b: sdf.capped_cone(a, b, 0.75, 0.25),
        lambda a, b: sdf.capped_cone(a, b, 0.25, 0.75),
    ):
        along_z, along_x = make(-Z, Z), make(-X, X)
        for a, b, c in PLACES:
            wanted = along_z.expr(a, b, c)
            assert along_x.expr(c, a, b) == pytest.approx(wanted, abs=3e-6)
    narrow = sdf.capped_cone(-Z, Z, 0.75, 0.25)
    assert narrow.expr(0.7, 0, -0.99) < 0 < narrow.expr(0.7, 0, 0.99)
    slab = sdf.slab(z0=-1, z1=0.5, x0=0)
    same(slab, lambda x, y, z: max(-x, -1 - z, z - 0.5))
    # The hull of two balls: the least distance of the balls between them.
    hull = sdf.rounded_cone(0.75, 0.25, 2)

    def nearest(x, y, z):
        steps = np.linspace(0, 1, 20_001)
        at = z - 2 * steps
        return (np.hypot(length(x, y), at) - 0.75 + 0.5 * steps).min()

    same(hull, nearest)


def test_solids():
    """Points of faces and corners."""
    octahedron = sdf.octahedron(1).expr
    assert octahedron(1, 0, 0) == pytest.approx(0, abs=1e-6)
    assert octahedron(0, 0, 0) == pytest.approx(-1 / math.sqrt(3))
    golden = (1 + math.sqrt(5)) / 2
    face = np.array([golden, 1, 0]) / math.hypot(golden, 1)
    dodecahedron = sdf.dodecahedron(1).expr
    assert dodecahedron(0, 0, 0) == pytest.approx(-0.8506508, abs=1e-6)
    assert dodecahedron(*(2 * face)) == pytest.approx(2 - 0.8506508, abs=1e-6)
    icosahedron = sdf.icosahedron(1).expr
    assert icosahedron(0, 0, 0) == pytest.approx(-0.7946545, abs=1e-6)
    corner = np.array([1, golden, 0]) / math.hypot(golden, 1)
    assert icosahedron(*corner) == pytest.approx(0, abs=1e-6)
    tetrahedron = sdf.tetrahedron(1).expr
    assert tetrahedron(1, 1, 1) == pytest.approx(0, abs=1e-6)
    assert tetrahedron(0, 0, 0) == pytest.approx(-1 / math.sqrt(3))
    pyramid = sdf.pyramid(2).expr
    assert pyramid(0, 0, 2) == pytest.approx(0, abs=1e-6)
    assert pyramid(0.5, 0, 0) == pytest.approx(0, abs=1e-6)
    assert pyramid(0, 0, 1) < 0 < pyramid(0, 0, -0.1)
    assert sdf.ellipsoid((1, 2, 3)).expr(0, 0, 3.01) > 0
    assert sdf.ellipsoid((1, 2, 3)).expr(0, 0, 2.99) < 0
    rim = sdf.rounded_cylinder(0.5, 0.1, 2).expr
    assert rim(0.5, 0, 0) == pytest.approx(0, abs=1e-6)
    assert rim(0.5, 0, 1) == pytest.approx(0.1 * (math.sqrt(2) - 1), abs=1e-6)
    frame = sdf.wireframe_box((2, 2, 2), 0.1).expr
    assert frame(1, 1, 0) < 0 < frame(0, 0, 0) and frame(1, 0, 0) > 0


def test_in_the_plane():
    same(sdf.circle(1, (1, 0)), lambda x, y, z: length(x - 1, y) - 1)
    same(sdf.line(), lambda x, y, z: -y)
    assert sdf.rectangle((2, 1)).expr(2, 0, 0) == 1
    assert sdf.rounded_rectangle((2, 1), 0.25).expr(1, 0, 0) == 0
    for corner in ((1, 0), (0.5, math.sqrt(3) / 2)):
        assert sdf.hexagon(1).expr(*corner, 0) == pytest.approx(0, abs=1e-6)
    top = 2 / math.sqrt(3)
    assert sdf.equilateral_triangle().expr(0, top, 0) == pytest.approx(
        0, abs=1e-6
    )
    assert sdf.rounded_x(1, 0.1).expr(0.5, 0.5, 0) == pytest.approx(-0.1)
    assert sdf.polygon([(0, 0), (2, 0), (0, 2)]).expr(0.5, 0.5, 0) < 0
    rod = sdf.circle(1).extrude(2)

    def cylinder(x, y, z):
        w = [length(x, y) - 1, abs(z) - 1]
        return length(*(max(v, 0) for v in w)) + min(max(w), 0)

    same(rod, cylinder)
    same(sdf.circle(0.5).revolve(1), sdf_torus := (
        lambda x, y, z: length(length(x, y) - 1, z) - 0.5
    ))
    same(sdf.torus(1, 0.5), sdf_torus)
    tower = sdf.circle(1).extrude_to(sdf.circle(0.5), 2)
    assert tower.expr(0.9, 0, -0.9) < 0 < tower.expr(0.9, 0, 0.9)
    same(sdf.sphere(1).slice(), lambda x, y, z: length(x, y) - 1)
    turned = sdf.rectangle((2, 1)).rotate(math.pi / 2)
    same(turned, lambda x, y, z: sdf.rectangle((1, 2)).expr(x, y, z))
    clockwise = sdf.circle(0.1, (1, 0)).rotate(math.pi / 2)
    assert clockwise.expr(0, -1, 0) == pytest.approx(-0.1)


def test_operations():
    a, b = sdf.sphere(1), sdf.box(1.5)
    fa, fb = a.expr, b.expr
    same(a | b, lambda *p: min(fa(*p), fb(*p)))
    same(a & b, lambda *p: max(fa(*p), fb(*p)))
    same(a - b, lambda *p: max(fa(*p), -fb(*p)))
    same(sdf.union(a, b), lambda *p: min(fa(*p), fb(*p)))

    def smooth(p, k):
        """The polynomial of second order that the README names."""
        f, g = fa(*p), fb(*p)
        h = clip(0.5 + 0.5 * (g - f) / k, 0, 1)
        return g + (f - g) * h - k * h * (1 - h)

    same(a | b.k(0.25), lambda *p: smooth(p, 0.25))
    same(sdf.union(a, b, k=0.25), lambda *p: smooth(p, 0.25))
    # Soft intersections and differences are those of inverses.
    same(sdf.intersection(a, b, k=0.3), (a.negate().union(b.negate(), k=0.3)).negate().expr)
    same(sdf.difference(a, b, k=0.3), sdf.intersection(a, b.negate(), k=0.3).expr)
    same(sdf.blend(a, b, k=0.25), lambda *p: 0.25 * fb(*p) + 0.75 * fa(*p))
    same(a.dilate(0.1), lambda *p: fa(*p) - 0.1)
    same(a.erode(0.1), lambda *p: fa(*p) + 0.1)
    same(a.shell(0.1), lambda *p: abs(fa(*p)) - 0.05)
    same(b.scale(2), lambda x, y, z: 2 * fb(x / 2, y / 2, z / 2))
    same(b.translate((1, 2, 3)), lambda x, y, z: fb(x - 1, y - 2, z - 3))
    stretched = a.elongate((0.5, 0, 1))
    same(
        stretched,
        lambda x, y, z: length(x - clip(x, -0.5, 0.5), y, z - clip(z, -1, 1)) - 1
        if max(abs(x) - 0.5, abs(y), abs(z) - 1) > 0
        else fa(0, 0, 0) + max(abs(x) - 0.5, abs(y), abs(z) - 1),
    )


def rotated(point, angle, axis):
    """A point turned about an axis, by quaternions."""
    axis = np.array(axis, float) / np.linalg.norm(axis)
    w, u = math.cos(angle / 2), math.sin(angle / 2) * axis
    v = np.array(point, float)
    return v + 2 * np.cross(u, np.cross(u, v) + w * v)


def test_turns():
    peg = sdf.sphere(0.3, (1.2, 0.3, 0.1)) | sdf.sphere(0.2, (0, 0, 1))
    for angle, axis in ((0.7, Z), (-1.1, X), (0.4, (1, 2, 3)), (math.pi / 2, Y)):
        turned = peg.rotate(angle, axis)
        same(turned, lambda *p: peg.expr(*rotated(p, -angle, axis)), 4e-6)
    for axis in (X, Y, Z, -Z, -X, (1, 1, 0)):
        tip = np.array(axis) / np.linalg.norm(axis)
        oriented = sdf.sphere(0.2, tip).orient(axis)
        assert oriented.expr(0, 0, 1) == pytest.approx(-0.2, abs=1e-6)
        back = oriented.rotate_to(axis, Z)
        assert back.expr(*tip) == pytest.approx(-0.2, abs=1e-6)
    three = sdf.sphere(0.3).circular_array(3, 1)
    for angle in (0, 2 * math.pi / 3, 4 * math.pi / 3):
        at = three.expr(math.cos(angle), math.sin(angle), 0)
        assert at == pytest.approx(-0.3, abs=1e-6)
    twisted = sdf.box((1, 0.2, 4)).twist(math.pi / 2)
    assert twisted.expr(0.4, 0, 0) < 0 < twisted.expr(0.4, 0, 1)
    assert twisted.expr(0, 0.4, 1) < 0


def test_copies_and_ways():
    dots = sdf.sphere(0.2).repeat(1)
    for x in (-3, 0, 7):
        assert dots.expr(x, 1, -2) == pytest.approx(-0.2, abs=1e-6)
    three = sdf.sphere(0.2).repeat((1, 0, 0), (1, 0, 0))
    assert three.expr(1, 0, 0) == pytest.approx(-0.2)
    assert three.expr(2, 0, 0) == pytest.approx(0.8)
    assert three.expr(0, 1, 0) == pytest.approx(0.8)
    wide = sdf.sphere(0.7).repeat(1, padding=1)
    assert wide.expr(0.5, 0.5, 0.5) == pytest.approx(math.sqrt(0.75) - 0.7)
    bent = sdf.box((4, 0.2, 0.2)).bend_linear(-X, X, Y)
    assert bent.expr(1.5, 1, 0) < 0 < bent.expr(1.5, 0, 0)
    assert bent.expr(-1.5, 0, 0) < 0
    raised = sdf.circle(2).extrude(0.2).bend_radial(0, 2, 1)
    assert raised.expr(1.9, 0, 0.95) < 0 < raised.expr(1.9, 0, 0)
    way = sdf.sphere(1).transition_linear(sdf.box(1), -Z, Z)
    assert way.expr(0, 0, -1) == pytest.approx(0, abs=1e-6)
    radial = sdf.sphere(1).transition_radial(sdf.box(4), 0, 1)
    assert radial.expr(1.5, 0, 0) == pytest.approx(-0.5)
    assert sdf.box(2).bend(0.5).expr(0, 0, 0) < 0
    for name in vars(sdf.ease):
        ease = getattr(sdf.ease, name)
        assert ease(0.0) == pytest.approx(0) and ease(1.0) == pytest.approx(1)
        field = sdf.SDF3(ease(iso.x))
        for t in (0.1, 0.5, 0.8):
            assert field.expr(t, 0, 0) == pytest.approx(ease(t), abs=1e-6)
    assert sdf.ease.in_out_quad(0.25) == pytest.approx(0.125)
    assert sdf.ease.out_quad(0.5) == pytest.approx(0.75)


def test_functions_of_ones_own():
    @sdf.sdf3
    def ball(radius):
        def f(p):
            return np.linalg.norm(p, axis=1) - radius

        return f

    same(ball(1.5), lambda x, y, z: length(x, y, z) - 1.5)

    @sdf.sdf2
    def stripe(width):
        return lambda p: np.abs(p[:, 0]) - width / 2

    same(stripe(1).extrude(1) | ball(1), (stripe(1).extrude(1) | ball(1)).expr)


@pytest.mark.filterwarnings("ignore::isoslice.SliceWarning")
def test_the_readmes_first_model(tmp_path):
    names = {}
    exec("from isoslice.sdf import *", names)
    program = """
f = sphere(1) & box(1.5)

c = cylinder(0.5)
f -= c.orient(X) | c.orient(Y) | c.orient(Z)
"""
    exec(program, names)
    f = names["f"]
    sliced = f.save(tmp_path / "out.gcode", size=30)
    assert sliced.size == pytest.approx((30, 30, 30), abs=0.01)
    assert sliced.layer_count == 150
    # A layer in the middle: the block without a hole across.
    rings = iso.outlines(f, 15, size=30)
    assert len(rings) == 4
    with pytest.raises(iso.Error, match="mesh"):
        f.save(tmp_path / "out.stl")


def test_what_is_not_there_says_why():
    for name in ("text", "image", "generate", "wrap_around"):
        with pytest.raises(AttributeError, match=name):
            getattr(sdf, name)
    for call in (
        lambda: sdf.slab(),
        lambda: sdf.box((1, 2)),
        lambda: sdf.sphere("a"),
        lambda: sdf.plane((0, 0, 0)),
        lambda: sdf.rounded_cone(1, 2, 0.5),
        lambda: sdf.sphere(1) | 3,
        lambda: sdf.sphere(1).rotate("a"),
    ):
        with pytest.raises((TypeError, ValueError, AttributeError, iso.Error)):
            call()
