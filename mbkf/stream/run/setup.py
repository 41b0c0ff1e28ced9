"""Everything a live run computes before its first frame: body, filter, log rows, displayed frames, labeller."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.record import FrameRecorder
from mbkf.imu.heading import turned
from mbkf.imu.rest_watch import FeetAtRest
from mbkf.io.subject import Subject, match_names
from mbkf.model.body import Body
from mbkf.numerics.threads import single_threaded
from mbkf.sensors.block import Frame
from mbkf.sensors.standing_feet import FOOT_REST
from mbkf.sensors.worn_orientations import ORIENTATIONS
from mbkf.stream.receiving.alignment import Note, ReadyFrame
from mbkf.stream.run.frame_maker import FrameMaker
from mbkf.stream.source import StreamDescription
from mbkf.trial.live.filter import LiveFilter, LiveInputs, live_inputs
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.in_view import LEAST_MARKERS, plain_name
from mbkf.trial.preparation.other_contacts import contact_opener
from mbkf.trial.preparation.settings import ReconstructSettings

if TYPE_CHECKING:
    from mbkf.stream.run.point_names import PointNames
    from mbkf.trial.live.worn import LiveWorn

MOST_NAMED = 4
"""Names that a sentence lists at most."""


class SensorFrames:
    """Readings of a stream's inertial sensors as the filter takes them, and feet at rest."""

    def __init__(self, worn: LiveWorn, rate_hz: float) -> None:
        """Args: the calibrated sensors, and the frame rate."""
        stillness, roles = worn.settings.filter.stillness, worn.filter.model.roles
        self._columns, self._oriented = list(worn.columns), worn.heading_rad is not None
        self._heading = np.full(len(self._columns), -(worn.heading_rad or 0.0))
        self._feet = FeetAtRest(roles.feet, worn.segments, rate_hz, stillness)

    def frame(self, ready: ReadyFrame, markers_m: Array) -> Frame:
        """The filter's frame; to be called once for each, in order, with markers (0, 3)."""
        imus = None if ready.imus is None else ready.imus[self._columns]
        readings = {FOOT_REST: self._feet.push(imus)}
        if self._oriented and ready.orientations is not None:
            readings[ORIENTATIONS] = turned(ready.orientations[self._columns], self._heading)
        return Frame(markers_m, ready.plates, imus, readings)


@dataclass(frozen=True)
class LiveSetup:
    """A filter prepared for a stream.

    Attributes:
        stream: The stream's description.
        live: Markers tracked, and the filter's inputs.
        filter: The filter, not started yet.
        maker: Makes the frames that listeners receive.
        rows: Makes the rows of the log.
        labels: Names the points of a stream without marker names; None where markers have names.
        sensors: Inertial sensors, in a run without markers.
        extra_settings: Settings that the log keeps beside the usual ones.
    """

    stream: StreamDescription
    live: LiveInputs
    filter: LiveFilter
    maker: FrameMaker
    rows: FrameRecorder
    labels: PointNames | None
    sensors: SensorFrames | None = None
    extra_settings: Mapping[str, object] = field(default_factory=dict)

    def frame(self, ready: ReadyFrame, markers_m: Array) -> Frame:
        """The filter's readings of a frame with markers (M, 3)."""
        if self.sensors is None:
            return Frame(markers_m, ready.plates)
        return self.sensors.frame(ready, markers_m)

    @property
    def names(self) -> tuple[str, ...]:
        """(M,) markers tracked."""
        return self.live.names

    @property
    def model(self) -> Body:
        """The scaled body."""
        return self.live.inputs.sensor.model

    @property
    def columns(self) -> Array | None:
        """(M,) columns of the markers in the stream; None where its points have no names."""
        return self.live.columns if self.stream.marker_names or self.sensors is not None else None

    @property
    def plate_corners_m(self) -> Array:
        """(K, 4, 3) corners of the plates, NaN where they are not known."""
        unknown = np.full((4, 3), np.nan)
        plates = self.stream.plates
        corners = [unknown if plate.corners_m is None else plate.corners_m for plate in plates]
        return np.array(corners).reshape(-1, 4, 3)


def prepare(
    stream: StreamDescription, subject: Subject, settings: ReconstructSettings, patient: bool, note: Note
) -> LiveSetup:
    """Prepares the filter for a stream.

    Args:
        stream: The stream's description.
        subject: The scaled person.
        settings: The filter and its settings.
        patient: The source waits for a slow reader; labels are then searched on complete frames.
        note: Called with events of the labeller.

    Raises:
        NotObservable: Too few of the subject's markers are among the stream's.
    """
    wanted = stream.marker_names or _sought(subject)
    _note_named_twice(stream.marker_names, subject, note)
    with single_threaded():
        live = live_inputs(wanted, stream.rate_hz, stream.plates, subject, settings)
        chosen = tracking_filter(settings.filter, live.inputs)
    return LiveSetup(
        stream,
        live,
        LiveFilter(chosen, settings.lag_s, contact_opener(live.inputs, settings)),
        FrameMaker(live, stream.rate_hz),
        FrameRecorder(chosen, len(live.names), live.inputs.body, settings.spreads),
        None if stream.marker_names else _labels(subject, live.names, 1.0 / stream.rate_hz, patient, note),
    )


def _sought(subject: Subject) -> tuple[str, ...]:
    """Names of the markers that are looked for among points without names."""
    # labelling loads slowly, and streams with names do not need it
    from mbkf.trial.live.labels import live_body

    return live_body(subject).names


def _labels(subject: Subject, names: tuple[str, ...], dt_s: float, patient: bool, note: Note) -> PointNames:
    from mbkf.stream.run.point_names import PointNames

    return PointNames(subject, names, dt_s, patient, note)


def _note_named_twice(names: tuple[str, ...], subject: Subject, note: Note) -> None:
    """Reports markers of the person that the stream names more than once, as it does for a second person."""
    counts = Counter(map(plain_name, names))
    twice = [name for name in match_names(names, subject.markers) if counts[plain_name(name)] > 1]
    if len(twice) >= LEAST_MARKERS:
        note(
            "person",
            f"the stream names {len(twice)} markers more than once ({', '.join(twice[:MOST_NAMED])} …): the first of "
            "each is followed; where two persons are in view, send a stream of one",
            None,
            1,
        )


def prepare_sensors(worn: LiveWorn, settings: ReconstructSettings, stream: StreamDescription) -> LiveSetup:
    """A filter on calibrated inertial sensors, prepared for their stream.

    Args:
        worn: The sensors.
        settings: The lag, and the standard deviations asked for.
        stream: The stream's description.
    """
    live = LiveInputs((), np.zeros(0, dtype=int), worn.inputs)
    return LiveSetup(
        stream,
        live,
        LiveFilter(worn.filter, settings.lag_s),
        FrameMaker(live, stream.rate_hz),
        FrameRecorder(worn.filter, 0, worn.body, settings.spreads),
        None,
        SensorFrames(worn, stream.rate_hz),
        {"inertial": asdict(worn.settings)},
    )
