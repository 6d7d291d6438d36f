"""An emulator for the time of a test."""

from contextlib import contextmanager

from surefoot.hw.emulator.emulation import Emulation

PATIENT = {"address": "127.0.0.1", "local_port": 0, "first_answer_s": 60.0}
"""Settings of a link whose ends are in no hurry."""


@contextmanager
def emulator(deployment, prepare=lambda plant: None):
    """An emulation; `prepare` is given its simulated robot before anything moves."""
    emulation = Emulation(deployment, prepare)
    try:
        yield emulation
    finally:
        emulation.switch_off()
