"""Fields: operators, functions, shapes, and values that are none."""

import ast
import gc
import math
import operator
import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import isoslice as iso
import numpy as np
import pytest
from conftest import ROOT
from isoslice import Expr, x, y, z

PLACES = [(0.5, -2.0, 3.0), (-1.25, 0.75, 2.5), (4.0, 4.0, -0.5)]


def same(field, function, tolerance=1e-6):
    """A field has these values, as exactly as 32 bits can."""
    for place in PLACES:
        wanted = function(*place)
        found = field(*place)
        assert found == pytest.approx(wanted, rel=tolerance, abs=tolerance)


def test_operators():
    same(x + y, lambda x, y, z: x + y)
    same(1 + x - y * 2, lambda x, y, z: 1 + x - y * 2)
    same(3 - x / y, lambda x, y, z: 3 - x / y)
    same(1 / y, lambda x, y, z: 1 / y)
    same(-x, lambda x, y, z: -x)
    same(+x, lambda x, y, z: x)
    same(abs(x), lambda x, y, z: abs(x))
    same(x**3, lambda x, y, z: x**3)
    same(x**-2, lambda x, y, z: x**-2)
    same(abs(x) ** 0.3, lambda x, y, z: abs(x) ** 0.3)
    same(abs(x) ** y, lambda x, y, z: abs(x) ** y)
    same(2**x, lambda x, y, z: 2**x)
    same(x % 3, lambda x, y, z: x % 3)
    same(7 % abs(y), lambda x, y, z: 7 % abs(y))
    same(x // 2, lambda x, y, z: x // 2)
    same(7 // y, lambda x, y, z: 7 // y)
    same(math.floor(x), lambda x, y, z: math.floor(x))
    same(math.ceil(x), lambda x, y, z: math.ceil(x))
    same(round(x * 1.1), lambda x, y, z: round(x * 1.1))
    same(x | y, lambda x, y, z: min(x, y))
    same(x & y & 2, lambda x, y, z: max(x, y, 2))
    same(0 | x, lambda x, y, z: min(0, x))
    same(~x, lambda x, y, z: -x)
    same(x + Fraction(1, 3), lambda x, y, z: x + 1 / 3)
    same(x + np.float32(0.5), lambda x, y, z: x + 0.5)
    field = x
    field += 1
    same(field, lambda x, y, z: x + 1)


def test_functions():
    for name, function in {
        "sin": math.sin,
        "cos": math.cos,
        "tan": math.tan,
        "atan": math.atan,
        "exp": math.exp,
        "floor": math.floor,
        "ceil": math.ceil,
        "abs": abs,
        "square": lambda v: v * v,
        "recip": lambda v: 1 / v,
        "sign": lambda v: (v > 0) - (v < 0),
    }.items():
        same(getattr(iso, name)(x), lambda x, y, z: function(x))
        assert getattr(iso, name)(0.5) == function(0.5)
    same(iso.sqrt(abs(x)), lambda x, y, z: math.sqrt(abs(x)))
    same(iso.log(abs(x)), lambda x, y, z: math.log(abs(x)))
    same(iso.asin(x / 9), lambda x, y, z: math.asin(x / 9))
    same(iso.acos(x / 9), lambda x, y, z: math.acos(x / 9))
    same(iso.atan2(y, x), lambda x, y, z: math.atan2(y, x))
    same(iso.min(x, y, z, 1), lambda x, y, z: min(x, y, z, 1))
    same(iso.max(x, y, z, 1), lambda x, y, z: max(x, y, z, 1))
    same(iso.mod(x, 3), lambda x, y, z: x % 3)
    same(iso.compare(x, y), lambda x, y, z: (x > y) - (x < y))
    same(iso.round(x), lambda x, y, z: math.floor(abs(x) + 0.5) * (x > 0 or -1))
    assert iso.min(3, 2) == 2 and iso.mod(-1, 3) == 2 and iso.round(2.5) == 3


def calls():
    """The functions' names in docs/functions.md, each with its values' number."""
    text = (ROOT / "docs" / "functions.md").read_text()
    rows = [row for row in text.splitlines() if row.startswith("| `")]
    for row in rows:
        for name, values in re.findall(r"`(\w+)\(([^`]*)\)`", row.split("|")[1]):
            yield name, len(values.split(","))


def test_a_name_means_the_same_in_three_languages():
    named = {"and": "logical_and", "or": "logical_or", "not": "logical_not"}
    found = list(calls())
    assert len(found) > 45, found
    for name, count in found:
        function = getattr(iso, named.get(name, name))
        fields = ", ".join("xyz"[:count])
        made = function(*(x, y, z)[:count])
        formula = iso.formula(f"{name}({fields})")
        script = iso.script(f"{name}({fields})")
        for place in PLACES:
            wanted = pytest.approx(formula(*place), rel=1e-5, abs=1e-5, nan_ok=True)
            assert made(*place) == wanted, name
            assert script(*place) == wanted, name
            number = function(*place[:count])
            assert isinstance(number, (int, float)), name
            if name != "hash":
                assert number == wanted, name
    for name in ("pi", "tau", "e", "PI", "TAU", "E"):
        wanted = pytest.approx(getattr(iso, name), rel=1e-6)
        assert iso.formula(f"{name} + 0*x")(0, 0, 0) == wanted
        assert iso.script(f"{name} + 0*x")(0, 0, 0) == wanted
    for text in ("x^2 - 1", "-x**2", "2**-x**2", "7 / 2 + x", "x % 3 / 2"):
        wanted = pytest.approx(iso.formula(text)(1.5, 0, 0), rel=1e-6)
        assert iso.script(text)(1.5, 0, 0) == wanted, text
        python = eval(text.replace("^", "**"), {"x": x})
        assert python(1.5, 0, 0) == wanted, text
    assert list(range(iso.floor(7 / 2))) == [0, 1, 2]
    with pytest.raises(TypeError, match=r"x\*\*2"):
        x ^ 2
    with pytest.raises(TypeError, match=r"x\*\*2"):
        2 ^ x


def test_numpys_functions_work_on_fields():
    for name in (
        "sin cos tan arctan exp floor ceil sign square negative absolute "
        "sinh cosh tanh exp2 cbrt degrees radians rint"
    ).split():
        function = getattr(np, name)
        field = function(x * 1.1)
        assert isinstance(field, Expr), name
        same(field, lambda x, y, z: function(x * 1.1), 2e-6)
    for name in ("add subtract multiply divide minimum maximum hypot").split():
        function = getattr(np, name)
        same(function(x, y), lambda x, y, z: function(x, y))
        same(function(2.0, y), lambda x, y, z: function(2.0, y))
    same(np.float64(3) - x, lambda x, y, z: 3 - x)
    same(np.array(3.0) * x, lambda x, y, z: 3 * x)
    # Arrays of fields, as programs for points have them.
    p = np.array([x, y, z], dtype=object)
    same(np.linalg.norm(p) - 2, lambda x, y, z: math.hypot(x, y, z) - 2)
    same((p * [1, 2, 3]).sum(), lambda x, y, z: x + 2 * y + 3 * z)
    both = np.array([1.0, 2.0]) * x
    assert both.shape == (2,)
    same(both[1], lambda x, y, z: 2 * x)
    with pytest.raises(TypeError):
        np.gcd(x, 3)
    with pytest.raises(TypeError):
        np.add.reduce(x)


def test_without_numpy():
    """numpy is not needed, and outlines are then lists."""
    program = """
import sys
sys.modules["numpy"] = None
import isoslice as iso
from isoslice import x, y, z
from isoslice import sdf
ring, = iso.sphere(5).outlines(3)
assert all(abs((a * a + b * b) ** 0.5 - 4) < 0.005 for a, b in ring), ring
assert isinstance(ring, list) and isinstance(ring[0], tuple)
assert sdf.sphere(2).expr(0, 0, 3) == 1
"""
    subprocess.run([sys.executable, "-c", program], check=True)


def test_every_shape_of_scripts_is_there():
    pages = [ROOT / "docs" / f"{page}.md" for page in ("shapes", "textures")]
    text = "".join(page.read_text() for page in pages)
    rows = [line for line in text.splitlines() if line.startswith("| `")]
    calls = [re.findall(r"`([^`]*)`", row.split("|")[1]) for row in rows]
    methods = {n for c in calls for n in re.findall(r"f\.(\w+)\(", " ".join(c))}
    functions = {
        m for c in calls for call in c for m in re.findall(r"^(\w+)\(", call)
    }
    assert len(methods) > 12 and len(functions) > 20
    assert {n for n in methods if not hasattr(Expr, n)} == set()
    assert {n for n in functions if not hasattr(iso, n)} == set()


def test_textures_take_words_and_flags():
    tile = iso.box((0, 0, 0), (9, 9, 2)).textured(
        0.5, iso.checker(size=3), projection="z", inward=True
    )
    assert tile(4.5, 1.5, 1.9) < 0 < tile(1.5, 1.5, 1.9)
    with pytest.raises(iso.Error, match="triplanar"):
        iso.sphere(3).textured(1, iso.ribs(), projection="cube")


def test_shapes_are_distances():
    same(iso.sphere(2), lambda x, y, z: math.hypot(x, y, z) - 2)
    same(iso.sphere(2, center=(1, 2, 3)).move((-1, -2, -3)), iso.sphere(2))
    ring = iso.torus(radius=3, tube=1)
    same(
        ring, lambda x, y, z: math.hypot(math.hypot(x, y) - 3, z) - 1, 1e-5
    )
    turned = iso.box((0, 0, 0), (1, 2, 3)).rotate_z(90)
    assert turned(-1, 0.5, 1) < 0 < turned(1, 0.5, 1)
    around = iso.box((0, 0, 0), (1, 2, 3)).rotate_z(180, center=(1, 1, 0))
    assert around(1.5, 1, 1) < 0 < around(0.5, 1, 1)
    assert iso.capsule((0, 0, 0), (0, 0, 5), 1)(0, 0, 6.5) == 0.5
    plan = iso.polygon([(0, 0), (4, 0), (0, 4)])
    assert plan.extrude_z(0, 2)(1, 1, 1) < 0
    assert iso.loft_z(iso.circle(1), iso.circle(3), 0, 2)(2.5, 0, 1.9) < 0
    shapes = [iso.sphere(1).move((3 * i, 0, 0)) for i in range(3)]
    assert iso.union(shapes)(6, 0, 0) == iso.union(*shapes)(6, 0, 0) == -1
    assert iso.difference(iso.sphere(2), *shapes)(0, 0, 0) == 1
    assert iso.sphere(1).linear_array((3, 0, 0), 3)(6, 0, 0) == -1
    assert iso.intersection(shapes[0], iso.inverse(shapes[1]))(0, 0, 0) == -1
    assert iso.sphere(2).reflect_x(3)(6, 0, 0) == -2
    assert iso.circle(2, center=(5, 0)).revolve_z()(0, 5, 1) == -1
    same(x.remap(y, z, x), lambda x, y, z: y)


def test_bodies_are_put_together_by_words():
    ball, hole = iso.sphere(4), iso.cylinder(1, 10)
    for wrong, words in [
        (lambda: ball - hole, "isoslice.difference"),
        (lambda: ball + hole, "isoslice.union"),
        (lambda: (ball | hole) - (ball & hole), "isoslice.difference"),
        (lambda: ball.move((1, 0, 0)) - hole, "isoslice.difference"),
        (lambda: (ball - 0.5) - iso.min(ball, hole), "isoslice.difference"),
        (lambda: ~ball - hole, "isoslice.difference"),
    ]:
        with pytest.raises(TypeError, match=words):
            wrong()
    # These are fields, or meant as such.
    assert (ball - x)(1, 0, 0) == -4
    assert (ball - 1 * hole)(0, 0, 0) == -3
    assert (0.5 * ball + 0.5 * hole)(0, 0, 0) == -2.5
    assert (iso.max(x, y) - iso.min(y, z))(1, 0, 0) == 1
    assert (ball + 1)(0, 0, 0) == -3


def test_what_is_no_field():
    for call in (
        lambda: x < 1,
        lambda: x >= y,
        lambda: bool(x),
        lambda: min(x, y),
        lambda: x + "1",
        lambda: x + None,
        lambda: x + [1],
        lambda: x + True,
        lambda: x @ y,
        lambda: pow(x, 2, 3),
        lambda: round(x, 2),
        lambda: x(1),
        lambda: x("a", 0, 0),
        lambda: iso.sin("a"),
        lambda: iso.min(),
        lambda: Expr(),
        lambda: setattr(x, "name", "a"),
        lambda: x + 10**400,
        lambda: iso.sphere(x),
        lambda: iso.cone(-1, 3),
        lambda: iso.box((0, 0), 3),
        lambda: iso.polygon([[0, 0]]),
        lambda: iso.polygon(5),
        lambda: iso._shapes.call("draw", x),
        lambda: iso._shapes.call("1; draw", x),
        lambda: iso._shapes.call("sphere", radius={"a": 1}),
        lambda: iso.sphere(1).linear_array((1, 0, 0), 10**9),
        lambda: x.remap(1, "a", 2),
    ):
        with pytest.raises((TypeError, ValueError, OverflowError, iso.Error, AttributeError)):
            call()
    assert x == x and x != y and len({x, y, x}) == 2
    assert x in [y, x]


def test_deep_fields_do_not_overflow_the_stack():
    field = x
    for i in range(300_000):
        field = field + i
    assert len(repr(field)) < 1000
    assert field.size > 300_000
    del field
    gc.collect()
    # Each of these expands the one before twice.
    field = x + y
    for i in range(60):
        field = iso.min(field.remap(y, x, z), field.remap(x + i, z, y))
    with pytest.raises(iso.Error, match="expands to more than"):
        iso.slice(field)
    with pytest.raises(iso.Error, match="expands to more than"):
        field(0, 0, 0)
    del field
    deep = []
    for _ in range(100_000):
        deep = [deep]
    with pytest.raises(ValueError, match="nest"):
        iso.union(deep)
    nested = {}
    for _ in range(1000):
        nested = {"speed": nested}
    with pytest.raises(ValueError, match="nest"):
        iso.slice(iso.sphere(5), settings=nested)


def test_texts_become_fields():
    same(iso.formula("2*x^2 + y"), lambda x, y, z: 2 * x * x + y)
    script = 'let n = param("n", 3, "how many"); x * n'
    same(iso.script(script), lambda x, y, z: 3 * x)
    field = iso.script(script, {"n": 5})
    same(field, lambda x, y, z: 5 * x)
    assert field.parameters == [
        {"name": "n", "default": "3", "value": "5", "description": "how many"}
    ]
    assert field.name == "script" and (field + 1).name is None
    with pytest.raises(iso.ModelError, match="unknown parameter"):
        iso.script(script, {"m": 5})
    with pytest.raises(iso.ModelError, match="line 2"):
        iso.script("let a = 1;\nnothing(a)")
    for bad in ("", "\0", "x +", "(" * 10_000, "\ud800", None, 3, b"x"):
        with pytest.raises((iso.ModelError, TypeError, UnicodeError)):
            iso.formula(bad)
        with pytest.raises((iso.ModelError, TypeError, UnicodeError)):
            iso.vm(bad)


def test_stubs_tell_of_everything():
    stub = Path(iso.__file__).with_name("_native.pyi")
    tree = ast.parse(stub.read_text())
    for kind in (Expr, iso.Sliced):
        body = next(
            node.body
            for node in tree.body
            if isinstance(node, ast.ClassDef) and node.name == kind.__name__
        )
        told = {n.name for n in body if isinstance(n, ast.FunctionDef)}
        there = {n for n in vars(kind) if not n.startswith("__")}
        assert {n for n in told if not n.startswith("__")} == there
        assert {n for n in told if not hasattr(kind, n)} == set()
        for name in there:
            assert getattr(kind, name).__doc__, name
    assert Path(iso.__file__).with_name("py.typed").exists()
    for name in iso.__all__:
        value = getattr(iso, name)
        assert name in "xyz" or value.__doc__, name


def test_importing_it_imports_nothing_slow():
    """numpy alone would take longer than isoslice, and not all models need it."""
    program = "import sys, isoslice; print(*sys.modules)"
    command = [sys.executable, "-c", program]
    run = subprocess.run(command, capture_output=True, check=True, text=True)
    loaded = set(run.stdout.split())
    assert "isoslice" in loaded
    assert not loaded & {"numpy", "asyncio", "unittest", "IPython"}


def test_data_is_a_field(tmp_path):
    import numpy

    mark = iso.text("IO", size=12, align="centre")
    assert mark(0, -20, 0) > 0 and mark(0, -20, 5) == mark(0, -20, 0)
    ramp = numpy.linspace(0, 1, 11, dtype="float32")[None, :].repeat(2, 0)
    wedge = iso.image(ramp, width=110)
    assert abs(wedge(55, 5, 0) - 0.5) < 1e-6
    block = numpy.arange(27, dtype="float32").reshape(3, 3, 3)
    assert iso.volume(block)(1, 2, 0) == 15
    table = tmp_path / "s.csv"
    rows = [f"{i % 3},{i // 3 % 3},{i // 9},{i % 3}" for i in range(27)]
    table.write_text("\n".join(["x,y,z,v"] + rows))
    assert abs(iso.samples(table)(0.5, 1, 1) - 0.5) < 1e-6
    corners = [(0, 0, 0), (10, 0, 0), (0, 10, 0), (0, 0, 10)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    lines = [f"v {a} {b} {c}" for a, b, c in corners]
    lines += ["f " + " ".join(str(k + 1) for k in f) for f in faces]
    path = tmp_path / "corner.obj"
    path.write_text("\n".join(lines))
    for corner in (iso.mesh(path), iso.load(path)):
        assert corner(1, 1, 1) == -1 and corner(-3, 1, 1) == 3
        assert (corner | iso.sphere(1))(1, 1, 1) < 0
    with pytest.raises(iso.Error, match="cannot read"):
        iso.mesh(tmp_path / "absent.stl")


def test_fields_are_written_as_3mf_and_read_again(tmp_path):
    part = iso.sqrt(x**2 + y**2 + z**2) - 5 & (x % 3) - 2
    file = tmp_path / "part.3mf"
    assert part.to_3mf(file) is None
    assert file.read_bytes() == part.to_3mf()
    again = iso.load(file)
    for place in PLACES:
        assert again(*place) == part(*place)
    with pytest.raises(iso.Error, match="it calls rand"):
        (part + iso.rand(x)).to_3mf(file)
    assert file.read_bytes() == part.to_3mf()
    with pytest.raises(iso.Error, match="part.3mf is also an input"):
        again.to_3mf(file)


def test_what_a_field_reads_is_not_replaced_by_it(tmp_path, monkeypatch):
    corners = "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\n"
    (tmp_path / "a.obj").write_text(corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    data = tmp_path / "a.3mf"
    iso.load(tmp_path / "a.obj").to_3mf(data)
    (tmp_path / "a.rhai").write_text('mesh("a.3mf")')
    monkeypatch.chdir(tmp_path)
    read = [iso.mesh("a.3mf"), iso.load("a.3mf"), iso.load(tmp_path / "a.rhai")]
    monkeypatch.chdir("/")
    whole = data.read_bytes()
    for field in read:
        for part in field, (field | iso.sphere(3)).remap(x + 1, y, z):
            with pytest.raises(iso.Error, match="a.3mf is also an input"):
                part.to_3mf(data)
            assert data.read_bytes() == whole
    iso.sphere(3).to_3mf(data)
    assert data.read_bytes() != whole


def test_what_should_be_known_of_a_3mf_file_is_a_warning():
    tiny = iso.sqrt(x**2 + y**2 + z**2) - 0.05
    with pytest.warns(iso.SliceWarning, match="only 0.100 mm large") as told:
        assert tiny.to_3mf()
    assert len(told) == 1
    assert told[0].filename == __file__
