"""Everything a live run computes before its first frame: body, filter, log rows, displayed frames, labeller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.record import FrameRecorder
from mbkf.io.subject import Subject
from mbkf.model.body import Body
from mbkf.numerics.threads import single_threaded
from mbkf.pipelines.live.filter import LiveFilter, LiveInputs, live_inputs
from mbkf.pipelines.live.labels import live_body
from mbkf.pipelines.reconstruct import ReconstructSettings
from mbkf.pipelines.trial.filters import tracking_filter
from mbkf.stream.receiving.alignment import Note
from mbkf.stream.run.frame_maker import FrameMaker
from mbkf.stream.run.point_names import PointNames
from mbkf.stream.source import StreamDescription


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
    """

    stream: StreamDescription
    live: LiveInputs
    filter: LiveFilter
    maker: FrameMaker
    rows: FrameRecorder
    labels: PointNames | None

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
        return self.live.columns if self.stream.marker_names else None

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
        patient: Whether the source waits for a slow reader; labels are then searched on complete frames.
        note: Called with events of the labeller.

    Raises:
        NotObservable: Too few of the subject's markers are among the stream's.
    """
    wanted = stream.marker_names or live_body(subject).names
    with single_threaded():
        live = live_inputs(wanted, stream.rate_hz, stream.plates, subject, settings)
        chosen = tracking_filter(settings.filter, live.inputs)
    return LiveSetup(
        stream,
        live,
        LiveFilter(chosen, settings.lag_s),
        FrameMaker(live, stream.rate_hz),
        FrameRecorder(chosen, len(live.names), live.inputs.body, settings.spreads),
        None if stream.marker_names else PointNames(subject, live.names, 1.0 / stream.rate_hz, patient, note),
    )
