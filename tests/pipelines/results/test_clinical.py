"""Clinical coordinates of a followed trial: means and spreads by the same linear maps."""

import numpy as np
import pytest

from mbkf.model.clinical import ClinicalAngles
from mbkf.pipelines.results.clinical import clinical_motion
from tests.motions import random_model, smooth_motion, track_of

FRAMES = 5


@pytest.fixture(scope="module")
def case():
    """Body, track with a random covariance and one frame not followed, torques, and their spreads."""
    rng = np.random.default_rng(1)
    model = random_model(rng)
    q, v, a = smooth_motion(model, rng).frames(FRAMES, 20.0)
    tau, sd_tau = 50 * rng.normal(size=v.shape), rng.uniform(1, 5, v.shape)
    angle_sd, rate_sd = rng.uniform(0.1, 1, v.shape), rng.uniform(0.1, 1, v.shape)
    for values in (q, v, a, tau, sd_tau, angle_sd, rate_sd):
        values[2] = np.nan
    tracked = np.arange(FRAMES) != 2
    track = track_of(q, v, a, angle_sd=angle_sd, rate_sd=rate_sd, tracked=tracked, starts=(0, 3))
    return model, track, tau, sd_tau, clinical_motion(model, track, tau, sd_tau)


KNOWN = [0, 1, 3, 4]


def test_angles_and_names_are_the_clinical_ones(case):
    model, track, _, _, found = case
    clinical = ClinicalAngles(model)
    assert found.names == clinical.names
    np.testing.assert_allclose(found.angles[KNOWN], clinical.angles(track.q)[KNOWN], rtol=1e-14)


def test_frames_not_followed_are_nan_and_not_singular(case):
    found = case[-1]
    for name in ("angles", "rates", "moments", "angles_sd", "rates_sd", "moments_sd"):
        assert np.isnan(getattr(found, name)[2]).all(), name
        assert np.isfinite(getattr(found, name)[KNOWN]).all(), name
    assert not found.singular[2].any()


def test_rates_are_the_slopes_of_the_angles(case):
    model, track, _, _, found = case
    clinical, h = ClinicalAngles(model), 1e-6
    for t in KNOWN:
        ends = np.array([model.integrate(track.q[t], s * h * track.v[t]) for s in (-1, 1)])
        before, after = clinical.angles(ends)
        np.testing.assert_allclose(found.rates[t], (after - before) / (2 * h), rtol=0, atol=2e-8)


def test_moments_do_the_power_of_the_torques(case):
    _, track, tau, _, found = case
    for t in KNOWN:
        assert found.moments[t] @ found.rates[t] == pytest.approx(tau[t] @ track.v[t], rel=1e-11)


def test_spread_of_moments_of_independent_dofs(case):
    """Var m = Σ B² sd_τ² with v = B θ̇, so B = E⁻¹."""
    model, track, _, sd_tau, found = case
    clinical = ClinicalAngles(model)
    for t in KNOWN:
        B = np.linalg.inv(clinical.rate_matrix(track.q[t], found.angles[t]))
        np.testing.assert_allclose(found.moments_sd[t] ** 2, (B.T) ** 2 @ sd_tau[t] ** 2, rtol=1e-9)


def test_long_trials_are_treated_in_blocks(case, monkeypatch):
    """The same rates whatever the size of a block."""
    model, track, tau, sd_tau, found = case
    monkeypatch.setattr("mbkf.pipelines.results.clinical.BLOCK", 3)
    again = clinical_motion(model, track, tau, sd_tau)
    np.testing.assert_array_equal(again.rates, found.rates)
