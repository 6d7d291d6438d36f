"""Which settings the view goes by."""

from surefoot.config.deployment import Deployment
from surefoot.tools.view.settings_watch import SettingsWatch


def test_it_goes_along_with_the_changes_and_back_with_a_recordings_time():
    watch, deployment = SettingsWatch(), Deployment()
    watch.follow(None, ())
    assert watch.run is None
    for assignments, collapse_m in (((), 0.03), (("fsm.collapse_m=0.025",), 0.025), ((), 0.03)):
        watch.follow(deployment, assignments)
        assert watch.run.now.fsm.collapse_m == collapse_m and watch.run.begun is deployment


def test_what_has_not_changed_is_not_worked_out_again():
    watch, deployment = SettingsWatch(), Deployment()
    watch.follow(deployment, ("wbc.kp=90.0",))
    before = watch.run
    watch.follow(deployment, ("wbc.kp=90.0",))
    assert watch.run is before


def test_a_change_that_another_version_has_made_is_told():
    watch, deployment = SettingsWatch(), Deployment()
    watch.follow(deployment, ("wbc.new_gain=1.0",))
    assert "wbc.new_gain" in watch.trouble and watch.run.now == deployment
    watch.follow(deployment, ())
    assert watch.trouble == ""
