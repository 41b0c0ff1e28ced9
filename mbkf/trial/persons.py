"""Several persons in one capture, for commands that follow one: who they are, and the refusal to guess.

Names tell persons apart by themselves (:mod:`mbkf.io.persons`). Bodies that only distances show are persons where a
marker set can be inferred for each: a box or a chair with markers is no body.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.persons import PersonMarkers, named_persons, persons_by_shape, several_persons
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.numerics.percentiles import known_percentiles
from mbkf.numerics.runs import spread_indices
from mbkf.trial.protocol.inferred import infer_marker_set

MANY, BENDS_M, FRAMES = 20, 0.05, 60
"""Points from which on a body needs no marker set if it bends, least change of the distances of a tenth of their pairs,
and frames that are looked at."""


@dataclass(frozen=True)
class PersonSummary:
    """One of several persons in a capture.

    Attributes:
        name: Name or number, as ``--person`` takes it.
        markers: Number of markers.
        height_m: Median height of the highest marker above the lowest, in m; None where no marker is seen.
        place_m: (x, y) median of the markers, in m; None where no marker is seen.
    """

    name: str
    markers: int
    height_m: float | None
    place_m: tuple[float, float] | None


def persons_in(capture: Capture) -> tuple[PersonMarkers, ...]:
    """The persons in a capture, in the order of the file; empty for one person.

    Args:
        capture: The capture.
    """
    if found := named_persons(capture.markers):
        return found
    found = tuple(one for one in persons_by_shape(capture.markers) if _is_body(capture, one))
    return found if len(found) > 1 else ()


def check_one_person(capture: Capture) -> None:
    """Refuses a capture of several persons without a choice.

    Raises:
        InvalidInput: It holds several persons.
    """
    if found := persons_in(capture):
        raise InvalidInput(f"{capture.path}: {several_persons(found)}")


def summaries(capture: Capture, found: Sequence[PersonMarkers]) -> tuple[PersonSummary, ...]:
    """Number of markers, height and place of each person.

    Args:
        capture: The capture.
        found: Its persons.
    """
    return tuple(_summary(one.name, capture.markers.select(tuple(one.own))) for one in found)


def _summary(name: str, markers: MarkerTrajectories) -> PersonSummary:
    places = markers.positions_m[markers.present.any(axis=1)]
    if not len(places):
        return PersonSummary(name, len(markers.names), None, None)
    heights = np.nanmax(places[:, :, 2], axis=1) - np.nanmin(places[:, :, 2], axis=1)
    x, y = np.nanmedian(places[:, :, :2], axis=(0, 1))
    return PersonSummary(name, len(markers.names), float(np.median(heights)), (float(x), float(y)))


def _is_body(capture: Capture, person: PersonMarkers) -> bool:
    """True for points that move among each other as a body's, or for which a marker set can be inferred."""
    markers = capture.markers.select(tuple(person.own))
    if len(markers.names) >= MANY and _bends(markers):
        return True
    named = tuple(
        name if not name.startswith("*") else f"point {k}"
        for k, name in enumerate(person.own.values(), start=1)
    )
    alone = replace(capture, markers=replace(markers, names=named), plates=())
    try:
        infer_marker_set(None, [alone])
    except MbkfError:
        return False
    return True


def _bends(markers: MarkerTrajectories) -> bool:
    """True where distances between the points change."""
    shown = markers.positions_m[spread_indices(markers.frames, FRAMES)]
    apart = np.linalg.norm(shown[:, :, None] - shown[:, None], axis=3)
    both = np.isfinite(apart).sum(axis=0) >= 0.5 * len(shown)
    low, high = known_percentiles(apart, (5.0, 95.0))
    return bool(np.percentile((high - low)[both], 90.0) >= BENDS_M) if both.any() else False
