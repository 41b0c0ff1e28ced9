"""Plates that are late or early are found to 3 ms; where nothing moves, nothing is told."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.pipelines.checks.clocks import clock_finding, delayed
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
