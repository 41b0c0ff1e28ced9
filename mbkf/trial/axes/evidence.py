"""Evidence of a person's markers on axes: the body's upward direction, its handedness and its size."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import SubjectMarker
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import ProtocolMarker, load_protocol, protocol_names
from mbkf.numerics.runs import spread_indices

FRAMES = 60
"""Number of frames, spread over the capture; a person's attitude changes slowly."""

FEWEST_MARKERS = 6
"""Least number of markers with a known place in a frame."""

LEAST_SPREAD_M = np.array([0.05, 0.15, 0.3])
"""Least root of the summed squares of the markers' reference places in depth, breadth and height that determines the
direction."""

LEAST_PAIR_M = 0.1
"""Least distance of two markers of a segment that counts for the body's size."""

FLAT_SINE = 0.45
"""A foot stands, or nearly, with its direction within this sine of the floor: 27°."""


@dataclass(frozen=True)
class MarkerPlaces:
    """Trajectories whose place on the body is known.

    Attributes:
        columns: (K,) their columns in the capture.
        segments: (K,) the segments that carry them.
        neutral_m: (K, 3) places on the reference body that stands, facing x, m.
        feet: Segments of right and of left foot.
        height_m: Height of the reference body, m.
    """

    columns: NDArray[np.intp]
    segments: tuple[str, ...]
    neutral_m: Array
    feet: tuple[frozenset[str], frozenset[str]]
    height_m: float


@dataclass(frozen=True)
class BodyAttitude:
    """The body in some frames, in the capture's world axes.

    Attributes:
        up: (N, 3) unit directions from the feet towards the head.
        stretch: (N,) height over which the body extends along them, over that of the reference body standing.
        handedness: (N,) triple product of forward, left and up as unit vectors: 1 for a person, −1 for a mirror image;
            NaN where depth or breadth is not seen.
        feet: (N, 2, 3) unit directions from heel to toe of right and left foot, NaN where not seen.
        size: Lengths within segments over those of the reference body, NaN without one.
        scatter: Interquartile range of these ratios over their median: small for right names.
        explained: (N,) share of the markers' spread that the reference places explain.
    """

    up: Array
    stretch: Array
    handedness: Array
    feet: Array
    size: float
    scatter: float
    explained: Array


def marker_places(
    names: Iterable[str], known: dict[str, ProtocolMarker] | dict[str, SubjectMarker], body: BodyDescription
) -> MarkerPlaces:
    """Places of a capture's markers on the reference body.

    Names that the protocol or subject does not know are looked up in the shipped protocols of the same body: R.PSIS is
    on the same side and segment in each.

    Args:
        names: Names in the capture.
        known: Markers of the protocol or the subject by the capture's names.
        body: Their reference body.

    Raises:
        UnknownName: The body has no segment that a marker is on.
    """
    origins = {"world": np.zeros(3)}
    for segment in body.segments:
        origins[segment.name] = origins[segment.parent] + segment.origin_m
    origins = {name: origin - origins[body.roles.root] for name, origin in origins.items()}
    present = tuple(names)
    others = _shipped(tuple(name for name in present if name not in known), body)
    columns, segments, places = [], [], []
    for column, name in enumerate(present):
        marker = known.get(name) or others.get(name)
        if marker is not None:
            columns.append(column)
            segments.append(marker.segment)
            places.append(origins[body.segment(marker.segment).name] + marker.position_m)
    feet, toes = body.roles.feet, body.roles.toes or body.roles.feet
    return MarkerPlaces(
        np.array(columns, dtype=np.intp),
        tuple(segments),
        np.array(places).reshape(-1, 3),
        (frozenset({feet[0], toes[0]}), frozenset({feet[1], toes[1]})),
        body.reference_height_m,
    )


def _shipped(names: tuple[str, ...], body: BodyDescription) -> dict[str, ProtocolMarker]:
    """Markers of the shipped protocols of this body by these names, if all of them agree on the segment."""
    found: dict[str, ProtocolMarker] = {}
    disputed = set()
    for protocol in (load_protocol(name) for name in protocol_names() if names):
        if (protocol.body.name, protocol.body.text) != (body.name, body.text):
            continue
        for name, marker in protocol.match(names).items():
            if found.setdefault(name, marker).segment != marker.segment:
                disputed.add(name)
    return {name: marker for name, marker in found.items() if name not in disputed}


