"""Rows: means, changes between trials and shares of known differences."""

import numpy as np
import pytest

from benchmarks.real_truth.rows import (
    MOST_SHIFT_DEG,
    agreement,
    cover_rows,
    hip_rows,
    hip_shifts,
    newton_rows,
    offset_rows,
    reference_rows,
    tilt_rows,
    trial_rows,
)
from tests.benchmarks.real_truth.made import compared, series


def value(rows, part):
    (found,) = [row.value for row in rows if part in row.name]
    return found


def test_a_range_is_that_of_the_worse_side_of_persons_with_several_trials():
    found = [
        compared("A", "walk", hips=(1.0, 2.0)),
        compared("A", "squat", hips=(0.0, 6.0)),
        compared("B", hips=(30.0, -30.0)),
    ]
    assert hip_shifts(found) == {"A": (2, pytest.approx(2.0), pytest.approx(4.0))}
    rows = offset_rows("session", found)
    assert value(rows, "range") == pytest.approx(4.0)
    assert [row.passed for row in rows] == [False, True]


def test_agreement_has_means_by_side_and_the_poorer_of_the_rest():
    found = agreement(compared(hips=(0.0, 3.5)), "angle", "hip_flexion")
    assert found.offsets == pytest.approx((0.0, 3.5))
    assert found.varying == pytest.approx(np.sqrt(0.5))
    right, left = 1.0, np.mean(np.abs(3.5 + np.sin(np.linspace(0, 2 * np.pi, 100, endpoint=False))) < 3.92)
    assert found.cover == pytest.approx(0.5 * (right + left))
    assert found.varying_cover == 1.0
    assert agreement(compared(), "moment", "hip_flexion") is None


def test_curves_are_bounded_and_standing_is_not():
    moment = series("hip_flexion_r", 0.1, 0.5, group="moment")
    rows = trial_rows("session", compared(moments=(moment,)))
    assert {row.name.split(": ")[1]: row.passed for row in rows if row.bounded} == {
        "hip, r": True,
        "hip, RMS without the mean": True,
        "hip moment, r": True,
        "hip moment, RMS without the mean": False,
    }
    assert not any(row.bounded for row in trial_rows("session", compared(trial="standing")))


def test_a_pelvis_that_tilts_away_from_its_markers_fails():
    apart = MOST_SHIFT_DEG + 0.5
    (row,) = tilt_rows("session", compared(tilt=2.0, line=2.0 - apart))
    assert (row.passed, row.value) == (False, pytest.approx(apart))
    assert tilt_rows("session", compared(line=np.nan)) == []
    assert tilt_rows("session", compared(trial="standing")) == []
    (bent,) = tilt_rows("session", compared(trial="lift 1", tilt=20.0))
    assert not bent.bounded


def test_newton_and_cover_are_for_information():
    rows = [*newton_rows("session", compared()), *cover_rows("session", [compared(hips=(0.0, 9.0))])]
    assert not any(row.bounded for row in rows)
    assert value(rows, "pelvis, RMS, ours") == 40.0
    assert value(rows, "pelvis, RMS, OpenSim") == 50.0
    assert rows[2].value == pytest.approx(0.5)
    assert rows[3].value == 1.0


@pytest.mark.parametrize(("scaling", "bounded"), [("static", True), ("session", False)])
def test_functional_hip_centres_bound_persons_that_were_scaled_without_them(scaling, bounded):
    near, spread = hip_rows(scaling, compared())
    assert (near.value, spread.value) == (14.0, 8.0)
    assert (near.bounded, spread.bounded) == (bounded, False)


def test_what_varies_is_held_to_the_tree_before_where_it_scaled_alike():
    hips = {scaling: reference_rows(scaling, [compared()] * 3)[0] for scaling in ("static", "session")}
    assert hips["static"].value == pytest.approx(np.sqrt(0.5))
    assert (hips["static"].bounded, hips["session"].bounded) == (True, False)
