"""Windows in which motion and contacts contradict each other, and where in them a force acts."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.loads.flags import Contradictions
from tests.bodies_in_balance import UP, WEIGHT_N, moving, times_of, unloaded


def judged(share, lasting_s, axis=UP):
    """A body on which a share of its weight acts from 2 s on."""
    return Contradictions(unloaded(moving(), share * WEIGHT_N * axis, 2.0, 2.0 + lasting_s))


@pytest.mark.parametrize(
    ("share", "lasting_s", "found"),
    [
        (0.045, 10.0, False),
        (0.056, 1.2, True),
        (0.056, 0.6, False),
        (0.09, 0.6, True),
        (-0.09, 0.6, True),
        (0.2, 0.1, False),
        (0.6, 0.1, True),
    ],
)
def test_a_mean_force_is_unexplained_above_its_limit(share, lasting_s, found):
    trial = judged(share, lasting_s)
    assert trial.exceeded(trial.missing) is found
    assert any(acts.any() for acts in trial.acting().values()) is found


@pytest.mark.parametrize("sign", [1, -1])
def test_a_force_acts_in_its_own_direction_and_time(sign):
    trial = judged(sign * 0.5, 1.0)
    acting = trial.acting()
    t = times_of(trial.balance)[acting[2, sign]]
    assert 1.85 <= t[0] <= 2.0 and 3.0 <= t[-1] <= 3.15
    assert not acting[2, -sign].any()


def test_forces_along_the_floor_are_judged_where_plates_read_them():
    trial = judged(0.2, 2.0, np.array([1.0, 0.0, 0.0]))
    assert trial.axes == (2, 0, 1) and trial.acting()[0, 1].any()
    vertical = trial.balance.feet_n * UP
    blind = Contradictions(replace(trial.balance, feet_n=vertical))
    assert blind.axes == (2,) and not blind.exceeded(blind.missing)


def test_another_mass_has_its_own_weight():
    trial = Contradictions(moving(height_m=0.0))
    assert trial.exceeded(lambda means: means.missing(1.1 * trial.balance.mass_kg))
    assert not trial.exceeded(lambda means: means.missing(1.04 * trial.balance.mass_kg))
    heavy = 0.0525 * WEIGHT_N * UP
    assert trial.exceeded(lambda means: 0.0 * means.required + heavy)
    assert not trial.exceeded(lambda means: 0.0 * means.required + heavy, 1.1 * trial.balance.mass_kg)
