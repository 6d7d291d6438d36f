"""The puppet of a robot under the whole state machine: it hears an operator's words and answers them."""

from dataclasses import replace

import numpy as np
from puppet import ROBOT, Puppet

from surefoot.bus.messages import OperatorCommand
from surefoot.components.component import Inbox, Outbox
from surefoot.components.fsm.fsm import Fsm
from surefoot.config.deployment import Deployment

LIE_Q = np.tile(ROBOT.nominal.lie_q, 4)


class Walker(Puppet):
    """The puppet with the whole state machine around its cycle; its joints are where a posture wants them.

    Attributes:
        said: events, as (kind, state, reason).
        answers: to commands.
        stiff: the joints follow no posture.
        com_off: the centre of mass from where the base is [m].
        numb: no foot feels the ground, as of a robot on its belly.
    """

    def __init__(self, settings=None, command="forward"):
        self.stiff, self.numb, self.commands = False, False, 0
        self.com_off = np.zeros(3)
        super().__init__(settings, forward=False)
        self.fsm = Fsm(Deployment(fsm=self.settings))
        self.fsm._cycle, self.said, self.asked, self.answers = self.cycle, [], {}, []
        self.cycle._report = self.cycle._phases._report = self.fsm._report
        self.fsm._observer.observe = lambda t, estimate: replace(self.observe(), estimate=estimate)
        self.inbox, self.outbox = Inbox(Fsm.inputs), Outbox(Fsm.outputs, self._hear)
        self.reference = None
        self.command(command)

    def _hear(self, key, message):
        if key == "fsm/reference":
            self.reference = message
        elif key == "fsm/event":
            self.said.append((message.kind, message.state, message.reason))
        elif key == "operator/answer":
            self.answers.append(message)
        else:
            self.asked[key] = message

    def observe(self):
        now = super().observe()
        contact = now.estimate.contact & (not self.numb)
        estimate = replace(now.estimate, contact=contact)
        return replace(now, estimate=estimate, com_W=now.com_W + self.com_off)

    def _answer(self, now):
        questions = self.cycle.questions
        questions.foothold_request = self.asked.pop("foothold/request", None)
        questions.plan_request = self.asked.pop("trajopt/request", None)
        super()._answer(now)
        questions.foothold_request = questions.plan_request = None

    def command(self, words):
        number, self.commands = self.commands, self.commands + 1
        self.inbox.deliver("operator/command", OperatorCommand(t=self.t, seq=number, valid=True, command=words))

    def tell(self, words):
        """A command, and what is answered to it in the next step."""
        self.command(words)
        self.tick()
        answer = self.answers[-1]
        assert (answer.number, answer.command) == (self.commands - 1, words)
        return answer

    def step(self, now):
        q = LIE_Q if self.stiff or self.reference is None else self.reference.joint_to
        self.inbox.deliver("state/estimate", replace(now.estimate, q=q))
        self.fsm.step(self.t, self.inbox, self.outbox)
        self.inbox.clear_new()
        self.cycle = self.fsm._cycle  # another one when settings were changed

    @property
    def state(self):
        return self.reference.state if self.reference is not None else ""

    def come_to(self, state, seconds=20.0):
        assert self.run(seconds, lambda: self.state == state), f"{self.state}: {self.reference.reason}"
