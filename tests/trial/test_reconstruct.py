"""A made capture of a known motion through the whole reconstruction.

Nothing pushes the made body, so only the filter that follows markers alone can recover its motion exactly; what the
dynamic filter makes of a motion under true loads stands in ``test_reconstruct_dynamic.py``.
"""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.io.records import PlateReadings
from mbkf.io.subject import STANDING_KEY
from mbkf.model.clinical import ClinicalAngles, dof_names
from mbkf.trial.preparation.settings import Hidden, ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from tests.motions import (
    angle_errors,
    assert_near,
    capture_of,
    marker_positions,
    protocol_sensor,
    random_model,
    smooth_motion,
    subject_of,
)

RATE_HZ, FRAMES = 100.0, 100
LEGS = (
    "pelvis",
    "right_thigh",
    "right_shank",
    "right_foot",
    "right_toes",
    "left_thigh",
    "left_shank",
    "left_foot",
    "left_toes",
)
DEGREE = np.pi / 180
SHIFT_M = np.array([0.0, 0.0, 0.03])


class Made:
    """A person, a smooth motion, and a capture of it without noise."""

    def __init__(self):
        rng = np.random.default_rng(1)
        self.model = random_model(rng)
        self.subject = subject_of(self.model, aliases={"RKNE": ("R.Knee",)})
        self.q, self.v, self.a = smooth_motion(self.model, rng).frames(FRAMES, RATE_HZ)
        self.sensor, self.names = protocol_sensor(self.model)
        self.positions = marker_positions(self.sensor, self.q)
        self.capture = capture_of(self.names, self.positions, RATE_HZ)

    def with_plates(self, *names):
        """Plates named so, each with a tenth of the weight, far from the feet or under them."""
        return replace(self.capture, plates=tuple(plate(name, 0.1 * self.model.mass_kg) for name in names))


def plate(name, mass_kg):
    samples = FRAMES * 10
    force = np.tile([0.0, 0.0, mass_kg * GRAVITY_M_S2], (samples, 1))
    nothing, at = np.zeros((samples, 3)), np.tile([5.0, 5.0, 0.0], (samples, 1))
    return PlateReadings(name, 1000.0, 0.0, at[0], force, nothing, at, 20.0)


@pytest.fixture(scope="module")
def made():
    return Made()


def kinematic(capture, subject, **settings):
    chosen = ReconstructSettings(filter="kinematic", smooth=False, **settings)
    return reconstruct(capture, subject, settings=chosen)


@pytest.fixture(scope="module")
def result(made):
    return kinematic(made.capture, made.subject)


def rms(values):
    return np.sqrt((values**2).mean())


def test_angles_are_recovered(made):
    """With markers where the subject has them. Three dofs of an arm hang on a wand each, the rest is firm."""
    found = kinematic(made.capture, made.subject, correct_markers=False)
    rotations = angle_errors(made.model, found.q, made.q)[:, 3:]
    firm = np.concatenate([np.arange(made.model.nv)[made.model.joint(s).v] for s in (*LEGS, "torso", "neck")])
    assert rms(rotations[:, firm[firm >= 3] - 3]) < 0.1 * DEGREE
    assert rms(rotations) < 0.4 * DEGREE
    clinical = ClinicalAngles(made.model)
    turning = clinical.rotational
    assert rms((found.angles_lab - clinical.angles(made.q))[:, turning]) < 0.4 * DEGREE
    assert np.abs(found.q[:, :3] - made.q[:, :3]).max() < 0.0005


def test_the_pelvis_is_told_against_its_heading_or_the_laboratory_on_request(made, result):
    """The frame changes the pelvis's angles and nothing else that is estimated."""
    lab = kinematic(made.capture, made.subject, pelvis="lab")
    clinical = ClinicalAngles(made.model)
    assert (result.direction, lab.direction) == ("heading", "laboratory")
    np.testing.assert_array_equal(lab.angles, lab.angles_lab)
    np.testing.assert_array_equal(lab.angles, result.angles_lab)
    assert not lab.heading_rad.any()
    turned = clinical.angles(clinical.against(result.heading_rad, result.q))
    np.testing.assert_array_equal(result.angles, turned)
    np.testing.assert_array_equal(result.q, lab.q)
    with pytest.raises(UnknownName, match="sideways"):
        kinematic(made.capture, made.subject, pelvis="sideways")


