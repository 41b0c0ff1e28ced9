"""Rows of a live stream: what a frame says, in clinical terms, with spreads that follow from independent dofs."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.contacts import Source
from mbkf.model.body_file import load_body
from mbkf.sensors.supports.bearings import BearingParts
from mbkf.stream.results.frame import LiveFrame
from mbkf.trial.results.supports import pressed_points
from mbkf.viz.live.rows import MOST_UNLABELLED, DisplayRows
from tests.motions import assert_near
from tests.recordings import walk, walker

UNASKED = np.full((len(load_body().bearings), 6), np.nan)


def frame(k, **changes):
    r, rng = walk(), np.random.default_rng(k)
    made = LiveFrame(
        number=k, time_s=k / 100.0, q=r.q[k], v=r.v[k], torques=r.tau[k], torques_sd=rng.uniform(1, 5, r.tau.shape[1]),
        wrench=r.foot_wrench[k], wrench_sd=np.full((2, 6), 4.0), plates=np.zeros((2, 6)), measured_m=r.measured_m[k],
        predicted_m=r.predicted_m[k], unlabelled_m=np.zeros((0, 3)), angle_sd=rng.uniform(0.01, 0.05, r.v.shape[1]),
        angle_offset=r.sd_q_offset[k], torques_offset=r.sd_tau_offset[k], wrench_offset=np.zeros((2, 6)),
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
    assert_near(part(rows, row, "force")[:6], r.foot_wrench[39, :, :3].ravel(), 1e-12)
    assert_near(part(rows, row, "status"), [0.39, 39, 1.5, 100.0, 2, 1, 0], 1e-12)
    stated = rows.row(replace(frame(39), unexplained=True))
    assert part(rows, stated, "status")[-1] == 1
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
        found = part(rows, row, "pressure").reshape(-1, 3)[:2]
        assert_near(found[standing], r.foot_cop_m[k][standing], 1e-6)
        assert np.isnan(found[r.foot_wrench[k, :, 2] == 0]).all()


def test_other_parts_have_their_forces_where_they_act(rows):
    """As in the results of the same frame; a foot that nothing reads and other parts are told apart from measured."""
    model, names = walker()[1], tuple(walker()[1].description.bearings)
    support = np.zeros((len(names), 6))
    hand = names.index("left_hand")
    support[hand] = [30.0, -20.0, 90.0, 1.0, 2.0, 3.0]
    source = np.array([Source.MEASURED, Source.ESTIMATED])
    row = rows.row(frame(50, foot_source=source, support=support, support_sd=0.1 * np.abs(support)))
    k = 2 + hand
    assert rows.layout.loads[k] == "left_hand"
    assert_near(part(rows, row, "force").reshape(-1, 3)[k], support[hand, :3], 0.0)
    assert_near(part(rows, row, "force_sd").reshape(-1, 3)[k], [3.0, 2.0, 9.0], 1e-12)
    expected = pressed_points(BearingParts(model), walk().q[50], support)
    np.testing.assert_array_equal(part(rows, row, "pressure").reshape(-1, 3)[2:], expected)
    assert part(rows, row, "source").tolist() == [1, 3] + [3 if i == hand else 0 for i in range(len(names))]


@pytest.mark.parametrize("changes", [{}, {"support": UNASKED, "support_sd": UNASKED}])
def test_a_filter_that_asks_for_no_other_parts_shows_none(rows, changes):
    row = rows.row(frame(50, **changes))
    assert np.isnan(part(rows, row, "force")[6:]).all()
    assert np.isnan(part(rows, row, "pressure")[6:]).all()
    assert part(rows, row, "source").tolist() == [1, 1] + [0] * len(UNASKED)


def test_declared_estimates_of_the_frame_stand_in_the_row(rows):
    row = rows.row(frame(5, plotted={"step_seconds": np.array(0.002)}))
    assert part(rows, row, "step_seconds") == [0.002]
    assert np.isnan(part(rows, rows.row(frame(5)), "step_seconds")).all()


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
