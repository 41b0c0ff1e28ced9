"""The two parts of a curve's standard deviation in the report: variation within the trial, and shift of the curve."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction, varying_sd
from mbkf.trial.gait.cycles import Cycle, over_cycle

SHIFTS = (
    "A standard deviation has two parts. The whole curve may be shifted, because the person's body is not known "
    "exactly: the shift is the same in every cycle, for the same posture. And the curve varies within the trial, "
    "because markers and skin do. Compare cycles of one session by the variation; compare sessions, persons or norms "
    "by both parts together."
)
NO_SHIFTS = (
    "Bands show the variation within the trial only. The shift of whole curves is not known, because the subject file "
    "does not state the uncertainty of the body. Scale the person again to add it."
)


class Curve(NamedTuple):
    """A curve with its spread.

    Attributes:
        values: (T,) values.
        sd: (T,) standard deviations.
        offset: (T,) the part of them that shifts the whole curve; None where it is not known.
    """

    values: Array
    sd: Array
    offset: Array | None = None

    @property
    def inner_sd(self) -> Array | None:
        """(T,) the part that varies within the trial; None where the offset is not known."""
        return None if self.offset is None else varying_sd(self.sd, self.offset)


def offsets_known(r: Reconstruction) -> bool:
    """True if the results state the shift of whole curves: the subject file has a covariance."""
    return r.angles_sd_offset is not None and bool(np.nan_to_num(r.angles_sd_offset).any())


def spread_note(r: Reconstruction) -> str:
    """The meaning of the bands, in words."""
    return SHIFTS if offsets_known(r) else NO_SHIFTS


def band_key(both: bool) -> list[tuple[str, str]]:
    """Entries of a legend for the bands, of one part or of both."""
    if not both:
        return [("swatch band", "± 2 standard deviations")]
    return [
        ("swatch inner", "variation within the trial"),
        ("swatch outer", "with the possible shift of the whole curve (each ± 2 standard deviations)"),
    ]


def cycle_sd(times_s: Array, sd: Array | None, cycles: Sequence[Cycle]) -> Array | None:
    """(POINTS,) standard deviations of one cycle, root mean square over all.

    Args:
        times_s: (T,) times of the frames, s.
        sd: (T,) standard deviations; None where they are not known.
        cycles: The cycles.
    """
    if sd is None:
        return None
    variances = np.array([over_cycle(times_s, sd, cycle) ** 2 for cycle in cycles])
    return np.asarray(np.sqrt(variances.mean(axis=0)))
