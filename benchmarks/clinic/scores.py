"""Scores on made curves against independent implementations, to their printed digits.

Variable scores are those of gait-profile-score 1.0.2 (M. Jeffryes, PyPI). It averages them for its GPS, as pyCGM2 4.2
does; Baker's GPS is their root mean square, which is taken of its numbers here. The index is that of a public
implementation of Schwartz's formula (compute_gdi, 2026), with its constants of the controls.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks.checks import Check
from mbkf.conventions import Array
from mbkf.io.norms import POINTS, Band, GdiBasis, Norms
from mbkf.io.session import TrialKind
from mbkf.study.session.cycles import ANGLE, Curves, Key, SessionCycle, SideCycles
from mbkf.study.session.means import Mean, half_width
from mbkf.study.session.records import MovementGroup
from mbkf.study.session.scores import VARIABLES, gait_scores
from mbkf.trial.gait.cycles import Cycle

SCORES_DEG = (
    (3.5312, 3.1139, 2.5334, 1.6777, 2.3185, 2.4694, 3.6090, 4.0045, 4.0086),
    (5.9920, 4.7128, 3.6365, 2.0501, 2.7734, 4.3660, 4.8925, 5.7659, 7.0673),
)
"""Of gait-profile-score, right and left, in the order of the variables."""

INDICES = (132.9254, 104.5071)
"""Of compute_gdi."""

SHIFT_DEG, PERSONS = 2.0, 300
"""Standard deviation of the error that a scaled body causes in all cycles of a curve, and made persons for a cover."""

DIGIT = 0.5001e-4
"""Half of the last printed digit."""


def curve(variable: int, person: int) -> Array:
    """(101,) a made curve in degrees."""
    t = np.linspace(0.0, 2.0 * np.pi, 101)
    swing = (variable + 1) * np.sin((1 + variable % 3) * t + 0.3 * person)
    return np.asarray(
        swing + 2.0 * np.cos((person + 1) * (1 + variable % 2) * t / 2.0) + person * 0.7 * (variable - 4)
    )


def made_gait() -> MovementGroup:
    """One cycle of each side: the right one is person 1's, the left one person 2's."""
    sides = []
    for side, person in ((0, 1), (1, 2)):
        cycle = Cycle(side, 0.0, 0.6, 1.0, 0.5, 0.1)
        zero = np.zeros((1, 101))
        curves = {
            Key(ANGLE, name): Curves("deg", curve(k, person)[None], zero, zero, zero)
            for k, name in enumerate(VARIABLES)
        }
        sides.append(SideCycles(side, (SessionCycle("made", cycle, True, True, True, True),), curves))
    return MovementGroup(TrialKind.WALK, ("made",), (sides[0], sides[1]), ())


def made_norms() -> Norms:
    """Person 0's curves, and cosines as features."""
    bands = {
        ("walk", ANGLE, name): Band("deg", 2, curve(k, 0), np.ones(101)) for k, name in enumerate(VARIABLES)
    }
    n = np.arange(459)
    features: Array = np.sqrt(2.0 / 459.0) * np.cos(np.pi * np.outer(np.arange(1, 16), n + 0.5) / 459.0)
    gdi = GdiBasis(VARIABLES, features, np.linspace(0.0, 1.4, 15), 4.443685139, 0.223457646)
    return Norms("made", bands, {}, gdi=gdi)


def _cover_rows() -> Iterator[Check]:
    """Share of made gaits, on a seed of their own, whose GPS interval holds the score of the person's cycles.

    Curves lie 0, 2 or 6 degrees off the norm, alike or as a sine; a body's error shifts all cycles of a person.
    """
    rng = np.random.default_rng(2026)
    shapes = (np.ones(POINTS), np.sqrt(2.0) * np.sin(np.linspace(0.0, 2.0 * np.pi, POINTS)))
    for cycles in (3, 6):
        covers = []
        for off in (0.0, 2.0, 6.0):
            for shape in shapes:
                many = off * shape + _wandering(rng, 4000)
                truth = float(np.sqrt((many**2).mean(axis=1)).mean())
                held = 0
                for _ in range(PERSONS):
                    own = off * shape + SHIFT_DEG * rng.standard_normal() + _wandering(rng, cycles)
                    gps = _gps_of(own)
                    held += abs(float(gps.mean[0]) - truth) <= float(half_width(gps)[0])
                covers.append(100.0 * held / PERSONS)
        yield Check(
            f"interval of a score, {cycles} cycles: least cover of 95 %", min(covers), 92.0, ">=", "%"
        )


def _wandering(rng: np.random.Generator, cycles: int) -> Array:
    """(C, 101) smooth differences of cycles, 1.5 degrees."""
    phases = rng.uniform(0.0, 2.0 * np.pi, (cycles, 3, 1))
    sizes = 1.5 * rng.standard_normal((cycles, 3, 1)) * np.sqrt(2.0 / 3.0)
    turns = np.arange(1, 4)[:, None] * np.linspace(0.0, 2.0 * np.pi, POINTS)
    return np.asarray((sizes * np.sin(turns + phases)).sum(axis=1))


def _gps_of(curves: Array) -> Mean:
    """The GPS of cycles of the left knee with a stated shift, against a norm of zero."""
    cycle, key = Cycle(1, 0.0, 0.6, 1.0, 0.5, 0.1), Key(ANGLE, "knee_angle")
    shift = np.full_like(curves, SHIFT_DEG)
    side = SideCycles(
        1,
        (SessionCycle("made", cycle, True, True, True, True),) * len(curves),
        {key: Curves("deg", curves, shift, shift, np.zeros_like(curves))},
    )
    gait = MovementGroup(TrialKind.WALK, ("made",), (SideCycles(0, (), {}), side), ())
    norms = Norms(
        "zero", {("walk", ANGLE, "knee_angle"): Band("deg", 2, np.zeros(POINTS), np.ones(POINTS))}, {}
    )
    scores = gait_scores(gait, norms)
    assert scores is not None and scores.sides[1] is not None
    return scores.sides[1].gps


def score_rows() -> Iterator[Check]:
    """Largest differences of the scores."""
    scores = gait_scores(made_gait(), made_norms())
    assert scores is not None and scores.gps is not None
    found, gps, indices = [], [], []
    for side in scores.sides:
        assert side is not None and side.gdi is not None
        found.append([float(side.gvs[name].mean[0]) for name in VARIABLES])
        gps.append(float(side.gps.mean[0]))
        indices.append(float(side.gdi.mean[0]))
    theirs = np.array(SCORES_DEG)
    yield Check(
        "profile of 2 x 9 variables", float(np.abs(np.array(found) - theirs).max()), DIGIT, "<=", "deg"
    )
    by_side = np.sqrt((theirs**2).mean(axis=1))
    yield Check("GPS of right and left", float(np.abs(np.array(gps) - by_side).max()), DIGIT, "<=", "deg")
    both = np.sqrt(((theirs[1] ** 2).sum() + (theirs[0, 3:] ** 2).sum()) / 15.0)
    yield Check("GPS of both, 15 variables", abs(float(scores.gps.mean[0]) - both), DIGIT, "<=", "deg")
    yield from _cover_rows()
    yield Check("GDI of right and left", float(np.abs(np.array(indices) - INDICES).max()), DIGIT, "<=")
