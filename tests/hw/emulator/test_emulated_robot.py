"""The emulated robot follows whole packets only, tells what it measures, and what is stuck repeats itself."""

from dataclasses import replace

import numpy as np
import pytest
from packet_samples import ANY_ANGLE, GOOD_LAW, PLAUSIBILITY, READING

from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import Deployment
from surefoot.config.emulator import Emulator, Fault, Press
from surefoot.config.hw import Hw
from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.aliengo.command_packet import encode_brake, encode_command
from surefoot.hw.aliengo.generation import G0, G1
from surefoot.hw.aliengo.remote import Button
from surefoot.hw.aliengo.state_packet import decode_state
from surefoot.hw.emulator.emulated_robot import EmulatedRobot

NOISES = ("torque_noise", "encoder_noise", "velocity_noise", "gyro_noise", "gyro_bias", "acc_noise", "acc_bias")
QUIET = dict.fromkeys(NOISES, 0.0)
HOLD = replace(GOOD_LAW, q=np.tile([0.0, 0.7273, -1.4545], 4), kp=np.full(12, 300.0), kd=np.full(12, 8.0))


def robot(generation=G1, start="standing", **settings):
    hw = Hw(start=start, command_delay_s=0.0, aliengo=Aliengo(generation=generation.name), **QUIET)
    return EmulatedRobot(Deployment(hw=hw, emulator=Emulator(**settings)))


def packet(law=HOLD, generation=G1):
    return encode_command(law, generation, PLAUSIBILITY)[0]


def state(machine, generation=G1):
    return decode_state(machine.answer(), generation, READING, PLAUSIBILITY)


def run(machine, cycles, generation=G1):
    """The states of so many cycles."""
    states = []
    for _ in range(cycles):
        machine.advance()
        states.append(state(machine, generation))
    return states


@pytest.mark.parametrize("generation", [G0, G1], ids=lambda generation: generation.name)
def test_it_stands_by_the_law_of_one_packet_and_tells_what_it_measures(generation):
    machine = robot(generation)
    assert machine.take(packet(generation=generation))
    told, truth = run(machine, 250, generation)[-1], machine.plant.truth()
    assert truth.p_WB[2] > 0.38 and machine.t == pytest.approx(0.5)
    for name in ("q", "dq", "tau", "omega_WB_B", "quat_WB"):
        np.testing.assert_allclose(getattr(told, name), getattr(truth, name), atol=1 / 256, err_msg=name)
    np.testing.assert_allclose(told.acc_B, [0.0, 0.0, 9.81], atol=0.2)
    np.testing.assert_allclose(told.foot_force, truth.force_W[:, 2], atol=1.0)
    assert told.foot_force.sum() == pytest.approx(240.0, abs=30.0)
    np.testing.assert_allclose(told.rpy, 0.0, atol=0.02)


def test_the_tick_counts_the_cycles_in_its_unit_from_its_start_and_wraps():
    assert [told.tick for told in run(robot(), 3)] == [2000, 4000, 6000]
    assert [told.tick for told in run(robot(tick_unit="ms", tick_start=2**32 - 3), 3)] == [2**32 - 1, 1, 3]


def test_no_packet_with_a_wrong_bit_is_followed():
    machine, good = robot(), packet()
    machine.take(good)
    law = machine._motors.law(0.0)
    harmful = replace(HOLD, tau=np.full(12, 40.0), kp=np.zeros(12))
    damaged = np.frombuffer(packet(harmful), np.uint8)
    rng = np.random.default_rng(5)
    for n in range(500):
        bits = np.unpackbits(damaged)
        bits[rng.choice(604 * 8, 1 + n % 20, replace=False)] ^= 1
        assert not machine.take(np.packbits(bits).tobytes())
    assert machine.refused == 500 and machine.commands == 1 and "G1 command packet" in machine.trouble
    np.testing.assert_array_equal(machine._motors.law(0.0).tau, law.tau)


