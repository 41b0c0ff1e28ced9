"""Ambiguous labels: names that fit nearly as well when exchanged, with their odds, as warnings.

Two markers of a cluster whose places a protocol leaves open, or two neighbours of which one is not worn, may fit a
capture nearly as well by either name. Only a labelled standing trial decides such a case.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.printed import percent
from mbkf.scaling.naming import NamingProblem
from mbkf.scaling.renaming import Renamed

DOUBTFUL_ODDS = 20.0
"""Names are doubtful where they are fewer times more likely than others."""

MISFIT = 1.0
"""Misfit (:class:`mbkf.scaling.naming.Naming`) above which limbs or sides may be confused."""

_MM = 1e3


@dataclass(frozen=True)
class Doubt:
    """Labels that may be others.

    Attributes:
        labels: The labels in doubt.
        others: The other name of each.
        odds: Ratio of the likelihoods of the given labels and of the others.
        off_m: Distance of each from its place in the protocol on this person.
        others_off_m: The same by the other name.
    """

    labels: tuple[str, ...]
    others: tuple[str, ...]
    odds: float
    off_m: tuple[float, ...]
    others_off_m: tuple[float, ...]

    def text(self) -> str:
        """The doubt as a sentence, with its evidence."""
        names = " and ".join(
            f"{own} may be {other} ({_MM * off:.0f} and {_MM * other_off:.0f} mm from their places)"
            for own, other, off, other_off in zip(
                self.labels, self.others, self.off_m, self.others_off_m, strict=True
            )
        )
        return f"{names}; the label given is {self.odds:.1f} times more likely"

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
        cases: Labels that may be others, the most likely others first.
        far_m: Distances from their places of labels that are further away than their protocol allows.
        misfit: Mean squared distance of person and points, in units of the usual one.
        nameless: Number of tracks seen in half of the frames that have no label.
        unused: Markers of the protocol without a track.
        scaled: True where the person was scaled before, so that places are those of the standing trial.
        rare: Share of the frames of labels that are seen much more rarely than others.
        names: Sentences about names of the capture that the labels do not keep.
        odds: Ratio of the likelihoods of each label and of the most likely other one.
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
        """The doubtful labels, each once."""
        return tuple(
            dict.fromkeys([*self.far_m, *self.rare, *(label for case in self.cases for label in case.labels)])
        )

    def warnings(self) -> tuple[str, ...]:
        """Warnings: the person as a whole, labels far from their places, ambiguous names, and the remedy."""
        if self.scaled:
            return self._against_standing()
        found = []
        if self.misfit > MISFIT:
            found.append(
                f"the points fit the body poorly (misfit {self.misfit:.1f}, usually 0.1 to 0.4); limbs or sides may be "
                "confused: check all labels"
            )
        if 0 < self.nameless <= len(self.unused):
            found.append(
                f"{self.nameless} tracks seen in at least half of the frames have no label, and {len(self.unused)} "
                "markers of the protocol have no track: check the labels near them"
            )
        if self.far_m:
            found.append(
                f"labels further from their places than the protocol allows: {self._far()}; check them"
            )
        found += [_group_text(group) for group in _groups(self.cases)]
        if found:
            found.append(
                f"{len(self.labels)} labels are doubtful; a labelled standing trial decides them: --static LABELLED"
            )
        return tuple(found)

    def _against_standing(self) -> tuple[str, ...]:
        """Warnings where the places are those of a standing trial."""
        found = list(self.names)
        if self.nameless > 0 and self.unused:
            found.append(
                f"{self.nameless} tracks seen in at least half of the frames have no label, and these markers have no "
                f"track: {', '.join(self.unused)}; check for other markers, and for markers that moved far"
            )
        if self.far_m:
            found.append(
                f"labels far from their places in scaling: {self._far()}; these markers moved, or are others or ghosts"
            )
        if self.rare:
            names = ", ".join(f"{name} ({percent(share)})" for name, share in self.rare.items())
            found.append(f"labels in few of the frames: {names}; they may be ghosts")
        return (*found, *(_group_text(group) for group in _groups(self.cases)))

    def _far(self) -> str:
        return ", ".join(f"{name} ({_MM * off:.0f} mm)" for name, off in self.far_m.items())

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
    """Doubts about the names that were found: others nearly as likely, and labels far from their places.

    Args:
        problem: The trajectories and markers.
        renamed: Their most likely names and the alternatives tried.
        nameless: Number of tracks seen in half of the frames that have no label.
    """
    own, names = renamed.naming, [marker.name for marker in problem.markers]
    off = problem.offsets_m(own)
    found = []
    for rival in renamed.rivals:
        # E is twice a logarithm; the odds of a rival that is not worse are 1.
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
    """Cases that share names, the most likely first."""
    groups: list[list[Doubt]] = []
    for case in cases:
        names = {*case.labels, *case.others}
        joined = [one for one in groups if any(names & {*other.labels, *other.others} for other in one)]
        groups = [one for one in groups if one not in joined]
        groups.append([*(other for one in joined for other in one), case])
    return sorted(groups, key=lambda group: min(case.odds for case in group))


def _group_text(group: Sequence[Doubt]) -> str:
    """A group as a sentence, with evidence for a single case."""
    if len(group) == 1:
        return group[0].text()
    labels = dict.fromkeys(label for case in group for label in case.labels)
    others = [name for name in dict.fromkeys(n for case in group for n in case.others) if name not in labels]
    worn = f" or be {' or '.join(others)}" if others else ""
    odds = min(case.odds for case in group)
    return f"{', '.join(labels)} may be exchanged{worn}; the labels given are {odds:.1f} times more likely"


def _numbers(values: Array) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
