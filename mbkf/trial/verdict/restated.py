"""Remarks of a trial that its verdict states already, so that pages state each problem once."""

from __future__ import annotations

import re
from collections.abc import Iterable

from mbkf.io.verdict import Verdict

SUPPORTS, BEARS = "other parts than the feet bear load", "which nothing measures"
"""A remark on loads besides the feet begins with the first; a reason that states them holds the second."""

_OPENING = re.compile(r"[^\d:+−-]{8,}")


def unstated(remarks: Iterable[str], verdict: Verdict) -> tuple[str, ...]:
    """The remarks that no reason states: those that begin otherwise than all of them, up to the first number.

    Args:
        remarks: Of the trial.
        verdict: Its verdict.
    """
    return tuple(dict.fromkeys(one for one in remarks if not stated(one, verdict)))


def stated(remark: str, verdict: Verdict) -> bool:
    """True if a reason against a part that is shown states a remark, or the check that the remark names.

    Args:
        remark: The remark, or the name of a check.
        verdict: The verdict.
    """
    found = [one.found for one in verdict.reasons if one.part in verdict.shown]
    if remark.startswith(SUPPORTS):
        return any(BEARS in one for one in found)
    return any(remark == one or _alike(remark, one) for one in found)


def _alike(remark: str, found: str) -> bool:
    openings = [_OPENING.match(one) for one in (remark, found)]
    return all(openings) and len({one[0].strip(" '") for one in openings if one}) == 1
