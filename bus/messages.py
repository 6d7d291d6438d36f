"""Every message of the stack. Frames: W world (z up, gravity along -z), B trunk. Legs FL, FR, RL, RR.

A name such as p_WB reads "position of B in W"; R_WB turns vectors of B into W; v_WB_W is the velocity of
B relative to W, expressed in W. Quaternions are (w, x, y, z). All units are SI.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, IntFlag

import numpy as np

from surefoot.bus.message import Message, array, flag, integer, names, number, text


class ControlMode(IntEnum):
    """What the whole-body controller does with its joints."""

    DAMP = 0
    """Damping only: the safe state."""
    JOINT = 1
    """Joint-space interpolation between two postures: stand up, sit down."""
    BALANCE = 2
    """The MPC's policy through the whole-body QP."""


class LegStatus(IntEnum):
    """What the state machine knows of a leg; the estimator and the momentum observer weigh feet by it."""

    STANCE = 0
    SWING = 1
    LANDING = 2
    """Touch-down is due or awaited."""
    PROBING = 3
    """In contact on ground that is not trusted yet."""
    COLLAPSING = 4
    """In contact with ground that gives way, until unloaded."""


class Unsafe(IntFlag):
    """Why the VFA takes a cell for unsafe (Sec. II-A); a safe cell has none of them."""

    UNKNOWN = 1
    """Nothing has been seen there."""
    UNCERTAIN = 2
    """Its height is not known well enough, or was seen too long ago."""
    ROUGH = 4
    """The ground under the foot is no plane."""
    STEEP = 8
    EDGE = 16
    """The ground drops or rises within the foot's disc."""
    LEG = 32
    """The foot or the shank would meet the ground on the way or when it stands."""
    REACH = 64
    """Out of the leg's reach from the target base pose."""
    COLLAPSED = 128
    """Probing has found that it gives way."""


