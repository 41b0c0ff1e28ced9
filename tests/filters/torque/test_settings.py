"""Presets of the torque filter: the thesis's schemes, its table, and refusals."""

import math
from dataclasses import replace

import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.torque.plant import Scheme
from mbkf.filters.torque.settings import TorqueSettings, preset


def test_the_default_is_the_exact_filter():
    assert preset("FD") == TorqueSettings()
    assert TorqueSettings().scheme == Scheme("TN", "exponential", "van_loan", complete=True)


def test_the_light_filter():
    assert preset("FDMC").scheme == Scheme("FE", "second", "series", complete=False)
    assert replace(preset("FDMC"), scheme=preset("FD").scheme) == preset("FD")


@pytest.mark.parametrize("name", ["FD", "FDMC"])
def test_literal_presets_hold_table_43(name):
    literal = preset(name, literal=True)
    assert literal.scheme == preset(name).scheme
    assert (literal.residual_force_n, literal.residual_moment_nm) == (10.0, 5.0)
    assert (literal.upper_torque_nm, literal.lower_torque_nm, literal.toe_acceleration) == (5.0, 20.0, 10.0)
    assert (literal.load_force_n, literal.load_moment_nm) == (20.0, 20.0)
    assert (literal.plate_force_n, literal.plate_moment_nm) == (20.0, 20.0)
    assert (literal.noise, literal.force_state, literal.wrench_frame) == ("independent", "torque", "thesis")


def test_what_cannot_be_is_refused():
    with pytest.raises(UnknownName, match="FDMC"):
        preset("FDCM")
    with pytest.raises(InvalidInput, match="residual"):
        TorqueSettings(residual_spread_force_n=math.inf)
