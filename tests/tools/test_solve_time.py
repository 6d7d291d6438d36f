"""A machine that cannot keep 100 Hz is told so in words."""

from dataclasses import replace

from surefoot.config.deployment import Deployment
from surefoot.tools import solve_time


def reason(took_ms, monkeypatch, **run):
    deployment = Deployment()
    monkeypatch.setattr(solve_time, "median_solve_ms", lambda deployment: took_ms)
    return solve_time.light_profile_reason(replace(deployment, run=replace(deployment.run, **run)))


def test_a_solve_is_measured():
    assert 0.0 < solve_time.median_solve_ms(Deployment(), 3) < 1e4


def test_slow_solves_and_few_cores_are_reasons(monkeypatch):
    assert reason(5.9, monkeypatch, cores_min=1) == ""
    assert "a solve takes 6.1 ms, 61 % of its 10 ms, limit 60 %" in reason(6.1, monkeypatch, cores_min=1)
    assert "at least 256 wanted" in reason(1.0, monkeypatch, cores_min=256)
    assert "light profile, 50 Hz" in reason(9.0, monkeypatch)
