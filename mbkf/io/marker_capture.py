"""Coordinates of a text file as a capture: length unit, axes and the size of the body are settled here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.axes import (
    axes_text,
    check_body_size,
    finite,
    length_unit,
    positions_to_world,
    rotation_to_world,
)
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.records import AxesSource, Capture, MarkerTrajectories


@dataclass(frozen=True)
class StatedUnit:
    """The length unit that a file states.

    Attributes:
        entry: Name of the entry, for messages.
        text: Its contents, "" where the file states no unit.
        default: The format's unit where the file states none.
        line: Line of the entry, from 1; None where lines do not count.
    """

    entry: str
    text: str
    default: str
    line: int | None = None

    def of(self, path: Path, options: CaptureOptions, notes: list[str]) -> str:
        """The unit to read with: the one of the options, else the stated one, else the default.

        Args:
            path: The file, for messages.
            options: The options.
            notes: Receives the remark that the default was taken.

        Raises:
            FileFormatError: The stated unit is not one of length.
            UnknownName: The unit of the options is not one of length.
        """
        if options.unit is not None:
            return length_unit(options.unit)
        if not self.text:
            notes.append(
                f"{self.entry} states no length unit; lengths taken as {self.default}, the format's default"
            )
            return self.default
        try:
            return length_unit(self.text)
        except UnknownName as error:
            reason = f"{self.entry} is '{self.text}', not a unit of length; give it with --unit (mm, cm or m)"
            raise FileFormatError(path, reason, self.line) from error


def marker_capture(
    path: Path,
    names: Sequence[str],
    values: Array,
    rate_hz: float,
    start_time_s: float,
    up: str,
    unit: str,
    options: CaptureOptions,
    notes: list[str],
    source: AxesSource = AxesSource.DEFAULT,
) -> Capture:
    """A capture of markers in world axes.

    Args:
        path: The file.
        names: (M,) names of the markers.
        values: (T, M, 3) coordinates in the file's axes and unit; NaN and exact (0, 0, 0) where a marker is missing.
        rate_hz: Frame rate.
        start_time_s: Time of the first frame.
        up: Axis of the file that points up.
        unit: Length unit of the values.
        options: Options of the reader; a unit that they state is not doubted.
        notes: Remarks on the file.
        source: Origin of ``up`` where the options do not state it.

    Raises:
        InvalidInput: The markers of one instant spread as no body does, so the unit is wrong.
    """
    positions = positions_to_world(values, finite(values), up, unit)
    doubts = check_body_size(positions, unit, str(path)) if options.unit is None else ()
    return Capture(
        str(path),
        MarkerTrajectories(tuple(names), positions, rate_hz, start_time_s),
        up_axis=up,
        length_unit=unit,
        notes=(*notes, *doubts),
        axes=axes_text(rotation_to_world(up)),
        axes_source=source if options.up is None else AxesSource.UP_GIVEN,
    )
