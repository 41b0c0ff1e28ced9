"""Mean specific force over some seconds, turned into a fixed frame by the gyroscope: about 1 g if it is right."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.frames import exponential, multiply, rotate


def mean_force(turns: Array, force: Array) -> float:
    """Median size of the mean of forces (W, L, 3), turned by successive rotations (W, L, 3), rad."""
    q = exponential(turns[:, :-1])
    reach = 1  # products of 1, 2, 4, … successive rotations
    while reach < q.shape[1]:
        q[:, reach:] = multiply(q[:, :-reach], q[:, reach:])
        reach *= 2
    total = force[:, 0] + rotate(q, force[:, 1:]).sum(axis=1)
    return float(np.median(np.sqrt((total**2).sum(axis=1)))) / turns.shape[1]
