"""Spread of people's segment masses and centres of mass about the table, at a whole mass that is known."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.inertial_regressor import PER_OWN, InertialRegressor
from mbkf.model.sides import mirrored

MASS_SD, CENTRE_SD, WHOLE_SD = 0.15, 0.1, 0.01
"""Standard deviations of a segment's mass, relative, of its centre of mass, in units of its distance from the segment's
origin, and of the whole mass, relative."""

LEAST_CENTRE_M = 0.005
"""Standard deviation of a centre of mass, at least."""

SIDES_ALIKE = 0.9
"""Correlation of right and left limbs in their difference from the table."""


def inertia_precision(
    regressor: InertialRegressor, mass_sd: float, centre_sd: float, whole_sd: float
) -> Array:
    """(4 S, 4 S) inverse covariance of the segments' differences from the table.

    Args:
        regressor: The body by the table.
        mass_sd: Standard deviation of a segment's mass about the table's, relative.
        centre_sd: The same of its centre of mass in each direction, in units of the centre's distance from the
            segment's origin.
        whole_sd: Standard deviation of the whole mass, relative: clothes, shoes, scales.
    """
    names, table = regressor.names, regressor.table().reshape(len(regressor.names), -1)
    masses = table[:, 0]
    lever = np.linalg.norm(table[:, 1:4], axis=1) / masses
    sd = np.column_stack([np.full(len(names), mass_sd), *[np.maximum(centre_sd * lever, LEAST_CENTRE_M)] * 3])
    covariance = np.diag(sd.ravel() ** 2)
    mirror = np.array([1.0, 1.0, -1.0, 1.0])
    for s, name in enumerate(names):
        other = mirrored(name)
        if other != name and other in names:
            rows = PER_OWN * s + np.arange(PER_OWN)
            columns = PER_OWN * names.index(other) + np.arange(PER_OWN)
            covariance[rows, columns] = SIDES_ALIKE * mirror * sd[s] * sd[names.index(other)]
    share = np.zeros(len(covariance))
    share[::PER_OWN] = masses / masses.sum()
    return np.asarray(np.linalg.inv(covariance) + np.outer(share, share) / whole_sd**2)
