"""Compiled feet are where the body puts them, and refuse other feet's memory."""

from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.kernel.contact import HEAD, Stand
from mbkf.kernel.contact_functions import ContactLimits
from mbkf.kernel.loading import library
from mbkf.kernel.tree import CompiledTree
from tests.motions import reference_model

pytestmark = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")

MODEL = reference_model()
TREE = CompiledTree.where_built(MODEL.pin_model)
FEET = [MODEL.joint(segment).joint_id for segment in MODEL.roles.feet]
POINTS = np.tile([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.2, 0.0, 0.0]], (2, 1))
PLATES, NO_LOAD = 2, np.zeros((2, 6))
LIMITS = ContactLimits(*[1.0] * len(ContactLimits._fields))
CONSTANTS = {
    "point_joints": [FEET[0]] * 3 + [FEET[1]] * 3,
    "foot_joints": FEET,
    "root_joint": MODEL.root.joint_id,
    "points": POINTS,
    "window": 20,
    "still": 2,
    "fall": 8,
    "floor_m": np.nan,
    "dt_s": 0.01,
    "limits": LIMITS,
    "plate_known": np.zeros(PLATES, dtype=bool),
    "plate_least_n": np.zeros(PLATES),
    "plate_surface_m": np.zeros(PLATES),
    "plate_box": np.zeros((PLATES, 4)),
    "plate_edges": np.zeros((PLATES, 4, 4)),
}
MEMORY = HEAD + 4 * PLATES + 7 * 20
STILL = MODEL.neutral(), np.zeros(MODEL.nv), np.zeros(MODEL.nv)


def feet(**changes):
    constants = CONSTANTS | changes
    for name in ("point_joints", "foot_joints"):
        constants[name] = np.array(constants[name], dtype=np.int32)
    return library().make_feet(TREE.handle, *constants.values())


def stood(before=None, motion=STILL):
    before = np.zeros(MEMORY) if before is None else before
    return Stand(*library().decide_contact(feet(), *motion, NO_LOAD, False, before))


def test_feet_stand_where_the_body_puts_them():
    """Points of both soles, the middles of heel and toe end, and the pelvis, as the model places them."""
    q = MODEL.integrate(STILL[0], np.random.default_rng(0).normal(0.0, 0.3, MODEL.nv))
    found = stood(motion=(q, *STILL[1:]))
    rotations, origins = MODEL.placements(q)
    soles = found.soles_m
    for sole, joint in zip(soles, FEET, strict=True):
        np.testing.assert_allclose(sole, origins[joint] + POINTS[:3] @ rotations[joint].T, atol=1e-12)
    np.testing.assert_allclose(found.middles_m, soles[:, [0, 2]].mean(axis=1), atol=1e-12)
    np.testing.assert_allclose(found.pelvis_m, origins[MODEL.root.joint_id], atol=1e-12)


@pytest.mark.parametrize(
    "change",
    [
        {"point_joints": [0] * 6},
        {"point_joints": [FEET[0]] * 5 + [1000]},
        {"foot_joints": [-1, FEET[1]]},
        {"root_joint": 99},
        {"window": 0},
        {"still": 0},
        {"fall": 3},
    ],
)
def test_joints_and_frames_that_cannot_be_are_refused(change):
    with pytest.raises(ValueError, match=next(iter(change))):
        feet(**change)


def test_limits_cross_by_name():
    """In whichever order they are given."""
    turned = SimpleNamespace(**dict(reversed(LIMITS._asdict().items())))
    feet(limits=turned)
    del turned.keep_m
    with pytest.raises(TypeError, match="make_feet: limits has no 'keep_m'"):
        feet(limits=turned)


@pytest.mark.parametrize("place, value", [(6, 21.0), (6, -1.0), (7, 1.0), (8, np.nan)])
def test_a_memory_whose_counts_leave_it_is_refused(place, value):
    before = np.zeros(MEMORY)
    before[place] = value
    with pytest.raises(ValueError, match="decide_contact: the memory belongs to other feet"):
        stood(before)
