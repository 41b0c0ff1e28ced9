"""The change of the offset with the posture: against errors drawn from the roots."""

import numpy as np
import pytest

from mbkf.filters import offset_change
from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.filters.offset_change import CHANGES, OffsetChanges
from mbkf.filters.record import blank, record_dtype
from mbkf.filters.tracking import track_of
from mbkf.model.clinical import ClinicalAngles
from tests.dynamics import DT
from tests.motions import random_model, smooth_motion

INSTANTS, COLUMNS, HELD = 8, 5, 10
FRAMES = INSTANTS * HELD


@pytest.fixture(scope="module")
def case():
    """Clinical coordinates of a body, records of a trial, and random roots of errors at each instant of it."""
    rng = np.random.default_rng(4)
    model = random_model(rng)
    source, clinical = smooth_motion(model, rng), ClinicalAngles(model)
    sizes = {"marker": 1, "part": 1, "level": 1, "configuration": model.nq, "dof": model.nv}
    sizes |= {"coordinate": len(clinical.names), "ball": len(clinical.ball_turns)}
    rows = blank(record_dtype(sizes), FRAMES)
    rows["number"], rows["known"] = np.arange(FRAMES), True
    rows["q"] = [source.q(DT * t) for t in range(FRAMES)]
    shared, *own = (
        [rng.normal(size=(n, COLUMNS)) for n in (model.nv, model.nv, model.nv, 12)]
        for _ in range(1 + INSTANTS)
    )
    return clinical, rows, [BodyErrorRoots(*map(np.add, shared, one)) for one in own]


class Body:
    """Errors by the body that are known at the instants, and remember where they were asked for."""

    def __init__(self, case):
        _, rows, self._roots = case
        self._rows, self.asked = rows, []

    def at(self, q, v, a, wrenches, contact):
        (found,) = np.flatnonzero((self._rows["q"] == q).all(axis=1))
        self.asked.append(int(found))
        return self._roots[found // HELD]


def changed(case, rows=None, body=None, by_records=False):
    """(T, …) changes of a trial that is followed frame by frame, or by its records when it is over."""
    clinical, whole, roots = case
    rows = whole if rows is None else rows
    changes = OffsetChanges(body or Body(case), clinical, DT)
    if by_records:
        changes.follow_all(rows)
    else:
        for t in np.flatnonzero(rows["known"]):
            changes.follow(int(t), rows["q"][t], roots[t // HELD])
    track = changes.added_to(track_of(rows), rows)
    return {name: getattr(track, name) for name in CHANGES}


def test_changes_are_the_scatter_of_errors_less_their_mean_over_the_trial(case):
    """Errors of one trial share their cause; those of angles and rates go through the coordinates' derivatives."""
    clinical, rows, roots = case
    cause = np.random.default_rng(5).normal(size=(4000, COLUMNS))
    E = [clinical.rate_matrix(q) for q in rows["q"][::HELD]]
    read = {
        "angle_change": [e @ one.position for e, one in zip(E, roots, strict=True)],
        "rate_change": [e @ one.velocity for e, one in zip(E, roots, strict=True)],
        "torque_change": [one.torque for one in roots],
        "wrench_change": [one.wrench for one in roots],
    }
    found = changed(case)
    for name, each in read.items():
        error = np.einsum("knr,dr->dkn", np.array(each), cause)
        scatter = (error - error.mean(axis=1, keepdims=True)).std(axis=0)
        np.testing.assert_allclose(found[name][::HELD].reshape(scatter.shape), scatter, rtol=0.06)
        for later in range(1, HELD):
            np.testing.assert_array_equal(found[name][later::HELD], found[name][::HELD])


def test_in_the_same_posture_nothing_changes(case):
    clinical, rows, roots = case
    still, one = rows.copy(), roots[0]
    still["q"] = rows["q"][0]
    changes = OffsetChanges(Body(case), clinical, DT)
    for t in range(0, FRAMES, HELD):
        changes.follow(t, still["q"][t], BodyErrorRoots(one.position, one.velocity, one.torque, one.wrench))
    track = changes.added_to(track_of(still), still)
    for name in CHANGES:
        np.testing.assert_allclose(getattr(track, name), 0.0, atol=1e-5)


def test_a_trial_that_is_over_has_the_changes_of_one_that_was_followed(case):
    """Every instant is worked out once; frames that were lost have no change."""
    rows, body = case[1].copy(), Body(case)
    rows["known"][HELD + 1 : HELD + 4] = False
    found, followed = changed(case, rows, body, by_records=True), changed(case, rows)
    assert body.asked == list(range(0, FRAMES, HELD))
    for name in CHANGES:
        np.testing.assert_array_equal(found[name], followed[name])
        np.testing.assert_array_equal(
            np.isnan(found[name]).any(axis=tuple(range(1, found[name].ndim))), ~rows["known"]
        )


def test_roots_that_there_is_no_room_for_are_worked_out_again(case, monkeypatch):
    kept, body, one = changed(case), Body(case), case[2][0]
    rows = 2 * len(case[0].names) + len(one.torque) + len(one.wrench)
    monkeypatch.setattr(offset_change, "KEPT_BYTES", 3 * 4 * COLUMNS * rows)
    found = changed(case, body=body)
    assert body.asked == list(range(3 * HELD, FRAMES, HELD))
    for name in CHANGES:
        np.testing.assert_array_equal(found[name], kept[name])


def test_a_trial_without_an_estimate_has_no_changes(case):
    rows = case[1].copy()
    rows["known"] = False
    track = track_of(rows)
    assert OffsetChanges(Body(case), case[0], DT).added_to(track, rows) is track
