"""A process ends in order when it is told to, and at once when a person insists."""

import signal
import subprocess
import sys

CODE = """
import sys, time
from surefoot.components.process_end import ProcessEnd

end = ProcessEnd()
try:
    print(end.due, flush=True)
    while not end.due:
        time.sleep(0.01)
    print("due", flush=True)
    for _ in range(60_000):  # a step that hangs; a signal just before one long sleep would wait for its end
        time.sleep(0.01)
except KeyboardInterrupt:
    print("broken off", flush=True)
"""


def test_a_second_ctrl_c_breaks_off_a_step_that_hangs_and_a_second_sigterm_does_not():
    child = subprocess.Popen([sys.executable, "-P", "-c", CODE], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "False\n"
    child.send_signal(signal.SIGINT)
    assert child.stdout.readline() == "due\n"
    child.send_signal(signal.SIGTERM)
    child.send_signal(signal.SIGINT)
    assert child.communicate()[0] == "broken off\n" and child.returncode == 0
