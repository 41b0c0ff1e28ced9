"""Compiled feet refuse what they could not stand on: other joints, other memories, other sizes."""

import numpy as np
import pytest

from mbkf.kernel.contact import HEAD, CompiledFeet
from mbkf.kernel.loading import library
from mbkf.kernel.tree import CompiledTree
from tests.motions import reference_model

pytestmark = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")

MODEL = reference_model()
TREE = CompiledTree.where_built(MODEL.pin_model)
FEET = [MODEL.joint(segment).joint_id for segment in MODEL.roles.feet]
WHOLE = np.array([FEET[0]] * 3 + [FEET[1]] * 3 + FEET + [MODEL.root.joint_id, 20, 2, 8], dtype=np.int32)
PLACES = np.tile([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.2, 0.0, 0.0]], (2, 1))
NUMBERS = np.array([*PLACES.ravel(), np.nan, 0.01, *np.ones(15)])
PLATES, NO_LOAD = np.zeros((2, 23)), np.zeros((2, 6))
STILL = MODEL.neutral(), np.zeros(MODEL.nv), np.zeros(MODEL.nv)


def stood(before=None, wrenches=NO_LOAD, plates=PLATES, motion=STILL):
    feet = CompiledFeet(TREE, WHOLE, NUMBERS, plates)
    before = np.zeros(feet.record_length) if before is None else before
    return feet.stand(motion, wrenches, False, before)


def test_feet_stand_where_the_body_puts_them():
    """Points of both soles, the middles of heel and toe end, and the pelvis, as the model places them."""
    q = MODEL.integrate(STILL[0], np.random.default_rng(0).normal(0.0, 0.3, MODEL.nv))
    found = stood(motion=(q, *STILL[1:]))
    rotations, origins = MODEL.placements(q)
    soles = found.rest[:18].reshape(2, 3, 3)
    for sole, joint in zip(soles, FEET, strict=True):
        np.testing.assert_allclose(sole, origins[joint] + PLACES[:3] @ rotations[joint].T, atol=1e-12)
    np.testing.assert_allclose(found.middles_m, soles[:, [0, 2]].mean(axis=1), atol=1e-12)
    np.testing.assert_allclose(found.rest[18:21], origins[MODEL.root.joint_id], atol=1e-12)


@pytest.mark.parametrize("place, value", [(0, 0), (5, 1000), (6, -1), (8, 99), (9, 0), (10, 0), (11, 3)])
def test_joints_and_frames_that_cannot_be_are_refused(place, value):
    whole = WHOLE.copy()
    whole[place] = value
    with pytest.raises(ValueError, match="do not fit"):
        CompiledFeet(TREE, whole, NUMBERS, PLATES)


def test_constants_of_another_size_are_refused():
    for whole, numbers, plates in (
        (WHOLE[:-1], NUMBERS, PLATES),
        (WHOLE, NUMBERS[:-1], PLATES),
        (WHOLE, NUMBERS, PLATES[:, :-1]),
    ):
        with pytest.raises(ValueError, match=r"size|number of numbers"):
            CompiledFeet(TREE, whole, numbers, np.ascontiguousarray(plates))


@pytest.mark.parametrize("place, value", [(6, 21.0), (6, -1.0), (7, 1.0), (8, np.nan)])
def test_a_memory_whose_counts_leave_it_is_refused(place, value):
    before = np.zeros(HEAD + 8 + 140)
    before[place] = value
    with pytest.raises(ValueError, match="none of these feet"):
        stood(before)


def test_memories_and_readings_of_another_size_are_refused():
    with pytest.raises(ValueError, match="size"):
        stood(np.zeros(HEAD + 8 + 139))
    with pytest.raises(ValueError, match="size"):
        stood(wrenches=np.zeros((1, 6)))


def test_a_memory_cannot_be_written_into():
    with pytest.raises(ValueError, match="read-only"):
        stood().after[0] = 1.0


def test_wrenches_beyond_a_covariance_are_refused():
    kernel, middles, two = library(), np.zeros((2, 3)), np.ones(2)
    for first in (-1, 9):
        with pytest.raises(ValueError, match="no such wrenches"):
            kernel.wrench_walk(np.zeros((20, 20)), first, middles, two, two)
    with pytest.raises(ValueError, match="no such wrenches"):
        kernel.wrench_walk(np.zeros((20, 19)), 0, middles, two, two)
