"""Cells of the report: angles, torques and forces of both sides in the units, order and signs shown."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.io.results import Reconstruction, varying_sd
from mbkf.model.description import BodyDescription
from mbkf.model.human import reference_body
from mbkf.trial.gait.convention import BY_MODEL
from mbkf.trial.gait.curves import CURVE_PARTS, side_views
from mbkf.trial.gait.facing import facing
from mbkf.viz.convention_words import angle_positive, angle_title, moment_title
from mbkf.viz.language import ENGLISH, words
from mbkf.viz.report.reading import Reading, curve_of
from mbkf.viz.report.spreads import Curve, offsets_known
from mbkf.viz.wording import Wording, wordings


@dataclass(frozen=True)
class JointNames:
    """Joints of a body that are shown together, without their sides.

    Attributes:
        legs: The root and the joints from it to the feet and toes.
        loaded: Joints with a torque: the reaction acts on the foot as a whole, so toes have none of their own.
        upper: All others.
    """

    legs: tuple[str, ...]
    loaded: tuple[str, ...]
    upper: tuple[str, ...]


def joint_names(body: BodyDescription) -> JointNames:
    """The joints of a body in their groups."""
    lower = {body.roles.root, *body.roles.legs, *body.roles.toes}
    names = {entry.distal: entry.name.removesuffix("_r").removesuffix("_l") for entry in body.clinical_joints}
    legs = dict.fromkeys(name for segment, name in names.items() if segment in lower)
    upper = dict.fromkeys(name for segment, name in names.items() if segment not in lower)
    unloaded = {names[segment] for segment in (body.roles.root, *body.roles.toes)}
    return JointNames(tuple(legs), tuple(name for name in legs if name not in unloaded), tuple(upper))


@dataclass(frozen=True)
class Cell:
    """One chart: a quantity of both sides, or of the midline.

    Attributes:
        title, unit, positive: Texts of the chart.
        curves: By side: "r" and "l", or "" alone.
        name: The coordinate without its side; empty for forces.
        caption: The convention.
    """

    title: str
    unit: str
    positive: str
    curves: dict[str, Curve]
    name: str = ""
    caption: str = ""


def leg_angle_cells(r: Reconstruction, joints: Sequence[str], read: Reading) -> list[list[Cell]]:
    """Charts of the legs' angles in the convention's order, those of the midline as each side sees them.

    Args:
        r: The results.
        joints: The body's joints, shown where the convention has no order of its own.
        read: The angles.
    """
    if not read.convention.rows:
        return angle_cells(r, joints, read)
    sides = [
        {one.name: one for one in side_views(r, k, read.convention, read.angles) if one.quantity == "angle"}
        for k in range(len(SIDES))
    ]
    rows = []
    for row in read.convention.rows:
        cells = []
        for name in row:
            title, positive = (
                word(ENGLISH, read.convention, name, words(ENGLISH, section).get(name, ""))
                for word, section in ((angle_title, "coordinates"), (angle_positive, "positive"))
            )
            curves = {
                side: curve_of(r, one[name].value, one[name][4:])
                for side, one in zip(SIDES, sides, strict=True)
                if name in one and np.isfinite(one[name].value).any()
            }
            if curves:
                cells.append(Cell(title, "°", positive, curves, name, read.caption))
        rows.append(cells)
    return [row for row in rows if row]


def angle_cells(r: Reconstruction, joints: Sequence[str], read: Reading | None = None) -> list[list[Cell]]:
    """Charts of angles, one row for each joint.

    Args:
        r: The results.
        joints: The joints, named without their sides.
        read: Angles and signs of a convention; None: the result's.
    """
    read = read or Reading.of(r, BY_MODEL)

    def curve(name: str, words: Wording) -> Curve:
        values, spreads = read.angles.of(name)
        return curve_of(r, words.factor * values, words.factor * spreads)

    return _cells(r, joints, "", curve, read.caption, lambda _, title: title)


def torque_cells(r: Reconstruction, joints: Sequence[str], read: Reading | None = None) -> list[list[Cell]]:
    """Charts of torques per body mass, one row for each joint.

    Args:
        r: The results.
        joints: The joints, named without their sides.
        read: Angles and signs of a convention; None: the result's.
    """
    read = read or Reading.of(r, BY_MODEL)
    convention, per_kg = read.convention, 1.0 / r.subject.mass_kg

    def curve(name: str, _: Wording) -> Curve:
        spreads = [per_kg * r.moment_sd(name, part) for part in CURVE_PARTS]
        return curve_of(r, convention.moment_sign(name[:-2]) * per_kg * r.moment(name), spreads)

    return _cells(r, joints, "N m/kg", curve, read.moment_caption, partial(moment_title, ENGLISH, convention))


def reaction_cells(r: Reconstruction, factor: float, unit: str) -> list[Cell]:
    """Charts of the three components of the reactions: upward, in the direction the person faces, to the left.

    Args:
        r: The results.
        factor: Factor from N to the unit shown.
        unit: The unit shown.
    """
    sd = np.full_like(r.foot_wrench, np.nan) if r.foot_wrench_sd is None else r.foot_wrench_sd
    offset, change = r.foot_wrench_sd_offset, r.foot_wrench_sd_change
    parts = []
    if offsets_known(r) and offset is not None and change is not None:
        parts = [offset, varying_sd(sd, offset, change)]
    feet = {
        side: Curve(*(one[:, k, :3] for one in (r.foot_wrench, sd, *parts))) for k, side in enumerate(SIDES)
    }
    return force_cells(facing(r), feet, factor, unit)


def force_cells(
    axes: Array, forces: dict[str, Curve], factor: float, unit: str, part: str = ""
) -> list[Cell]:
    """Charts of the three components of forces.

    Args:
        axes: (T, 3, 3) rows: forward, to the left, up.
        forces: (T, 3) world force with its spread by side.
        factor: Factor from N to the unit shown.
        unit: The unit shown.
        part: Part of the body, put before the charts' titles.
    """
    cells = []
    for title, axis, positive in (
        ("Vertical", 2, "upward"),
        ("Fore-aft", 0, "forward"),
        ("Sideways", 1, "to the left"),
    ):
        curves: dict[str, Curve] = {}
        for side, (force, *spreads) in forces.items():
            along = np.einsum("tj,tj->t", axes[:, axis], force)
            shown = [
                factor * np.sqrt(np.einsum("tj,tj->t", axes[:, axis] ** 2, sd**2))
                for sd in spreads
                if sd is not None
            ]
            curves[side] = Curve(factor * along, *shown)
        cells.append(Cell(f"{part}, {title.lower()}" if part else title, unit, positive, curves))
    return cells


def _cells(
    r: Reconstruction,
    joints: Sequence[str],
    unit: str,
    curve: Callable[[str, Wording], Curve],
    caption: str,
    title: Callable[[str, str], str],
) -> list[list[Cell]]:
    known_joints = reference_body(r.subject).clinical_joints
    words, rows = wordings(known_joints), []
    segments = {entry.main: entry.distal for entry in known_joints}
    for joint in joints:
        entries = [e for e in known_joints if e.name in (joint, f"{joint}_r")]
        if not entries or _is_unobserved(r, segments[entries[0].main]):
            continue
        row = []
        for angle in entries[0].angles:
            w = words[angle.name]
            names = {"r": angle.name, "l": angle.name[:-2] + "_l"} if w.side else {"": angle.name}
            known = {side: name for side, name in names.items() if name in r.coordinate_names}
            curves = {side: curve(name, words[name]) for side, name in known.items()}
            if any(np.isfinite(one.values).any() for one in curves.values()):
                base = angle.name.removesuffix("_r")
                shown = title(base, w.title)
                positive = w.positive if shown == w.title else ""
                row.append(Cell(shown, unit or w.unit, positive, curves, base, caption))
        if row:
            rows.append(row)
    return rows


def _is_unobserved(r: Reconstruction, segment: str) -> bool:
    return any(name.startswith(f"{segment}_") for name in r.unobserved_dofs)
