"""A component that takes over from another goes on as that one would have: nothing that counts is forgotten."""

import inspect
from collections import deque
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
import pytest
from taped import Taped, carried, memory_names, written

from surefoot.bus.messages import FsmEvent
from surefoot.components.clock_messages import pack_snapshot, unpack_snapshot
from surefoot.components.lockstep import Lockstep
from surefoot.components.memory import ForeignMemory, Memory
from surefoot.components.registry import component_class
from surefoot.config.deployment import Deployment, Run
from surefoot.config.fsm import Fsm
from surefoot.config.mpc import Mpc
from surefoot.config.terrain import Terrain, Tiles

NAMES = ("estimator", "wbc", "mpc", "fsm", "trajopt", "elevation_map")
STATES = (
    *("STAND_UP", "STAND", "SEND", "OPT", "MOVE", "DETECT_CONTACT"),
    *("PROBE", "LEG_UP", "RETURN_SAFE", "STOPPED"),
)
WATCHED_S = {"mpc": 0.15, "wbc": 0.4, "estimator": 0.8}
"""How long after the take-over the dear ones are watched; the others until the end of the run."""

SCRATCH = {
    "Component": {"trouble"},  # of most it is said anew at every step
    "ContactAidedFilter": {"_F", "_H"},
    "ContactForce": {"_q", "_v"},
    "WholeBodyQp": {"J", "_M", "_P", "_A", "_G", "_b", "_c", "_h", "_bias", "_lower", "_upper", "_box_lower"}
    | {"com_W", "momentum_W", "inertia_W", "p_WF", "wrench_map"},
    "CentroidalDynamics": {"*"},
    "Linearisation": {"*"},
    "QuadraticModel": {"*"},
    "Riccati": {"*"},
    "StageQP": {"*"},
}
"""What a class works on within a step and writes before it reads: by attribute, or all of it."""

NO_MEMORY = {
    *("_events", "stage_ms", "stage_begun"),  # of one step
    *("_solver", "preconditioner_iter", "eps_abs", "eps_rel", "check_duality_gap"),  # PIQP: set up once
    *("_diagonal", "_qp"),  # a view of P; a call
}
"""What methods write to and need not remember."""

OWN_WAY = {
    "ElevationMap": {"_last", "_refused", "_publish_t"},
    "TerrainMap": {"_base", "drift_m", "seen_t"},
    "Torus": {"first", "layers"},
    "Heights": {"_height", "_variance", "_seen_t", "_doubted", "_doubts", "_passed"},
    "LoadLayer": {"_held", "_collapsed"},
    "PoseMatch": {"_estimates", "_waiting"},
}
"""What the elevation map's snapshot keeps in a form of its own, as far as it is needed."""


@pytest.fixture(scope="module")
def run():
    """A blow-by-blow of Fig. 6: FR breaks through a tile, is stopped on its next way, and returns."""
    deployment = Deployment(
        run=Run(vision=True),
        mpc=Mpc(profile="light"),
        terrain=Terrain(kind="tiles", tiles=Tiles(load_min_n=48.0, load_max_n=52.0)),
        fsm=Fsm(crawl_order=(1, 2, 0, 3), probe_around=False),
    )
    tapes = {name: Taped(component_class(name)(deployment), SCRATCH | OWN_WAY) for name in NAMES}
    stack = Lockstep(deployment, given=tapes.values())
    states, left = [], list(STATES)

    def hear(key, message):
        if key == "fsm/reference":
            states.append(message.state)
            if states[-5:].count(message.state) == 5 and message.state in left:
                left.remove(message.state)
                for tape in tapes.values():
                    tape.remember = True

    def go_to(state, more_s=0.0):
        stack.run(stack.t + 10.0, lambda: states[-1:] == [state])
        assert states[-1] == state
        stack.run(stack.t + more_s)

    stack.listen(hear)
    stack.command("forward")
    go_to("LEG_UP")
    go_to("DETECT_CONTACT", 0.3)
    stack.command("stop")
    go_to("STOPPED", 1.2)
    stack.command("left")
    go_to("MOVE", 0.2)
    return tapes, left


def test_the_run_has_been_through_fig_6(run):
    tapes, left = run
    assert not left
    assert all(len(tapes[name].memories) == len(STATES) for name in ("estimator", "wbc", "fsm", "elevation_map"))
    events = [m for *_, new, _ in tapes["elevation_map"].tape for _, m in new if isinstance(m, FsmEvent)]
    assert {"collapse", "force_held", "accepted", "rejected"} & {event.kind for event in events} >= {"collapse"}
    assert sum(len(said) for *_, said in tapes["trajopt"].tape) >= 3


@pytest.mark.parametrize("name", NAMES)
def test_whoever_takes_over_says_the_same(run, name):
    tape = run[0][name]
    for steps in tape.memories:
        t = tape.tape[steps][0]
        differs = tape.differs(tape.heir(steps), steps, WATCHED_S.get(name, 100.0))
        assert differs is None, f"taken over at {t:.3f} s, {name} says something else at {differs:.3f} s"


@pytest.mark.parametrize("name", ["estimator", "wbc", "mpc", "fsm", "elevation_map"])
def test_without_the_memory_it_does_not(run, name):
    tape = run[0][name]
    steps = list(tape.memories)[6]
    fresh = component_class(name)(tape.deployment)
    fresh.warm_up()
    assert tape.differs(fresh, steps, 0.1) is not None


