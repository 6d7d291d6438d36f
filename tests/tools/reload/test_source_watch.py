"""A change counts when the files are at rest, differ from what runs, and compile."""

import os

import pytest

from surefoot.tools.reload.source_watch import ROOT, SourceWatch


class Tree:
    """A small project under a watch whose clock is moved by hand."""

    def __init__(self, root):
        self.root, self.t, self.stamp = root, 0.0, 1_000_000_000
        for path, text in {
            "components/runner.py": "from surefoot.bus import codec\n",
            "components/mpc/mpc.py": "from surefoot.components.ocp import riccati\n",
            "components/wbc/wbc.py": "",
            "components/io/io.py": "from surefoot.hw.gate import Gate\n",
            "components/ocp/riccati.py": "A = 1\n",
            "bus/codec.py": "",
            "hw/gate.py": "",
            "tools/cli.py": "",
        }.items():
            self.write(path, text)
        self.watch = SourceWatch(root, lambda: self.t)

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        self.stamp += 1_000_000_000
        os.utime(file, ns=(self.stamp, self.stamp))

    def look(self):
        self.t += 0.6
        return self.watch.changed()

    def settled(self):
        assert self.look() is None  # seen, but perhaps not the last of it
        return self.look()


@pytest.fixture
def tree(tmp_path):
    return Tree(tmp_path)


def test_nothing_changes_by_itself(tree):
    assert [tree.look() for _ in range(5)] == [None] * 5


def test_a_change_restarts_what_imports_it_once(tree):
    tree.write("components/ocp/riccati.py", "A = 2\n")
    change = tree.settled()
    assert change.processes == ("mpc",) and change.what == "components/ocp/riccati.py" and change.notes == ()
    assert [tree.look() for _ in range(3)] == [None] * 3


def test_files_that_are_still_being_written_are_left_to_settle(tree):
    for text in ("A = 2\n", "A = 3\n", "A = 4\n"):
        tree.write("components/ocp/riccati.py", text)
        assert tree.look() is None
    tree.write("components/wbc/wbc.py", "B = 1\n")
    change = tree.settled()
    # Readers first: the controller still gets its last messages from an mpc that has them.
    assert change.processes == ("wbc", "mpc")
    assert change.what == "components/ocp/riccati.py, components/wbc/wbc.py"


def test_what_was_only_saved_again_or_taken_back_is_no_change(tree):
    tree.write("components/ocp/riccati.py", "A = 1\n")
    assert tree.settled() is None
    tree.write("components/ocp/riccati.py", "A = 2\n")
    assert tree.look() is None
    tree.write("components/ocp/riccati.py", "A = 1\n")
    assert tree.settled() is None


def test_while_one_file_does_not_compile_nothing_is_restarted(tree):
    tree.write("components/ocp/riccati.py", "A = (\n")
    tree.write("components/wbc/wbc.py", "B = 1\n")
    change = tree.settled()
    assert change.processes == ()
    assert change.notes[0].startswith("nothing is restarted: components/ocp/riccati.py, line 1: ")
    tree.write("components/wbc/wbc.py", "B = 2\n")
    assert tree.settled() is None  # that was said already
    tree.write("components/ocp/riccati.py", "A = (2)\n")
    assert tree.settled().processes == ("wbc", "mpc")


def test_bytes_that_are_no_text_are_a_fault_and_not_the_end(tree):
    (tree.root / "components/wbc/wbc.py").write_bytes(b"A = '\xff'\n")
    assert "components/wbc/wbc.py" in tree.settled().notes[0]


def test_io_goes_on_with_what_it_has_and_that_is_said(tree):
    tree.write("hw/gate.py", "C = 1\n")
    change = tree.settled()
    assert change.processes == () and "io goes on with what hw/gate.py said before" in change.notes[0]
    tree.write("bus/codec.py", "D = 1\n")
    change = tree.settled()
    assert {"wbc", "mpc"} <= set(change.processes) and "io" not in change.processes
    assert "io goes on" in change.notes[0]


def test_what_no_process_is_made_of_is_said_to_wait_for_the_next_run(tree):
    tree.write("tools/cli.py", "E = 1\n")
    assert tree.settled().notes == ("tools/cli.py changed: no process is made of it, the next run will be",)


def test_new_imports_and_files_and_those_that_go_are_followed(tree):
    tree.write("components/ocp/cone.py", "A = 1\n")
    tree.write("components/ocp/riccati.py", "from surefoot.components.ocp.cone import A\n")
    assert tree.settled().processes == ("mpc",)
    tree.write("components/ocp/cone.py", "A = 2\n")
    assert tree.settled().processes == ("mpc",)
    (tree.root / "components/ocp/cone.py").unlink()
    assert tree.settled().processes == ("mpc",)  # it will fail, and say so
    tree.write("components/mpc/mpc.py", "")
    assert tree.settled().processes == ("mpc",)
    tree.write("components/ocp/riccati.py", "A = 9\n")
    assert tree.settled().processes == ()


def test_the_projects_own_tree_is_watched():
    watch = SourceWatch()
    assert (ROOT / "components" / "mpc" / "mpc.py").is_file() and watch.changed() is None
