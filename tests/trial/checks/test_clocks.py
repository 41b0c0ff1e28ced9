"""Plates that are late or early are found to 3 ms; where nothing moves, nothing is told."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.checks.clocks import clock_finding, delayed, together
from tests.checked import evidence, plates


@pytest.mark.parametrize("name", ["walk", "squat"])
@pytest.mark.parametrize("late_ms", [0.0, 10.0, 20.0, 40.0, -20.0])
def test_the_delay_is_found(name, late_ms):
    found = clock_finding(evidence(name, read=delayed(plates(name), 1e-3 * late_ms)))
    assert found.value == pytest.approx(late_ms, abs=3.0)
    assert found.verdict == ("inside" if late_ms == 0.0 else "outside")
    if late_ms:
        assert (" ms late" in found.hint) == (late_ms > 0.0)


@pytest.mark.parametrize("mass", [0.75, 1.3])
def test_a_wrong_mass_is_no_delay(mass):
    assert clock_finding(evidence(mass=mass)).value == pytest.approx(0.0, abs=3.0)


def test_who_stands_still_tells_no_delay():
    given = evidence("squat")
    rng = np.random.default_rng(3)
    still = np.tile([0.0, 0.0, given.weight_n, 0.0, 0.0, 0.0], (len(given.times_s), 1))
    noisy = still + rng.normal(size=still.shape)
    found = clock_finding(replace(given, asked=noisy))
    assert found.verdict == "not judged"


def test_few_frames_are_not_judged():
    given = evidence()
    assert clock_finding(given.restricted(np.arange(len(given.times_s)) < 30)).verdict == "not judged"


def test_delayed_plates_read_the_same_later():
    before, after = plates()[0], delayed(plates(), 0.02)[0]
    np.testing.assert_allclose(after.times_s, before.times_s + 0.02)
    np.testing.assert_array_equal(after.force_n, before.force_n)


def test_plates_of_one_clock_are_shifted_as_one():
    one, other = plates()[:2]
    later = replace(one, start_time_s=one.start_time_s + 0.1)
    both, alone = together((one, later, other))
    np.testing.assert_array_equal(both.force_n, one.force_n + other.force_n)
    np.testing.assert_array_equal(alone.force_n, later.force_n)
    assert (both.start_time_s, alone.start_time_s) == (one.start_time_s, later.start_time_s)


def test_shifted_together_they_give_the_sum_of_what_they_give():
    given = evidence()
    shifted = delayed(given.plates, 0.013)
    assert len(shifted) > 1
    np.testing.assert_allclose(
        given.gives(together(shifted))[:, :, :3].sum(axis=1),
        given.gives(shifted)[:, :, :3].sum(axis=1),
        rtol=0,
        atol=1e-9,
    )
