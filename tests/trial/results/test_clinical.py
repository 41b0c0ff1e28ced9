"""Clinical coordinates of a followed trial: means and spreads by the same linear maps."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.io.result_groups import Torques
from mbkf.model.angle_reading import AngleReading, JointAxes
from mbkf.model.clinical import ClinicalAngles
from mbkf.trial.results.clinical import clinical_motion
from mbkf.trial.results.progression import Progression
from tests.motions import random_model, smooth_motion, track_of

FRAMES = 5


def found_by(model, track, tau, sd_tau, *how):
    """Motion and moments with these torques."""
    offset, unknown = np.where(np.isnan(tau), np.nan, track.torque_offset), np.full((FRAMES, 3), np.nan)
    torques = Torques(
        tau=tau, sd_tau=sd_tau, sd_tau_offset=offset, residual_force_n=unknown, residual_moment_nm=unknown
    )
    motion, moments = clinical_motion(model, track, torques, *how)
    return SimpleNamespace(**vars(motion), **vars(moments))


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
    return model, track, tau, sd_tau, found_by(model, track, tau, sd_tau)


KNOWN = [0, 1, 3, 4]


def test_angles_and_names_are_the_clinical_ones(case):
    model, track, _, _, found = case
    clinical = ClinicalAngles(model)
    assert found.coordinate_names == clinical.names
    np.testing.assert_allclose(found.angles[KNOWN], clinical.angles(track.q)[KNOWN], rtol=1e-14)


def test_frames_not_followed_are_nan_and_not_singular(case):
    found = case[-1]
    for name in ("angles", "angle_rates", "moments", "angles_sd", "angle_rates_sd", "moments_sd"):
        assert np.isnan(getattr(found, name)[2]).all(), name
        assert np.isfinite(getattr(found, name)[KNOWN]).all(), name
    assert not found.singular[2].any()


def test_rates_are_the_slopes_of_the_angles(case):
    model, track, _, _, found = case
    clinical, h = ClinicalAngles(model), 1e-6
    for t in KNOWN:
        ends = np.array([model.integrate(track.q[t], s * h * track.v[t]) for s in (-1, 1)])
        before, after = clinical.angles(ends)
        np.testing.assert_allclose(found.angle_rates[t], (after - before) / (2 * h), rtol=0, atol=2e-8)


def test_moments_do_the_power_of_the_torques(case):
    _, track, tau, _, found = case
    for t in KNOWN:
        assert found.moments[t] @ found.angle_rates[t] == pytest.approx(tau[t] @ track.v[t], rel=1e-11)


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
    monkeypatch.setattr("mbkf.trial.results.clinical.BLOCK", 3)
    again = found_by(model, track, tau, sd_tau)
    np.testing.assert_array_equal(again.angle_rates, found.angle_rates)


def in_frame(case, frame):
    model, track, tau, sd_tau, _ = case
    return found_by(model, track, tau, sd_tau, frame)


def turned_track(model, track, angle_rad):
    """The same motion in a laboratory whose axes are turned back about the vertical."""
    q = ClinicalAngles(model).against(np.full(len(track.q), -angle_rad), track.q)
    x, y = track.q[:, 0], track.q[:, 1]
    q[:, 0] = np.cos(angle_rad) * x - np.sin(angle_rad) * y
    q[:, 1] = np.sin(angle_rad) * x + np.cos(angle_rad) * y
    return replace(track, q=q)


@pytest.fixture(scope="module")
def spread_case(case):
    """The case with the covariance of the root's orientation and the velocities' deviations."""
    model, track, tau, sd_tau, found = case
    rng = np.random.default_rng(2)
    A = 0.1 * rng.normal(size=(FRAMES, 15, 3, 3))
    velocity_sd = rng.uniform(0.1, 1.0, track.v.shape)
    covariance = np.einsum("tnij,tnkj->tnik", A, A)
    return model, replace(track, ball_covariance=covariance, sd_v=velocity_sd), tau, sd_tau, found


STEADY = Progression("progression", np.full(FRAMES, 0.8), np.zeros(FRAMES))


@pytest.mark.parametrize("angle", [0.5, np.pi / 2, np.pi, -2.0])
def test_a_turned_capture_in_its_turned_frame_has_the_same_angles(spread_case, angle):
    """Positions and their forces stay in the laboratory's axes; all else is the same."""
    model, track, tau, sd_tau, _ = spread_case
    clinical = ClinicalAngles(model)
    first = in_frame(spread_case, STEADY)
    turned = Progression("progression", STEADY.heading_rad + angle, STEADY.turning_rad_s)
    second = found_by(model, turned_track(model, track, angle), tau, sd_tau, turned)
    for name in ("angles", "angle_rates", "moments", "angles_sd", "angle_rates_sd", "moments_sd"):
        one, other = (getattr(found, name)[:, clinical.rotational] for found in (first, second))
        if name == "angles":
            one, other = np.exp(1j * one), np.exp(1j * other)
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-9, err_msg=name)


