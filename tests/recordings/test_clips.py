"""Every component publishes, on what it read in the clips, the bytes that it published then."""

import pytest
import scenes

from surefoot.bus.codec import decode
from surefoot.bus.messages import MotionReference
from surefoot.bus.recording.reader import Recording
from surefoot.tools.recording.clip import REMEMBER
from surefoot.tools.recording.contents import Contents
from surefoot.tools.recording.replay import recorded_deployment, replay

CHAIN = {"wbc": ("mpc", "wbc")}  # of the policy the clips hold digests only
IDLE = {("stand", "trajopt"), ("step", "trajopt"), ("map", "trajopt")}  # no plan is asked for
QP_SHARE = 0.03  # on other arithmetic the QP's interior point stops an iteration earlier or later now and then


def differing(result):
    """The topics that are not what they were, and how."""
    return {
        key: topic.first
        for key, topic in result.comparison.topics.items()
        if topic.missing or topic.extra or topic.differing > (0.0 if result.exact else QP_SHARE * topic.compared)
    }


@pytest.fixture(scope="session", autouse=True)
def refreshed(request, tmp_path_factory):
    """With --update-refs the clips are made again before they are tested."""
    if request.config.getoption("--update-refs"):
        folder = tmp_path_factory.mktemp("runs")
        told = [scenes.update(name, folder) for name in scenes.SCENES]
        capture = request.config.pluginmanager.getplugin("capturemanager")
        with capture.global_and_fixture_disabled():
            print("", *told, sep="\n")


@pytest.mark.parametrize("name", scenes.SCENES)
@pytest.mark.parametrize("process", REMEMBER)
def test_a_component_publishes_what_it_published_when_it_was_recorded(name, process):
    result = replay(scenes.path(name), CHAIN.get(process, (process,)))
    assert differing(result) == {} and not any(result.left_out.values()), result.notes
    if (name, process) not in IDLE:
        assert result.steps[process] > 0


@pytest.mark.parametrize("name", scenes.SCENES)
def test_all_together_publish_the_same(name):
    result = replay(scenes.path(name), REMEMBER)
    assert differing(result) == {} and not any(result.left_out.values()), result.notes


@pytest.mark.parametrize(
    ("name", "process", "setting", "key"),
    [
        ("collapse", "fsm", "fsm.collapse_m=0.028", "fsm/reference"),
        ("step", "estimator", "estimator.force_filter_hz=41.0", "state/estimate"),
        ("probe_holds", "mpc", "ocp.weights.force=0.011", "mpc/policy"),
        ("stand", "wbc", "wbc.kp=101.0", "joint/command"),
        ("probe_holds", "trajopt", "ocp.weights.force=0.011", "trajopt/plan"),
        ("map", "elevation_map", "elevation_map.std_min_m=0.004", "map/elevation"),
    ],
)
def test_another_setting_is_seen(name, process, setting, key):
    result = replay(scenes.path(name), CHAIN.get(process, (process,)), overrides=[setting])
    if result.comparison.topics[key].unread:
        pytest.skip("only digests were recorded, on a machine of other arithmetic")
    assert result.comparison.topics[key].differing and result.comparison.topics[key].first


@pytest.mark.parametrize("clip", sorted(scenes.HERE.glob("*.mcap")), ids=lambda clip: clip.stem)
def test_every_clip_can_be_read(clip):
    contents = Contents(clip)
    assert contents.bad == [] and contents.recording.damage == ""
    _, unknown = recorded_deployment(contents.recording)
    assert unknown == []
    assert clip.stat().st_size < 1_000_000


@pytest.mark.parametrize("name", scenes.SCENES)
def test_a_clip_shows_what_it_is_for(name):
    references = [
        decode(MotionReference, item.payload)
        for item in Recording(scenes.path(name))
        if item.key == "fsm/reference"
    ]
    assert set(scenes.SCENES[name].states) <= {reference.state for reference in references}