def test_angles_are_read_as_plug_in_gait_on_request(made, result):
    """Motion and torques stay, and the widths that the capture tells are heeded."""
    told = replace(made.capture, processing={"RKNEEWIDTH": 140.0})
    bare, found = (kinematic(capture, made.subject, angles="pig") for capture in (made.capture, told))
    assert (result.angles_read, found.angles_read) == ("model", "pig")
    assert found.settings["angles"] == "pig"
    for name in ("q", "v", "tau", "moments"):
        np.testing.assert_array_equal(getattr(found, name), getattr(result, name))
    assert np.abs(found.angles - result.angles)[:, found.coordinate_names.index("hip_flexion_r")].max() > 1e-3
    changed = np.abs(found.angles - bare.angles).max(axis=0) > 1e-6
    told_apart = {name for name, by in zip(found.coordinate_names, changed, strict=True) if by}
    assert "hip_adduction_r" in told_apart and not {n for n in told_apart if n.endswith("_l")}
    with pytest.raises(UnknownName, match="sideways"):
        kinematic(made.capture, made.subject, angles="sideways")


def test_joint_angles_are_zero_in_the_static_trial_on_request_only(made, result):
    """Angles of the pelvis, positions and moments stay; a person without a static trial is refused."""
    clinical, standing = ClinicalAngles(made.model), made.q[10]
    stood = replace(made.subject, report={**made.subject.report, STANDING_KEY: standing.tolist()})
    found = kinematic(made.capture, stood, angles_zero="static")
    taken_off = result.angles - found.angles
    expected = clinical.angles(standing[None])[0] * clinical.rotational
    expected[clinical.root_angles] = 0.0
    np.testing.assert_allclose(taken_off, np.broadcast_to(expected, taken_off.shape), atol=1e-12)
    np.testing.assert_array_equal(found.moments, result.moments)
    assert (result.angles_zero, found.angles_zero) == ("axes", "static")
    with pytest.raises(InvalidInput, match="static trial"):
        kinematic(made.capture, made.subject, angles_zero="static")
    with pytest.raises(UnknownName, match="sideways"):
        kinematic(made.capture, made.subject, angles_zero="sideways")


def test_correcting_exact_markers_costs_little(made, result):
    """The correction lets every marker wander by a millimetre: a degree where a joint hangs on few markers."""
    errors = angle_errors(made.model, result.q, made.q)
    assert rms(errors[:, 3:6]) < 0.15 * DEGREE
    assert rms(errors[:, 3:]) < 1.5 * DEGREE
    assert np.abs(errors[:, :3]).max() < 0.002


def test_predicted_markers_lie_on_the_measured_ones(made, result):
    distance = np.linalg.norm(result.predicted_m - result.measured_m, axis=2)
    assert rms(distance) < 0.0008
    np.testing.assert_array_equal(result.measured_m, made.positions)
    assert result.marker_names == made.names


def test_without_plates_there_are_no_torques_and_a_warning(result):
    for values in (
        result.tau,
        result.sd_tau,
        result.moments,
        result.moments_sd,
        result.residual_force_n,
        result.residual_moment_nm,
    ):
        assert np.isnan(values).all()
    assert not result.valid.any()
    assert "no force plates: torques and residuals are not computed" in result.warnings


def test_the_result_says_how_it_was_made(made, result):
    assert (result.trial, result.protocol, result.filter) == ("made", "reference36", "kinematic")
    assert result.rate_hz == RATE_HZ
    assert result.dof_names == dof_names(made.model)
    assert result.unobserved_dofs == ()
    assert result.settings["correct_markers"] is True
    assert (result.foot_wrench_sd, result.foot_contact, result.plate_change, result.covariance) == (None,) * 4
    assert not result.smoothed
    assert result.tracked.all()


