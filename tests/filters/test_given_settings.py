"""Settings given by name have their type and a possible value; others are refused in one line."""

import math

import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.given_settings import own_values, plain, possible, with_given
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.settings import flat, leaf_fields
from mbkf.filters.torque.settings import TorqueSettings

EVERY = [
    (kind, name) for kind in (KinematicSettings, DynamicSettings, TorqueSettings) for name in flat(kind())
]
INDEPENDENT = {"noise": "independent"}


def ids(value):
    return value if isinstance(value, str) else value.__name__


@pytest.mark.parametrize(("kind", "name"), EVERY, ids=ids)
def test_every_setting_can_be_given_its_default(kind, name):
    settings = kind()
    value = plain(leaf_fields(settings)[name], flat(settings)[name])
    start = with_given(settings, INDEPENDENT) if name in ("upper_torque_nm", "lower_torque_nm") else settings
    assert with_given(start, {name: value}) == start
    assert possible(leaf_fields(settings)[name], flat(settings)[name])


@pytest.mark.parametrize(
    ("given", "name", "value"),
    [
        ({"min_markers": 8.0}, "min_markers", 8),
        ({"complete": False}, "complete", False),
        ({"covariance": "series"}, "covariance", "series"),
        ({"toe_acceleration": 10.0}, "toe_acceleration", 10.0),
        ({"force_state": "torque", "residual_spread_force_n": math.inf}, "residual_spread_force_n", math.inf),
        ({**INDEPENDENT, "per_frame": True}, "per_frame", True),
    ],
)
def test_values_are_taken_over_with_their_type(given, name, value):
    found = flat(with_given(TorqueSettings(), given))[name]
    assert (found, type(found)) == (value, type(value))


def test_own_values_make_the_settings_anew():
    settings = with_given(TorqueSettings(), {**INDEPENDENT, "complete": False, "toe_acceleration": 10.0})
    assert own_values(settings) == {**INDEPENDENT, "complete": False, "toe_acceleration": 10.0}


def test_zero_switches_off_where_it_may():
    assert with_given(DynamicSettings(), {"residual_share": 0.0}).residual.residual_share == 0.0


@pytest.mark.parametrize(
    ("given", "error", "line"),
    [
        ({"integrater": "FE"}, UnknownName, "unknown setting 'integrater'; did you mean integrator"),
        ({"integrator": "Huen"}, UnknownName, "unknown integrator 'Huen'; did you mean HE"),
        ({"integrator": 3.0}, InvalidInput, "integrator must be one of FE, HE, TF, TN, RK4, got 3"),
        ({"complete": "yes"}, InvalidInput, 'complete must be true or false, got "yes"'),
        ({"complete": 1.0}, InvalidInput, "complete must be true or false, got 1"),
        ({"substeps": 1.5}, InvalidInput, "substeps must be a whole number of one or more, got 1.5"),
        ({"substeps": math.inf}, InvalidInput, "substeps must be a whole number"),
        ({"substeps": True}, InvalidInput, "substeps must be a whole number of one or more, got true"),
        ({"gate": 0.0}, InvalidInput, "gate must be a positive number, got 0"),
        ({"gate": "5.0"}, InvalidInput, 'gate must be a positive number, got "5.0"; write gate = 5'),
        ({"complete": "true"}, InvalidInput, 'complete must be true or false, got "true"; write complete = true'),
        ({"gate": math.inf}, InvalidInput, "gate must be a positive number, got inf"),
        ({"gate": (1.0, 2.0)}, InvalidInput, "gate must be a positive number, got [1, 2]"),
        ({"toe_acceleration": "tabel"}, InvalidInput, 'a positive number, or "table", got "tabel"'),
        ({"per_frame": True}, InvalidInput, 'noise is "consistent"; give noise = "independent"'),
        ({"residual_spread_force_n": math.inf}, InvalidInput, 'force_state "inertial" needs a finite'),
        ({"lower_torque_nm": 9.0}, InvalidInput, 'lower_torque_nm has an effect only with noise = "independent"'),
        ({**INDEPENDENT, "jerk_scale": 2.0}, InvalidInput, 'jerk_scale has an effect only with noise = "consistent"'),
    ],
)  # fmt: skip
def test_wrong_settings_are_refused_with_their_place(given, error, line):
    with pytest.raises(error) as refused:
        with_given(TorqueSettings(), given, "my.toml")
    assert str(refused.value).startswith("my.toml: ")
    assert line in str(refused.value)


@pytest.mark.parametrize("value", [(1.0,), (1.0, -2.0), (1.0, math.inf), 2.0, "wide"])
def test_lists_have_their_length_and_finite_numbers(value):
    with pytest.raises(InvalidInput, match="busy_shares must be 2 numbers of zero or more"):
        with_given(DynamicSettings(), {"busy_shares": value})
