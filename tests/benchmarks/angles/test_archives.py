"""Differences from a file's Plug-in Gait angles: signs, sides, wrapped turns and gaps."""

import numpy as np
import pytest

from benchmarks.angles.archives import JOINTS, differences, worst
from mbkf.io.records import Capture, DerivedPoint, MarkerTrajectories

FRAMES = 12
NAMES = tuple(
    name
    for joint, columns in JOINTS.items()
    for name in (
        [c.lstrip("-") for c in columns]
        if joint == "Pelvis"
        else [f"{c.lstrip('-')}_{side}" for side in "rl" for c in columns]
    )
)


class Found:
    """The angles of a result, by name."""

    def __init__(self, degrees):
        self.degrees = degrees

    def angle(self, name):
        return np.deg2rad(self.degrees[:, NAMES.index(name)])


def archive(angles):
    points = tuple(DerivedPoint(name, "angle", values, "deg") for name, values in angles.items())
    return Capture("", MarkerTrajectories((), np.zeros((FRAMES, 0, 3)), 100.0), derived=points)


def as_stored(degrees, offset):
    """What a file holds where ours lies so far above it in every column."""
    stored = {}
    for joint, columns in JOINTS.items():
        for side in "RL":
            turned = []
            for column in columns:
                name = column.lstrip("-") + ("" if joint == "Pelvis" else f"_{side.lower()}")
                sign = -1.0 if column.startswith("-") else 1.0
                if joint == "Pelvis" and side == "L" and name != "pelvis_tilt":
                    sign = -sign
                turned.append(sign * degrees[:, NAMES.index(name)] - offset)
            stored[f"{side}{joint}Angles"] = np.column_stack(turned)
    return stored


@pytest.fixture
def degrees():
    return np.random.default_rng(0).uniform(-60.0, 60.0, (FRAMES, len(NAMES)))


def test_every_column_has_its_coordinate_and_sign(degrees):
    away = differences(archive(as_stored(degrees, 2.0)), Found(degrees))
    assert set(away) == {side + joint for side in "RL" for joint in JOINTS}
    for values in away.values():
        np.testing.assert_allclose(values, 2.0, atol=1e-10)
    assert worst(away, "Knee", 1) == pytest.approx((2.0, 0.0), abs=1e-10)


def test_whole_turns_and_frames_without_angles_do_not_count(degrees):
    stored = as_stored(degrees, -3.0)
    stored["RHipAngles"][:, 2] += 360.0
    stored["RHipAngles"][4] = 0.0
    away = differences(archive(stored), Found(degrees))["RHip"]
    assert np.isnan(away[4]).all()
    np.testing.assert_allclose(np.delete(away, 4, axis=0), -3.0, atol=1e-10)


def test_the_worse_side_counts_without_its_sign(degrees):
    stored = as_stored(degrees, 1.0)
    stored["LKneeAngles"][:, 0] += 5.0 + np.tile([-2.0, 2.0], FRAMES // 2)
    away = differences(archive(stored), Found(degrees))
    assert worst(away, "Knee", 0) == pytest.approx((4.0, 2.0))
