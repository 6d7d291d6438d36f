"""The inputs of a setting, on viser's own server."""

import pytest
import viser

from surefoot.config.deployment import Deployment
from surefoot.config.tuning import tunable_settings, value_of
from surefoot.config.typed_toml import Within
from surefoot.tools.teleop.tuned_run import TunedRun
from surefoot.tools.view.page import HOST
from surefoot.tools.view.tuning_field import TuningField, step_of


@pytest.fixture(scope="module")
def server():
    server = viser.ViserServer(host=HOST, port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture
def field(server):
    def make(path):
        return TuningField(
            server.gui, tunable_settings()[path], value_of(Deployment(), path), "what it is", lambda field: None
        )

    return make


def run(*assignments):
    return TunedRun(Deployment(), assignments)


def test_what_differs_from_the_runs_beginning_is_marked_and_the_hint_has_what_it_was(field):
    kp = field("wbc.kp")
    kp.write(run())
    (number,) = kp._inputs
    assert number.value == 100.0 and number.label == "kp"
    kp.write(run("wbc.kp=90.0"))
    assert number.value == 90.0 and number.label == "● kp" and not kp._button.visible
    assert number.hint == "what it is; allowed: 0 to 10000; the run began with 100.0"


def test_each_number_of_a_list_has_an_input_and_only_what_differs_is_marked(field):
    weight = field("wbc.wrench_weight")
    weight.write(run("wbc.wrench_weight=[1, 1, 2, 2, 2, 3]"))
    assert [each.label for each in weight._inputs][4:] == ["wrench_weight[4]", "● wrench_weight[5]"]
    weight._inputs[0].value = 7.0
    weight.write(run("wbc.wrench_weight=[1, 1, 2, 2, 2, 3]"))
    assert weight.typed == (7.0, 1.0, 2.0, 2.0, 2.0, 3.0)
    assert weight._button.visible and weight._button.label == "set [7, 1, 2, 2, 2, 3]"


def test_nothing_is_sent_but_what_the_button_has_offered(server):
    asked = []
    setting = tunable_settings()["wbc.kp"]
    kp = TuningField(server.gui, setting, 100.0, "", lambda field: asked.append(field.typed))
    kp._inputs[0].value = 12.0
    kp.write(run())
    kp._inputs[0].value = 120.0  # since then
    for _ in range(2):
        kp._button.value = True  # a click
    assert asked == [120.0] and kp._button.label == "set kp = 120.0"


def test_what_is_typed_stays_until_the_run_goes_by_another_value(field):
    swing = field("fsm.swing_s")
    swing._inputs[0].value = 0.4
    swing.write(run("fsm.step_m=0.12"))
    assert swing.typed == 0.4
    swing.write(run("fsm.swing_s=0.6"))
    assert swing.typed == 0.6


@pytest.mark.parametrize("path", tunable_settings())
def test_every_setting_has_inputs_that_keep_its_value(field, path):
    deployment = Deployment()
    made = field(path)
    assert made.typed == value_of(deployment, path)
    assert type(made.typed) is type(value_of(deployment, path))


@pytest.mark.parametrize(
    ("usual", "limits", "step"),
    [
        (100.0, Within(0.0, 1e4), 10.0),
        (350.0, Within(0.0, 1e4), 10.0),
        (0.03, Within(0.001, 0.3), 0.001),
        (1e-2, Within(1e-6, 1e6), 1e-3),
        (0.0, Within(0.0, 500.0), 10.0),
        (3, Within(0, 20), 1),
    ],
)
def test_a_step_is_a_tenth_of_the_leading_decimal_place(usual, limits, step):
    assert step_of(usual, limits) == step