def test_only_the_roots_angles_depend_on_the_frame(spread_case):
    model, track, tau, sd_tau, _ = spread_case
    clinical = ClinicalAngles(model)
    others = np.setdiff1d(np.arange(len(clinical.names)), clinical.root_angles)
    lab, steady = found_by(model, track, tau, sd_tau), in_frame(spread_case, STEADY)
    for name in ("angles", "angle_rates", "moments", "angles_sd", "angle_rates_sd", "moments_sd", "singular"):
        np.testing.assert_array_equal(getattr(lab, name)[:, others], getattr(steady, name)[:, others])
    np.testing.assert_array_equal(steady.angles_lab, lab.angles)
    np.testing.assert_array_equal(lab.angles_lab, lab.angles)
    assert np.abs(lab.angles - steady.angles)[KNOWN][:, clinical.root_angles].max() > 0.1


def test_in_a_steady_frame_moments_do_the_power_of_the_torques(spread_case):
    _, track, tau, _, _ = spread_case
    found = in_frame(spread_case, STEADY)
    for t in KNOWN:
        assert found.moments[t] @ found.angle_rates[t] == pytest.approx(tau[t] @ track.v[t], rel=1e-11)


def test_in_a_turning_frame_rates_are_slopes_against_it_and_power_is_what_is_left(spread_case):
    """m·θ̇ = τ·v − ψ̇ n, with n the root's moment about the vertical."""
    model, track, tau, _, _ = spread_case
    clinical, h, turning = ClinicalAngles(model), 1e-6, np.full(FRAMES, 0.7)
    heading = 0.8 + 0.1 * np.arange(FRAMES)
    found = in_frame(spread_case, Progression("progression", heading, turning))
    for t in KNOWN:
        ends = np.array([model.integrate(track.q[t], s * h * track.v[t]) for s in (-1, 1)])
        seen = clinical.against(heading[t] + turning[t] * np.array([-h, h]), ends)
        before, after = clinical.angles(seen)
        np.testing.assert_allclose(found.angle_rates[t], (after - before) / (2 * h), rtol=0, atol=2e-8)
        about_vertical = tau[t, clinical.root_turns] @ clinical.vertical(track.q[[t]])[0]
        power = tau[t] @ track.v[t] - turning[t] * about_vertical
        assert found.moments[t] @ found.angle_rates[t] == pytest.approx(power, rel=1e-10)


def test_the_roots_spreads_follow_its_own_covariance(spread_case):
    """Var θ = J P Jᵀ by finite differences of the root's angles in the frame, Var θ̇ = Σ E² sd²."""
    model, track, _, _, _ = spread_case
    clinical, h = ClinicalAngles(model), 1e-6
    found = in_frame(spread_case, STEADY)
    for t in KNOWN:
        steps = h * np.eye(model.nv)[clinical.root_turns]
        ends = np.array([[model.integrate(track.q[t], s * step) for s in (-1, 1)] for step in steps])
        angles = [clinical.angles(clinical.against(np.full(2, 0.8), pair)) for pair in ends]
        J = np.array([(after - before) / (2 * h) for before, after in angles]).T[clinical.root_angles]
        variance = np.diag(J @ track.ball_covariance[t, 0] @ J.T)
        np.testing.assert_allclose(found.angles_sd[t, clinical.root_angles] ** 2, variance, rtol=1e-6)
        rate_variance = J**2 @ track.sd_v[t, clinical.root_turns] ** 2
        np.testing.assert_allclose(
            found.angle_rates_sd[t, clinical.root_angles] ** 2, rate_variance, rtol=1e-6
        )


