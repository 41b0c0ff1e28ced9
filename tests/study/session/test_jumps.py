"""Jumps: heights by ballistics, power by the work that it does."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.study.session.jumps import jump_measures
from mbkf.study.session.loading import body_path, flights
from tests.recordings import recorded, walk


@pytest.fixture(scope="module")
def jump():
    return recorded("jump", 3.0, 2)


@pytest.fixture(scope="module")
def found(jump):
    return {one.name: float(one.values[""][0]) for one in jump_measures(jump)}


def test_heights_agree_with_ballistics(jump, found):
    path = body_path(jump)
    (run,) = flights(path)
    flight_s = found["Flight time"]
    assert found["Height by flight time"] == pytest.approx(100.0 * GRAVITY_M_S2 * flight_s**2 / 8.0)
    risen = 100.0 * (np.max(path.centre_m[:, 2]) - np.median(path.centre_m[:20, 2]))
    assert found["Height of the centre of mass"] == pytest.approx(risen, abs=1.0)
    take_off = path.velocity_m_s[run[0], 2]
    assert 100.0 * take_off**2 / (2.0 * GRAVITY_M_S2) == pytest.approx(
        100.0 * (np.max(path.centre_m[run, 2]) - path.centre_m[run[0], 2]), abs=0.5
    )


def test_peaks(jump, found):
    path = body_path(jump)
    (run,) = flights(path)
    before = slice(max(0, run[0] - 100), run[0])
    power = path.force_n * path.velocity_m_s[:, 2] / path.mass_kg
    assert found["Peak power"] == pytest.approx(power[before].max())
    weight = path.mass_kg * GRAVITY_M_S2
    assert found["Peak force, push-off"] == pytest.approx(path.force_n[before].max() / weight)
    assert 40.0 < found["Share of the right leg, push-off"] < 60.0
    assert np.isnan(found["Contact time"])


def test_who_walks_does_not_jump():
    assert jump_measures(walk()) == ()
