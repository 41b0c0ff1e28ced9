"""Faults put into a capture: what they change, and the force that nothing reads then."""

import numpy as np
import pytest

from benchmarks.loads.faults import Beside, Clock, Load, Mass, scaled
from mbkf.conventions import GRAVITY_M_S2
from tests.captures import MASS_KG, made_capture
from tests.motions import assert_near

WEIGHT_N = GRAVITY_M_S2 * MASS_KG


class Person:
    """A person of the capture's mass."""

    mass_kg = MASS_KG


def read(capture):
    """(S, 3) force of all plates."""
    return np.sum([plate.force_n for plate in capture.plates], axis=0)


def test_a_late_clock_moves_the_plates_alone():
    capture = made_capture()
    late, _, unread = Clock(0.1).put_into(capture, Person())
    assert [b.start_time_s - a.start_time_s for a, b in zip(capture.plates, late.plates, strict=True)] == (
        pytest.approx([0.1] * len(capture.plates))
    )
    assert late.markers is capture.markers and unread is None


def test_one_stance_reads_its_share():
    capture = made_capture(100)
    beside, _, _ = Beside(0.5).put_into(capture, Person())
    gains = [
        b.force_n[:, 2].sum() / a.force_n[:, 2].sum()
        for a, b in zip(capture.plates, beside.plates, strict=True)
    ]
    assert sorted(gains) == pytest.approx([0.5] + [1.0] * (len(gains) - 1))


@pytest.mark.parametrize("share", [0.25, -0.15])
def test_plates_read_less_by_a_load_and_keep_their_centres(share):
    capture = made_capture(200)
    loaded, _, unread = Load("x", share, (0.3, 0.7)).put_into(capture, Person())
    times = capture.markers.times_s
    assert_near(unread[len(times) // 2], [0.0, 0.0, share * WEIGHT_N], 1e-9)
    assert not unread[: len(times) // 4].any()
    middle = len(read(capture)) // 2
    assert_near((read(capture) - read(loaded))[middle], [0.0, 0.0, share * WEIGHT_N], 1.0)
    for a, b in zip(capture.plates, loaded.plates, strict=True):
        assert_near(
            b.moment_nm[middle, :2] / b.force_n[middle, 2],
            a.moment_nm[middle, :2] / a.force_n[middle, 2],
            1e-9,
        )


def test_labels():
    assert Mass(1.1).label == "mass +10 %"
    assert Clock(-0.1).label == "plates 100 ms early"
    assert Beside(0.6).label == "40 % of a step beside the plate"
    assert Load("box", -0.15, (0.0, 1.0)).label == "box of 15 % of body weight"


def test_components_of_a_plate_are_scaled_sample_by_sample():
    plate = made_capture().plates[0]
    gain = np.linspace(0.0, 1.0, len(plate.force_n))
    found = scaled(plate, gain, np.array([0.0, 0.0, 1.0, 0.0, 0.0, 1.0]))
    assert_near(found.force_n[:, 2], gain * plate.force_n[:, 2], 1e-9)
    assert_near(found.force_n[:, :2], plate.force_n[:, :2], 0.0)
    assert_near(found.moment_nm[:, 2], gain * plate.moment_nm[:, 2], 1e-9)
