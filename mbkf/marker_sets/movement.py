"""Scatter of markers in the frames of all segments over a movement: it shows the segment that a marker moves with.

The poses come from markers of certain segment. A marker on a segment keeps its place in that segment's frame, except
for skin movement; in another segment's frame it moves as the joint between them does. Where joints hardly move, the
scatter is similar in all frames and decides nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.model.human import HumanModel
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_most_markers, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor

SKIN = 2.0
"""Scatter of a marker in its own segment's frame over its noise in protocols: the pose has errors as well."""

OBSERVATIONS = 4.0
"""Number of independent observations in a movement: skin moves slowly, and with the posture."""

FREEDOM = 4.0
"""Degrees of freedom of the Student distribution of scatter."""

POOR_M = 0.02
"""Greatest RMS distance of the certain markers in a frame that counts."""

NOISE_M = 0.015
"""Noise of the markers that poses are fitted to."""


@dataclass(frozen=True)
class Movement:
    """K markers in the frames of S segments.

    Attributes:
        mean_m: (K, S, 3) mean place in each segment's frame, NaN for a marker that is seen in no frame.
        squared_m2: (K, S) Σ |y − ȳ|² over :data:`OBSERVATIONS` independent observations.
        rms_m: RMS distance of the sure markers from the bodies.
    """

    mean_m: Array
    squared_m2: Array
    rms_m: float


def movement(
    model: HumanModel, positions_m: Array, segments: Sequence[str], local_m: Array, sure: BoolArray
) -> Movement:
    """Places and scatter of markers on a moving body.

    Args:
        model: The body, scaled.
        positions_m: (T, K, 3) positions in the world, NaN where missing.
        segments: (K,) the likely segment of each.
        local_m: (K, 3) its place in that segment's frame.
        sure: (K,) True for markers that the poses are fitted to.
    """
    chosen = np.flatnonzero(sure)
    sensor = MarkerSensor(model, [segments[int(k)] for k in chosen], local_m[chosen])
    posture = PostureSensor(model)
    noise = np.full(len(chosen), NOISE_M)
    joints = [model.joint(segment.name).joint_id for segment in model.description.segments]
    places = np.full((*positions_m.shape[:2], len(joints), 3), np.nan)
    squares: list[Array] = []
    for t, points in enumerate(positions_m):
        own = points[chosen]
        if np.count_nonzero(~np.isnan(own[:, 0])) < min(6, len(chosen)):
            continue
        fit = fit_most_markers(sensor, posture, own, noise, segment_by_segment(sensor, own))
        if fit.rms_m > POOR_M:
            continue
        rotations, origins = model.placements(fit.q)
        away = points[:, None] - origins[joints]
        places[t] = np.einsum("sji,ksj->ksi", rotations[joints], away)
        squares.append(((sensor.positions(fit.q) - own) ** 2).sum(axis=1))
    seen: BoolArray = np.asarray(~np.isnan(places[..., 0]).any(axis=2))
    count = np.maximum(seen.sum(axis=0), 1)
    mean = np.nansum(places, axis=0) / count[:, None, None]
    mean[~seen.any(axis=0)] = np.nan
    squared = np.nansum((places - mean) ** 2, axis=(0, 3)) / count[:, None]
    rms = float(np.sqrt(np.nanmean(np.concatenate(squares)))) if squares else np.nan
    return Movement(mean, OBSERVATIONS * squared, rms)


def segment_scatter_m(seen: Movement, best: NDArray[np.intp], segments: int) -> Array:
    """(S,) median scatter, per coordinate, of the likely markers of a segment in its own frame.

    Where it is large, the segment was posed badly, and movement shows little about its markers.

    Args:
        seen: The movement.
        best: (K,) the likely segment of each marker.
        segments: Number of segments S.
    """
    own = np.sqrt(seen.squared_m2[np.arange(len(best)), best] / (3.0 * OBSERVATIONS))
    overall = float(np.nanmedian(own)) if len(own) else 0.0
    members = [own[(best == s) & ~np.isnan(own)] for s in range(segments)]
    return np.array([np.median(one) if len(one) else overall for one in members])


def movement_cost(squared_m2: Array, spread_m: Array) -> Array:
    """Negative log-likelihood of a movement in a segment's frame, up to a constant, by a Student distribution.

    Its heavy tails allow for skin that moves far: over the shoulder blade, at the waist.

    Args:
        squared_m2: Σ |y − ȳ|² over :data:`OBSERVATIONS` independent observations, any shape.
        spread_m: Expected scatter, per coordinate, of a shape that broadcasts with it.
    """
    dimensions = 3.0 * OBSERVATIONS
    return np.asarray(0.5 * (FREEDOM + dimensions) * np.log1p(squared_m2 / (spread_m**2 * FREEDOM)))
