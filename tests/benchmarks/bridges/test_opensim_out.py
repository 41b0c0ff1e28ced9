"""The comparison with OpenSim's inverse dynamics: our forces for the accelerations of its spline."""

from dataclasses import replace

import numpy as np

from benchmarks.bridges.opensim_out import spline_forces
from mbkf.model.human import HumanModel
from mbkf.model.osim import osim_forces
from tests.recordings import recorded

INNER = slice(10, -10)
"""The spline has no third derivative at its ends, the motions have."""


def test_a_smooth_motion_has_the_forces_of_its_true_accelerations():
    r = recorded("squat", 1.0, 5)
    model = HumanModel.of(r.subject)
    true, found = osim_forces(model, r.q, r.tau), spline_forces(r, model)
    assert np.abs(true[INNER]).max() > 50.0
    np.testing.assert_allclose(found[INNER], true[INNER], atol=0.2)


def test_a_turning_body_needs_the_change_of_its_rate_matrix():
    """A body that spins about the vertical at constant rates of its angles: Ė v is all of its acceleration."""
    r = recorded("squat", 1.0, 5)
    model = HumanModel.of(r.subject)
    spin = np.zeros(model.nv)
    spin[model.root.v] = [0.0, 0.0, 0.0, 0.0, 0.0, 3.0]
    q = np.array([model.integrate(model.neutral(), spin * t) for t in r.times_s])
    still = replace(r, q=q, foot_wrench=np.zeros_like(r.foot_wrench))
    tau = np.array([model.inverse_dynamics(one, spin, np.zeros(model.nv)) for one in q])
    true, found = osim_forces(model, q, tau), spline_forces(still, model)
    np.testing.assert_allclose(found[INNER], true[INNER], atol=1e-3)