@pytest.mark.parametrize("name", NAMES)
def test_beside_its_memory_nothing_changes(run, name):
    """Fails for an attribute that a step changes and that its class's memory does not name."""
    tape = run[0][name]
    fresh = component_class(name)(tape.deployment)
    fresh.warm_up()
    before = carried(fresh, SCRATCH | OWN_WAY)
    changed = {path for after in tape.beside for path in before | after if before.get(path) != after.get(path)}
    assert changed == set() and tape.beside and len(before) > 5


@pytest.mark.parametrize("name", ["estimator", "wbc", "mpc", "fsm", "trajopt"])
def test_what_a_method_writes_to_is_remembered(name):
    """Also what the run above never comes to: a press that is repeated, a foot that is freed, a leg put off."""
    part = component_class(name)(Deployment())
    folder = Path(inspect.getfile(type(part))).parent
    names = set().union(*(written(path.read_text()) for path in folder.glob("*.py")))
    known = memory_names(part).union(*SCRATCH.values(), NO_MEMORY)
    assert names - known == set() and len(names) > (name != "trajopt")


@pytest.mark.parametrize("name", NAMES)
def test_a_memory_survives_being_read_packed_and_put_back(run, name):
    tape = run[0][name]
    for steps, payload in tape.memories.items():
        assert pack_snapshot(tape.heir(steps).snapshot()) == payload


def test_a_forgotten_attribute_is_told_by_its_path():
    class Careless:
        memory = Memory("held")

        def __init__(self):
            self.held, self.told = 0, 0

        def step(self):
            self.held, self.told = self.held + 1, self.told + 1

    before, thing = carried(Careless(), {}), Careless()
    thing.step()
    assert [path for path, value in carried(thing, {}).items() if value != before[path]] == [".Careless.told"]
    method = "def b(self): self.b[0], x.c = 1, 2; self.d.e += 1; self.f.append(3)"
    assert written(f"class A:\n def __init__(self): self.a = 1\n {method}") == {"b", "c", "e", "f"}


# The helper itself ----------------------------------------------------------------------------------------


class Colour(StrEnum):
    RED = "red"
    BLUE = "blue"


@dataclass(frozen=True)
class Pair:
    a: np.ndarray
    b: float


class Inner:
    memory = Memory("count", "places")

    def __init__(self):
        self.count, self.places = 0, [np.zeros(2)]


class Outer:
    memory = Memory("held", colour=Colour, event=FsmEvent, pair=Pair, legs=set, gap=tuple, inner=Inner)

    def __init__(self):
        self.held, self.colour, self.event, self.pair = None, Colour.RED, None, None
        self.legs, self.gap, self.inner = set(), (), Inner()


def full():
    outer = Outer()
    outer.held, outer.colour, outer.legs, outer.gap = np.arange(3.0), Colour.BLUE, {2, 0}, (np.ones(2), 1.5)
    outer.event, outer.pair = FsmEvent(kind="stopped", leg=2), Pair(np.eye(2), np.inf)
    outer.inner.count, outer.inner.places = np.int64(7), [np.array([1.0, 2.0])]
    return outer


def test_every_form_comes_back_as_it_was():
    state = unpack_snapshot(pack_snapshot(Outer.memory.of(full())))
    again = Outer()
    inner = again.inner
    Outer.memory.restore(again, state)
    assert again.colour is Colour.BLUE and again.legs == {0, 2} and again.inner is inner
    assert again.event.kind == "stopped" and again.event.leg == 2 and again.pair.b == np.inf
    assert isinstance(again.gap, tuple) and again.gap[1] == 1.5 and again.inner.count == 7
    np.testing.assert_array_equal(again.held, [0.0, 1.0, 2.0])
    np.testing.assert_array_equal(again.inner.places, [[1.0, 2.0]])
    again.held[0] = 5.0  # its own, and to be written to
    Outer.memory.restore(again, unpack_snapshot(pack_snapshot(Outer.memory.of(Outer()))))
    assert again.held is None and again.event is None and again.pair is None and again.gap == ()


def test_what_is_taken_over_without_packing_is_not_shared():
    one, other = full(), Outer()
    Outer.memory.restore(other, Outer.memory.of(one))
    one.held[0] = one.pair.a[0, 0] = one.gap[0][0] = one.inner.places[0][0] = 99.0
    one.legs.add(3)
    assert other.held[0] == 0.0 and other.pair.a[0, 0] == 1.0 and other.gap[0][0] == 1.0
    assert other.inner.places[0][0] == 1.0 and other.legs == {0, 2}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda state: state.pop("held"), "a memory of Outer holds held, colour"),
        (lambda state: state["inner"].update(new=1), "a memory of Inner holds count, places, not"),
        (lambda state: state.update(colour="green"), "Outer.colour cannot be 'green'"),
        (lambda state: state.update(event=b"?"), "Outer.event cannot be b'?'"),
        (lambda state: state.update(pair={"a": 1.0, "c": 2.0}), "Outer.pair cannot be"),
        (lambda state: state.update(inner=3), "a memory of Inner holds count, places, not int"),
    ],
)
def test_a_memory_of_something_else_is_refused_whole(change, words):
    state, outer = Outer.memory.of(full()), Outer()
    change(state)
    with pytest.raises(ForeignMemory, match=words.replace("?", "[?]")):
        Outer.memory.restore(outer, state)
    assert outer.held is None and outer.colour is Colour.RED and outer.inner.count == 0


def test_an_object_without_a_memory_cannot_be_remembered():
    with pytest.raises(TypeError, match="no memory of a deque"):
        Memory(recent=deque)
