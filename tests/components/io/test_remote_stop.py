"""Buttons of the emulated robot's remote, over its wire, through io, to every process in lockstep."""

from dataclasses import replace

import pytest
from emulation import emulator
from machines import deployment

from surefoot.components.lockstep import Lockstep
from surefoot.config.emulator import Press

HELD_S = 0.8  # it is standing up then


@pytest.mark.parametrize(
    ("buttons", "states", "reason"),
    [
        (("L2", "B"), ["STAND_UP", "SIT_DOWN", "DAMP"], "sitting: buttons of the remote"),
        (("L1", "L2", "R1", "R2"), ["STAND_UP", "DAMP"], "cut by command"),
    ],
)
def test_a_chord_on_the_remote_stops_the_robot(buttons, states, reason):
    settings = deployment("cycle")
    press = Press(buttons, HELD_S, HELD_S + 0.5)
    with emulator(replace(settings, emulator=replace(settings.emulator, presses=(press,)))) as emulation:
        stack = Lockstep(emulation.deployment)
        commands, references, hardware = [], [], []
        heard = {"operator/command": commands, "fsm/reference": references, "hw/state": hardware}
        stack.listen(lambda key, message: heard[key].append(message) if key in heard else None)
        stack.command("stand")
        stack.run(6.0, lambda: stack.t > HELD_S and references[-1].state == "DAMP")
        stack.run(stack.t + 0.1)
        stack.components["io"].robot.close()
    seen = [each.state for each in references]
    assert [state for state, before in zip(seen, ["DAMP", *seen], strict=False) if state != before] == states
    assert references[-1].reason == reason
    assert len(commands) == 2 and abs(commands[1].t - HELD_S) < 0.01
    assert ("cut" in hardware[-1].gate) == (reason == "cut by command")
