"""Options of the whole suite."""


def pytest_addoption(parser):
    parser.addoption(
        "--update-refs",
        action="store_true",
        help="record the clips in tests/recordings again, and print what has changed in them",
    )
