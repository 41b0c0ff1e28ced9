"""A long capture read in pieces, so that memory does not grow with its length.

What a reader decides by looking at a whole file (axis that points up, unit, signs and offsets of plates) is decided by
stretches spread over it, and holds for every piece.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.io.axes import axes_matrix, vertical_of
from mbkf.io.c3d import capture_of
from mbkf.io.c3d_decode import decode, frames_stated
from mbkf.io.c3d_layout import C3dLayout, check_layout
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.persons import one_person
from mbkf.io.plausible import plausible
from mbkf.io.readable_plates import left_out_notes
from mbkf.io.records import AxesSource, Capture, MarkerTrajectories, PlateReadings
from mbkf.io.turning import turned

LOOK_STRETCHES = 12
"""Number of stretches that a look at a capture consists of."""

_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class CapturePieces:
    """A C3D file of one person, whose frames are read when they are asked for.

    Attributes:
        path: The file.
        frames: Number of frames T.
        look: Stretches spread over the capture, one after the other, as a capture of their own.
        look_frames: (n,) numbers of the look's frames in the capture.
        turn: (3, 3) turn from the file's axes, as they were read, into those that are used.
    """

    path: Path
    frames: int
    look: Capture
    look_frames: NDArray[np.intp]
    turn: Array
    _layout: C3dLayout
    _options: CaptureOptions

    @classmethod
    def of(
        cls, path: Path, look_frames: int, unneeded_plates: tuple[str, ...] = (), **options: str | None
    ) -> CapturePieces | None:
        """The pieces of a capture; None for one that is read whole: damaged, or of several persons.

        Args:
            path: A C3D file.
            look_frames: Number of frames of the look.
            unneeded_plates: Names of plates that will be withheld.
            options: ``up``, ``unit`` and ``axes`` as of :func:`mbkf.io.capture.read_capture`.

        Raises:
            FileFormatError: The file is missing, no C3D file, or broken.
            InvalidInput: Unit or rate cannot be right, or axes name no axes.
        """
        layout, axes = check_layout(path), options.get("axes")
        frames = frames_stated(path, layout)
        if frames is None:
            return None
        matrix = None if axes is None else axes_matrix(axes)
        up = vertical_of(options.get("up"), axes)
        given = CaptureOptions(up=up, unit=options.get("unit"), unneeded_plates=unneeded_plates, ways={})
        stretches = spread_stretches(frames, look_frames)
        look = capture_of(path, decode(path, layout, stretches), given)
        notes = (*look.notes, *left_out_notes(given.left_out))
        far = plausible(replace(look, plates=(), notes=())).notes  # counted in all pieces later
        look = plausible(replace(look, plates_left_out=dict(given.left_out), notes=notes))
        look = replace(look, notes=tuple(note for note in look.notes if note not in far))
        if one_person(look, None) is not look:
            return None
        settled = replace(given, up=look.up_axis, unit=look.length_unit)
        numbers = np.concatenate([np.arange(*stretch) for stretch in stretches])
        pieces = cls(path, frames, look, numbers, np.eye(3), layout, settled)
        return pieces if matrix is None else pieces.turned(matrix @ axes_matrix(look.axes).T)

    def turned(self, turn: Array, source: AxesSource = AxesSource.GIVEN) -> CapturePieces:
        """The pieces in other axes.

        Args:
            turn: (3, 3) signed permutation.
            source: Where the new axes are known from.
        """
        return replace(self, look=turned(self.look, turn, source), turn=turn @ self.turn)

    @property
    def keeps_vertical(self) -> bool:
        """True for axes whose vertical is that of the file, along which offsets of plates were found."""
        return bool(np.array_equal(self.turn[2], _UP))

    def piece(self, first: int, after: int) -> Capture:
        """The capture's frames ``first`` to ``after``, that one excluded, without electromyograms and derived points.

        Plates are those of the look; one that cannot be read here is not recorded here (NaN). Remarks are those on the
        samples of these frames.

        Args:
            first: First frame, counted from 0.
            after: The frame after the last one.

        Raises:
            FileFormatError: The file changed since it was opened.
        """
        options = replace(self._options, left_out={})
        read = capture_of(self.path, decode(self.path, self._layout, [(first, after)]), options, first)
        plates = read.plates
        read = replace(plausible(replace(read, plates=(), notes=())), plates=plates, derived=(), analog=())
        read = turned(read, self.turn, self.look.axes_source)
        by_name = {plate.name: plate for plate in read.plates}
        return replace(
            read,
            plates=tuple(
                by_name.get(plate.name) or _not_recorded(plate, read.markers) for plate in self.look.plates
            ),
            axes=self.look.axes,
            up_axis=self.look.up_axis,
            axes_source=self.look.axes_source,
            plates_left_out=self.look.plates_left_out,
        )


def _not_recorded(plate: PlateReadings, markers: MarkerTrajectories) -> PlateReadings:
    """A plate during the frames of markers, without a reading."""
    unknown = np.full((round(plate.rate_hz / markers.rate_hz) * markers.frames, 3), np.nan)
    return replace(
        plate,
        start_time_s=markers.start_time_s,
        force_n=unknown,
        moment_nm=unknown,
        centre_of_pressure_m=unknown,
    )


def spread_stretches(frames: int, wanted: int, count: int = LOOK_STRETCHES) -> list[tuple[int, int]]:
    """First frame and the one after the last of stretches of equal length, spread evenly over a trial.

    Args:
        frames: Number of frames of the trial.
        wanted: Number of frames of all stretches; a shorter trial is one stretch.
        count: Number of stretches.
    """
    each = wanted // count
    if frames <= wanted or not each:
        return [(0, frames)]
    begins = np.linspace(0, frames - each, count).astype(int)
    return [(int(begin), int(begin) + each) for begin in begins]
