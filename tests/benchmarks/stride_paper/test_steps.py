"""The paper's real experiments in kind."""

import numpy as np
import pytest

from benchmarks.inertial.foot_walks import foot_walk
from benchmarks.stride_paper.step_findings import step_findings
from benchmarks.stride_paper.steps import (
    KALMAN,
    METHODS,
    Estimated,
    LateStart,
    Recording,
    Signals,
    cut,
    estimate,
    kalman_way,
    late_starts,
    over_phases,
    recordings,
)


@pytest.fixture(scope="module")
def steps():
    return recordings(None)


def made(kind="one step", measured=True, length=1.0):
    walk = foot_walk((length,), rate_hz=50.0)
    time, x = walk.readings.time_s, walk.position_m[:, 0]
    return Recording("made", kind, walk.readings, length, time, x, measured)


def test_simulated_steps_have_the_papers_lengths_and_times(steps):
    assert [round(one.length_m, 3) for one in steps] == [0.7, 0.7, 1.2, 1.2]
    assert not any(one.measured for one in steps)
    still = np.diff(steps[2].course_m) == 0.0
    moves = steps[2].course_s[1:][~still]
    assert moves[0] == pytest.approx(1.22, abs=0.03)
    assert moves[-1] == pytest.approx(1.2 + 3 * 1.1, abs=0.03)


def test_readings_are_cut_with_their_ends():
    one = foot_walk((1.0,), rate_hz=50.0).readings
    part = cut(one, 0.5, 1.0)
    assert (part.time_s[0], part.time_s[-1]) == pytest.approx((0.5, 1.0))
    assert np.array_equal(part.specific_force_mps2, one.specific_force_mps2[25:51])
    assert len(part.angular_velocity_rad_s) == 26


def test_the_filter_measures_a_made_step_and_windows_depend_on_their_phase():
    one = made()
    assert kalman_way(one.readings)[1][-1] == pytest.approx(1.0, abs=0.02)
    ends = over_phases(one.readings, METHODS["as printed"])
    assert ends.shape == (10,)
    assert np.ptp(ends) > 0.2


def test_every_method_is_run_on_every_recording():
    found = estimate([made()])
    assert [one.method for one in found] == [*METHODS, KALMAN]
    assert found[-1].rms_m == pytest.approx(abs(found[-1].lengths_m[0] - 1.0))


def test_steps_are_reported_beside_the_papers():
    found = [
        Estimated(made(kind), name, np.full(10, 1.1))
        for kind in ("one step", "two steps")
        for name in METHODS
    ]
    found += [Estimated(made(kind), KALMAN, np.array([1.06])) for kind in ("one step", "two steps")]
    ways = ("ours", "bias of the first second", "velocity runs through rests", "both as the paper")
    late = [
        LateStart(
            0.0,
            dict(zip(ways, (0.1, 0.11, 0.2, 0.2), strict=True)),
            {"first rest": 0.01, "first second": 0.1},
        )
    ]
    result = step_findings(found, late, Signals(0.6, 0.9, 0.39, 1.9, 80.0, 3))
    assert [band.kept for band in result.bands] == [False, False, True, True]
    assert [claim.verdict for claim in result.claims] == [
        "cannot be had", "cannot be had", "differs", "differs", "reproduced", "reproduced", "reproduced"
    ]  # fmt: skip
    assert result.sheets[0].rows[0][2:4] == (0.70, 0.65)
    assert not step_findings(found).sheets[1].rows


def test_measured_first_steps(real_data):
    found = [one for one in recordings(real_data) if one.measured]
    assert [round(one.length_m, 2) for one in found] == [1.34, 2.73, 0.63, 2.04]
    late = late_starts([one for one in found if one.kind == "two steps"], real_data)
    assert late[0].rms_m["velocity runs through rests"] > 2.0 * late[0].rms_m["ours"]
    assert late[-1].bias_rad_s["first second"] > 2.0 * late[-1].bias_rad_s["first rest"]
