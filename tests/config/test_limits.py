"""Every number has limits, every default is inside them, and what lies outside is refused by name."""

import dataclasses
import math
import types
import typing
from pathlib import Path

import pytest

import surefoot.config.deployment as deployment_module
from surefoot.config.deployment import Deployment, load_deployment
from surefoot.config.robot import Robot, load_robot
from surefoot.config.typed_toml import ConfigError, Within, build, to_table, with_override
from surefoot.config.unit import Unit

CONFIG = Path(deployment_module.__file__).parent


def numbers(hint, path):
    """(path, limits) of every number a type holds; limits is None where it has none."""
    origin, args = typing.get_origin(hint), typing.get_args(hint)
    if origin is typing.Annotated:
        limits = [mark for mark in args[1:] if isinstance(mark, Within)]
        yield from [(path, limits[0])] if limits else numbers(args[0], path)
    elif dataclasses.is_dataclass(hint):
        hints = typing.get_type_hints(hint, include_extras=True)
        for field in dataclasses.fields(hint):
            yield from numbers(hints[field.name], f"{path}.{field.name}".lstrip("."))
    elif origin in (tuple, list, dict, typing.Union, types.UnionType):
        for arg in args:
            yield from numbers(arg, path)
    elif hint in (int, float):
        yield path, None


