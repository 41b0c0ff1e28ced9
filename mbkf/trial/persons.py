"""Several persons in one capture, for commands that follow one: who they are, and the refusal to guess.

Names tell persons apart by themselves (:mod:`mbkf.io.persons`). Bodies that only distances show are persons where a
marker set can be inferred for each: a box or a chair with markers is no body. Inferring takes seconds, so that points
fixed to the room and rigid objects, which movement shows at once, are left out before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.persons import PersonMarkers, named_persons, persons_by_shape, several_persons
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.numerics.percentiles import known_percentiles
from mbkf.numerics.runs import spread_indices
from mbkf.trial.protocol.inferred import infer_marker_set

MANY, BENDS_M, FRAMES = 20, 0.05, 60
"""Points from which on a body needs no marker set if it bends, least change of the distances of a tenth of their pairs,
and frames that are looked at."""

STILL_M, STILL_S = 0.0015, 1.0
"""Points that move by less for at least so long are fixed to the room: persons who stand for 1 s and longer move by 2.3
mm and more (25 public captures), points on the floor by the cameras' noise."""

FAR_M, RIGID_M = 0.3, 0.01
"""Points that move so far, and whose distances change by less, are those of a rigid object. In 55 public captures of
persons who move by 0.3 m and more distances change by 0.10 m and more; persons who stand (28) move by 0.035 m at
most."""


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
    bodies = [(one, _Movement.of(capture.markers, one)) for one in persons_by_shape(capture.markers)]
    farthest_m = float(np.nanmax([0.0, *(movement.moved_m for _, movement in bodies)]))
    bodies = [(one, movement) for one, movement in bodies if not movement.is_object(farthest_m)]
    if len(bodies) < 2:
        return ()
    found = tuple(one for one, movement in bodies if movement.is_body or _has_marker_set(capture, one))
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


class _Movement(NamedTuple):
    """Movement of the points of a body.

    Attributes:
        points: Number of points.
        duration_s: Time that they are looked at.
        moved_m, bent_m: Width of the middle nine tenths of places along an axis, and of distances from each other,
            which a tenth of the points and pairs exceeds; NaN where they are seen in less than half of the frames.
    """

    points: int
    duration_s: float
    moved_m: float
    bent_m: float

    @classmethod
    def of(cls, markers: MarkerTrajectories, person: PersonMarkers) -> _Movement:
        """The movement of one body of a capture."""
        own = markers.select(tuple(person.own))
        shown = own.positions_m[spread_indices(own.frames, FRAMES)]
        apart = np.linalg.norm(shown[:, :, None] - shown[:, None], axis=3)
        moved = _width(shown).max(axis=1)
        return cls(
            len(own.names),
            own.frames / own.rate_hz,
            _tenth(moved, shown[:, :, 0]),
            _tenth(_width(apart), apart),
        )

    @property
    def is_body(self) -> bool:
        """True for many points whose distances change."""
        return self.points >= MANY and self.bent_m >= BENDS_M

    def is_object(self, farthest_m: float) -> bool:
        """True for points that are fixed to the room or to each other; ``farthest_m``: how far any body moves."""
        fixed = self.moved_m < STILL_M and self.duration_s >= STILL_S and farthest_m >= FAR_M
        return fixed or (self.moved_m >= FAR_M and self.bent_m < RIGID_M)


def _width(values: Array) -> Array:
    """Width of the middle nine tenths over frames (T, ...)."""
    low, high = known_percentiles(values, (5.0, 95.0))
    return np.asarray(high - low)


def _tenth(widths: Array, values: Array) -> float:
    """Width that a tenth exceeds of those whose values (T, ...) are known in half of the frames, NaN without any."""
    known = np.isfinite(values).sum(axis=0) >= 0.5 * len(values)
    return float(np.percentile(widths[known], 90.0)) if known.any() else np.nan


def _has_marker_set(capture: Capture, person: PersonMarkers) -> bool:
    """True for points for which a marker set can be inferred."""
    markers = capture.markers.select(tuple(person.own))
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
