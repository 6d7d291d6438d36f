"""A robot to be driven: the puppet under the real state machine, on a real bus with the operator's real desk."""

import os
import time
from contextlib import contextmanager
from dataclasses import replace
from itertools import count
from threading import Event, Thread

from walker import Walker

from surefoot.bus.codec import decode, encode
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS
from surefoot.components.deployment_desk import serve_deployment
from surefoot.components.operator_desk import OperatorDesk
from surefoot.config.deployment import Deployment
from surefoot.config.fsm import Fsm as Settings
from surefoot.config.operator import Operator
from surefoot.tools.teleop.drive_page import DrivePage

_numbers = count()
PATIENCE_S = 180.0  # of wall time: other jobs share the cores, and no test is decided by it
RESTS = ("STAND", "STOPPED", "DAMP")


class DrivenPuppet(Walker):
    """Says on the bus what the state machine says."""

    def __init__(self, session, settings):
        self._session, self._ticks = session, count()
        super().__init__(settings, command="stand")

    def _hear(self, key, message):
        super()._hear(key, message)
        self._session.put(key, encode(message), lossless=False)

    def step(self, now):
        super().step(now)
        estimate = replace(now.estimate, seq=next(self._ticks))
        self._session.put("state/estimate", encode(estimate), lossless=False)


class Driven:
    """A stack that runs in a thread of this process until it is closed.

    Attributes:
        namespace: of its bus.
        robot: the puppet; a test may let its ground give way.
        commands: what the desk has passed on.
        refused: what it has not.
    """

    def __init__(self, heartbeat_s=0.0, **settings):
        self.namespace = f"driven-{os.getpid()}-{next(_numbers)}"
        self._session = Session(self.namespace, hub=True)
        deployment = Deployment(operator=Operator(heartbeat_s=heartbeat_s), fsm=Settings(**settings))
        serve_deployment(self._session, deployment)
        self.refused, self.commands = [], []
        self._desk = OperatorDesk(
            self._session, self.refused.append, lambda key, words: self.refused.append(words), deployment
        )
        self.robot = DrivenPuppet(self._session, deployment.fsm)
        for key in ("operator/command", "operator/tuning"):
            self._session.subscribe(key, self._on_message)
        self._asked, self._ended, self._hold_in = [], Event(), "nowhere"
        self._thread = Thread(target=self._run, daemon=True)
        self._thread.start()

    def join(self):
        """The bus, from another session."""
        return Session(self.namespace, connect_ms=2000)

    def hold_in(self, state):
        """As soon as the robot comes to a state time stands, but for a tick to answer a command, until `go_on`."""
        self._hold_in = state

    def wait_held(self):
        self.wait(lambda: self.robot.state == self._hold_in)

    def go_on(self):
        self._hold_in = "nowhere"

    def wait(self, true):
        end = time.monotonic() + PATIENCE_S
        while not true():
            assert time.monotonic() < end, f"{self.robot.state}: {self.robot.said[-3:]}"
            time.sleep(0.01)

    def come_to(self, state):
        self.wait(lambda: self.robot.state == state)

    def close(self):
        self._ended.set()
        self._thread.join()
        self._session.close()

    def _on_message(self, key, payload):
        self._asked.append((key, payload))

    def _run(self):
        while not self._ended.is_set():
            self._desk.publish(self.robot.t)
            told = bool(self._asked)
            while self._asked:
                key, payload = self._asked.pop(0)
                message = decode(TOPICS[key].message, payload)
                if key == "operator/command":
                    self.commands.append(message.command)
                self.robot.inbox.deliver(key, message)
            if told or self.robot.state != self._hold_in:
                self.robot.tick()
            time.sleep(0.02 if self.robot.state in RESTS else 0.001)  # only its walks need to hurry


@contextmanager
def served(silent_s=PATIENCE_S, **settings):
    """A stack that stands, and the page that drives it."""
    stack = Driven(**settings)
    stack.come_to("STAND")
    page, over = DrivePage(stack.join, port=0, silent_s=silent_s), Event()
    thread = Thread(target=page.run, args=(over.is_set,))
    thread.start()
    try:
        yield stack, page
    finally:
        over.set()
        thread.join()
        page.close()
        stack.close()
