"""Settings of the state machine: the paper's numbers, and what it leaves open."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from surefoot.config.quantities import Share
from surefoot.config.typed_toml import ConfigError, Tuned, Within, ordered

Goal = Annotated[float, Within(0.0, 1000.0)]
Distance = Annotated[float, Within(0.0, 0.5)]
Advance = Annotated[float, Within(0.001, 0.5)]  # what does not advance is tried for ever
Reach = Annotated[float, Within(0.05, 2.0)]
Height = Annotated[float, Within(0.001, 0.5)]
Pause = Annotated[float, Within(0.0, 10.0)]
Duration = Annotated[float, Within(0.02, 60.0)]
Flight = Annotated[float, Within(0.05, 10.0)]  # longer than the 30 ms before its end in which contact is due
SwingShare = Annotated[float, Within(0.1, 1.0)]  # a foot that has just lifted off is still near the ground
Speed = Annotated[float, Within(0.005, 2.0)]  # above 0: it is waited for, or divided by
Force = Annotated[float, Within(0.0, 500.0)]
Tilt = Annotated[float, Within(0.05, 1.5)]
Leg = Annotated[int, Within(0, 3)]


@dataclass(frozen=True)
class Fsm:
    """Lengths, times and thresholds of stepping and probing (Sec. II-D)."""

    goal_m: Tuned[Goal] = 1.0  # every foot advances this far in the direction commanded, then it stands; 0: never

    # Targets and candidates.
    step_m: Tuned[Advance] = 0.10  # the target base pose lies this far ahead (Sec. II-D.1)
    step_min_m: Distance = 0.05  # a foot whose target is not even this far ahead of it is left where it is
    alternatives: Tuned[Annotated[int, Within(0, 20)]] = 3  # (Sec. II-D.3)
    alternative_spacing_m: Tuned[Advance] = 0.075
    base_height_min_m: Reach = 0.27  # of the hip axes; the base is lowered as far as this to reach a candidate
    base_height_step_m: Annotated[float, Within(0.001, 0.1)] = 0.01
    leg_length_plan_m: Reach = 0.40  # planned reach: eq. (5) keeps the base a few centimetres short of its pose
    put_off: Tuned[bool] = (
        True  # a leg without a safe foothold waits for another to move; false: STOPPED at once (II-D.5)
    )
    depth_reserve_m: Distance = 0.0  # the ground of a candidate may lie this much lower and must still be in reach
    leg_length_max_m: Reach = 0.470  # a foot that looks for ground stops here (Sec. II-D.4)

    # Base shift before a swing.
    base_reference: Literal["polygon", "stride"] = "polygon"  # while probing: inside the triangle, or the stride's
    stride_s: Duration = 4.0  # duration of a stride (Sec. II-B.3)
    margin_m: Distance = 0.02  # alpha of eq. (5); Table I's barrier holds the CoM another 1-3 cm inside
    margin_extra_m: Distance = 0.02  # the base is sent this much further inside
    shift_s: Duration = 0.4  # least duration
    shift_speed: Tuned[Speed] = 0.2  # mean speed of longer shifts [m/s]
    shift_margin_m: Distance = 0.035  # lift-off once the centre of mass is this far inside ...
    shift_rest_speed: Speed = 0.08  # ... slower than this [m/s] ...
    shift_hold_s: Pause = 0.04  # ... for this long
    shift_timeout_s: Duration = 3.0

    # Swing.
    swing_s: Tuned[Flight] = 0.5
    swing_height_m: Tuned[Height] = 0.08
    swing_v_lift: Annotated[float, Within(0.0, 2.0)] = 0.1  # [m/s]
    swing_v_touch: Speed = 0.1  # slow: an impact is itself a probe [m/s]
    contact_armed: SwingShare = 0.6  # share of the swing after which contact counts as early touch-down
    early_contact_n: Tuned[Force] = 25.0  # what counts as contact before the touch-down is due [N]
    descend_m: Advance = 0.12  # below the expected ground, then the foothold is given up

    # Probing.
    probing: bool = True  # false: the paper's baseline, feet are trusted on contact
    support_polygon: bool = True  # eq. (5)
    fixed_force_n: Tuned[Force] = 0.0  # > 0: this normal force instead of the optimised envelope
    force_over_static: Tuned[Annotated[float, Within(0.5, 3.0)]] = 1.0  # most that is asked, of what statics allow
    cap_forces: Tuned[bool] = False  # mpc and trajopt spare feet what is above their certificates
    adaptive_probing: Tuned[bool] = False  # a foothold that the map knows to bear enough is not probed again
    dwell_s: Duration = 0.1  # each force (Sec. II-C)
    blend_s: Pause = 0.03  # change from one force to the next, inside the dwell
    settle_s: Pause = 0.12  # from contact to the first force: the base leans towards the foot in this time
    unload_s: Pause = 0.08  # after the last force, before the foot hops on ...
    unload_n: Force = 12.0  # ... it is brought down to this
    yield_m: Tuned[Advance] = 0.015  # a stance foot that moves this far while another presses ends the press
    collapse_m: Tuned[Annotated[float, Within(0.001, 0.3)]] = 0.03  # displacement that is a collapse (Sec. II-D.5)
    held_share: Tuned[Share] = 0.8  # a force counts as held above this share of what was asked

    # Around the foothold.
    probe_around: bool = True
    around_radius_m: Tuned[Advance] = 0.025  # the foot pad's radius (Sec. II-D.5)
    around_drop_m: Tuned[Distance] = 0.02  # a foothold beside which the ground lies this much lower is on an edge
    hop_s: Flight = 0.2
    hop_height_m: Height = 0.02

    # After a collapse.
    leg_up_s: Flight = 0.3
    leg_up_below_hip_m: Reach = 0.27

    # A step is given up ...
    tilt_hold: Tilt = 0.35  # ... when the trunk tilts this far from the local plane [rad] ...
    margin_hold_m: Distance = 0.005  # ... or the centre of mass is less than this inside the other feet ...
    unsteady_s: Pause = 0.04  # ... for this long

    # Postures and limits.
    hold_s: Pause = 0.0  # a damped robot's gains come up in this time before it stands up; 0: at once
    hold_error: Annotated[float, Within(0.01, 1.0)] = 0.15  # a joint that leaves its hold so far is damped [rad]
    posture_speed: Annotated[float, Within(0.05, 10.0)] = 0.8  # of the fastest joint in JOINT mode [rad/s]
    posture_min_s: Duration = 0.2
    posture_error_max: Annotated[float, Within(0.05, 3.0)] = 0.3  # beyond it a joint has not stood up [rad]
    put_down_s: Duration = 4.0  # to sit: so long a leg in the air looks for where it stood
    tilt_max: Tilt = 0.7  # beyond this the robot has fallen and is damped [rad]
    crawl_order: tuple[Leg, Leg, Leg, Leg] = (2, 0, 3, 1)  # RL, FL, RR, FR

    def __post_init__(self) -> None:
        if sorted(self.crawl_order) != [0, 1, 2, 3]:
            raise ConfigError(
                f"crawl_order = {list(self.crawl_order)}: name each of the legs 0 to 3 once, such as [2, 0, 3, 1]"
            )
        if self.step_min_m >= self.step_m:
            raise ConfigError(
                f"step_min_m = {self.step_min_m} is not below step_m = {self.step_m}: no foot would ever be far "
                "enough behind its target; lower the one or raise the other"
            )
        ordered(self, "leg_length_plan_m", "leg_length_max_m", "a planned foothold would be out of a leg's reach")
        ordered(self, "shift_hold_s", "shift_timeout_s", "the wait before a lift-off would always time out")
        ordered(self, "blend_s", "dwell_s", "a force would be over before it is reached")
        sent = self.margin_m + self.margin_extra_m
        if self.shift_margin_m > sent:
            raise ConfigError(
                f"shift_margin_m = {self.shift_margin_m} is above margin_m + margin_extra_m = {sent:g}: "
                "lift-off would wait for more than the base is sent inside"
            )
