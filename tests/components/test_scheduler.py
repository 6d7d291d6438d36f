"""Simulated time: what is visible when, and in which order."""

from surefoot.components.scheduler import Scheduler


class Recorder:
    """An executor that notes its releases and publishes one message a step."""

    def __init__(self, name, log, topic=None):
        self.name, self.log, self.topic = name, log, topic

    def release(self, t_ns, visible):
        self.log.append((t_ns // 1_000_000, self.name, dict(visible)))

    def collect(self):
        return {self.topic: 1} if self.topic else {}


def run(milliseconds):
    log = []
    executors = {
        "mpc": Recorder("mpc", log, "mpc/policy"),
        "wbc": Recorder("wbc", log, "joint/command"),
        "estimator": Recorder("estimator", log, "state/estimate"),
        "io": Recorder("io", log, "hw/state"),
    }
    scheduler = Scheduler(executors)
    scheduler.run_until(milliseconds * 1_000_000)
    return log, scheduler


def test_the_control_chain_runs_at_its_rates_and_delays():
    log, _ = run(20)
    times = {name: [t for t, who, _ in log if who == name] for name in ("io", "estimator", "wbc", "mpc")}
    assert times["io"] == list(range(0, 21, 2))
    assert times["estimator"] == times["io"]
    # Every second estimate, one millisecond after the sensors were read.
    assert times["wbc"] == [3, 7, 11, 15, 19]
    assert times["mpc"] == [0, 10, 20]


def test_output_is_visible_only_after_the_budget():
    log, _ = run(20)
    first_wbc = next(visible for _, who, visible in log if who == "wbc")
    assert first_wbc["state/estimate"] == 2
    assert "mpc/policy" not in first_wbc
    later_wbc = next(visible for t, who, visible in log if who == "wbc" and t == 11)
    assert later_wbc["mpc/policy"] == 1


def test_components_released_together_step_in_the_order_of_the_table():
    log, _ = run(20)
    together = [who for t, who, _ in log if t == 10]
    assert together == ["io", "estimator", "mpc"]


def test_a_stop_condition_ends_between_two_instants():
    log = []
    scheduler = Scheduler({"io": Recorder("io", log)})
    scheduler.run_until(10_000_000, stop=lambda: len(log) >= 3)
    assert len(log) == 3
