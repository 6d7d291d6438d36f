"""What an operator may say of a walk: when to rest, when to go on, and what of the foothold of the moment.

None of it lifts a foot or skips a way back by itself: a walk rests when the leg under way stands, and a foot that
presses is unloaded before it is lifted, as long as the other three can carry the robot.
"""

from __future__ import annotations

from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.probing_cycle import ProbingCycle
from surefoot.components.fsm.state import State
from surefoot.components.fsm.words import PAUSED, Answer, refused, taken

_HALTED = "commanded halt"


def obey(cycle: ProbingCycle, word: str, now: Observation) -> Answer:
    """Do what is said of a walk, or answer why not; the robot is not in a posture."""
    match word:
        case "halt":
            return _halt(cycle, now)
        case "pause":
            return _pause(cycle, now)
        case "resume":
            return _resume(cycle, now)
        case "step":
            return _step(cycle, now)
        case "skip":
            return _skip(cycle, now)
        case _:
            return _press_again(cycle, now)


def turn_to(cycle: ProbingCycle, now: Observation, reason: str) -> Answer:
    """A new direction while the robot walks: it rests first, then sets off again."""
    if cycle.ends in ("", PAUSED):
        cycle.halt(now, reason)
    return taken(_when(cycle))


def end(cycle: ProbingCycle, now: Observation, reason: str) -> None:
    """The walk is over at once: a leg that is under way goes back."""
    if paused(cycle):
        cycle.rest(now, reason)
    else:
        cycle.stop(now, reason)


def _halt(cycle: ProbingCycle, now: Observation) -> Answer:
    if cycle.state == State.STOPPED:
        if not paused(cycle):
            return refused(f"halt: the robot rests already ({cycle.reason})")
        cycle.rest(now, _HALTED)
        return taken("the walk is over; a direction begins another")
    if _goes_back(cycle):
        return refused(f"halt: {_back(cycle)}")
    cycle.halt(now, _HALTED)
    return taken(f"{_when(cycle)}; the walk is over")


def _pause(cycle: ProbingCycle, now: Observation, word: str = "pause") -> Answer:
    if cycle.state == State.STOPPED:
        return refused(f"{word}: the robot rests already ({cycle.reason})")
    if cycle.ends == PAUSED:
        return refused(f"{word}: a pause comes already after the step of {cycle.leg_name}")
    if cycle.ends:
        return refused(f"{word}: the walk ends with this step: {cycle.ends}")
    cycle.halt(now, PAUSED)
    return taken(f"{_when(cycle)}; resume goes on")


def _resume(cycle: ProbingCycle, now: Observation) -> Answer:
    if cycle.state != State.STOPPED and cycle.ends == PAUSED:
        cycle.keep_walking()
        return taken("the pause is taken back: the walk goes on after this step")
    if not paused(cycle):
        return refused(f"resume: {_no_pause(cycle)}")
    cycle.go_on(now, "commanded resume")
    return taken("the walk goes on")


def _step(cycle: ProbingCycle, now: Observation) -> Answer:
    if cycle.state != State.STOPPED:
        return _pause(cycle, now, "step")
    if not paused(cycle):
        return refused(f"step: {_no_pause(cycle)}")
    cycle.go_on(now, "commanded step", halt=PAUSED)
    return taken("one step, then a pause again")


def _skip(cycle: ProbingCycle, now: Observation) -> Answer:
    state = cycle.state
    if state in (State.STOPPED, State.PRE_OPT):
        return refused(f"skip: no leg is on its way to a foothold in {state}; give a direction, or resume")
    if state == State.LEG_UP:
        return refused(f"skip: {cycle.leg_name} has given this foothold up already; the next candidate follows")
    if state == State.RETURN_SAFE:
        return refused(f"skip: {_back(cycle)}")
    if state == State.PROBE and (why := cycle.keeps_down(now)):
        return refused(f"skip: {why}")
    cycle.skip(now)
    return taken("the foot is unloaded, then lifted" if state == State.PROBE else "the next candidate follows")


def _press_again(cycle: ProbingCycle, now: Observation) -> Answer:
    if cycle.stuck:
        cycle.try_again(now, "commanded reprobe")
        return taken("the leg that found no foothold tries its candidates once more")
    if cycle.state != State.PROBE:
        return refused(
            f"reprobe: no foot presses in {cycle.state}; say it in PROBE, or after a leg has found no foothold"
        )
    if cycle.press_ends:
        return refused(f"reprobe: the press ends already: {cycle.press_ends}")
    cycle.press_again(now)
    return taken(f"{cycle.leg_name} presses again from the first force")


def paused(cycle: ProbingCycle) -> bool:
    """The walk rests and can go on."""
    return cycle.state == State.STOPPED and cycle.reason == PAUSED


def _goes_back(cycle: ProbingCycle) -> bool:
    return cycle.state == State.RETURN_SAFE and bool(cycle.ends)


def _back(cycle: ProbingCycle) -> str:
    why = f" ({cycle.ends})" if cycle.ends else ""
    return f"{cycle.leg_name} goes back to where it stood{why}; wait until it stands"


def _no_pause(cycle: ProbingCycle) -> str:
    if cycle.state == State.STOPPED:
        return f"the walk is over ({cycle.reason}); give a direction"
    return f"the robot walks; it is taken after a pause (state {cycle.state})"


def _when(cycle: ProbingCycle) -> str:
    return f"after the step of {cycle.leg_name}" if cycle.under_way else "at once: no leg has left the ground"