def test_a_reading_changes_angles_their_rates_and_spreads_and_no_moment(spread_case):
    """Spreads come from the covariance of each joint's rotation, read in the turned axes."""
    model, track, tau, sd_tau, _ = spread_case
    hip = JointAxes(*Rotation.from_rotvec([[0.1, 0.2, -0.1], [-0.1, 0.3, 0.2]]).as_matrix())
    reading = AngleReading("made up", {"hip_r": hip})
    read, own = ClinicalAngles(model, reading), in_frame(spread_case, STEADY)
    found = found_by(model, track, tau, sd_tau, STEADY, reading)
    seen = read.against(STEADY.heading_rad, track.q)
    np.testing.assert_allclose(found.angles[KNOWN], read.angles(seen)[KNOWN], rtol=1e-14)
    spread = read.ball_spread(seen[KNOWN], found.angles[KNOWN], track.ball_covariance[KNOWN])
    columns = read.ball_columns.ravel()
    np.testing.assert_allclose(found.angles_sd[KNOWN][:, columns], spread[:, columns], rtol=1e-12)
    for name in ("moments", "moments_sd"):
        np.testing.assert_array_equal(getattr(found, name), getattr(own, name))
    h = 1e-6
    for t in KNOWN:
        ends = np.array([model.integrate(track.q[t], s * h * track.v[t]) for s in (-1, 1)])
        before, after = read.angles(read.against(np.full(2, 0.8), ends))
        np.testing.assert_allclose(found.angle_rates[t], (after - before) / (2 * h), rtol=0, atol=2e-8)


@pytest.mark.parametrize("turned", [False, True])
def test_parts_go_the_way_of_their_totals(spread_case, turned):
    """A fixed share of every spread is the same share in every frame and reading."""
    model, track, tau, sd_tau, _ = spread_case
    told = {f"{name}_offset": 0.6 * getattr(track, f"{name}_sd") for name in ("angle", "rate")}
    told |= {f"{name}_change": 0.3 * getattr(track, f"{name}_sd") for name in ("angle", "rate")}
    told |= {"sd_v_offset": 0.6 * track.sd_v, "torque_change": 0.3 * sd_tau}
    track = replace(track, **told, ball_offset=0.36 * track.ball_covariance, torque_offset=0.6 * sd_tau)
    hip = JointAxes(*Rotation.from_rotvec([[0.1, 0.2, -0.1], [-0.1, 0.3, 0.2]]).as_matrix())
    how = (STEADY, AngleReading("made up", {"hip_r": hip})) if turned else ()
    found = found_by(model, track, tau, sd_tau, *how)
    for name in ("angles", "angle_rates", "moments"):
        total, offset = getattr(found, f"{name}_sd"), getattr(found, f"{name}_sd_offset")
        np.testing.assert_allclose(offset, 0.6 * total, rtol=1e-12)
        assert np.isnan(offset[2]).all() and (offset[KNOWN] > 0.0).all()
        np.testing.assert_allclose(getattr(found, f"{name}_sd_change"), 0.3 * total, rtol=1e-5)


def test_opensims_origin_of_the_pelvis_is_the_middle_of_the_persons_asis(case):
    """Reed 1999: the hips lie 0.208 of the pelvis's width behind and 0.278 below it."""
    model, _, _, _, found = case
    root, hip = model.description.segments[0], model.description.segment("right_thigh").origin_m
    middle = [hip[0] + 0.208 * 0.224, 0.0, hip[2] + 0.278 * 0.224]
    np.testing.assert_allclose(found.opensim_origin_m, model.axis_scale(root) * middle, atol=1e-3)
    assert found.opensim_zeros_rad == {name: pytest.approx(np.pi / 2) for name in ("pro_sup_r", "pro_sup_l")}
