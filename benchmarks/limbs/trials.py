"""Trials that faults of limbs are put into, and the list of cases."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.dynamic.captures import Source
from benchmarks.limbs.faults import KINDS
from benchmarks.loads.trials import ALL_SOURCES
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

LONGEST_S = 1.5
"""Trials are cut to this."""

CHOSEN_ON = ("walk 1", "squat 1", "turn 1", "opencap", "gait2354")
SHOWN_ON = (
    "walk 2",
    "jump 2",
    "step_up 2",
    "reach 2",
    "rajagopal walk",
    "judgement walk",
    "knee challenge 1",
    "bmc run",
    "biobuddy",
    "HC032A",
)
MORE: Mapping[str, Source] = {
    "HC032A": Source(
        "biomechzoo_walk_turn", "HC032A_Straight_HC032A03.c3d", 60.3, "HC032A_Static_HC032A01.c3d"
    )
}
LIMBS = ("left_thigh", "right_thigh", "left_upper_arm", "right_upper_arm")
NUMBER = 120


@dataclass(frozen=True)
class Case:
    """A trial with a fault, or without.

    Attributes:
        data: Folder of the reference captures.
        trial: One of :data:`CHOSEN_ON` or :data:`SHOWN_ON`.
        kind: One of :data:`benchmarks.limbs.faults.KINDS`; empty for a clean trial.
        limb: The limb.
        at: Share of the trial at which the fault begins; 0: at the start.
        seed: Of the choice of names.
    """

    data: Path
    trial: str
    kind: str = ""
    limb: str = ""
    at: float = 0.0
    seed: int = 0

    @property
    def label(self) -> str:
        """Name in rows."""
        return f"{self.trial}, {self.limb} {self.kind} at {self.at:.2f}" if self.kind else self.trial


@cache
def loaded(data: Path, trial: str) -> tuple[Capture, Subject]:
    """Capture, cut, and person."""
    if trial.split(maxsplit=1)[0] in ("walk", "squat", "turn", "jump", "step_up", "reach"):
        motion, seed = trial.split()
        subject, made = synthesise(motion, seed=int(seed))
        return _cut(made.trial), subject
    source = {**ALL_SOURCES, **MORE}[trial]
    folder = data / source.folder
    capture = read_capture(folder / source.trial, forces=source.forces and folder / source.forces)
    static = None if source.static is None else read_capture(folder / source.static)
    return _cut(capture), scale(static, [capture] if static is None else [], mass_kg=source.mass_kg)


def _cut(capture: Capture) -> Capture:
    """The middle of a capture."""
    positions, rate = capture.markers.positions_m, capture.markers.rate_hz
    frames = min(len(positions), round(LONGEST_S * rate))
    begin = (len(positions) - frames) // 2
    return replace(
        capture, markers=replace(capture.markers, positions_m=positions[begin : begin + frames]), plates=()
    )


def cases(data: Path, quick: bool, seed: int) -> list[Case]:
    """120 cases: kinds, limbs and trials in turn, a third of them at the start.

    Args:
        data: Folder of the reference captures.
        quick: Every fifth of them.
        seed: Of frames and names.
    """
    rng, trials = np.random.default_rng(seed), [*CHOSEN_ON, *SHOWN_ON]
    found = []
    for k in range(NUMBER):
        limb = LIMBS[(k // len(KINDS)) % len(LIMBS)]
        at = 0.0 if k % 3 == (k // len(KINDS)) % 3 else float(rng.uniform(0.1, 0.6))
        found.append(Case(data, trials[k % len(trials)], KINDS[(k + k // 30) % len(KINDS)], limb, at, k))
    return found[::5] if quick else found


def clean(data: Path, quick: bool) -> list[Case]:
    """The trials without a fault."""
    found = [Case(data, trial) for trial in (*CHOSEN_ON, *SHOWN_ON)]
    return found[::5] if quick else found
