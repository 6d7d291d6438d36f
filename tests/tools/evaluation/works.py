"""Stand-ins for a graded run, importable by the process that is to do them."""

import os
import signal
import time

CROSSED = {"success": True, "failure": None, "sim_time_s": 12.0}
STATE = "as it was loaded"


def crosses(scenario, changes, seed, limit_s):
    """Says what it was asked for."""
    return CROSSED | {"asked": [scenario.stem, *changes, limit_s], "pid": os.getpid()}


def one_is_killed(scenario, changes, seed, limit_s):
    """Seed 1 ends as one that runs out of memory does."""
    if seed == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.2)  # the others are under way when it dies
    return CROSSED


def one_sleeps(scenario, changes, seed, limit_s):
    """Seed 1 sleeps, with a mark before and after; the others wait until it does."""
    asleep = scenario.parent / "asleep"
    if seed == 1:
        told = scenario.parent / "asleep.part"
        told.write_text(str(os.getpid()))
        told.replace(asleep)
        time.sleep(20.0)
        (scenario.parent / "awake").touch()
    while not asleep.exists():
        time.sleep(0.01)
    return CROSSED


def one_raises(scenario, changes, seed, limit_s):
    """Seed 1 crashes."""
    if seed == 1:
        raise RuntimeError("the solver has gone for a walk")
    return CROSSED


def notes_itself(scenario, changes, seed, limit_s):
    """Leaves a mark when it begins and when it ends."""
    folder = scenario.parent
    (folder / f"begun-{seed}").touch()
    time.sleep(0.3)
    at_once = len(list(folder.glob("begun-*"))) - len(list(folder.glob("ended-*")))
    (folder / f"ended-{seed}").touch()
    return CROSSED | {"at_once": at_once}


def falls(scenario, changes, seed, limit_s):
    """Seed 1 falls over."""
    return CROSSED if seed != 1 else CROSSED | {"success": False, "failure": "fell"}


def one_kills_its_worker(scenario, changes, seed, limit_s):
    """Seed 1 takes the process that waits for it with it."""
    if seed == 1:
        os.kill(os.getppid(), signal.SIGKILL)
    return CROSSED


def later_ones_sleep(scenario, changes, seed, limit_s):
    """All but seed 0 take longer than anybody waits."""
    if seed:
        time.sleep(30.0)
    return CROSSED


def other_digest():
    """In whose process it was changed says something else than in the workers'."""
    return STATE


def lives(pid):
    """Whether a process is there."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True
