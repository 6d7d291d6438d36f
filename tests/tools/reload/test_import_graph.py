"""A changed file is traced to exactly the processes that import it, on the project's own tree."""

import subprocess
import sys

import pytest

from surefoot.bus.topics import PROCESSES
from surefoot.tools.reload.import_graph import ImportGraph, imports_of, source_files
from surefoot.tools.reload.source_watch import ROOT

ALL = set(PROCESSES)


@pytest.fixture(scope="module")
def graph():
    return ImportGraph({path: imports_of((ROOT / path).read_text()) for path in source_files(ROOT)})


@pytest.mark.parametrize(
    ("path", "processes"),
    [
        ("components/mpc/mpc.py", {"mpc"}),
        ("components/wbc/whole_body_qp.py", {"wbc"}),
        ("components/ocp/riccati.py", {"mpc", "trajopt"}),
        ("components/fsm/probe.py", {"fsm"}),
        ("components/estimator/__init__.py", {"estimator"}),
        ("components/robot_model/__init__.py", ALL - {"io"}),
        ("components/clock_master.py", {"io"}),
        ("components/stepper.py", ALL),
        ("hw/gate/gate.py", {"io"}),
        ("hw/mujoco/terrain/rocks.py", {"io"}),
        ("bus/codec.py", ALL),
        ("config/wbc.py", ALL),
        ("components/lockstep.py", set()),
        ("tools/supervisor.py", set()),
        ("components/nowhere.py", set()),
    ],
)
def test_a_file_belongs_to_the_processes_that_import_it(graph, path, processes):
    assert graph.processes_with({path}) == processes


@pytest.mark.parametrize("name", ["trajopt", "estimator"])
def test_what_a_process_loads_is_what_the_graph_says(graph, name):
    """Against Python itself, which imports the component and its runner."""
    code = (
        f"import surefoot.components.{name}.{name}, surefoot.components.runner, sys; "
        "print(*(n for n in sys.modules if n.startswith('surefoot.')))"
    )
    said = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True).stdout
    loaded = {name.removeprefix("surefoot.").replace(".", "/") for name in said.split()}
    told = {path.removesuffix(".py").removesuffix("/__init__") for path in graph.files_of(name)}
    assert loaded <= told
    # What only a function imports may be loaded later; here that is the table of components at most.
    assert told - loaded <= {"tools"}


def test_every_way_to_import_is_seen():
    source = """
import surefoot.bus.codec
import surefoot.hw.gate as gate, numpy
from surefoot.bus import topics
from surefoot.config.robot import load_robot
def later():
    from surefoot.components.ocp import riccati
"""
    graph = ImportGraph(
        {
            "components/mpc/mpc.py": imports_of(source),
            **dict.fromkeys(
                (
                    "bus/__init__.py", "bus/codec.py", "bus/topics.py", "bus/session.py", "hw/__init__.py",
                    "hw/gate.py", "config/robot.py", "components/ocp/riccati.py", "components/ocp/__init__.py",
                ),
                frozenset(),
            ),
        }
    )  # fmt: skip
    assert graph.files_of("mpc") == {
        "components/mpc/mpc.py", "bus/__init__.py", "bus/codec.py", "bus/topics.py", "hw/__init__.py",
        "hw/gate.py", "config/robot.py", "components/ocp/riccati.py", "components/ocp/__init__.py",
    }  # fmt: skip


def test_a_ring_of_imports_is_walked_once():
    graph = ImportGraph(
        {
            "components/mpc/mpc.py": frozenset({"components.mpc.other"}),
            "components/mpc/other.py": frozenset({"components.mpc.mpc.Mpc"}),
        }
    )
    assert graph.processes_with({"components/mpc/other.py"}) == {"mpc"}
