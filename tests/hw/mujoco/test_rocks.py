"""Stones are of the sizes and weights asked for, lie still before the robot comes, and are loose."""

import mujoco
import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.distance import pdist

from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.terrain import Rocks, Terrain
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.hw.mujoco.press_test import PressTest
from surefoot.hw.mujoco.scene import build_scene
from surefoot.hw.mujoco.terrain.rocks import settled_stones

ROCKS = Rocks()
LEAST_FRICTION = Hw().friction_min


def deployment(seed=0, **settings):
    return Deployment(terrain=Terrain(kind="rocks", rocks=Rocks(**settings)), hw=Hw(seed=seed))


class Scene:
    """The stones as a run finds them."""

    def __init__(self, seed=0, **settings):
        self.model, self.field = build_scene(deployment(seed, **settings), None, LEAST_FRICTION)
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self.bodies = [i for i in range(self.model.nbody) if self.model.body(i).name.startswith("rock_")]

    def vertices(self, body):
        """(n, 3) corners of a stone in the world."""
        model, data = self.model, self.data
        (geom,) = [i for i in range(model.ngeom) if model.geom_bodyid[i] == body]
        mesh = model.mesh(model.geom_dataid[geom])
        first, number = mesh.vertadr[0], mesh.vertnum[0]
        vertices = model.mesh_vert[first : first + number]
        return vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]


@pytest.fixture(scope="module")
def scene():
    return Scene()


def test_count_sizes_and_densities(scene):
    assert len(scene.bodies) == ROCKS.count == 90
    sizes = np.array([pdist(scene.vertices(body)).max() for body in scene.bodies])
    assert (sizes > ROCKS.size_min_m - 1e-4).all() and (sizes < ROCKS.size_max_m + 1e-4).all()
    assert sizes.min() < 0.06 and sizes.max() > 0.12, "the whole range occurs"
    volumes = np.array([ConvexHull(scene.vertices(body)).volume for body in scene.bodies])
    densities = scene.model.body_mass[scene.bodies] / volumes
    assert (densities > ROCKS.density_min - 1.0).all() and (densities < ROCKS.density_max + 1.0).all()
    assert densities.max() - densities.min() > 400.0


def test_they_lie_in_their_field_on_the_ground(scene):
    corners = [scene.vertices(body) for body in scene.bodies]
    low = np.array([points[:, 2].min() for points in corners])
    assert low.min() > -1e-3, "none is below the ground"
    assert (low < 1e-3).mean() > 0.5, "most lie on it"
    x = np.array([points[:, 0].mean() for points in corners])
    assert x.min() > scene.field.start_x and x.max() < scene.field.end_x + 0.1
    assert scene.field.end_x - scene.field.start_x == pytest.approx(ROCKS.length_m)


@pytest.mark.parametrize("seed", [0, 1])
def test_awake_they_stay_where_they_are(seed):
    # Without sleep and on the most slippery ground: what a run starts from is at rest, not frozen in mid-air.
    scene = Scene(seed)
    scene.model.opt.enableflags = 0
    before = scene.data.xpos.copy()
    for _ in range(300):
        mujoco.mj_step(scene.model, scene.data)
    moved = np.linalg.norm(scene.data.xpos - before, axis=1)
    assert np.percentile(moved, 95) < 1e-3
    assert moved.max() < 0.02


def test_they_sleep_until_something_touches_them():
    scene = Scene()
    data, model = scene.data, scene.model
    assert data.ntree_awake == 0
    data.qvel[model.body_dofadr[scene.bodies[0]]] = 0.5
    mujoco.mj_step(model, data)
    assert 1 <= data.ntree_awake < 30
    for _ in range(2000):
        mujoco.mj_step(model, data)
    assert data.ntree_awake == 0, "and sleep again when it is over"


def test_the_robot_never_sleeps_and_feels_only_its_own_contacts():
    machine = MujocoRobot(deployment())
    for _ in range(50):
        machine.advance()
    model, data = machine.model, machine.data
    assert data.tree_awake[model.body_treeid[model.body("trunk").id]]
    # A stone pushed against another makes contacts in which the robot has no part.
    data.qvel[model.body_dofadr[model.body("rock_0").id] :][:6] = 0.3
    machine.advance()
    geoms = data.contact.geom
    assert not (model.geom_contype[geoms] == 1).any(axis=1).all()
    truth = machine.truth()
    assert "rock" not in truth.body_contact and "ground" not in truth.body_contact


def test_a_stone_bears_where_it_lies_flat_and_tips_where_it_does_not():
    press = PressTest(deployment())
    xs = np.linspace(0.4, 1.05, 8)
    heights = np.array([[press.surface(x, y) for y in (-0.2, -0.1, 0.0, 0.1, 0.2)] for x in xs])
    assert heights.max() > 0.03 and heights.min() >= -1e-6
    sunk = press.label_map(xs, (-0.2, -0.1, 0.0, 0.1, 0.2), 100.0)
    assert sunk.shape == heights.shape
    assert (sunk < 0.005).any() and (sunk > 0.02).any()
    again = PressTest(deployment()).press(xs[2], 0.1, 100.0).displacement_m
    assert again == sunk[2, 3], "every press starts from the settled stones"


def test_other_seeds_other_stones():
    def poses(seed):
        settled_stones.cache_clear()
        return Scene(seed, count=60).data.qpos.copy()

    np.testing.assert_array_equal(poses(1), poses(1))
    assert np.abs(poses(1) - poses(2)).max() > 0.05
