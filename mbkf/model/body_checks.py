"""Whether a body description can be a body: a tree of joints, real inertias, spreads for every degree of freedom."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mbkf.model.description import JOINT_DOF, BodyDescription, Segment

MASS_TOLERANCE = 0.01
"""How far the masses of the segments may sum to something else than the reference mass, as a share of it."""

SHAPE_KINDS = {"limb": 2, "ellipsoid": 6, "tube": 4, "foot": 0, "toes": 0}
"""How many numbers each kind of shape has; a tube a multiple of it."""

_AXES = {"free": 0, "spherical": 0, "universal": 2, "hinge": 1}


def check_body(body: BodyDescription) -> None:
    """Refuses a description that cannot be a body.

    Raises:
        ValueError: With what is wrong where, and what would be right.
    """
    for complaint in _complaints(body):
        raise ValueError(complaint)


def _complaints(body: BodyDescription) -> Iterator[str]:
    yield from _tree(body)
    for segment in body.segments:
        yield from _joint(segment)
        yield from _inertia(segment)
    yield from _masses(body)
    yield from _clinical(body)
    yield from _sole(body)
    yield from _shapes(body)


def _tree(body: BodyDescription) -> Iterator[str]:
    names = [segment.name for segment in body.segments]
    roots = [segment.name for segment in body.segments if segment.parent == "world"]
    if roots != names[:1] or roots != [body.roles.root]:
        yield (
            f"the first segment is the root: its parent is 'world' and it stands in [roles]; segments on the world "
            f"are {roots}, the first one is {names[0]}, the root of [roles] {body.roles.root}"
        )
    chain: list[str] = []
    for segment in body.segments:
        if segment.parent != "world" and segment.parent not in names:
            yield f"segment {segment.name}: its parent '{segment.parent}' is not a segment"
        while chain and chain[-1] != segment.parent:
            chain.pop()
        if segment.parent != "world" and not chain:
            yield (
                f"segment {segment.name} must follow its parent {segment.parent} or a segment that this carries "
                "(depth-first order)"
            )
        chain.append(segment.name)
        if (segment.joint == "free") != (segment.parent == "world"):
            yield f"segment {segment.name}: the root's joint is 'free', no other one's"


def _joint(segment: Segment) -> Iterator[str]:
    where, dof = f"segment {segment.name}", JOINT_DOF[segment.joint]
    axes = segment.axes
    if len(axes) != _AXES[segment.joint] or len(set(axes)) != len(axes) or set(axes) - set("xyz"):
        yield (
            f"{where}: a {segment.joint} joint has {_AXES[segment.joint]} axes out of x, y and z, not '{axes}'"
        )
    for name in ("origin_m", "com_m", "inertia_kg_m2"):
        values = getattr(segment, name)
        if values.shape != (3,) or not np.isfinite(values).all():
            yield f"{where}: {name} needs three finite numbers"
    for name, shown in (
        ("posture_sd_rad", "posture_sd_deg"),
        ("acceleration_sd", "acceleration_sd"),
        ("movement_sd", "movement_sd"),
    ):
        values = getattr(segment, name)
        if values.shape != (dof,) or not (np.isfinite(values).all() and (values >= 0).all()):
            yield f"{where}: {shown} needs {dof} numbers, 0 or more, for its {segment.joint} joint"
    limits = segment.limits_rad
    if limits.shape != (dof, 2) or not (limits[:, 0] < limits[:, 1]).all():
        yield f"{where}: limits_deg needs {dof} pairs [least, greatest] for its {segment.joint} joint"


def _inertia(segment: Segment) -> Iterator[str]:
    moments = np.sort(segment.inertia_kg_m2)
    if not segment.mass_kg > 0:
        yield f"segment {segment.name}: mass_kg must be positive, not {segment.mass_kg}"
    if not (moments > 0).all() or moments[2] > moments[0] + moments[1]:
        yield (
            f"segment {segment.name}: no rigid body has the principal moments {segment.inertia_kg_m2.tolist()}; all "
            "are positive, and the largest is at most the sum of the others"
        )


def _masses(body: BodyDescription) -> Iterator[str]:
    if not (body.reference_mass_kg > 0 and body.reference_height_m > 0):
        yield "reference_mass_kg and reference_height_m must be positive"
    total = sum(segment.mass_kg for segment in body.segments)
    if abs(total - body.reference_mass_kg) > MASS_TOLERANCE * body.reference_mass_kg:
        yield (
            f"the segments' masses sum to {total:.2f} kg, reference_mass_kg is {body.reference_mass_kg:.2f}; give what "
            "is not modelled to the segment that carries it (a pelvis with trunk, head and arms)"
        )


def _clinical(body: BodyDescription) -> Iterator[str]:
    for segment, joint in zip(body.segments, body.clinical_joints, strict=True):
        where = f"clinical joint {joint.name}"
        if joint.proximal != segment.parent:
            yield f"{where}: {segment.name} hangs on {segment.parent}, not on {joint.proximal}"
        turns = segment.axes or "xyz"
        if len(joint.order) != len(turns) or (segment.axes and joint.order != turns):
            yield f"{where}: order '{joint.order}' does not suit a {segment.joint} joint about {', '.join(turns)}"
        along = sorted(angle.axis for angle in joint.translations)
        if along != (["x", "y", "z"] if segment.parent == "world" else []):
            yield f"{where}: the root, and no other joint, has translations along x, y and z"


def _sole(body: BodyDescription) -> Iterator[str]:
    sole = body.sole
    if not sole.heel_x_m < sole.ball_x_m < sole.toe_x_m:
        yield f"sole: heel_x_m {sole.heel_x_m}, ball_x_m {sole.ball_x_m} and toe_x_m {sole.toe_x_m} must grow"
    if not sole.outer_y_m < sole.inner_y_m:
        yield "sole: outer_y_m must lie to the right (less y) of inner_y_m; the sole is that of the right foot"


def _shapes(body: BodyDescription) -> Iterator[str]:
    names = {segment.name for segment in body.segments}
    for shape in body.shapes.values():
        where = f"shape of {shape.segment}"
        if shape.kind not in SHAPE_KINDS:
            yield f"{where}: kind '{shape.kind}' is not one of {', '.join(SHAPE_KINDS)}"
            continue
        count, given = SHAPE_KINDS[shape.kind], len(shape.numbers)
        fits = given % 4 == 0 and given > 4 if shape.kind == "tube" else given == count
        if not fits:
            yield f"{where}: a {shape.kind} has {count}{' n' if shape.kind == 'tube' else ''} numbers, not {given}"
        if shape.kind == "limb" and shape.to not in names:
            yield f"{where}: a limb ends at a segment named by 'to', not '{shape.to}'"
        if shape.kind == "toes" and shape.segment not in body.roles.toes:
            yield f"{where}: only a segment of the role toes is drawn as toes"
        if shape.kind == "foot" and shape.segment not in body.roles.feet:
            yield f"{where}: only a segment of the role feet is drawn as a foot"
