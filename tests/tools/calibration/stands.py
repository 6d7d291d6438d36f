"""What io tells of a robot that stands still."""

import numpy as np

from surefoot.bus.messages import JointCommand
from surefoot.components.component import Inbox, Outbox
from surefoot.config.robot import load_robot

STAND_Q = np.tile(load_robot("aliengo").nominal.stand_q, 4)


def standing_states(io, seconds):
    """Its messages on hw/state while it holds the stand posture, after a second to come to rest."""
    states = []
    inbox = Inbox(io.inputs)
    outbox = Outbox(io.outputs, lambda key, message: states.append(message) if key == "hw/state" else None)
    for cycle in range(round(500 * (seconds + 1.0))):
        t = 0.002 * cycle
        hold = JointCommand(t=t, valid=True, q=STAND_Q, kp=np.full(12, 300.0), kd=np.full(12, 8.0))
        inbox.deliver("joint/command", hold)
        io.step(t, inbox, outbox)
    return states[500:]
