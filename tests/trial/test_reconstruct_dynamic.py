"""A squat recorded by made instruments through the whole reconstruction: what the dynamic filter tells."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.filters.torque.settings import preset
from mbkf.io.results import ARRAYS
from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from mbkf.trial.preparation.settings import Hidden, ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from tests.dynamics import trial
from tests.motions import angle_errors

pytestmark = pytest.mark.slow

QUIET = CaptureSettings(markers_sd_m=0.001, skin_sd_m=0.0, occlusion=0.0, offset_n=(0.0, 0.0))
SHORT = slice(40, 120)
LATE = slice(15, None)
RIGHT, LEFT = 0, 1
LEGS = ("pelvis", "thigh", "shank", "foot", "toes")


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@cache
def capture():
    """0.8 s of a squat over two plates, with camera noise and no skin."""
    made = trial("squat")
    whole = synthesise_capture(made.subject, made.motion, QUIET, seed=1).trial
    markers = whole.markers
    part = replace(markers, positions_m=markers.positions_m[SHORT], start_time_s=markers.times_s[SHORT.start])
    return replace(whole, markers=part)


@cache
def made(**settings):
    """Causal unless smoothing is asked for."""
    chosen = ReconstructSettings(**{"smooth": False, "correct_markers": False, **settings})
    return reconstruct(capture(), trial("squat").subject, settings=chosen)


def truth(name):
    return getattr(trial("squat").motion, name)[SHORT]


def leg_errors(found):
    """(T, n) errors of the dofs of pelvis and legs."""
    model = trial("squat").model
    legs = np.concatenate([np.arange(model.nv)[j.v] for s, j in model.joints.items() if s.endswith(LEGS)])
    return angle_errors(model, found.q, truth("q"))[:, legs[legs >= 3]]


def test_the_dynamic_filter_smoothed_is_the_default():
    found, asked = made(smooth=None), made(smooth=True)
    assert (found.filter, found.later_frames) == ("dynamic", "smoothed (all later frames known)")
    for name in set(ARRAYS) - {"covariance", "step_seconds"}:
        np.testing.assert_array_equal(getattr(found, name), getattr(asked, name), err_msg=name)
    assert made().later_frames == "causal (as live)"


@pytest.mark.parametrize(("smooth", "degrees"), [(False, 0.7), (True, 0.5)])
def test_motion_torques_and_reactions_are_those_that_were(smooth, degrees):
    found = made(smooth=True) if smooth else made()
    assert found.warnings == ()
    assert found.valid.all() and found.tracked.all()
    assert rms(leg_errors(found)) < np.deg2rad(degrees)
    assert rms((found.tau - truth("tau"))[LATE, 6:]) < 5.0
    assert rms((found.foot_wrench - truth("foot_wrench"))[LATE, :, :3]) < 1.5
    assert rms((found.foot_cop_m - truth("centre_of_pressure"))[LATE]) < 0.003


def test_torques_are_better_than_inverse_dynamics():
    theirs = rms((made(filter="kinematic").tau - truth("tau"))[LATE, 6:])
    assert rms((made().tau - truth("tau"))[LATE, 6:]) < 0.5 * theirs
    assert rms((made(smooth=True).tau - truth("tau"))[LATE, 6:]) < 0.35 * theirs


def test_a_lag_without_plates_lies_between_the_filter_and_its_smoother():
    """Errors of the force on both feet; what is still to come corrects it most where no plate reads it.

    How much the feet push apart is known from no frame.
    """
    names = tuple(plate.name for plate in capture().plates)
    true = truth("foot_wrench")[LATE, :, :3].sum(axis=1)
    runs = ({}, {"lag_s": 0.02}, {"lag_s": 0.06}, {"smooth": True})
    found = [made(without_plates=names, **run) for run in runs]
    causal, short, lagged, smooth = (rms(one.foot_wrench[LATE, :, :3].sum(axis=1) - true) for one in found)
    assert smooth < 1.1 * lagged and lagged < short < causal
    assert lagged < 0.8 * causal
    assert [one.smoothed for one in found] == [False, False, False, True]
    assert [one.lag_ms for one in found] == [0.0, 20.0, 60.0, 0.0]


def test_newtons_law_holds_with_the_measured_plates():
    """The residual of the plates as measured, not of the estimate."""
    found = made()
    assert rms(found.residual_force_n[LATE]) < 3.0
    assert rms(found.residual_moment_nm[LATE]) < 2.0
    assert rms(made(filter="kinematic").residual_force_n[LATE]) > 10.0


@pytest.mark.parametrize("filter", ["dynamic", "kinematic"])
def test_a_load_that_plates_lack_spoils_its_frames(filter):
    """Plates read 20 % less throughout: the body weighs less, or a harness bears it."""
    plates = tuple(
        replace(plate, force_n=0.8 * plate.force_n, moment_nm=0.8 * plate.moment_nm)
        for plate in capture().plates
    )
    settings = ReconstructSettings(filter=filter, smooth=False, correct_markers=False, checks=False)
    found = reconstruct(replace(capture(), plates=plates), trial("squat").subject, settings=settings)
    (load,) = found.unexplained
    assert load.direction == "upward" and load.cause == "mass"
    assert load.share == pytest.approx(0.2, abs=0.02)
    assert found.measured.all() and not found.valid.any()
    assert load.sentence in found.warnings


def test_without_plates_loads_follow_the_motion_and_nothing_is_unexplained():
    found = made(without_plates=tuple(plate.name for plate in capture().plates), smooth=True)
    assert found.unexplained == () and np.isnan(found.unexplained_force_n).all()
    weight = 9.80665 * found.subject.mass_kg
    assert np.abs(made().unexplained_force_n).max() < 0.02 * weight


def test_plates_are_moved_by_less_than_their_noise():
    change = made().plate_change
    assert change.shape == (80, 2, 6)
    assert np.isfinite(change).all()
    assert rms(change[:, :, :3]) < 1.0 and rms(change[:, :, 3:]) < 0.3


def test_feet_stand_on_their_plates():
    found = made()
    np.testing.assert_array_equal(found.foot_contact, 1)
    assert (found.foot_wrench_sd > 0).all()
    assert np.abs((found.foot_wrench - truth("foot_wrench")) / found.foot_wrench_sd)[LATE].max() < 4.0


def test_every_number_has_a_spread_that_covers_its_error():
    """Without skin errors the stated spreads are on the safe side."""
    found = made()
    normal = angle_errors(trial("squat").model, found.q, truth("q")) / found.sd_q
    assert np.abs(normal).max() < 4.0
    assert np.isfinite(found.sd_tau).all() and np.isfinite(found.moments_sd).all()
    assert np.abs((found.tau - truth("tau")) / found.sd_tau)[LATE, 6:].max() < 4.5


def test_a_withheld_plate_is_estimated_and_said_to_be():
    withheld = capture().plates[LEFT].name
    found = made(without_plates=(withheld,))
    assert (found.foot_contact == [1, -1]).all(axis=1)[2:].all()
    assert "where no plate reads: its reaction is estimated" in " ".join(found.warnings)
    assert not found.measured.any()
    assert found.plate_change.shape == (80, 1, 6)
    error = found.foot_wrench - truth("foot_wrench")
    assert rms(error[LATE, LEFT, 2]) < 100.0
    assert rms(error[LATE, RIGHT, 2]) < 5.0
    assert (found.foot_wrench_sd[:, LEFT, 2] > 5 * found.foot_wrench_sd[:, RIGHT, 2])[LATE].all()
    normal = (error / found.foot_wrench_sd)[LATE]
    assert rms(normal) < 1.3
    assert np.abs(normal).max() < 5.0
    assert np.isfinite(found.tau).all()
    assert np.median(found.sd_tau[LATE]) > np.median(made().sd_tau[LATE])


def test_without_plates_reactions_are_estimated_and_residuals_are_not():
    found = made(without_plates=("1", "2"))
    assert (
        "no force plates: reactions are estimated from the motion, residuals are not computed"
        in found.warnings
    )
    assert not found.measured.any()
    assert found.plate_change is None
    assert np.isnan(found.residual_force_n).all() and np.isnan(found.residual_moment_nm).all()
    for name in ("tau", "sd_tau", "moments", "moments_sd", "foot_wrench", "foot_wrench_sd"):
        assert np.isfinite(getattr(found, name)).all(), name


def test_without_plates_the_feet_carry_the_body():
    found = made(without_plates=("1", "2"))
    assert (found.foot_contact == -1).all(axis=1).mean() > 0.9
    total = found.foot_wrench[:, :, 2].sum(axis=1)
    assert rms((total - truth("foot_wrench")[:, :, 2].sum(axis=1))[LATE]) < 100.0
    # This squat's feet push towards the pelvis, which persons in standing do by a half at most: frontal torques of the
    # legs, which that push decides, are left out.
    legs = ("thigh_x", "thigh_z", "shank_x", "shank_z", "foot_x", "foot_z")
    decided = np.array([not name.endswith(legs) for name in found.dof_names])
    decided[:6] = False
    off = np.abs((found.tau - truth("tau")) / found.sd_tau)[LATE][:, decided]
    assert rms(off) < 1.0 and np.percentile(off, 99) < 3.0
    assert np.median(found.sd_tau[LATE]) > np.median(made().sd_tau[LATE])


def test_without_plates_the_kinematic_filter_tells_no_torques():
    found = made(without_plates=("1", "2"), filter="kinematic")
    assert np.isnan(found.tau).all()
    assert found.foot_wrench_sd is None and found.foot_contact is None
    assert "no force plates: torques and residuals are not computed" in found.warnings


def test_hidden_markers_leave_fewer_readings_and_larger_spreads():
    """36 markers less two, Newton's six equations and two plates of six."""
    hide = (Hidden(("RKNE", "RTHI"), 0.7, 0.9),)
    found, model = made(hide=hide), trial("squat").model
    hidden = found.hidden.any(axis=1)
    assert hidden.sum() in (20, 21)
    assert (found.nis_readings[hidden] == 3 * 34 + 18).all()
    thigh, last = model.joint("right_thigh").v, np.flatnonzero(hidden)[-1]
    assert (found.sd_q[last, thigh] > made().sd_q[last, thigh]).all()
    exact = np.array([m.name in ("RKNE", "RTHI") for m in trial("squat").subject.markers])
    off = np.linalg.norm(found.predicted_m - capture().markers.positions_m, axis=2)
    assert off[np.ix_(hidden, exact)].max() < 0.05


