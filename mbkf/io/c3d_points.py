"""Points of a C3D file: labels made unambiguous, measured markers and derived points separated."""

from __future__ import annotations

import numpy as np

from mbkf.io.axes import finite, positions_to_world
from mbkf.io.c3d_decode import C3dContent
from mbkf.io.c3d_parameters import C3dParameters
from mbkf.io.derived import UNIT_PARAMETERS, classify, group_kinds
from mbkf.io.labels import unique_labels, without_subject
from mbkf.io.records import DerivedPoint, MarkerTrajectories

_MOTION_ANALYSIS = "motion analysis"


def read_points(
    content: C3dContent,
    up: str,
    unit: str,
    rate_hz: float,
    start_time_s: float,
    notes: list[str],
) -> tuple[MarkerTrajectories, tuple[DerivedPoint, ...]]:
    """Measured markers in m and world axes, and the derived points of a file, unchanged.

    Args:
        content: The decoded file.
        up: Axis of the file that points up.
        unit: Length unit of the file.
        rate_hz: Frame rate in Hz.
        start_time_s: Time of the first frame in s.
        notes: Receives remarks on labels.
    """
    points, parameters = content.points, content.parameters
    # A point is not seen where its residual is negative, a coordinate is not a number, or all are zero.
    present = finite(points) & (content.residuals >= 0.0)
    labels = point_labels(parameters, points.shape[1], notes)
    kinds = classify(labels, _listed(parameters))
    descriptions = parameters.texts("POINT", "DESCRIPTIONS")
    descriptions += [""] * (len(labels) - len(descriptions))
    measured = [i for i, label in enumerate(labels) if label not in kinds]
    positions = positions_to_world(points[:, measured], present[:, measured], up, unit)
    markers = MarkerTrajectories(tuple(labels[i] for i in measured), positions, rate_hz, start_time_s)
    derived = tuple(
        DerivedPoint(
            name=label,
            kind=kinds[label],
            values=np.where(present[:, i, None], points[:, i], np.nan),
            unit=parameters.text("POINT", UNIT_PARAMETERS[kinds[label]]),
            description=descriptions[i],
        )
        for i, label in enumerate(labels)
        if label in kinds
    )
    return markers, derived


def point_labels(parameters: C3dParameters, count: int, notes: list[str]) -> list[str]:
    """One unique label per point.

    Missing labels become ``*i`` (i counted from 0), a subject's name before all labels ("Anna:LASI") is taken
    off, and repeated labels get a number.

    Args:
        parameters: The file's parameters; labels continue in POINT:LABELS2, LABELS3 ….
        count: Number of points.
        notes: Receives the changes.
    """
    listed = _long_labels(parameters, count, notes) or parameters.texts("POINT", "LABELS")
    labels, beyond = listed[:count], [label for label in listed[count:] if label]
    if beyond:
        notes.append(f"POINT:LABELS names {len(beyond)} points more than the {count} of the data; not used")
    if len(labels) < count:
        notes.append(f"{count - len(labels)} of {count} points have no label; named by their number")
    labels += [""] * (count - len(labels))
    labels = [label or f"*{i}" for i, label in enumerate(labels)]
    return unique_labels(without_subject(labels), notes)


def _long_labels(parameters: C3dParameters, count: int, notes: list[str]) -> list[str]:
    """POINT:DESCRIPTIONS where Motion Analysis wrote whole names there and cut ones into LABELS; else empty."""
    names = parameters.texts("POINT", "DESCRIPTIONS")[:count]
    maker = parameters.text("MANUFACTURER", "COMPANY").lower()
    distinct = len(names) == count and all(names) and len(set(names)) == count
    if (
        not (maker.startswith(_MOTION_ANALYSIS) and distinct)
        or names == parameters.texts("POINT", "LABELS")[:count]
    ):
        return []
    notes.append(
        "names are those of POINT:DESCRIPTIONS, of which Motion Analysis writes short ones into LABELS"
    )
    return names


def _listed(parameters: C3dParameters) -> dict[str, str]:
    """Label → kind of the points the file itself declares derived."""
    kinds = group_kinds(parameters.group("POINT"))
    return {label: kind for group, kind in kinds.items() for label in parameters.texts("POINT", group)}
