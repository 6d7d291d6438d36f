"""The state machine's process: commands, postures, the probing cycle, and what makes all of them stop."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np

from surefoot.bus.messages import FsmEvent, MotionReference, OperatorAnswer, OperatorCommand
from surefoot.bus.topics import TOPICS
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.fsm.observation import Observation, Observer
from surefoot.components.fsm.posture import JointMove, Posture, posture_reference
from surefoot.components.fsm.probing_cycle import ProbingCycle
from surefoot.components.fsm.state import State
from surefoot.components.fsm.walk_commands import end, obey, turn_to
from surefoot.components.fsm.words import (
    WALK_WORDS,
    Answer,
    Command,
    NoCommand,
    is_direction,
    read_command,
    refused,
    taken,
)
from surefoot.components.memory import Memory
from surefoot.config.deployment import Deployment

_CUT = "cut by command"
"""Why the robot is damped; nothing gets it up before a person has said damp."""

_HELD_UP_S = TOPICS["fsm/reference"].stale_after_s
"""After so long without a step the motion is no longer this one's: the controllers hold the base by themselves."""


class Fsm(Component):
    """Turns operator commands and estimates into the motion reference, at 250 Hz.

    Without a fresh estimate, or fallen over, it asks for damping. A command that cannot be obeyed now is
    answered by an event that says why; one that needs the robot to stand first is obeyed after standing up.
    Held up itself, as a stopped process is, it ends the walk: nobody has watched the foot meanwhile.
    """

    name: ClassVar[str] = "fsm"
    inputs: ClassVar[tuple[str, ...]] = (
        "state/estimate",
        "operator/command",
        "operator/tuning",
        "trajopt/plan",
        "foothold/regions",
    )
    outputs: ClassVar[tuple[str, ...]] = (
        "fsm/reference",
        "fsm/event",
        "operator/answer",
        "trajopt/request",
        "foothold/request",
    )
    complete = ("state/estimate",)  # one that is invalid must not be passed over
    memory: ClassVar[Memory] = Memory(
        "_reason",
        "_wish",
        "_t",
        _posture=Posture,
        _move=JointMove,
        _cycle=ProbingCycle,
    )

    def __init__(self, deployment: Deployment):
        super().__init__(deployment)
        robot = deployment.load_robot()
        self._stand_q = np.tile(robot.nominal.stand_q, 4)
        self._lie_q = np.tile(robot.nominal.lie_q, 4)
        self._lower, self._upper = np.array(robot.position_range()).T
        self._observer = Observer(robot)
        self._posture: Posture | None = Posture.DAMP
        self._reason = "waiting for a command"
        self._move = JointMove(self._stand_q, self._stand_q)
        self._wish = ""
        self._events: list[FsmEvent] = []
        self._t = 0.0

    def set_up(self) -> None:
        self._settings = self.deployment.fsm
        self._cycle = ProbingCycle(self.deployment.load_robot(), self._settings, self._report)

    def activate(self, t: float, inbox: Inbox) -> bool:
        return True

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        self.heed_tuning(inbox)
        held_up_s, self._t = t - self._t, t
        lost = self._lost(t, inbox)
        now = None if lost else self._observer.observe(t, inbox.latest("state/estimate"))
        if lost and self._posture is not Posture.DAMP:
            self._damp(lost)
        for message in inbox.new("operator/command"):
            outbox.publish("operator/answer", self._answer(message, now))
        if now is not None:
            if held_up_s > _HELD_UP_S and self._walks:
                end(self._cycle, now, f"the state machine was held up for {held_up_s:.1f} s")
            self._advance(now, inbox)
        outbox.publish("fsm/reference", self._reference(t))
        self._send(outbox)

    # Commands -------------------------------------------------------------------------------------------

    def _answer(self, message: OperatorCommand, now: Observation | None) -> OperatorAnswer:
        answer = self._obey(message.command, now)
        return OperatorAnswer(
            t=self._t,
            valid=True,
            command=message.command,
            number=message.seq,
            taken=answer.taken,
            words=answer.words,
        )

    def _obey(self, asked: str, now: Observation | None) -> Answer:
        """Do what is asked; what cannot be done is an event too."""
        try:
            answer = self._command(read_command(asked), asked, now)
        except NoCommand as error:
            answer = refused(str(error))
        if not answer.taken:
            self._report("refused", answer.words)
        return answer

    def _command(self, command: Command, asked: str, now: Observation | None) -> Answer:
        word = command.word
        if word == "damp":
            self._damp("waiting for a command" if self._cut else "commanded")
            return taken("every joint is braked")
        if word == "cut":
            self._damp(_CUT)
            return taken("no torque before damp is said")
        if word == "halt" and is_direction(self._wish):
            self._wish = ""
            if self._posture is not None:
                return taken("the robot does not set off")
        if now is None:
            return self._wait(word, asked)
        if word == "hold":
            return self._hold(now)
        if word == "sit":
            return self._sit(now, asked)
        if word == "stop":
            return self._stop(now)
        if self._cut:
            return refused(f"{word}: the torque was cut; command damp first")
        if word == "stand" or command.direction_B is not None:
            return self._go(command, now)
        if self._posture is not None:
            return refused(f"{word}: the robot does not walk in {self._posture}; give a direction first")
        if word == "pause" and is_direction(self._wish):
            self._wish = ""
        return obey(self._cycle, word, now)

    def _wait(self, word: str, asked: str) -> Answer:
        """Nobody knows how the robot stands."""
        if word in WALK_WORDS:
            return refused(f"{word}: state/estimate is missing or stale: is the estimator running?")
        self._wish = asked
        words = f"{word}: kept until there is a fresh state/estimate"
        self._report("waiting", words)
        return taken(words)

    def _stop(self, now: Observation) -> Answer:
        self._wish = ""
        if self._posture is not None:
            return taken(f"the robot does not walk in {self._posture}")
        end(self._cycle, now, "commanded stop")
        return taken("the robot comes to rest")

    def _go(self, command: Command, now: Observation) -> Answer:
        """stand or a direction: stand up first where need be; what waited until now is overruled."""
        asked, self._wish = command.asked, ""
        if self._posture is Posture.DAMP and self._settings.hold_s > 0.0:
            self._wish = asked
            self._stiffen(now, f"commanded {asked}")
        elif self._posture in (Posture.DAMP, Posture.SIT_DOWN):
            self._wish = asked
            self._move_joints(Posture.STAND_UP, self._stand_q, now, f"commanded {asked}")
        elif self._posture in (Posture.HOLD, Posture.STAND_UP):
            self._wish = asked  # obeyed once the gains are up, or the robot stands
        elif command.direction_B is None:
            if self._posture is None:
                end(self._cycle, now, "commanded stand")
            return taken("the robot stands")
        elif self._posture is Posture.STAND or self._cycle.state == State.STOPPED:
            self._posture = None
            self._cycle.walk(now, np.array(command.direction_B), asked)
            return taken("the robot sets off")
        else:
            self._wish = asked
            return turn_to(self._cycle, now, f"commanded {asked}")
        return taken("the robot stands up first")

    def _hold(self, now: Observation) -> Answer:
        if self._posture is not Posture.DAMP:
            return refused("hold: the robot is not damped; command sit, or damp, first")
        self._stiffen(now, "commanded hold")
        return taken("the joints are held where they are")

    def _sit(self, now: Observation, asked: str) -> Answer:
        """Settle from any state; a leg in the air is put down first."""
        if self._walks:
            self._wish = asked
            self._cycle.stop(now, f"commanded {asked}")
        elif self._posture not in (Posture.DAMP, Posture.SIT_DOWN):
            self._sit_down(now, asked)
        return taken("the robot sits down, then it is damped")

    def _sit_down(self, now: Observation, asked: str) -> None:
        self._wish = ""
        self._move_joints(Posture.SIT_DOWN, self._lie_q, now, f"commanded {asked}")

    @property
    def _walks(self) -> bool:
        return self._posture is None and self._cycle.state != State.STOPPED

    @property
    def _cut(self) -> bool:
        return self._posture is Posture.DAMP and self._reason == _CUT

    # Postures -------------------------------------------------------------------------------------------

    def _advance(self, now: Observation, inbox: Inbox) -> None:
        tilt, limit = float(np.abs(now.rpy[:2]).max()), self._settings.tilt_max
        if self._posture is not Posture.DAMP and tilt > limit:
            self._damp(f"tilt {tilt:.2f} rad, limit {limit} rad: fallen")
            return
        if self._posture is Posture.STAND_UP and now.t >= self._move.t1:
            self._stood_up(now)
        elif self._posture is Posture.HOLD:
            self._check_hold(now)
        elif self._posture is Posture.SIT_DOWN and now.t >= self._move.t1:
            self._damp(self._reason.replace("commanded sit", "sitting"))
        elif self._posture is Posture.STAND:
            self._cycle.step(now)
        elif self._posture is None:
            for answer in inbox.new("foothold/regions"):
                self._cycle.regions(answer, now)
            for plan in inbox.new("trajopt/plan"):
                self._cycle.plan(plan, now)
            self._cycle.step(now)
        self._grant_wish(now)

    def _stood_up(self, now: Observation) -> None:
        """A robot whose joints have not followed does not stand, whatever was asked of them."""
        joint, error = self._move.farthest(now.estimate.q)
        limit = self._settings.posture_error_max
        if error > limit:
            self._damp(f"did not stand up: {joint} is {error:.2f} rad from its posture, limit {limit} rad")
            return
        self._cycle.stand_up(now)
        self._enter(Posture.STAND, "stood up")

    def _grant_wish(self, now: Observation) -> None:
        """Obey what had to wait for the robot to rest; to sit no longer than there is a way back for the leg."""
        if self._wish.startswith("sit") and self._walks:
            if self._cycle.state != State.RETURN_SAFE or self._cycle.waited_s(now) > self._settings.put_down_s:
                self._sit_down(now, self._wish)
            return
        moves = self._posture in (Posture.HOLD, Posture.STAND_UP, Posture.SIT_DOWN)
        rests = not moves and not self._walks
        if self._wish and rests and now.t >= self._cycle.reference.base_t1:
            wish, self._wish = self._wish, ""
            if wish != "stand" or self._posture is Posture.DAMP:
                self._obey(wish, now)

    def _stiffen(self, now: Observation, reason: str) -> None:
        """The joints are held where they are, by gains that come up in `hold_s`; never beyond their range."""
        q = np.clip(now.estimate.q, self._lower, self._upper)
        self._move = JointMove(q, q, now.t, now.t + self._settings.hold_s)
        self._enter(Posture.HOLD, reason)

    def _check_hold(self, now: Observation) -> None:
        """A joint that is driven away, by a wrong sign or order, shows while the gains are still low."""
        joint, error = self._move.farthest(now.estimate.q)
        limit = self._settings.hold_error
        if error > limit:
            self._damp(f"{joint} left its hold by {error:.2f} rad, limit {limit} rad")
        elif self._wish and now.t >= self._move.t1:
            self._move_joints(Posture.STAND_UP, self._stand_q, now, f"commanded {self._wish}")

    def _move_joints(self, posture: Posture, to: np.ndarray, now: Observation, reason: str) -> None:
        q, settings = now.estimate.q.copy(), self._settings
        seconds = max(settings.posture_min_s, float(np.abs(to - q).max()) / settings.posture_speed)
        self._move = JointMove(q, to, now.t, now.t + seconds)
        self._enter(posture, reason)

    def _damp(self, reason: str) -> None:
        self._wish = ""
        if self._posture is not Posture.DAMP or self._cut or reason == _CUT:
            self._enter(Posture.DAMP, reason)

    @staticmethod
    def _lost(t: float, inbox: Inbox) -> str:
        """Why nobody knows how the robot moves; empty where it is known.

        A filter that begins anew in the middle of a motion says so in one estimate; the next may be valid already.
        """
        if any(not estimate.valid for estimate in inbox.new("state/estimate")):
            return "state/estimate is invalid: the estimator has lost the base and begins anew"
        if inbox.fresh("state/estimate", t) is None:
            return "state/estimate is missing or stale: is the estimator running?"
        return ""

    def _enter(self, posture: Posture, reason: str) -> None:
        self._posture, self._reason = posture, reason
        self._report("transition", reason)

    # Messages -------------------------------------------------------------------------------------------

    def _reference(self, t: float) -> MotionReference:
        if self._posture in (None, Posture.STAND):
            message = self._cycle.message(t)
            if self._posture is None:
                return message
            return replace(message, state=str(self._posture), reason=self._reason)
        return posture_reference(t, self._posture, self._reason, self._move)

    def _send(self, outbox: Outbox) -> None:
        self._cycle.questions.send(outbox)
        for event in self._events:
            outbox.publish("fsm/event", event)
        self._events.clear()

    def _report(self, kind: str, reason: str, **figures) -> None:
        state = str(self._cycle.state) if self._posture is None else str(self._posture)
        counters = self._cycle.counters if self._posture is None else {}
        event = FsmEvent(t=self._t, valid=True, kind=kind, state=state, reason=reason, **(counters | figures))
        self._events.append(event)
