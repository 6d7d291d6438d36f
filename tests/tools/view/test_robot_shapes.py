"""The view's robot against the stack's own models of it."""

import numpy as np
import pinocchio as pin
import pytest

from surefoot.bus.messages import LegStatus
from surefoot.components.robot_model import LegKinematics, build_model
from surefoot.components.robot_model.rotation import matrix_of
from surefoot.config.robot import load_robot
from surefoot.tools.view.palette import LEG_RGB
from surefoot.tools.view.robot_shapes import RobotShapes

ROBOT = load_robot("aliengo")
P_WB = np.array([0.3, -0.2, 0.38])
QUAT_WB = np.array([0.96, 0.1, -0.2, 0.15]) / np.linalg.norm([0.96, 0.1, -0.2, 0.15])
Q = np.array([0.1, 0.8, -1.5, -0.2, 0.6, -1.2, 0.3, 0.9, -1.7, 0.0, 0.7, -1.4])
STATUS = np.array([LegStatus.STANCE, LegStatus.SWING, LegStatus.PROBING, LegStatus.COLLAPSING])


@pytest.fixture(scope="module")
def shapes():
    return RobotShapes(ROBOT)


def test_feet_are_where_the_leg_kinematics_have_them(shapes):
    feet = shapes.draw(P_WB, QUAT_WB, Q, STATUS)["robot/feet"]
    expected = P_WB + LegKinematics(ROBOT).position(Q.reshape(4, 3)) @ matrix_of(QUAT_WB).T
    assert feet.p_W == pytest.approx(expected)
    assert feet.rgb.tolist() == [list(LEG_RGB[LegStatus(status)]) for status in STATUS]


def test_links_lie_and_turn_as_the_simulators_bodies(shapes):
    mujoco = pytest.importorskip("mujoco")
    from surefoot.config.deployment import Deployment
    from surefoot.hw.mujoco.scene import build_scene

    model, _ = build_scene(Deployment(), ROBOT, 0.6)
    data = mujoco.MjData(model)
    data.qpos[:19] = [*P_WB, *QUAT_WB, *Q]
    mujoco.mj_kinematics(model, data)
    boxes = shapes.draw(P_WB, QUAT_WB, Q, STATUS)["robot/boxes"]
    names = ["trunk", *(f"{leg}_{link}" for leg in ("FL", "FR", "RL", "RR") for link in ("thigh", "calf"))]
    for name, p, quat, size in zip(names, boxes.p_W, boxes.quat_W, boxes.size_m, strict=True):
        geom = model.geom(name)
        assert p == pytest.approx(data.geom_xpos[geom.id])
        assert matrix_of(quat) == pytest.approx(data.geom_xmat[geom.id].reshape(3, 3))
        assert size == pytest.approx(2.0 * geom.size)


def test_the_centre_of_mass_is_that_of_the_rigid_body_model(shapes):
    model = build_model(ROBOT)
    q = np.concatenate([P_WB, np.roll(QUAT_WB, -1), Q])
    assert shapes.com(P_WB, QUAT_WB, Q) == pytest.approx(pin.centerOfMass(model, model.createData(), q))
