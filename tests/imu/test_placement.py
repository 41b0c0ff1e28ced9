"""Typical mounts: on the body's surface side, sensor axes as people strap them, careless ones near the neat ones."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import InvalidInput
from mbkf.imu.placement import EIGHT, typical_mounts, usual_place
from mbkf.model.human import HumanModel

MODEL = HumanModel.scaled()


def test_boxes_lie_flat_with_z_away_from_the_body():
    for mount in typical_mounts(MODEL):
        out = Rotation.from_quat(mount.rotation).apply([0.0, 0.0, 1.0])
        along = Rotation.from_quat(mount.rotation).apply([1.0, 0.0, 0.0])
        if "foot" in mount.segment:
            np.testing.assert_allclose(out, [0, 0, 1], atol=1e-9)
            np.testing.assert_allclose(along, [1, 0, 0], atol=1e-9)
        else:
            level = np.array([mount.position_m[0], mount.position_m[1], 0.0])
            assert out @ level > 0.99 * np.linalg.norm(level)
            np.testing.assert_allclose(np.abs(along), [0, 0, 1], atol=1e-9)


def test_careless_ones_are_turned_and_moved_a_little_and_differ_by_seed():
    neat, first, again, other = (typical_mounts(MODEL, seed=seed) for seed in (None, 1, 1, 2))
    for a, b, c, d in zip(neat, first, again, other, strict=True):
        turn = np.degrees((Rotation.from_quat(a.rotation) * Rotation.from_quat(b.rotation).inv()).magnitude())
        assert 0.5 < turn < 45
        assert 0.001 < np.linalg.norm(a.position_m - b.position_m) < 0.08
        np.testing.assert_array_equal(b.rotation, c.rotation)
        assert np.abs(b.rotation - d.rotation).max() > 1e-3


def test_places_scale_with_the_body():
    tall = HumanModel.scaled(dict.fromkeys(MODEL.description.scale_factors, 1.1))
    for segment in EIGHT:
        np.testing.assert_allclose(usual_place(tall, segment), 1.1 * usual_place(MODEL, segment))
    with pytest.raises(InvalidInput, match="pelvis"):
        typical_mounts(MODEL, ("head",))
