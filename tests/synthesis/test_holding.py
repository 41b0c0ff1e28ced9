"""The changes of lean and height that bring a part of the body to its place."""

import numpy as np

from mbkf.synthesis.holding import Correction, Hold

TIMES = np.linspace(0.0, 2.0, 401)


def held(missed, lean):
    """A hold in the first half, free in the last quarter."""
    return Hold(
        missed,
        lambda t: (t < 1.0).astype(float),
        lambda t: (t > 1.5).astype(float),
        lean,
        metres_per_rad=0.25,
    )


def test_in_rounds_the_part_comes_to_its_place_and_elsewhere_nothing_changes():
    """A part that leans back by 0.2 m per radian and rises with the height."""

    def missed(times, _):
        change = correction(times).value
        return np.column_stack(
            [0.03 + 0.02 * times - 0.2 * change[:, 0], -0.1 + 0.05 * np.sin(times) + change[:, 1]]
        )

    correction = Correction(held(missed, {"torso": (0.0, 1.0, 0.0)}), TIMES)
    far = correction.improve(None)
    for _ in range(15):
        near = correction.improve(None)
    assert near < 5e-3 < far
    assert np.abs(missed(TIMES, None)[TIMES < 0.9]).max() < 1e-3
    assert np.abs(correction(TIMES[TIMES > 1.6]).value).max() < 5e-3


def test_without_lean_only_the_height_changes():
    correction = Correction(held(lambda times, _: np.full((len(times), 2), 0.1), {}), TIMES)
    correction.improve(None)
    change = correction(TIMES).value
    assert not change[:, 0].any()
    assert np.abs(change[TIMES < 0.8, 1] + 0.1).max() < 2e-3


def test_its_rates_are_exact():
    correction = Correction(held(lambda times, _: np.column_stack([times, times**2]), {}), TIMES)
    correction.improve(None)
    at, h = np.linspace(0.1, 1.9, 37), 1e-5
    late, early, now = correction(at + h), correction(at - h), correction(at)
    for k in range(2):
        slope = (late.orders[k] - early.orders[k]) / (2 * h)
        assert np.abs(slope - now.orders[k + 1]).max() < 1e-5 * (1 + np.abs(now.orders[k + 1]).max())
