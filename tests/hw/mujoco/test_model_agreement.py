"""The robot in MuJoCo and the robot in Pinocchio are one robot."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from surefoot.components.robot_model import build_model, foot_frame_ids
from surefoot.config.deployment import Deployment
from surefoot.config.robot import JOINT_NAMES, LEGS, load_robot
from surefoot.hw.mujoco.scene import build_scene

TOLERANCE = 1e-6


@pytest.fixture(scope="module")
def models():
    robot = load_robot("aliengo")
    mj, _ = build_scene(Deployment(), robot, friction=0.6)
    return mj, mujoco.MjData(mj), build_model(robot)


def random_state(seed):
    """One state in both conventions: (MuJoCo qpos, qvel), (Pinocchio q, v), rotation R_WB."""
    rng = np.random.default_rng(seed)
    p, joints = rng.normal(size=3), rng.uniform(-1.0, 1.0, 12)
    quat = pin.Quaternion(pin.exp3(rng.normal(size=3)))
    R_WB = quat.matrix()
    v_W, omega_B, dq = rng.normal(size=3), rng.normal(size=3), rng.normal(size=12)
    mj = np.concatenate([p, [quat.w, quat.x, quat.y, quat.z], joints]), np.concatenate([v_W, omega_B, dq])
    pn = np.concatenate([p, quat.coeffs(), joints]), np.concatenate([R_WB.T @ v_W, omega_B, dq])
    return mj, pn, R_WB


def set_state(mj, data, state):
    data.qpos[:], data.qvel[:] = state
    mujoco.mj_forward(mj, data)


def test_joints_come_in_the_same_order(models):
    mj, _, model = models
    assert tuple(mj.joint(i).name for i in range(1, mj.njnt)) == JOINT_NAMES
    assert tuple(model.names)[2:] == JOINT_NAMES


@pytest.mark.parametrize("seed", range(4))
def test_mass_centre_of_mass_and_feet(models, seed):
    mj, data, model = models
    state, (q, v), _ = random_state(seed)
    set_state(mj, data, state)
    pin_data = model.createData()
    pin.forwardKinematics(model, pin_data, q, v)
    pin.updateFramePlacements(model, pin_data)
    np.testing.assert_allclose(mj.body_mass.sum(), pin.computeTotalMass(model), atol=TOLERANCE)
    np.testing.assert_allclose(
        data.subtree_com[mj.body("trunk").id], pin.centerOfMass(model, pin_data, q), atol=TOLERANCE
    )
    for leg, frame in zip(LEGS, foot_frame_ids(model), strict=True):
        foot = mj.geom(f"{leg}_foot").id
        np.testing.assert_allclose(data.geom_xpos[foot], pin_data.oMf[frame].translation, atol=TOLERANCE)


def velocity_map(R_WB):
    """Pinocchio's v = T qvel: MuJoCo's base velocity is in the world, Pinocchio's in the base."""
    T = np.eye(18)
    T[:3, :3] = R_WB.T
    return T


@pytest.mark.parametrize("seed", range(4))
def test_joint_space_inertia_and_foot_jacobians(models, seed):
    mj, data, model = models
    state, (q, _), R_WB = random_state(seed)
    set_state(mj, data, state)
    pin_data = model.createData()
    T = velocity_map(R_WB)
    M = pin.crba(model, pin_data, q)
    M = np.triu(M) + np.triu(M, 1).T
    M_mujoco = np.zeros((18, 18))
    mujoco.mj_fullM(mj, data, M_mujoco)
    np.testing.assert_allclose(M_mujoco, T.T @ M @ T, atol=TOLERANCE)
    pin.computeJointJacobians(model, pin_data, q)
    pin.updateFramePlacements(model, pin_data)
    for leg, frame in zip(LEGS, foot_frame_ids(model), strict=True):
        foot = mj.geom(f"{leg}_foot").id
        J = np.zeros((3, 18))
        mujoco.mj_jacGeom(mj, data, J, None, foot)
        J_pin = pin.getFrameJacobian(model, pin_data, frame, pin.LOCAL_WORLD_ALIGNED)[:3] @ T
        np.testing.assert_allclose(J, J_pin, atol=TOLERANCE)


@pytest.mark.parametrize("seed", range(4))
def test_centroidal_momentum_matrix(models, seed):
    mj, data, model = models
    state, (q, _), R_WB = random_state(seed)
    set_state(mj, data, state)
    A = pin.computeCentroidalMap(model, model.createData(), q) @ velocity_map(R_WB)
    trunk = mj.body("trunk").id
    linear = np.zeros((3, 18))
    mujoco.mj_jacSubtreeCom(mj, data, linear, trunk)
    np.testing.assert_allclose(mj.body_mass.sum() * linear, A[:3], atol=TOLERANCE)
    angular = np.zeros((3, 18))
    mujoco.mj_angmomMat(mj, data, angular, trunk)
    np.testing.assert_allclose(angular, A[3:], atol=TOLERANCE)
