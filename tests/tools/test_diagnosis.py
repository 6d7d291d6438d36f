"""Whoever keeps the robot from moving is named, in one sentence, from what the processes say of themselves."""

import numpy as np
import pytest

from surefoot.bus.messages import HardwareState, MotionReference, ProcessStatus
from surefoot.bus.topics import PROCESSES, nominal_hz
from surefoot.components.registry import component_class
from surefoot.tools.diagnosis import awaited, clock_stands, troubles, why_nothing_moves, worst_input
from surefoot.tools.picture import Picture
from surefoot.tools.supervisor_messages import Notice, Post

NOW = 1000.0


def status(name, **fields):
    """Of a process that is well."""
    keys = component_class(name).inputs
    hz = nominal_hz(PROCESSES[name])
    well = {"life": "RUN", "steps": 900, "rate_hz": hz, "nominal_hz": hz, "input": keys}
    return ProcessStatus(process=name, valid=True, **{**well, "input_age_s": np.full(len(keys), 0.002), **fields})


def walking(state="PROBE", reason="one more force"):
    """A picture in which all is well."""
    picture = Picture(
        reference=MotionReference(t=5.0, state=state, reason=reason), hardware=HardwareState(t=5.0, valid=True)
    )
    for name in PROCESSES:
        say(picture, name)
    return picture


def say(picture, name, heard=NOW - 0.3, **fields):
    picture.note_status(status(name, **fields))
    picture.processes[name].heard = heard


def ages(name, **by_key):
    """Ages of the inputs of a process, those named by their key with _ for /."""
    keys = component_class(name).inputs
    return np.array([by_key.get(key.replace("/", "_"), 0.002) for key in keys])


def why(picture):
    return why_nothing_moves(picture, NOW)


def test_nothing_is_said_of_a_robot_that_moves():
    picture = walking()
    assert why(picture) == "" and troubles(picture, NOW) == {}


def test_before_anything_is_heard_io_is_awaited():
    assert "io comes up first" in why(Picture())
    picture = Picture()
    picture.processes["io"].out = "ended with exit code 1 (no such terrain), see log/io.log"
    assert why(picture) == "io ended with exit code 1 (no such terrain), see log/io.log"


def test_a_process_that_never_came_is_named_before_time_begins():
    picture = walking()
    picture.processes["trajopt"].status = None
    say(picture, "io", reason="waiting for trajopt to come up")
    assert awaited(picture) == "trajopt"
    assert why(picture).startswith("simulated time waits for trajopt, which has not spoken yet")
    assert "trajopt" in troubles(picture, NOW)


@pytest.mark.parametrize("name", [name for name in PROCESSES if name != "io"])
def test_one_that_simulated_time_waits_for_is_named_with_what_is_known_of_it(name):
    picture = walking()
    say(picture, "io", reason=f"simulated time waits for {name}, 5.3 s now")
    assert why(picture) == f"simulated time waits for {name}: its step is not over yet"
    picture.processes[name].heard = NOW - 5.4
    assert why(picture) == (
        f"simulated time waits for {name}, which has been silent for 5 s: stopped, or hanging in a step"
    )
    picture.processes[name].lent_to = 4242
    assert "is lent to process 4242 and silent for 5 s: at a breakpoint?" in why(picture)
    picture.processes[name].lent_to, picture.processes[name].out = (
        0,
        "ended with signal 9; it waits for its source",
    )
    assert why(picture) == f"simulated time waits for {name}, which ended with signal 9; it waits for its source"


def test_a_slow_rate_is_nobodys_fault_while_time_stands_still():
    picture = walking()
    say(picture, "io", reason="simulated time waits for wbc, 5.3 s now")
    for _ in range(3):
        say(picture, "mpc", rate_hz=0.0)
    assert "mpc" not in troubles(picture, NOW)


def test_in_real_time_a_rate_that_stays_low_is_told_and_one_low_figure_is_not():
    picture = walking()
    say(picture, "mpc", rate_hz=31.0)
    assert troubles(picture, NOW) == {}
    say(picture, "mpc", rate_hz=32.0)
    assert troubles(picture, NOW) == {"mpc": "makes 32 of 100 steps a second"}
    say(picture, "mpc")
    assert troubles(picture, NOW) == {}


def standing_clock(io_heard_s=0.9, stood_s=0.9):
    """Simulated time that io advanced so long ago; so long ago it was heard."""
    picture = walking()
    picture.simulated = True
    say(picture, "io", heard=NOW - io_heard_s, pid=4242)
    picture.note_time()
    picture._advanced = 5.0, NOW - stood_s
    return picture


