"""The change of the offset with the posture: against errors drawn from the roots."""

from dataclasses import fields

import numpy as np
import pytest

from mbkf.filters import offset_change
from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.filters.offset_change import OffsetChanges
from mbkf.model.clinical import ClinicalAngles
from tests.motions import random_model, smooth_motion

INSTANTS, COLUMNS, HELD = 8, 5, 10
NAMES = ("angle", "rate", "torque", "wrench")


@pytest.fixture(scope="module")
def case():
    """Clinical coordinates of a body, and its configurations at some instants with random roots of errors."""
    rng = np.random.default_rng(4)
    model = random_model(rng)
    source = smooth_motion(model, rng)
    sizes = (model.nv, model.nv, model.nv, 12)
    shared = [rng.normal(size=(n, COLUMNS)) for n in sizes]
    roots = [BodyErrorRoots(*(one + rng.normal(size=one.shape) for one in shared)) for _ in range(INSTANTS)]
    return ClinicalAngles(model), [source.q(0.1 * k) for k in range(INSTANTS)], roots


def whole(changes, again=None):
    """Changes about the mean of the whole trial, by quantity."""
    found = list(changes.about_the_whole(again))
    assert [first for first, _, _ in found] == [HELD * k for k in range(len(found))]
    assert [end for _, end, _ in found] == [*(HELD * k for k in range(1, len(found))), None]
    return {name: np.array([getattr(one, name).ravel() for _, _, one in found]) for name in NAMES}


def followed(case, instants=INSTANTS, whole_trial=True):
    """Changes after some instants, and those about the mean so far that the last frame of each had."""
    clinical, q, roots = case
    changes, so_far = OffsetChanges(clinical, whole_trial), []
    for k in range(instants):
        for frame in range(HELD):
            found = changes.so_far(HELD * k + frame, q[k], roots[k])
        so_far.append(found)
    return changes, so_far


def drawn(case, draws):
    """(draws, INSTANTS, n) errors of each quantity: those of one trial share their cause."""
    clinical, q, roots = case
    E = [clinical.rate_matrix(one) for one in q]
    cause = np.random.default_rng(5).normal(size=(draws, COLUMNS))
    read = {
        "angle": [e @ one.position for e, one in zip(E, roots, strict=True)],
        "rate": [e @ one.velocity for e, one in zip(E, roots, strict=True)],
        "torque": [one.torque for one in roots],
        "wrench": [one.wrench for one in roots],
    }
    return {name: np.einsum("knr,dr->dkn", np.array(one), cause) for name, one in read.items()}


def test_changes_are_the_scatter_of_errors_less_their_mean_over_the_trial(case):
    found, errors = whole(followed(case)[0]), drawn(case, 4000)
    for name, error in errors.items():
        scatter = (error - error.mean(axis=1, keepdims=True)).std(axis=0)
        np.testing.assert_allclose(found[name], scatter, rtol=0.06)


def test_a_live_frame_takes_the_mean_so_far(case):
    """Those of a trial that ends with it; nothing has changed at the first instant."""
    _, so_far = followed(case, whole_trial=False)
    for one in fields(so_far[0]):
        size = np.abs(getattr(so_far[-1], one.name)).max()
        np.testing.assert_allclose(getattr(so_far[0], one.name), 0.0, atol=1e-6 * size)
    for instants in (2, INSTANTS):
        ended = whole(followed(case, instants)[0])
        for name in NAMES:
            np.testing.assert_array_equal(getattr(so_far[instants - 1], name).ravel(), ended[name][-1])


def test_in_the_same_posture_nothing_changes(case):
    clinical, q, roots = case
    changes = OffsetChanges(clinical, whole_trial=True)
    one = roots[0]
    for k in range(INSTANTS):
        changes.so_far(HELD * k, q[0], BodyErrorRoots(one.position, one.velocity, one.torque, one.wrench))
    for name, change in whole(changes).items():
        np.testing.assert_allclose(change, 0.0, atol=1e-5, err_msg=name)


def test_roots_that_there_is_no_room_for_are_worked_out_again(case, monkeypatch):
    _, _, roots = case
    kept, asked = whole(followed(case)[0]), []
    one = roots[0]
    size = 4 * (2 * len(case[0].names) + len(one.torque) + len(one.wrench)) * COLUMNS
    monkeypatch.setattr(offset_change, "KEPT_BYTES", 3 * size)

    def again(number):
        asked.append(number)
        return roots[number // HELD]

    found = whole(followed(case)[0], again)
    assert asked == [HELD * k for k in range(3, INSTANTS)]
    for name in NAMES:
        np.testing.assert_array_equal(found[name], kept[name])


def test_a_trial_without_an_estimate_has_no_changes(case):
    assert not list(OffsetChanges(case[0], whole_trial=True).about_the_whole(None))
