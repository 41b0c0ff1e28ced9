"""Names permuted within a segment: put right where the joint would be turned about, and left alone elsewhere."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.labelling.exchanges import undo_exchanges
from mbkf.labelling.turned_segments import find_turned

FRAMES = 30
PELVIS = np.array([[0.1, 0.12, 1.0], [0.1, -0.12, 1.0], [-0.1, 0.05, 1.02], [-0.1, -0.05, 1.02]])
THIGH = np.array(
    [[0.06, 0.09, 0.78], [0.06, 0.09, 0.64], [-0.055, 0.09, 0.782], [-0.055, 0.09, 0.641], [0.0, 0.06, 0.5]]
)
"""A rectangle of four at the side of the thigh, and one at the knee."""

PLACES = np.vstack([PELVIS, THIGH])
SEGMENTS = ("pelvis",) * len(PELVIS) + ("thigh",) * len(THIGH)
PROXIMAL = {"thigh": "pelvis", "pelvis": "world"}
FRONT_AND_REAR = [(4, 6), (5, 7)]


def moved(flexion_deg, noise_m=0.002, seed=0):
    """(T, M, 3) a thigh that turns by flexions (T,) about the hip below a pelvis that sways."""
    rng = np.random.default_rng(seed)
    hip, positions = np.array([0.0, 0.08, 0.9]), []
    for t, angle in enumerate(flexion_deg):
        sway = Rotation.from_euler("ZYX", [3.0 * t, 4.0, 5.0 * np.sin(t)], degrees=True)
        thigh = hip + Rotation.from_euler("y", -angle, degrees=True).apply(THIGH - hip)
        positions.append(np.array([0.02 * t, 0.0, 0.0]) + sway.apply(np.vstack([PELVIS, thigh])))
    return np.array(positions) + rng.normal(0.0, noise_m, (len(flexion_deg), len(PLACES), 3))


def exchanged(positions, pairs):
    changed = positions.copy()
    for a, b in pairs:
        changed[:, [a, b]] = changed[:, [b, a]]
    return changed


@pytest.fixture
def walking():
    return moved(15.0 + 25.0 * np.sin(np.linspace(0.0, 6.0, FRAMES)))


def test_front_and_rear_of_a_rectangle_are_put_back(walking):
    wrong = exchanged(walking, FRONT_AND_REAR)
    found = find_turned(wrong, PLACES, SEGMENTS, PROXIMAL)
    assert sorted((one.a, one.b) for one in found) == FRONT_AND_REAR
    np.testing.assert_array_equal(undo_exchanges(wrong, found), walking)


def test_hidden_samples_are_left_out_of_the_fit_and_exchanged_with_the_rest(walking):
    walking[3:20, 5] = np.nan
    wrong = exchanged(walking, FRONT_AND_REAR)
    found = find_turned(wrong, PLACES, SEGMENTS, PROXIMAL)
    np.testing.assert_array_equal(undo_exchanges(wrong, found), walking)


def test_right_names_stay(walking):
    assert find_turned(walking, PLACES, SEGMENTS, PROXIMAL) == ()


def test_a_hip_that_is_bent_beyond_the_limit_keeps_its_names():
    squatting = moved(np.linspace(105.0, 130.0, FRAMES))
    assert find_turned(squatting, PLACES, SEGMENTS, PROXIMAL) == ()


def test_a_turn_in_half_of_the_frames_is_no_permutation(walking):
    wrong = walking.copy()
    wrong[: FRAMES // 2] = exchanged(walking, FRONT_AND_REAR)[: FRAMES // 2]
    assert find_turned(wrong, PLACES, SEGMENTS, PROXIMAL) == ()


@pytest.mark.parametrize("unknown", [[0, 1], [4, 5, 6]])
def test_too_few_known_places_give_no_answer(walking, unknown):
    places = PLACES.copy()
    places[unknown] = np.nan
    assert find_turned(exchanged(walking, FRONT_AND_REAR), places, SEGMENTS, PROXIMAL) == ()


def test_a_trial_without_a_whole_segment_gives_no_answer(walking):
    walking[:, 6] = np.nan
    assert find_turned(walking, PLACES, SEGMENTS, PROXIMAL) == ()
    assert find_turned(walking[:0], PLACES, SEGMENTS, PROXIMAL) == ()
