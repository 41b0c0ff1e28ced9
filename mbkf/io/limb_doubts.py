"""Doubts about limbs: stretches in which a limb fits its markers badly or lies beyond its ranges, mended or not."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Literal, get_args

import numpy as np

from mbkf.errors import InvalidInput

DoubtKind = Literal["turned over", "names exchanged", "fits badly", "beyond its range"]
"""Another pose fitted; markers had each other's names; or no better pose was found: by the markers, by the ranges."""


@dataclass(frozen=True)
class LimbDoubt:
    """A stretch of time in which the estimate of a limb was in doubt.

    Attributes:
        limb: The limb by the first of its segments (``left_thigh``).
        kind: One of :data:`DoubtKind`.
        from_s, to_s: Times of its first and its last frame.
        joint: The segment whose joint lies furthest beyond its range; empty where every joint is within it.
        beyond_rad: How far, rad.
        misfit_m: RMS distance of the limb's markers from the body, m.
        others_m: RMS distance of all other markers, m.
        mended: The limb was fitted anew.
        exchanged: Pairs of markers whose names were put right to mend it.
        right_from_s: Time from which frames have the better pose: after ``to_s``, or earlier where a smoother carried
            it back; None for a limb that was not mended.
    """

    limb: str
    kind: DoubtKind
    from_s: float
    to_s: float
    joint: str = ""
    beyond_rad: float = 0.0
    misfit_m: float = 0.0
    others_m: float = 0.0
    mended: bool = False
    exchanged: tuple[tuple[str, str], ...] = ()
    right_from_s: float | None = None

    def __post_init__(self) -> None:
        """Refuses an unknown kind.

        Raises:
            InvalidInput: It is unknown.
        """
        if self.kind not in get_args(DoubtKind):
            raise InvalidInput(f"limb in doubt: unknown kind '{self.kind}'")

    def as_text(self) -> str:
        """As JSON."""
        return json.dumps(asdict(self))

    @classmethod
    def of_text(cls, text: str) -> LimbDoubt:
        """The doubt of JSON.

        Raises:
            InvalidInput: The text lacks an entry of a doubt, or is not JSON.
        """
        try:
            plain = json.loads(text)
            return cls(**{**plain, "exchanged": tuple((str(a), str(b)) for a, b in plain["exchanged"])})
        except (ValueError, KeyError, TypeError) as error:
            raise InvalidInput(f"doubt about a limb: cannot be read ({error})") from error

    @property
    def sentence(self) -> str:
        """The doubt in words: times, evidence, meaning and remedy."""
        evidence = [f"its markers lie {1e3 * self.misfit_m:.0f} mm (RMS) from the body"]
        if self.joint:
            evidence.append(
                f"the {self.joint.replace('_', ' ')} is {np.degrees(self.beyond_rad):.0f}° beyond its range"
            )
        when = f"from {self.from_s:.2f} to {self.to_s:.2f} s"
        limb = self.limb.replace("_", " ")
        return f"the {limb} was in doubt {when}: {', '.join(evidence)}; {self._remedy}"

    @property
    def _remedy(self) -> str:
        if self.exchanged:
            pairs = ", ".join(f"{a} and {b}" for a, b in self.exchanged)
            return f"the names of {pairs} were exchanged and are put right from {self._right} on"
        if self.mended:
            return f"the limb was fitted anew from {self._right} on"
        return "no better pose was found: check the names of its markers and the subject file"

    @property
    def _right(self) -> str:
        return "there" if self.right_from_s is None else f"{self.right_from_s:.2f} s"