def test_spreads_cover_the_errors(made, result):
    """Noise-free markers: the error of every joint stays within three of its standard deviations."""
    normal = np.abs(angle_errors(made.model, result.q, made.q)) / result.sd_q
    assert normal.max() < 3.0


def test_hidden_markers_are_reported_and_kept_as_measured(made):
    hide = (Hidden(("RKNE", "RTHI"), 0.30, 0.50), Hidden(("C7",), 0.9, 5.0))
    found = kinematic(made.capture, made.subject, hide=hide)
    hidden = np.zeros((FRAMES, len(made.names)), bool)
    hidden[30:51, [made.names.index("RKNE"), made.names.index("RTHI")]] = True
    hidden[90:, made.names.index("C7")] = True
    np.testing.assert_array_equal(found.hidden, hidden)
    np.testing.assert_array_equal(found.measured_m, made.positions)
    assert np.isfinite(found.predicted_m[hidden]).all()
    assert (found.nis_readings[31:51] == 3 * 34).all()
    thigh = made.model.joint("right_thigh").v
    assert (found.sd_q[50, thigh] > found.sd_q[25, thigh]).all()
    assert np.linalg.norm((found.predicted_m - made.positions)[hidden], axis=1).max() < 0.05


@pytest.mark.slow
def test_hiding_what_is_not_there_hides_nothing(made):
    positions = made.positions.copy()
    positions[:, 0] = np.nan
    hide = (Hidden((made.names[0],), 0.0, 1.0),)
    found = reconstruct(
        capture_of(made.names, positions), made.subject, settings=ReconstructSettings(hide=hide, smooth=False)
    )
    assert not found.hidden.any()


def test_legs_alone_leave_the_rest_neutral_and_uncertain(made):
    legs = [i for i, segment in enumerate(made.sensor.segments) if segment in LEGS]
    capture = capture_of([made.names[i] for i in legs], made.positions[:, legs])
    found = kinematic(capture, made.subject)
    above = np.concatenate(
        [np.arange(made.model.nv)[j.v] for s, j in made.model.joints.items() if s not in LEGS]
    )
    assert found.unobserved_dofs == tuple(dof_names(made.model)[i] for i in above)
    assert "dofs move no marker and keep the neutral posture" in " ".join(found.warnings)
    np.testing.assert_allclose(found.q[:, 7:35], np.tile(made.model.neutral()[7:35], (FRAMES, 1)), atol=1e-9)
    assert (found.sd_q[:, above] >= made.model.posture_sd[above] * (1 - 1e-6)).all()
    below = np.setdiff1d(np.arange(3, made.model.nv), above)
    errors = angle_errors(made.model, found.q, made.q)[:, below]
    assert rms(errors) < 1.5 * DEGREE


def test_aliases_name_the_same_marker(made, result):
    names = ["R.Knee" if name == "RKNE" else name for name in made.names]
    found = kinematic(capture_of(names, made.positions), made.subject)
    assert found.marker_names == made.names
    np.testing.assert_array_equal(found.q, result.q)


def test_the_order_of_markers_and_strangers_among_them_do_not_matter(made, result):
    order = np.random.default_rng(2).permutation(len(made.names))
    names = ["stranger", *(made.names[i] for i in order)]
    positions = np.concatenate([np.full((FRAMES, 1, 3), 7.0), made.positions[:, order]], axis=1)
    found = kinematic(capture_of(names, positions), made.subject)
    assert "stranger" not in found.marker_names
    assert np.abs(angle_errors(made.model, found.q, result.q)).max() < 1e-6


@pytest.mark.slow
def test_moved_markers_are_corrected_on_the_trial_only_when_wanted(made):
    places = {m.name: m for m in made.subject.markers}
    moved = replace(places["RTHI"], position_m=places["RTHI"].position_m + SHIFT_M, session_sd_m=0.05)
    subject = replace(
        made.subject, markers=tuple(moved if m.name == "RTHI" else m for m in made.subject.markers)
    )
    with_correction, without = (
        reconstruct(made.capture, subject, settings=ReconstructSettings(smooth=False, correct_markers=wanted))
        for wanted in (True, False)
    )
    i = made.names.index("RTHI")
    assert_near(without.subject.markers[i].position_m, moved.position_m, 0.0)
    off = np.linalg.norm(with_correction.subject.markers[i].position_m - places["RTHI"].position_m)
    assert off < 0.003


