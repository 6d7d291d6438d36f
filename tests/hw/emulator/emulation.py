"""An emulator on an ephemeral port of 127.0.0.1, served by a thread."""

from contextlib import contextmanager
from dataclasses import replace
from threading import Event, Thread

from surefoot.hw.emulator.server import EmulatorServer

PATIENT = {"address": "127.0.0.1", "local_port": 0, "first_answer_s": 60.0}
"""Settings of a link whose ends are in no hurry."""


@contextmanager
def emulator(deployment):
    """The server, and the deployment with its port in it."""
    server, ended = EmulatorServer(deployment, port=0), Event()
    thread = Thread(target=server.serve, args=(ended.is_set,), daemon=True)
    thread.start()
    wire = replace(deployment.hw.aliengo, port=server.port)
    try:
        yield server, replace(deployment, hw=replace(deployment.hw, aliengo=wire))
    finally:
        ended.set()
        thread.join()