def test_garbage_and_the_other_generation_are_refused():
    machine = robot()
    for garbage in (b"", bytes(610), packet(generation=G0), packet()[:-1], packet() + b"\0"):
        assert not machine.take(garbage)
    assert machine.refused == 5


def test_a_stuck_encoder_tells_the_same_again_while_the_joint_moves():
    joint = JOINT_NAMES.index("FR_calf")
    machine = robot(faults=(Fault("stuck encoder", "FR_calf", begin_s=0.02, end_s=0.06),))
    machine.take(encode_brake(G1))  # it sinks
    told = run(machine, 50)
    angles = [each.q[joint] for each in told]
    stuck = angles[8:29]
    assert len(set(stuck)) == 1 and len(set(angles[:9])) > 5 and angles[29] != stuck[-1]
    others = [each.q[JOINT_NAMES.index("FL_calf")] for each in told[8:29]]
    assert len(set(others)) > 10


def test_a_stuck_imu_and_a_stuck_tick_stand_still():
    machine = robot(faults=(Fault("stuck imu", begin_s=0.02), Fault("stuck tick", begin_s=0.04)))
    machine.take(encode_brake(G1))
    told = run(machine, 40)
    assert len({each.omega_WB_B.tobytes() + each.acc_B.tobytes() for each in told[10:]}) == 1
    assert len({each.omega_WB_B.tobytes() for each in told[:8]}) == 8
    assert [each.tick for each in told[17:22]] == [36000, 38000, 38000, 38000, 38000]
    assert len({each.q.tobytes() for each in told[20:]}) > 10


def test_a_silent_robot_answers_nothing_and_goes_on():
    machine = robot(faults=(Fault("silent", begin_s=0.01, end_s=0.02),))
    answers = []
    for _ in range(12):
        machine.advance()
        answers.append(machine.answer())
    assert [answer is None for answer in answers] == [False] * 4 + [True] * 5 + [False] * 3


def test_heat_is_told():
    settings = Deployment().emulator.motors
    machine = robot(motors=replace(settings, heating=1.0, heating_s=1.0))
    machine.take(packet())
    told = run(machine, 100)[-1]
    assert told.temperature.max() > 30.0 and told.imu_temperature == 25.0


def test_a_dead_motor_lets_its_leg_sink():
    machine = robot(faults=(Fault("dead motor", "RR_calf"), Fault("dead motor", "RR_thigh")))
    machine.take(packet())
    run(machine, 250)
    assert np.argmax(np.abs(machine.plant.truth().q - HOLD.q)) // 3 == 3


def test_who_tips_it_over_lays_it_on_its_side():
    machine = robot(faults=(Fault("tipped over", begin_s=0.02, end_s=0.62),))
    machine.take(packet())
    for _ in range(350):
        machine.advance()
    assert machine.witness.fell.startswith("tilted by ")


def test_a_blow_presses_it_down_and_its_motors_turn_over_the_power():
    machine = robot(faults=(Fault("blow", begin_s=0.02, end_s=0.06),))
    machine.take(packet())
    power = []
    for _ in range(60):
        machine.advance()
        power.append(machine.plant.truth().power_w)
    assert max(power[:10]) < 10.0 < 500.0 < sorted(power)[-7] and machine.witness.tilt < 0.1


def test_angles_beyond_every_robots_are_no_command():
    machine = robot()
    assert not machine.take(encode_command(replace(HOLD, q=np.full(12, 8.0)), G1, ANY_ANGLE)[0])
    assert "law.q of FL_hip = 8 rad" in machine.trouble


def test_buttons_of_its_remote_are_held_when_the_settings_say_so():
    presses = (Press(("L2", "B"), 0.004, 0.008), Press(("UP",), 0.006, 0.010))
    held = [each.remote.buttons for each in run(robot(presses=presses), 5)]
    both = Button.L2 | Button.B
    assert held == [0, both, both | Button.UP, Button.UP, 0]
