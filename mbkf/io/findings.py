"""Result of one check of a capture: a number beside the part of it that noise explains, and a verdict."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Literal, get_args

from mbkf.errors import InvalidInput

Judgement = Literal["inside", "doubtful", "outside", "not judged"]
"""Within the spread of noise; beyond it, but below the bound; beyond the bound; too few data."""

INSIDE_SD = 2.0
"""Expected standard deviations that noise explains."""


@dataclass(frozen=True)
class Finding:
    """One check.

    Attributes:
        name: Name of the check, e.g. "mass against plates".
        value: Its result, 0 where everything agrees; None where it cannot be judged.
        expected_sd: Standard deviation that noise alone gives the value; None where it cannot be judged.
        unit: Unit of value, spread and bound.
        bound: Values up to this size are not called outside.
        verdict: One of :data:`Judgement`.
        hint: Meaning and remedy, or the reason why it is not judged.
        better: Better value of the quantity where the capture gives one, e.g. the mass in kg; None elsewhere.
        segment: Segment that it concerns; empty for the capture as a whole.
    """

    name: str
    value: float | None
    expected_sd: float | None
    unit: str
    bound: float
    verdict: Judgement
    hint: str = ""
    better: float | None = None
    segment: str = ""

    def __post_init__(self) -> None:
        """Refuses an unknown verdict.

        Raises:
            InvalidInput: It is unknown.
        """
        if self.verdict not in get_args(Judgement):
            raise InvalidInput(f"check '{self.name}': unknown verdict '{self.verdict}'")

    def as_table(self) -> dict[str, object]:
        """As plain data."""
        return asdict(self)


def not_judged(name: str, unit: str, bound: float, why: str) -> Finding:
    """A check for which the capture holds too little.

    Args:
        name: Name of the check.
        unit: Unit of its value.
        bound: Its bound.
        why: Missing data.
    """
    return Finding(name, None, None, unit, bound, "not judged", why)


def judged(  # noqa: D417
    name: str, value: float, expected_sd: float, unit: str, bound: float, hint: str, remedy: str = ""
) -> Finding:
    """A check with its verdict; the remedy is added to the hint of a value outside.

    Args:
        name, value, expected_sd, unit, bound, hint: As of :class:`Finding`.
        remedy: Text on what to do.
    """
    verdict = judgement(value, expected_sd, bound)
    text = f"{hint}{remedy}" if verdict == "outside" else hint
    return Finding(name, value, expected_sd, unit, bound, verdict, text)


def judgement(value: float, expected_sd: float, bound: float) -> Judgement:
    """The verdict on a value.

    Args:
        value: The result of the check.
        expected_sd: Standard deviation by noise alone.
        bound: Beyond this, and beyond noise, the value is outside.
    """
    size, noise = abs(value), INSIDE_SD * expected_sd
    if size <= noise:
        return "inside"
    return "outside" if size > max(bound, noise) else "doubtful"
