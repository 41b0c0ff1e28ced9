"""What a check of a capture found: a number beside what noise explains of it, and a verdict."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Literal, get_args

from mbkf.errors import InvalidInput

Judgement = Literal["inside", "doubtful", "outside", "not judged"]
"""Within what noise explains; more than that, and less than the bound; beyond the bound; too little to tell by."""

INSIDE_SD = 2.0
"""So many expected standard deviations are what noise explains."""


@dataclass(frozen=True)
class Finding:
    """One check.

    Attributes:
        name: What is checked, e.g. "mass against plates".
        value: What was found, 0 where everything agrees; None where it cannot be judged.
        expected_sd: The standard deviation that noise alone gives the value; None where it cannot be judged.
        unit: Unit of value, spread and bound.
        bound: A value of this size or less is not called outside.
        verdict: One of :data:`Judgement`.
        hint: What it means and what to do, or why it is not judged.
        better: The quantity's better value where the capture gives one, e.g. the mass in kg; None elsewhere.
    """

    name: str
    value: float | None
    expected_sd: float | None
    unit: str
    bound: float
    verdict: Judgement
    hint: str = ""
    better: float | None = None

    def __post_init__(self) -> None:
        """Refuses a verdict that is none.

        Raises:
            InvalidInput: It is so.
        """
        if self.verdict not in get_args(Judgement):
            raise InvalidInput(f"check '{self.name}': the verdict '{self.verdict}' is none")

    def as_table(self) -> dict[str, object]:
        """As plain data."""
        return asdict(self)


def not_judged(name: str, unit: str, bound: float, why: str) -> Finding:
    """A check for which the capture holds too little.

    Args:
        name: What is checked.
        unit: Unit of its value.
        bound: Its bound.
        why: What is missing.
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
        value: What was found.
        expected_sd: What noise alone gives.
        bound: Beyond this, and beyond what noise explains, it is outside.
    """
    size, noise = abs(value), INSIDE_SD * expected_sd
    if size <= noise:
        return "inside"
    return "outside" if size > max(bound, noise) else "doubtful"
