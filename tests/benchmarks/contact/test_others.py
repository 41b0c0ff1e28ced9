"""Rows on other contacts: errors per part, and how late a part is found."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.contact.others import BEARS_SHARE, Trial, lateness_s, seated_percent, support_percent
from mbkf.conventions import GRAVITY_M_S2

MASS_KG, RATE_HZ, FRAMES = 70.0, 100.0, 300
WEIGHT_N = MASS_KG * GRAVITY_M_S2


def trial(begins, off_n=0.0, named=True):
    """A hand that bears from frame 100 on, 5 % of weight 10 frames later; found from a frame on."""
    true = np.zeros(FRAMES)
    true[100:] = np.minimum(np.arange(1, 201) / 10.0, 4.0) * BEARS_SHARE * WEIGHT_N
    found = np.where(np.arange(FRAMES) >= begins, true + off_n, 0.0)
    names = ("right_hand",) if named else ("pelvis",)
    wrench = np.zeros((FRAMES, 1, 6))
    truth = wrench.copy()
    wrench[:, 0, 2], truth[:, 0, 2] = found, true
    return Trial(
        SimpleNamespace(mass_kg=MASS_KG),
        SimpleNamespace(
            times_s=np.arange(FRAMES) / RATE_HZ, support_names=("right_hand",), support_wrench=truth
        ),
        SimpleNamespace(support_names=names, support_wrench=wrench, support_wrench_sd=np.ones_like(wrench)),
    )


@pytest.mark.parametrize(("begins", "late"), [(100, 0.0), (105, 0.0), (130, 0.2), (80, -0.2)])
def test_a_part_is_late_outside_of_its_first_and_its_bearing_frame(begins, late):
    found = trial(begins)
    if begins < 100:
        found.found.support_wrench[begins:, 0, 2] += 1.0
    (first,) = lateness_s(found)
    assert first == pytest.approx(late, abs=0.011)


def test_a_part_that_is_never_found_is_infinitely_late():
    assert lateness_s(trial(0, named=False)) == [float("inf")]


def test_errors_are_of_the_frames_in_which_a_part_bears():
    assert support_percent(trial(100, 0.02 * WEIGHT_N))["right_hand"] == pytest.approx(2.0)
    missed = support_percent(trial(0, named=False))["right_hand"]
    assert 15.0 < missed < 20.0


@pytest.mark.parametrize(
    ("begins", "within", "beyond"), [(101, 100.0, 0.0), (151, 75.0, 0.0), (81, 100.0, 10.0)]
)
def test_time_on_a_seat_is_found_and_exceeded(begins, within, beyond):
    made = trial(begins)
    made.found.support_wrench[begins:, 0, 2] += 1.0
    assert seated_percent(made) == pytest.approx((within, beyond), abs=1.5)
