"""Options of the whole suite, and what its processes begin with: their signals, and the compiled program."""

import os
import signal
import sys
import tempfile

# What is started in the background of a shell, or by nohup, ignores these two, and so would every process that the
# suite starts and ends by them.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)

# Where Python is told to write nothing beside the sources, each of the hundreds of processes that the suite starts
# would compile the program anew: they find it compiled in a folder that goes with the suite.
if sys.dont_write_bytecode:
    compiled = tempfile.TemporaryDirectory(prefix="surefoot-compiled-")
    os.environ["PYTHONPYCACHEPREFIX"] = compiled.name
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)


def pytest_addoption(parser):
    parser.addoption(
        "--update-refs",
        action="store_true",
        help="record the clips in tests/recordings again, and print what has changed in them",
    )
