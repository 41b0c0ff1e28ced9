"""The trunk's moments of a trial: feet that bear exactly the motion, and loads that are not measured."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.inverse_dynamics import inverse_dynamics
from mbkf.io.contacts import Source
from mbkf.io.result_groups import Reactions, Torques
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.newton_euler import NewtonEuler
from mbkf.trial.results.reactions import GroundReactions
from mbkf.trial.results.supports import support_loads
from mbkf.trial.results.trunk import trunk_moments
from tests.motions import assert_near, random_model, smooth_motion, track_of, worst

FRAMES = 5
NAMES = ("lumbar_extension", "lumbar_bending", "lumbar_rotation")


@pytest.fixture(scope="module")
def scene():
    """A body, its track, and loads on the feet that are the motion's."""
    rng = np.random.default_rng(3)
    model = random_model(rng)
    q, v, a = smooth_motion(model, rng).frames(FRAMES, 20.0)
    balance, wrench = NewtonEuler(model), np.zeros((FRAMES, 2, 6))
    for t in range(FRAMES):
        wrench[t, 0] = rng.normal(size=6) * 100.0
        J = model.spatial_jacobian(q[t])[:, :6]
        wrench[t, 1] = np.linalg.solve(J.T, balance.tau(q[t], v[t], a[t], wrench[t].ravel())[:6])
    bearing = np.full((FRAMES, len(model.description.bearings), 6), np.nan)
    return model, track_of(q, v, a, support=bearing, wrench=wrench)


def loaded(model, track, judged=None):
    """Loads and torques of a track by its own wrenches."""
    found = inverse_dynamics(model, track, track.wrench, track.support)
    torques = Torques(
        tau=found.tau,
        sd_tau=found.tau,
        sd_tau_offset=found.tau,
        residual_force_n=found.residual_force_n,
        residual_moment_nm=found.residual_moment_nm,
    )
    nothing = np.full((FRAMES, 2, 3), np.nan)
    feet = Reactions(
        foot_wrench=track.wrench,
        foot_cop_m=nothing,
        foot_free_moment_nm=nothing[..., 0],
        foot_source=np.full((FRAMES, 2), Source.MEASURED),
    )
    every = np.ones(FRAMES, dtype=bool)
    judged = every if judged is None else judged
    supports = support_loads((), np.zeros((FRAMES, 0, 6)))
    return GroundReactions(feet, supports, torques, every, every, judged, ())


def test_both_ways_agree_where_the_body_obeys_newton(scene):
    model, track = scene
    found = trunk_moments(model, track, loaded(model, track))
    assert found.level_names == ("T12/L1", "L3/L4", "L5/S1")
    assert found.level_columns == ("t12_l1", "lumbar", "l5_s1")
    assert found.trunk_moments.shape == (FRAMES, 2, 3, 3)
    assert_near(found.trunk_moments[:, 0], found.trunk_moments[:, 1], 1e-9 * worst(found.trunk_moments))
    assert worst(found.trunk_moments[:, 0, 2] - found.trunk_moments[:, 0, 0]) > 5.0


def test_at_the_bodys_own_joint_they_are_the_coordinates_moments(scene):
    model, track = scene
    ground, clinical = loaded(model, track), ClinicalAngles(model)
    expected = clinical.moments(track.q, ground.torques.tau)[
        :, [clinical.names.index(name) for name in NAMES]
    ]
    found = trunk_moments(model, track, ground).trunk_moments
    assert_near(found[:, 0, 0], expected, 1e-9 * worst(expected))


def test_loads_in_the_hands_that_are_estimated_count(scene):
    model, track = scene
    names = list(model.description.bearings)
    support = track.support.copy()
    support[:, names.index("right_hand")] = [0.0, 0.0, -70.0, -10.0, 20.0, 0.0]
    wrench = track.wrench.copy()
    wrench[:, 1] -= support[:, names.index("right_hand")]
    carrying = replace(track, support=support, wrench=wrench)
    found = trunk_moments(model, carrying, loaded(model, carrying)).trunk_moments
    assert_near(found[:, 0], found[:, 1], 1e-9 * worst(found))
    plain = trunk_moments(model, track, loaded(model, track)).trunk_moments
    assert worst(found[:, 0, 2] - plain[:, 0, 2]) > 5.0


def test_bottom_up_is_not_stated_where_a_load_below_is_not_measured(scene):
    model, track = scene
    judged = np.array([True, False, True, True, True])
    support = track.support.copy()
    support[3, list(model.description.bearings).index("pelvis")] = [0.0, 0.0, 200.0, 0.0, 0.0, 0.0]
    seated = replace(track, support=support)
    found = trunk_moments(model, seated, loaded(model, seated, judged)).trunk_moments
    assert np.isnan(found[[1, 3], 1]).all() and np.isfinite(found[[0, 2, 4], 1]).all()
    assert np.isfinite(found[:, 0]).all()


def test_spreads_are_turned_with_the_moments_and_end_where_these_do(scene):
    model, track = scene
    sd = np.tile([3.0, 3.0, 3.0], (FRAMES, 2, 3, 1))
    known = replace(track, level_sd=sd, level_offset=0.5 * sd)
    judged = np.array([True, True, False, True, True])
    found = trunk_moments(model, known, loaded(model, track, judged))
    # extension and rotation are about unit axes of the joint
    np.testing.assert_allclose(found.trunk_moments_sd[judged][..., [0, 2]], 3.0)
    np.testing.assert_allclose(found.trunk_moments_sd_offset[judged][..., 0], 1.5)
    assert np.isnan(found.trunk_moments_sd[2, 1]).all() and np.isfinite(found.trunk_moments_sd[2, 0]).all()
    assert np.isnan(trunk_moments(model, track, loaded(model, track)).trunk_moments_sd).all()


def test_without_torques_there_are_no_moments(scene):
    model, track = scene
    ground = loaded(model, track)
    unknown = replace(ground.torques, tau=np.full_like(ground.torques.tau, np.nan))
    assert np.isnan(trunk_moments(model, track, replace(ground, torques=unknown)).trunk_moments).all()
