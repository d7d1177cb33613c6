"""What the guide and the notebook say runs."""

import ast
import json
import re

import pytest
from conftest import ROOT

pytestmark = pytest.mark.filterwarnings("ignore::isoslice.SliceWarning")


def test_the_guide_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.S | re.M)
    assert len(blocks) == 6
    names = {}
    for block in blocks:
        exec(block, names)
    assert "150 layers" not in capsys.readouterr().err
    written = {"part.gcode", "out.gcode", "plate.gcode"}
    assert {p.name for p in tmp_path.iterdir()} == written


def test_the_guide_names_all_of_sdf():
    from isoslice import sdf

    page = (ROOT / "docs" / "python.md").read_text()
    there = page.split("What is there:")[1].split("What is not there:")[0]
    words = set(re.findall(r"`@?\.?(\w+)", there))
    operations = {
        name
        for kind in (sdf.SDF2, sdf.SDF3)
        for name in dir(kind)
        if not name.startswith("_") and name != "expr"
    }
    helpers = {"SDF2", "SDF3", "Vec", "X", "Y", "Z", "UP", "ORIGIN", "ease"}
    helpers |= {"pi", "degrees", "radians"}
    names = (set(sdf.__all__) | operations) - helpers
    assert {name for name in names if name not in words} == set()
    missing = page.split("What is not there:")[1]
    assert all(f"`{n}" in missing for n in ("text", "image", "wrap_around"))


def test_the_notebook_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = ROOT / "examples" / "python.ipynb"
    assert path.stat().st_size < 100_000
    notebook = json.loads(path.read_text())
    names, previews = {}, 0
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        program = ast.parse("".join(cell["source"]))
        last = program.body[-1]
        shows = isinstance(last, ast.Expr)
        if shows:
            program.body.pop()
        exec(compile(program, "cell", "exec"), names)
        if shows:
            # What a notebook shows: the last line's value.
            shown = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
            if hasattr(shown, "_repr_html_"):
                assert "<iframe" in shown._repr_html_()
                previews += 1
    assert previews == 1
