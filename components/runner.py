"""One process: a component, its inbox and outbox on the bus, released by simulated or by monotonic time."""

from __future__ import annotations

import gc
import queue
import time

from surefoot.bus.errors import MessageError
from surefoot.bus.session import Marked, Session
from surefoot.bus.topics import nominal_hz, processes
from surefoot.components import clock_messages as clock
from surefoot.components.component import Life
from surefoot.components.deployment_desk import check_settings, serve_deployment
from surefoot.components.operator_desk import TUNING, OperatorDesk
from surefoot.components.process_end import ProcessEnd
from surefoot.components.real_time import claim
from surefoot.components.registry import component_class
from surefoot.components.relief import GIVE, SHOW, Relief
from surefoot.components.run_clock import AnotherRun, run_clock, serve_time
from surefoot.components.scheduler import NS
from surefoot.components.stepper import Stepper
from surefoot.config.deployment import Deployment
from surefoot.config.tuning import tunable_settings

_LOOK_S = 0.2
_LET_GO_S = 1.0  # shorter than the supervisor's patience
_LEAVE_S = 0.1
_GREET_S = 1.0  # without a release
_HELD_UP_S = 0.03  # of the run's time: a process so late was stopped or starved, and so were the threads that read
_CATCH_UP_S = 0.02  # for those threads: what waits to be read would else count as stale


