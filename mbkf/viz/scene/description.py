"""The scene's static description (person, markers, plates), and the poses of a frame's segments."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.model.body import Body
from mbkf.viz.scene.body_shapes import as_plain as plain_shapes
from mbkf.viz.scene.body_shapes import segment_shapes
from mbkf.viz.scene.channels import STATUS, Layout, quantities
from mbkf.viz.scene.channels import as_plain as plain_quantities
from mbkf.viz.wording import part_wording


def scene_description(
    title: str,
    model: Body,
    marker_names: tuple[str, ...],
    coordinate_names: tuple[str, ...],
    plate_corners_m: Array,
    layout: Layout,
    streamed: bool,
) -> dict[str, object]:
    """The page's first message, as JSON can hold it.

    Args:
        title: What is shown: trial or subject.
        model: The body.
        marker_names: (M,) markers.
        coordinate_names: (A,) clinical coordinates.
        plate_corners_m: (K, 4, 3) corners of the plates; a plate with NaN is not drawn.
        layout: Of the rows that follow.
        streamed: Whether they come from a stream.
    """
    drawn = plate_corners_m[np.isfinite(plate_corners_m).all(axis=(1, 2))]
    return {
        "title": title,
        "weight_n": round(float(model.mass_kg * GRAVITY_M_S2), 1),
        "segments": plain_shapes(segment_shapes(model)),
        "markers": list(marker_names),
        "loads": [{"name": name, "side": part_wording(name).side} for name in layout.loads],
        "plates": np.round(drawn, 4).tolist(),
        "status": list(STATUS),
        "parts": {name: list(place) for name, place in layout.parts.items()},
        "width": layout.width,
        "quantities": plain_quantities(
            quantities(layout, coordinate_names, model.description.clinical_joints, streamed)
        ),
    }


def segment_poses(model: Body, q: Array) -> Array:
    """(T, S, 7) world position m and quaternion (x, y, z, w) of every segment; NaN where q (T, nq) is NaN.

    Successive quaternions of a segment lie in one hemisphere, so that they can be interpolated and pack well.
    """
    ids = [joint.joint_id for joint in model.joints.values()]
    poses = np.full((len(q), len(ids), 7), np.nan)
    known = np.flatnonzero(~np.isnan(q).any(axis=1))
    if not len(known):
        return poses
    rotations = np.empty((len(known), len(ids), 3, 3))
    for row, t in enumerate(known):
        R, origins = model.placements(q[t])
        rotations[row], poses[t, :, :3] = R[ids], origins[ids]
    quaternions = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_quat().reshape(len(known), len(ids), 4)
    turned = (quaternions[1:] * quaternions[:-1]).sum(axis=2) < 0
    quaternions[1:][np.cumsum(turned, axis=0) % 2 == 1] *= -1.0
    poses[known, :, 3:] = quaternions
    return poses
