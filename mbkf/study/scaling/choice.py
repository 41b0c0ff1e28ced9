"""Choice of a session's trials for scaling: a walk, a deep flexion, and a movement of trunk or arms that neither has.

A walk shows where hips, knees and ankles turn; flexion as deep as in a squat distinguishes skin from the posture of the
bones under it. Further trials of the same movement hardly add to that, and impacts shake the markers. Each movement has
one trial, the one that shows it best; names decide between equals, so that the order of the trials does not matter.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from mbkf.io.session import TrialKind
from mbkf.study.scaling.excitation import Excitation

DEEP_HIP_DEG, DEEP_KNEE_DEG = 70.0, 80.0
"""Least flexion of both hips and both knees in a deep flexion: that of getting up from a chair."""

USUAL_SWING_DEG, ENOUGH = 55.0, 1.3
"""Flexion of the knee in a walk, and depth of a flexion over the least one, beyond which trials count as equal."""

UPPER_GAIN_DEG = 45.0
"""A movement of trunk or arms is added where a joint turns by so much more than in the trials chosen already."""

STEP = 0.1
"""Trials whose merits differ by less count as equal."""

IMPACTS = (TrialKind.RUN, TrialKind.JUMP)


class Part(StrEnum):
    """Contribution of a trial to scaling."""

    WALK = "walk"
    DEEP = "deep flexion"
    UPPER = "trunk and arms"
    FIRST = "movement"


@dataclass(frozen=True)
class Chosen:
    """A trial that the body is scaled from.

    Attributes:
        name: The trial.
        part: Its contribution.
        why: The evidence, a clause.
    """

    name: str
    part: Part
    why: str


@dataclass(frozen=True)
class Choice:
    """The trials that the body is scaled from besides standing.

    Attributes:
        chosen: They, in the order of :class:`Part`.
        left_out: Reason by each other trial, a clause.
        complete: True with a walk and a deep flexion, both without impacts: more trials would add little.
    """

    chosen: tuple[Chosen, ...] = ()
    left_out: Mapping[str, str] = field(default_factory=dict)
    complete: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the chosen trials."""
        return tuple(one.name for one in self.chosen)


def choose(excitations: Mapping[str, Excitation], refused: Mapping[str, str] | None = None) -> Choice:
    """The trials to scale from.

    Args:
        excitations: Excitation by name of the trial.
        refused: Reason by name of each trial that cannot be used.
    """
    usable = {name: excitations[name] for name in sorted(excitations)}
    calm = {name: one for name, one in usable.items() if one.kind not in IMPACTS}
    gait = best(calm, lambda one: _stride(one) if one.kind == TrialKind.WALK else 0.0)
    gait = gait or best(usable, lambda one: _stride(one) if one.kind == TrialKind.RUN else 0.0)
    others = {name: one for name, one in calm.items() if one.kind != TrialKind.WALK}
    moved = _upper_over([usable[gait]] if gait else [])
    deep = best(others, _depth, moved) or best(usable, _depth)
    taken = {name: part for name, part in ((deep, Part.DEEP), (gait, Part.WALK)) if name}
    moved = _upper_over([usable[name] for name in taken])
    upper = best(
        {name: one for name, one in others.items() if name not in taken},
        lambda one: min(moved(one) / 90.0, 1.0) if moved(one) >= UPPER_GAIN_DEG else 0.0,
    )
    if upper:
        taken[upper] = Part.UPPER
    order = list(Part)
    chosen = tuple(
        Chosen(name, part, _evidence(part, usable[name]))
        for name, part in sorted(taken.items(), key=lambda one: order.index(one[1]))
    )
    surplus = {name: _surplus(one, taken.values()) for name, one in usable.items() if name not in taken}
    left_out = {**(refused or {}), **surplus}
    complete = gait in calm and deep in calm
    return Choice(chosen, {name: left_out[name] for name in sorted(left_out)}, complete)


def best(
    trials: Mapping[str, Excitation],
    merit: Callable[[Excitation], float],
    otherwise: Callable[[Excitation], float] = lambda _: 0.0,
) -> str:
    """Name of the trial with greatest merit; "" where all have 0.

    Args:
        trials: Excitation by name, sorted.
        merit: 0 to about 1 of a trial.
        otherwise: Decides between those that come within :data:`STEP` of the greatest merit; their names do last.
    """
    merits = {name: one.coverage * merit(one) for name, one in trials.items()}
    greatest = max(merits.values(), default=0.0)
    equals = [name for name, found in merits.items() if found and found >= greatest - STEP]
    return max(equals, key=lambda name: round(otherwise(trials[name]) / UPPER_GAIN_DEG), default="")


def _stride(found: Excitation) -> float:
    """Merit of a gait."""
    return min(found.swing_deg / USUAL_SWING_DEG, 1.0)


def _depth(found: Excitation) -> float:
    """Merit of a deep flexion; 0 where it is not deep."""
    depth = min(found.hips_deg / DEEP_HIP_DEG, found.knees_deg / DEEP_KNEE_DEG)
    return min(depth / ENOUGH, 1.0) if depth >= 1.0 else 0.0


def _upper_over(chosen: Sequence[Excitation]) -> Callable[[Excitation], float]:
    """Greatest excursion of trunk or arms, degrees, beyond that of the trials chosen already."""

    def further(found: Excitation) -> float:
        gains = (
            deg - max((one.upper_deg.get(name, 0.0) for one in chosen), default=0.0)
            for name, deg in found.upper_deg.items()
        )
        return max(gains, default=0.0)

    return further


def _evidence(part: Part, found: Excitation) -> str:
    """Clause about the movement of a chosen trial."""
    shaken = ", with impacts" if found.kind in IMPACTS else ""
    if part is Part.WALK:
        return f"both legs step, knees bend to {found.swing_deg:.0f}°{shaken}"
    if part is Part.DEEP:
        return f"hips bend to {found.hips_deg:.0f}°, knees to {found.knees_deg:.0f}°{shaken}"
    name = max(found.upper_deg, key=found.upper_deg.__getitem__)
    return f"{name.replace('_', ' ')} turns by {found.upper_deg[name]:.0f}°"


def _surplus(found: Excitation, taken: Collection[Part]) -> str:
    """Clause about a usable trial that is not needed."""
    if found.kind == TrialKind.STATIC:
        return "the person stands still"
    if found.kind in IMPACTS:
        return "impacts shake its markers, and calm trials show as much"
    if found.kind == TrialKind.WALK and Part.WALK in taken:
        return "another walk shows as much"
    if _depth(found) and Part.DEEP in taken:
        return "another trial bends as deeply"
    return (
        f"hips bend to {found.hips_deg:.0f}° and knees to {found.knees_deg:.0f}°; deep flexion takes "
        f"{DEEP_HIP_DEG:.0f}° and {DEEP_KNEE_DEG:.0f}°"
    )
