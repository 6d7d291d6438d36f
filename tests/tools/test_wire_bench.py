"""The figures of the driver come from real packets over a real socket; how large they are no test decides."""

from surefoot.tools.wire_bench import rows, wire_bench


def test_every_command_is_timed_and_told():
    found = wire_bench(seconds=0.5)
    assert found["commands"] >= 3 and found["jitter_ms"]["p50"] <= found["jitter_ms"]["p99"]
    for to_wire in (found["to_wire_ms"], found["odd_to_wire_ms"]):
        assert 0.0 < to_wire["p50"] <= to_wire["p99"] <= to_wire["max"] < 60e3
    assert found["cpu_share"] > 0.0 and all(us > 1.0 for us in found["codec_us"].values())
    assert len(list(rows(found))) == 5
