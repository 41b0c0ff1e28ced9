"""Fit of the markers of each part: their distances from the body and their innovations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.subject import SubjectMarker
from mbkf.model.description import BodyDescription
from mbkf.trial.verdict.parts import markers_of_part

LEAST_SAMPLES = 20
"""Markers of a part are judged from so many samples on."""


@dataclass(frozen=True)
class PartFit:
    """Fit of the markers of one part.

    Attributes:
        part: The part.
        markers: Number of its markers that were seen.
        rms_mm: Root mean square of their distances from the body.
        per_noise: The same over the noise of one coordinate times √3: about 0.5 where body and markers are right, since
            the noise of the subject file holds movements of skin that the filter follows.
        nis: Normalised innovation squared per coordinate; 1 where markers err as they did just before. None: unknown.
        refused: Share of its samples that the innovation gate refused.
        worst: The marker that fits worst for its noise.
    """

    part: str
    markers: int
    rms_mm: float
    per_noise: float
    nis: float | None
    refused: float
    worst: str


class MarkerFrames(NamedTuple):
    """Markers in a block of frames.

    Attributes:
        present: (n, M) samples that are seen.
        squared_m2: (n, M) squared distances from the body; what is not seen does not count.
        tracked: (n,) frames in which the body is followed.
        refused: (n, M) samples that the innovation gate refused.
        nis: (n, M) normalised innovation squared of each marker, NaN where not known; None without any.
        settled: (n,) frames in which innovations count.
    """

    present: BoolArray
    squared_m2: Array
    tracked: BoolArray
    refused: BoolArray
    nis: Array | None
    settled: BoolArray


class FitSums:
    """Sums over frames from which the fit of each part follows; frames come in blocks, in order."""

    def __init__(self, body: BodyDescription, names: Sequence[str], markers: Sequence[SubjectMarker]) -> None:
        """Sums without a frame.

        Args:
            body: The body.
            names: (M,) the markers that are followed.
            markers: The subject's markers.
        """
        own = {marker.name: marker for marker in markers}
        self._names = tuple(names)
        self._columns = markers_of_part(body, [own[name].segment for name in names])
        self._noise_m = np.array([own[name].noise_m for name in names])
        count = len(names)
        self._squared, self._nis = np.zeros(count), np.zeros(count)
        self._counted, self._judged, self._present, self._refused = np.zeros((4, count), dtype=np.int64)

    def add(self, frames: MarkerFrames) -> None:
        """Adds a block of frames."""
        counted = frames.present & frames.tracked[:, None] & np.isfinite(frames.squared_m2)
        self._squared += np.where(counted, frames.squared_m2, 0.0).sum(axis=0)
        self._counted += counted.sum(axis=0)
        self._present += frames.present.sum(axis=0)
        self._refused += frames.refused.sum(axis=0)
        if frames.nis is not None:
            judged = np.isfinite(frames.nis) & frames.settled[:, None]
            self._nis += np.where(judged, frames.nis, 0.0).sum(axis=0)
            self._judged += judged.sum(axis=0)

    @property
    def seen(self) -> BoolArray:
        """(M,) markers that were seen in any frame."""
        return np.asarray(self._present > 0)

    def fits(self) -> tuple[PartFit, ...]:
        """The fit of each part that shows markers."""
        found = []
        for part, all_of_it in self._columns.items():
            here = [m for m in all_of_it if self._counted[m]]
            if not here or self._counted[here].sum() < LEAST_SAMPLES:
                continue
            mean = self._squared[here] / self._counted[here]
            per_noise = mean / (3.0 * self._noise_m[here] ** 2)
            judged = int(self._judged[here].sum())
            found.append(
                PartFit(
                    part,
                    len(here),
                    1e3 * float(np.sqrt(mean.mean())),
                    float(np.sqrt(per_noise.mean())),
                    float(self._nis[here].sum() / judged) if judged >= LEAST_SAMPLES else None,
                    float(self._refused[here].sum() / max(self._present[here].sum(), 1)),
                    self._names[here[int(np.argmax(per_noise))]],
                )
            )
        return tuple(found)
