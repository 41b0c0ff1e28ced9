"""True joint centres from exact markers: a hip that turns about a known point is found; knees lie between markers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.foreign.centres import hip_in_pelvis, landmarks, true_centres
from benchmarks.foreign.truth import TO_OURS, Truth
from mbkf.errors import InvalidInput
from mbkf.io.records import MarkerTrajectories

FRAMES = 60
HIPS = {"r": np.array([-0.06, -0.09, 0.08]), "l": np.array([-0.06, -0.09, -0.08])}
NAMES = (
    *(f"pelvis_{part}" for part in ("tilt", "list", "rotation", "tx", "ty", "tz")),
    *(f"hip_{part}_{side}" for side in "rl" for part in ("flexion", "adduction", "rotation")),
)


def made() -> Truth:
    """A pelvis that moves, and thighs with markers that turn about :data:`HIPS`."""
    rng, t = np.random.default_rng(1), np.linspace(0.0, 1.0, FRAMES)
    q = np.column_stack([0.4 * np.sin(6.0 * t + rng.uniform(0.0, 6.0)) for _ in NAMES])
    value = {name: q[:, k] for k, name in enumerate(NAMES)}
    pelvis = Rotation.from_euler("ZXY", q[:, :3]).as_matrix()
    origin = q[:, 3:6]
    names: list[str] = []
    places = []
    for side, mirror in (("r", 1.0), ("l", -1.0)):
        turns = (1.0, mirror, mirror)
        angles = [
            sign * value[f"hip_{part}_{side}"]
            for sign, part in zip(turns, ("flexion", "adduction", "rotation"), strict=True)
        ]
        thigh = pelvis @ Rotation.from_euler("ZXY", np.column_stack(angles)).as_matrix()
        for name in (*(f"TH{k}" for k in (1, 2, 3)), "Knee", "MKnee", "Ankle", "MAnkle"):
            names.append(f"{side.upper()}.{name}")
            places.append(origin + pelvis @ HIPS[side] + thigh @ rng.normal(0.0, 0.2, 3))
    exact = MarkerTrajectories(tuple(names), np.stack(places, axis=1) @ TO_OURS.T, 100.0)
    moments = {side: np.zeros(FRAMES) for side in "rl"}
    return Truth(t, NAMES, q, np.zeros_like(q), moments, moments, 70.0, exact)


def test_hips_are_found_where_they_turn() -> None:
    truth = made()
    for side, hip in HIPS.items():
        np.testing.assert_allclose(hip_in_pelvis([truth], side), hip, atol=1e-9)


def test_centres_are_in_our_axes() -> None:
    truth = made()
    found = true_centres(truth, HIPS)
    turned, origin = truth.pelvis()
    right = origin + turned @ HIPS["r"]
    np.testing.assert_allclose(found["hip", "r"], np.column_stack([right[:, 0], -right[:, 2], right[:, 1]]))
    pair = [truth.exact.names.index(name) for name in ("L.Knee", "L.MKnee")]
    np.testing.assert_allclose(found["knee", "l"], truth.exact.positions_m[:, pair].mean(axis=1))


def test_unknown_marker_set_is_refused() -> None:
    with pytest.raises(InvalidInput, match="neither"):
        landmarks(("RASI", "LASI"), "r")
