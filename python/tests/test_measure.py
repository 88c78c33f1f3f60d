"""Promises: a measurement from Python is the command's, byte by byte, however its campaign is given; what the program
refuses is an exception with its own line; other threads go on meanwhile, and Ctrl-C is answered within a second."""

import signal
import subprocess
import sys
import threading
import time

import gonio
import numpy as np
import pytest
from conftest import CAMPAIGN

# Summary, page and card tell times besides.
DATA = ("small.exr", "small.realisations.exr")
DOCUMENT = {
    "name": "small",
    "seed": np.int64(3),
    "surface": {"realisations": 4, "cells": 64, "ggx": {"alpha": np.float64(0.3)}},
    "light": {"theta_i_deg": np.array([0, 60])},
    "sensor.hemisphere": {"theta_r_bins": 9, "phi_r_bins": 18, "bins": "centred"},
    "optics": {"material": "gold"},
    "stop.samples": 16_384,
}
# Minutes of work: nothing that is ended after a second has come to its end before.
LONG = {"surface.cells": 256, "surface.realisations": 64, "stop.samples": 1 << 24}


def data(folder):
    return [(folder / name).read_bytes() for name in DATA]


def test_files_are_the_commands(binary, campaign, tmp_path):
    subprocess.run([binary, "measure", campaign, "-o", tmp_path / "command"], check=True, capture_output=True)
    gonio.measure(campaign, output=tmp_path / "python", progress=False)
    assert data(tmp_path / "python") == data(tmp_path / "command")
    names = {path.name for path in (tmp_path / "command").iterdir()}
    assert {path.name for path in (tmp_path / "python").iterdir()} == names


def test_path_text_document_and_threads_give_the_same_bytes(campaign, tmp_path):
    given = [str(campaign), CAMPAIGN, DOCUMENT, {"stop": {"samples": 4096}, **DOCUMENT}]
    for number, one in enumerate(given):
        gonio.measure(one, output=tmp_path / str(number), threads=1 + number % 2, progress=False)
        assert data(tmp_path / str(number)) == data(tmp_path / "0"), one


def test_overrides_are_keys_of_the_campaign(binary, campaign, tmp_path):
    changed = CAMPAIGN.replace("alpha = 0.3", "alpha = 0.2").replace("seed = 3", "seed = 5")
    changed = changed.replace("[surface.ggx]", "[surface.beckmann]")
    (tmp_path / "changed.toml").write_text(changed)
    command = [binary, "measure", tmp_path / "changed.toml", "-o", tmp_path / "command"]
    subprocess.run(command, check=True, capture_output=True)
    surface = {"ggx": None, "beckmann": {"alpha": 0.2}}
    gonio.measure(campaign, output=tmp_path / "python", seed=5, surface=surface, progress=False)
    assert data(tmp_path / "python") == data(tmp_path / "command")


def test_without_a_folder_files_live_as_long_as_the_measurement(tmp_path):
    measurement = gonio.measure(CAMPAIGN, progress=False)
    path, saved = measurement.path, measurement.save(tmp_path / "saved")
    assert path.is_file() and saved.dataset.identical(measurement.dataset)
    with pytest.raises(gonio.FileError, match="is there already"):
        measurement.save(tmp_path / "saved")
    del measurement
    assert not path.exists() and saved.path.is_file()


def test_several_tables_are_a_list(tmp_path):
    lists = {"surface.ggx.alpha": [0.2, 0.4], "stop.samples": 4096}
    with pytest.raises(gonio.UsageError, match="2 tables"):
        gonio.measure(CAMPAIGN, output=tmp_path, progress=False, **lists)
    assert list(tmp_path.iterdir()) == []
    both = gonio.measure_all(CAMPAIGN, output=tmp_path, progress=False, **lists)
    assert [one.path.name for one in both] == ["small_alpha_0.2.exr", "small_alpha_0.4.exr"]


def test_faults_of_a_campaign_are_all_named(binary, campaign):
    campaign.write_text(CAMPAIGN.replace("alpha = 0.3", "alpha = 0").replace("cells = 64", "cells = 1"))
    with pytest.raises(gonio.CampaignError) as caught:
        gonio.measure(campaign, progress=False)
    ended = subprocess.run([binary, "check", campaign], capture_output=True, text=True)
    said = [line.removeprefix("error: ") for line in ended.stderr.splitlines() if line.startswith("error: ")]
    assert str(caught.value).splitlines() == said and len(said) == 2
    assert caught.value.exit_code == ended.returncode == 2
    assert [fault["key"] for fault in caught.value.faults] == ["surface.cells", "surface.ggx.alpha"]
    assert all(fault["line"] for fault in caught.value.faults)
    with pytest.raises(ValueError, match="surface.ggx.alpha = 0: "):
        gonio.measure(CAMPAIGN, progress=False, **{"surface.ggx.alpha": 0})


def test_refusals_have_their_own_class(campaign, tmp_path, small):
    with pytest.raises(gonio.FileError, match="nowhere.toml: No such file"):
        gonio.measure(tmp_path / "nowhere.toml", progress=False)
    with pytest.raises(gonio.FileError, match="nowhere.exr: No such file"):
        gonio.load(tmp_path / "nowhere.exr")
    with pytest.raises(gonio.FileError, match="measured by another campaign or seed"):
        gonio.measure(campaign, output=small.path.parent, seed=4, progress=False)
    with pytest.raises(gonio.RefusedError):
        gonio.measure(campaign, memory_mb=1, progress=False, **{"surface.cells": 4096})
    with pytest.raises(gonio.UsageError, match="known formats are npz"):
        small.export(tmp_path / "table", "nothing")
    (tmp_path / "damaged.exr").write_bytes(small.path.read_bytes()[:-100])
    with pytest.raises(gonio.FileError, match="damaged.exr"):
        gonio.load(tmp_path / "damaged.exr")


