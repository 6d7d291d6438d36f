"""`surefoot emulator` as it is called: it says where it answers, answers, and says at the end what there was."""

import signal
import socket
import subprocess
import sys

import pytest
from packet_samples import GOOD_LAW, PLAUSIBILITY

from surefoot.hw.aliengo.command_packet import encode_command
from surefoot.hw.aliengo.generation import GENERATIONS


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as each:
        each.bind(("127.0.0.1", 0))
        return each.getsockname()[1]


@pytest.mark.parametrize("name", ["G0", "G1"])
def test_it_answers_in_its_generation_until_it_is_ended(name):
    generation, port = GENERATIONS[name], free_port()
    options = ["--terrain", "planks", "--port", str(port), "--generation", name, "--set", "emulator.pace=packets"]
    options += ["--set", "emulator.states.latency_s=0", "--set", "emulator.states.jitter_s=0"]
    call = [sys.executable, "-P", "-m", "surefoot.tools.cli", "emulator", *options]
    with subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            said = process.stdout.readline()
            assert f"generation {name} on planks ground answers at 127.0.0.1:{port}" in said
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
                client.settimeout(60.0)
                client.connect(("127.0.0.1", port))
                client.send(encode_command(GOOD_LAW, generation, PLAUSIBILITY)[0])
                assert len(client.recv(2048)) == generation.state.length
        finally:
            process.send_signal(signal.SIGINT)
        said, complaints = process.communicate(timeout=60.0)
    assert "0.0 s, 1 commands, 1 answers" in said and complaints == "" and process.returncode == 0
