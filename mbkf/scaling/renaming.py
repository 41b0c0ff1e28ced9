"""The likeliest names of trajectories, searched from names that may be wrong, and the alternatives tried.

A person is fitted to the names, and names are assigned anew to that person, in turns. E falls at every turn
(:mod:`mbkf.scaling.naming`), but may end in a local minimum of poses and names. Single names are therefore changed,
the most promising first, with the person fitted anew; and where markers are still far from their places, whole limbs
are exchanged with those of the other side.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.sides import mirrored
from mbkf.scaling.naming import Indices, Naming, NamingProblem

TURNS = 8
"""Greatest number of turns of fitting and assigning."""

LEAST_GAIN = 1.0
"""Least gain in E for which names are changed."""

TRIED = 60
"""Changes of one name that are tried in vain before the search ends."""

MOST_CHANGES = 40
"""Greatest number of changes."""

LOOK_STEPS, STEPS, FIRST_STEPS = 2, 6, 40
"""Iterations of a first fit after a change, of the fit that judges it, and of a fit without a start."""

HOPELESS = 60.0
"""A change that costs more than this after the first fit is not fitted any further."""


@dataclass(frozen=True)
class Renamed:
    """The likeliest names, and the alternatives tried, the cheapest first."""

    naming: Naming
    rivals: tuple[Naming, ...]


def likeliest(problem: NamingProblem, progress: Callable[[int, int], None] | None = None) -> Renamed:
    """The likeliest names that can be reached from the first ones by changing one after the other.

    Args:
        problem: Trajectories and markers.
        progress: Called with changes tried and changes to be tried.
    """
    report = progress or (lambda *_: None)
    found = _changed(problem, settled_names(problem), report)
    sided = _on_their_sides(problem, found.naming)
    if sided is not found.naming:
        found = _changed(problem, sided, report)
    report(TRIED, TRIED)
    return found


def _changed(problem: NamingProblem, naming: Naming, report: Callable[[int, int], None]) -> Renamed:
    """Names after changes of single ones that make them likelier."""
    rivals: list[Naming] = []
    for _ in range(MOST_CHANGES):
        rivals.clear()
        better = None
        for done, marker in enumerate(_changes(problem.shares(naming.state)[0], naming.marker)):
            report(done, TRIED)
            one = _refitted(problem, naming, marker, LOOK_STEPS)
            if one.cost < naming.cost + HOPELESS:
                one = problem.fitted(marker, one.state, STEPS - LOOK_STEPS)
            if one.cost < naming.cost - LEAST_GAIN:
                better = one
                break
            rivals.append(one)
        if better is None:
            break
        naming = _settled(problem, better)
    return Renamed(naming, tuple(sorted(rivals, key=lambda one: one.cost)))


def settled_names(problem: NamingProblem) -> Naming:
    """Names and poses that agree, from the first names."""
    return _settled(problem, problem.fitted(problem.first, None, FIRST_STEPS))


def _settled(problem: NamingProblem, naming: Naming) -> Naming:
    from scipy.optimize import linear_sum_assignment  # loads slowly

    for _ in range(TURNS):
        share, _ = problem.shares(naming.state)
        marker = np.asarray(linear_sum_assignment(share)[1], dtype=np.intp)
        if (marker == naming.marker).all():
            break
        again = _refitted(problem, naming, marker, FIRST_STEPS)
        if again.cost >= naming.cost - LEAST_GAIN:
            break
        naming = again
    return naming


def _on_their_sides(problem: NamingProblem, naming: Naming) -> Naming:
    """Names with those of whole limbs exchanged between left and right, where that is likelier.

    Tried only where markers are far from their places. Names that settled with a limb on the wrong side are scrambled,
    so that the first names are exchanged as well.
    """
    mirror = _mirror_images(problem)
    for limb in _limbs(problem):
        for names in (problem.first, naming.marker):
            crossed = np.where(limb[names], mirror[names], names)
            if not problem.far(naming).any() or (crossed == names).all():
                continue
            other = _settled(problem, problem.fitted(crossed, None, FIRST_STEPS))
            if other.cost < naming.cost - LEAST_GAIN:
                naming = other
    return naming


def _mirror_images(problem: NamingProblem) -> Indices:
    """(M,) the marker at the same place of the other side, else the marker itself."""
    place = np.array([marker.position_m for marker in problem.markers])
    segments = [marker.segment for marker in problem.markers]
    image = np.arange(len(place))
    for m, segment in enumerate(segments):
        same = [other == mirrored(segment) for other in segments]
        near = (np.abs(place - place[m] * [1.0, -1.0, 1.0]) < 1e-9).all(axis=1)
        others = np.flatnonzero(same & near)
        image[m] = others[0] if len(others) else m
    return image


def _limbs(problem: NamingProblem) -> list[BoolArray]:
    """(M,) True for markers of a paired segment and of the segments beyond it, on both sides."""
    body, segments = problem.body, [marker.segment for marker in problem.markers]
    found = []
    for segment in body.segments:
        if not segment.name.startswith("right_"):
            continue
        limb = {segment.name}
        for other in body.segments:  # parents come first
            if other.parent in limb:
                limb.add(other.name)
        limb |= {mirrored(name) for name in limb}
        found.append(np.array([name in limb for name in segments]))
    return found


def _refitted(problem: NamingProblem, naming: Naming, marker: Indices, steps: int) -> Naming:
    """The person fitted to other names, from the poses of the names before."""
    _, offsets = problem.shares(naming.state)
    start = np.zeros_like(naming.state.offsets_m)
    start[marker] = offsets[np.arange(len(marker)), marker]
    return problem.fitted(marker, replace(naming.state, offsets_m=start), steps)


def _changes(share: Array, marker: Indices) -> list[Indices]:
    """Names after a change of one trajectory's, the most promising first, by the change of E with the poses fixed.

    The trajectory whose name it takes gets the best of the names that are then free.
    """
    owner = {int(one): u for u, one in enumerate(marker)}
    own = share[np.arange(len(share)), marker]
    free = [m for m in range(share.shape[1]) if m not in owner]
    found: dict[bytes, tuple[float, Indices]] = {}
    for u, old in enumerate(marker):
        for new in range(share.shape[1]):
            if new == old:
                continue
            changed = marker.copy()
            changed[u] = new
            added = share[u, new] - own[u]
            if new in owner:
                v = owner[new]
                rest = np.array([*free, int(old)])
                changed[v] = rest[share[v, rest].argmin()]
                added += share[v, changed[v]] - own[v]
            found[changed.tobytes()] = (float(added), changed)
    ordered = sorted(found.values(), key=lambda one: one[0])
    return [changed for _, changed in ordered[:TRIED]]