def test_an_io_that_stands_still_is_named_with_its_process_before_a_second_has_passed():
    words = "io has not advanced the clock for 0.9 s: is process 4242 stopped?"
    assert why(standing_clock()) == clock_stands(standing_clock(), NOW) == words
    assert troubles(standing_clock(), NOW) == {"io": words.removeprefix("io ")}
    picture = standing_clock(4.0, 4.0)
    for watched in picture.processes.values():
        watched.heard = NOW - 4.0  # the bus goes through io
    assert why(picture) == "io has not advanced the clock for 4.0 s: is process 4242 stopped?"
    picture.processes["io"].host = "robot"
    assert why(picture).endswith("is process 4242 stopped, or the link to robot down?")


def test_a_clock_that_goes_on_or_waits_for_another_process_is_no_fault_of_io():
    assert clock_stands(standing_clock(io_heard_s=0.3), NOW) == ""
    assert clock_stands(standing_clock(stood_s=0.1), NOW) == ""
    assert clock_stands(Picture(simulated=True), NOW) == ""
    real_time = standing_clock()
    real_time.simulated = False
    assert clock_stands(real_time, NOW) == ""


def test_a_process_that_runs_with_other_settings_than_io_is_named():
    picture = walking()
    for name in PROCESSES:
        say(picture, name, settings="0a1b2c3d")
    assert troubles(picture, NOW) == {}
    say(picture, "mpc", settings="ffffffff")
    assert troubles(picture, NOW) == {"mpc": "runs with other settings than io"}


def test_a_silent_hub_and_a_silent_bus_are_two_things():
    picture = walking()
    picture.processes["io"].heard = NOW - 4.0
    assert why(picture).startswith("io has been silent for 4 s") and "holds the robot" in why(picture)
    for watched in picture.processes.values():
        watched.heard = NOW - 8.0
    assert why(picture).startswith("nothing on the bus for 8 s")
    assert set(troubles(picture, NOW)) == set(PROCESSES)


def test_in_real_time_a_process_that_fails_or_falls_silent_is_named():
    picture = walking()
    picture.processes["wbc"].heard = NOW - 6.0
    assert why(picture) == "wbc has been silent for 6 s: stopped, or hanging in a step"
    picture = walking()
    say(picture, "mpc", life="FAILED", reason="SolverFailed: riccati, node 3")
    assert why(picture) == "mpc has failed: SolverFailed: riccati, node 3"


def test_while_simulated_time_goes_on_one_that_is_not_there_keeps_nobody_from_moving():
    picture = walking()
    picture.processes["trajopt"].status = None
    assert why(picture).startswith("trajopt has not spoken yet")
    picture.simulated = True
    assert why(picture) == "" and "trajopt" in troubles(picture, NOW)
    say(picture, "wbc", life="ACTIVATING", reason="no message yet on mpc/policy",
        input_age_s=ages("wbc", mpc_policy=-1.0))  # fmt: skip
    assert "mpc is behind it" in why(picture)


def test_one_that_waits_for_its_first_input_leads_to_the_one_that_does_not_write_it():
    picture = walking()
    say(picture, "wbc", life="ACTIVATING", reason="no message yet on state/estimate",
        input_age_s=ages("wbc", state_estimate=-1.0))  # fmt: skip
    say(picture, "estimator", life="ACTIVATING", reason="no message yet on hw/state",
        input_age_s=ages("estimator", hw_state=-1.0))  # fmt: skip
    said = why(picture)
    assert said.startswith("io is behind it") and "estimator waits for io" in said
    # A ring of two that wait for each other ends too.
    say(picture, "estimator", life="ACTIVATING", reason="no message yet on fsm/reference",
        input_age_s=ages("estimator", fsm_reference=-1.0))  # fmt: skip
    say(picture, "fsm", life="ACTIVATING", reason="no message yet on state/estimate",
        input_age_s=ages("fsm", state_estimate=-1.0))  # fmt: skip
    assert "estimator waits for fsm" in why(picture)


def test_the_one_that_is_late_is_named_and_not_those_that_wait_behind_it():
    picture = walking()
    say(picture, "mpc", reason="riccati: node 3")
    say(picture, "wbc", input_age_s=ages("wbc", mpc_policy=0.34))
    say(picture, "io", input_age_s=ages("io", joint_command=0.2))
    assert why(picture) == "mpc is late (riccati: node 3): wbc has its mpc/policy of 340 ms ago, limit 100 ms"
    assert troubles(picture, NOW)["io"] == "joint/command of wbc, 200 ms, limit 40 ms is too old"


