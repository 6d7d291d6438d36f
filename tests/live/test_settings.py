"""What runs on another machine than io joins it only with the same settings."""

import socket
import subprocess
import sys
from pathlib import Path

from surefoot.bus.topics import PROCESSES

CLI = [sys.executable, "-P", "-m", "surefoot.tools.cli"]


def network():
    """Settings of two machines that are one, without keys."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    hosts = (
        'network.hosts={robot = ["io", "estimator", "wbc", "mpc", "fsm"], laptop = ["trajopt", "elevation_map"]}'
    )
    return hosts, f"network.listen=tcp/127.0.0.1:{port}", "network.address=127.0.0.1", "network.insecure=true"


def test_one_with_other_settings_ends_at_once_and_says_which_and_its_supervisor_starts_none(stack):
    live = stack(network(), leave_out=PROCESSES)
    live.wait(lambda: "io" in live.status)
    live.overrides += ["network.host=laptop", f"run.log_dir={live.config.parent / 'logs'}"]
    live.start("elevation_map")
    live.wait(lambda: "elevation_map" in live.status)
    assert live.status["elevation_map"].settings == live.status["io"].settings != ""

    live.overrides.append("hw.seed=3")
    live.start("trajopt")
    assert live.children["trajopt"].wait() == 2
    words = "has other settings than io: hw.seed = 3, not 0; give every machine the same file and the same --set"
    log = Path(live.log.name).read_text()
    assert f"surefoot: trajopt {words}" in log and "Traceback" not in log

    settings = [word for setting in live.overrides for word in ("--set", setting)]
    run = subprocess.run([*CLI, "run", str(live.config), "--plain", *settings], capture_output=True, text=True)
    assert run.returncode == 2 and f"surefoot: laptop {words}" in run.stderr
