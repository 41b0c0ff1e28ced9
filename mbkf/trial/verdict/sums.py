"""The part of the evidence that every frame adds to, as running sums: a trial adds one block, a live run many."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.model.body import Body
from mbkf.model.human import HumanModel
from mbkf.trial.results.innovations import settled
from mbkf.trial.verdict.fit import FitSums, MarkerFrames, PartFit
from mbkf.trial.verdict.ranges import Beyond, RangeSums


@dataclass(frozen=True)
class Followed:
    """Whom a trial or a live run follows, and by which markers.

    Attributes:
        subject: The person.
        model: The scaled body.
        marker_names: (M,) markers that are followed.
        coordinate_names: (A,) clinical coordinates.
        dof_names: (nv,) dofs.
        unobserved_dofs: Dofs that nothing shows.
        rate_hz: Frame rate.
    """

    subject: Subject
    model: Body
    marker_names: tuple[str, ...]
    coordinate_names: tuple[str, ...]
    dof_names: tuple[str, ...]
    unobserved_dofs: tuple[str, ...]
    rate_hz: float

    @classmethod
    def of(cls, r: Reconstruction) -> Followed:
        """Those of a result."""
        return cls(
            r.subject,
            HumanModel.of(r.subject),
            r.marker_names,
            r.coordinate_names,
            r.dof_names,
            r.unobserved_dofs,
            r.rate_hz,
        )


class Frames(NamedTuple):
    """A block of frames.

    Attributes:
        q: (n, nq) configurations.
        markers: Markers against the body.
        angle_sd: (n, A) standard deviations of clinical coordinates, rad.
        known: (n,) frames in which every load is known, or would be without an unexplained one.
        spoilt: (n,) frames in which an unexplained force acts.
    """

    q: Array
    markers: MarkerFrames
    angle_sd: Array
    known: BoolArray
    spoilt: BoolArray


class TrialSums:
    """Sums over the frames of a trial or live run.

    Attributes:
        followed: The person.
        frames: Number of frames.
        tracked: Of these, frames in which the body was followed.
        known: Frames in which every load is known, or would be without an unexplained one.
        spoilt: Of these, frames in which such a force acts.
    """

    def __init__(self, followed: Followed) -> None:
        """Args: the person who is followed."""
        self.followed = followed
        self.frames = self.tracked = self.known = self.spoilt = 0
        self._fits = FitSums(followed.model.description, followed.marker_names, followed.subject.markers)
        self._ranges = RangeSums(followed.model, followed.rate_hz)
        count = len(followed.coordinate_names)
        self._sd, self._sd_frames = np.zeros(count), np.zeros(count, dtype=np.int64)

    @classmethod
    def of(cls, r: Reconstruction) -> TrialSums:
        """Those of a whole trial.

        Args:
            r: The result.
        """
        sums = cls(Followed.of(r))
        sums.add(frames_of(r, settled(r)))
        return sums

    def add(self, frames: Frames) -> None:
        """Adds the next frames."""
        tracked = frames.markers.tracked
        self.frames += len(tracked)
        self.tracked += int(tracked.sum())
        self.known += int(frames.known.sum())
        self.spoilt += int((frames.known & frames.spoilt).sum())
        self._fits.add(frames.markers)
        self._ranges.add(frames.q[tracked])
        counted = tracked[:, None] & np.isfinite(frames.angle_sd)
        self._sd += np.where(counted, frames.angle_sd, 0.0).sum(axis=0)
        self._sd_frames += counted.sum(axis=0)

    @property
    def seen(self) -> frozenset[str]:
        """Markers that were seen in any frame."""
        return frozenset(
            name for name, seen in zip(self.followed.marker_names, self._fits.seen, strict=True) if seen
        )

    def fits(self) -> tuple[PartFit, ...]:
        """The fit of each part that shows markers."""
        return self._fits.fits()

    def beyond(self) -> tuple[Beyond, ...]:
        """Joints beyond their ranges, the farthest first."""
        return self._ranges.joints()

    def mean_sd(self) -> Mapping[str, float]:
        """Mean standard deviation, rad, by clinical coordinate that has one."""
        names = self.followed.coordinate_names
        return {
            name: float(self._sd[k] / n)
            for k, (name, n) in enumerate(zip(names, self._sd_frames, strict=True))
            if n
        }


def frames_of(r: Reconstruction, settled: BoolArray) -> Frames:
    """The frames of a result, or of a part of one.

    Args:
        r: The result or the part.
        settled: (T,) frames in which innovations count.
    """
    squared = ((r.measured_m - r.predicted_m) ** 2).sum(axis=2)
    markers = MarkerFrames(r.present, squared, r.tracked, r.rejected, r.marker_nis, settled)
    acts = acting(r)
    return Frames(r.q, markers, r.angles_sd, r.valid | acts, acts)


def acting(r: Reconstruction) -> BoolArray:
    """(T,) frames in which an unexplained force acts."""
    acts = np.zeros(r.frames, dtype=bool)
    for one in r.unexplained:
        acts |= (r.times_s >= one.from_s - 1e-9) & (r.times_s <= one.to_s + 1e-9)
    return acts
