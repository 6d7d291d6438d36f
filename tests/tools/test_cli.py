"""A wrong call ends with code 2 and says what would be right."""

import json

import pytest

from surefoot.bus.codec import check
from surefoot.bus.errors import MessageError
from surefoot.bus.messages import HardwareState
from surefoot.bus.topics import TOPICS
from surefoot.tools.cli import main
from surefoot.tools.commands import topics


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (["run", "nowhere.toml"], "no such file: nowhere.toml"),
        (["run", "flat", "--set", "hw.sed=3"], "did you mean hw.seed?"),
        (["run", "flat", "--set", "hw.friction_max=7"], "out of range, allowed 0 to 2"),
        (["run", "flat", "--set", "hw"], "section.key=value"),
        (["run", "flat", "--set", "hw.unit=mine.toml"], "robot file mine.toml: no such file"),
        (["restart", "io"], "io holds robot and bus"),
        (["restart", "engine"], "processes that can be: estimator"),
        (["command", "jump"], "commands are stand, sit, forward"),
        (["run", "flat", "--host", "laptop"], "network: host = 'laptop': hosts has robot"),
        (["command", "stand", "--connect", "flat"], "robot cannot be reached from another machine"),
        *(([word, "--connect", "flat"], "robot cannot be reached from") for word in ("stop", "cut", "heartbeat")),
        (["record", "{tmp}/a.mcap", "--connect", "flat"], "robot cannot be reached from"),
        (
            ["record", "{tmp}/a.mcap", "--namespace", "nobody"],
            "is `surefoot run` running with namespace 'nobody'?",
        ),
        (["child", "flat", "engine"], "no process 'engine'"),
        (["eval", "flat", "--seeds", "x", "--out", "out"], "--seeds 'x'"),
        (["emulator", "--terrain", "moss"], "terrain.kind = 'moss': must be one of 'flat'"),
        (["emulator", "--port", "0"], "hw.aliengo.port = 0: out of range"),
        (["emulated", "planks"], "hw.backend = 'mujoco' with hw.aliengo.exchange = 'timer'"),
        (["faults", "--robot", "--phase", "swing", "--out", "page.md"], "--robot has its own clock and phases"),
        (["soak", "--set", "hw.sed=3", "--out", "out"], "did you mean hw.seed?"),
        (["eval", "aliengo", "--seeds", "0", "--out", "out"], "hw.backend = 'aliengo': runs are graded with"),
        (["reproduce", "out", "--set", "flat_gaol_m=0.3"], "did you mean flat_goal_m?"),
        (["reproduce", "out", "--jobs", "0"], "--jobs 0: at least one"),
        (["reproduce", "out", "--seeds", "one"], "--seeds 'one'"),
        (["eval", "flat", "--arm", "half", "--out", "out"], "no arm 'half'; there are full"),
        (["eval", "flat", "--arm", "threshold=high", "--out", "out"], "fsm.collapse_m = 'high': expected float"),
        (
            ["eval", "flat", "--dask", "nonsense://here", "--out", "{tmp}"],
            "--dask nonsense://here: no Dask scheduler",
        ),
        (["press", "planks", "--out", "map.jpg"], "--out map.jpg: a picture is a .png"),
        (["press", "planks", "--force", "0.5", "--out", "map.png"], "--force 0.5: above 1 N"),
        (["press", "planks", "--force", "nan", "--out", "map.png"], "--force nan"),
        (["press", "planks", "--step", "0", "--out", "map.png"], "--step 0: allowed 0.002 to 0.2 m"),
        (["doctor", "nowhere"], "no such file: nowhere"),
        (["doctor", "flat", "--set", "doctor.motor_warm=90"], "motor_warm = 90.0 is above motor_hot = 75.0"),
        (["calibrate", "flat", "--hung", "--attitudes", "2", "--out", "unit.toml"], "--attitudes 2: 3 to 20"),
        (["calibrate", "flat", "--hung", "--level-floor", "--out", "unit.toml"], "--level-floor: with --standing"),
        (["calibrate", "flat", "--hung", "--out", "{tmp}/none/unit.toml"], "there is no folder"),
        (["calibrate", "flat", "--standing", "--namespace", "nobody", "--out", "{tmp}/unit.toml"], "nobody"),
        (["press", "nowhere", "--out", "map.png"], "no such file: nowhere"),
    ],
)
def test_a_wrong_call_is_answered_by_what_would_be_right(call, words, capsys, tmp_path):
    assert main([word.format(tmp=tmp_path) for word in call]) == 2
    assert words in capsys.readouterr().err


def test_a_malformed_file_is_named_with_its_line(tmp_path, capsys):
    path = tmp_path / "broken.toml"
    path.write_text("[hw]\nseed = \n")
    assert main(["run", str(path)]) == 2
    assert "broken.toml is not valid TOML" in (said := capsys.readouterr().err) and "line 2" in said


@pytest.mark.parametrize(
    ("kind", "fault"),
    [
        (ValueError, lambda: int("seven")),
        (KeyError, lambda: {}["leg"]),
        (MessageError, lambda: check(HardwareState(t=float("nan")))),
    ],
)
def test_an_error_of_the_program_keeps_its_traceback(kind, fault, monkeypatch):
    monkeypatch.setattr(topics, "_run", lambda call: fault())
    with pytest.raises(kind):
        main(["topics"])


def test_topics_for_a_script(capsys):
    assert main(["topics", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told.keys() == TOPICS.keys()
    assert told["mpc/policy"] == {"message": "Policy", "writer": "mpc", "rate_hz": 100.0, "stale_after_s": 0.1}
    assert told["fsm/event"]["rate_hz"] is None and told["fsm/event"]["stale_after_s"] is None
