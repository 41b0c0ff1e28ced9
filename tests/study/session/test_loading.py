"""The body as one mass: its force is its weight and its acceleration, and in flight it falls."""

import numpy as np

from mbkf.conventions import GRAVITY_M_S2
from mbkf.study.session.loading import body_path, flights
from tests.recordings import performer, recorded


def test_force_is_mass_times_acceleration_and_weight():
    r = recorded("squat", 4.0, 2)
    path = body_path(r)
    acceleration = np.gradient(path.velocity_m_s[:, 2], r.times_s)
    inside = slice(5, -5)
    residual = path.force_n - path.mass_kg * (acceleration + GRAVITY_M_S2)
    assert np.sqrt(np.mean(residual[inside] ** 2)) < 0.01 * path.mass_kg * GRAVITY_M_S2
    assert flights(path) == []


def test_flights_are_those_of_the_motion():
    r, motion = recorded("jump", 3.0, 2), performer("jump", 3.0, 2)[2]
    (run,) = flights(body_path(r))
    assert abs(r.times_s[run[0]] - motion.flight_s[0]) < 0.021
    assert abs(r.times_s[run[-1]] - motion.flight_s[1]) < 0.021
