"""What a state says of a frame before it is read: of the state alone, and the same for whoever asks."""

from dataclasses import fields, replace

import numpy as np

from mbkf.numerics.kalman import Information
from mbkf.sensors.posture import pull
from tests.dynamics import dynamic_filter, random_state, standing
from tests.motions import assert_near, reference_model

MODEL = reference_model()
NOBODY = np.zeros(0, dtype=np.intp)


def look(q=None, seed=0, **settings):
    kalman = dynamic_filter(MODEL, **settings)
    state = random_state(MODEL, np.random.default_rng(seed), standing(MODEL) if q is None else q)
    return kalman, kalman.outlooks.at(state if q is None else replace(state, q=q))


def assert_same_information(found, expected):
    for field in fields(Information):
        np.testing.assert_array_equal(getattr(found, field.name), getattr(expected, field.name))


def test_newtons_law_is_read_as_zero_by_what_it_is_believed_to():
    kalman, found = look(residual_force_n=2.0, residual_moment_nm=0.5)
    s = found.state
    residual = kalman.balance.root(s.q, s.v, s.a, s.w).residual
    assert_near(found.law_values[:3], -residual[:3] / 2.0, 1e-12 * np.abs(residual).max())
    assert_near(found.law_values[3:], -residual[3:] / 0.5, 1e-12 * np.abs(residual).max())


def test_rows_stay_what_they_are_when_other_states_are_looked_at():
    """Pinocchio's derivatives live in arrays that its next call overwrites."""
    kalman, found = look()
    kept = found.law.copy(), found.reading.positions_m.copy(), found.by_q.copy()
    kalman.outlooks.at(random_state(MODEL, np.random.default_rng(9)))
    kalman.balance.torques(MODEL.neutral(), *np.zeros((2, MODEL.nv)), np.zeros(12))
    for now, before in zip((found.law, found.reading.positions_m, found.by_q), kept, strict=True):
        np.testing.assert_array_equal(now, before)


def test_markers_are_where_the_sensor_says():
    kalman, found = look()
    np.testing.assert_array_equal(found.reading.positions_m, kalman.sensor.positions(found.state.q))


def test_while_all_is_in_sight_the_lean_is_as_prepared():
    kalman, found = look()
    assert kalman.outlooks.lean(found, NOBODY) is found.lean
    weights = kalman.outlooks.posture.weights(kalman.settings.posture_scale, kalman.held)
    assert found.limit is None
    assert_same_information(found.lean, pull(found.deviation, found.by_q, weights))


def test_what_nobody_sees_leans_by_its_own_measure():
    kalman, found = look(unseen_posture=3.0)
    unseen = np.arange(*MODEL.joint("right_forearm").v.indices(MODEL.nv))
    weights = kalman.outlooks.posture.weights(kalman.settings.posture_scale, kalman.held)
    weights[unseen] *= 3.0
    expected = pull(found.deviation, found.by_q, weights)
    assert_same_information(kalman.outlooks.lean(found, unseen), expected)
    assert np.abs(expected.matrix - found.lean.matrix).max() > 0.0


def test_a_passed_limit_is_in_the_lean_and_stays_there_out_of_sight():
    bent = MODEL.neutral()
    knee = MODEL.joint("right_shank").v.start
    step = np.zeros(MODEL.nv)
    step[knee] = MODEL.limits[knee, 0] - 0.2
    kalman, found = look(MODEL.integrate(bent, step))
    assert found.limit is not None and found.limit.matrix[knee, knee] > 0.0
    for unseen in (NOBODY, np.array([knee])):
        weights = kalman.outlooks.posture.weights(kalman.settings.posture_scale, kalman.held)
        weights[unseen] *= kalman.settings.unseen_posture
        free = pull(found.deviation, found.by_q, weights)
        lean = kalman.outlooks.lean(found, unseen)
        assert_near(lean.matrix, free.matrix + found.limit.matrix, 1e-9)
        assert_near(lean.vector, free.vector + found.limit.vector, 1e-9)
