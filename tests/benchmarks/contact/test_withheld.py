"""The rows of withheld plates: which later frames their modes know, and what their errors count."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.contact.withheld import MODES, TOTAL_PERCENT, compared
from mbkf.conventions import GRAVITY_M_S2
from mbkf.sensors.contact.records import Contact
from tests.io.reconstructions import made_up_whole

OFF_N = 7.0


def pair():
    """A walk with its plates, every contact measured, and without: each foot's vertical force is off by 7 N."""
    names = ("ankle_angle_r", "ankle_angle_l", "pelvis_tilt")
    truth = replace(
        made_up_whole(),
        coordinate_names=names,
        foot_contact=np.full((12, 2), Contact.MEASURED),
        valid=np.ones(12, dtype=bool),
        tracked=np.ones(12, dtype=bool),
    )
    wrench = truth.foot_wrench.copy()
    wrench[:, :, 2] += OFF_N
    return truth, replace(truth, foot_wrench=wrench, foot_wrench_sd=np.full((12, 2, 6), 5.0))


def test_modes_are_bounded_from_worst_to_best():
    assert [(one.smooth, one.lag_s) for one in MODES.values()] == [(False, 0.0), (None, 0.06), (True, 0.0)]
    bounds = [TOTAL_PERCENT[mode] for mode in MODES]
    assert bounds == sorted(bounds, reverse=True)


def test_errors_are_shares_of_the_weight():
    truth, found = pair()
    off = compared(truth, found, truth.subject)
    weight_n = truth.subject.mass_kg * GRAVITY_M_S2
    assert off.total == pytest.approx(100.0 * 2.0 * OFF_N / weight_n)
    assert off.stance == pytest.approx(100.0 * OFF_N / weight_n)
    assert off.over_sd == pytest.approx(OFF_N / 5.0) and off.cover == 100.0


def test_frames_count_until_a_foot_lands_beside_the_plates():
    truth, found = pair()
    wrench = found.foot_wrench.copy()
    wrench[8:, :, 2] += 500.0
    late = replace(found, foot_wrench=wrench)
    assert compared(truth, late, truth.subject, until_s=0.075) == compared(
        truth, found, truth.subject, until_s=0.075
    )
    assert compared(truth, late, truth.subject).total > 50.0


def test_frames_with_a_foot_on_no_plate_do_not_count():
    truth, found = pair()
    wrench, contact = found.foot_wrench.copy(), np.array(truth.foot_contact)
    wrench[4:6, :, 2] += 500.0
    contact[4:6, 0] = Contact.UNMEASURED
    found, seen = replace(found, foot_wrench=wrench), replace(truth, foot_contact=contact)
    assert compared(seen, found, truth.subject).total == compared(*pair(), truth.subject).total
    assert compared(truth, found, truth.subject).total > 50.0
