"""The prior of segments: limbs are alike, the whole mass is known, places of plates stand apart."""

import numpy as np

from mbkf.model.inertia_spread import SIDES_ALIKE
from mbkf.model.inertial_regressor import PER_OWN, PER_SEGMENT, InertialRegressor
from mbkf.trial.inertia.prior import PLACE, PLACE_SD_M, WHOLE_SD, inertia_prior
from tests.motions import reference_model

REGRESSOR = InertialRegressor(reference_model())
SIZE = PER_OWN * len(REGRESSOR.names)
PRIOR = inertia_prior(REGRESSOR, 2)


def test_the_whole_mass_is_known_better_than_its_parts():
    share = REGRESSOR.table()[::PER_SEGMENT] / REGRESSOR.table()[::PER_SEGMENT].sum()
    masses = PRIOR.covariance[:SIZE:PER_OWN, :SIZE:PER_OWN]
    assert 0.9 * WHOLE_SD < np.sqrt(share @ masses @ share) < WHOLE_SD


def test_limbs_differ_from_the_table_alike():
    """A centre of mass further left on the left goes with one further right on the right."""
    first, second = (PER_OWN * REGRESSOR.names.index(f"{side}_shank") for side in ("right", "left"))
    covariance = PRIOR.covariance
    sd = np.sqrt(np.diag(covariance))
    for k, sign in ((1, 1.0), (2, -1.0), (3, 1.0)):
        found = covariance[first + k, second + k] / sd[first + k] / sd[second + k]
        np.testing.assert_allclose(found, sign * SIDES_ALIKE, atol=1e-9)


def test_places_of_plates_are_trials_own():
    places = PRIOR.covariance[SIZE:, SIZE:]
    np.testing.assert_allclose(places, PLACE_SD_M**2 * np.eye(2 * PLACE), atol=1e-15)
    assert not PRIOR.mean.any()
