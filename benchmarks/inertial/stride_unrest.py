"""Strides of simulated feet that hardly rest: how long the longest accepted one is, and how far they err."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.inertial.stride_feet import KINDS, STAND_S, SimulatedFoot, simulated_foot
from mbkf.errors import InvalidInput
from mbkf.trial.inertial.stride import measure_strides

FEET, QUICK_FEET, LONGEST_M, RMSE_MM = 200, 20, 3.0, 60.0
CUT = 4
"""One foot out of so many is recorded from the middle of its way only, so that it never rests at all."""


@dataclass(frozen=True)
class Measured:
    """Strides of one foot.

    Attributes:
        kind: How it goes.
        accepted: (n, 3) length, true length and stated standard deviation of each stride that was accepted, m.
        refused: How many were not.
        unusable: Whether the whole recording was refused.
    """

    kind: str
    accepted: np.ndarray
    refused: int
    unusable: bool = False


def rows(context: Context) -> list[Check]:
    """The rows of feet that hardly rest."""
    each = (QUICK_FEET if context.quick else FEET) // len(KINDS)
    feet = [(kind, seed) for kind in KINDS for seed in range(each)]
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        found = list(pool.map(measured, *zip(*feet, strict=True)))
    return list(checks([one for one in found if one is not None]))


def measured(kind: str, seed: int) -> Measured:
    """A foot's strides beside the truth.

    Args:
        kind: A key of :data:`benchmarks.inertial.stride_feet.KINDS`.
        seed: Of the foot.
    """
    foot = simulated_foot(kind, seed)
    if seed % CUT == CUT - 1:
        foot = _without_standing(foot)
    try:
        strides = measure_strides([foot.readings]).feet[0].strides
    except InvalidInput:
        return Measured(kind, np.empty((0, 3)), 0, unusable=True)
    ways = [foot.position_m[one.last] - foot.position_m[one.first] for one in strides]
    numbers = [
        (one.length_m, float(np.hypot(way[0], way[1])), one.length_sd_m)
        for one, way in zip(strides, ways, strict=True)
        if not one.doubt
    ]
    return Measured(kind, np.array(numbers).reshape(-1, 3), sum(bool(one.doubt) for one in strides))


def checks(found: list[Measured]) -> Iterator[Check]:
    """The rows of all feet.

    Args:
        found: Every foot.
    """
    every = np.concatenate([one.accepted for one in found])
    head = f"{len(found)} simulated feet that hardly rest"
    yield Check(f"{head}: longest accepted stride", float(every[:, 0].max()), LONGEST_M, "<=", "m")
    yield Check(f"{head}: RMSE of {len(every)} accepted strides", _rmse_mm(every), RMSE_MM, "<=", "mm")
    for kind in KINDS:
        own = [one for one in found if one.kind == kind]
        accepted = np.concatenate([one.accepted for one in own])
        errors = accepted[:, 0] - accepted[:, 1]
        name = f"{len(own)} feet, {kind}"
        yield Check(f"{name}: RMSE", _rmse_mm(accepted), RMSE_MM, "<=", "mm")
        yield Check(
            f"{name}: error by stated sd",
            float(np.sqrt((errors**2 / accepted[:, 2] ** 2).mean())),
            np.inf,
            "<=",
        )
        yield Check(f"{name}: strides refused", float(sum(one.refused for one in own)), np.inf, "<=")
        yield Check(f"{name}: recordings refused", float(sum(one.unusable for one in own)), np.inf, "<=")
        yield Check(f"{name}: accepted strides each", len(accepted) / len(own), np.inf, "<=")


def _rmse_mm(accepted: np.ndarray) -> float:
    return float(1e3 * np.sqrt(((accepted[:, 0] - accepted[:, 1]) ** 2).mean()))


def _without_standing(foot: SimulatedFoot) -> SimulatedFoot:
    """The foot from the middle of its third stride on, until it stops."""
    one = foot.readings
    kept = (one.time_s > STAND_S + 3.0) & (one.time_s < one.time_s[-1] - STAND_S - 2.5)
    cut = replace(
        one,
        time_s=one.time_s[kept],
        specific_force_mps2=one.specific_force_mps2[kept],
        angular_velocity_rad_s=one.angular_velocity_rad_s[kept],
    )
    return SimulatedFoot(foot.kind, cut, foot.position_m[kept])
