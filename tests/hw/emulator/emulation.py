"""An emulator on an ephemeral port of 127.0.0.1, served by a thread."""

from contextlib import contextmanager
from dataclasses import replace
from threading import Event, Thread

from surefoot.hw.emulator.server import EmulatorServer

PATIENT = {"address": "127.0.0.1", "local_port": 0, "first_answer_s": 60.0}
"""Settings of a link whose ends are in no hurry."""


class Emulation:
    """A server that is up until it is switched off.

    Attributes:
        server: what is served.
        robot: who answers.
        deployment: the one it was made of, with its port in it.
    """

    def __init__(self, deployment, prepare=lambda plant: None):
        self.server = EmulatorServer(deployment, port=0)
        self.robot = self.server.robot
        prepare(self.robot.plant)
        wire = replace(deployment.hw.aliengo, port=self.server.port)
        self.deployment = replace(deployment, hw=replace(deployment.hw, aliengo=wire))
        self._ended = Event()
        self._thread = Thread(target=self.server.serve, args=(self._ended.is_set,), daemon=True)
        self._thread.start()

    def switch_off(self):
        """From now on nobody listens at its port."""
        self._ended.set()
        self._thread.join()


@contextmanager
def emulator(deployment, prepare=lambda plant: None):
    """An emulation for the time of a test; `prepare` is given its simulated robot before anything moves."""
    emulation = Emulation(deployment, prepare)
    try:
        yield emulation
    finally:
        emulation.switch_off()
