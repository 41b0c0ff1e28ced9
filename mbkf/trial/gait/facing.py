"""Direction in which a person faces over a trial: the axes of reported ground reactions."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.trial.gait.events import feet_in_motion

FACING_S = 0.5
"""Standard deviation of the window over which the direction a person faces is averaged."""


def facing(r: Reconstruction) -> Array:
    """(T, 3, 3) rows: horizontally forward as the pelvis faces on average over a second or so, left, up."""
    from scipy.ndimage import gaussian_filter1d

    forward = feet_in_motion(r).forward
    known = np.flatnonzero(~np.isnan(forward).any(axis=1))
    frames = np.arange(r.frames)
    filled = np.column_stack([np.interp(frames, known, forward[known, axis]) for axis in range(2)])
    x, y = gaussian_filter1d(filled, FACING_S * r.rate_hz, axis=0, mode="nearest").T
    n = np.maximum(np.hypot(x, y), 1e-9)
    axes = np.zeros((r.frames, 3, 3))
    axes[:, 0, 0], axes[:, 0, 1] = x / n, y / n
    axes[:, 1, 0], axes[:, 1, 1] = -y / n, x / n
    axes[:, 2, 2] = 1.0
    return axes
