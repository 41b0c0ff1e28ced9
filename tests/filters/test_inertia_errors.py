"""Errors by segment masses and centres of mass: against inverse dynamics of bodies that differ so."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.filters import inertia_errors
from mbkf.filters.inertia_errors import KEPT_VARIANCE, InertiaErrors
from mbkf.model.inertia_spread import CENTRE_SD, MASS_SD, WHOLE_SD, inertia_precision
from mbkf.model.inertial_regressor import PER_OWN, PER_SEGMENT, InertialRegressor
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
REGRESSOR = InertialRegressor(MODEL)
IDS = [MODEL.joint(name).joint_id for name in REGRESSOR.names]
RNG = np.random.default_rng(3)
MOTION = moderate_pose(MODEL, RNG), RNG.normal(size=MODEL.nv), 10.0 * RNG.normal(size=MODEL.nv)


def forces(difference, motion=MOTION):
    """(nv,) inverse dynamics of a body whose segments differ from the table by (4 S,)."""
    model = MODEL.pin_model.copy()
    parameters, _ = REGRESSOR.own(difference)
    for joint, own in zip(IDS, parameters.reshape(-1, PER_SEGMENT), strict=True):
        model.inertias[joint] = pin.Inertia.FromDynamicParameters(own)
    return np.array(pin.rnea(model, model.createData(), *motion))


def by_difference(h=1e-6):
    """(nv, 4 S) derivative of the forces by finite differences."""
    steps = h * np.eye(PER_OWN * len(IDS))
    return np.array([(forces(step) - forces(-step)) / (2.0 * h) for step in steps]).T


@pytest.fixture
def everything(monkeypatch):
    """Errors of which no direction is left out."""
    monkeypatch.setattr(inertia_errors, "KEPT_VARIANCE", 1.0 - 1e-12)
    return InertiaErrors(MODEL)


def test_they_are_the_derivative_times_the_spread(everything):
    """Y L Lᵀ Yᵀ against finite differences of the Newton–Euler algorithm by masses and centres."""
    precision = inertia_precision(REGRESSOR, MASS_SD, CENTRE_SD, WHOLE_SD)
    slope = by_difference()
    expected = slope @ np.linalg.solve(precision, slope.T)
    found = everything.at(*MOTION)
    sd = np.sqrt(np.diag(expected))
    assert (np.abs(found @ found.T - expected) <= 1e-5 * np.outer(sd, sd)).all()


def test_errors_of_drawn_bodies_are_as_large(everything):
    """Bodies drawn from the spread, at full size: the second order of masses times centres stays small."""
    root = np.linalg.inv(np.linalg.cholesky(inertia_precision(REGRESSOR, MASS_SD, CENTRE_SD, WHOLE_SD))).T
    rng, right = np.random.default_rng(0), forces(np.zeros(len(root)))
    errors = np.array([forces(root @ rng.normal(size=len(root))) - right for _ in range(400)])
    sd = np.linalg.norm(everything.at(*MOTION), axis=1)
    np.testing.assert_allclose(errors.std(axis=0) / sd, 1.0, atol=0.15)


def test_the_weight_of_the_whole_body_is_as_well_known_as_its_mass():
    """At rest, the force at the root is the whole weight; what one segment has more, others have less."""
    still = np.zeros(MODEL.nv)
    found = InertiaErrors(MODEL).at(MOTION[0], still, still)
    weight = np.linalg.norm(forces(np.zeros(PER_OWN * len(IDS)), (MOTION[0], still, still))[:3])
    assert np.linalg.norm(found[:3]) == pytest.approx(WHOLE_SD * weight, rel=0.05)


def test_few_directions_keep_nearly_all_of_every_force(monkeypatch):
    few = InertiaErrors(MODEL).at(*MOTION)
    monkeypatch.setattr(inertia_errors, "KEPT_VARIANCE", 1.0 - 1e-12)
    own = InertiaErrors(MODEL).at(*MOTION)
    assert few.shape[1] < own.shape[1]
    kept = (few**2).sum(axis=1) / (own**2).sum(axis=1)
    assert kept.mean() > 2.0 * KEPT_VARIANCE - 1.0, "directions were chosen on other motions"
    assert kept.min() > 0.9 and kept.max() < 1.0 + 1e-9
