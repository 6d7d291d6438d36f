"""Runs cases on live runs and judges what came of them."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from surefoot.bus.codec import decode
from surefoot.bus.messages import HardwareState, JointCommand, SimTruth
from surefoot.bus.topics import PROCESSES
from surefoot.components.robot_model.rotation import matrix_of
from surefoot.tools.faults.case import Case, Result
from surefoot.tools.faults.observed_run import ObservedRun, RunOver
from surefoot.tools.faults.reference_run import first_difference

PAUSE_S = 1.0  # of the run's time
_GO_ON_S = 0.06
_SETTLE_S = 4.0  # of the run's time
_END_S = 12.0  # likewise: the robot sits down before the run ends
_STANDS_M = 0.30  # height of the trunk that no robot has that lies
_TILT = 0.5  # more than the state machine lets pass for standing or lying [rad]
_SAID = {"kill": "{} ended with", "restart": "restart", "pause": "simulated time waits"}
"""What is said, of which process, after a fault with simulated time."""

_PAUSED_IO = "io has not advanced the clock"

_NO_WALK = 'run.command="stand"'

Say = Callable[[str], None]


@dataclass(frozen=True)
class _Done:
    """A case that has been carried out in a run with simulated time, not compared yet."""

    case: Case
    t: float
    outcome: str
    told: str
    stands: bool


class Drill:
    """Live runs of one deployment, with faults."""

    def __init__(self, config: Path, settings: list[str], folder: Path, say: Say = lambda words: None):
        """`folder` is for logs and output; `say` is told of each case when it is over."""
        self._config, self._settings, self._folder, self._say = config, settings, folder, say
        self._runs = 0

    # Simulated time -------------------------------------------------------------------------------------

    def simulated(self, cases: list[Case], legs: tuple[int, ...] = (0, 1, 2, 3)) -> list[Result]:
        """One run through all cases, in their order, compared with the same run in one process.

        Args:
            cases: those of one phase stand together; a kill of io is the last.
            legs: which of them may swing or probe when it happens.
        """
        run = self._run(_NO_WALK if cases[0].phase == "standing" else "")
        done: list[_Done] = []
        try:
            run.wait(lambda: len(run.status) == len(PROCESSES) and run.t > 0.2, "the first step")
            walks = cases[0].phase != "standing"
            for case in cases:
                if case.phase != "standing" and not walks:
                    run.command("forward")
                    walks = True
                run.wait(partial(_is_in, run, case.phase, legs), f"the phase {case.phase}")
                done.append(self._carry_out(run, case))
                self._say(f"{case.phase}: {case.fault} {case.process} at {done[-1].t:.2f} s: {done[-1].outcome}")
        except RunOver as error:
            for case in cases[len(done) :]:
                done.append(_Done(case, run.t, f"not reached: {error}", "", False))
        finally:
            end = run.t
            run.close()
        differs, where = first_difference(run.deployment, run.heard, end - 0.05)
        return [_judged(each, done[index + 1 :], differs, where) for index, each in enumerate(done)]

    def _carry_out(self, run: ObservedRun, case: Case) -> _Done:
        t, mark, status = run.t, run.mark(), run.status.get(case.process)
        boot = -1 if status is None else status.boot
        name = case.process
        begun = time.monotonic()
        if case.fault == "kill" and name == "io":
            run.signal(name, signal.SIGKILL)
            seconds = run.wait_end()
            left = run.left_behind()
            outcome = f"run over {seconds:.1f} s later" + (f", left behind: {', '.join(left)}" if left else "")
            return _Done(case, t, outcome, run.ending(), not left)
        if case.fault == "pause":
            run.signal(name, signal.SIGSTOP)
            time.sleep(PAUSE_S)
            run.go_on(name)
            stood = f"paused {PAUSE_S:g} s"
        elif name == "io":
            run.restart(name)
            run.wait(lambda: bool(run.words("cannot restart io", mark)), "a refusal")
            stood = "refused"
        else:
            if case.fault == "kill":
                run.signal(name, signal.SIGKILL)
            else:
                run.restart(name)
            run.wait(lambda: run.status[name].boot > boot, f"{name} again")
            stood = f"back after {time.monotonic() - begun:.1f} s"
        go_on = run.t + _GO_ON_S
        run.wait(lambda: run.t > go_on, "time to go on")
        about = _PAUSED_IO if case.fault == "pause" and name in ("io", "all") else _SAID[case.fault].format(name)
        if case.fault != "pause":
            run.wait(lambda: bool(run.words(about, mark)), "a word of the supervisor")
        return _Done(case, t, stood, run.words(about, mark), _stands(run))

    # Monotonic clock ------------------------------------------------------------------------------------

    def monotonic(self, case: Case) -> Result:
        """One run for one case; how long until the robot is in its safe state, by the run's own clock."""
        command = "stand" if case.phase == "standing" else "forward"
        run = self._run("run.clock=monotonic", "mpc.profile=light", f'run.command="{command}"')
        speed = run.deployment.run.speed
        try:
            run.wait(lambda: len(run.status) == len(PROCESSES) and run.phase == case.phase, case.phase)
            if case.phase == "standing":
                begun = run.t
                run.wait(lambda: run.t > begun + 1.0)
            t, mark, name, truths = run.t, run.mark(), case.process, len(run.heard["sim/truth"])
            if case.fault == "pause":
                run.signal(name, signal.SIGSTOP)
                time.sleep(PAUSE_S / speed)
                run.go_on(name)
            elif case.fault == "kill":
                run.signal(name, signal.SIGKILL)
            else:
                run.restart(name)
            end = time.monotonic() + (_END_S if case.fault == "kill" else _SETTLE_S) / speed
            while time.monotonic() < end and not run.over:
                time.sleep(0.05)
            result = self._judge_monotonic(run, case, t, truths, mark)
        except RunOver as error:
            result = Result(case, False, f"not reached: {error}", "")
        finally:
            run.close()
        self._say(f"{case.phase}: {case.fault} {case.process}: {result.outcome}")
        return result

    def _judge_monotonic(
        self, run: ObservedRun, case: Case, t: float, since: int, mark: tuple[int, int]
    ) -> Result:
        """Damped, ended or up: no command that was too old was ever applied, and the robot did not fall over."""
        # What is published from here on, while this machine is busy with the judging, is no doing of the fault.
        until, payloads = run.t, run.heard["sim/truth"][since:]
        states = [state for state in run.since("hw/state", t) if state.t <= until]
        truths = [decode(SimTruth, payload) for payload in payloads]
        commands = [command for command in run.since("joint/command", t) if command.t <= until]
        told = run.ending() if run.over else run.words(case.process, mark) or run.words("io: ", mark)
        damped = [state.t for state in states if state.damping]
        damped += [command.t for command in commands if not command.kp.any() and not command.tau.any()]
        tilt = max((_tilt(truth.quat_WB) for truth in truths), default=0.0)
        old = _applied_too_old(states, run.since("joint/command", t - 1.0), run.deployment.hw.command_timeout_s)
        if tilt > _TILT or old:
            return Result(case, False, old or f"fell: tilted {tilt:.2f} rad", told)
        seconds = min(damped) - t if damped else None
        height = truths[-1].p_WB[2] if truths else 0.0
        if run.over and case.fault == "kill" and case.process == "io":
            others = ", ".join(run.left_behind())
            return Result(case, not others and bool(told), f"run over, left behind: {others or 'nothing'}", told)
        if run.over:
            seconds = seconds if seconds is not None else (states[-1].t - t if states else 0.0)
            left = ", ".join(run.left_behind())
            outcome = "run over, robot damped" + (f", left behind: {left}" if left else "")
            return Result(case, not left and bool(told), outcome, told, seconds)
        if seconds is None:
            return Result(case, height > _STANDS_M, f"stays up, trunk at {height:.2f} m", told)
        reference = run.last("fsm/reference")
        told = told or reference.reason
        outcome = f"damped; {PAUSE_S:g} s after: trunk at {height:.2f} m, {reference.state}"
        return Result(case, bool(told), outcome, told, seconds)

    def _run(self, *settings: str) -> ObservedRun:
        self._runs += 1
        folder = self._folder / str(self._runs)
        folder.mkdir(parents=True, exist_ok=True)
        return ObservedRun(self._config, [*self._settings, *filter(None, settings)], folder)


