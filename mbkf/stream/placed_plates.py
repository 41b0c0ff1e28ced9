"""A stream whose plates have the geometry of a file, where the stream itself states none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.plate_corners import plate_axes
from mbkf.io.records import PlateReadings
from mbkf.stream.source import FrameSource, PlateSamples, SourceFrame, StreamDescription


@dataclass(frozen=True)
class PlateGeometry:
    """Plates of a file, for :class:`PlacedPlates`.

    Attributes:
        file: Its name, for messages.
        plates: Its plates with corners.
    """

    file: str
    plates: tuple[PlateReadings, ...]

    def __post_init__(self) -> None:
        if not self.plates or any(plate.corners_m is None for plate in self.plates):
            raise InvalidInput(
                f"{self.file}: not every force plate of it has corners; name a C3D file of this laboratory"
            )

    def of(self, plates: Sequence[PlateReadings]) -> list[PlateReadings]:
        """The file's plate for each of a stream's: by name, else in the file's order.

        Raises:
            InvalidInput: Names differ, and so do the numbers of plates.
        """
        named = {plate.name: plate for plate in self.plates}
        if all(plate.name in named for plate in plates):
            return [named[plate.name] for plate in plates]
        if len(plates) != len(self.plates):
            raise InvalidInput(
                f"the stream has {len(plates)} plates without corners ({_listed(plates)}), {self.file} has "
                f"{len(self.plates)} ({_listed(self.plates)}); give a file with these plates"
            )
        return list(self.plates)


class PlacedPlates:
    """A :class:`mbkf.stream.source.FrameSource` that takes corners of a file for plates that come without any.

    Moments of such a plate are about the point that the stream states, else about the middle of the surface.
    """

    def __init__(self, source: FrameSource, geometry: PlateGeometry, in_plate_axes: bool = False) -> None:
        """Takes over a source.

        Args:
            source: The source.
            geometry: The plates of a file.
            in_plate_axes: Readings of plates without corners come in the plate's own axes (z down), not the world's.
        """
        self._source, self._geometry, self._local = source, geometry, in_plate_axes
        self._turns: dict[int, Array] = {}
        self._news: list[tuple[str, str]] = []
        self.patient = source.patient

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """The stream's description with plates that have corners.

        Raises:
            MbkfError: As the source's; the file's plates are not those of the stream.
        """
        stream = self._source.connect(timeout_s)
        bare = [] if stream is None else [k for k, one in enumerate(stream.plates) if one.corners_m is None]
        if stream is None or not bare:
            return stream
        plates = list(stream.plates)
        known = self._geometry.of([plates[k] for k in bare])
        for k, one in zip(bare, known, strict=True):
            assert one.corners_m is not None
            stated = bool(plates[k].origin_m.any())
            origin = plates[k].origin_m if stated else one.corners_m.mean(axis=0)
            plates[k] = replace(plates[k], corners_m=one.corners_m, origin_m=origin)
            if self._local:
                self._turns[k] = plate_axes(one.corners_m)
        names = _listed([plates[k] for k in bare])
        self._news.append(("plates", f"the corners of the plates {names} are those of {self._geometry.file}"))
        return replace(stream, plates=tuple(plates))

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The source's next frame, its forces in world axes.

        Raises:
            EOFError: No more frames will ever come.
        """
        frame = self._source.read(timeout_s)
        if frame is None or not self._turns or not len(frame.plates.index):
            return frame
        wrench = np.array(frame.plates.wrench)
        for k, turn in self._turns.items():
            wrench[:, k, :3], wrench[:, k, 3:] = wrench[:, k, :3] @ turn.T, wrench[:, k, 3:] @ turn.T
        return replace(frame, plates=PlateSamples(frame.plates.index, wrench))

    def news(self) -> list[tuple[str, str]]:
        """Events of the connection since the last call."""
        news, self._news = [*self._news, *self._source.news()], []
        return news

    def close(self) -> None:
        """Lets go of the stream."""
        self._source.close()


def _listed(plates: Sequence[PlateReadings]) -> str:
    return ", ".join(f"'{plate.name}'" for plate in plates)
