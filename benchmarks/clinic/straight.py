"""Straight walks keep all of their gait cycles, and cycles of turns are left out.

The limit was chosen on HC032A, HC044A, rehazenter_walk, functional_walk, rajagopal_walk_run, gait2354_walk and made
turns of seeds 1 to 7; no row is about these.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import mbkf
from benchmarks.angles.archives import Archive
from benchmarks.checks import Check, information
from benchmarks.clinic.convention import WALKS, followed
from mbkf.io.results import Reconstruction
from mbkf.trial.gait.cycles import find_gait, turned_deg
from mbkf.trial.gait.events import feet_in_motion

SHOWN = (
    *(walk for walk in WALKS if walk.name in ("cgm24", "gaitalytics")),
    Archive("unipd", "unipd_walk", "Walking1.c3d", "Static1.c3d", 70.0),
    Archive("gappy", "opensim_gappy_walk", "walking2.c3d", None, 70.0),
)

TURNS = range(101, 107)
"""Seeds of made turns."""


def straight_rows(data: Path) -> Iterator[Check]:
    """Cycles of straight walks and of turns, with the choice of straight walking.

    Args:
        data: Folder of the reference captures.
    """
    for walk in SHOWN:
        yield from _cycles(walk.name, followed(walk, data)[1])
    kept = total = 0
    for seed in TURNS:
        subject, made = mbkf.synthesise("turn", seed=seed, varied=True)
        settings = mbkf.ReconstructSettings(filter="kinematic")
        r = mbkf.reconstruct(replace(made.trial, plates=()), subject, settings=settings)
        whole, straight = find_gait(r), find_gait(r, straight=True)
        total += 0 if whole is None else len(whole.cycles)
        kept += 0 if straight is None else len(straight.cycles)
    yield Check("turns of six made persons: cycles", total, 1, ">=")
    yield Check("turns of six made persons: cycles kept", kept, 0, "<=")


def _cycles(name: str, r: Reconstruction) -> Iterator[Check]:
    whole, straight = find_gait(r), find_gait(r, straight=True)
    if whole is None:
        yield Check(f"{name}: cycles", 0, 1, ">=")
        return
    feet = feet_in_motion(r)
    turned = max(abs(turned_deg(feet, cycle)) for cycle in whole.cycles)
    yield information(f"{name}, straight: the pelvis turns in a cycle by at most", turned, "°")
    lost = len(whole.cycles) - (0 if straight is None else len(straight.cycles))
    yield Check(f"{name}, straight: cycles left out of {len(whole.cycles)}", lost, 0, "<=")