@pytest.mark.parametrize("name", ["kinematic", "torque", "dynamic"])
def test_half_a_second_without_markers_is_restarted_and_told(name):
    every = tuple(marker.name for marker in trial("squat").subject.markers)
    start = capture().markers.times_s[0]
    found = made(filter=name, hide=(Hidden(every, start + 0.195, start + 0.695),))
    lost = found.hidden.all(axis=1)
    assert lost.sum() == 50
    assert "the filter started anew at frame 70" in found.warnings
    told = [w for w in found.warnings if w.startswith("50 of 80 frames have too few markers within the gate")]
    assert len(told) == 1
    np.testing.assert_array_equal(found.tracked, ~lost)
    assert not found.valid[lost].any()
    assert rms(leg_errors(found)[70:]) < np.deg2rad(2.0)


@cache
def legs_alone():
    subject = trial("squat").subject
    names = tuple(m.name for m in subject.markers if m.segment.endswith(LEGS))
    only = replace(capture(), markers=capture().markers.select(names))
    return reconstruct(only, subject, settings=ReconstructSettings(smooth=False, correct_markers=False))


def test_legs_alone_are_followed_and_the_rest_is_named():
    found = legs_alone()
    assert len(found.unobserved_dofs) == 26
    assert "26 dofs move no marker and keep the neutral posture" in " ".join(found.warnings)
    assert rms(leg_errors(found)) < np.deg2rad(1.0)


def test_unobserved_dofs_keep_the_neutral_posture():
    found = legs_alone()
    model = trial("squat").model
    away = angle_errors(model, found.q, np.tile(model.neutral(), (len(found.q), 1)))
    held = np.isin(found.dof_names, found.unobserved_dofs)
    assert np.abs(away[:, held]).max() < np.deg2rad(1.0)


def test_the_thesiss_filter_tells_torques_where_it_has_them():
    found = made(filter="torque")
    assert found.filter == "torque"
    known = ~np.isnan(found.sd_tau[1])
    assert known.sum() == 50
    assert rms((found.tau - truth("tau"))[LATE][:, known][:, 6:]) < 5.0
    np.testing.assert_array_equal(found.foot_contact, 1)


def test_settings_of_a_filter_reach_it():
    plain = made(filter="torque")
    light = made(filter="torque", torque=preset("FDMC"))
    assert light.settings["torque"]["scheme"]["integrator"] == "FE"
    assert not np.array_equal(plain.q, light.q)
    assert rms(leg_errors(light)) < np.deg2rad(1.0)
