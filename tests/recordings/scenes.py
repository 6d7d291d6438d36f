"""What the clips beside this file show, and how they are made."""

from dataclasses import dataclass
from pathlib import Path

from surefoot.components.lockstep import Lockstep
from surefoot.components.memory import ForeignMemory
from surefoot.config.deployment import load_deployment
from surefoot.tools.recording.clip import REMEMBER, cut
from surefoot.tools.recording.lockstep_recording import LockstepRecording
from surefoot.tools.recording.replay import replay

HERE = Path(__file__).parent
CONFIG = HERE.parents[1] / "config"
DIGESTS = ("mpc/policy",)  # four fifths of a run's bytes


@dataclass(frozen=True)
class Scene:
    """A window of a run on the planks.

    Attributes:
        from_t, until_t: of the run [s]; just after a full second, at which states are recorded.
        settings: other than those of the deployment.
        states: of the state machine that it shows.
    """

    from_t: float
    until_t: float
    states: tuple[str, ...]
    settings: tuple[str, ...] = ()


SCENES = {
    "stand": Scene(0.0, 0.6, ("STAND_UP", "STAND")),
    "step": Scene(2.01, 2.9, ("MOVE", "DETECT_CONTACT", "PROBE")),
    "probe_holds": Scene(7.01, 7.93, ("PROBE", "PROBE_AROUND", "OPT", "MOVE")),
    "collapse": Scene(23.01, 23.94, ("PROBE", "LEG_UP", "MOVE", "DETECT_CONTACT")),
    "map": Scene(1.01, 1.35, ("STAND", "SEND", "OPT"), ("run.vision=true",)),
}


def path(name):
    """The clip of a scene."""
    return HERE / f"{name}.mcap"


def record(settings, folder, until_s=None):
    """The run that the scenes with these settings are cut from, or the first `until_s` of it."""
    whole = folder / f"{'-'.join(settings) or 'run'}.mcap"
    if not whole.exists():
        deployment = load_deployment(CONFIG / "planks.toml", settings)
        stack = Lockstep(deployment)
        recording = LockstepRecording(stack, deployment, whole)
        stack.command("forward")
        ends = [scene.until_t for scene in SCENES.values() if scene.settings == settings]
        stack.run(until_s or max(ends) + 0.01)
        recording.close()
    return whole


def update(name, folder):
    """Make the clip of a scene again; in words, what has changed in it."""
    scene, clip = SCENES[name], path(name)
    changed = ["new"]
    if clip.exists():
        changed = _changed(clip)
    cut(record(scene.settings, folder), clip, scene.from_t, scene.until_t, digests=DIGESTS)
    return f"{name}, {clip.stat().st_size / 1e6:.2f} MB: {'; '.join(changed) or 'nothing has changed'}"


def _changed(clip):
    try:
        topics = replay(clip, REMEMBER).comparison.topics
    except ForeignMemory as error:
        return [f"not to be compared: {error}"]
    return [
        f"{key}: {topic.differing} differ, first {topic.first}" for key, topic in topics.items() if not topic.equal
    ]
