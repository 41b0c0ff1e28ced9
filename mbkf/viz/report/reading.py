"""A result's angles in the convention of a report, and their curves with spreads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction, varying_sd
from mbkf.trial.gait.convention import MODEL, Convention
from mbkf.trial.gait.convention_angles import ConventionAngles, convention_angles
from mbkf.viz.convention_words import statement
from mbkf.viz.language import ENGLISH
from mbkf.viz.report.spreads import Curve, offsets_known


@dataclass(frozen=True)
class Reading:
    """The angles of a result in a convention.

    Attributes:
        convention: The convention.
        angles: The angles.
    """

    convention: Convention
    angles: ConventionAngles

    @classmethod
    def of(cls, r: Reconstruction, convention: Convention) -> Reading:
        """Of a result.

        Args:
            r: The result.
            convention: The convention.
        """
        return cls(convention, convention_angles(r, convention))

    @property
    def caption(self) -> str:
        """The convention in short."""
        return statement(ENGLISH, self.convention, (self.angles.axes,))

    @property
    def moment_caption(self) -> str:
        """The convention of moments in short; they are about the body's own axes."""
        return statement(ENGLISH, self.convention, (MODEL,))


def curve_of(r: Reconstruction, values: Array, spreads: Sequence[Array] | Array) -> Curve:
    """A curve with its spreads.

    Args:
        r: The results.
        values: (T,) values.
        spreads: (T,) standard deviations: total, offset and change of the offset.
    """
    total, offset, change = spreads
    return Curve(values, total, *((offset, varying_sd(total, offset, change)) if offsets_known(r) else ()))
