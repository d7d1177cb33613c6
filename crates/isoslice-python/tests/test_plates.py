"""Plates: several models, copies, places and plate files."""

import isoslice as iso
import pytest
from conftest import ROOT
from isoslice import Part, x, y, z

GEAR = ROOT / "examples" / "gear.rhai"
KNOB = ROOT / "examples" / "threaded-knob.rhai"
LAYERS = "10..14"
pytestmark = pytest.mark.filterwarnings("ignore::isoslice.SliceWarning")


def by_program(program, tmp_path, *words):
    path = tmp_path / "by-program.gcode"
    done = program.run("slice", *words, "--layers", LAYERS, "-o", path)
    assert done.returncode == 0, done.stderr.decode()
    return path.read_bytes()


def sliced(model, **keywords):
    return iso.slice(model, layers=LAYERS, **keywords)


PLATE = f"""
settings = {{ layer_height = 0.25 }}

[[part]]
model = "{GEAR}"
copies = 2
params = {{ teeth = 12 }}
rotate = 30
settings = {{ walls = 3 }}

[[part]]
model = "{KNOB}"
at = [30, 40]
scale = 0.5
"""


def test_a_plate_file_and_its_parts(program, tmp_path):
    path = tmp_path / "both.toml"
    path.write_text(PLATE)
    wanted = by_program(program, tmp_path, path)
    assert b";LAYER_CHANGE" in wanted
    assert sliced(path).gcode == wanted
    assert sliced(str(path)).name == "both"
    parts = [
        Part(
            GEAR,
            copies=2,
            params={"teeth": 12},
            rotate=30,
            settings={"walls": 3},
        ),
        Part(KNOB, at=(30, 40), scale=0.5),
    ]
    by_parts = sliced(parts, name="both", layer_height=0.25)
    assert by_parts.gcode == wanted
    # Keywords win over a plate file's settings, as on the command line.
    wanted = by_program(program, tmp_path, path, "--set", "layer_height=0.2")
    assert sliced(path, layer_height=0.2).gcode == wanted


def test_copies_and_several_models(program, tmp_path):
    wanted = by_program(program, tmp_path, GEAR, KNOB, "--copies", "2")
    assert sliced([GEAR, KNOB], copies=2).gcode == wanted
    assert sliced([Part(GEAR, 2), Part(KNOB, 2)]).gcode == wanted
    wanted = by_program(program, tmp_path, GEAR, "--copies", "3", "--size", 30)
    assert sliced(GEAR, copies=3, size=30).gcode == wanted
    one = by_program(program, tmp_path, GEAR, "--copies", "1")
    assert sliced(GEAR, copies=1).gcode == one
    assert sliced(Part(GEAR)).gcode == one


def test_fields_on_a_plate():
    ball = iso.sqrt(x**2 + y**2 + z**2) - 6
    two = iso.slice([Part(ball, name="ball"), ball & (x - 2)], layers=20)
    assert b"ball" in two.gcode
    assert two.name == "ball+formula"
    # Copies of one field are sliced once, and printed twice.
    copies = iso.slice([ball, ball], layers=20)
    assert copies.gcode == iso.slice(ball, copies=2, layers=20).gcode
    alone = iso.slice(ball, layers=20)
    assert copies.printing_moves > 1.9 * alone.printing_moves


def test_what_cannot_be_on_a_plate(program, tmp_path):
    ball = iso.sqrt(x**2 + y**2 + z**2) - 6
    with pytest.raises(TypeError, match=r"Part\(model, at="):
        iso.slice([ball, ball], at=(10, 10))
    with pytest.raises(TypeError, match="size and scale"):
        iso.slice([Part(ball, size=3, scale=2)])
    with pytest.raises(TypeError, match="a model is an isoslice.Expr"):
        iso.slice([Part(3.5)])
    path = tmp_path / "plate.toml"
    path.write_text(PLATE)
    with pytest.raises(TypeError, match="is a plate file"):
        iso.slice(path, size=20)
    for model, words in [
        ([], None),
        (Part(GEAR, copies=1001), (GEAR, "--copies", "1001")),
        (Part(GEAR, at=(1, 1)), None),
    ]:
        with pytest.raises(iso.Error):
            iso.slice(model)
    # The same words as the command line.
    path.write_text(PLATE.replace("scale", "skale"))
    with pytest.raises(iso.Error) as caught:
        iso.slice(path)
    assert str(caught.value) == program.error("slice", path)


def test_a_part_has_copies_of_its_own():
    part = Part(iso.sphere(5), copies=2)
    with pytest.raises(TypeError, match="Part"):
        iso.slice(part, copies=3)
