"""The spread of segments about the table: its size, limbs that are alike, and a whole mass that is known."""

import numpy as np
import pytest

from mbkf.model.inertia_spread import LEAST_CENTRE_M, SIDES_ALIKE, inertia_precision
from mbkf.model.inertial_regressor import PER_OWN, PER_SEGMENT, InertialRegressor
from tests.motions import reference_model

REGRESSOR = InertialRegressor(reference_model())
NAMES, TABLE = REGRESSOR.names, REGRESSOR.table().reshape(-1, PER_SEGMENT)
MASS_SD, CENTRE_SD = 0.15, 0.1
SHARE = np.zeros(PER_OWN * len(NAMES))
SHARE[::PER_OWN] = TABLE[:, 0] / TABLE[:, 0].sum()


def covariance(whole_sd):
    return np.linalg.inv(inertia_precision(REGRESSOR, MASS_SD, CENTRE_SD, whole_sd))


@pytest.mark.parametrize("whole_sd", [1e-4, 0.01])
def test_the_whole_mass_is_known_as_well_as_stated(whole_sd):
    """Segments that differ make up for one another."""
    found = covariance(whole_sd)
    assert np.sqrt(SHARE @ found @ SHARE) == pytest.approx(whole_sd, rel=0.05)
    trunk = PER_OWN * NAMES.index("torso")
    assert 0.5 * MASS_SD < np.sqrt(found[trunk, trunk]) < MASS_SD


def test_without_a_known_whole_mass_each_segment_has_its_own_spread():
    """Masses in shares of themselves, centres in shares of their distance, the latter at least a few millimetres."""
    sd = np.sqrt(np.diag(covariance(1e6))).reshape(-1, PER_OWN)
    np.testing.assert_allclose(sd[:, 0], MASS_SD, rtol=1e-6)
    lever = np.linalg.norm(TABLE[:, 1:4], axis=1) / TABLE[:, 0]
    expected = np.maximum(CENTRE_SD * lever, LEAST_CENTRE_M)
    assert expected.min() == LEAST_CENTRE_M < expected.max()
    np.testing.assert_allclose(sd[:, 1:], expected[:, None] * np.ones(3), rtol=1e-6)


def test_limbs_differ_from_the_table_alike():
    """Masses and centres go together; one further left on the left with one further right on the right."""
    found = covariance(1e6)
    right, left = (PER_OWN * NAMES.index(f"{side}_forearm") for side in ("right", "left"))
    sd = np.sqrt(np.diag(found))
    correlation = found / np.outer(sd, sd)
    own = correlation[right : right + PER_OWN, left : left + PER_OWN]
    np.testing.assert_allclose(own, SIDES_ALIKE * np.diag([1.0, 1.0, -1.0, 1.0]), atol=1e-9)
    trunk = PER_OWN * NAMES.index("torso")
    np.testing.assert_allclose(correlation[right : right + PER_OWN, trunk : trunk + PER_OWN], 0.0, atol=1e-9)
