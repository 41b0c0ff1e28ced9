"""How sure the report's curves are: what varies within the trial, and by how much a whole curve could be shifted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction, varying_sd
from mbkf.trial.gait.cycles import Cycle, over_cycle

SHIFTS = (
    "How sure a number is has two parts. A curve could be shifted as a whole, because the person's body is not known "
    "exactly: the shift repeats whenever the posture is the same, in every cycle. And it varies within the trial, "
    "because markers and skin do. Compare cycles of one session by what varies; compare sessions, persons or norms by "
    "both together."
)
NO_SHIFTS = (
    "Bands tell what varies within the trial. By how much whole curves could be shifted is not told, because the "
    "subject file does not say how well the body is known; scale the person again to have it told."
)


class Curve(NamedTuple):
    """A curve with its spread.

    Attributes:
        values: (T,) values.
        sd: (T,) standard deviations.
        offset: (T,) the part of them that could shift the curve as a whole; None where that is not told.
    """

    values: Array
    sd: Array
    offset: Array | None = None

    @property
    def inner_sd(self) -> Array | None:
        """(T,) the part that varies within the trial, None where the offset is not told."""
        return None if self.offset is None else varying_sd(self.sd, self.offset)


def offsets_told(r: Reconstruction) -> bool:
    """Whether the results tell by how much whole curves could be shifted: the subject file has a covariance."""
    return r.angles_sd_offset is not None and bool(np.nan_to_num(r.angles_sd_offset).any())


def spread_note(r: Reconstruction) -> str:
    """What the bands mean, in words."""
    return SHIFTS if offsets_told(r) else NO_SHIFTS


def band_key(told: bool) -> list[tuple[str, str]]:
    """Entries of a legend for the bands: of both parts where the offset is told."""
    if not told:
        return [("swatch band", "± 2 standard deviations")]
    return [
        ("swatch inner", "varies within the trial by this"),
        ("swatch outer", "with what it could be shifted by as a whole (each ± 2 standard deviations)"),
    ]


def cycle_sd(times_s: Array, sd: Array | None, cycles: Sequence[Cycle]) -> Array | None:
    """(POINTS,) standard deviations of one cycle, root mean square over all.

    Args:
        times_s: (T,) times of the frames, s.
        sd: (T,) standard deviations; None where they are not told.
        cycles: The cycles.
    """
    if sd is None:
        return None
    variances = np.array([over_cycle(times_s, sd, cycle) ** 2 for cycle in cycles])
    return np.asarray(np.sqrt(variances.mean(axis=0)))
