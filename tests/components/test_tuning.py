"""A setting that is changed while the robot walks: taken over between two steps, recorded, replayed, kept."""

from dataclasses import replace

import pytest
from taped import Taped

from surefoot.bus.messages import Tuning
from surefoot.components.component import Inbox
from surefoot.components.lockstep import Lockstep
from surefoot.components.registry import component_class
from surefoot.config.deployment import Deployment
from surefoot.config.fsm import Fsm
from surefoot.config.mpc import Mpc
from surefoot.config.tuning import tuned
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.recording.lockstep_recording import LockstepRecording
from surefoot.tools.recording.replay import replay

DEPLOYMENT = Deployment(fsm=Fsm(probe_around=False), mpc=Mpc(profile="light"))
CHANGES = ("ocp.weights.force=0.02", "wbc.kp=90", "fsm.swing_s=0.45", "trajopt.envelope_scale=0.9")
TUNED = ("fsm", "mpc", "trajopt", "wbc")


class Walk:
    """The robot stands up, and settings are changed while it plans its first step.

    Attributes:
        swings_s: how long the planned swings last, each once [s].
    """

    def __init__(self, path):
        self.tapes = {name: Taped(component_class(name)(DEPLOYMENT), {}) for name in TUNED}
        self.stack = Lockstep(DEPLOYMENT, given=self.tapes.values())
        self.path = path
        recording = LockstepRecording(self.stack, DEPLOYMENT, path)
        self.swings_s, self.state = [], ""
        self.stack.listen(self.hear)
        self.stack.command("forward")
        self.go_on_to("SEND")
        for assignment in CHANGES:
            self.stack.tune(assignment)
        self.go_on_to("MOVE")
        for tape in self.tapes.values():
            tape.remember = True
        self.go_on_to("PROBE")
        recording.close()

    def hear(self, key, message):
        if key == "fsm/reference":
            self.state = message.state
            lasts_s = round(message.swing_t1 - message.swing_t0, 6)
            if message.swing_leg >= 0 and lasts_s not in self.swings_s:
                self.swings_s.append(lasts_s)

    def go_on_to(self, state):
        self.stack.run(self.stack.t + 10.0, lambda: self.state == state)
        assert self.state == state


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    return Walk(tmp_path_factory.mktemp("tuned") / "walk.mcap")


def test_it_acts_from_the_next_step_on(walk):
    assert walk.tapes["fsm"].part.deployment == tuned(DEPLOYMENT, CHANGES)
    assert 0.45 in walk.swings_s and 0.5 not in walk.swings_s


def test_a_component_that_takes_it_over_says_what_one_with_these_settings_would(walk):
    """Beside the settings nothing is lost: the one built anew with the old one's memory goes on alike."""
    for name in ("fsm", "wbc", "mpc"):
        tape = walk.tapes[name]
        steps = next(iter(tape.memories))
        other = component_class(name)(tuned(DEPLOYMENT, CHANGES))
        other.warm_up()
        other.restore(tape.heir(steps).snapshot())
        assert tape.differs(other, steps, 1.2) is None


@pytest.mark.parametrize("name", ["fsm", "mpc", "wbc"])
def test_one_that_is_restarted_keeps_it(walk, name):
    tape = walk.tapes[name]
    steps = next(iter(tape.memories))
    assert tape.differs(tape.heir(steps), steps, 1.2) is None


@pytest.mark.parametrize("name", ["fsm", "mpc", "wbc"])
def test_without_it_the_same_memory_says_something_else(walk, name):
    tape = walk.tapes[name]
    steps = next(iter(tape.memories))
    heir = tape.heir(steps)
    heir.heed_tuning = lambda inbox: None
    assert tape.differs(heir, steps, 1.2) is not None


def test_a_recording_with_a_change_is_replayed_byte_for_byte(walk):
    result = replay(walk.path, TUNED)
    assert result.comparison.equal and not any(result.left_out.values()), result.notes
    assert all(result.comparison.topics[key].compared for key in ("fsm/reference", "mpc/policy", "joint/command"))


def test_and_from_a_checkpoint_after_it(walk):
    result = replay(walk.path, TUNED, from_t=walk.stack.t)
    assert result.comparison.equal and not any(result.left_out.values()), result.notes


def test_what_cannot_be_tuned_is_an_error_and_tells_nobody():
    stack, heard = Lockstep(DEPLOYMENT, names=("fsm",)), []
    stack.listen(lambda key, message: heard.append(key))
    with pytest.raises(ConfigError, match="not to be changed while the robot runs"):
        stack.tune("hw.kp_max=1000")
    assert not heard


def test_a_component_of_other_code_goes_on_as_it_was_and_says_so():
    part, inbox = component_class("wbc")(DEPLOYMENT), Inbox(component_class("wbc").inputs)
    inbox.deliver("operator/tuning", Tuning(valid=True, assignment=("wbc.new_gain=1.0",)))
    part.heed_tuning(inbox)
    assert "wbc.new_gain" in part.untuned and part.deployment is DEPLOYMENT
    inbox.deliver("operator/tuning", Tuning(valid=True, seq=1, assignment=("wbc.kp=90.0",)))
    part.heed_tuning(inbox)
    assert part.untuned == "" and part.deployment == replace(DEPLOYMENT, wbc=replace(DEPLOYMENT.wbc, kp=90.0))
