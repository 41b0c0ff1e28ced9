"""The search finds maxima inside the box and on its sides, and never spends more than it may."""

import math

import numpy as np
import pytest

from mbkf.numerics.line_search import maximise

LOW, HIGH = np.full(3, -3.0), np.full(3, 3.0)


def hill(top, widths=(1.0, 0.3, 2.0), turn=0.3):
    """A quadratic hill with its top at a point, its axes turned against the coordinates."""
    A = np.diag(np.asarray(widths) ** -2.0)
    A[0, 1] = A[1, 0] = turn

    def value(x):
        d = x - np.asarray(top)
        return 5.0 - float(d @ A @ d)

    return value


def test_the_top_of_a_hill_is_found():
    found = maximise(hill((0.8, -1.3, 2.0)), np.zeros(3), LOW, HIGH, calls=80)
    np.testing.assert_allclose(found.x, (0.8, -1.3, 2.0), atol=0.06)
    assert found.value == pytest.approx(5.0, abs=0.01)
    assert found.settled


def test_a_top_outside_leads_to_the_side():
    found = maximise(hill((9.0, 0.0, -9.0), turn=0.0), np.zeros(3), LOW, HIGH, calls=200)
    np.testing.assert_allclose(found.x, (3.0, 0.0, -3.0), atol=0.05)


def test_roughness_does_not_hold_it_up():
    rng = np.random.default_rng(0)
    smooth = hill((1.0, 1.0, -1.0))
    found = maximise(lambda x: smooth(x) + 1e-3 * rng.normal(), np.zeros(3), LOW, HIGH, calls=120)
    np.testing.assert_allclose(found.x, (1.0, 1.0, -1.0), atol=0.2)


@pytest.mark.parametrize("worthless", [-math.inf, math.nan])
def test_where_there_is_no_value_it_does_not_stay(worthless):
    smooth = hill((2.0, 0.0, 0.0))
    found = maximise(lambda x: worthless if x[0] > 1.0 else smooth(x), np.zeros(3), LOW, HIGH, calls=100)
    assert 0.8 < found.x[0] <= 1.0
    assert math.isfinite(found.value)


@pytest.mark.parametrize("calls", [1, 2, 7])
def test_it_spends_no_more_than_it_may(calls):
    asked = []

    def value(x):
        asked.append(x)
        return -float(x @ x)

    found = maximise(value, np.ones(3), LOW, HIGH, calls=calls)
    assert len(asked) == found.calls == calls
    assert not found.settled
    assert found.value == max(-float(x @ x) for x in asked)


def test_a_flat_function_stays_where_it_began():
    found = maximise(lambda x: 1.0, np.ones(3), LOW, HIGH, calls=100)
    np.testing.assert_array_equal(found.x, np.ones(3))
    assert found.settled
