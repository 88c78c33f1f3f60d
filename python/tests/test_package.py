"""Promises: what is typed is right, everything public says what it is, and nothing heavy is imported before it is used."""

import inspect
import subprocess
import sys
from pathlib import Path

import gonio
import pytest


def test_types_are_checked(tmp_path):
    pytest.importorskip("mypy")
    folder = Path(gonio.__file__).parent
    assert (folder / "py.typed").is_file()
    words = [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "-p", "gonio"]
    ended = subprocess.run(words, capture_output=True, text=True, cwd=tmp_path)
    assert ended.returncode == 0, ended.stdout


def test_everything_public_is_described():
    for name in gonio.__all__:
        thing = getattr(gonio, name)
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing) and not issubclass(thing, Exception):
            members = [member for member in vars(thing) if not member.startswith("_")]
            assert all(inspect.getdoc(inspect.getattr_static(thing, member)) for member in members), name


def test_the_command_starts_without_numpy():
    program = "import sys, gonio.__main__; sys.exit('numpy' in sys.modules or 'xarray' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program]).returncode == 0
