"""Frames in which a person enters the measured volume: the first markers seen may lie far from where they are.

Software that solves clusters extrapolates them at the border of the volume by 0.1 to 0.3 m, and a filter that starts
from these samples refuses right ones later on. Such samples fit the body worse than later ones, although few markers
fit more closely than many where all are right.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.numerics.runs import runs, spread_indices
from mbkf.sensors.pose_fit import PoseFit, fit_pose, segment_by_segment
from mbkf.sensors.posture import PostureSensor
from mbkf.sensors.subject_sensor import subject_sensor

LEAST_SHARE = 0.5
"""Share of the most markers of a stretch with which its beginning ends."""

LONGEST_S = 1.0
"""A person passes the border of the volume in so much time; fewer markers for longer are seen of a part of the body."""

WORSE, FITTED = 1.3, 20
"""Beginnings whose median misfit exceeds that of later frames by this factor are left out, judged by so many frames of
each. Set on two walks and a made one: 28 against 17 mm where clusters are extrapolated (unipd_walk), 2 against 3 mm in
opensim_gappy_walk and 0.8 to 1.1 times that of later frames in the made one, whose first markers are right. In 49
further public captures nobody enters with fewer than half of the markers: the factor is shown on no other person."""


def without_entering(
    markers: MarkerTrajectories, subject: Subject, fewest: int, gap_s: float
) -> tuple[MarkerTrajectories, tuple[str, ...]]:
    """The trajectories without samples of frames in which the person enters the volume, and a note on these.

    Args:
        markers: The subject's markers, under the subject's names.
        subject: The person.
        fewest: Number of markers from which on a frame can be followed.
        gap_s: Time with fewer after which the body is sought anew.
    """
    count = markers.present.sum(axis=1)
    entering, followed, body = np.zeros(markers.frames, dtype=bool), count >= fewest, None
    for first, after in _stretches(followed, round(gap_s * markers.rate_hz)):
        seen = count[first:after]
        begin = first + int(np.argmax(seen >= LEAST_SHARE * seen.max()))
        if first < begin <= first + LONGEST_S * markers.rate_hz:
            body = body or _Body(subject, markers.names)
            early_m, later_m = (
                body.misfit_m(markers.positions_m[part][followed[part]])
                for part in (slice(first, begin), slice(begin, after))
            )
            entering[first:begin] = early_m > WORSE * later_m
    frames = int(entering.sum())
    if not frames:
        return markers, ()
    last_s = float(markers.times_s[np.flatnonzero(entering)[-1]])
    note = (
        f"in {frames} frames (the last at {last_s:.2f} s) the person enters the measured volume: fewer than half of "
        "the markers are seen, and they fit the body worse than later; these frames are left out"
    )
    return replace(markers, positions_m=np.where(entering[:, None, None], np.nan, markers.positions_m)), (
        note,
    )


class _Body:
    """The person's body, to which frames of markers are fitted.

    Args:
        subject: The person.
        names: (M,) names of the markers.
    """

    def __init__(self, subject: Subject, names: Sequence[str]) -> None:
        by_name = {marker.name: marker for marker in subject.markers}
        own = [by_name[name] for name in names]
        self._sensor = subject_sensor(HumanModel.of(subject), own)
        self._posture = PostureSensor(self._sensor.model)
        self._noise_m = np.array([marker.noise_m for marker in own])

    def misfit_m(self, positions_m: Array) -> float:
        """Median over frames (T, M, 3) of the RMS distance of markers from the fitted body, m."""
        frames = positions_m[spread_indices(len(positions_m), FITTED)]
        return float(np.median([self._fit(frame).rms_m for frame in frames]))

    def _fit(self, frame_m: Array) -> PoseFit:
        start = segment_by_segment(self._sensor, frame_m)
        return fit_pose(self._sensor, self._posture, frame_m, self._noise_m, start)


def _stretches(seen: BoolArray, gap: int) -> list[tuple[int, int]]:
    """First frame and the one after the last of each stretch in which a body is seen, with gaps of so many frames."""
    found: list[tuple[int, int]] = []
    for first, after in runs(seen):
        if found and first - found[-1][1] <= gap:
            found[-1] = found[-1][0], after
        else:
            found.append((first, after))
    return found
