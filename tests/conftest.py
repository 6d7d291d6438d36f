"""Options of the whole suite, and the signals that its processes begin with."""

import signal

# What is started in the background of a shell, or by nohup, ignores these two, and so would every process that the
# suite starts and ends by them.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)


def pytest_addoption(parser):
    parser.addoption(
        "--update-refs",
        action="store_true",
        help="record the clips in tests/recordings again, and print what has changed in them",
    )
