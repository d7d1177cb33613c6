"""What the tests share: the program to compare with, and some models."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]


class Program:
    """The command line."""

    def __init__(self, path):
        self.path = path

    def run(self, *words, **options):
        command = [self.path, *map(str, words)]
        return subprocess.run(command, capture_output=True, **options)

    def error(self, *words):
        """What it writes behind `error: `."""
        done = self.run(*words)
        assert done.returncode == 1, done
        text = done.stderr.decode()
        at = text.index("error: ")
        return text[at + len("error: ") :].rstrip("\n")


@pytest.fixture(scope="session")
def program():
    """ISOSLICE names the program; tests/run.sh sets it."""
    path = os.environ.get("ISOSLICE")
    if not path:
        pytest.skip("ISOSLICE does not name the program isoslice")
    return Program(path)


@pytest.fixture(autouse=True)
def own_profiles(monkeypatch, tmp_path):
    """No test reads the profiles of whoever runs it."""
    monkeypatch.setenv("ISOSLICE_PROFILES", str(tmp_path / "none"))
