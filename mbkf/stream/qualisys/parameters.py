"""QTM's parameters, XML: frame rate, labels, axis that points up, plates with their corners.

Source: QTM Real-time Server Protocol Documentation 1.25 (Qualisys), section XML parameters: plates as in C3D files.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.axes import METRES_PER_UNIT, length_unit, rotation_to_world, up_axis
from mbkf.io.labels import unique_labels
from mbkf.io.loose_xml import Element, parse_loose_xml
from mbkf.io.plate_corners import has_area
from mbkf.io.records import PlateReadings
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N
from mbkf.stream.source import FARTHEST_M, StreamDescription, empty_plate

MM = 1e-3
"""Coordinates of points are millimetres."""

HIGHEST_HZ = 100_000.0

MOST_LABELS, MOST_PLATES = 5000, 64


@dataclass(frozen=True)
class QtmDescription:
    """A stream as QTM's parameters describe it.

    Attributes:
        stream: Its description; plates about the middles of their corners.
        plate_ids: (K,) their IDs in frames.
        rotation: (3, 3) from QTM's axes to the world's.
        left_out: Sentences on plates that cannot be read.
    """

    stream: StreamDescription
    plate_ids: tuple[int, ...]
    rotation: Array
    left_out: tuple[str, ...] = ()

    @cached_property
    def to_world(self) -> Array:
        """(3, 3) matrix that takes rows of coordinates in QTM's axes, mm, to the world's, m."""
        return MM * self.rotation.T


def read_parameters(text: str, up: str | None = None) -> QtmDescription:
    """The stream that parameters General, 3D and Force describe.

    Args:
        text: XML.
        up: Axis that points up; None for the one that QTM states.

    Raises:
        InvalidInput: It states no frame rate, or an axis that does not exist.
        UnknownName: The axis, or the unit of length, does not exist.
    """
    root = parse_loose_xml(text)
    general, markers, force = (_block(root, name) for name in ("General", "The_3D", "Force"))
    rate_hz = _number(general.child_text("Frequency"))
    if not 1.0 <= rate_hz <= HIGHEST_HZ:
        raise InvalidInput(
            f"Qualisys: QTM states the frame rate {general.child_text('Frequency')!r}; start a measurement"
        )
    rotation = rotation_to_world(up_axis(up or markers.child_text("AxisUpwards") or "z"))
    labels = [one.child_text("Name") for one in markers.children if one.tag == "Label"][:MOST_LABELS]
    plates: list[PlateReadings] = []
    ids: list[int] = []
    left_out: list[str] = []
    metres = METRES_PER_UNIT[length_unit(force.child_text("Unit_Length") or "mm")]
    for k, one in enumerate([one for one in force.children if one.tag == "Plate"][:MOST_PLATES]):
        name = one.child_text("Name") or f"plate {k + 1}"
        plate_rate_hz, number = (
            _number(one.child_text("Frequency")),
            _number(one.child_text("Plate_ID", "Force_Plate_Index")),
        )
        corners = metres * _corners(one) @ rotation.T
        if (
            not has_area(corners, FARTHEST_M)
            or not 1.0 <= plate_rate_hz <= HIGHEST_HZ
            or not math.isfinite(number)
        ):
            left_out.append(f"plate '{name}' has no usable corners, frequency or ID in QTM and is left out")
            continue
        if plates and plates[0].rate_hz != plate_rate_hz:
            left_out.append(f"plate '{name}' has another frequency than '{plates[0].name}' and is left out")
            continue
        plates.append(
            empty_plate(name, plate_rate_hz, 0.0, corners.mean(axis=0), DEFAULT_COP_THRESHOLD_N, corners)
        )
        ids.append(int(number))
    stream = StreamDescription("qualisys", tuple(unique_labels(labels, [])), rate_hz, 0.0, tuple(plates))
    return QtmDescription(stream, tuple(ids), rotation, tuple(left_out))


def _block(root: Element, name: str) -> Element:
    return next(iter(root.every(name)), Element(name))


def _corners(plate: Element) -> Array:
    """(4, 3) corners, NaN where they are not stated."""
    place = plate.child("Location") or Element("Location")
    corners = [place.child(f"Corner{k}") or Element("") for k in range(1, 5)]
    return np.array([[_number(corner.child_text(axis)) for axis in "XYZ"] for corner in corners])


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
