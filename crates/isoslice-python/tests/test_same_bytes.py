"""The wheel writes what the command line writes."""

import isoslice as iso
import numpy as np
import pytest
from conftest import ROOT
from isoslice import x, y, z

BALL = "sqrt(x^2 + y^2 + z^2) - 6"
pytestmark = pytest.mark.filterwarnings("ignore::isoslice.SliceWarning")


def ball():
    return iso.sqrt(x**2 + y**2 + z**2) - 6


def by_program(program, tmp_path, *words, name="part.gcode"):
    path = tmp_path / f"by-program-{name}"
    done = program.run("slice", *words, "-o", path)
    assert done.returncode == 0, done.stderr.decode()
    return path.read_bytes()


def test_a_formula(program, tmp_path):
    wanted = by_program(program, tmp_path, "-e", BALL)
    assert wanted.count(b";LAYER_CHANGE") == 60
    assert iso.slice(iso.formula(BALL)).gcode == wanted
    # A field made by operators is that of the formula.
    assert iso.slice(ball()).gcode == wanted
    # numpy's functions make it, too.
    with_numpy = np.sqrt(np.power(x, 2) + np.square(y) + z**2.0) - np.int64(6)
    assert iso.slice(with_numpy).gcode == wanted


def test_powers_and_functions(program, tmp_path):
    formula = (
        "max(abs(x)^2.5 + y^4 + 2^(z/9) - 300, max(abs(z) - 3, "
        "3*sin(x/2)*cos(y/2) - 4 + (x % 3)/2 - atan2(y, 20)))"
    )
    field = iso.max(
        abs(x) ** 2.5 + y**4 + 2 ** (z / 9) - 300,
        abs(z) - 3,
        3 * iso.sin(x / 2) * iso.cos(y / 2)
        - 4
        + (x % 3) / 2
        - iso.atan2(y, 20),
    )
    # The formula's own nesting.
    nested = iso.max(
        abs(x) ** 2.5 + y**4 + 2 ** (z / 9) - 300,
        iso.max(
            abs(z) - 3,
            3 * iso.sin(x / 2) * iso.cos(y / 2)
            - 4
            + (x % 3) / 2
            - iso.atan2(y, 20),
        ),
    )
    wanted = by_program(program, tmp_path, "-e", formula)
    assert iso.slice(nested).gcode == wanted
    assert field(1, 2, 3) == nested(1, 2, 3)


def test_a_script_with_parameters_settings_and_profiles(program, tmp_path):
    model = ROOT / "examples" / "gear.rhai"
    wanted = by_program(
        program,
        tmp_path,
        model,
        "-D",
        "teeth=15",
        "-D",
        "module=1.5",
        "--printer",
        "prusa-mk4",
        "--filament",
        "petg",
        "--preset",
        "draft",
        "--layers",
        "3..9",
        "--set",
        "speed.outer_wall=31.5",
        "--set",
        "infill_density=20%",
        "--set",
        "supports=off",
        "--size",
        "30",
        "--rotate-z",
        "20",
    )
    path = tmp_path / "part.gcode"
    sliced = iso.slice(
        str(model),
        path,
        params={"teeth": 15, "module": 1.5},
        printer="prusa-mk4",
        filament="petg",
        preset="draft",
        layers=(3, 9),
        settings={"speed": {"outer_wall": 31.5}, "infill_density": "20%"},
        supports="off",
        size=30,
        rotate=(0, 0, 20),
    )
    assert path.read_bytes() == wanted == sliced.gcode
    assert sliced.layers == (3, 9)
    assert [p.name for p in tmp_path.glob(".isoslice*")] == []
    # The model may also be read first.
    again = iso.slice(
        iso.load(model, {"teeth": 15, "module": 1.5}),
        printer="prusa-mk4",
        filament="petg",
        preset="draft",
        layers="3..9",
        settings={"speed.outer_wall": 31.5, "infill_density": 20},
        supports="off",
        size=30,
        rotate=(0, 0, 20),
        threads=1,
    )
    assert again.gcode == wanted


def test_a_template_with_lines_and_quotes(program, tmp_path):
    start = 'G28 ; "home" \\ all\nG92 E0'
    config = tmp_path / "my.toml"
    config.write_text(f"[gcode]\nstart = '''{start}'''\n")
    wanted = by_program(program, tmp_path, "-e", BALL, "--config", config)
    assert b'; "home" \\ all\n' in wanted
    assert iso.slice(ball(), settings={"gcode.start": start}).gcode == wanted
    assert iso.slice(ball(), config=config).gcode == wanted
    assert iso.slice(ball(), config=[str(config)]).gcode == wanted


@pytest.mark.parametrize("format", ["bgcode", "gcode.3mf"])
def test_formats(program, tmp_path, format):
    printer = "prusa-mk4" if format == "bgcode" else "bambu-a1"
    wanted = by_program(
        program,
        tmp_path,
        "-e",
        BALL,
        "--printer",
        printer,
        name=f"part.{format}",
    )
    path = tmp_path / f"part.{format}"
    iso.slice(ball(), path, printer=printer)
    assert path.read_bytes() == wanted
    assert iso.slice(ball(), printer=printer, format=format).gcode == wanted


