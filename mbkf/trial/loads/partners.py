"""Another person who comes so near to a segment that both may touch: a possible contact, and a cause of loads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.near_others import NearStretch, near_remarks, nearest_m, stretches
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.model.body import Body
from mbkf.trial.preparation.in_view import others_in_view

LIMB_M = 0.05
"""Half the thickness of a limb about the line between its joints."""

NAMED = "another person is near"
"""Words of a hint that names another person."""


def others_of(capture: Capture, used: Sequence[str]) -> MarkerTrajectories | None:
    """Markers of other persons in a capture: those that a choice left out, else markers of somebody else in view.

    Args:
        capture: The capture.
        used: Names of its markers that are the subject's.
    """
    if capture.others is not None:
        return capture.others
    found = others_in_view(capture.markers, used)
    return capture.markers.select(found.names) if found.is_person else None


def near_segments(
    model: Body, q: Array, own: MarkerTrajectories, subject: Subject, others: MarkerTrajectories
) -> list[NearStretch]:
    """Stretches in which another person's markers come near a segment: its markers, or the line between its joints.

    Args:
        model: The body.
        q: (T, nq) its configurations, NaN where not tracked.
        own: (T, M, 3) the person's markers, under the subject's names.
        subject: The person.
        others: Markers of the others in the same frames.
    """
    by_marker = nearest_m(own.positions_m, others.positions_m)
    segment_of = {marker.name: marker.segment for marker in subject.markers}
    segments = tuple(segment.name for segment in model.description.segments)
    apart = {name: np.full(own.frames, np.inf) for name in segments}
    for m, name in enumerate(own.names):
        if segment_of.get(name) in apart:
            segment = segment_of[name]
            apart[segment] = np.fmin(apart[segment], by_marker[:, m])
    for name, distance_m in _from_lines(model, q, others).items():
        apart[name] = np.fmin(apart[name], np.maximum(distance_m - LIMB_M, 0.0))
    return [one for name in segments for one in stretches(name.replace("_", " "), apart[name], own.times_s)]


def _from_lines(model: Body, q: Array, others: MarkerTrajectories) -> dict[str, Array]:
    """(T,) distance of the nearest marker of others from the line of each segment to its child's joint, by segment."""
    inner = [one for one in model.description.segments if one.parent != "world"]
    parents, children = (
        [model.joint(name).joint_id for name in names]
        for names in (
            [one.parent for one in inner],
            [one.name for one in inner],
        )
    )
    apart = np.full((len(q), len(inner)), np.inf)
    for t in np.flatnonzero(~np.isnan(q).any(axis=1)):
        points = others.positions_m[t]
        points = points[~np.isnan(points[:, 0])]
        if len(points):
            _, origins = model.placements(q[t])
            apart[t] = _to_lines(points, origins[parents], origins[children])
    found: dict[str, Array] = {}
    for k, one in enumerate(inner):
        found[one.parent] = np.fmin(found.get(one.parent, np.inf), apart[:, k])
    return found


def _to_lines(points_m: Array, begin_m: Array, end_m: Array) -> Array:
    """(L,) least distance of points (P, 3) from lines between two ends (L, 3) each."""
    along = end_m - begin_m
    length2 = np.maximum((along**2).sum(axis=1), 1e-12)
    from_begin = points_m[:, None] - begin_m
    share = np.clip((from_begin * along).sum(axis=2) / length2, 0.0, 1.0)
    return np.asarray(np.linalg.norm(from_begin - share[:, :, None] * along, axis=2).min(axis=0))


def with_contacts(
    found: Reconstruction,
    model: Body,
    subject: Subject,
    measured: MarkerTrajectories,
    others: MarkerTrajectories | None,
) -> Reconstruction:
    """The result with remarks on possible contacts, and their names in the hints of loads that nothing else explains.

    Args:
        found: The result.
        model: The body.
        subject: The person.
        measured: The person's markers, under the subject's names.
        others: Markers of the others in the same frames; None without any.
    """
    near = [] if others is None else near_segments(model, found.q, measured, subject, others)
    if not near:
        return found
    loads = tuple(one if one.cause else _named(one, near) for one in found.unexplained)
    return replace(found, unexplained=loads, warnings=(*found.warnings, *near_remarks(near)))


def _named(load: UnexplainedLoad, near: Sequence[NearStretch]) -> UnexplainedLoad:
    """A load with the nearest contact of its time in its hint."""
    meanwhile = [one for one in near if one.from_s <= load.to_s and one.to_s >= load.from_s]
    if not meanwhile:
        return load
    nearest = min(meanwhile, key=lambda one: one.nearest_m)
    hint = (
        f"{NAMED}: {1e3 * nearest.nearest_m:.0f} mm from the {nearest.part} from {nearest.from_s:.2f} to "
        f"{nearest.to_s:.2f} s, the likely cause; loads are not to be used there"
    )
    return replace(load, hint=hint)
