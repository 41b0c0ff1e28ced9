"""Norms in another convention: curves whose sign alone differs are turned, those in other axes are left out.

Moments, powers and reactions are about the body's own axes in every convention, so that they differ by a sign at most.
Angles in the same axes do, too, but for pelvis, trunk and feet where one convention alone reads them in the direction
of walking.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mbkf.io.norms import Band, CurveName, Norms
from mbkf.study.session.cycles import ANGLE, TORQUE
from mbkf.study.session.scores import GPS, VARIABLES
from mbkf.trial.gait.convention import FOOT_PROGRESSION, TRUNK, Convention, convention_of
from mbkf.trial.gait.curves import ROOT


@dataclass(frozen=True)
class ConvertedNorms:
    """Norms in the convention of a session.

    Attributes:
        norms: They; the session's convention and axes.
        turned: Whether the sign of a curve was turned.
        without_angles: Whether angles, and scores of them, are left out, since they are in other axes.
    """

    norms: Norms
    turned: bool = False
    without_angles: bool = False


def converted(norms: Norms, convention: Convention, axes: Sequence[str]) -> ConvertedNorms:
    """Norms as a session's curves are read.

    Args:
        norms: The norms.
        convention: Of the session.
        axes: Axes that its angles are read in.
    """
    if norms.read == (convention.name, *axes):
        return ConvertedNorms(norms)
    own, same_axes = convention_of(norms.convention), tuple(axes) == (norms.axes,)

    def factor(key: CurveName) -> float | None:
        """To the session's curve; None of one that is another angle."""
        _, quantity, name = key
        if quantity == TORQUE:
            return own.moment_sign(name) * convention.moment_sign(name)
        if quantity != ANGLE:
            return 1.0
        along = name.startswith(ROOT) or name in (FOOT_PROGRESSION, *TRUNK)
        if not same_axes or (along and own.walking != convention.walking):
            return None
        return own.angle_sign(name) * convention.angle_sign(name)

    def curves(bands: Mapping[CurveName, Band]) -> dict[CurveName, Band]:
        factors = ((key, factor(key), band) for key, band in bands.items())
        return {key: replace(band, mean=f * band.mean) for key, f, band in factors if f is not None}

    every = [*norms.curves, *(key for bands in norms.by_speed.values() for key in bands)]
    factors = {factor(key) for key in every}
    scores = (GPS, *VARIABLES)
    changed = replace(
        norms,
        curves=curves(norms.curves),
        by_speed={speeds: curves(bands) for speeds, bands in norms.by_speed.items()},
        measures={key: band for key, band in norms.measures.items() if key[1] not in scores},
        gdi=None,
        convention=convention.name,
        axes=axes[0],
    )
    return ConvertedNorms(changed, -1.0 in factors, any(key[1] == ANGLE for key in every) and not same_axes)
