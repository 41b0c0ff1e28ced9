r"""Scores of a gait against norms: Gait Profile Score, Movement Analysis Profile, gait deviation index.

With x the curve of a variable over a cycle and m the norm's mean, at P points (Baker 2009),

    GVS = sqrt(sum (x - m)^2 / P),    GPS = sqrt(sum GVS^2 / V).

The profile is the GVS of nine variables on each side; a side's GPS has all nine, the overall one the left nine and the
right six without the pelvis. With g the nine curves at 51 points, F the features, c their controls' mean, and mean and
standard deviation of the controls' ln d (Schwartz 2008),

    d = |F g - c|,    GDI = 100 - 10 (ln d - mean) / sd.

Scores are those of each cycle, then averaged. The uncertainty of the body shifts a curve by z s at each point, with z
standard normal. The shifts of different variables are added as if they had one cause, which bounds them: with
c = sum |mean (x - m) s| and q = sum mean s^2 over the variables, a score g becomes at most

    sqrt(g^2 + 2 z c + z^2 q),

taken at the interval's end: near g = 0, and where s is square to x - m, a gradient would be too small. The index is
taken to change by its gradient.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.io.norms import GdiBasis, Norms
from mbkf.study.session.cycles import ANGLE, Key, SideCycles
from mbkf.study.session.means import Mean, mean_of
from mbkf.study.session.records import MovementGroup
from mbkf.trial.gait.curves import ROOT

VARIABLES = (
    "pelvis_tilt", "pelvis_list", "pelvis_rotation", "hip_flexion", "hip_adduction", "hip_rotation", "knee_angle",
    "ankle_angle", "foot_progression",
)  # fmt: skip
"""Coordinates of the nine variables, in the order of Schwartz and Rozumalski."""

INTERVAL_SD = 1.959964
"""Standard deviations to the end of a normal distribution's 95 % interval."""

GPS = "GPS"
"""Name of the score among measures of norms; those of single variables are named after their coordinates."""


@dataclass(frozen=True)
class SideScores:
    """Scores of one side.

    Attributes:
        gvs: By variable.
        gps: Of all of them.
        gdi: None where the norms do not carry what it needs.
    """

    gvs: Mapping[str, Mean]
    gps: Mean
    gdi: Mean | None


@dataclass(frozen=True)
class GaitScores:
    """Scores of a gait.

    Attributes:
        sides: Of right and left; None for a side without cycles in which every variable is known.
        gps: Overall; None where a side lacks.
        lacking: Variables that the gait or the norms lack; the scores are of the others.
    """

    sides: tuple[SideScores | None, SideScores | None]
    gps: Mean | None
    lacking: tuple[str, ...]


def gait_scores(gait: MovementGroup, norms: Norms) -> GaitScores | None:
    """Scores of a gait against norms; None where they have no variable in common.

    Args:
        gait: The cycles.
        norms: Their means are the reference.
    """
    known = {
        name: band.mean
        for name in VARIABLES
        if (band := norms.curves.get((gait.kind.value, ANGLE, name))) is not None and band.unit == "deg"
    }
    names = tuple(name for name in known if all(Key(ANGLE, name) in s.curves for s in gait.sides if s.cycles))
    if not names or not any(side.cycles for side in gait.sides):
        return None
    right, left = (_deviations(side, names, known) for side in gait.sides)
    basis = norms.gdi if norms.gdi is not None and norms.gdi.variables == names else None
    sides = tuple(None if one is None else _side_scores(one, basis) for one in (right, left))
    if all(one is None for one in sides):
        return None
    lacking = tuple(name for name in VARIABLES if name not in names)
    return GaitScores((sides[0], sides[1]), _overall(right, left), lacking)


@dataclass(frozen=True)
class _Deviations:
    """Cycles of a side less the norm, of the cycles in which every variable is known.

    Attributes:
        names: V variables.
        trials: (C,) trial of each cycle.
        values, reference: (C, V, 101) curves, and (V, 101) means of the norms.
        shift, own: (C, V, 101) standard deviations: of the shift of all cycles, and of the cycle alone.
    """

    names: tuple[str, ...]
    trials: tuple[str, ...]
    values: Array
    reference: Array
    shift: Array
    own: Array

    def of(self, names: tuple[str, ...]) -> _Deviations:
        """Those of some variables."""
        at = [self.names.index(name) for name in names]
        rest = (self.values[:, at], self.reference[at], self.shift[:, at], self.own[:, at])
        return _Deviations(names, self.trials, *rest)

    def mean(self, scores: Array, gradient: Array) -> Mean:
        """The mean of a score: (C,) values, and their (C, V, 101) gradient over the curves."""
        shift, own = (
            np.abs((gradient * each).sum(axis=2)).sum(axis=1)[:, None] for each in (self.shift, self.own)
        )
        return mean_of(scores[:, None], self.trials, shift, own)