def body_attitude(markers: MarkerTrajectories, places: MarkerPlaces) -> BodyAttitude | None:
    """Attitude of the body in a capture, right-handed or mirrored.

    In a frame, positions p of the markers are regressed on their places in the neutral posture, p ≈ f d + l y + u z:
    y and z about the mean of all markers, the depth d about the mean of each segment's, since limbs swing forwards and
    backwards as a whole, but a foot's toe and a pelvis's front stay in front. f, l and u point forward, left and up,
    whatever the posture, as long as the body is not folded.

    Args:
        markers: The capture's markers.
        places: Their places on the body.

    Returns:
        The attitude in the frames with enough markers; None without such a frame.
    """
    positions = markers.positions_m[:, places.columns]
    enough = np.flatnonzero((~np.isnan(positions).any(axis=2)).sum(axis=1) >= FEWEST_MARKERS)
    if not len(enough):
        return None
    frames = enough[spread_indices(len(enough), FRAMES)]
    segments = np.array(places.segments)
    points = positions[frames]
    seen = np.asarray(~np.isnan(points).any(axis=2))
    points = np.where(seen[:, :, None], points, 0.0)
    feet = [np.isin(segments, list(foot)) for foot in places.feet]
    both_feet = np.stack([_foot(points, places.neutral_m, seen & foot) for foot in feet], axis=1)
    up, stretch, handedness, explained = _frames(points, seen, places.neutral_m, segments)
    known = ~np.isnan(stretch)
    if not known.any():
        return None
    low, size, high = _sizes(positions[frames], places, segments)
    return BodyAttitude(
        up[known],
        stretch[known],
        handedness[known],
        both_feet[known],
        size,
        (high - low) / size,
        explained[known],
    )


def _frames(
    points: Array, seen: BoolArray, neutral: Array, segments: NDArray[np.str_]
) -> tuple[Array, Array, Array, Array]:
    """Up (F, 3), stretch, handedness and explained share (F,) of frames; NaN without evidence on up.

    Args:
        points: (F, K, 3) markers of the frames, 0 where missing.
        seen: (F, K) True where they are not.
        neutral: (K, 3) their places on the body.
        segments: (K,) their segments.
    """
    counts = seen.sum(axis=1)[:, None]
    from_middle = neutral[:, 1:] - (seen @ neutral[:, 1:] / counts)[:, None]
    design = np.concatenate([_depth(seen, neutral, segments)[:, :, None], from_middle], axis=2)
    design = np.where(seen[:, :, None], design, 0.0)
    spread_enough = np.linalg.norm(design, axis=1) >= LEAST_SPREAD_M
    design = np.where(spread_enough[:, None], design, 0.0)
    centred = np.where(seen[:, :, None], points - (points.sum(axis=1) / counts)[:, None], 0.0)
    slopes = np.linalg.pinv(design, rcond=len(neutral) * np.finfo(float).eps) @ centred
    left, spread = centred - design @ slopes, (centred**2).sum(axis=(1, 2))
    lengths = np.linalg.norm(slopes, axis=2)
    clear = ((lengths > 0.0) | ~spread_enough).all(axis=1) & spread_enough[:, 2]
    units = slopes / np.where(clear[:, None] & (lengths > 0.0), lengths, np.nan)[:, :, None]
    sided = clear & spread_enough.all(axis=1)
    handedness = np.where(sided, np.linalg.det(np.where(sided[:, None, None], units, 0.0)), np.nan)
    explained = 1.0 - (left**2).sum(axis=(1, 2)) / np.where(spread > 0.0, spread, np.inf)
    return (
        units[:, 2],
        np.where(clear, lengths[:, 2], np.nan),
        handedness,
        np.where(spread > 0.0, explained, 0.0),
    )


def _depth(seen: BoolArray, neutral: Array, segments: NDArray[np.str_]) -> Array:
    """(F, K) distance of each marker in front of the mean of its segment's that are seen (F, K)."""
    names, which = np.unique(segments, return_inverse=True)
    own = np.eye(len(names))[which]
    means = (seen * neutral[:, 0]) @ own / np.maximum(seen @ own, 1)
    return np.asarray(neutral[:, 0] - means[:, which])


def _foot(points: Array, neutral: Array, own: BoolArray) -> Array:
    """(F, 3) unit direction from heel to toe in frames (F, K, 3); NaN with too few of the foot's own markers (F, K)."""
    mean = own @ neutral[:, 0] / np.maximum(own.sum(axis=1), 1)
    ahead = np.where(own, neutral[:, 0] - mean[:, None], 0.0)
    direction = (ahead[:, None] @ points)[:, 0]
    length = np.linalg.norm(direction, axis=1)
    enough = (length > 0.0) & (np.linalg.norm(ahead, axis=1) >= LEAST_SPREAD_M[0])
    return np.asarray(direction / np.where(enough, length, np.nan)[:, None])


def _sizes(positions: Array, places: MarkerPlaces, segments: NDArray[np.str_]) -> tuple[float, float, float]:
    """Quartiles of measured over reference distances between markers of the same segment; NaN without such a pair."""
    first, second = np.triu_indices(len(segments), 1)
    reference = np.linalg.norm(places.neutral_m[first] - places.neutral_m[second], axis=1)
    pairs = (segments[first] == segments[second]) & (reference >= LEAST_PAIR_M)
    measured = np.linalg.norm(positions[:, first[pairs]] - positions[:, second[pairs]], axis=2)
    ratios = (measured / reference[pairs])[~np.isnan(measured)]
    if not ratios.size:
        return np.nan, np.nan, np.nan
    low, middle, high = np.percentile(ratios, [25, 50, 75])
    return float(low), float(middle), float(high)
