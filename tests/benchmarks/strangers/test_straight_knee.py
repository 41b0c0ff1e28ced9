"""The straight knee by the length of the leg: a leg whose angles have another zero, and hips by regression."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.strangers.straight_knee import hip_centres_m, landmarks, straight_knee, straight_knee_rows

PELVIS = {
    "right_asis": [0.1, -0.12, 1.0],
    "left_asis": [0.1, 0.12, 1.0],
    "right_psis": [-0.06, -0.05, 1.0],
    "left_psis": [-0.06, 0.05, 1.0],
}


@pytest.mark.parametrize("zero", [-8.0, 0.0, 3.5])
def test_a_leg_is_longest_where_its_knee_is_straight(zero):
    """Thigh 0.43 m, shank 0.40 m, a gap, and a deep flexion in which the hip is 5 cm off."""
    true = np.deg2rad(np.linspace(-5.0, 90.0, 96))
    length = np.sqrt(0.43**2 + 0.40**2 + 2.0 * 0.43 * 0.40 * np.cos(true))
    stated = np.rad2deg(true) + zero
    length[stated > 60.0] += 0.05
    length[20] = np.nan
    found = straight_knee(length, stated)
    assert found.angle_deg == pytest.approx(zero, abs=0.3)
    assert found.rms_mm < 0.2


def test_hip_centres_are_where_the_regression_puts_them_in_the_turned_pelvis():
    """Width 240 mm, depth 160 mm: 48.3 mm behind, 82.9 mm below and 86.5 mm beside the middle of the ASIS."""
    turn = np.array([[0.0, -1.0, 0.0], [0.8, 0.0, 0.6], [-0.6, 0.0, 0.8]])
    at = {name: (turn @ place)[None] for name, place in PELVIS.items()}
    found = hip_centres_m(at)
    for side, y in (("r", -0.0865), ("l", 0.0865)):
        np.testing.assert_allclose(found[side][0] @ turn, [0.1 - 0.0483, y, 1.0 - 0.0829], atol=1e-9)
    assert hip_centres_m({name: one for name, one in at.items() if name != "left_psis"}) == {}
    at["sacrum"] = 0.5 * (at.pop("right_psis") + at.pop("left_psis"))
    np.testing.assert_allclose(hip_centres_m(at)["r"], found["r"], atol=1e-12)


def test_markers_are_found_by_the_landmark_that_their_names_mean():
    names = ("LASI", "RASI", "LANK", "C7")
    found = landmarks(names, np.arange(12.0).reshape(1, 4, 3))
    np.testing.assert_array_equal(found["left_ankle_lateral"], [[6.0, 7.0, 8.0]])
    assert {"left_asis", "right_asis", "c7"} <= set(found)


def test_a_result_that_is_missing_has_no_rows():
    assert list(straight_knee_rows("walk", None)) == []


def test_rows_state_the_angle_and_hold_it_to_both_standard_deviations():
    """The right knee's zero is 8° off, its sd 3°, the fit's 5°; the left leg has no marker at the ankle."""
    true = np.deg2rad(np.linspace(0.0, 50.0, 51))
    still = {name: np.tile(place, (51, 1)) for name, place in PELVIS.items()}
    still["right_ankle_lateral"] = hip_centres_m(still)["r"] - np.outer(0.84 * np.cos(true / 2.0), [0, 0, 1])
    found = SimpleNamespace(
        marker_names=("RASI", "LASI", "RPSI", "LPSI", "RANK"),
        measured_m=np.stack(list(still.values()), axis=1),
        angle=lambda name: true + np.deg2rad(8.0),
        angle_sd=lambda name: np.full(51, np.deg2rad(3.0)),
    )
    shown, held = straight_knee_rows("walk", found)
    assert (shown.value, shown.bounded) == (pytest.approx(8.0), False)
    assert (held.value, held.passed) == (pytest.approx(8.0 / np.hypot(3.0, 5.0)), True)