def test_a_vm_text(program, tmp_path):
    text = "_0 var-x\n_1 square _0\n_2 var-y\n_3 square _2\n_4 add _1 _3\n"
    text += "_5 const 36\n_6 sub _4 _5\n_7 var-z\n_8 abs _7\n_9 const 2\n"
    text += "_a sub _8 _9\n_b max _6 _a\n"
    model = tmp_path / "disc.vm"
    model.write_text(text)
    wanted = by_program(program, tmp_path, model)
    assert iso.slice(model).gcode == wanted
    assert iso.slice(iso.vm(text), name="disc").gcode == wanted


def test_the_summary_is_that_of_json(program, tmp_path):
    import json

    path = tmp_path / "json.gcode"
    done = program.run("slice", "-e", BALL, "-o", path, "--json")
    told = json.loads(done.stdout)
    sliced = iso.slice(ball())
    assert sliced.time == told["print_time_s"]
    assert sliced.filament_length == told["filament_mm"]
    assert sliced.filament_mass == told["filament_g"]
    assert list(sliced.size) == told["size_mm"]
    assert sliced.layer_count == told["layer_count"]
    assert sliced.outline_error["p99"] == told["outline_p99_um"]
    assert sliced.wall_error["p99"] == told["outer_wall_p99_um"]
    assert sliced.printing_moves == told["printing_moves"]
    assert sliced.solid_area == told["area_mm2"]
    assert sliced.roles == told["roles"]
    assert sliced.hanging == told["hanging"]
    assert sliced.time_lost == told["time_lost_s"]
    assert set(sliced.warnings) == set(told["warnings"])
    assert sliced.checked


def test_the_report_is_that_of_the_command_line(program, tmp_path):
    import json

    path = tmp_path / "report.json"
    by_program(program, tmp_path, "-e", BALL, "--report", path)
    wanted = json.loads(path.read_text())
    report = iso.slice(ball(), report=True).report
    assert report == wanted
    assert report["outline_um"]["max"] <= 5
    assert iso.slice(ball()).report is None


def test_errors_have_the_words_of_the_command_line(program, tmp_path):
    missing = tmp_path / "missing.rhai"
    broken = tmp_path / "broken.rhai"
    broken.write_text("let a = 1;\nsphare(10)\n")
    cases = [
        (iso.ModelError, ["-e", "x +"], lambda: iso.slice(iso.formula("x +"))),
        (iso.ModelError, ["-e", "x"], lambda: iso.slice(x)),
        (iso.ModelError, [missing], lambda: iso.slice(missing)),
        (iso.ModelError, [broken], lambda: iso.slice(broken)),
        (
            iso.ModelError,
            ["-e", BALL, "--size", "900"],
            lambda: iso.slice(ball(), size=900),
        ),
        (
            iso.SettingsError,
            ["-e", BALL, "--set", "layer_hight=1"],
            lambda: iso.slice(ball(), layer_hight=1),
        ),
        (
            iso.SettingsError,
            ["-e", BALL, "--set", "layer_height=9"],
            lambda: iso.slice(ball(), layer_height=9),
        ),
        (
            iso.SettingsError,
            ["-e", BALL, "--printer", "prusa-mk44"],
            lambda: iso.slice(ball(), printer="prusa-mk44"),
        ),
        (
            iso.SliceError,
            ["-e", BALL, "--layers", "900.."],
            lambda: iso.slice(ball(), layers="900.."),
        ),
        (
            iso.SliceError,
            ["-e", BALL, "--set", "gcode.start=M109 S900"],
            lambda: iso.slice(ball(), settings={"gcode.start": "M109 S900"}),
        ),
        (
            iso.Error,
            ["-e", BALL, "-o", tmp_path],
            lambda: iso.slice(ball(), tmp_path),
        ),
        (
            iso.Error,
            ["-e", BALL, "-o", tmp_path / "no" / "a.gcode"],
            lambda: iso.slice(ball(), tmp_path / "no" / "a.gcode"),
        ),
        (
            iso.Error,
            ["-e", BALL, "-o", tmp_path / "a.stl"],
            lambda: iso.slice(ball(), tmp_path / "a.stl"),
        ),
        (
            iso.Error,
            ["-e", BALL, "--profiles", tmp_path / "no"],
            lambda: iso.slice(ball(), profiles=tmp_path / "no"),
        ),
    ]
    for kind, words, call in cases:
        if "-o" not in words:
            words = [*words, "-o", tmp_path / "error.gcode"]
        wanted = program.error("-q", "slice", *words)
        with pytest.raises(iso.Error) as raised:
            call()
        assert str(raised.value) == wanted, words
        assert type(raised.value) is kind, words
    assert not (tmp_path / "error.gcode").exists()
