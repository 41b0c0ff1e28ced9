"""Points of a body are found from markers without names."""

from dataclasses import replace

import numpy as np

from mbkf.io.records import MarkerTrajectories
from mbkf.study.survey.body_points import body_points
from mbkf.trial.synth import synthesise


def test_points_follow_feet_pelvis_and_direction():
    """Against the true motion of a turn: heading of the pelvis and its height over the trial."""
    _, made = synthesise("turn", seed=3)
    found = body_points(made.trial.markers)
    q = made.truth.q
    z, w = q[:, 5], q[:, 6]
    heading = np.unwrap(2.0 * np.arctan2(z, w))
    turned = np.rad2deg(heading[-1] - heading[0])
    yaw = found.yaw_rad[~np.isnan(found.yaw_rad)]
    assert abs(turned) > 45.0
    assert abs(np.rad2deg(yaw[-20:].mean() - yaw[:20].mean()) - turned) < 25.0
    assert (
        np.nanmax(np.abs((found.pelvis_m[:, 2] - q[:, 2]) - np.nanmean(found.pelvis_m[:, 2] - q[:, 2])))
        < 0.04
    )
    assert found.feet_m.shape == (len(q), 2, 3)
    assert found.lifts_m[np.isfinite(found.lifts_m)].min() >= 0.0


def test_a_turned_capture_turns_its_points_alone():
    """All markers turned about the vertical from a frame on: the yaw jumps by that, heights stay."""
    _, made = synthesise("reach", seconds=2.0, seed=1)
    plain = body_points(made.trial.markers)
    x, y, z = np.moveaxis(made.trial.markers.positions_m.copy(), 2, 0)
    half = len(x) // 2
    angle = np.where(np.arange(len(x)) < half, 0.0, 0.5)[:, None]
    turned = np.stack(
        [np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y, z], axis=2
    )
    found = body_points(replace(made.trial.markers, positions_m=turned))
    gained = found.yaw_rad - plain.yaw_rad
    np.testing.assert_allclose(np.diff(gained[[half - 1, half]]), 0.5, atol=1e-9)
    np.testing.assert_allclose(found.lifts_m, plain.lifts_m, atol=1e-12)


def test_knees_travel_beside_the_sinking_middle():
    """A stick figure sinks by 0.4 m at the hips while its knees go 0.1 m forward: a quarter."""
    heights = np.array([0.02, 0.03, 0.02, 0.03, 0.5, 0.5, 1.0, 1.0, 1.1, 1.1, 1.8])
    positions = np.zeros((100, len(heights), 3))
    positions[..., 2] = heights
    positions[..., 1] = np.where(np.arange(len(heights)) % 2, 0.1, -0.1)
    sunk = np.where(np.arange(100) < 50, 0.0, 1.0)[:, None]
    positions[:, 4:6, 0] += 0.1 * sunk
    positions[:, 6:, 2] -= 0.4 * sunk
    markers = MarkerTrajectories(tuple(f"*{k}" for k in range(len(heights))), positions, 100.0)
    np.testing.assert_allclose(body_points(markers).knee_travel, 0.25, atol=1e-12)
