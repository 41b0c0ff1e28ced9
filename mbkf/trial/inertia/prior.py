"""Prior of segment masses and centres of mass: the spread of people about the table."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.inertial_regressor import PER_OWN, InertialRegressor
from mbkf.model.sides import mirrored
from mbkf.numerics.correlated_regression import Belief

MASS_SD = 0.1
"""Standard deviation of a segment's mass about the table's, relative."""

CENTRE_SD = 0.1
"""The same of its centre of mass in each direction, in units of the centre's distance from the segment's origin."""

LEAST_CENTRE_M = 0.005
"""Standard deviation of a centre of mass, at least."""

SIDES_ALIKE = 0.9
"""Correlation of right and left limbs in their difference from the table."""

WHOLE_SD = 0.01
"""Standard deviation of the whole mass, relative: clothes, shoes, scales."""

PLACE_SD_M = 0.003
"""Standard deviation of the place of plates against the body in a trial, forward and sideways: calibration of both, and
skin that stays aside for the whole trial."""

PLACE = 2
"""Numbers that state the place of the plates in a trial."""


def inertia_prior(regressor: InertialRegressor, trials: int) -> Belief:
    """The parameters (4 S + 2 K) before any trial: differences of segments from the table, and plates' places.

    Args:
        regressor: The body by the table.
        trials: K of them.
    """
    names, table = regressor.names, regressor.table().reshape(len(regressor.names), -1)
    masses = table[:, 0]
    lever = np.linalg.norm(table[:, 1:4], axis=1) / masses
    sd = np.column_stack([np.full(len(names), MASS_SD), *[np.maximum(CENTRE_SD * lever, LEAST_CENTRE_M)] * 3])
    covariance = np.diag(np.append(sd.ravel() ** 2, np.full(PLACE * trials, PLACE_SD_M**2)))
    mirror = np.array([1.0, 1.0, -1.0, 1.0])
    for s, name in enumerate(names):
        other = mirrored(name)
        if other != name and other in names:
            rows = PER_OWN * s + np.arange(PER_OWN)
            columns = PER_OWN * names.index(other) + np.arange(PER_OWN)
            covariance[rows, columns] = SIDES_ALIKE * mirror * sd[s] * sd[names.index(other)]
    share = np.zeros(len(covariance))
    share[: PER_OWN * len(names) : PER_OWN] = masses / masses.sum()
    precision: Array = np.linalg.inv(covariance) + np.outer(share, share) / WHOLE_SD**2
    return Belief(np.zeros(len(share)), precision)
