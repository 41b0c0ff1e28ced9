"""Findings of pieces put together to those of the trial: stretches across borders, checks, remarks."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.io.contacts import ContactInterval
from mbkf.io.findings import Finding
from mbkf.io.unexplained import UnexplainedLoad

GRAVITY_OF = {"not judged": 0, "inside": 1, "doubtful": 2, "outside": 3}
"""Verdicts of checks, the gravest last."""

_NUMBERS = re.compile(r"(?<![\w'])\d[\d.,–:]*")
"""Numbers that differ among remarks of one kind; those of names, such as LTHI1 and plate '2', are part of the kind."""


class Remarks:
    """Remarks of the pieces of a trial, those of one kind together."""

    def __init__(self) -> None:
        """No remark."""
        self._found: dict[str, list[tuple[float, float, str]]] = {}
        self._pieces = 0

    def add(self, texts: Sequence[str], from_s: float, to_s: float) -> None:
        """Adds those of the next piece.

        Args:
            texts: The remarks.
            from_s: Time of the piece's first frame.
            to_s: Time of its last frame.
        """
        self._pieces += 1
        for text in dict.fromkeys(texts):
            self._found.setdefault(_NUMBERS.sub("#", text), []).append((from_s, to_s, text))

    def texts(self) -> tuple[str, ...]:
        """A remark of each kind: the first one, with its time where not all pieces have it word by word."""
        return tuple(self._text(each) for each in self._found.values())

    def _text(self, each: Sequence[tuple[float, float, str]]) -> str:
        from_s, to_s, text = each[0]
        if len({one for *_, one in each}) == 1 and len(each) == self._pieces:
            return text
        return f"in {len(each)} of {self._pieces} parts of the trial, such as {from_s:.0f} to {to_s:.0f} s: {text}"


def usual_checks(found: Sequence[Sequence[Finding]]) -> tuple[Finding, ...]:
    """Of each check the usual finding: the middle one of all pieces that could judge it, by its verdict and size.

    The gravest of many pieces would say more of their noise than of the trial; what goes wrong in a few of them is
    said by :func:`unusual_checks`.

    Args:
        found: The checks of each piece.
    """
    return tuple(each[len(each) // 2] for each in _by_check(found))


def unusual_checks(found: Sequence[Sequence[Finding]]) -> tuple[str, ...]:
    """A remark on each check that is outside its bound in some pieces, but not usually.

    Args:
        found: The checks of each piece.
    """
    remarks = []
    for each in _by_check(found):
        outside = [one for one in each if one.verdict == "outside"]
        if outside and each[len(each) // 2].verdict != "outside":
            worst = outside[-1]
            place = f" ({worst.segment.replace('_', ' ')})" if worst.segment else ""
            remarks.append(
                f"{worst.name}{place}: outside its bound of {worst.bound:g} {worst.unit} in {len(outside)} of "
                f"{len(each)} parts of the trial, up to {abs(worst.value or 0.0):.3g} {worst.unit}; {worst.hint}"
            )
    return tuple(remarks)


def _by_check(found: Sequence[Sequence[Finding]]) -> list[list[Finding]]:
    """Findings of each check, the gravest last; those that could not be judged only where no piece could."""
    each: dict[tuple[str, str], list[Finding]] = {}
    for one in (one for piece in found for one in piece):
        each.setdefault((one.name, one.segment), []).append(one)
    judged = ([one for one in many if one.verdict != "not judged"] or many[:1] for many in each.values())
    return [sorted(many, key=_gravity) for many in judged]


def _gravity(one: Finding) -> tuple[int, float]:
    return GRAVITY_OF[one.verdict], abs(one.value or 0.0)


def joined_loads(loads: Sequence[UnexplainedLoad], frame_s: float) -> tuple[UnexplainedLoad, ...]:
    """Unexplained loads with those of one direction joined that overlap or follow each other: they crossed a border.

    Args:
        loads: Loads of all pieces, with their margins, so that those near a border come twice.
        frame_s: Time between frames.
    """
    found: list[UnexplainedLoad] = []
    for one in sorted(loads, key=lambda one: (one.from_s, one.to_s)):
        k = next(
            (
                k
                for k, other in enumerate(found)
                if one.from_s <= other.to_s + 1.5 * frame_s and one.direction == other.direction
            ),
            None,
        )
        if k is None:
            found.append(one)
            continue
        longer = max(found[k], one, key=lambda load: load.to_s - load.from_s)
        found[k] = replace(longer, from_s=found[k].from_s, to_s=max(found[k].to_s, one.to_s))
    return tuple(found)


def joined_contacts(contacts: Sequence[ContactInterval], frame_s: float) -> tuple[ContactInterval, ...]:
    """Contacts with those of one part and source joined that follow each other without a frame between them.

    Args:
        contacts: Contacts of all pieces, without their margins.
        frame_s: Time between frames.
    """
    found: list[ContactInterval] = []
    last: dict[str, int] = {}
    for one in sorted(contacts, key=lambda one: one.from_s):
        k = last.get(one.part)
        if k is None or found[k].how != one.how or one.from_s > found[k].to_s + 1.5 * frame_s:
            last[one.part] = len(found)
            found.append(one)
        else:
            found[k] = _one_contact(found[k], one, frame_s)
    return tuple(found)


def _one_contact(before: ContactInterval, after: ContactInterval, frame_s: float) -> ContactInterval:
    """Two parts of a contact as one; its standard deviation is the mean over both."""
    sizes = [one.to_s - one.from_s + frame_s for one in (before, after)]
    sds = np.array([before.sd_n, after.sd_n])
    known = np.isfinite(sds)
    sd_n = float(np.average(sds[known], weights=np.array(sizes)[known])) if known.any() else float("nan")
    peak_n = max(before.peak_n, after.peak_n)
    return replace(before, to_s=after.to_s, peak_n=peak_n, sd_n=sd_n)
