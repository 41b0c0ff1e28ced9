"""Likelier causes than a load: mass, clocks, a foot beside its plate."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.unexplained import UnexplainedLoad
from mbkf.trial.loads.causes import stances
from mbkf.trial.loads.unexplained import unexplained_loads
from tests.bodies_in_balance import MASS_KG, RATE_HZ, UP, WEIGHT_N, moving, times_of, unloaded


def causes_in(balance):
    return [(one.cause, one.hint) for one in unexplained_loads(balance, times_of(balance)).loads]


@pytest.mark.parametrize("wrong", [0.9, 1.12])
def test_forces_of_another_body_throughout_are_a_wrong_mass(wrong):
    found = causes_in(replace(moving(), mass_kg=wrong * MASS_KG))
    assert found and {cause for cause, _ in found} == {"mass"}
    assert f"scale with --mass {MASS_KG:.1f}" in found[0][1]
    assert ("are carried" in found[0][1]) == (wrong < 1.0)


def test_a_load_for_a_part_of_the_trial_is_no_mass():
    assert [cause for cause, _ in causes_in(unloaded(moving(), -0.1 * WEIGHT_N * UP, 1.0, 3.0))] == [""]


def test_a_changing_load_throughout_is_no_mass():
    balance = moving()
    swing = (0.3 + 0.25 * np.sin(3.0 * times_of(balance)))[:, None] * WEIGHT_N * UP
    found = causes_in(replace(balance, feet_n=balance.feet_n - 0.5 * swing[:, None]))
    assert {cause for cause, _ in found} == {""}


@pytest.mark.parametrize("frames", [9, -9])
def test_forces_that_fit_at_another_time_are_a_clock(frames):
    """A bounce of 10 cm whose plates are 90 ms late or early."""
    balance = moving(hz=1.6, height_m=0.1)
    found = causes_in(replace(balance, feet_n=np.roll(balance.feet_n, frames, axis=0)))
    assert found and {cause for cause, _ in found} == {"clock"}
    assert ("late" if frames > 0 else "early") in found[0][1]


@pytest.mark.parametrize(("foot", "cause"), [(0, "right_foot"), (1, "left_foot")])
def test_a_force_that_comes_and_goes_with_a_foot_is_that_foots(foot, cause):
    """One stance of several reads only 60 % of its load."""
    balance = moving(6.0)
    begin, end = list(stances(balance.feet_n[:, foot], RATE_HZ, 0.1))[1]
    feet = balance.feet_n.copy()
    feet[begin:end, foot] *= 0.6
    found = causes_in(replace(balance, feet_n=feet))
    assert [one for one, _ in found] == [cause]
    assert "1.7 times" in found[0][1]


def test_a_cause_found_before_is_kept():
    balance = unloaded(moving(6.0), 0.3 * WEIGHT_N * UP, 2.0, 4.0)
    at = UnexplainedLoad(1.0, 3.0, (0.0, 0.0, 1.0), 1.0, 0.1, "right_foot", "beside")
    (load,) = unexplained_loads(balance, times_of(balance), [at]).loads
    assert (load.cause, load.hint) == ("right_foot", "beside")
    (load,) = unexplained_loads(
        balance, times_of(balance), [replace(at, to_s=1.5), replace(at, cause="")]
    ).loads
    assert load.cause == ""


def test_a_load_during_a_part_of_a_stance_is_no_foots():
    balance = moving(6.0)
    begin, end = list(stances(balance.feet_n[:, 0], RATE_HZ, 0.1))[1]
    middle = 0.5 * (begin + end) / RATE_HZ
    assert [
        cause for cause, _ in causes_in(unloaded(balance, 0.5 * WEIGHT_N * UP, middle - 0.9, middle))
    ] == [""]


def test_stances_are_loadings_of_a_least_duration():
    force = np.zeros((50, 3))
    force[5:20, 2] = force[30:33, 2] = 100.0
    assert list(stances(force, RATE_HZ, 0.1)) == [(5, 20)]
