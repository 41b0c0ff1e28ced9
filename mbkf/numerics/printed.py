"""Numbers in sentences: a share that is not 0 or 1 does not read as 0 or 100 %, a length or force not as 0."""

from __future__ import annotations

MOST_PLACES = 4
"""Decimal places after which a number is rounding noise."""

ENDS = (0.0, 100.0, -100.0)


def percent(share: float, places: int = 0, *, signed: bool = False) -> str:
    """A share in per cent, with more decimal places where it would read as 0 or ± 100 and is not.

    Args:
        share: The share, 1 for all.
        places: Decimal places, as far as they suffice.
        signed: True for a sign before positive numbers as well.
    """
    return f"{_distinct(100.0 * share, places, signed, ENDS)} %"


def rounded(value: float, places: int = 0, *, signed: bool = False) -> str:
    """A number with more decimal places where it would read as 0 and is not.

    Args:
        value: The number.
        places: Decimal places, as far as they suffice.
        signed: True for a sign before positive numbers as well.
    """
    return _distinct(value, places, signed, ENDS[:1])


def _distinct(value: float, places: int, signed: bool, ends: tuple[float, ...]) -> str:
    sign = "+" if signed else ""
    for more in (*range(places, MOST_PLACES + 1), places):
        text = f"{round(value, more) + 0.0:{sign}.{more}f}"  # + 0.0: without the sign of a negative zero
        if float(text) not in ends or float(text) == value:
            return text
    return text