class Runner:
    """Runs one component in this process until it is told to stop or its parent is gone."""

    hub = False

    def __init__(self, deployment: Deployment, name: str, boot: int = 0, parent: int = 0, relieves: bool = False):
        """One process.

        Args:
            deployment: the run's settings.
            name: of its component.
            boot: counts the restarts of this process.
            parent: the supervisor's process id, 0 the starter's.
            relieves: on the monotonic clock, take over from the process that runs under this name.
        """
        self._end = ProcessEnd(parent)
        self._deployment, self._name, self._boot = deployment, name, boot
        self._process = processes(deployment.mpc.profile)[name]
        self._monotonic, self._speed = deployment.run.clock == "monotonic", deployment.run.speed
        self._session = Session(deployment.run.namespace, hub=self.hub, network=deployment.network)
        component = component_class(name)(deployment)
        self._stepper = Stepper(component, self._session, self._process, boot, simulated=not self._monotonic)
        self._relief, self._relieves, self._relieved = Relief(self._session, name), relieves, False
        self._clock = run_clock(self._session, deployment, lambda: self._end.due, self._stepper.buffers.drop)

    def run(self) -> int:
        """Until the end; returns the exit code.

        Raises:
            BusError: io, on another machine, runs with other settings, or the process that is to be relieved does
                not answer.
            ForeignMemory: that one is of other code.
        """
        health = self._stepper.health
        if not self._deployment.network.at_hub:
            check_settings(self._session, self._deployment, self._name, lambda: self._end.due)
        self._stepper.component.warm_up()
        tunable_settings()  # read now: the first change costs no more than any other
        gc.collect()
        gc.freeze()
        self._stepper.connect()  # a process that is busy with itself would hold up the bus
        health.life = Life.IDLE
        self._stepper.look = self._look
        if self._monotonic:
            self._claim_priority()
        try:
            if self._relieves:
                self._take_over()
            elif self._monotonic and not self.hub:
                self._stepper.hear_again(TUNING)
            self._follow()
        finally:
            self._stepper.close()
            self._session.close()
        return 0

    def _claim_priority(self) -> None:
        """Come before ordinary programs where the machine permits it; where it does not, the run has said so."""
        base, urgency = self._deployment.run.realtime_priority, self._process.urgency
        if base and urgency:
            claim(base + urgency, self._process.core)

    def _follow(self) -> None:
        """Step until the end, then let go of the robot, also after a failure.

        In simulated time there is nothing to let go of: time stands still, and a process that takes this one's
        place goes on where it stood.
        """
        if self._monotonic:
            self._relief.expect()
        try:
            if not self._monotonic:
                self._follow_simulated_time()
            elif self._process.rate_hz:
                self._follow_timer()
            else:
                self._follow_trigger()
        except Exception as error:
            self._stepper.fail(error)
            raise
        finally:
            if self._relieved:
                time.sleep(_LEAVE_S)
            elif self._monotonic:
                self._let_go()

    def _take_over(self) -> None:
        """Take the place of the process that runs under this name, which then ends."""
        self._relief.listen()
        self._stepper.rehearse(self._relief.ask(SHOW))
        time.sleep(self._stepper.take_over(self._relief.ask(GIVE), self._live_t()) / self._speed)

    def _answer_successor(self) -> None:
        """Show where this process stands to one that asks, or leave it its place for good."""
        while (asked := self._relief.asked()) and not self._relieved:
            self._relief.answer(self._stepper.place())
            self._relieved = asked == GIVE

    @property
    def _goes_on(self) -> bool:
        return not (self._end.due or self._relieved)

    def _look(self) -> None:
        """Called while a message is awaited.

        Raises:
            SystemExit: there is no reason to wait on.
        """
        if self._end.due:
            raise SystemExit(0)

    def _let_go(self) -> None:
        """Deactivate at the process's rate, for a second at the most."""
        period = 1.0 / (nominal_hz(self._process) or 1.0 / _LOOK_S)
        for _ in range(round(_LET_GO_S / period)):
            self._stepper.read_all()
            t = self._live_t()
            done = self._stepper.deactivate(t)
            sent = self._stepper.publish()
            self._stepper.tell(t)
            if done:
                break
            time.sleep(period)
        if sent:
            time.sleep(_LEAVE_S)  # let it leave before the session closes

    def _follow_simulated_time(self) -> None:
        """Step at each release of the clock's master; the outputs, then the done token, answer it."""
        releases: queue.SimpleQueue[Marked] = queue.SimpleQueue()
        stepper, name = self._stepper, self._name
        self._session.subscribe(f"{clock.RELEASE}/{name}", lambda key, payload: releases.put(payload))
        self._session.put(f"{clock.HELLO}/{name}", clock.pack_hello(clock.Hello(self._boot)))
        last_ns, answer, greeted = None, b"", time.monotonic()
        while not self._end.due:
            stepper.tell((last_ns or 0) / NS)
            try:
                payload = releases.get(timeout=_LOOK_S)
                release = clock.unpack_release(payload)
            except MessageError as error:
                stepper.buffers.drop(str(error))
                continue
            except queue.Empty:
                # The hub may have come up after the first greeting; later a release or its answer may be lost.
                if last_ns is None or time.monotonic() - greeted > _GREET_S:
                    hello = clock.Hello(self._boot, new=last_ns is None)
                    self._session.put(f"{clock.HELLO}/{name}", clock.pack_hello(hello))
                    greeted = time.monotonic()
                continue
            if payload.writer not in self._session.hub_marks():
                at = release.t_ns / NS
                stepper.buffers.drop(f"{clock.RELEASE}: a second clock releases for {at:.3f} s")
                continue
            greeted = time.monotonic()
            t_ns, visible = release.t_ns, release.visible
            if release.writers is not None:
                stepper.buffers.trust(release.writers)
            if t_ns == clock.STOP_NS:
                return
            if last_ns is not None and t_ns < last_ns:
                raise AnotherRun(
                    f"time went back from {last_ns / NS} s to {t_ns / NS} s: io belongs to another run"
                )
            if t_ns != last_ns:
                if last_ns is None:
                    stepper.resume(release.resume or clock.Resume({}, b""), visible)
                last_ns = t_ns
                stepper.read_visible(visible)
                stepper.step(t_ns / NS)
                answer = clock.pack_done(clock.Done(t_ns, stepper.publish(), stepper.snapshot()))
            self._session.put(f"{clock.DONE}/{name}", answer)

    def _follow_timer(self) -> None:
        """Absolute deadlines on the monotonic clock; after an overrun the missed ones are skipped and counted."""
        period = 1.0 / (self._process.rate_hz * self._speed)
        deadline = time.monotonic()
        while self._goes_on:
            deadline += period
            time.sleep(max(deadline - time.monotonic(), 0.0))
            late = time.monotonic() - deadline
            missed = int(late / period)
            self._stepper.health.overruns += missed
            deadline += missed * period
            if late > _HELD_UP_S / self._speed and not self.hub:  # for io the robot waits
                time.sleep(_CATCH_UP_S)
            self._live_step()

    def _follow_trigger(self) -> None:
        """Step on every n-th message of the trigger; releases that came during a step are skipped and counted."""
        trigger, every = self._process.trigger, self._process.every
        seen, begun = 0, False
        while self._goes_on:
            due = (self._stepper.buffers.wait_arrivals(trigger, seen + every, _LOOK_S) - seen) // every
            if due:
                seen += due * every
                # Requests, which come on events, are all served in one step.
                if begun and nominal_hz(self._process):
                    self._stepper.health.overruns += due - 1
                begun = True
                self._live_step()
            else:
                self._stepper.tell(self._live_t())
                self._answer_successor()

    def _live_step(self) -> None:
        self._stepper.read_all()
        t = self._live_t()  # after the inputs: none of them may lie in the future
        self._stepper.step(t)
        self._stepper.publish()
        self._stepper.tell(t)
        self._answer_successor()

    def _live_t(self) -> float:
        return self._clock()


class HubRunner(Runner):
    """The runner of io on the monotonic clock: it hosts the bus and takes people's commands."""

    hub = True

    def __init__(self, deployment: Deployment, name: str, boot: int = 0, parent: int = 0):
        super().__init__(deployment, name, boot, parent)
        buffers = self._stepper.buffers
        self._desk = OperatorDesk(self._session, buffers.drop, buffers.incidents.note, deployment, lossless=False)
        serve_time(self._session, deployment)
        serve_deployment(self._session, deployment)

    def _let_go(self) -> None:
        super()._let_go()
        self._desk.close()

    def _live_step(self) -> None:
        self._desk.publish(self._live_t(), self._stepper.take_said())
        super()._live_step()
