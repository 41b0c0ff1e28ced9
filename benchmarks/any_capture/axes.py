"""Axes of captures that do not state them: wrong up axes and mirror images have to be put right or refused.

Five captures are stored as nine laboratories might have: with each of the six directions up, and mirrored along each
axis. Their markers (and plates, where those stand in a file of their own) are what a reader gives that takes the
usual axes of the format. Right is a capture whose vertical and handedness come out as they truly are; its heading may
be another.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.axes import WORLD_AXES, axes_matrix, axes_text, rotation_to_world
from mbkf.io.capture import read_capture
from mbkf.io.records import AxesSource, Capture
from mbkf.io.turning import turned
from mbkf.model.protocol import detect_protocol
from mbkf.trial.axes.decision import right_axes
from mbkf.trial.axes.evidence import MarkerPlaces, marker_places

MOST_SECONDS = 0.2
"""Time that the check may take on one capture."""

MIRRORED = ("bmc_walk_run", "lower_walk1.trc")
"""A walk of legs and pelvis whose file is mirrored."""


@dataclass(frozen=True)
class Stored:
    """A capture whose file states its axes rightly, and the axes that its format usually has.

    Attributes:
        name: For the row.
        folder, trial: Where it is, below the data folder.
        usual: Axis that the format has up.
        forces: Ground reactions beside it.
    """

    name: str
    folder: str
    trial: str
    usual: str
    forces: str | None = None


CAPTURES = (
    Stored("rajagopal walk", "rajagopal_walk_run", "motion_capture_walk.trc", "y", "grf_walk.mot"),
    Stored("bmc run", "bmc_walk_run", "run.trc", "y", "run_grf.mot"),
    Stored("gait2354 static", "gait2354_walk", "subject01_static.trc", "y"),
    Stored("biomechzoo HC032A", "biomechzoo_walk_turn", "HC032A_Straight_HC032A03.c3d", "z"),
    Stored("stoop lift", "stoop_lift_box", "stoop1_t169_f620f800.c3d", "z"),
)


@dataclass
class Tally:
    """How the cases of one capture came out, and the longest time that one took."""

    right: int = 0
    refused: int = 0
    wrong: int = 0
    seconds: float = 0.0


def axes_rows(data: Path) -> list[Check]:
    """The rows of the table.

    Args:
        data: Folder of the reference captures.
    """
    rows, tallies = [], []
    for stored in CAPTURES:
        tally = _tally(stored, data)
        tallies.append(tally)
        rows += [
            Check(f"axes, {stored.name}: silently wrong of 9", tally.wrong, 0, "<="),
            information(f"axes, {stored.name}: put right of 9", tally.right),
            information(f"axes, {stored.name}: refused of 9", tally.refused),
        ]
    cases = 9 * len(CAPTURES)
    rows += [
        Check(f"axes: right or refused of {cases}", sum(t.right + t.refused for t in tallies), cases, ">="),
        information(f"axes: put right of {cases}", sum(t.right for t in tallies)),
        Check("axes: longest check of a capture", max(t.seconds for t in tallies), MOST_SECONDS, "<=", "s"),
    ]
    return [*rows, mirrored_row(data)]


def mirrored_row(data: Path) -> Check:
    """The row of a capture that is mirrored as it is stored: 1 where that is found."""
    capture = read_capture(data.joinpath(*MIRRORED))
    (found,) = right_axes([capture], [_places(capture)])
    flipped = axes_matrix(found.axes) @ axes_matrix(capture.axes).T
    is_found = np.linalg.det(flipped) < 0.0 and flipped[2, 2] == 1.0
    return Check("axes, bmc lower walk: reflection found", float(is_found), 1.0, ">=")


def as_stored(usual: str) -> Iterator[tuple[str, Array]]:
    """Name and matrix of nine ways to store world coordinates: six up axes, three mirror images of the usual one.

    Args:
        usual: Axis that the format has up.
    """
    for up in WORLD_AXES:
        yield f"{up} up", rotation_to_world(up).T
    for axis, name in enumerate("xyz"):
        flip = np.eye(3)
        flip[axis, axis] = -1.0
        yield f"{name} mirrored", flip @ rotation_to_world(usual).T


def _tally(stored: Stored, data: Path) -> Tally:
    """The nine cases of a capture."""
    folder = data / stored.folder
    forces = None if stored.forces is None else folder / stored.forces
    capture = read_capture(folder / stored.trial, forces=forces)
    if forces is None:
        capture = replace(capture, plates=())
    places, usual = _places(capture), rotation_to_world(stored.usual)
    tally = Tally()
    for _, store in as_stored(stored.usual):
        misread = usual @ store
        read = replace(turned(capture, misread, AxesSource.DEFAULT), axes=axes_text(usual))
        start = time.perf_counter()
        try:
            (found,) = right_axes([read], [places])
        except InvalidInput:
            tally.refused += 1
            continue
        finally:
            tally.seconds = max(tally.seconds, time.perf_counter() - start)
        right = is_right(found, capture, axes_matrix(found.axes) @ usual.T @ misread)
        tally.right += right
        tally.wrong += not right
    return tally


def is_right(found: Capture, true: Capture, whole: Array) -> bool:
    """Whether a capture is the true one but for its heading: markers, forces and where they act.

    Args:
        found: The capture as it came out.
        true: The capture in its true axes.
        whole: (3, 3) what turns the true one into it, by the axes that it tells.
    """
    if whole[2, 2] != 1.0 or np.linalg.det(whole) < 0.0:
        return False
    pairs = [(found.markers.positions_m, true.markers.positions_m)]
    for one, other in zip(found.plates, true.plates, strict=True):
        pairs += [(one.force_n, other.force_n), (one.centre_of_pressure_m, other.centre_of_pressure_m)]
    return all(np.allclose(one, other @ whole.T, atol=1e-6, equal_nan=True) for one, other in pairs)


def _places(capture: Capture) -> MarkerPlaces:
    protocol = detect_protocol(capture.markers.names)
    return marker_places(capture.markers.names, protocol.match(capture.markers.names), protocol.body)
