"""Checks of a body description: a tree of joints, rigid inertias, a spread for every degree of freedom."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mbkf.conventions import Array
from mbkf.model.description import JOINT_DOF, BodyDescription, Segment

MASS_TOLERANCE = 0.01
"""Greatest difference between the sum of the segments' masses and the reference mass, as a share of the latter."""

ROUNDING = 1e-9
"""Share by which the largest moment may exceed the sum of the others: a flat body's are equal but for rounding."""

SHAPE_KINDS = {"limb": 2, "ellipsoid": 6, "tube": 4, "foot": 0, "toes": 0}
"""Count of numbers of each kind of shape; of a tube, per section."""

_AXES = {"free": 0, "spherical": 0, "universal": 2, "hinge": 1}


def check_body(body: BodyDescription) -> None:
    """Refuses a description that cannot be a body.

    Raises:
        ValueError: The first fault, with its place and the rule it breaks.
    """
    for fault in _faults(body):
        raise ValueError(fault)


def _faults(body: BodyDescription) -> Iterator[str]:
    yield from _tree(body)
    for segment in body.segments:
        where = f"segment {segment.name}"
        yield from (f"{where}: {fault}" for fault in (*_joint(segment), *_inertia(segment)))
    yield from _masses(body)
    yield from _clinical(body)
    yield from _sole(body)
    yield from _levels(body)
    for shape in body.shapes:
        yield from (f"shape of {shape}: {fault}" for fault in _shape(body, shape))


def _tree(body: BodyDescription) -> Iterator[str]:
    names = [segment.name for segment in body.segments]
    roots = [segment.name for segment in body.segments if segment.parent == "world"]
    if roots != names[:1] or roots != [body.roles.root]:
        yield (
            "the first segment, and no other, has the parent 'world' and is the root of [roles]; found: first segment "
            f"{names[0]}, parent 'world' {roots}, root of [roles] {body.roles.root}"
        )
    chain: list[str] = []
    for segment in body.segments:
        if segment.parent != "world" and segment.parent not in names:
            yield f"segment {segment.name}: its parent '{segment.parent}' is not a segment"
        while chain and chain[-1] != segment.parent:
            chain.pop()
        if segment.parent != "world" and not chain:
            yield (
                f"segment {segment.name} must follow its parent {segment.parent} or a segment of the same branch "
                "(depth-first order)"
            )
        chain.append(segment.name)
        if (segment.joint == "free") != (segment.parent == "world"):
            yield (
                f"segment {segment.name}: the root, and no other segment, has a 'free' joint; "
                f"its joint is '{segment.joint}'"
            )


def _joint(segment: Segment) -> Iterator[str]:
    kind, dof, axes = f"{segment.joint} joint", JOINT_DOF[segment.joint], segment.axes
    if len(axes) != _AXES[segment.joint] or len(set(axes)) != len(axes) or set(axes) - set("xyz"):
        yield f"a {kind} has {_AXES[segment.joint]} axes out of x, y and z, not '{axes}'"
    if segment.axis is not None and (segment.joint != "hinge" or not _is_nearest(segment.axis, axes)):
        yield (
            f"axis {segment.axis.tolist()} of a {kind} is not the unit vector of a hinge whose largest component is "
            f"along +{axes}; give such a vector, or leave axis out"
        )
    for name in ("origin_m", "com_m", "inertia_kg_m2", "products_kg_m2"):
        values = getattr(segment, name)
        if values.shape != (3,) or not np.isfinite(values).all():
            yield f"{name} needs three finite numbers"
    for name, values in (
        ("posture_sd_deg", segment.posture_sd_rad),
        ("acceleration_sd", segment.acceleration_sd),
        ("movement_sd", segment.movement_sd),
    ):
        if values.shape != (dof,) or not (np.isfinite(values).all() and (values >= 0).all()):
            yield f"{name} needs {dof} numbers, 0 or more, for its {kind}"
    limits = segment.limits_rad
    if limits.shape != (dof, 2) or not (limits[:, 0] < limits[:, 1]).all():
        yield f"limits_deg needs {dof} pairs [least, greatest] for its {kind}"


