"""The robot that is exported is the robot of every model here."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import scenes

from surefoot.components.robot_model import build_model, foot_frame_ids
from surefoot.config.robot import JOINT_NAMES, LEGS, load_robot
from surefoot.tools.cli import main
from surefoot.tools.export.mjcf import STAND, mjcf
from surefoot.tools.export.urdf import urdf

TOLERANCE = 1e-9
ROBOT = load_robot("aliengo")


@pytest.fixture(scope="module")
def ours():
    return build_model(ROBOT)


@pytest.fixture(scope="module")
def from_urdf():
    return pin.buildModelFromXML(urdf(ROBOT), pin.JointModelFreeFlyer())


def configuration(ours, seed):
    return pin.randomConfiguration(ours, -np.ones(ours.nq), np.ones(ours.nq)) if seed else pin.neutral(ours)


@pytest.mark.parametrize("seed", range(4))
def test_the_urdf_has_our_mass_matrix_but_for_the_rotors_and_our_feet(ours, from_urdf, seed):
    pin.seed(seed)
    q = configuration(ours, seed)
    data, theirs = ours.createData(), from_urdf.createData()
    M, M_urdf = pin.crba(ours, data, q), pin.crba(from_urdf, theirs, q)
    np.testing.assert_allclose(np.triu(M_urdf) + np.diag(ours.armature), np.triu(M), atol=TOLERANCE)
    pin.framesForwardKinematics(ours, data, q)
    pin.framesForwardKinematics(from_urdf, theirs, q)
    for leg, frame in zip(LEGS, foot_frame_ids(ours), strict=True):
        foot = theirs.oMf[from_urdf.getFrameId(f"{leg}_foot")].translation
        np.testing.assert_allclose(foot, data.oMf[frame].translation, atol=TOLERANCE)


def test_the_urdf_has_our_joints_and_their_limits(ours, from_urdf):
    assert tuple(from_urdf.names)[2:] == JOINT_NAMES == tuple(ours.names)[2:]
    for limit in ("lowerPositionLimit", "upperPositionLimit"):
        np.testing.assert_array_equal(getattr(from_urdf, limit)[7:], getattr(ours, limit)[7:])
    np.testing.assert_array_equal(from_urdf.upperEffortLimit[6:], ROBOT.per_joint("torque_limit"))
    np.testing.assert_array_equal(from_urdf.upperVelocityLimit[6:], ROBOT.per_joint("velocity_limit"))
    assert f"{ROBOT.joints['calf'].armature!r} kg m^2" in urdf(ROBOT)


@pytest.mark.parametrize("seed", range(4))
def test_the_mjcf_has_our_mass_matrix_and_our_feet(ours, seed):
    model = mujoco.MjModel.from_xml_string(mjcf(ROBOT))
    data, theirs = ours.createData(), mujoco.MjData(model)
    pin.seed(seed)
    q = configuration(ours, seed)
    x, y, z, w = q[3:7]
    theirs.qpos[:] = np.concatenate([q[:3], [w, x, y, z], q[7:]])
    mujoco.mj_forward(model, theirs)
    M = pin.crba(ours, data, q)
    M = np.triu(M) + np.triu(M, 1).T
    T = np.eye(18)
    T[:3, :3] = pin.Quaternion(w, x, y, z).matrix().T  # MuJoCo's base velocity is in the world
    found = np.zeros((18, 18))
    mujoco.mj_fullM(model, theirs, found)
    np.testing.assert_allclose(found, T.T @ M @ T, atol=1e-6)  # the file has a diagonal inertia and a rotation
    pin.framesForwardKinematics(ours, data, q)
    for leg, frame in zip(LEGS, foot_frame_ids(ours), strict=True):
        foot = theirs.geom_xpos[model.geom(f"{leg}_foot").id]
        np.testing.assert_allclose(foot, data.oMf[frame].translation, atol=TOLERANCE)


def test_the_mjcf_stands_on_its_floor_and_is_driven_by_torques():
    model = mujoco.MjModel.from_xml_string(mjcf(ROBOT))
    data = mujoco.MjData(model)
    data.qpos[:] = model.key(STAND).qpos
    mujoco.mj_forward(model, data)
    lowest = [data.geom_xpos[model.geom(f"{leg}_foot").id][2] - ROBOT.foot.radius for leg in LEGS]
    np.testing.assert_allclose(lowest, 0.0, atol=1e-3)
    assert [model.actuator(place).name for place in range(model.nu)] == list(JOINT_NAMES)
    np.testing.assert_allclose(model.actuator_ctrlrange[:, 1], ROBOT.per_joint("torque_limit"))


@pytest.mark.parametrize(("kind", "ending"), [("urdf", ".urdf"), ("mjcf", ".xml")])
def test_the_robot_of_a_recording_is_the_one_of_its_name(tmp_path, kind, ending):
    of_clip, of_name = tmp_path / f"a{ending}", tmp_path / f"b{ending}"
    assert main(["export", str(scenes.path("stand")), "--to", kind, "--out", str(of_clip)]) == 0
    assert main(["export", "aliengo", "--to", kind, "--out", str(of_name)]) == 0
    assert of_clip.read_text() == of_name.read_text() != ""
