"""Lost markers: what is hidden, what counts as back, how a loss is made."""

import numpy as np
import pytest

from benchmarks.dynamic import losses as dynamic_losses
from benchmarks.dynamic.losses import (
    GAP_S,
    LossErrors,
    Occluded,
    OcclusionErrors,
    back_after,
    leg_dofs,
    losses,
    occlusion_errors,
    occlusion_rows,
    streaks,
)
from benchmarks.dynamic.methods import Method, in_turn
from benchmarks.dynamic.synthetic import MATCHED, make_case
from mbkf.model.clinical import dof_names
from mbkf.model.human import HumanModel

KINEMATIC = Method("kinematic")


@pytest.fixture(scope="module")
def case():
    return make_case(("squat", 0), MATCHED)


@pytest.mark.parametrize("fraction", [0.10, 0.27])
def test_streaks_reach_their_fraction_and_differ_by_seed(fraction):
    present = np.ones((238, 41), dtype=bool)
    hidden = streaks(present, fraction, 0)
    assert fraction <= hidden.mean() < fraction + 21 / hidden.size
    assert (hidden == streaks(present, fraction, 0)).all()
    assert (hidden != streaks(present, fraction, 1)).any()
    edges = np.diff(np.vstack([np.zeros((1, 41)), hidden, np.zeros((1, 41))]).astype(int), axis=0)
    for marker in range(41):
        starts, ends = np.flatnonzero(edges[:, marker] > 0), np.flatnonzero(edges[:, marker] < 0)
        inner = (starts > 0) & (ends < 238)
        assert ((ends - starts)[inner] >= 20).all()


def test_only_what_is_there_can_be_hidden():
    present = np.ones((100, 5), dtype=bool)
    present[:, 2] = False
    assert not streaks(present, 0.5, 0)[:, 2].any()


def test_hidden_samples_are_compared_with_what_was_withheld(case):
    markers = case.capture.markers
    hidden = np.zeros(markers.present.shape, dtype=bool)
    hidden[100:120, 3] = True
    withheld = markers.positions_m + np.where(hidden[:, :, None], [0.3, 0.0, 0.4], 0.0)
    found = occlusion_errors(
        Occluded(case.subject, case.capture, withheld, hidden & markers.present), KINEMATIC
    )
    assert found.hidden_mm == pytest.approx(500.0, abs=20.0)
    assert found.farthest_mm == pytest.approx(500.0, abs=20.0)
    assert found.unknown == 0


def test_occlusion_is_judged_against_its_bound_and_fcdi_at_its_best(monkeypatch, tmp_path):
    def errors(case, method):
        return OcclusionErrors(8.0 + method.scale if method.filter == "kinematic" else 7.0, 99.0, 0)

    monkeypatch.setattr(dynamic_losses, "occlude", lambda key, data: key)
    monkeypatch.setattr(dynamic_losses, "occlusion_errors", errors)
    rows = occlusion_rows("walk", 0.10, tmp_path, [Method("dynamic")], in_turn, seeds=range(5))
    by_name = {row.name.rsplit(": ", 1)[1]: row for row in rows}
    assert by_name["FCDI at its best scale 0.15"].value == pytest.approx(8.15)
    assert by_name["dynamic, hidden-marker RMS"].bound == 7.5
    assert by_name["dynamic, hidden-marker RMS / FCDI"].value == pytest.approx(7.0 / 8.15)
    assert all(row.passed for row in rows)


def test_a_loss_takes_one_lower_leg_and_withholds_it_from_the_correction(case):
    right, left = losses([case], in_turn)
    markers = case.capture.markers
    assert (right.leg, left.leg) == ("right", "left")
    assert right.end - right.first == round(GAP_S * markers.rate_hz)
    gone = markers.present & ~right.capture.markers.present
    assert np.flatnonzero(gone.any(axis=1))[[0, -1]].tolist() == [right.first, right.end - 1]
    lost = {markers.names[m] for m in np.flatnonzero(gone.any(axis=0))}
    segments = {m.segment for m in case.given.markers if m.name in lost}
    assert segments == {"right_shank", "right_foot", "right_toes"}
    moved = [np.linalg.norm(a.position_m - b.position_m) for a, b in zip(
        right.subject.markers, case.subject.markers, strict=True)]  # fmt: skip
    assert 0.0 < max(moved) < 0.005


def test_knee_and_ankle_are_the_leg_that_was_lost():
    names = dof_names(HumanModel.scaled())
    found = [names[6 + dof] for dof in leg_dofs("left")]
    assert found == [f"left_{segment}_{axis}" for segment in ("shank", "foot") for axis in "xyz"]


def test_back_is_the_first_frame_as_good_as_without_the_gap():
    error = np.array([8.0, 5.0, 2.9, 1.0])[:, None] * np.ones(6)
    assert back_after(error, np.full((4, 6), 2.0), 100.0) == pytest.approx(0.03)
    assert back_after(error, np.full((4, 6), 0.0), 100.0) == pytest.approx(0.04)
    assert back_after(error, np.full((4, 6), 4.0), 100.0) == pytest.approx(0.02)
    assert back_after(error[:2], np.full((2, 6), 2.0), 100.0) == np.inf
    assert back_after(np.full((4, 6), np.nan), np.full((4, 6), 2.0), 100.0) == np.inf


def test_a_loss_is_judged_against_fcdi_and_the_slowest_recovery(monkeypatch, case):
    made = iter([LossErrors(5.0, 2.0, 0.02), LossErrors(5.0, 2.0, 0.08)])
    monkeypatch.setattr(dynamic_losses, "lose", lambda key: key)
    monkeypatch.setattr(dynamic_losses, "gap_error_deg", lambda loss, method: 10.0 + method.scale)
    monkeypatch.setattr(dynamic_losses, "loss_errors", lambda loss, method: next(made))
    rows = dynamic_losses.loss_rows([case], [Method("dynamic")], in_turn, scales=(0.0, 1.0))
    ratio, back = rows[-2:]
    assert (ratio.value, ratio.bound) == (pytest.approx(0.5), 0.7)
    assert back.value == pytest.approx(80.0)
    assert not back.passed