def _is_nearest(axis: Array, letter: str) -> bool:
    """True for a unit vector whose largest component is along an axis."""
    unit = axis.shape == (3,) and abs(np.linalg.norm(axis) - 1.0) < ROUNDING
    return bool(unit and "xyz"[int(np.argmax(axis))] == letter and axis.max() >= -axis.min())


def _inertia(segment: Segment) -> Iterator[str]:
    if not all(np.shape(one) == (3,) for one in (segment.inertia_kg_m2, segment.products_kg_m2)):
        return
    moments = np.linalg.eigvalsh(np.nan_to_num(segment.inertia_matrix_kg_m2))
    if not segment.mass_kg > 0:
        yield f"mass_kg must be positive, not {segment.mass_kg}"
    if not (moments > 0).all() or moments[2] > (moments[0] + moments[1]) * (1.0 + ROUNDING):
        shown = segment.inertia_kg_m2 if not segment.products_kg_m2.any() else moments
        yield (
            f"a rigid body cannot have the principal moments {shown.tolist()} kg m²; all are positive, "
            "and the largest is at most the sum of the others"
        )


def _masses(body: BodyDescription) -> Iterator[str]:
    if not (body.reference_mass_kg > 0 and body.reference_height_m > 0):
        yield "reference_mass_kg and reference_height_m must be positive"
    total = sum(segment.mass_kg for segment in body.segments)
    if abs(total - body.reference_mass_kg) > MASS_TOLERANCE * body.reference_mass_kg:
        yield (
            f"the segments' masses sum to {total:.2f} kg, but reference_mass_kg is {body.reference_mass_kg:.2f}; add "
            "the mass of parts without a segment to the segment that carries them (trunk, head and arms to a pelvis)"
        )


def _clinical(body: BodyDescription) -> Iterator[str]:
    for segment, joint in zip(body.segments, body.clinical_joints, strict=True):
        where = f"clinical joint {joint.name}"
        if joint.proximal != segment.parent:
            yield f"{where}: the parent of {segment.name} is {segment.parent}, not {joint.proximal}"
        turns = segment.axes or "xyz"
        if len(joint.order) != len(turns) or (segment.axes and joint.order != turns):
            yield f"{where}: order '{joint.order}' does not suit a {segment.joint} joint about {', '.join(turns)}"
        along = sorted(angle.axis for angle in joint.translations)
        if along != (["x", "y", "z"] if segment.parent == "world" else []):
            yield f"{where}: the root, and no other joint, has translations along x, y and z"


def _levels(body: BodyDescription) -> Iterator[str]:
    root = body.segments[0]
    for level in body.levels:
        if not 0.0 <= level.part_mass_kg < root.mass_kg:
            yield (
                f"level {level.name}: part_mass_kg is a part of the {root.mass_kg:g} kg of {root.name}, "
                f"not {level.part_mass_kg:g} kg"
            )


def _sole(body: BodyDescription) -> Iterator[str]:
    sole = body.sole
    if not sole.heel_x_m < sole.ball_x_m < sole.toe_x_m:
        yield f"sole: heel_x_m {sole.heel_x_m}, ball_x_m {sole.ball_x_m} and toe_x_m {sole.toe_x_m} must grow"
    if not sole.outer_y_m < sole.inner_y_m:
        yield "sole: outer_y_m must lie to the right (less y) of inner_y_m; the sole is that of the right foot"


def _shape(body: BodyDescription, segment: str) -> Iterator[str]:
    shape = body.shapes[segment]
    if shape.kind not in SHAPE_KINDS:
        yield f"kind '{shape.kind}' is not one of {', '.join(SHAPE_KINDS)}"
        return
    count, given, tube = SHAPE_KINDS[shape.kind], len(shape.numbers), shape.kind == "tube"
    if not (given % count == 0 and given > count if tube else given == count):
        yield f"{shape.kind} needs {count}{' n' if tube else ''} numbers, not {given}"
    if shape.kind == "limb" and shape.to not in [one.name for one in body.segments]:
        yield f"a limb ends at a segment named by 'to', not '{shape.to}'"
    if shape.kind == "toes" and segment not in body.roles.toes:
        yield "only a segment of the role toes is drawn as toes"
    if shape.kind == "foot" and segment not in body.roles.feet:
        yield "only a segment of the role feet is drawn as a foot"
