"""What can be tuned exists among the settings of its filter."""

import math

import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.settings import flat
from mbkf.study.tuning.parameters import PARAMETERS, parameter_names
from mbkf.trial.preparation.settings import ReconstructSettings


@pytest.mark.parametrize("kind", PARAMETERS)
def test_parameters_are_settings_of_their_filter(kind):
    defaults = flat(getattr(ReconstructSettings(), kind))
    for one in PARAMETERS[kind].values():
        assert all(defaults[name] > 0.0 for name in one.fields)
        assert one.lowest < 1.0 < one.highest
        assert math.isfinite(one.highest)


def test_names_are_known_and_given_once():
    assert parameter_names("kinematic", ("markers", "motion", "markers")) == ("markers", "motion")
    assert parameter_names("dynamic", None) == ("motion", "loads", "plates")
    with pytest.raises(UnknownName, match="did you mean motion"):
        parameter_names("kinematic", ("motoin",))
    with pytest.raises(InvalidInput, match="at least one"):
        parameter_names("kinematic", ())
