"""The gait cycles of one trial: every quantity over 0–100 % of each cycle, per kg of body mass where it is a load."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.contacts import Source
from mbkf.io.results import Reconstruction
from mbkf.io.verdict import LOAD_PARTS
from mbkf.model.description import BodyDescription
from mbkf.model.human import reference_body
from mbkf.trial.gait.convention import BY_MODEL, FOOT_PROGRESSION, Convention
from mbkf.trial.gait.convention import TRUNK as WALKING_TRUNK
from mbkf.trial.gait.convention_angles import ConventionAngles
from mbkf.trial.gait.curves import ENDINGS, SideCurve, side_views
from mbkf.trial.gait.cycles import POINTS, Cycle, Gait, over_cycle
from mbkf.trial.gait.facing import facing
from mbkf.trial.verdict.judge import verdict_of
from mbkf.trial.verdict.parts import LEGS, PELVIS, TRUNK, part_of_segment

FORCES = ("forward", "medial", "upward")
"""Components of a reaction: in the direction the person faces, towards the other foot, up."""

EDGE = 0.025
"""Share of a cycle at both ends in which it does not matter how the foot's load is known: a foot that lands at a
plate's edge is read a frame or two late."""

ANGLE, TORQUE, POWER, REACTION = "angle", "torque", "power", "reaction"
EMG, EMG_ACTIVE = "emg", "emg_active"
"""Envelope of a muscle's electromyogram, and 1 where the muscle is active."""


class Key(NamedTuple):
    """Kind of a curve, e.g. "angle", "torque" or "emg", and its coordinate or muscle without the side."""

    quantity: str
    name: str

    @property
    def is_load(self) -> bool:
        """True for quantities that follow from loads, and so are measured or estimated."""
        return self.quantity != ANGLE and not self.is_emg

    @property
    def is_emg(self) -> bool:
        """True for envelopes and activity of muscles, which a trial may lack."""
        return self.quantity in (EMG, EMG_ACTIVE)


@dataclass(frozen=True)
class Curves:
    """A quantity over cycles.

    Attributes:
        unit: deg, m, N m/kg, W/kg, % of body weight, or V.
        values: (C, 101) over each cycle.
        sd: (C, 101) standard deviations.
        shift_sd: (C, 101) the part of these that repeats in the same posture, and so shifts all cycles alike.
        change_sd: (C, 101) the change of that part with the posture, about its mean over the trial.
        midline: Whether it belongs to the trunk, whose loads depend on both feet.
    """

    unit: str
    values: Array
    sd: Array
    shift_sd: Array
    change_sd: Array
    midline: bool = False


@dataclass(frozen=True)
class SessionCycle:
    """A cycle of a session.

    Attributes:
        trial: Its trial.
        cycle: When it was.
        measured: Whether a plate of its own measured the foot's load throughout: then the leg's torques are measured,
            whatever the other foot stands on.
        valid: Whether the leg's torques are known: measured, or every load estimated well enough.
        body_measured, body_valid: The same of every load on the body, for the trunk's torques.
    """

    trial: str
    cycle: Cycle
    measured: bool
    valid: bool
    body_measured: bool
    body_valid: bool


@dataclass(frozen=True)
class SideCycles:
    """The cycles of one side.

    Attributes:
        side: 0 right, 1 left.
        cycles: C of them.
        curves: The quantities shown.
    """

    side: int
    cycles: tuple[SessionCycle, ...]
    curves: Mapping[Key, Curves]


def cycles_of_trial(
    r: Reconstruction,
    gait: Gait | None,
    side: int,
    convention: Convention = BY_MODEL,
    read: ConventionAngles | None = None,
) -> SideCycles:
    """The cycles of one side of a trial in which the body was followed throughout; NaN where one may not be used.

    Curves of the midline are as either side sees them: those of the left are mirrored.

    Args:
        r: The trial's results.
        gait: Its gait; None: a trial without gait.
        side: 0 right, 1 left.
        convention: Axes and signs of the curves.
        read: The trial's angles in it, where they are known already.
    """
    kept = [] if gait is None else [c for c in gait.of(side) if _within(r, c, r.tracked).all()]
    cycles = tuple(_session_cycle(r, c) for c in kept)
    if not kept:
        return SideCycles(side, (), {})
    whole = frozenset((*r.coordinate_names, *WALKING_TRUNK))
    body, verdict = reference_body(r.subject), verdict_of(r)
    curves = {}
    for curve in [*side_views(r, side, convention, read), *_reactions(r, side)]:
        factor, unit = _shown(curve, r.subject.mass_kg)
        value, sd, shift, change = (
            np.array([over_cycle(r.times_s, factor * each, c) for c in kept])
            for each in (curve.value, curve.sd, curve.offset_sd, curve.change_sd)
        )
        if not verdict.may_use(part_of_curve(body, Key(curve.quantity, curve.name), side)):
            value = np.full_like(value, np.nan)
        curves[Key(curve.quantity, curve.name)] = Curves(unit, value, sd, shift, change, curve.name in whole)
    curves |= _whole_joints(curves, reference_body(r.subject), side)
    return SideCycles(side, cycles, curves)