def test_what_a_robot_that_sits_has_no_use_for_is_not_late():
    picture = walking()
    say(picture, "wbc", input_age_s=ages("wbc", mpc_policy=12.0))
    picture.reference = MotionReference(t=5.0, valid=True, state="DAMP", reason="sitting: no heartbeat for 2 s")
    assert why(picture).startswith("the robot is damped (sitting: no heartbeat for 2 s): `surefoot command stand`")


def test_what_the_gate_says_in_a_dry_run_does_not_hide_why_the_state_machine_gave_up():
    picture = walking()
    gate, reason = "DRY RUN, the motors only damp: the command would pass", "did not stand up: FL_calf"
    picture.hardware = HardwareState(t=5.0, valid=True, damping=True, gate=gate)
    picture.reference = MotionReference(t=5.0, valid=True, state="DAMP", reason=reason)
    assert why(picture) == f"the gate in io damps the robot: {gate}; {reason}"


def test_a_robot_damped_by_the_gate_is_told_with_the_gates_reason_and_who_is_behind_it():
    picture = walking()
    picture.hardware = HardwareState(
        t=5.0, valid=True, damping=True, gate="command is 61.0 ms old, limit 40 ms: is wbc running?"
    )
    say(picture, "wbc", reason="the QP was infeasible")
    assert why(picture) == f"the gate in io damps the robot: {picture.hardware.gate}; the QP was infeasible"
    say(picture, "io", input_age_s=ages("io", joint_command=0.061))
    assert "wbc is late" in why(picture)


@pytest.mark.parametrize(
    ("state", "reason", "words"),
    [
        ("DAMP", "waiting for a command", "`surefoot command stand` or a direction gets it up"),
        ("HOLD", "commanded hold", "is held where it lies: `surefoot command stand` gets it up"),
        ("DAMP", "the robot has fallen", "the robot is damped: the robot has fallen"),
        ("STAND", "stood up", "waits for a command: `surefoot command forward`"),
        ("STOPPED", "commanded stop", "the robot stands (commanded stop)"),
        (
            "STOPPED",
            "no safe foothold for FL",
            "the robot stopped: no safe foothold for FL; it waits for a command",
        ),
    ],
)
def test_a_state_machine_that_waits_for_a_person_says_so(state, reason, words):
    picture = walking(state, reason)
    assert words in why(picture)
    assert troubles(picture, NOW) == {}


def test_a_robot_that_has_stood_up_to_walk_is_not_said_to_wait():
    picture = walking("STAND", "stood up")
    picture.note_command("forward")
    assert why(picture) == ""
    picture.note_command("stand")
    assert "waits for a command" in why(picture)


def test_a_goal_reached_and_an_end_are_told():
    picture = walking("STOPPED", "arrived")
    picture.reference = MotionReference(t=5.0, state="STOPPED", finished=True)
    assert why(picture) == "the robot has reached its goal and waits for a command"
    picture.note_notice(Notice(1, "flat.toml", [], ending="stopped by command"))
    assert why(picture) == "the run ends: stopped by command"


def test_what_the_supervisor_knows_counts_for_one_who_came_late():
    picture = walking()
    picture.note_notice(Notice(1, "flat.toml", [], {"mpc": Post(restarts=2, silent_s=40.0)}))
    assert picture.processes["mpc"].status is None  # that of one that has been replaced
    assert troubles(picture, NOW)["mpc"].startswith("has been silent for 40 s")
    say(picture, "mpc", boot=1)
    assert picture.processes["mpc"].status is None
    say(picture, "mpc", boot=2)
    assert troubles(picture, NOW) == {}


def test_the_worst_input_is_the_one_nearest_to_its_limit():
    said = status("wbc", input_age_s=ages("wbc", mpc_policy=0.05, state_estimate=0.03))
    assert worst_input(said) == ("state/estimate", 0.03, 0.04)
    assert worst_input(status("wbc", input_age_s=np.full(len(component_class("wbc").inputs), -1.0))) is None


def test_inputs_of_a_process_that_steps_on_events_have_no_age_in_between():
    picture = walking()
    say(picture, "trajopt", input_age_s=ages("trajopt", state_estimate=3.0))
    assert troubles(picture, NOW) == {}
    assert why_nothing_moves(picture, NOW) == ""
    assert worst_input(picture.processes["trajopt"].status) is None
