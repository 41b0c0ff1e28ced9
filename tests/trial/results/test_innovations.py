"""What innovations tell: values by kind, noise by marker, and remarks where they stay outside their band."""

import numpy as np
import pytest

from mbkf.io.findings import Finding
from mbkf.trial.checks.newton import FORCE, MOMENT
from mbkf.trial.results.innovations import by_kind, marker_noise_mm, per_reading, remarks
from tests.io.reconstructions import made_up

T = 200


def trial(**changes):
    """A coherent trial of 12 readings of markers and 6 of plates a frame."""
    readings = np.tile([12, 6, 0, 0], (T, 1))
    M = len(made_up().marker_names)
    values = {
        "nis_by_kind": readings * 1.0,
        "nis_readings_by_kind": readings,
        "nis": readings.sum(axis=1) * 1.0,
        "nis_readings": readings.sum(axis=1),
        "marker_nis": np.ones((T, M)),
        "marker_spread_m": np.full((T, M), 0.002),
        "measured_m": np.zeros((T, M, 3)),
        "hidden": np.zeros((T, M), dtype=bool),
    }
    return made_up(T, **(values | changes))


def test_innovations_count_after_the_first_half_second_per_reading():
    nis, readings = np.full(100, 20.0), np.full(100, 10)
    nis[:50], nis[60], readings[70] = 1e6, np.nan, 0
    assert per_reading(made_up(100, nis=nis, nis_readings=readings)) == pytest.approx(2.0)


def test_a_coherent_trial_has_ones_and_no_remark():
    r = trial()
    assert by_kind(r) == {"markers": pytest.approx(1.0), "plates": pytest.approx(1.0)}
    assert marker_noise_mm(r) == {"A": pytest.approx(2.0), "B": pytest.approx(2.0)}
    assert remarks(r) == ()


def test_an_older_file_tells_nothing_by_kind():
    r = made_up()
    assert by_kind(r) == {} and marker_noise_mm(r) == {} and remarks(r) == ()


def test_newtons_law_before_correction_is_the_mean_of_force_and_moment():
    checks = tuple(
        Finding(name, value, 2.0, "", 9.0, "inside") for name, value in ((FORCE, 4.0), (MOMENT, 2.0))
    )
    assert by_kind(trial(checks=checks))["before_correction"] == pytest.approx((4.0 + 1.0) / 2.0)


def test_a_stretch_is_told_with_its_time_and_kind():
    r = trial()
    squared = r.nis_by_kind.copy()
    squared[100:150, 1] *= 12.0
    (remark,) = remarks(trial(nis_by_kind=squared))
    assert "1.50–1.99 s (plates 12.0)" in remark


def test_markers_above_their_band_are_told():
    squared = trial().nis_by_kind.copy()
    squared[:, 0] *= 1.6
    (remark,) = remarks(trial(nis_by_kind=squared))
    assert remark.startswith("innovations of markers: 1.6 per reading")


def test_a_single_marker_is_told_by_name_where_it_is_seen_for_long_enough():
    nis = trial().marker_nis.copy()
    nis[:, 1] = 4.0
    (remark,) = remarks(trial(marker_nis=nis))
    assert f"{made_up().marker_names[1]} (4.0)" in remark
    nis[80:, 1] = np.nan
    assert remarks(trial(marker_nis=nis)) == ()
