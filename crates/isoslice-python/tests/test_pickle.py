"""Fields and results go through pickle, to another process and back."""

import copy
import math
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import isoslice as iso
import pytest
from conftest import ROOT
from isoslice import _native, x, y, z

pytestmark = pytest.mark.filterwarnings("ignore::isoslice.SliceWarning")


def again(value):
    return pickle.loads(pickle.dumps(value))


UNARY = (
    "sqrt sin cos tan asin acos atan exp log abs floor ceil round square "
    "recip sign not rand tanh fract"
).split()
BINARY = "min max atan2 mod compare and or hash step".split()
PLACES = [[0.3, -0.4, 0.9], [1.5, 2.5, -3.5], [-0.7, 0.1, 0.2]]


def same(a, b):
    """Equal bit for bit, no number among them being equal to itself."""
    pairs = zip(_native.evaluate(a, PLACES), _native.evaluate(b, PLACES))
    return all(u == v or math.isnan(u) and math.isnan(v) for u, v in pairs)


def test_every_operation():
    fields = [_native.call(name, x + 0.1 * y) for name in UNARY]
    fields += [_native.call(name, x, y - 0.25) for name in BINARY]
    fields += [x + y, x - y, x * y, x / y, -x, x, 3 * z, z // 2, z % 0.7]
    fields += [(x + y).remap(y, z, x * 2), (x**2 + z).move([1, 2, 3])]
    fields += [iso.box([0, 0, 0], [3, 4, 5]).rotate_z(30), iso.gyroid(cell=5, thickness=1)]
    for field in fields:
        read = again(field)
        assert repr(read) == repr(field)
        assert read.size == field.size
        assert same(read, field)
    assert len(fields) > 30


def test_the_same_bytes(program, tmp_path):
    gear = ROOT / "examples" / "gear.rhai"
    path = tmp_path / "part.gcode"
    done = program.run(
        "slice", gear, "-D", "teeth=14", "--layers", "3..9", "-o", path
    )
    assert done.returncode == 0, done.stderr.decode()
    read = again(iso.load(gear, {"teeth": 14}))
    assert read.name == "gear"
    assert read.parameters == iso.load(gear, {"teeth": 14}).parameters
    assert read.parameters
    assert iso.slice(read, layers="3..9").gcode == path.read_bytes()


def test_shared_operations_stay_shared():
    field = x
    for _ in range(60):
        # Written out this would have 2⁶⁰ operations.
        field = iso.sqrt(field * field + field)
    assert len(pickle.dumps(field)) < 20_000
    assert again(field).size == field.size
    # And so deep that recursion would end it.
    for _ in range(20_000):
        field = field + y
    assert copy.deepcopy(field).size == field.size


def test_a_body_stays_a_body():
    ball, hole = iso.sphere(4), iso.cylinder(1, 10)
    for read, other in [
        (again(ball), hole),
        (ball, again(hole)),
        (copy.deepcopy(ball), hole),
        (again(ball | hole), again(hole)),
    ]:
        with pytest.raises(TypeError, match="isoslice.difference"):
            read - other
        with pytest.raises(TypeError, match="isoslice.union"):
            read + other
    # A field stays a field.
    assert (again(1 * ball) - hole)(0, 0, 0) == -3
    # Pickles of earlier versions do not say what the field is.
    call, (steps, name, parameters, _) = ball.__reduce__()
    assert same(call(steps, name, parameters), ball)


def test_what_is_no_field():
    for steps in [
        [],
        [("nothing", [], [])],
        [("sqrt", [0], [])],
        [("x", [], []), ("add", [0, 1], [])],
        [("x", [], []), ("affine", [0], [1.0])],
    ]:
        with pytest.raises(ValueError):
            _native.unpickled_expr(steps, None, [])


def layer_of(job):
    field, layer = job
    return iso.slice(field, layers=layer, threads=1)


def test_results_from_other_processes(tmp_path):
    ball = iso.sqrt(x**2 + y**2 + z**2) - 6
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        results = list(pool.map(layer_of, [(ball, 10), (ball, 11)]))
    for layer, result in zip((10, 11), results):
        here = layer_of((ball, layer))
        assert result.gcode == here.gcode
        for name in (
            "name size layer_count layers time filament_mass filament_cost "
            "printing_moves warnings notes roles outline_error wall_error "
            "report hanging time_lost settings checked path"
        ).split():
            assert getattr(result, name) == getattr(here, name), name
        assert repr(result) == repr(here)
    # A file stays where it is.
    path = tmp_path / "part.gcode"
    to_file = iso.slice(
        ball,
        path,
        layers="1..3",
        report=True,
        printer="voron-2.4-350",
        **{"filament.cost": 25},
    )
    assert to_file.report
    read = again(to_file)
    assert read.path == path and read.gcode == path.read_bytes()
    assert read.report == to_file.report
    assert read.settings == to_file.settings
    assert read.preview_html() == to_file.preview_html()
    with pytest.raises(iso.Error, match="missing field"):
        _native.unpickled_sliced("{}", None, None, False)
