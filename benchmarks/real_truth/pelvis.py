"""The pelvis's tilt by its markers alone: the line from the sacrum to the ASIS, which no body model enters."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction


def pelvis_lines(found: Reconstruction) -> Array:
    """(2,) mean inclination of the body's pelvis, and of the line from the rear to the front markers on it.

    Degrees, backward positive, whatever axes angles are read in. The line is NaN where less than three markers of the
    pelvis are worn.

    Args:
        found: A reconstruction.
    """
    forward = Rotation.from_quat(found.q[found.tracked, 3:7]).apply([1.0, 0.0, 0.0])
    tilt = _inclined(forward)
    depth = {one.name: one.position_m[0] for one in found.subject.markers if one.segment == "pelvis"}
    worn = [i for i, name in enumerate(found.marker_names) if name in depth]
    x = np.array([depth[found.marker_names[i]] for i in worn])
    if len(worn) < 3:
        return np.array([tilt, np.nan])
    seen, front = found.measured_m[:, worn], x > 0.5 * (x.min() + x.max())
    line = seen[:, front].mean(axis=1) - seen[:, ~front].mean(axis=1)
    return np.array([tilt, _inclined(line)])


def _inclined(directions: Array) -> float:
    """Mean angle of directions (T, 3) above the horizontal, degrees."""
    angle = np.arctan2(directions[:, 2], np.hypot(directions[:, 0], directions[:, 1]))
    return float(np.degrees(np.nanmean(angle)))
