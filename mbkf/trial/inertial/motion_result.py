"""The result of a motion that inertial sensors alone show: that of any trial, without markers and plates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.filters.record import Track
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.trial.inertial.motion_inputs import motion_inputs
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.results.assembly import assemble
from mbkf.trial.verdict.judge import judged_result


@dataclass(frozen=True)
class Timeline:
    """The frames of a motion.

    Attributes:
        trial: Name of the motion.
        rate_hz: Frame rate.
        start_s: Time of the first frame.
    """

    trial: str
    rate_hz: float
    start_s: float


def motion_result(
    subject: Subject,
    segments: Sequence[str],
    timeline: Timeline,
    tracked: Track,
    *,
    notes: Sequence[str] = (),
    more: Mapping[str, object] | None = None,
    smooth: bool = False,
) -> Reconstruction:
    """Motion, torques and reactions of a tracked trial.

    Args:
        subject: The person.
        segments: (S,) segments that carry sensors.
        timeline: The frames.
        tracked: The track, (T,) frames.
        notes: Remarks for the reader.
        more: Settings to be kept beside the usual ones.
        smooth: Whether later frames corrected earlier ones.
    """
    frames, dt_s = len(tracked.q), 1.0 / timeline.rate_hz
    none = MarkerTrajectories((), np.zeros((frames, 0, 3)), timeline.rate_hz, timeline.start_s)
    settings = ReconstructSettings(smooth=smooth, checks=False)
    inputs = motion_inputs(HumanModel.of(subject), dt_s, segments)
    capture = Capture(timeline.trial, none, notes=tuple(notes))
    hidden = np.zeros((frames, 0), dtype=bool)
    found = assemble(capture, subject, settings, none, hidden, inputs, tracked)
    return judged_result(
        replace(found, protocol="inertial sensors", settings={**found.settings, **(more or {})})
    )
