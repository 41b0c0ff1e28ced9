"""Prior of segment masses and centres of mass: the spread of people about the table."""

from __future__ import annotations

import numpy as np

from mbkf.model.inertia_spread import inertia_precision
from mbkf.model.inertial_regressor import InertialRegressor
from mbkf.numerics.correlated_regression import Belief

MASS_SD = 0.1
"""Standard deviation of a segment's mass about the table's, relative."""

CENTRE_SD = 0.1
"""The same of its centre of mass in each direction, in units of the centre's distance from the segment's origin."""

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
    own = inertia_precision(regressor, MASS_SD, CENTRE_SD, WHOLE_SD)
    size, places = len(own), PLACE * trials
    precision = np.eye(size + places) / PLACE_SD_M**2
    precision[:size, :size] = own
    return Belief(np.zeros(size + places), precision)