@dataclass(frozen=True, eq=False, kw_only=True)
class HardwareState(Message):
    """`hw/state`: what the robot's sensors gave in one cycle. Nothing else reaches a controller."""

    q: np.ndarray = array(12, doc="joint angles", unit="rad")
    dq: np.ndarray = array(12, doc="joint velocities", unit="rad/s")
    tau: np.ndarray = array(12, doc="motor torque estimates, before the joint's own friction", unit="N m")
    omega_WB_B: np.ndarray = array(3, doc="gyroscope", unit="rad/s")
    acc_B: np.ndarray = array(3, doc="accelerometer: specific force, +g upwards at rest", unit="m/s^2")
    damping: bool = flag("the command gate damps in this cycle")
    gate: str = text("why the gate damps or limits; empty when it does not")
    foot_force: np.ndarray = array(
        -1, doc="of foot sensors FL, FR, RL, RR: raw, in newtons by hw.unit; empty without; no controller reads it"
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class DepthFrame(Message):
    """`hw/depth`: one image of the body-mounted depth camera.

    Frame C: x along the optical axis, y to the left and z to the top of the image. Row 0 is the top, column 0 the
    left; the ray of a pixel leaves through the middle of its share of the image plane.
    """

    p_BC: np.ndarray = array(3, doc="camera in the trunk", unit="m")
    quat_BC: np.ndarray = array(4, doc="camera in the trunk, (w, x, y, z)")
    fov: np.ndarray = array(2, doc="horizontal and vertical field of view", unit="rad")
    depth_m: np.ndarray = array(
        -1,
        -1,
        dtype="float32",
        doc="distance along the optical axis; 0 where there is none: dropped, out of range, the robot itself",
        unit="m",
        finite=False,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class JointCommand(Message):
    """`joint/command`: the motor law tau + kp (q - q_measured) + kd (dq - dq_measured), per joint."""

    q: np.ndarray = array(12, doc="joint angle reference", unit="rad")
    dq: np.ndarray = array(12, doc="joint velocity reference", unit="rad/s")
    kp: np.ndarray = array(12, doc="position gain", unit="N m/rad")
    kd: np.ndarray = array(12, doc="velocity gain", unit="N m s/rad")
    tau: np.ndarray = array(12, doc="feed-forward torque", unit="N m")
    force_W: np.ndarray = array(4, 3, doc="ground reaction the torques are meant to cause", unit="N")
    policy_age_s: float = number("age of the MPC policy that was used; -1 without one", "s")
    solver: str = text("'ok', or why the whole-body QP was not used in this step")


@dataclass(frozen=True, eq=False, kw_only=True)
class StateEstimate(Message):
    """`state/estimate`: base, feet and contact forces from IMU, encoders and torque estimates alone."""

    p_WB: np.ndarray = array(3, doc="trunk origin in the world", unit="m")
    quat_WB: np.ndarray = array(4, doc="trunk orientation, (w, x, y, z)")
    v_WB_W: np.ndarray = array(3, doc="velocity of the trunk origin, in the world", unit="m/s")
    omega_WB_B: np.ndarray = array(3, doc="angular velocity, in the trunk, bias removed", unit="rad/s")
    q: np.ndarray = array(12, doc="joint angles", unit="rad")
    dq: np.ndarray = array(12, doc="joint velocities", unit="rad/s")
    p_WF: np.ndarray = array(4, 3, doc="foot centres: base estimate and leg kinematics", unit="m")
    v_WF: np.ndarray = array(4, 3, doc="foot velocities", unit="m/s")
    force_W: np.ndarray = array(4, 3, doc="ground reaction on each foot, eq. (7), low-passed", unit="N")
    contact: np.ndarray = array(4, doc="contact by eq. (7) after three successive hits", dtype="bool")
    normal_W: np.ndarray = array(3, doc="local surface normal: plane through the latest contacts")
    covariance: np.ndarray = array(9, 9, doc="error covariance of (position, velocity, rotation in W)")
    foot_std_m: np.ndarray = array(4, 3, doc="standard deviation of each foot position state", unit="m")


@dataclass(frozen=True, eq=False, kw_only=True)
class MotionReference(Message):
    """`fsm/reference`: all that mpc, wbc and estimator need of the state machine, as functions of time.

    The base moves linearly from `base_from` at `base_t0` to `base_to` at `base_t1`. A foot in stance is at
    `p_WF`. One leg may swing, from lift-off `swing_t0` to touch-down `swing_t1`; without `swing_lands` it
    stays in the air at `swing_to` (LEG_UP). Past `swing_t1` a landing foot descends along -normal at
    `swing_v_touch` until the state machine has seen contact.
    """

    state: str = text("state of Fig. 6, or a posture: DAMP, HOLD, STAND_UP, STAND, SIT_DOWN, ...")
    reason: str = text("why the machine entered this state")
    mode: int = integer("a ControlMode")
    leg: int = integer("leg being moved or probed; -1 none", default=-1)
    candidate: int = integer("0 the planned foothold, from 1 on the alternatives")
    around: int = integer("0 the foothold, 1..4 front, back, left, right of it, 5 back on it")
    force_index: int = integer("which of the six forces is applied; -1 none", default=-1)
    finished: bool = flag("the machine has reached its goal and stands")

    joint_from: np.ndarray = array(12, doc="JOINT mode: posture at joint_t0", unit="rad")
    joint_to: np.ndarray = array(12, doc="JOINT mode: posture at joint_t1", unit="rad")
    joint_t0: float = number("JOINT mode: its beginning", "s")
    joint_t1: float = number("JOINT mode: its end", "s")

    base_from: np.ndarray = array(6, doc="x, y, z [m] of the trunk origin, roll, pitch, yaw [rad] at base_t0")
    base_to: np.ndarray = array(6, doc="the same at base_t1 and after")
    base_t0: float = number("the base begins to move", "s")
    base_t1: float = number("the base has arrived", "s")

    p_WF: np.ndarray = array(4, 3, doc="foot centres of stance legs; last safe foothold otherwise", unit="m")
    leg_status: np.ndarray = array(4, doc="a LegStatus for each leg", dtype="int64")
    normal_W: np.ndarray = array(3, doc="local surface normal")

    swing_leg: int = integer("-1 none", default=-1)
    swing_t0: float = number("lift-off", "s")
    swing_t1: float = number("touch-down", "s")
    swing_from: np.ndarray = array(3, doc="foot centre at lift-off, in W", unit="m")
    swing_to: np.ndarray = array(3, doc="foot centre at touch-down, in W", unit="m")
    swing_v_from: np.ndarray = array(3, doc="foot velocity at the start of a swing that does not land", unit="m/s")
    swing_height: float = number("apex above the higher of the two ends", "m")
    swing_v_lift: float = number("speed along the normal at lift-off", "m/s")
    swing_v_touch: float = number("speed against the normal at touch-down and after", "m/s")
    swing_lands: bool = flag("contact is meant to follow", default=True)

    support_leg: int = integer("leg left out of the support polygon of eq. (5); -1 constraint off", default=-1)
    support_t0: float = number("eq. (5) is active from here on", "s")
    support_t1: float = number("and until here", "s")
    support_margin_m: float = number("alpha of eq. (5)", "m")

    probe_leg: int = integer("leg that eq. (6) acts on; -1 none", default=-1)
    probe_t0: float = number("start of the first force", "s")
    probe_dwell_s: float = number("duration of each force", "s")
    probe_blend_s: float = number("linear change from one force to the next, inside its dwell", "s")
    probe_force_W: np.ndarray = array(
        -1, 3, doc="forces in order; the first entry is the force before probe_t0", unit="N"
    )

    region_a: np.ndarray = array(4, 3, doc="eq. (4): rows A of the swing leg's convex region")
    region_b: np.ndarray = array(4, doc="eq. (4): b", unit="m")
    region_active: bool = flag("false: the swing leg may touch down on the whole plane")
    force_max_n: np.ndarray = array(
        4, doc="largest normal force each foothold is certified for; 0: the limit of the robot", unit="N"
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Policy(Message):
    """`mpc/policy`: the optimised trajectory from `t` on, N intervals of `dt`.

    State x (24): momentum/mass (linear, angular about the CoM, in W), base position, roll, pitch, yaw (ZYX),
    joints. Input u (24): four contact forces in W, twelve joint velocities.
    """

    dt: float = number("interval", "s")
    x: np.ndarray = array(-1, 24, doc="states at the N+1 nodes")
    u: np.ndarray = array(-1, 24, doc="inputs over the N intervals")
    v: np.ndarray = array(
        -1, 18, doc="generalised velocities at the N+1 nodes: base linear and angular in B, joints"
    )
    contact: np.ndarray = array(-1, 4, doc="planned contact of the N+1 nodes", dtype="bool")
    solver: str = text("'ok', or what failed by name")
    constraint: tuple[str, ...] = names("names of the constraints in `violation`")
    violation: np.ndarray = array(
        -1,
        doc="largest violation of each constraint over the horizon, in its unit, by the trajectory this tick "
        "started from: the one before the step that gave `x` and `u`",
    )
    stage: tuple[str, ...] = names("names of the stages in `stage_ms`")
    stage_ms: np.ndarray = array(-1, doc="wall time of each stage of this tick", unit="ms", volatile=True)


@dataclass(frozen=True, eq=False, kw_only=True)
class PlanRequest(Message):
    """`trajopt/request`: optimise one stride from the present state, eqs. (1)-(4)."""

    id: int = integer("echoed in the plan")
    leg_order: np.ndarray = array(4, doc="legs in the order they move; the first one probes", dtype="int64")
    p_WF: np.ndarray = array(4, 3, doc="present footholds", unit="m")
    lifted: bool = flag("the first leg is in the air already")
    target_WF: np.ndarray = array(4, 3, doc="reference touch-down positions", unit="m")
    base_target: np.ndarray = array(6, doc="x, y, z, roll, pitch, yaw at the end of the stride")
    normal_W: np.ndarray = array(3, doc="local surface normal")
    region_a: np.ndarray = array(4, 4, 3, doc="eq. (4): rows A_i of each leg's convex region")
    region_b: np.ndarray = array(4, 4, doc="eq. (4): b_i", unit="m")
    region_active: np.ndarray = array(4, doc="false: the whole plane", dtype="bool")
    force_max_n: np.ndarray = array(
        4, doc="largest normal force each present foothold is certified for; 0: the limit of the robot", unit="N"
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Plan(Message):
    """`trajopt/plan`: the optimised stride and the GRF envelope of the probing foot."""

    id: int = integer("of the request")
    status: str = text("'ok', or what failed by name")
    footholds_WF: np.ndarray = array(4, 3, doc="touch-down positions", unit="m")
    envelope_W: np.ndarray = array(6, 3, doc="full force vectors at the extrema, by rising normal force", unit="N")
    dt: float = number("interval", "s")
    x: np.ndarray = array(-1, 24, doc="states as in Policy")
    u: np.ndarray = array(-1, 24, doc="inputs as in Policy")
    iterations: int = integer("SQP iterations used")
    solve_ms: float = number("wall time", "ms", volatile=True)


@dataclass(frozen=True, eq=False, kw_only=True)
class FootholdRequest(Message):
    """`foothold/request`: ask for the safe region nearest each target (SEND of Fig. 6)."""

    id: int = integer("echoed in the answer")
    target_WF: np.ndarray = array(4, 3, doc="desired touch-down positions of the foot centres", unit="m")
    p_WF: np.ndarray = array(4, 3, doc="present foot centres: where the swings start", unit="m")
    base_target: np.ndarray = array(6, doc="x, y, z, roll, pitch, yaw of the trunk at the end of the stride")
    normal_W: np.ndarray = array(3, doc="local surface normal")


@dataclass(frozen=True, eq=False, kw_only=True)
class FootholdRegions(Message):
    """`foothold/regions`: adapted footholds, their convex regions of eq. (4) and the heightmaps they come from."""

    id: int = integer("of the request")
    foothold_WF: np.ndarray = array(4, 3, doc="foot centre on the safe cell nearest each target", unit="m")
    safe: np.ndarray = array(
        4, doc="false: the map knows the place and no cell of it is safe; true without a map", dtype="bool"
    )
    region_a: np.ndarray = array(4, 4, 3, doc="rows A_i: A p + b >= 0")
    region_b: np.ndarray = array(4, 4, doc="b_i", unit="m")
    region_active: np.ndarray = array(4, doc="false: no map there, the whole plane is allowed", dtype="bool")
    held_n: np.ndarray = array(4, doc="normal force that the foothold is known to bear; 0 untested", unit="N")
    reasons: tuple[str, ...] = names("for each leg, why it is where it is, or why it is the whole plane")
    cell_m: float = number("side of a cell", "m")
    heightmap_p_W: np.ndarray = array(4, 2, doc="x, y of each heightmap's first cell's centre", unit="m")
    heightmap_m: np.ndarray = array(
        4, 15, 15, dtype="float32", doc="foothold heightmaps, x by y; NaN unknown", unit="m", finite=False
    )
    heightmap_unsafe: np.ndarray = array(4, 15, 15, dtype="int64", doc="Unsafe flags of each cell; 0 safe")


@dataclass(frozen=True, eq=False, kw_only=True)
class ElevationGrid(Message):
    """`map/elevation`: the robot-centric map; arrays are x by y, cells aligned with the world's axes."""

    cell_m: float = number("side of a cell", "m")
    p_W: np.ndarray = array(2, doc="x, y of the first cell's centre", unit="m")
    height_m: np.ndarray = array(-1, -1, dtype="float32", doc="of the ground; NaN unknown", unit="m", finite=False)
    std_m: np.ndarray = array(
        -1, -1, dtype="float32", doc="standard deviation; NaN unknown", unit="m", finite=False
    )
    age_s: np.ndarray = array(-1, -1, dtype="float32", doc="since it was seen; NaN never", unit="s", finite=False)
    held_n: np.ndarray = array(-1, -1, dtype="float32", doc="largest load that has held; 0 untested", unit="N")
    collapsed_n: np.ndarray = array(
        -1, -1, dtype="float32", doc="load under which, or less, it gave way; 0 none", unit="N"
    )
    drift_m: float = number("correction of the map's height from the contacts", "m")


@dataclass(frozen=True, eq=False, kw_only=True)
class FsmEvent(Message):
    """`fsm/event`: a transition, or a verdict on a foothold, with its reason."""

    kind: str = text(
        "transition; contact, force_held, collapse, accepted, rejected: of the leg that is moved; late_collapse: "
        "of a foothold accepted before; stopped; refused, waiting: of a command"
    )
    state: str = text("state entered or active")
    reason: str = text("in words, with figures")
    leg: int = integer("-1 none", default=-1)
    candidate: int = integer("as in MotionReference")
    around: int = integer("as in MotionReference")
    force_index: int = integer("which of the six forces was held or made the ground give way; -1 none", default=-1)
    p_WF: np.ndarray = array(3, doc="foot centre at the event", unit="m")
    displacement_m: float = number("from the stored contact position", "m")
    asked_n: float = number("normal force asked", "N")
    held_n: float = number(
        "largest normal force estimated while held; of a late collapse, on the foot since it was accepted or, "
        "later, set down again: its ground gave way under that or less",
        "N",
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class OperatorCommand(Message):
    """`operator/command`: what a person asks for, or what is done because nobody is there to ask."""

    command: str = text(
        "a word such as stand, pause or forward, or `direction X Y`; what a person did not type has its reason "
        "after a colon"
    )

    @property
    def word(self) -> str:
        """Without the reason."""
        return self.command.partition(": ")[0]

    @property
    def why(self) -> str:
        """The reason; empty where a person has typed it."""
        return self.command.partition(": ")[2]


@dataclass(frozen=True, eq=False, kw_only=True)
class OperatorAnswer(Message):
    """`operator/answer`: what becomes of a command, in the state machine's words."""

    command: str = text("as it was asked")
    number: int = integer("`seq` of that `operator/command`", default=-1)
    taken: bool = flag("it is obeyed, now or when the step is over; false: refused")
    words: str = text("what the robot does; or why it does not, and what would help")


@dataclass(frozen=True, eq=False, kw_only=True)
class Tuning(Message):
    """`operator/tuning`: every setting that was changed since the run began; who has this one needs no earlier."""

    assignment: tuple[str, ...] = names("section.key=value, as --set takes them; the latest change last")


@dataclass(frozen=True, eq=False, kw_only=True)
class SimTruth(Message):
    """`sim/truth`: the simulator's state, for logs and grading only. No controller may subscribe."""

    p_WB: np.ndarray = array(3, doc="trunk origin", unit="m")
    quat_WB: np.ndarray = array(4, doc="(w, x, y, z)")
    v_WB_W: np.ndarray = array(3, doc="velocity of the trunk origin, in the world", unit="m/s")
    omega_WB_B: np.ndarray = array(3, doc="angular velocity, in the trunk", unit="rad/s")
    q: np.ndarray = array(12, doc="joint angles", unit="rad")
    dq: np.ndarray = array(12, doc="joint velocities", unit="rad/s")
    tau: np.ndarray = array(12, doc="motor torque applied", unit="N m")
    com_W: np.ndarray = array(3, doc="centre of mass of the true, varied robot", unit="m")
    p_WF: np.ndarray = array(4, 3, doc="foot centres", unit="m")
    force_W: np.ndarray = array(4, 3, doc="ground reaction on each foot", unit="N")
    body_contact: str = text("names of trunk, hips, thighs or calves that touch something; empty when none")
    saturated: bool = flag("a motor is at its torque limit")
    power_w: float = number("sum of |torque x velocity|", "W")
    terrain_q: np.ndarray = array(
        -1, doc="positions of moving terrain: angles, heights, poses of stones", unit="rad, m"
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class ProcessStatus(Message):
    """`status/NAME`: a process's health, twice a second."""

    process: str = text("its name")
    life: str = text("INIT, IDLE, ACTIVATING, RUN, DEACTIVATING or FAILED")
    reason: str = text("in words why nothing moves, or what failed; empty when all is well")
    pid: int = integer("of the operating system")
    settings: str = text("digest of the settings that all processes of a run must have alike")
    steps: int = integer("steps since start")
    rate_hz: float = number("steps per second of the run's clock since the last status", "Hz", volatile=True)
    nominal_hz: float = number("steps per second it is to make; 0 when it steps on events", "Hz")
    step_p50_ms: float = number("wall time of the last steps, median", "ms", volatile=True)
    step_p99_ms: float = number("99th percentile", "ms", volatile=True)
    step_max_ms: float = number("longest", "ms", volatile=True)
    overruns: int = integer("deadlines missed since start (monotonic clock only)")
    bad_messages: int = integer("messages dropped because they were malformed")
    input: tuple[str, ...] = names("topics read")
    input_age_s: np.ndarray = array(
        -1, doc="age of each input's latest message; -1 none yet", unit="s", volatile=True
    )