def _deviations(side: SideCycles, names: tuple[str, ...], known: Mapping[str, Array]) -> _Deviations | None:
    if not side.cycles:
        return None
    curves = [side.curves[Key(ANGLE, name)] for name in names]
    values = np.stack([one.values for one in curves], axis=1)
    counts = np.flatnonzero(np.isfinite(values).all(axis=(1, 2)))
    if not len(counts):
        return None
    sd, shift = (
        np.nan_to_num(np.stack(each, axis=1)[counts])
        for each in ([one.sd for one in curves], [one.shift_sd for one in curves])
    )
    own = np.sqrt(np.maximum(sd**2 - shift**2, 0.0))
    trials = tuple(side.cycles[k].trial for k in counts)
    return _Deviations(names, trials, values[counts], np.array([known[n] for n in names]), shift, own)


def _side_scores(found: _Deviations, basis: GdiBasis | None) -> SideScores:
    gvs = {name: profile_score(found.of((name,))) for name in found.names}
    return SideScores(gvs, profile_score(found), None if basis is None else _gdi(found, basis))


def profile_score(found: _Deviations) -> Mean:
    """The GPS of the variables at hand; of a single one its GVS."""
    apart = found.values - found.reference
    scores = np.sqrt((apart**2).mean(axis=(1, 2)))
    count = apart.shape[1] * apart.shape[2]

    def to_the_end(sd: Array) -> Array:
        """(C, 1) standard deviation of the score that leads to the interval's end."""
        c = np.abs((apart * sd).sum(axis=2)).sum(axis=1) / count
        q = (sd**2).sum(axis=(1, 2)) / count
        end = np.sqrt(scores**2 + 2.0 * INTERVAL_SD * c + INTERVAL_SD**2 * q)
        return np.asarray((end - scores) / INTERVAL_SD)[:, None]

    return mean_of(scores[:, None], found.trials, to_the_end(found.shift), to_the_end(found.own))


def _gdi(found: _Deviations, basis: GdiBasis) -> Mean:
    apart = found.values[:, :, ::2].reshape(len(found.values), -1) @ basis.features.T - basis.centre
    distance = np.maximum(np.linalg.norm(apart, axis=1), 1e-9)
    gradient = np.zeros_like(found.values)
    per_point = -10.0 / basis.ln_sd * (apart @ basis.features) / distance[:, None] ** 2
    gradient[:, :, ::2] = per_point.reshape(len(apart), len(found.names), -1)
    return found.mean(100.0 - 10.0 * (np.log(distance) - basis.ln_mean) / basis.ln_sd, gradient)


def _overall(right: _Deviations | None, left: _Deviations | None) -> Mean | None:
    """The score of the left side's variables and the right one's without the pelvis."""
    if right is None or left is None:
        return None
    own = tuple(name for name in right.names if not name.startswith(ROOT))
    if not own:
        return profile_score(left)
    parts = ((profile_score(left), len(left.names)), (profile_score(right.of(own)), len(own)))
    count = sum(n for _, n in parts)
    value = np.sqrt(sum(n * one.mean**2 for one, n in parts) / count)
    slopes = [n * one.mean / np.maximum(count * value, 1e-9) for one, n in parts]
    variances = [slope**2 * one.variance for slope, (one, _) in zip(slopes, parts, strict=True)]
    variance = np.sum(variances, axis=0)
    uncertain = np.sum([v**2 / one.freedom for v, (one, _) in zip(variances, parts, strict=True)], axis=0)
    shifts = [slope * np.sqrt(one.shift_variance) for slope, (one, _) in zip(slopes, parts, strict=True)]
    freedom = variance**2 / np.maximum(uncertain, 1e-300)
    unknown = np.full_like(value, np.nan)
    cycles = sum(one.count for one, _ in parts)
    return Mean(value, unknown, variance, freedom, np.sum(shifts, axis=0) ** 2, np.zeros_like(value), cycles)


def gdi_basis(vectors: Array, variables: tuple[str, ...], features: int) -> GdiBasis:
    """The basis of controls: leading singular vectors of their curves, and the spread of their distances.

    Args:
        vectors: (N, 51 V) curves of the controls, one side of a person each.
        variables: V coordinates, in their order.
        features: How many singular vectors; 15 in the paper.
    """
    _, _, right = np.linalg.svd(vectors, full_matrices=False)
    basis = right[:features]
    along = vectors @ basis.T
    centre = along.mean(axis=0)
    logs = np.log(np.linalg.norm(along - centre, axis=1))
    return GdiBasis(variables, basis, centre, float(logs.mean()), float(logs.std(ddof=1)))
