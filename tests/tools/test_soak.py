"""What grows is told from what does not, of every process of a run."""

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

import surefoot.config.deployment as deployment_module
from surefoot.bus.topics import PROCESSES
from surefoot.tools.process_tree import Held, held_below
from surefoot.tools.soak import growth, soak

CONFIG = Path(deployment_module.__file__).parent / "planks_emulated.toml"


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as each:
        each.bind(("127.0.0.1", 0))
        return each.getsockname()[1]


def samples(rss_mb, files):
    return [{"io": Held(mb, count)} for mb, count in zip(rss_mb, files, strict=True)]


def test_what_is_taken_at_the_start_is_no_growth():
    (io,) = growth(samples([50.0, 90.0, 100.0, 100.0, 104.0, 104.0, 104.0, 104.0], [8] * 8))
    assert io.flat and io.rss_mb == (100.0, 104.0) and io.samples == 8


@pytest.mark.parametrize(
    ("rss_mb", "files"), [([100, 100, 110, 120], [8, 8, 8, 8]), ([100, 100, 100, 100], [8, 8, 9, 9])]
)
def test_memory_and_files_that_become_more_are(rss_mb, files):
    (io,) = growth(samples(rss_mb, files))
    assert not io.flat and "GREW" in str(io)


def test_a_process_is_told_by_its_name_in_the_run():
    sleeps = [
        sys.executable,
        "-c",
        "import sys, time; print(flush=True); time.sleep(60)",
        "child",
        "x.toml",
        "mpc",
    ]
    with subprocess.Popen(sleeps, stdout=subprocess.PIPE) as process:
        process.stdout.readline()
        held = held_below(os.getpid())["mpc"]
        process.kill()
    assert held.rss_mb > 1.0 and held.files >= 3


def test_a_run_with_an_emulator_is_sampled_to_its_end(tmp_path):
    settings = ["terrain.kind=flat", f"run.namespace=soak-{os.getpid()}", f"hw.aliengo.port={free_port()}"]
    settings += ["hw.aliengo.local_port=0", "run.command=stand", "mpc.profile=light"]
    code, found = soak(CONFIG, settings, 1.0, 0.5, tmp_path, lambda words: None)
    said = (tmp_path / "run.txt").read_text()
    assert code == 0 and "time is up" in said, said
    assert "the robot has not stood" in (tmp_path / "emulator.txt").read_text()  # the truth, told when it is ended
    rows = (tmp_path / "samples.csv").read_text()
    assert all(f",{name}," in rows for name in (*PROCESSES, "supervisor", "guardian", "emulator"))
    assert {each.name for each in found} >= {"emulator", "supervisor"}