def test_a_budget_is_that_of_the_command(binary, campaign, tmp_path):
    import json

    keys = {"uncertainty": {"reading": {"u": 0.002}, "at": [[30, 0, 45, 180]], "aperture_deg": 4, "trials": 200_000}}
    with pytest.raises(gonio.UsageError, match="uncertainty: required"):
        gonio.budget(campaign)
    found = gonio.budget(campaign, **keys)
    text = campaign.read_text() + "[uncertainty]\nreading = { u = 0.002 }\nat = [[30, 0, 45, 180]]\naperture_deg = 4\ntrials = 200_000\n"
    (tmp_path / "same.toml").write_text(text)
    ended = subprocess.run([binary, "budget", tmp_path / "same.toml", "--json"], capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert found == json.loads(ended.stdout) and found["values"]


def test_what_the_program_warns_of_is_a_warning(campaign):
    arm = {"hemisphere": None, "arm": {"theta_r_deg": [0], "aperture_deg": 1.0}}
    with pytest.warns(gonio.GonioWarning, match="the sensor stands where the lamp is") as seen:
        gonio.measure(campaign, progress=False, sensor=arm)
    assert seen[0].filename == __file__


def test_stored_tables_answer_as_the_commands_do(binary, small, tmp_path):
    import json

    def command(*words):
        ended = subprocess.run([binary, *words, "--json"], capture_output=True, text=True)
        return json.loads(ended.stdout)

    assert small.validate() == command("validate", small.path)
    assert small.fit("ggx") == command("fit", small.path, "--model", "ggx")
    assert small.appearance() == command("appearance", small.path)
    answer = small.export(tmp_path / "python.npz", "npz")
    assert answer["read_back"]["l1"] == 0
    command("export", small.path, "--to", "npz", "-o", tmp_path / "command.npz")
    assert (tmp_path / "python.npz").read_bytes() == (tmp_path / "command.npz").read_bytes()
    page = small.report(tmp_path / "page.html")
    assert page.read_text("utf-8").startswith("<!DOCTYPE html>")


def test_progress_counts_to_the_end(campaign):
    seen = []
    measurement = gonio.measure(campaign, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (measurement.summary["cost"]["samples"],) * 2
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)


def test_other_threads_go_on_meanwhile(campaign):
    counted, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    during = []
    try:
        gonio.measure(
            campaign,
            progress=lambda *_: during.append(counted[0]),
            **{"surface.cells": 256, "stop.samples": 1 << 18},
        )
    finally:
        over.set()
        thread.join()
    # Under a lock that is kept, the count would stand still from one look to the next.
    assert len(during) > 2 and during[-1] > during[0] + 2, during


PROGRAM = """
import signal, sys, time, gonio
# A shell's background jobs ignore SIGINT.
signal.signal(signal.SIGINT, signal.default_int_handler)
def begun(done, total):
    if total:
        print("begun", flush=True)
try:
    gonio.measure(sys.argv[1], output=sys.argv[2], progress=begun, **{LONG})
except KeyboardInterrupt:
    print("caught", flush=True)
    time.sleep(60)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
def test_ctrl_c_is_answered_within_a_second(campaign, tmp_path):
    words = [sys.executable, "-c", PROGRAM.replace("{LONG}", repr(LONG)), campaign, tmp_path / "out"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "begun\n"
        time.sleep(1.5)
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        while (line := process.stdout.readline()) == "begun\n":
            pass
        took = time.monotonic() - begin
        assert line == "caught\n" and took < 1.0, took
        # The thread that measures keeps what it has, in its own time.
        deadline = time.monotonic() + 30
        while not (kept := list((tmp_path / "out").glob("*checkpoint*"))) and time.monotonic() < deadline:
            time.sleep(0.1)
        assert kept, list((tmp_path / "out").iterdir())
    finally:
        process.kill()
        process.wait()


def test_a_run_that_was_ended_resumes_to_the_same_bytes(campaign, tmp_path, caplog):
    # Some seconds of work, of which more than half is done when it is ended.
    keys = {"surface.cells": 256, "surface.realisations": 8, "stop.samples": 1 << 18}

    def end(done, total):
        if done > 0.6 * total > 0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        gonio.measure(campaign, output=tmp_path / "ended", progress=end, **keys)
    with pytest.raises(gonio.GonioError, match="resume"):
        once_it_is_free(campaign, tmp_path / "ended", **keys)
    caplog.set_level("INFO", "gonio")
    once_it_is_free(campaign, tmp_path / "ended", resume=True, **keys)
    assert any("resumes" in record.message for record in caplog.records)
    gonio.measure(campaign, output=tmp_path / "whole", progress=False, **keys)
    assert data(tmp_path / "ended") == data(tmp_path / "whole")


def once_it_is_free(campaign, folder, **options):
    """Measures into a folder that the run before may still be leaving."""
    deadline = time.monotonic() + 60
    while True:
        try:
            return gonio.measure(campaign, output=folder, progress=False, **options)
        except gonio.GonioError as error:
            if "is writing this output" not in str(error) or time.monotonic() > deadline:
                raise
        time.sleep(0.05)
