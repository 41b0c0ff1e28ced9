"""Rows of a live stream: what a frame says, in clinical terms, with spreads that follow from independent dofs."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.stream.results.frame import LiveFrame
from mbkf.viz.live.rows import MOST_UNLABELLED, DisplayRows
from tests.motions import assert_near
from tests.recordings import walk, walker


def frame(k, **changes):
    r, rng = walk(), np.random.default_rng(k)
    made = LiveFrame(
        number=k, time_s=k / 100.0, q=r.q[k], v=r.v[k], torques=r.tau[k], torques_sd=rng.uniform(1, 5, r.tau.shape[1]),
        wrench=r.foot_wrench[k], wrench_sd=np.full((2, 6), 4.0), plates=np.zeros((2, 6)), measured_m=r.measured_m[k],
        predicted_m=r.predicted_m[k], unlabelled_m=np.zeros((0, 3)), angle_sd=rng.uniform(0.01, 0.05, r.v.shape[1]),
        latency_s=0.0015, lost=2, rate_hz=100.0, tracked=True, started=k == 0,
    )  # fmt: skip
    return replace(made, **changes)


@pytest.fixture
def rows():
    return DisplayRows(walker()[1], len(walk().marker_names))


def part(rows, row, name):
    first, width = rows.layout.parts[name]
    return row[first : first + width]


def test_a_row_tells_what_the_result_of_the_same_frame_tells(rows):
    r = walk()
    for k in range(40):
        row = rows.row(frame(k))
        assert_near(part(rows, row, "angles"), r.angles[k], 1e-9)
        assert_near(part(rows, row, "moments"), r.moments[k], 1e-9)
    assert_near(part(rows, row, "force"), r.foot_wrench[39, :, :3].ravel(), 1e-12)
    assert_near(part(rows, row, "status"), [0.39, 39, 1.5, 100.0, 2, 1], 1e-12)
    assert (part(rows, row, "state") == 0).all()


def test_spreads_are_those_of_the_frame_and_of_samples(rows):
    """Angles' as the frame states them, moments' of torques drawn with the stated standard deviations."""
    f, model, clinical = frame(30), walker()[1], rows.clinical
    row = rows.row(f)
    np.testing.assert_array_equal(part(rows, row, "angles_sd"), f.angle_sd)
    rng = np.random.default_rng(1)
    tau = f.torques + rng.normal(size=(4000, model.nv)) * f.torques_sd
    moments = clinical.moments(np.tile(f.q, (4000, 1)), tau, np.tile(clinical.angles(f.q[None]), (4000, 1)))
    assert_near(part(rows, row, "moments_sd") / moments.std(axis=0), 1.0, 0.08)


def test_pressure_lies_where_the_true_one_does(rows):
    r = walk()
    for k in (50, 120):
        row = rows.row(frame(k))
        standing = r.foot_wrench[k, :, 2] > 100.0
        found = part(rows, row, "pressure").reshape(2, 3)
        assert_near(found[standing], r.foot_cop_m[k][standing], 1e-6)
        assert np.isnan(found[r.foot_wrench[k, :, 2] == 0]).all()


def test_hidden_markers_and_points_without_a_name(rows):
    measured = walk().measured_m[5].copy()
    measured[3] = np.nan
    many = np.arange(3.0 * (MOST_UNLABELLED + 10)).reshape(-1, 3)
    row = rows.row(frame(5, measured_m=measured, unlabelled_m=many))
    assert np.flatnonzero(part(rows, row, "state")).tolist() == [3]
    assert_near(part(rows, row, "unlabelled"), many[:MOST_UNLABELLED].ravel(), 0.0)
    few = rows.row(frame(5, unlabelled_m=many[:2]))
    assert np.isfinite(part(rows, few, "unlabelled")).sum() == 6


@pytest.mark.parametrize("changes", [{"tracked": False}, {"q": np.full(walk().q.shape[1], np.nan)}])
def test_a_body_that_is_not_followed_is_not_drawn(rows, changes):
    row = rows.row(frame(5, **changes))
    for name in ("segments", "predicted", "angles", "moments"):
        assert np.isnan(part(rows, row, name)).all()
    assert np.isfinite(part(rows, row, "measured")).all()
