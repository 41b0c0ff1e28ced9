"""Loads that nothing in a capture explains: from when to when, how much, whereto, and a likelier cause if one fits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.numerics.printed import percent

Cause = Literal["", "mass", "clock", "right_foot", "left_foot"]
"""Likelier than a load: the body's mass, the clocks of markers and plates, a foot that stands beside its plate."""

STEEP, FLAT = 0.87, 0.5
"""Share of a force that is vertical: from the first on it is called upward or downward, below the second horizontal."""


@dataclass(frozen=True)
class UnexplainedLoad:
    """A stretch of time in which the body moves as if a force acted on it that no contact gives.

    Attributes:
        from_s, to_s: Times of its first and its last frame.
        vector_n: Mean force on the body, world axes, N.
        sd_n: Standard deviation of its size, N.
        share: Its size over body weight.
        cause: One of :data:`Cause`; empty for a load.
        hint: Meaning and remedy.
    """

    from_s: float
    to_s: float
    vector_n: tuple[float, float, float]
    sd_n: float
    share: float
    cause: Cause = ""
    hint: str = ""

    def __post_init__(self) -> None:
        """Refuses an unknown cause.

        Raises:
            InvalidInput: It is unknown.
        """
        if self.cause not in get_args(Cause):
            raise InvalidInput(f"unexplained load: unknown cause '{self.cause}'")

    @property
    def force_n(self) -> float:
        """Size of the mean force, N."""
        return float(np.linalg.norm(self.vector_n))

    @property
    def direction(self) -> str:
        """Upward, downward, horizontal, obliquely upward or obliquely downward."""
        up = self.vector_n[2] / max(self.force_n, 1e-9)
        if abs(up) < FLAT:
            return "horizontal"
        vertical = "upward" if up > 0.0 else "downward"
        return vertical if abs(up) >= STEEP else f"obliquely {vertical}"

    @property
    def sentence(self) -> str:
        """The load in words, with its hint."""
        return f"unexplained force {self.size} from {self.from_s:.2f} to {self.to_s:.2f} s: {self.hint}"

    @property
    def sentence_now(self) -> str:
        """The load in words while it goes on."""
        return f"unexplained force {self.size}: {self.hint}"

    @property
    def size(self) -> str:
        """Size, direction and share of body weight."""
        return f"{self.force_n:.0f} N {self.direction} ({percent(self.share)} of body weight)"
