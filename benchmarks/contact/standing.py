"""Persons who stand and squat with their feet at a given distance, pressed beside the middle of the soles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.model.body import Body
from mbkf.synthesis.contact import Load, LoadPlan
from mbkf.synthesis.curves import sinusoid
from mbkf.synthesis.motions import motion_names, register_motion
from mbkf.synthesis.plan import FeetPlan, MotionPlan
from mbkf.synthesis.squat import squat_plan
from mbkf.synthesis.stand import stand_plan
from mbkf.synthesis.standing import planted, pressed

ASIDE_M = 0.007
"""Distance of the pressure from the middle of the sole: the RMS over both feet of six walkers (HC032A, HC044A,
gaitalytics, Rajagopal's, Rehazenter's, gait2354) while the other foot is in the air and this one flat."""

PERSONS = {"left of the soles": (ASIDE_M, ASIDE_M), "inside the soles": (ASIDE_M, -ASIDE_M)}
"""How far to the left right and left foot are pressed. With σ each, the share's error is σ or 0 over the distance at
equal loads, and √½ σ on the average of both persons, as for independent spreads."""

WIDTHS_M = (0.10, 0.20, 0.30)
SHIFT = 0.15
"""How much of the weight is shifted to and fro between the feet."""

_PLANS: dict[str, Callable[[Body, float, np.random.Generator], MotionPlan]] = {
    "stand": stand_plan,
    "squat": squat_plan,
}


def motion_of(kind: str, width_m: float, person: str) -> str:
    """Name of the registered motion of a person of :data:`PERSONS`.

    Args:
        kind: stand or squat.
        width_m: Distance of the ankles.
        person: Where the feet are pressed.
    """
    name = f"{kind} {100 * width_m:.0f} cm, pressed {person}"
    if name not in motion_names(static=True):
        planner = partial(_plan, kind, width_m, PERSONS[person])
        register_motion(name, seconds=3.0, trial=False)(planner)
    return name


def _plan(
    kind: str,
    width_m: float,
    left_m: tuple[float, float],
    model: Body,
    seconds: float,
    rng: np.random.Generator,
) -> MotionPlan:
    """The motion's usual plan on other feet.

    Args:
        kind: stand or squat.
        width_m: Distance of the ankles.
        left_m: How far to the left right and left foot are pressed.
        model: The body.
        seconds: Duration.
        rng: Source of the differences between persons.
    """
    plan = _PLANS[kind](model, seconds, rng)
    feet = planted(model, 0.5 * width_m, rng.uniform(0, 6), rng)
    return replace(plan, feet=feet, load=_load(feet, left_m, 0.045 * float(model.scale.mean()), rng))


def _load(
    feet: FeetPlan, left_m: tuple[float, float], forward_m: float, rng: np.random.Generator
) -> LoadPlan:
    """Weight that shifts between the feet, each pressed at a place of its own.

    Args:
        feet: Poses of the feet.
        left_m: How far to the left right and left foot are pressed.
        forward_m: How far ahead of the ankles.
        rng: Source of rates and phases.
    """
    share = sinusoid(SHIFT, rng.uniform(0.2, 0.4), rng.uniform(0, 6.28), 0.5)
    forth = sinusoid(0.006, rng.uniform(0.2, 0.5), rng.uniform(0, 6.28), forward_m)

    def load(times: Array) -> Load:
        poses, ahead = feet(times), forth(times).value
        places = [pressed(poses[side], ahead, aside) for side, aside in zip(SIDES, left_m, strict=True)]
        return Load(share(times).value, np.stack(places, axis=1), np.ones(len(times), dtype=bool))

    return load
