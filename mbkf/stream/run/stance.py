"""The frames in which a person stands still before a stream: collected until there are enough to scale from."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.model.protocol import Protocol
from mbkf.stream.source import SourceFrame, StreamDescription, plausible
from mbkf.trial.live.scaling import Stance, StillWatch, watched_names

MOST_LISTED = 4
"""Missing markers that are listed by name."""


class StanceFrames:
    """Collects frames while the person stands still.

    Attributes:
        named: The stream's points have marker names.
        hindrance: Reason why the person could not be scaled so far, as a clause.
    """

    def __init__(self, stream: StreamDescription, protocol: Protocol | None) -> None:
        """Args: the stream, and the protocol worn; it may be None where markers have names."""
        self._stream = stream
        self._names = watched_names(stream.marker_names, protocol)
        self._columns = [stream.marker_names.index(name) for name in self._names]
        self.named = bool(stream.marker_names)
        self._worn = len(self._names)
        if not self.named:
            assert protocol is not None
            self._worn = sum(marker.kind != "computed" for marker in protocol.markers)
        self._watch = StillWatch(stream.rate_hz, self._worn, self.named)
        self._frames: deque[SourceFrame] = deque(maxlen=self._watch.wanted)
        self._stance = Stance(0, 0, 0.0, None, False)
        self.hindrance = "no markers are seen yet"

    def __len__(self) -> int:
        return len(self._frames)

    @property
    def first_number(self) -> int:
        """Number of the first frame, as the source counts."""
        return self._frames[0].number

    @property
    def last_number(self) -> int:
        """Number of the last frame."""
        return self._frames[-1].number

    @property
    def enough(self) -> bool:
        """True once the person can be scaled from the frames."""
        return self._stance.enough

    @property
    def progress(self) -> float:
        """Share of the time of standing still that is over, 0 to 1; 0 while too few markers are seen."""
        seen = self._stance.seen >= self._watch.least
        return min(self._stance.frames / self._watch.wanted, 1.0) if seen else 0.0

    def push(self, frame: SourceFrame) -> None:
        """Takes the next frame; one in which the person moved begins a new stance."""
        points = self._points(frame)
        self._stance = self._watch.push(points)
        if self._stance.frames <= 1:
            self._frames.clear()
        self._frames.append(frame)
        self._find_hindrance(points)

    def restart(self) -> None:
        """Forgets all frames: the person has to stand still once more."""
        self._frames.clear()
        self._watch.restart()

    def capture(self) -> Capture:
        """The frames as a capture, with the plates' readings."""
        points = [
            plausible(frame.markers_m if self._names else frame.unlabelled_m)[0] for frame in self._frames
        ]
        names = self._stream.marker_names
        if not names:
            width = max(len(one) for one in points)
            names = tuple(f"*{k}" for k in range(width))
            points = [np.pad(one, ((0, width - len(one)), (0, 0)), constant_values=np.nan) for one in points]
        markers = MarkerTrajectories(names, np.array(points), self._stream.rate_hz)
        wrench = np.concatenate([frame.plates.wrench for frame in self._frames])
        plates = tuple(_with_readings(plate, wrench[:, k]) for k, plate in enumerate(self._stream.plates))
        return Capture(self._stream.trial, markers, plates)

    def _points(self, frame: SourceFrame) -> Array:
        """(M, 3) the worn markers of a frame, or (N, 3) its points; implausible ones are NaN."""
        return plausible(frame.markers_m[self._columns] if self._names else frame.unlabelled_m)[0]

    def _find_hindrance(self, points_m: Array) -> None:
        """Remembers a movement, or markers that are missing, as the reason to wait."""
        stance, least = self._stance, self._watch.least
        if stance.frames == 1 and stance.moved_m > 0.0:
            mover = "the points" if stance.mover is None else f"marker {self._names[stance.mover]}"
            self.hindrance = f"{mover} moved {1e3 * stance.moved_m:.0f} mm"
        elif stance.seen < least:
            unseen = np.flatnonzero(np.isnan(points_m).any(axis=1))
            missing = [self._names[k] for k in unseen] if self._names else []
            more = " …" if len(missing) > MOST_LISTED else ""
            listed = f" (not {', '.join(missing[:MOST_LISTED])}{more})" if missing else ""
            kind = "markers are" if self._names else "points are"
            self.hindrance = f"{stance.seen} of {self._worn} {kind} seen{listed}, at least {least} are needed"


def _with_readings(plate: PlateReadings, wrench: Array) -> PlateReadings:
    """A plate with readings (S, 6), force N and moment N m about its own origin."""
    unknown = np.full((len(wrench), 3), np.nan)
    return replace(plate, force_n=wrench[:, :3], moment_nm=wrench[:, 3:], centre_of_pressure_m=unknown)
