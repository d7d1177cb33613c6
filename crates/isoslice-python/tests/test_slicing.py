"""Slicing: results, outlines, progress, and how it ends."""

import inspect
import math
import os
import signal
import subprocess
import sys
import threading
import time

import isoslice as iso
import numpy as np
import pytest
from isoslice import x, y, z

pytestmark = pytest.mark.filterwarnings("ignore::isoslice.SliceWarning")

# A lattice that takes a while.
SLOW = iso.intersection(iso.gyroid(4, 0.5), iso.sphere(40))


def area(ring):
    """Content of a ring, positive if it is counter-clockwise."""
    a, b = ring.T
    return 0.5 * np.sum(a * np.roll(b, -1) - np.roll(a, -1) * b)


def test_outlines_of_a_field():
    tube = iso.tube(radius=8, inner=3, height=20)
    rings = tube.outlines(1.5)
    assert len(rings) == 2
    for ring in rings:
        radius = np.hypot(*ring.T)
        wanted = 8 if area(ring) > 0 else 3
        # Corners and edges are within 5 µm of the circle.
        middles = np.hypot(*(0.5 * (ring + np.roll(ring, -1, 0))).T)
        assert np.abs(radius - wanted).max() < 0.005
        assert np.abs(middles - wanted).max() < 0.005
    assert sorted(np.sign([area(ring) for ring in rings])) == [-1, 1]
    ball = iso.sphere(5)
    fine = ball.outlines([4, 0, 3, 7], accuracy=0.0005)
    radii = [[np.hypot(*ring.T) for ring in of_height] for of_height in fine]
    for (found,), wanted in zip(radii[:3], [3, 5, 4]):
        assert np.abs(found - wanted).max() < 0.0005
    assert fine[3] == []
    assert ball.outlines(np.linspace(-4, 4, 70))[35][0].dtype == np.float64
    half = ball.outlines(0, bounds=[(-9, -9, -9), (9, 9, 9)])
    assert len(half) == 1


def test_outlines_has_the_keywords_of_slice():
    of_slice = inspect.signature(iso.slice).parameters
    of_outlines = dict(inspect.signature(iso.outlines).parameters)
    assert of_outlines.pop("z").kind is inspect.Parameter.POSITIONAL_OR_KEYWORD
    assert of_outlines.keys() < of_slice.keys()
    # A plate has no outlines of its own.
    assert of_outlines.pop("model").kind == of_slice["model"].kind
    for name, parameter in of_outlines.items():
        # Annotation, default and kind are the same.
        assert parameter == of_slice[name]
    own = "model output copies layers format report check svg"
    assert of_slice.keys() - of_outlines.keys() == set(own.split())


def test_outlines_as_printed():
    ball = iso.sphere(6)
    (ring,) = iso.outlines(ball, 6.0, at=(50, 60))
    assert np.abs(np.hypot(*(ring - [50, 60]).T) - 6).max() < 0.005
    (ring,) = iso.outlines(ball, 2.0, scale=2, accuracy=0.001)
    centre = ring.mean(axis=0)
    radius = math.sqrt(12**2 - 10**2)
    assert np.abs(np.hypot(*(ring - [110, 110]).T) - radius).max() < 0.001
    assert np.abs(centre - 110).max() < 0.2
    assert iso.outlines(ball, -1) == []
    assert iso.outlines(ball, [1, 13])[1] == []
    for bad in (math.nan, "a", [1, "b"], None):
        with pytest.raises((TypeError, ValueError)):
            iso.outlines(ball, bad)
    for bad in (0, -1, math.inf, "a"):
        with pytest.raises((TypeError, ValueError)):
            ball.outlines(0, accuracy=bad)
        with pytest.raises((TypeError, ValueError)):
            ball.outlines(0, spacing=bad)
    with pytest.raises(iso.Error, match="goes on along"):
        x.outlines(0)


def test_results():
    block = iso.box((0, 0, 0), (10, 20, 4))
    sliced = iso.slice(block, report=True, infill_density=100)
    assert sliced.size == pytest.approx((10, 20, 4), abs=1e-3)
    assert sliced.layer_count == 20 and sliced.layers == (1, 20)
    assert sliced.solid_area == pytest.approx(20 * 200, rel=1e-3)
    # The filament's volume is the block's, and the skirt's.
    skirt = sliced.roles["skirt"]["filament_mm"]
    section = math.pi * (1.75 / 2) ** 2
    volume = (sliced.filament_length - skirt) * section
    assert volume == pytest.approx(10 * 20 * 4, rel=0.03)
    assert sliced.time > 60
    assert sliced.report["outline_um"]["max"] <= 5
    assert sliced.settings["infill_density"] == "100"
    assert sum(sliced.timings.values()) > 0
    assert "10.0 × 20.0 × 4.0 mm" in repr(sliced)
    priced = iso.slice(block, settings={"filament": {"cost": 20}})
    grams = priced.filament_mass
    assert priced.filament_cost == pytest.approx(grams * 20 / 1000)
    free = iso.slice(block, settings={"filament": {"cost": 0}})
    assert free.filament_cost is None