def _judged(done: _Done, later: list[_Done], differs: float, where: str) -> Result:
    """A difference is the doing of the last fault before it."""
    until = later[0].t if later else float("inf")
    outcome, good = done.outcome, done.stands
    if done.case.fault == "kill" and done.case.process == "io":
        return Result(done.case, good, outcome, done.told)
    if outcome.startswith("not reached"):
        return Result(done.case, False, outcome, done.told)
    if differs < done.t:
        bytes_are = "bytes not compared: they differ since an earlier case"
    elif differs < until:
        bytes_are, good = f"other bytes: {where}", False
    else:
        bytes_are = "same bytes"
    return Result(done.case, good, f"{bytes_are if done.stands else 'fell'}; {outcome}", done.told)


def _applied_too_old(states: list[HardwareState], commands: list[JointCommand], limit_s: float) -> str:
    """The first cycle that was not damped although no command was young enough; empty if there is none.

    Where the drill itself has not heard commands, as their numbers tell, it knows of no age.
    """
    dated = np.array([command.t for command in commands])
    for state in states:
        heard = int(np.searchsorted(dated, state.t, side="right"))
        age = state.t - dated[heard - 1] if heard else np.inf
        unheard = 0 < heard < len(commands) and commands[heard].seq > commands[heard - 1].seq + 1
        if not state.damping and age > limit_s + 1e-6 and not unheard:
            return f"at {state.t:.3f} s a command of {1e3 * age:.0f} ms was applied, limit {1e3 * limit_s:.0f} ms"
    return ""


def _is_in(run: ObservedRun, phase: str, legs: tuple[int, ...]) -> bool:
    return run.phase == phase and (phase not in ("swing", "probing") or run.last("fsm/reference").leg in legs)


def _stands(run: ObservedRun) -> bool:
    truth = run.last("sim/truth")
    return bool(truth.p_WB[2] > _STANDS_M and truth.body_contact == "" and _tilt(truth.quat_WB) < _TILT)


def _tilt(quat_WB: np.ndarray) -> float:
    """Angle between the trunk's and the world's upwards [rad]."""
    return float(np.arccos(np.clip(matrix_of(quat_WB)[2, 2], -1.0, 1.0)))
