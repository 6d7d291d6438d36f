"""Processes are started from the deployment that the run began with, and their end is told."""

from surefoot.tools.launcher import Launcher


def test_a_file_that_changes_during_a_run_is_not_read_again(tmp_path):
    config = tmp_path / "mine.toml"
    config.write_text('[terrain]\nkind = "flat"\n')
    launcher = Launcher(config, ["hw.seed=3"], tmp_path / "log")
    launcher.open()
    config.write_text("no TOML at all")
    code = launcher.launch("nobody", 0).wait()
    launcher.close()
    told = launcher.obituary("nobody", code)
    assert "nobody ended with exit code 2 (surefoot: no process 'nobody'" in told and "log/nobody.log" in told
