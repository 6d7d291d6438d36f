"""What is broken of an emulated robot is named so that it can be."""

import pytest

from surefoot.config.emulator import Emulator, Fault
from surefoot.config.typed_toml import ConfigError, build


def test_faults_are_a_list_of_tables():
    table = {"faults": [{"kind": "dead motor", "joint": "RL_calf", "begin_s": 2.5}, {"kind": "stuck tick"}]}
    assert build(Emulator, table).faults == (Fault("dead motor", "RL_calf", begin_s=2.5), Fault("stuck tick"))


@pytest.mark.parametrize("kind", ["dead motor", "hot motor", "stuck encoder"])
@pytest.mark.parametrize("joint", ["", "FL_knee"])
def test_a_fault_of_a_joint_names_one(kind, joint):
    with pytest.raises(ConfigError, match=rf"faults\[0\]: joint = '{joint}': a {kind} is one of FL_hip, FL_thigh"):
        build(Emulator, {"faults": [{"kind": kind, "joint": joint}]}, "emulator")