def leaves(value, path=()):
    """(path, key by key; value) of every number in a table."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if inner is not None:
        for key, item in inner:
            yield from leaves(item, (*path, key))
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, value


def table_of(assignments):
    """The table of assignments with a space between them."""
    table = {}
    for assignment in assignments.split(" "):
        table = with_override(table, assignment)
    return table


@pytest.mark.parametrize("cls", [Deployment, Robot, Unit])
def test_every_number_has_two_finite_limits(cls):
    found = list(numbers(cls, ""))
    bare = [path for path, limits in found if not isinstance(limits, Within)]
    assert not bare, f"give {', '.join(bare)} an Annotated[..., Within(least, most)]"
    for path, limits in found:
        assert math.isfinite(limits.least) and math.isfinite(limits.most) and limits.least < limits.most, path
    assert len(found) > 10


def test_a_number_without_limits_would_be_found():
    @dataclasses.dataclass
    class Careless:
        gains: tuple[float, ...] = (1.0,)
        share: typing.Annotated[float, Within(0.0, 1.0)] = 0.5
        on: bool = True

    assert [path for path, limits in numbers(Careless, "") if limits is None] == ["gains"]


SECTIONS = [field.name for field in dataclasses.fields(Deployment) if field.name != "robot"]


@pytest.mark.parametrize("section", SECTIONS)
def test_the_defaults_of_a_section_are_within_its_limits(section):
    default = getattr(Deployment(), section)
    assert type(default)() == default
    assert build(type(default), to_table(default), section) == default


def test_the_defaults_go_with_each_other_and_so_do_the_deployments():
    assert build(Deployment, to_table(Deployment())) == Deployment()
    for path in CONFIG.glob("*.toml"):
        load_deployment(path)


@pytest.mark.parametrize("robot", [path.stem for path in (CONFIG / "robots").glob("*.toml")])
def test_no_figure_of_a_robot_may_be_absurd(robot):
    figures = load_robot(robot)
    assert build(Robot, to_table(figures), robot) == figures
    for path, value in leaves(to_table(figures)):
        table = to_table(figures)
        inner = table
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = value + 1e6
        with pytest.raises(
            ConfigError, match=rf"{path[-1] if isinstance(path[-1], str) else path[-2]}.*out of range"
        ):
            build(Robot, table)


# A value that used to divide by zero, never end, press nothing or mean nothing, and how it is refused.
OUTSIDE = {
    "estimator.start_x_m=1e6": "-1000 to 1000",
    "estimator.acc=0.0": "1e-05 to 10",
    "estimator.encoder=-0.001": "1e-06 to 0.1",
    "estimator.kinematics=0": "1e-06 to 0.1",
    "estimator.slip_gate=0": "1 to 1e+06",
    "estimator.force_filter_hz=0": "0.5 to 250",
    "estimator.contact_every=0": "1 to 50",
    "estimator.contact_hits=0": "1 to 50",
    "estimator.friction_speed=0": "0.001 to 10",
    "estimator.normal_filter=1.5": "0 to 1",
    "estimator.normal_tilt_max=1.6": "0 to 1.2",
    "fsm.goal_m=-1.0": "0 to 1000",
    "fsm.step_m=0": "0.001 to 0.5",
    "fsm.alternatives=-1": "0 to 20",
    "fsm.base_height_step_m=0": "0.001 to 0.1",
    "fsm.shift_speed=0": "0.005 to 2",
    "fsm.swing_s=0": "0.05 to 10",
    "fsm.swing_v_touch=0": "0.005 to 2",
    "fsm.contact_armed=0": "0.1 to 1",
    "fsm.fixed_force_n=-5": "0 to 500",
    "fsm.dwell_s=0": "0.02 to 60",
    "fsm.collapse_m=0": "0.001 to 0.3",
    "fsm.held_share=1.2": "0 to 1",
    "fsm.posture_speed=0": "0.05 to 10",
    "fsm.tilt_max=4": "0.05 to 1.5",
    "ocp.friction_cone.mu=10 ocp.friction_cone.delta=0": "0.0001 to 10",
    "ocp.force_limits.mu=-1": "0 to 10000",
    "ocp.weights.force=0": "1e-06 to 1e+06",
    "ocp.weights.foot_velocity=0": "1e-06 to 1e+06",
    "ocp.weights.terminal_scale=-1": "0 to 1e+06",
    "ocp.friction=0": "0.05 to 2",
    "ocp.cone_regularisation_n2=0": "0.001 to 10000",
    "ocp.joint_velocity_limit=0": "0.5 to 100",
    "ocp.step_force_n=0": "1 to 10000",
    "trajopt.intervals=0": "10 to 1000",
    "trajopt.interval_s=0": "0.005 to 0.5",
    "trajopt.shift_s=-0.1": "0 to 10",
    "trajopt.iterations=0": "1 to 200",
    "trajopt.envelope_scale=0": "0.1 to 5",
    "trajopt.cone_regularisation_n2=0": "0.001 to 10000",
    "wbc.kd=600": "0 to 500",
    "wbc.force_weight=0": "1e-06 to 1e+06",
    "wbc.friction=-0.3": "0.05 to 2",
    "wbc.friction_speed=0": "0.001 to 10",
    "hw.damping_kd=0": "0.1 to 20",
    "wbc.lower_speed=0": "0.005 to 1",
    "wbc.blend_s=0": "0.001 to 10",
    "wbc.observer_gain=0": "0.01 to 250",
    "wbc.failures_max=-1": "0 to 250",
    "terrain.planks.rows=0": "1 to 50",
    "terrain.planks.stiffness=0": "1 to 100000",
    "terrain.planks.board_mass=0": "0.1 to 100",
    "terrain.planks.frame_height_m=0": "0.02 to 5",
    "hw.depth.slit_m=-1": "0 to 0.1",
    "hw.depth.rate_hz=1": "4 to 60",
    "elevation_map.std_min_m=0": "0.0001 to 0.2",
    "elevation_map.gate=0": "1 to 10000",
    "elevation_map.takeover_frames=0": "1 to 100",
    "elevation_map.publish_s=0": "0.05 to 60",
    "run.epoch_s=-1": "0 to 1e+10",
    "run.speed=0": "0.02 to 1",
    "elevation_map.vfa.age_max_s=0": "1 to 100000",
    "elevation_map.vfa.std_max_m=0": "0.001 to 0.5",
    "elevation_map.vfa.disc_gaps_max=0.6": "0 to 0.5",
    "elevation_map.vfa.slope_max=1.6": "0.05 to 1.2",
    "hw.aliengo.stale_s=0": "0.004 to 1",
    "hw.gate.torque_share=1.2": "0.05 to 1",
    "emulator.states.loss=1.1": "0 to 1",
    "emulator.commands.corrupt_bits=0": "1 to 1000",
    "emulator.motors.heating_s=0": "0.01 to 10000",
    "emulator.tick_start=-1": "0 to 4.29497e+09",
}


@pytest.mark.parametrize(("assignments", "allowed"), OUTSIDE.items(), ids=OUTSIDE)
def test_a_value_out_of_range_is_named_with_its_limits(assignments, allowed):
    key, _, value = assignments.split(" ")[-1].partition("=")
    with pytest.raises(ConfigError) as caught:
        build(Deployment, table_of(assignments))
    said = str(caught.value)
    assert said.startswith((f"{key} = {value}: ", f"{key} = {float(value)}: "))
    assert said.endswith(f"out of range, allowed {allowed}")


def test_an_entry_out_of_range_is_named_by_its_place():
    for assignment, said in (
        ("fsm.crawl_order=[2, 0, 4, 1]", r"fsm\.crawl_order\[2\] = 4: out of range, allowed 0 to 3"),
        ("ocp.weights.joints=[2.0, -2.0, 1.0]", r"ocp\.weights\.joints\[1\] = -2\.0: .* 0 to 1e\+06"),
        ("wbc.wrench_weight=[1, 1, 1, 1, 1, -1]", r"wbc\.wrench_weight\[5\] = -1\.0: .* 0 to 1e\+06"),
    ):
        with pytest.raises(ConfigError, match=said):
            build(Deployment, with_override({}, assignment))


ALL = "['io','estimator','wbc','mpc','fsm','trajopt','elevation_map']"

# Values that are possible alone, but not together.
TOGETHER = {
    "estimator.contact_off_n=12": r"estimator: contact_off_n = 12\.0 is above contact_on_n = 10\.0",
    "estimator.stance_rate=0.5": r"estimator: stance_rate = 0\.5 is above probing_rate = 0\.2",
    "estimator.tilt_start=0.5 estimator.position_limit=0.4": r"tilt_start = 0\.5 reaches position_limit = 0\.4",
    "calibration.swing_hz=1": r"calibration: swing_rad = 0\.25 at swing_hz = 1\.0 .* 1\.57 rad/s: at most 1 rad/s",
    "calibration.swing_rad=0.05": r"swing_rad = 0\.05 .* 0\.16 rad/s: at least three times slow_speed = 0\.1",
    "fsm.crawl_order=[0,0,0,0]": r"fsm: crawl_order = \[0, 0, 0, 0\]: name each of the legs 0 to 3 once",
    "fsm.step_min_m=0.1": r"fsm: step_min_m = 0\.1 is not below step_m = 0\.1",
    "fsm.leg_length_plan_m=0.472": r"fsm: leg_length_plan_m = 0\.472 is above leg_length_max_m = 0\.47",
    "fsm.shift_hold_s=4": r"fsm: shift_hold_s = 4\.0 is above shift_timeout_s = 3\.0",
    "fsm.blend_s=0.2": r"fsm: blend_s = 0\.2 is above dwell_s = 0\.1",
    "fsm.shift_margin_m=0.06": r"fsm: shift_margin_m = 0\.06 is above margin_m \+ margin_extra_m = 0\.04",
    "ocp.force_min_n=50 ocp.force_max_n=40": r"ocp: force_min_n = 50\.0 is above force_max_n = 40\.0",
    "wbc.force_min_n=50 wbc.force_max_n=40": r"wbc: force_min_n = 50\.0 is above force_max_n = 40\.0",
    "trajopt.swing_s=0.7": r"trajopt: shift_s \+ swing_s = 1\.05 .* intervals \* interval_s = 4 s",
    "trajopt.shift_s=0.95 trajopt.swing_s=0.05 trajopt.interval_s=0.1": r"interval_s = 0\.1 is above swing_s",
    "trajopt.envelope_trim_s=1.0 trajopt.shift_s=0 trajopt.intervals=52": r"trim_s = 1\.0 .* at most 0\.925",
    "terrain.planks.board_thickness_m=0.3": r"board_thickness_m = 0\.3 is above frame_height_m = 0\.2",
    "terrain.planks.missing=[[4,0]]": r"missing\[0\] = \[4, 0\]: there are 4 rows and 4 columns",
    "terrain.planks.missing=[[0,0]] terrain.planks.missing_count=1": r"missing_count = 1 with .* not both",
    "terrain.planks.missing_count=6": r"missing_count = 6: at most 5, a third of 4 rows of 4",
    "terrain.slope.angle_min_deg=11": r"^terrain\.slope: angle_min_deg = 11\.0 is above angle_max_deg = 10\.0",
    "terrain.rocks.size_min_m=0.2": r"^terrain\.rocks: size_min_m = 0\.2 is above size_max_m = 0\.15",
    "terrain.rocks.flatness_min=0.7": r"flatness_min = 0\.7 is above flatness_max = 0\.6",
    "terrain.rocks.density_max=1000": r"density_min = 2000\.0 is above density_max = 1000\.0",
    "terrain.rocks.size_max_m=0.4 terrain.rocks.length_m=0.3": r"size_max_m = 0\.4 is above length_m = 0\.3",
    "terrain.rocks.size_max_m=0.4": r"count = 90 of up to 0\.4 m lie about 14\.5 layers high .* at most 6\.0",
    "terrain.tiles.load_min_n=200": r"^terrain\.tiles: load_min_n = 200\.0 is above load_max_n = 160\.0",
    "terrain.tiles.travel_m=0.3": r"travel_m = 0\.3 is above frame_height_m = 0\.2",
    "terrain.tiles.return_n=50": r"return_n = 50\.0 is above load_min_n = 40\.0",
    "terrain.trap.load_min_n=30": r"^terrain\.trap: load_min_n = 30\.0 is above load_max_n = 8\.0",
    "terrain.edge.drop_min_m=0.1": r"^terrain\.edge: drop_min_m = 0\.1 is above drop_max_m = 0\.04",
    "terrain.edge.distance_m=0.01": r"distance_spread_m = 0\.025 is above distance_m = 0\.01",
    "terrain.edge.distance_m=0.6": r"distance_m = 0\.6 \+- .* not within length_m = 0\.25",
    "terrain.foam.sink_max_m=0.0015": r"^terrain\.foam: sink_min_m = 0\.002 is above sink_max_m = 0\.0015",
    "terrain.foam.thickness_m=0.015": r"sink_max_m = 0\.025 is above thickness_m = 0\.015",
    "terrain.lane.sections=[]": r"^terrain\.lane: sections = \[\]: name at least one",
    'terrain.lane.sections=["planks","lane"]': r"^terrain\.lane\.sections\[1\] = 'lane': must be one of 'planks'",
    "mpc.intervals=1": r"mpc: intervals = 1 of interval_s = 0\.015 look 0\.015 s ahead: at least 0\.2 s",
    "wbc.posture_kp=600": r"^wbc\.posture_kp = 600\.0 is above hw\.kp_max = 500\.0",
    "wbc.joint_kd=30": r"^wbc\.joint_kd = 30\.0 is above hw\.kd_max = 20\.0",
    "hw.gate.temperature_warn=90": r"^hw\.gate: temperature_warn = 90\.0 is above temperature_max = 80\.0",
    "hw.kd_max=2": r"^wbc\.posture_kd = 6\.0 is above hw\.kd_max = 2\.0",
    "ocp.swing_height_gain=60": r"^ocp\.swing_height_gain = 60\.0 with trajopt\.interval_s = 0\.05: .* at most 40",
    "ocp.joint_velocity_limit=18": r"^ocp\.joint_velocity_limit = 18\.0: at most the 15\.89 rad/s",
    "wbc.force_min_n=70": r"^wbc\.force_min_n = 70\.0: must be below 61 N",
    "ocp.force_max_n=80": r"^ocp\.force_max_n = 80\.0: must be above 82 N",
    "ocp.cone_regularisation_n2=1000": r"^ocp\.cone_regularisation_n2 = 1000\.0 .* asks 63 N .* below 61 N",
    "ocp.friction=0.08": r"^trajopt\.cone_regularisation_n2 = 25\.0 with ocp\.friction = 0\.08 asks 62 N",
    "fsm.fixed_force_n=300": r"^fsm\.fixed_force_n = 300\.0 is above ocp\.force_max_n = 240\.0",
    "fsm.leg_length_max_m=0.48": r"^fsm\.leg_length_max_m = 0\.48: aliengo's legs reach 0\.474 m",
    "fsm.base_height_min_m=0.45": r"^fsm\.base_height_min_m = 0\.45: aliengo's hips stand at 0\.400 m",
    "fsm.leg_up_below_hip_m=0.45": r"^fsm\.leg_up_below_hip_m = 0\.45: aliengo's hips",
    "terrain.kind=planks terrain.planks.run_up_m=0.5": r"^terrain\.planks\.run_up_m = 0\.5: .* 0\.58 m",
    "elevation_map.cell_m=0.06": r"^elevation_map: vfa\.edge_max_m = 0\.03: .* rises 0\.035 m .*cell_m = 0\.06",
    "elevation_map.cell_m=0.005 elevation_map.length_m=20": r"^elevation_map: .* 1280000 cells, at most 250000",
    "terrain.kind=slope terrain.slope.run_up_m=0.5": r"^terrain\.slope\.run_up_m = 0\.5: .* 0\.58 m",
    'network.hosts={robot=["io"]}': r"^network: hosts: estimator, wbc, .* runs nowhere; name each",
    'network.hosts.laptop=["mpc"]': r"hosts: io, estimator, wbc, .* runs nowhere",
    f"network.hosts={{robot={ALL},laptop=['mpc']}}": r"^network: hosts\.robot: mpc runs twice",
    f"network.hosts={{robot={ALL},laptop=['motor']}}": r"hosts\.laptop: no component 'motor'; there are io, est",
    f"network.hosts={{operator={ALL}}}": r"hosts\.operator: io cannot run there",
    f"network.hosts={{robot={ALL},laptop=[]}}": r"listen is empty: laptop cannot reach robot",
    f"network.hosts={{robot={ALL},laptop=[]}} network.listen=tls/0.0.0.0:1": r"address is empty: .* laptop reach",
    "network.host=laptop": r"^network: host = 'laptop': hosts has robot",
    "network.listen=7448": r"listen = 7448: expected str",
    "network.listen=tls/0.0.0.0": r"listen = 'tls/0\.0\.0\.0': such as \"tls/0\.0\.0\.0:7448\"",
    "network.listen=tls/0.0.0.0:70000": r"listen = 'tls/0\.0\.0\.0:70000': such as",
    "network.listen=udp/0.0.0.0:7448": r"listen = 'udp/0\.0\.0\.0:7448': such as",
    "network.listen=tcp/127.0.0.1:7448": r"tcp lets everyone in; use tls and `surefoot keys init`, or insecure",
    "network.insecure=true network.listen=tcp/0.0.0.0:7448": r"without keys only 127\.0\.0\.1 may listen; use tls",
    "network.address=tls/10.0.0.1:7448": r"address = 'tls/10\.0\.0\.1:7448': a host name or an IP address",
    "hw.backend=aliengo": r"^run\.clock = 'simulated' with hw\.aliengo\.exchange = 'timer': .* set 'monotonic'",
    "hw.backend=aliengo run.clock=monotonic hw.aliengo.exchange=cycle hw.aliengo.address=127.0.0.1": (
        r"^run\.clock = 'monotonic' with hw\.aliengo\.exchange = 'cycle': .* 'simulated' and 'cycle'"
    ),
    "run.speed=0.5": r"^run\.speed = 0\.5 with run\.clock = 'simulated' .* set run\.speed = 1",
    "hw.backend=aliengo run.clock=monotonic run.speed=0.5": r"^run\.speed .* 'aliengo': .* set run\.speed = 1",
    "hw.backend=aliengo run.clock=monotonic run.vision=true": r"^run\.vision = true .* set run\.vision = false",
    "hw.aliengo.exchange=cycle": r"^hw\.aliengo: exchange = 'cycle' with address = '192\.168\.123\.10': .*'timer'",
    "emulator.motors.cooled=95": r"^emulator\.motors: cooled = 95\.0 is above overheated = 90\.0",
    "emulator.motors.ambient=85": r"^emulator\.motors: ambient = 85\.0 is above cooled = 80\.0",
    "emulator.faults=[{kind='silent',joint='FL_hip'}]": r"faults\[0\]: joint = 'FL_hip': silent is of the whole",
    "emulator.faults=[{kind='silent'},{kind='stuck_encoder'}]": r"faults\[1\]\.kind = 'stuck_encoder': must be",
    "emulator.faults=[{kind='silent',begin_s=2,end_s=1}]": r"faults\[0\]: begin_s = 2\.0 is above end_s = 1\.0",
    "robot=spot": r"^robot 'spot' is not described; known: aliengo",
}


@pytest.mark.parametrize(("assignments", "said"), TOGETHER.items(), ids=TOGETHER)
def test_values_that_do_not_go_together_are_named(assignments, said):
    with pytest.raises(ConfigError, match=said):
        build(Deployment, table_of(assignments))


@pytest.mark.parametrize(
    "assignments",
    [
        "fsm.alternatives=0 fsm.goal_m=0 fsm.step_min_m=0",
        "fsm.fixed_force_n=150 fsm.collapse_m=0.01",
        "ocp.support_polygon.mu=10.0 ocp.support_polygon.delta=0.005",
        "ocp.weights.terminal_scale=0 ocp.weights.force=1e-3",
        "ocp.friction=0.8 wbc.friction=0.5",
        "trajopt.intervals=40 trajopt.interval_s=0.1",
        "terrain.kind=planks terrain.planks.stiffness=60 terrain.planks.start_offset_m=0",
        "wbc.observer_force_share=0 wbc.observer_moment_max=0",
        "network.insecure=true network.listen=tcp/127.0.0.1:7448",
        "network.listen=tls/[::]:7448 network.address=fe80::1",
        f"network.hosts={{robot={ALL},pc=[]}} network.listen=tls/0.0.0.0:1 network.address=a network.host=pc",
        "mpc.profile=light mpc.interval_s=0.02 mpc.intervals=50",
        "hw.backend=aliengo run.clock=monotonic hw.aliengo.generation=G0 hw.aliengo.local_port=8008",
        "hw.backend=aliengo hw.aliengo.exchange=cycle hw.aliengo.address=127.0.0.1",
    ],
)
def test_what_a_researcher_may_try_is_let_through(assignments):
    build(Deployment, table_of(assignments))


@pytest.mark.parametrize(
    ("keys", "value", "said"),
    [
        (
            ("joints", "calf", "axis"),
            [0.0, 1.0, 1.0],
            r"joints\.calf: axis = \[0\.0, 1\.0, 1\.0\]: of length 1\.41",
        ),
        (("trunk", "mass"), 0.0, r"trunk\.mass = 0\.0: out of range, allowed 0\.001 to 200"),
        (("trunk", "inertia"), [0.05, 0.2, 0.0, 0.2, 0.0, 0.2], r"trunk: inertia = .* not positive definite"),
        (
            ("legs", "RL", "hip_range"),
            [1.0, -1.0],
            r"legs\.RL: hip_range = \[1\.0, -1\.0\]: the lower limit comes",
        ),
        (("legs", "RL", "calf_range"), [-2.7, 0.5], r"legs\.RL\.calf_range\[1\] = 0\.5: .* -3\.14 to -0\.01"),
        (("nominal", "stand_q"), [0.0, 4.0, -1.4], r"nominal\.stand_q: thigh at 4\.0 rad is outside legs\.FL"),
        (
            ("collision", "hip", "size"),
            [0.05],
            r"collision\.hip: size = \[0\.05\]: a cylinder_y has 2: radius, len",
        ),
    ],
)
def test_a_figure_that_no_robot_has_is_named(keys, value, said):
    table = to_table(load_robot("aliengo"))
    inner = table
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = value
    with pytest.raises(ConfigError, match=said):
        build(Robot, table)
