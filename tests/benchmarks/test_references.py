"""Curves made to order: correlation, RMS without the mean, zero-phase low-pass, sides, rounding."""

import numpy as np
import pytest

from benchmarks.references import (
    Curve,
    agreement,
    correlation,
    in_degrees,
    low_pass,
    low_passed,
    plug_in_gait_angles,
    rms,
    rms_without_mean,
    rounding,
    worst_side,
)
from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.records import Capture, DerivedPoint, MarkerTrajectories
from mbkf.io.storage import Table

TIMES = np.arange(401) / 100.0
SINE = np.sin(2 * np.pi * TIMES)


def test_correlation_of_known_curves():
    assert correlation(SINE, 3.0 * SINE + 2.0) == pytest.approx(1.0)
    assert correlation(SINE, -SINE) == pytest.approx(-1.0)
    assert correlation(SINE[:400], np.cos(2 * np.pi * TIMES)[:400]) == pytest.approx(0.0, abs=1e-12)
    assert np.isnan(correlation(SINE, np.ones(401)))


def test_rms_with_and_without_the_mean():
    assert rms(np.array([3.0, np.nan, -3.0])) == 3.0
    assert rms_without_mean(SINE[:400] + 7.0) == pytest.approx(np.sqrt(0.5))
    assert np.isnan(rms(np.array([np.nan])))
    assert np.isnan(rms_without_mean(np.array([np.nan])))


def test_low_pass_keeps_slow_removes_fast_and_delays_nothing():
    fast = np.sin(2 * np.pi * 30.0 * TIMES)
    middle = slice(100, 300)
    found = low_pass(SINE + fast, 100.0)
    np.testing.assert_allclose(found[middle], SINE[middle], atol=5e-3)
    assert np.argmax(low_pass(np.exp(-(((TIMES - 2.0) / 0.1) ** 2)), 100.0)) == 200
    at_cut_off = np.sin(2 * np.pi * 6.0 * TIMES)
    assert rms(low_pass(at_cut_off, 100.0)[middle]) == pytest.approx(0.5 * rms(at_cut_off[middle]), rel=0.01)


def test_low_pass_of_a_table_needs_even_times():
    table = Table(("a", "b"), TIMES, np.column_stack([SINE, 0 * SINE + 2.0]))
    np.testing.assert_allclose(low_passed(table).column("b"), 2.0)
    uneven = Table(("a",), np.delete(TIMES, 50), np.delete(SINE, 50)[:, None])
    with pytest.raises(InvalidInput, match="not evenly spaced"):
        low_passed(uneven)


def test_curves_are_compared_where_both_are_known():
    coarse = Curve(TIMES[100:300:10], SINE[100:300:10] + 1.0)
    for a, b in ((coarse, Curve(TIMES, SINE)), (Curve(TIMES, SINE), coarse)):
        found = agreement(a, b)
        assert found.r == pytest.approx(1.0)
        assert found.rms == pytest.approx(1.0)
        assert found.rms_without_mean == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(InvalidInput, match="share"):
        agreement(coarse, Curve(TIMES + 10.0, SINE))


def test_the_worse_side_counts():
    ours = Table(("knee_r_moment", "knee_l_moment"), TIMES, np.column_stack([SINE, SINE]))
    theirs = Table(("knee_r_moment", "knee_l_moment"), TIMES, np.column_stack([-SINE, -SINE - 0.5]))
    found = worst_side(ours, theirs, "knee", suffix="_moment", sign=-1.0, factor=2.0)
    assert found.r == pytest.approx(1.0)
    assert found.rms == pytest.approx(1.0)
    assert found.rms_without_mean == pytest.approx(0.0, abs=1e-12)


def test_printed_numbers_are_known_to_half_their_last_digit():
    np.testing.assert_allclose(rounding(np.array([1837.1, 321.96, -9.9999])), [0.05, 0.005, 0.00005])


def test_degrees():
    table = Table(("a",), TIMES[:2], np.array([[np.pi], [0.0]]))
    assert in_degrees(table).column("a")[0] == pytest.approx(180.0)
    assert in_degrees(in_degrees(table)).column("a")[0] == pytest.approx(180.0)


def test_plug_in_gait_angles_take_the_first_component():
    points = [
        DerivedPoint(f"{side}{joint}Angles", "angle", np.full((3, 3), [number, 9.0, 9.0]), "deg")
        for number, joint in enumerate(("Hip", "Knee", "Ankle"))
        for side in "RL"
    ]
    markers = MarkerTrajectories((), np.zeros((3, 0, 3)), 100.0, 1.0)
    found = plug_in_gait_angles(Capture("", markers, derived=tuple(points)))
    assert found.column("ankle_angle_l").tolist() == [2.0, 2.0, 2.0]
    assert found.times_s[0] == 1.0
    with pytest.raises(UnknownName, match="RHipAngles"):
        plug_in_gait_angles(Capture("", markers))