def part_of_curve(body: BodyDescription, key: Key, side: int) -> str:
    """The part of the verdict that a curve belongs to; loads of arms belong to their motion.

    Args:
        body: The body.
        key: The curve.
        side: 0 right, 1 left.
    """
    if key.quantity == REACTION:
        return LOAD_PARTS[side]
    if key.name == FOOT_PROGRESSION:
        return LEGS[side]
    segments = part_of_segment(body)
    names = (key.name, key.name + ENDINGS[side])
    part = next(
        (
            segments[joint.distal]
            for joint in body.clinical_joints
            if any(one.name in names for one in (*joint.angles, *joint.translations))
        ),
        TRUNK,  # the trunk's net moments by level of the spine
    )
    loads = {PELVIS: LOAD_PARTS[2], TRUNK: LOAD_PARTS[2], **dict(zip(LEGS, LOAD_PARTS, strict=False))}
    return loads.get(part, part) if key.is_load else part


def _whole_joints(curves: Mapping[Key, Curves], body: BodyDescription, side: int) -> dict[Key, Curves]:
    """The power of each joint as a whole, under the joint's name: the sum over its coordinates."""
    found = {}
    for joint in body.clinical_joints:
        if joint.name.endswith(ENDINGS[1 - side]):
            continue
        parts = [
            curves[key]
            for a in joint.angles
            if (key := Key(POWER, a.name.removesuffix(ENDINGS[side]))) in curves
        ]
        if parts:
            found[Key(POWER, joint.name.removesuffix(ENDINGS[side]))] = Curves(
                parts[0].unit,
                np.sum([one.values for one in parts], axis=0),
                np.sqrt(np.sum([one.sd**2 for one in parts], axis=0)),
                np.sqrt(np.sum([one.shift_sd**2 for one in parts], axis=0)),
                np.sqrt(np.sum([one.change_sd**2 for one in parts], axis=0)),
                parts[0].midline,
            )
    return found


def together(parts: list[SideCycles], side: int) -> SideCycles:
    """Cycles of several trials of one side; curves that one of them lacks are left out, but for muscles: there NaN.

    Args:
        parts: The cycles of each trial.
        side: 0 right, 1 left.
    """
    filled = [part for part in parts if part.cycles]
    if not filled:
        return SideCycles(side, (), {})
    every = dict.fromkeys(key for part in filled for key in part.curves)
    keys = [key for key in every if key.is_emg or all(key in part.curves for part in filled)]

    def joined(key: Key) -> Curves:
        unit = next(part.curves[key].unit for part in filled if key in part.curves)
        each = [part.curves.get(key, _unknown(unit, len(part.cycles))) for part in filled]
        return Curves(
            each[0].unit,
            np.concatenate([one.values for one in each]),
            np.concatenate([one.sd for one in each]),
            np.concatenate([one.shift_sd for one in each]),
            np.concatenate([one.change_sd for one in each]),
            each[0].midline,
        )

    cycles = tuple(cycle for part in filled for cycle in part.cycles)
    return SideCycles(side, cycles, {key: joined(key) for key in keys})


def _unknown(unit: str, count: int) -> Curves:
    """A quantity that a trial lacks over so many cycles."""
    unknown = np.full((count, POINTS), np.nan)
    return Curves(unit, unknown, unknown, unknown, unknown)


def _session_cycle(r: Reconstruction, cycle: Cycle) -> SessionCycle:
    """Source of the loads of a cycle; a foot that no plate measured in stance stood beside the plates."""
    edge = np.minimum(r.times_s - cycle.start_s, cycle.end_s - r.times_s) < EDGE * cycle.seconds
    source = r.foot_source[:, cycle.side]
    own = edge | np.isin(source, (Source.NONE, Source.MEASURED))
    measured, body_measured, valid = (
        bool(_within(r, cycle, one).all()) for one in (own, r.measured, r.valid)
    )
    measured = measured and bool(_within(r, cycle, source == Source.MEASURED).any())
    return SessionCycle(r.trial, cycle, measured, measured or valid, body_measured, valid)


def _within(r: Reconstruction, cycle: Cycle, flags: BoolArray) -> BoolArray:
    return flags[(r.times_s >= cycle.start_s) & (r.times_s <= cycle.end_s)]


def _shown(curve: SideCurve, mass_kg: float) -> tuple[float, str]:
    """Factor and unit of the values in a report."""
    if curve.quantity == REACTION:
        return 100.0 / (mass_kg * GRAVITY_M_S2), "% BW"
    if curve.quantity == ANGLE:
        return 1.0, curve.unit
    return 1.0 / mass_kg, f"{curve.unit}/kg"


def _reactions(r: Reconstruction, side: int) -> Iterator[SideCurve]:
    """The reaction on a foot, in the axes of the person."""
    axes = facing(r)
    axes = np.stack([axes[:, 0], axes[:, 1] * (1.0 if side == 0 else -1.0), axes[:, 2]], axis=1)
    unknown = np.full((r.frames, 3), np.nan)
    spreads = [
        unknown if sd is None else np.sqrt(np.einsum("tij,tj->ti", axes**2, sd[:, side, :3] ** 2))
        for sd in (r.foot_wrench_sd, r.foot_wrench_sd_offset, r.foot_wrench_sd_change)
    ]
    force = np.einsum("tij,tj->ti", axes, r.foot_wrench[:, side, :3])
    for k, name in enumerate(FORCES):
        yield SideCurve(REACTION, name, "N", force[:, k], *(sd[:, k] for sd in spreads))


PERCENT = np.linspace(0.0, 100.0, POINTS)
"""(101,) points of a cycle."""
