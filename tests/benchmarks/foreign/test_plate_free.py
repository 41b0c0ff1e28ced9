"""Rows of persons without plates: impulse against momentum, and covers of frames that count."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.foreign.plate_free import Followed, impulse_misfit, plate_free_rows
from mbkf.conventions import GRAVITY_M_S2
from mbkf.model.human import HumanModel
from tests.motions import reference_model, subject_of

SUBJECT = subject_of(reference_model())


def standing(force_share, frames=51):
    """A result in which a body stands still and its feet bear so much more than its weight."""
    model, mass = HumanModel.of(SUBJECT), SUBJECT.mass_kg
    wrench = np.zeros((frames, 2, 6))
    wrench[:, 0, 2] = (1.0 + force_share) * mass * GRAVITY_M_S2
    return SimpleNamespace(
        tracked=np.ones(frames, dtype=bool),
        subject=SUBJECT,
        q=np.tile(model.neutral(), (frames, 1)),
        v=np.zeros((frames, model.nv)),
        foot_wrench=wrench,
        support_wrench=np.zeros((frames, 0, 6)),
        times_s=0.01 * np.arange(frames),
    )


def test_a_mean_force_that_changes_no_momentum_is_the_misfit():
    np.testing.assert_allclose(impulse_misfit(standing(0.03)), [0.0, 0.0, 0.03], atol=1e-12)


def test_a_force_that_changes_the_momentum_is_none():
    found = standing(0.02)
    found.v[:, 2] = 0.02 * GRAVITY_M_S2 * found.times_s
    np.testing.assert_allclose(impulse_misfit(found), 0.0, atol=1e-12)


def followed(plates, error, size=20):
    errors, sd = np.full(size, error), np.ones(size)
    return Followed("one", "walk", plates, 1.0, errors, sd, errors, sd, np.array([0.0, 0.0, 0.015]))


def test_rows_bound_cover_without_plates_and_impulse_by_whether_plates_read():
    rows = {one.name: one for one in plate_free_rows("set", [followed(True, 0.0), followed(False, 2.5)])}
    assert rows["set, no plates, walk: forces of feet in 95 % intervals"].value == 0.0
    impulse = {name: one for name, one in rows.items() if "momentum" in name}
    assert [one.value for one in impulse.values()] == pytest.approx([1.5, 1.5])
    assert [one.passed for one in impulse.values()] == [False, True]
