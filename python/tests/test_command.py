"""Promise: the command of the wheel is the program: what it prints, its exit codes, its end by a signal."""

import shutil
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import pytest

COMMAND = Path(sysconfig.get_path("scripts")) / ("gonio.exe" if sys.platform == "win32" else "gonio")


def both(binary, *words):
    run = [subprocess.run([program, *words], capture_output=True) for program in (COMMAND, binary)]
    return [(ended.returncode, ended.stdout, ended.stderr) for ended in run]


def test_answers_are_the_programs(binary, campaign, tmp_path):
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(campaign.read_text().replace("alpha = 0.3", "alpha = -1"))
    words = [
        ["--version"],
        ["--help"],
        [],
        ["measure"],
        ["check", campaign],
        ["check", wrong],
        ["validate", tmp_path / "nowhere.exr"],
    ]
    codes = []
    for one in words:
        python, program = both(binary, *one)
        assert python == program, one
        codes.append(python[0])
    assert codes == [0, 0, 2, 2, 0, 2, 3]


def test_a_reader_that_goes_away_ends_the_printing_alone(campaign):
    shell = shutil.which("bash")
    if shell is None:
        pytest.skip("no bash")
    line = f"'{COMMAND}' check '{campaign}' | head -n 1; echo ${{PIPESTATUS[0]}}"
    ended = subprocess.run([shell, "-c", line], capture_output=True, text=True)
    assert ended.stdout.splitlines()[-1] == "0" and ended.stderr == ""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_it_as_the_program(campaign, tmp_path, number):
    long = campaign.read_text().replace("16_384", "100_000_000")
    campaign.write_text(long)
    words = [COMMAND, "measure", campaign, "-o", tmp_path / "out"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        # The plan is printed before the first ray is traced.
        assert process.stdout.readline()
        time.sleep(1.5)
        process.send_signal(number)
        _, said = process.communicate(timeout=30)
    finally:
        process.kill()
    assert process.returncode == 130
    assert said.splitlines()[-1].startswith("interrupted "), said
    assert "--resume" in said and "Traceback" not in said
