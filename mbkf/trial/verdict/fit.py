"""Fit of the markers of each part: their distances from the body and their innovations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.io.results import Reconstruction
from mbkf.model.human import reference_body
from mbkf.trial.results.innovations import settled
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


def part_fits(r: Reconstruction) -> tuple[PartFit, ...]:
    """The fit of each part that shows markers.

    Args:
        r: The result.
    """
    own = {marker.name: marker for marker in r.subject.markers}
    names = r.marker_names
    columns = markers_of_part(reference_body(r.subject), [own[name].segment for name in names])
    noise_m = np.array([own[name].noise_m for name in names])
    counted = r.present & r.tracked[:, None]
    squared = np.where(counted, ((r.measured_m - r.predicted_m) ** 2).sum(axis=2), np.nan)
    late = settled(r)
    found = []
    for part, all_of_it in columns.items():
        here = [m for m in all_of_it if counted[:, m].any()]
        if not here or counted[:, here].sum() < LEAST_SAMPLES:
            continue
        mean = np.array([np.nanmean(squared[:, m]) for m in here])
        per_noise = mean / (3.0 * noise_m[here] ** 2)
        nis = None if r.marker_nis is None else r.marker_nis[late][:, here]
        known = None if nis is None else nis[np.isfinite(nis)]
        found.append(
            PartFit(
                part,
                len(here),
                1e3 * float(np.sqrt(mean.mean())),
                float(np.sqrt(per_noise.mean())),
                float(known.mean()) if known is not None and len(known) >= LEAST_SAMPLES else None,
                float(r.rejected[:, here].sum() / max(r.present[:, here].sum(), 1)),
                names[here[int(np.argmax(per_noise))]],
            )
        )
    return tuple(found)
