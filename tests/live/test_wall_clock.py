"""The clock on the wall may jump, by a correction over the network or by hand: nothing of a run goes by it."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from live_bytes import assert_same_bytes

COMPILER = shutil.which("cc")
pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")


@pytest.fixture
def jumping(tmp_path, monkeypatch):
    """Every process that is started sees a wall clock that jumps by hours each second."""
    library = tmp_path / "wall_clock.so"
    source = Path(__file__).with_name("wall_clock.c")
    subprocess.run([COMPILER, "-shared", "-fPIC", "-O1", "-o", library, source], check=True)
    monkeypatch.setenv("LD_PRELOAD", str(library))
    say = "import time; [print(time.time()) or time.sleep(0.5) for _ in range(6)]"
    seen = subprocess.run([sys.executable, "-c", say], check=True, capture_output=True, text=True).stdout
    assert max(abs(float(line) - time.time()) for line in seen.split()) > 3000.0
    assert "LD_PRELOAD" in os.environ


def test_with_simulated_time_no_byte_changes(jumping, stack):
    live = stack(leave_out=("trajopt",))
    live.begin(b"forward")
    live.wait(lambda: live.t() >= 0.6)
    live.restart("mpc")
    live.go_on(0.2)
    assert_same_bytes(live)
    assert not any(status.bad_messages for status in live.status.values())


def test_in_real_time_the_run_goes_on(jumping, supervised):
    live = supervised("run.clock=monotonic", 'run.command=""')
    pids = live.pids()
    live.go_on(7.0)
    assert live.run.poll() is None and live.pids() == pids
    assert not any(status.bad_messages for status in live.status.values())
