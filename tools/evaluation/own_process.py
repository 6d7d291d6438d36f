"""One run in a process of its own where `multiprocessing` cannot start one: a Dask worker may have no children.

The work and its result travel as files in a folder; what the run prints goes where its starter prints.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from surefoot.components.process_end import ProcessEnd
from surefoot.tools.evaluation.workers import Work, do_or_tell, failed

_WORK, _RESULT = "work", "result"
_LOOK_S = 0.5


def run_alone(work: Work, call: tuple, environment: dict[str, str], wanted: Callable[[], bool]) -> dict:
    """Do `work(*call)` in a fresh process; where it raised or died, the result is a failure that says so.

    Args:
        work: importable in a fresh process with this one's import path.
        call: its arguments.
        environment: variables that are set for the process besides this one's.
        wanted: asked now and then; once it is false the process is ended.
    """
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / _WORK).write_bytes(pickle.dumps((work, call)))
        found = {"PYTHONPATH": os.pathsep.join(sys.path)}  # what can be imported here can be there
        command = [sys.executable, "-P", "-m", __name__, name, str(os.getpid())]
        process = subprocess.Popen(command, env=os.environ | found | environment)
        try:
            while wanted():
                try:
                    process.wait(_LOOK_S)
                    break
                except subprocess.TimeoutExpired:
                    continue
        finally:
            process.kill()
            process.wait()
        result = folder / _RESULT
        if not result.exists():
            return failed(f"worker died (exit code {process.returncode})")
        return pickle.loads(result.read_bytes())


def _main(name: str, parent: str) -> None:
    ProcessEnd(int(parent))  # does not outlive who waits for the result
    folder = Path(name)
    work, call = pickle.loads((folder / _WORK).read_bytes())
    unfinished = folder / f"{_RESULT}.part"
    unfinished.write_bytes(pickle.dumps(do_or_tell(work, call)))
    unfinished.replace(folder / _RESULT)


if __name__ == "__main__":
    _main(*sys.argv[1:])