def test_one_result_on_any_number_of_threads():
    ball = iso.sphere(8)
    one = iso.slice(ball, threads=1).gcode
    assert iso.slice(ball, threads=3).gcode == one
    found = []
    threads = [
        threading.Thread(target=lambda: found.append(iso.slice(ball).gcode))
        for _ in range(3)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [one] * 3


def test_warnings_are_pythons():
    with pytest.warns(iso.SliceWarning, match="stands on") as told:
        sliced = iso.slice(iso.sphere(6))
    assert [str(w.message) for w in told] == sliced.warnings
    assert told[0].filename == __file__


def test_progress():
    told = []
    iso.slice(iso.sphere(8), progress=lambda done, all: told.append((done, all)))
    assert told[-1] == (80, 80)
    assert told == sorted(told)

    class Enough(Exception):
        pass

    def enough(done, all):
        raise Enough

    with pytest.raises(Enough):
        iso.slice(SLOW, progress=enough)
    with pytest.raises(TypeError):
        iso.slice(SLOW, progress=3)


def test_other_threads_go_on(tmp_path):
    """The GIL is released: another thread counts meanwhile."""
    count, done = [0], threading.Event()

    def counting():
        while not done.is_set():
            count[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=counting)
    thread.start()
    before, start = count[0], time.perf_counter()
    iso.slice(SLOW, layers=(1, 40))
    counted, took = count[0] - before, time.perf_counter() - start
    done.set()
    thread.join()
    assert counted > 40 * took, (counted, took)


def test_ctrl_c_ends_the_work(tmp_path):
    program = """
import sys, isoslice as iso
part = iso.intersection(iso.gyroid(4, 0.5), iso.sphere(90))
def progress(done, all):
    print(done, flush=True)
try:
    iso.slice(part, sys.argv[1], progress=progress, time_limit=600)
except KeyboardInterrupt:
    print("interrupted", flush=True)
    # Python goes on as if nothing had been.
    print(iso.slice(iso.sphere(6)).layer_count, flush=True)
"""
    path = tmp_path / "part.gcode"
    running = subprocess.Popen(
        [sys.executable, "-W", "ignore", "-c", program, str(path)],
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(
            signal.SIGINT, signal.default_int_handler
        ),
    )
    assert running.stdout.readline().strip().isdigit()
    start = time.perf_counter()
    running.send_signal(signal.SIGINT)
    for line in running.stdout:
        if line.strip() == "interrupted":
            break
    took = time.perf_counter() - start
    rest = running.stdout.read()
    assert running.wait() == 0
    assert rest.strip() == "60"
    assert took < 5
    assert os.listdir(tmp_path) == []


def test_limits():
    with pytest.raises(iso.Stopped, match="the time limit"):
        iso.slice(SLOW, time_limit=0.2)
    with pytest.raises(iso.Stopped, match="the limit"):
        iso.slice(SLOW, memory_limit=1 << 20)
    for bad in (0, -1, math.nan):
        with pytest.raises(ValueError):
            iso.slice(SLOW, time_limit=bad)
        with pytest.raises(ValueError):
            iso.slice(SLOW, memory_limit=bad)
    part = iso.sphere(6)
    iso.slice(part, time_limit=math.inf, memory_limit=math.inf)


def test_files_are_whole_or_as_they_were(tmp_path):
    path = tmp_path / "part.gcode"
    path.write_text("old")
    with pytest.raises(iso.SliceError):
        iso.slice(iso.sphere(6), path, settings={"gcode.start": "M109 S900"})
    assert path.read_text() == "old"
    sliced = iso.slice(iso.sphere(6), path)
    assert sliced.path == path and path.read_bytes() == sliced.gcode
    assert os.listdir(tmp_path) == ["part.gcode"]
    iso.slice(iso.sphere(6)).save(tmp_path / "again.gcode")
    assert (tmp_path / "again.gcode").read_bytes() == path.read_bytes()


def test_a_pipe_stays_a_pipe(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    found = []
    thread = threading.Thread(target=lambda: found.append(path.read_bytes()))
    thread.start()
    sliced = iso.slice(iso.sphere(6), path)
    thread.join()
    assert path.is_fifo() and found == [iso.slice(iso.sphere(6)).gcode]
    for read in (lambda: sliced.gcode, sliced.preview_html):
        with pytest.raises(iso.Error, match="is no file"):
            read()


def test_an_input_is_not_overwritten(tmp_path):
    config = tmp_path / "settings.gcode"
    config.write_text("walls = 2")
    with pytest.raises(iso.Error, match="also an input"):
        iso.slice(iso.sphere(6), config, config=config)
    assert config.read_text() == "walls = 2"


def test_pictures_of_layers(tmp_path):
    iso.slice(iso.sphere(2), svg=tmp_path / "svg", layer_height=0.2)
    assert len(list((tmp_path / "svg").glob("*.svg"))) == 20


def test_a_notebook_shows_the_preview(tmp_path):
    sliced = iso.slice(iso.sphere(6), tmp_path / "a<b>.gcode")
    page = sliced.preview_html()
    assert page.startswith("<!doctype html>") and "a&lt;b&gt;" in page
    cell = sliced._repr_html_()
    assert 'sandbox="allow-scripts"' in cell
    # The page stands in an attribute, so it has no quotes of its own.
    inner = cell.split('srcdoc="')[1].split('"></iframe>')[0]
    assert '"' not in inner and "<" not in inner
    import html

    assert html.unescape(inner) == page
    sliced.save_preview(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == page
    os.remove(tmp_path / "a<b>.gcode")
    with pytest.raises(iso.Error, match="cannot read"):
        sliced.preview_html()
    with pytest.raises(iso.Error, match="cannot read"):
        sliced.gcode


def test_what_there_is():
    names = [setting["name"] for setting in iso.settings()]
    assert "layer_height" in names and "speed.outer_wall" in names
    assert all(s["allowed"] and s["description"] for s in iso.settings())
    kinds = {(p["kind"], p["name"]) for p in iso.profiles()}
    assert {("printer", "prusa-mk4"), ("preset", "fine")} <= kinds
    # No setting has the name of a keyword, except for two groups.
    import inspect

    keywords = set(inspect.signature(iso.slice).parameters)
    first = {name.split(".")[0] for name in names}
    assert keywords & first == {"printer", "filament"}


def test_values_that_make_no_sense():
    ball = iso.sphere(6)
    junk = [None, "", "a", b"a", -1, 10**30, math.nan, [], {}, object(), x, True]
    junk += [[1, 2, 3], {"a": 1}, lambda: 1, (1, "b"), [[0] * 3, [math.nan] * 3]]
    keywords = (
        "params name settings printer filament preset profiles config size "
        "scale height lay rotate at keep_position bounds layers format report "
        "check svg threads time_limit memory_limit progress walls speed"
    ).split()
    fine = []
    for keyword in keywords:
        for value in junk:
            if keyword == "svg" or (keyword == "threads" and value is True):
                continue
            try:
                iso.slice(ball, **{"layers": 1, keyword: value})
                fine.append(keyword)
            except Exception as error:
                assert type(error).__name__ != "PanicException"
                assert "bug" not in str(error), (keyword, value, error)
    # None is what is not given, and few others make sense.
    assert len(fine) < 3 * len(keywords)
    for value in junk:
        if value is not x:
            with pytest.raises((TypeError, ValueError, iso.Error, OSError)):
                iso.slice(value)
    with pytest.raises(TypeError, match="together"):
        iso.slice(ball, size=3, scale=2)
    with pytest.raises(TypeError, match="params"):
        iso.slice(ball, params={"a": 1})


def test_what_makes_a_field():
    class Part:
        def __isoslice__(self):
            return iso.sphere(6)

    class NoPart:
        def __isoslice__(self):
            return 3

    assert iso.slice(Part()).gcode == iso.slice(iso.sphere(6)).gcode
    assert (Part() | iso.sphere(2))(0, 0, 0) == -6
    assert iso.union(Part(), iso.sphere(2))(0, 0, 0) == -6
    assert (iso.sphere(2) | Part())(0, 0, 0) == -6
    with pytest.raises(TypeError, match="__isoslice__"):
        iso.slice(NoPart())


def test_empty_groups_and_impossible_shapes_are_errors():
    ball = iso.sphere(5)
    for settings, name in [
        ({"speed": {"a": {}}}, "speed.a"),
        ({"speeed": {}}, "speeed"),
        ({"walls": {}}, "walls"),
    ]:
        with pytest.raises(iso.SettingsError, match=name):
            iso.slice(ball, settings=settings)
    with pytest.raises(iso.ModelError, match="radius must be a number above 0"):
        iso.sphere(-1)
