"""Ambiguous labels: pairs of names that fit nearly as well the other way round, with their odds, as warnings.

Two markers of a cluster whose places a protocol leaves open, or one of two neighbours of which one is not worn, may fit
a capture nearly as well by either name. Only a labelled standing trial settles such a case.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import Array
from mbkf.scaling.naming import NamingProblem
from mbkf.scaling.renaming import Renamed

DOUBTFUL_ODDS = 20.0
"""Names are doubtful that are fewer times likelier than others."""

MISFIT = 1.0
"""A person that fits no better (:class:`mbkf.scaling.naming.Naming`) may be none: limbs or sides are mistaken."""

_MM = 1e3


@dataclass(frozen=True)
class Doubt:
    """Labels that may be others.

    Attributes:
        labels: The labels in doubt.
        others: What each of them may be.
        odds: How many times likelier the labels are as they stand.
        off_m: How far each is from where the protocol has it on this person.
        others_off_m: The same by the other name.
    """

    labels: tuple[str, ...]
    others: tuple[str, ...]
    odds: float
    off_m: tuple[float, ...]
    others_off_m: tuple[float, ...]

    def text(self) -> str:
        """The doubt in words, with its evidence."""
        names = " and ".join(
            f"{own} may be {other} ({_MM * off:.0f} and {_MM * other_off:.0f} mm from their places)"
            for own, other, off, other_off in zip(
                self.labels, self.others, self.off_m, self.others_off_m, strict=True
            )
        )
        return f"{names}; {self.odds:.1f} times likelier as it stands"

    def summary(self) -> dict[str, object]:
        """Plain numbers for the summary."""
        return {
            "labels": list(self.labels),
            "may_be": list(self.others),
            "odds": self.odds,
            "from_place_mm": [_MM * off for off in self.off_m],
            "from_other_place_mm": [_MM * off for off in self.others_off_m],
        }


@dataclass(frozen=True)
class Doubts:
    """Possible errors in the labels of a person.

    Attributes:
        cases: Labels that may be others, the likeliest others first.
        far_m: Labels further from their place than their protocol allows, and how far.
        misfit: Mean squared distance of person and points, in squares of what is usual.
        nameless: Tracks seen in half of the frames that fit no marker.
        unused: Markers of the protocol that were found nowhere.
        scaled: Whether the person was scaled before, so that places are those of the standing trial.
        rare: Labels seen much more rarely than others, and in which share of the frames.
        names: Lines about names of the capture that the labels do not keep.
        odds: How many times likelier each label is than the likeliest other.
    """

    cases: tuple[Doubt, ...]
    far_m: Mapping[str, float]
    misfit: float
    nameless: int
    unused: tuple[str, ...]
    scaled: bool = False
    rare: Mapping[str, float] = field(default_factory=dict)
    names: tuple[str, ...] = ()
    odds: Mapping[str, float] = field(default_factory=dict)

    @property
    def labels(self) -> tuple[str, ...]:
        """The labels in doubt, each once."""
        return tuple(
            dict.fromkeys([*self.far_m, *self.rare, *(label for case in self.cases for label in case.labels)])
        )

    def warnings(self) -> tuple[str, ...]:
        """Warnings in words: the person as a whole, labels far from their places, names, and what settles them."""
        if self.scaled:
            return self._against_standing()
        found = []
        if self.misfit > MISFIT:
            found.append(
                f"the points fit no person well (misfit {self.misfit:.1f}, usually 0.1 to 0.4): limbs or sides may be "
                "mistaken, and any label wrong"
            )
        if 0 < self.nameless <= len(self.unused):
            found.append(
                f"{self.nameless} tracks seen in half of the frames fit no marker, though {len(self.unused)} markers "
                "of the protocol were found nowhere: labels near them may be wrong"
            )
        if self.far_m:
            names = ", ".join(f"{name} ({_MM * off:.0f} mm)" for name, off in self.far_m.items())
            found.append(f"further from their places than their protocol allows, hence hardly right: {names}")
        found += [_group_text(group) for group in _groups(self.cases)]
        if found:
            found.append(
                f"{len(self.labels)} labels are in doubt; a labelled standing trial settles it: --static LABELLED"
            )
        return tuple(found)

    def _against_standing(self) -> tuple[str, ...]:
        """Warnings where places are those of the standing trial."""
        found = list(self.names)
        if self.nameless > 0 and self.unused:
            found.append(
                f"{self.nameless} tracks seen in half of the frames fit no marker, and found nowhere are "
                f"{', '.join(self.unused)}: are these other markers, or moved far?"
            )
        if self.far_m:
            names = ", ".join(f"{name} ({_MM * off:.0f} mm)" for name, off in self.far_m.items())
            found.append(
                f"far from where scaling found them, hence moved since, other markers, or ghosts: {names}"
            )
        if self.rare:
            names = ", ".join(f"{name} ({100.0 * share:.0f} %)" for name, share in self.rare.items())
            found.append(f"labelled in few of the frames, hence perhaps ghosts: {names}")
        return (*found, *(_group_text(group) for group in _groups(self.cases)))

    def summary(self) -> dict[str, object]:
        """Plain numbers for the summary."""
        more = {"rarely_seen": dict(self.rare), "names_not_kept": list(self.names), "odds": dict(self.odds)}
        return {
            **(more if self.scaled else {}),
            "labels": list(self.labels),
            "far_from_place_mm": {name: _MM * off for name, off in self.far_m.items()},
            "cases": [case.summary() for case in self.cases],
            "misfit": self.misfit,
            "nameless_tracks": self.nameless,
            "unused_markers": list(self.unused),
        }


def doubts(problem: NamingProblem, renamed: Renamed, nameless: int) -> Doubts:
    """What was nearly as likely as the names that were found, and how well these fit.

    Args:
        problem: The trajectories and markers.
        renamed: Their likeliest names and those tried instead.
        nameless: Tracks seen in half of the frames that fit no marker.
    """
    own, names = renamed.naming, [marker.name for marker in problem.markers]
    off = problem.offsets_m(own)
    found = []
    for rival in renamed.rivals:
        # E is twice a logarithm; a rival not worse at all is as likely as not.
        odds = math.exp(0.5 * max(0.0, min(rival.cost - own.cost, 700.0)))
        if odds > DOUBTFUL_ODDS:
            continue
        changed = np.flatnonzero(rival.marker != own.marker)
        rival_off = problem.offsets_m(rival)
        found.append(
            Doubt(
                tuple(names[m] for m in own.marker[changed]),
                tuple(names[m] for m in rival.marker[changed]),
                odds,
                _numbers(off[changed]),
                _numbers(rival_off[changed]),
            )
        )
    unused = np.setdiff1d(np.arange(len(names)), own.marker)
    far = {names[own.marker[u]]: float(off[u]) for u in np.flatnonzero(problem.far(own))}
    return Doubts(tuple(found), far, own.misfit, nameless, tuple(names[m] for m in unused))


def _groups(cases: Sequence[Doubt]) -> list[list[Doubt]]:
    """Cases that hang together by their names, the likeliest first."""
    groups: list[list[Doubt]] = []
    for case in cases:
        names = {*case.labels, *case.others}
        joined = [one for one in groups if any(names & {*other.labels, *other.others} for other in one)]
        groups = [one for one in groups if one not in joined]
        groups.append([*(other for one in joined for other in one), case])
    return sorted(groups, key=lambda group: min(case.odds for case in group))


def _group_text(group: Sequence[Doubt]) -> str:
    """A group in words; its evidence where it is one case only."""
    if len(group) == 1:
        return group[0].text()
    labels = dict.fromkeys(label for case in group for label in case.labels)
    others = [name for name in dict.fromkeys(n for case in group for n in case.others) if name not in labels]
    worn = f", or {' or '.join(others)}" if others else ""
    odds = min(case.odds for case in group)
    return f"{', '.join(labels)} may have each other's names{worn}; {odds:.1f} times likelier as they stand"


def _numbers(values: Array) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
