"""The results of one live frame, and the protocol of listeners that receive them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from mbkf.conventions import Array
from mbkf.io.contacts import Source
from mbkf.stream.results.judgement import Judgement


@dataclass(frozen=True)
class LiveFrame:
    """One frame of a live reconstruction; world axes x forward, y left, z up.

    Attributes:
        number: Frame number, counted from 0 at the first frame taken; lost frames are counted, too.
        time_s: Time of the frame in s, from the first one.
        q: (nq,) configuration.
        v: (nv,) velocity.
        torques: (nv,) generalised forces, N and N m; the first six are the residual at the pelvis.
        torques_sd: (nv,) their standard deviations, NaN where not known.
        wrench: (2, 6) ground on right and left foot: force N, moment N m about the world's origin.
        wrench_sd: (2, 6) their standard deviations, NaN where not known.
        plates: (K, 6) measured force N and moment N m about the world's origin per plate; NaN where not read.
        measured_m: (M, 3) labelled markers, NaN where hidden.
        predicted_m: (M, 3) the same markers on the body.
        unlabelled_m: (N, 3) points without a name.
        angle_sd: (A,) standard deviations of the clinical coordinates, rad; of the pelvis's translations m.
        angle_offset, torques_offset, wrench_offset: The part of ``angle_sd``, ``torques_sd`` and ``wrench_sd`` that
            repeats whenever the posture is the same, because the body is not known exactly.
        latency_s: Time from the frame's arrival to this result, a lag included.
        lost: Frames lost so far.
        rate_hz: Rate of the frames of the last second.
        tracked: Whether enough markers passed the gate to track the body.
        started: Whether the filter started, or restarted, in this frame.
        foot_source: (2,) how the wrench of right and left foot is known (:class:`mbkf.io.contacts.Source`).
        support: (B, 6) estimated wrench on each other part that may bear load (``description.bearings``), NaN or no
            rows where the filter does not ask.
        support_sd: (B, 6) their standard deviations.
        valid: True where torques and reactions may be used as far as is known by now: every load is read or estimated
            well, no unexplained force acts, and the verdict is not against loads.
        judgement: The verdict on the run so far, and limbs in doubt; None in its first second. The record stays the
            same until it changes.
        unexplained: True while an unexplained force is stated: torques and reactions are not to be used.
        plotted: Estimates of the filter and the force that no contact explains, with a curve of their own in viewers
            (:data:`mbkf.io.results.PLOTTED`), by name.
    """

    number: int
    time_s: float
    q: Array
    v: Array
    torques: Array
    torques_sd: Array
    wrench: Array
    wrench_sd: Array
    plates: Array
    measured_m: Array
    predicted_m: Array
    unlabelled_m: Array
    angle_sd: Array
    angle_offset: Array
    torques_offset: Array
    wrench_offset: Array
    latency_s: float
    lost: int
    rate_hz: float
    tracked: bool
    started: bool
    foot_source: Array = field(default_factory=lambda: np.full(2, Source.MEASURED))
    support: Array = field(default_factory=lambda: np.zeros((0, 6)))
    support_sd: Array = field(default_factory=lambda: np.zeros((0, 6)))
    unexplained: bool = False
    valid: bool = False
    judgement: Judgement | None = None
    plotted: Mapping[str, Array] = field(default_factory=dict)


class FrameSink(Protocol):
    """A listener: it shows or sends on the frames of a live reconstruction."""

    def take(self, frame: LiveFrame) -> None:
        """A new frame. Must never block: a frame that cannot be passed on at once is dropped."""

    def close(self) -> None:
        """Ends the frames."""
