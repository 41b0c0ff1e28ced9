"""Quality of a fitted body: impossible ones are refused, doubtful ones reported.

In a standing trial a close fit proves little: a wrong body fits one posture to some millimetres, since markers may sit
elsewhere and segments be longer. A wrong body shows in its proportions, in factors that differ from each other by far
more than people's: S = sd(k) / mean(k) in units of the prior's spread of a proportion. The persons of 15 public
captures have S of 0.3 to 2.3; bodies fitted to eight markers with permuted names mostly more than 4.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.printed import percent

DOUBTFUL_SPREADS, IMPOSSIBLE_SPREADS = 2.5, 4.5
"""Spread of the factors about their mean, in units of the prior's of a proportion: doubtful, and refused."""

DOUBTFUL_NOISE, IMPOSSIBLE_NOISE = 2.0, 4.0
"""RMS distance of markers over the RMS of their noise per coordinate: doubtful, and refused without convergence. Noise
alone gives 1.7, of which fitting takes a part."""

DOUBTFUL_SHARE = 0.1
"""Doubtful share of samples that are left out, since they lie too far from the body."""

MOVED_M, NEARER = 0.04, 0.4
"""Two markers of a segment may have exchanged names where at least one was moved by more than this, and the squared
distances from each other's places are at most this share of those from their own. The wrist's markers of the gait2354
walk, which are exchanged, have 0.31; no pair of fifteen other captures has less than 0.6."""

DOUBTS_KEY = "doubts"
"""Key of a subject's report for doubts about the fit, as sentences; absent without any."""

APPROXIMATED_KEY = "approximated"
"""Key of a subject's report for joints that its body has in a simpler form than the model it comes from, as sentences.
"""


@dataclass(frozen=True)
class FitQuality:
    """Quality of a fitted body.

    Attributes:
        factors: Scale factors by name.
        at_bound: Names of the factors at a bound.
        proportion_sd: Prior standard deviation of a factor about the person's overall size.
        rms_per_noise: RMS distance of the markers over their noise per coordinate.
        share_left_out: Share of the samples that were left out.
        converged: True where the fit converged.
    """

    factors: Mapping[str, float]
    at_bound: tuple[str, ...]
    proportion_sd: float
    rms_per_noise: float
    share_left_out: float
    converged: bool

    @property
    def proportion_spread(self) -> float:
        """Spread of the scale factors about their mean, in units of the prior's spread of a proportion."""
        values = np.array(list(self.factors.values()))
        return float(np.std(values) / np.mean(values) / self.proportion_sd)

    @property
    def refusal(self) -> str:
        """Reason why the fit is not a person's body, "" where it may be."""
        if self.proportion_spread > IMPOSSIBLE_SPREADS:
            low, high = min(self.factors.values()), max(self.factors.values())
            return (
                f"the segments that fit the markers are {low:.2f} to {high:.2f} of the reference body's, proportions "
                "that people do not have; check for exchanged marker names"
            )
        if not self.converged and self.rms_per_noise > IMPOSSIBLE_NOISE:
            return (
                f"the fit did not converge, and the markers lie {self.rms_per_noise:.1f} times as far from the body as "
                "their noise explains; check for exchanged marker names"
            )
        return ""

    @property
    def doubts(self) -> tuple[str, ...]:
        """Sentences about a fit that may be a person's body, but is doubtful."""
        found = []
        if not self.converged:
            found.append("the fit did not converge")
        if self.at_bound or self.proportion_spread > DOUBTFUL_SPREADS:
            value = self.factors.__getitem__
            names = self.at_bound or (min(self.factors, key=value), max(self.factors, key=value))
            shown = ", ".join(f"{name.replace('_', ' ')} {self.factors[name]:.2f}" for name in names)
            found.append(
                f"proportions are unusual ({shown} of the reference body's); check for exchanged marker names"
            )
        if self.rms_per_noise > DOUBTFUL_NOISE:
            found.append(
                f"markers lie {self.rms_per_noise:.1f} times as far from the body as their noise explains"
            )
        if self.share_left_out > DOUBTFUL_SHARE:
            share = percent(self.share_left_out)
            found.append(f"{share} of the samples lie too far from the body and were left out")
        return tuple(found)


def as_each_other(segments: Sequence[str], places_m: Array, found_m: Array) -> list[tuple[int, int]]:
    """Pairs of markers of a segment, each of which is at the other one's place.

    Args:
        segments: Segment of each of the M markers.
        places_m: (M, 3) their places in the protocol on the scaled body, in their segments' frames, m.
        found_m: (M, 3) the places that were found.
    """
    squared = ((found_m[:, None] - places_m) ** 2).sum(axis=2)  # of marker i from the place of j
    own, names = np.diag(squared), np.array(segments)
    stay, trade = own[:, None] + own, squared + squared.T
    far = np.maximum(own[:, None], own) > MOVED_M**2
    pairs = (names[:, None] == names) & far & (trade < NEARER * stay)
    return [(int(i), int(j)) for i, j in np.argwhere(np.triu(pairs, 1))]
