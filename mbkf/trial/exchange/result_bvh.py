"""A reconstruction as a BVH file: the body's segments as joints, each with its rotation in every frame."""

from __future__ import annotations

from pathlib import Path

from mbkf.io.atomic import write_text
from mbkf.io.bvh import BvhJoint, bvh_text
from mbkf.io.results import Reconstruction
from mbkf.trial.exchange.animation import TO_ANIMATION, AnimatedBody, animated_body, held_rows
from mbkf.trial.exchange.even_frames import even_rows


def write_result_bvh(r: Reconstruction, path: str | Path) -> None:
    """Writes a result as a BVH file: cm, y up, z forward; all angles are 0 in the body's neutral posture.

    Frames in which the body is not followed hold the last pose (those before the first one that pose).

    Args:
        r: The result.
        path: The file, replaced whole or not at all.

    Raises:
        InvalidInput: The body is followed in no frame.
        UnknownName: The subject's body is unknown.
        OSError: The file cannot be written.
    """
    body = animated_body(r, held_rows(even_rows(r.times_s, r.rate_hz), r.tracked))
    text = bvh_text(bvh_joints(body), body.root_m, body.rotations, r.rate_hz)
    write_text(path, text)


def bvh_joints(body: AnimatedBody) -> tuple[BvhJoint, ...]:
    """The tree; a segment without children ends twice as far as its centre of mass."""
    joints = []
    for k, (name, parent) in enumerate(zip(body.names, body.parents, strict=True)):
        segment = body.model.description.segment(name)
        end = (
            None
            if k in body.parents
            else 2.0 * TO_ANIMATION @ (body.model.axis_scale(segment) * segment.com_m)
        )
        joints.append(BvhJoint(name, parent, body.offsets_m[k], end))
    return tuple(joints)
