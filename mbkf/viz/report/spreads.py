"""Bands of the report's curves: the error's variation within the trial, and the whole error."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.trial.gait.cycles import Cycle, over_cycle

SHIFTS = (
    "The person's body is not known exactly. The error from that repeats whenever the posture is the same. Its mean "
    "over the trial shifts the whole curve. Its change with the posture and the errors of markers and skin vary within "
    "the trial: the dark band holds them. Compare frames and cycles of this trial by the dark band. Compare sessions, "
    "persons, norms and movements in other postures by the light band."
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
        offset: (T,) the part of them that repeats in the same posture; None where it is not known.
        inner_sd: (T,) standard deviations of the errors less their mean over the trial; None as the offset.
    """

    values: Array
    sd: Array
    offset: Array | None = None
    inner_sd: Array | None = None


def offsets_known(r: Reconstruction) -> bool:
    """True if the results state errors by the body: the subject file has a covariance."""
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
        ("swatch outer", "whole error, with the shift of the curve (each ± 2 standard deviations)"),
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
