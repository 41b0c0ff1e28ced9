"""Newton's law at the pelvis as a reading of zero, as exact as it is said to be."""

import numpy as np
import pytest

from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.newton_euler import NewtonEulerLaw, NewtonEulerSettings
from tests.dynamics import notes_of, prepared_at, random_state, standing
from tests.motions import assert_near, reference_model

MODEL = reference_model()
SETTINGS = NewtonEulerSettings(residual_force_n=2.0, residual_moment_nm=0.5, imu_residual_scale=30.0)
HIDDEN = np.arange(3)


def law():
    block = NewtonEulerLaw(NewtonEuler(MODEL), SETTINGS)
    state = random_state(MODEL, np.random.default_rng(0), standing(MODEL))
    return block, state, prepared_at(block, state)


def test_the_residual_is_read_as_zero():
    _, s, at = law()
    residual = NewtonEuler(MODEL).root(s.q, s.v, s.a, s.w).residual
    assert_near(at.prepared.innovation[:3], -residual[:3] / 2.0, 1e-12 * np.abs(residual).max())
    assert_near(at.prepared.innovation[3:], -residual[3:] / 0.5, 1e-12 * np.abs(residual).max())
    assert at.prepared.readings == 6


def test_rows_stay_what_they_are_when_other_states_are_looked_at():
    """Pinocchio's derivatives live in arrays that its next call overwrites."""
    block, _, at = law()
    kept = at.prepared.jacobian.copy(), at.prepared.innovation.copy()
    block.prepare(random_state(MODEL, np.random.default_rng(9)), None)
    block.balance.torques(MODEL.neutral(), *np.zeros((2, MODEL.nv)), np.zeros(12))
    np.testing.assert_array_equal(at.prepared.jacobian, kept[0])
    np.testing.assert_array_equal(at.prepared.innovation, kept[1])


@pytest.mark.parametrize(
    ("notes", "scale"),
    [
        ({}, 1.0),
        ({"unobserved": HIDDEN}, 1.0),
        ({"imus": np.zeros((1, 6))}, 1.0),
        ({"imus": np.zeros((1, 6)), "unobserved": HIDDEN}, 30.0),
    ],
)
def test_it_is_loosened_where_inertial_sensors_read_and_a_limb_is_unobserved(notes, scale):
    """And what counts is what stands in the notes when all blocks have decided."""
    block, _, at = law()
    told = notes_of()
    decision = block.decide(at, None, None, told)
    for name, value in notes.items():
        setattr(told, name, value)
    found = block.linearise(at, decision)
    np.testing.assert_array_equal(found.jacobian, at.prepared.jacobian / scale)
    np.testing.assert_array_equal(found.innovation, at.prepared.innovation / scale)
    assert found.readings == 6


def test_its_noise_is_that_of_six_equations():
    block, _, _ = law()
    assert block.log_noise(notes_of()) == pytest.approx(2.0 * 3.0 * (np.log(2.0) + np.log(0.5)))
