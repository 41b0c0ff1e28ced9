"""Both sides of Newton's law by the segments' parameters: they agree in a true motion, and tell other segments."""

from dataclasses import replace
from functools import cache

import numpy as np

from mbkf.model.inertial_regressor import PER_OWN, InertialRegressor
from mbkf.numerics.correlated_regression import regress
from mbkf.trial.inertia.prior import PLACE, inertia_prior
from mbkf.trial.inertia.rows import trial_rows
from tests.checked import body, evidence, motion

REGRESSOR = InertialRegressor(body("squat"))
SIZE = PER_OWN * len(REGRESSOR.names)


@cache
def rows():
    found = evidence("squat")
    return trial_rows(REGRESSOR, motion("squat"), found, found.clear)


def exact(differs, place=(0.0, 0.0)):
    """Plates that give, but for 1 mN, what segments that differ from the table ask for, read at another place."""
    given = rows().asked @ REGRESSOR.own(differs)[0] + 1e-3 * np.random.default_rng(0).normal(
        size=(len(rows().asked), 6)
    )
    shift = np.append(place, 0.0)
    given[:, 3:] -= np.cross(shift, given[:, :3])
    return replace(rows(), given=given)


def test_both_sides_agree_in_a_true_motion():
    """As :class:`Evidence` finds them, and within the noise of plates (1 N, 0.2 N m) and of one window."""
    found, same = evidence("squat"), rows()
    lack = same.given - same.asked @ REGRESSOR.table()
    assert np.sqrt((lack**2).mean(axis=0)).max() < 3.0
    every = np.flatnonzero(found.clear)
    weight = np.array([0.0, 0.0, found.weight_n])
    assert abs((same.asked @ REGRESSOR.table())[:, :3].mean(axis=0) - weight).max() < 0.1 * found.weight_n
    assert len(same.given) < len(every)
    assert same.follows.sum() <= len(same.given) - 1


def test_exact_plates_give_what_is_observable_exactly():
    """With next to no noise, what is left of the parameters' errors makes no difference to any load."""
    rng = np.random.default_rng(1)
    differs = np.concatenate([[0.03 * rng.normal(), *(0.003 * rng.normal(size=3))] for _ in REGRESSOR.names])
    one, prior = exact(differs, (0.002, -0.001)), inertia_prior(REGRESSOR, 1)
    mean = prior.mean
    for _ in range(4):
        mean = regress([one.series(REGRESSOR, mean, 0)], prior).posterior.mean
    lack = one.given - one.asked @ REGRESSOR.own(mean[:SIZE])[0]
    lack[:, 3:] += np.cross(np.append(mean[SIZE:], 0.0), one.given[:, :3])
    before = one.given - one.asked @ REGRESSOR.table()
    assert np.sqrt((lack**2).mean()) < 1e-3 * np.sqrt((before**2).mean())


def test_a_series_is_the_derivative_of_what_plates_lack():
    rng = np.random.default_rng(2)
    at = np.append(0.02 * rng.normal(size=SIZE), 0.001 * rng.normal(size=2 * PLACE))
    series, step = rows().series(REGRESSOR, at, 1), 1e-6

    def explained(own):
        return rows().asked @ REGRESSOR.own(own)[0]

    direction = rng.normal(size=SIZE)
    slope = (explained(at[:SIZE] + step * direction) - explained(at[:SIZE] - step * direction)) / (2 * step)
    np.testing.assert_allclose(series.design[..., :SIZE] @ direction, slope, atol=1e-5)
    np.testing.assert_allclose(
        series.values - series.design[..., :SIZE] @ at[:SIZE], rows().given - explained(at[:SIZE]), atol=1e-9
    )
    assert not series.design[..., SIZE : SIZE + PLACE].any()


def test_a_part_begins_anew():
    part = rows().part(slice(5, 9))
    assert not part.follows[0]
    np.testing.assert_array_equal(part.given, rows().given[5:9])


def test_without_frames_there_are_no_rows():
    found = evidence("squat")
    none = trial_rows(REGRESSOR, motion("squat"), found, np.zeros(len(found.times_s), dtype=bool))
    assert none.asked.shape == (0, 6, 10 * len(REGRESSOR.names))
