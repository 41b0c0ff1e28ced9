"""A body that moves, prone or upright, and its points as tracks or shuffled in every frame."""

import numpy as np
from scipy.spatial.transform import Rotation

RATE_HZ = 100.0


def poses(model, rng, frames=120, prone=True, swing_rad=0.35, speed_m_s=0.9):
    """(T, nq) poses: every joint swings about neutral with its own period while the body travels along x."""
    start = model.neutral()
    start[:3] = [0.0, 0.0, 0.3 if prone else 1.0]
    start[3:7] = Rotation.from_euler("yz", [np.pi / 2 if prone else 0.0, 0.7]).as_quat()
    swing = rng.uniform(0.3, 1.0, model.nv) * swing_rad
    swing[:6] = [0.0, 0.05, 0.05, 0.1, 0.1, 0.1]
    frequency, phase = rng.uniform(0.6, 1.4, model.nv), rng.uniform(0.0, 2.0 * np.pi, model.nv)
    found = []
    for t in np.arange(frames) / RATE_HZ:
        q = model.integrate(start, swing * np.sin(2.0 * np.pi * frequency * t + phase))
        q[0] += speed_m_s * t
        found.append(q)
    return np.array(found)


def movement(sensor, rng, **kwargs):
    """(T, M, 3) markers of such a body."""
    return np.array([sensor.positions(q) for q in poses(sensor.model, rng, **kwargs)])


def shuffled(positions_m, rng):
    """The same points (T, C, 3) in a new order in every frame, and the marker (T, C) of each."""
    order = np.array([rng.permutation(positions_m.shape[1]) for _ in positions_m])
    return np.take_along_axis(positions_m, order[:, :, None], axis=1), order
