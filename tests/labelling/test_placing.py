"""Points near the places of a segment's markers: their densities against that of ghosts."""

import numpy as np
from scipy.stats import multivariate_normal

from mbkf.labelling.assignment import AssignmentSettings
from mbkf.labelling.placing import log_likelihood_ratio


def test_the_ratio_of_a_point_is_twice_the_log_of_its_marker_s_density_over_that_of_ghosts():
    away, sd = np.array([[0.01, 0.0, 0.02], [0.0, 0.0, 0.0]]), np.array([0.01, 0.03])
    densities = [multivariate_normal(np.zeros(3), s**2).pdf(r) for r, s in zip(away, sd, strict=True)]
    found = log_likelihood_ratio((away**2).sum(axis=1), sd)
    np.testing.assert_allclose(
        found, 2.0 * np.log(np.array(densities) / AssignmentSettings.ghosts_per_m3), rtol=1e-12
    )