@pytest.mark.slow
def test_withheld_plates_are_not_used(made):
    capture = made.with_plates("1", "2")
    all_plates = kinematic(capture, made.subject)
    assert np.isfinite(all_plates.tau).all()
    assert np.isfinite(all_plates.moments).all()
    neither = kinematic(capture, made.subject, without_plates=("1", "2"))
    assert np.isnan(neither.tau).all()


def test_stray_loads_leave_frames_invalid(made):
    found = kinematic(made.with_plates("1"), made.subject)
    assert not found.valid.any()
    np.testing.assert_array_equal(found.foot_wrench, 0.0)
    assert "loaded plate with no foot" in " ".join(found.warnings)


def test_kept_covariances_agree_with_the_spreads(made):
    short = capture_of(made.names, made.positions[:30])
    found = reconstruct(short, made.subject, settings=ReconstructSettings(keep_covariance=True))
    nv = made.model.nv
    spread = np.sqrt(np.diagonal(found.covariance, axis1=1, axis2=2))
    np.testing.assert_allclose(found.sd_q, spread[:, :nv], rtol=1e-12)
    np.testing.assert_allclose(found.sd_v, spread[:, nv:], rtol=1e-12)


def test_unknown_names_are_refused(made):
    def run(capture=made.capture, **settings):
        return reconstruct(capture, made.subject, settings=ReconstructSettings(**settings))

    with pytest.raises(UnknownName, match="--hide: unknown marker 'RKNEE'; did you mean RKNE"):
        run(hide=(Hidden(("RKNEE",), 0.0, 1.0),))
    with pytest.raises(InvalidInput, match="ends before it begins"):
        run(hide=(Hidden(("RKNE",), 1.0, 0.0),))
    with pytest.raises(UnknownName, match="--without-plate: unknown plate '3'"):
        run(made.with_plates("1", "2"), without_plates=("3",))
    with pytest.raises(UnknownName, match="the capture has none"):
        run(without_plates=("1",))
    with pytest.raises(UnknownName, match="unknown filter 'kinematics'; did you mean kinematic"):
        run(filter="kinematics")


def test_a_capture_of_other_markers_is_refused(made):
    with pytest.raises(NotObservable, match="has 5 of the subject's markers"):
        reconstruct(capture_of(made.names[:5], made.positions[:, :5]), made.subject)
    with pytest.raises(NotObservable, match=r"has 0 of the subject's markers.*its own are A, B"):
        reconstruct(capture_of(("A", "B"), np.zeros((3, 2, 3))), made.subject)


def test_progress_names_its_stage(made):
    told = []
    reconstruct(
        capture_of(made.names, made.positions[:10]), made.subject, progress=lambda *step: told.append(step)
    )
    assert told[-1] == ("Filtering", 10, 10)


def test_ignored_markers_are_told_and_change_nothing(made):
    short = made.positions[:10]
    points = np.concatenate([short, np.ones((10, 2, 3))], axis=1)
    plain = reconstruct(capture_of(made.names, short), made.subject)
    found = reconstruct(capture_of((*made.names, "X", "*7"), points), made.subject)
    assert_near(found.q, plain.q, 0.0)
    assert (plain.markers_ignored, plain.markers_explained) == ({}, 1.0)
    assert list(found.markers_ignored) == ["X"]
    assert found.markers_explained == pytest.approx(1.0 - 1.0 / (len(made.names) + 1))
    assert found.warnings == plain.warnings
    many = len(made.names)
    points = np.concatenate([short, np.ones((10, many, 3))], axis=1)
    few = reconstruct(capture_of((*made.names, *(f"X{i}" for i in range(many))), points), made.subject)
    assert any(f"knows {many} of {2 * many} markers (50 %)" in text for text in few.warnings)
    assert any(text.startswith(f"one person in view: +{many} markers") for text in few.warnings)
    assert len(few.warnings) == len(plain.warnings) + 2
