"""Orientations of the segments as the table of quaternions that OpenSim's OpenSense reads.

A column is called after its segment, ``right_thigh_imu``, and holds the quaternion w, x, y, z of the segment's axes in
OpenSim's (x forward, y up, z right): the orientation of the body of that name in the exported model. OpenSense takes it
for a sensor whose axes are the body's.
"""

from __future__ import annotations

import numpy as np

from mbkf.io.results import Reconstruction
from mbkf.io.written import MARK
from mbkf.model.body import Body
from mbkf.model.osim import osim_name, to_osim_axes
from mbkf.model.segment_poses import segment_poses

SENSOR = "_imu"
"""Ends the names of columns, as OpenSense expects."""


def orientations_text(r: Reconstruction, model: Body) -> str:
    """The table, with a row for every frame in which the body is followed.

    Args:
        r: The result.
        model: Its body.
    """
    rows = r.tracked & np.isfinite(r.q).all(axis=1)
    quaternions = segment_poses(model, r.q[rows])[:, :, 3:]
    vectors = to_osim_axes(quaternions[:, :, :3])
    turned = np.concatenate([quaternions[:, :, 3:], vectors], axis=2)
    heading = [f"Source={MARK}", f"DataRate={r.rate_hz:.9g}", "DataType=Quaternion", "version=3", "endheader"]
    names = ["time", *(osim_name(segment) + SENSOR for segment in model.joints)]
    lines = (
        [f"{time_s:.9g}", *(",".join(f"{one:.12g}" for one in segment) for segment in frame)]
        for time_s, frame in zip(r.times_s[rows], turned, strict=True)
    )
    return "\n".join([*heading, "\t".join(names), *("\t".join(line) for line in lines), ""])
