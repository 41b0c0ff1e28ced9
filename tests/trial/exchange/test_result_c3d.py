"""A result as C3D: what ezc3d and mbkf's own reader find is what the result holds."""

from dataclasses import replace
from functools import cache

import ezc3d
import numpy as np
import pytest

from mbkf.io.c3d import read_c3d
from mbkf.io.capture_options import CaptureOptions
from mbkf.model.clinical import ClinicalAngles
from mbkf.trial.exchange.result_c3d import result_capture, write_result_c3d
from mbkf.trial.gait.events import foot_events
from tests.recordings import LOST, broken_walk, leaning_walk, walker

SUFFIX = {"r": "R", "l": "L"}
JOINTS = {"hip": ("hip_flexion", "hip_adduction", "hip_rotation"),
          "knee": ("knee_angle", "knee_adduction", "knee_rotation"),
          "ankle": ("ankle_angle", "subtalar_angle", "ankle_rotation"),
          "elbow": ("elbow_flex", "elbow_adduction", "pro_sup"),
          "wrist": ("wrist_flex", "wrist_dev", "wrist_rotation")}  # fmt: skip
SEGMENTS = {
    "HJC": "thigh",
    "KJC": "shank",
    "AJC": "foot",
    "SJC": "upper_arm",
    "EJC": "forearm",
    "WJC": "hand",
}


@cache
def result():
    """The broken walk with rates of its angles that belong to its velocities."""
    r, clinical = broken_walk(), ClinicalAngles(walker()[1])
    rates = np.einsum("tai,ti->ta", clinical.rate_matrices(r.q, r.angles), r.v)
    return replace(r, angle_rates=rates, times_s=r.times_s + 0.4)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("c3d") / "walk.c3d"
    write_result_c3d(result(), path)
    return path


@pytest.fixture(scope="module")
def theirs(path):
    return ezc3d.c3d(str(path))


@pytest.fixture(scope="module")
def points(theirs):
    """(T, 3) of every label, NaN where the residual says missing."""
    values = theirs["data"]["points"][:3].transpose(1, 2, 0)
    missing = theirs["data"]["meta_points"]["residuals"][0] < 0.0
    labels = told(theirs, "LABELS")
    assert values.shape[0] == len(labels) == len(set(labels))
    return dict(zip(labels, np.where(missing[:, :, None], np.nan, values), strict=True))


def told(c3d, name, group="POINT"):
    return c3d["parameters"][group][name]["value"]


def assert_same(found, expected):
    """Equal to 1e-4 of the largest value, and unknown together."""
    expected = np.where(result().tracked[:, None], expected, np.nan)
    np.testing.assert_array_equal(np.isnan(found), np.isnan(expected))
    np.testing.assert_allclose(found, expected, atol=1e-4 * np.nanmax(np.abs(expected)), rtol=0)


@pytest.mark.parametrize("side", ["r", "l"])
@pytest.mark.parametrize("joint", JOINTS)
def test_angles_moments_and_powers_are_those_of_the_result(points, joint, side):
    r, stem = result(), SUFFIX[side] + joint.capitalize()
    names, turned = (
        [f"{name}_{side}" for name in JOINTS[joint]],
        [1.0, -1.0 if joint == "ankle" else 1.0, 1.0],
    )
    assert_same(points[f"{stem}Angles"], turned * np.rad2deg(np.column_stack([r.angle(n) for n in names])))
    assert_same(points[f"{stem}AnglesSD"], np.rad2deg(np.column_stack([r.angle_sd(n) for n in names])))
    assert_same(points[f"{stem}Moment"], turned * np.column_stack([r.moment(n) for n in names]))
    power = sum(r.power(n) for n in names)
    assert_same(points[f"{stem}Power"], np.column_stack([0 * power, 0 * power, power]))


def test_powers_are_of_moment_and_rate_of_the_stored_angle(points):
    r = result()
    spine = ("lumbar_extension", "lumbar_bending", "lumbar_rotation")
    moment, signs = points["SpineMoment"], np.array([-1.0, 1.0, 1.0])
    rates = signs * np.column_stack([r.angle_rate(n) for n in spine])
    assert_same(points["SpinePower"][:, 2:], (moment * rates).sum(axis=1)[:, None])


def test_the_pelvis_is_told_as_plug_in_gait_tells_it(points):
    """Forward lean, own side up; the right side counts turns to the left, the left side those to the right."""
    r = result()
    tilt, up, turn = (np.rad2deg(r.angle(n)) for n in ("pelvis_tilt", "pelvis_list", "pelvis_rotation"))
    assert_same(points["RPelvisAngles"], np.column_stack([-tilt, -up, turn]))
    assert_same(points["LPelvisAngles"], np.column_stack([-tilt, up, -turn]))
    assert "RPelvisMoment" not in points


def test_joint_centres_and_the_centre_of_mass_are_the_body_s(points):
    r, model = result(), walker()[1]
    for side, word in (("R", "right"), ("L", "left")):
        for name, segment in SEGMENTS.items():
            joint = model.joint(f"{word}_{segment}").joint_id
            assert_same(points[side + name], 1e3 * np.array([model.placements(q)[1][joint] for q in r.q]))
    assert_same(points["CentreOfMass"], 1e3 * np.array([model.centre_of_mass(q) for q in r.q]))


def test_markers_stand_measured_and_on_the_body(points):
    r = result()
    for k, name in enumerate(r.marker_names):
        np.testing.assert_allclose(points[name], 1e3 * r.measured_m[:, k], atol=0.1)
        assert_same(points[f"{name}_model"], 1e3 * r.predicted_m[:, k])
    assert np.isnan(points[r.marker_names[0]][20:50]).all()


def test_reactions_are_in_newton(points):
    r = result()
    for k, side in enumerate("RL"):
        assert_same(points[f"{side}GroundReactionForce"], r.foot_wrench[:, k, :3])
        assert_same(points[f"{side}CentreOfPressure"], 1e3 * r.foot_cop_m[:, k])


def test_frames_without_the_body_have_a_residual_of_minus_one(theirs, points):
    residuals = theirs["data"]["meta_points"]["residuals"][0]
    labels = list(points)
    assert (residuals[labels.index("LKneeAngles"), LOST] == -1.0).all()
    assert (residuals[labels.index("CentreOfMass"), LOST] == -1.0).all()
    assert (residuals[labels.index("LKneeAngles"), : LOST.start] == 0.0).all()


def test_kinds_units_and_signs_are_stated(theirs, points):
    assert [told(theirs, f"{kind}_UNITS") for kind in ("ANGLE", "MOMENT", "POWER", "FORCE")] == [
        ["deg"], ["Nm"], ["W"], ["N"],
    ]  # fmt: skip
    assert told(theirs, "UNITS") == ["mm"]
    for group, end in (("ANGLES", ("Angles", "SD")), ("MOMENTS", ("Moment", "SD")), ("POWERS", ("Power",)),
                       ("FORCES", ("Force",))):  # fmt: skip
        listed = told(theirs, group)
        assert listed and all(label.endswith(end) and label in points for label in listed)
    words = told(theirs, "TYPE_GROUPS")
    assert dict(zip(words[::2], words[1::2], strict=True)) == {
        "ANGLES": "ANGLE", "FORCES": "FORCE", "MOMENTS": "MOMENT", "POWERS": "POWER",
        "MODELED_MARKERS": "MODELED_MARKER",
    }  # fmt: skip
    said = dict(zip(points, told(theirs, "DESCRIPTIONS"), strict=True))
    assert said["LKneeAngles"].startswith(
        "X+ heel to the buttock (flexion), Y+ shank towards the midline (varus)"
    )
    assert said["RHipMoment"].startswith("internal: X+ thigh forward")
    assert said["LPelvisAngles"].startswith(
        "X+ forward lean (anterior tilt), Y+ left side up, Z+ turned to the right"
    )
    assert said["RPelvisAngles"].endswith(f", {result().direction} frame")
    assert all(said[name] for name in points if name not in result().marker_names)
    assert max(map(len, said.values())) <= 117  # so that the list is cut where the labels are


def test_strikes_and_offs_are_events(theirs, path):
    expected = sorted(
        (time, side, label)
        for side, foot in zip(("Right", "Left"), foot_events(result()), strict=True)
        for label, times in (("Foot Strike", foot.strikes_s), ("Foot Off", foot.offs_s))
        for time in times
    )
    assert len(expected) >= 4 and {label for _, _, label in expected} == {"Foot Strike", "Foot Off"}
    minutes, seconds = told(theirs, "TIMES", "EVENT")
    np.testing.assert_allclose(60 * minutes + seconds, [time for time, _, _ in expected], atol=1e-5)
    assert told(theirs, "CONTEXTS", "EVENT") == [side for _, side, _ in expected]
    assert told(theirs, "LABELS", "EVENT") == [label for _, _, label in expected]
    icons = {"Foot Strike": 1, "Foot Off": 2}
    assert list(told(theirs, "ICON_IDS", "EVENT")) == [icons[label] for _, _, label in expected]
    own = [(e.context, e.label) for e in read_c3d(path, CaptureOptions()).events]
    assert own == [(side, label) for _, side, label in expected]


def test_the_own_reader_finds_the_same_and_takes_no_computed_point_for_a_marker(path, points):
    back, r = read_c3d(path, CaptureOptions()), result()
    assert back.markers.names == r.marker_names
    assert (back.markers.rate_hz, back.markers.start_time_s) == (r.rate_hz, pytest.approx(0.4))
    assert back.subject_mass_kg == pytest.approx(r.subject.mass_kg, rel=1e-6)
    given = {point.name: point for point in result_capture(r).derived}
    units = {"angle": "deg", "moment": "Nm", "power": "W", "force": "N", "point": "mm"}
    assert set(given) == {point.name for point in back.derived} == set(points) - set(r.marker_names)
    for point in back.derived:
        own = given[point.name]
        assert (point.kind, point.unit, point.description) == (own.kind, units[own.kind], own.description)
        np.testing.assert_array_equal(np.isnan(point.values), np.isnan(own.values))
        scale = 1e3 if own.kind == "point" else 1.0
        np.testing.assert_allclose(
            point.values, scale * own.values, atol=1e-4 * scale * np.nanmax(np.abs(own.values), initial=1e-3)
        )


def test_lost_frames_leave_gaps(tmp_path):
    r = result()
    kept = np.r_[0:50, 60:90]
    short = cut(r, kept)
    write_result_c3d(short, tmp_path / "x.c3d")
    back = read_c3d(tmp_path / "x.c3d", CaptureOptions())
    assert back.markers.frames == 90
    knee = next(point.values for point in back.derived if point.name == "RKneeAngles")
    np.testing.assert_array_equal(np.isnan(knee[:, 0]), (np.arange(90) >= 50) & (np.arange(90) < 60))
    np.testing.assert_allclose(knee[60:90, 0], np.rad2deg(r.angle("knee_angle_r")[60:90]), atol=1e-4)


def cut(r, rows):
    arrays = {name: getattr(r, name)[rows] for name in vars(r)
              if isinstance(getattr(r, name), np.ndarray) and len(getattr(r, name)) == r.frames}  # fmt: skip
    return replace(r, **arrays)


def test_loads_on_other_parts_stand_beside_those_of_the_feet():
    r = leaning_walk()
    found = {point.name: point for point in result_capture(r).derived}
    k = r.support_names.index("right_hand")
    np.testing.assert_array_equal(found["RightHandContactForce"].values, r.support_wrench[:, k, :3])
    assert found["RightHandContactForce"].kind == "force"
    assert "LeftHandContactForce" not in found


def test_the_axes_that_angles_are_read_in_are_told_and_powers_do_not_depend_on_them():
    r = replace(result(), angles_read="pig", angle_rates=np.full(result().angles.shape, 7.0))
    found = {point.name: point for point in result_capture(r).derived}
    assert found["RKneeAngles"].description.endswith(", in pig axes")
    own = {point.name: point for point in result_capture(result()).derived}
    np.testing.assert_array_equal(found["RKneePower"].values, own["RKneePower"].values)


def test_points_that_are_never_known_are_left_out():
    r = result()
    unknown = np.full(r.moments.shape, np.nan)
    found = {point.name for point in result_capture(replace(r, moments_sd=unknown)).derived}
    assert "RKneeMoment" in found and "RKneeMomentSD" not in found


def test_a_result_that_follows_nothing_holds_the_measured_markers_alone():
    r = replace(result(), tracked=np.zeros(result().frames, bool))
    capture = result_capture(r)
    assert capture.derived == () and capture.events == ()
    np.testing.assert_array_equal(capture.markers.positions_m, r.measured_m)


@pytest.mark.parametrize("start_s", [0.0, 1e6, -3.0, 1.7e9, 0.4037])
def test_events_keep_their_place_among_the_frames_whenever_the_trial_began(tmp_path, start_s):
    r = result()
    moved = replace(r, times_s=r.times_s - r.times_s[0] + start_s)
    write_result_c3d(moved, tmp_path / "x.c3d")
    back = read_c3d(tmp_path / "x.c3d", CaptureOptions())
    assert abs(back.markers.start_time_s - start_s) < 0.51 / r.rate_hz or back.markers.start_time_s == 0.0
    expected = [event.time_s - r.times_s[0] for event in result_capture(r).events]
    found = [event.time_s - back.markers.start_time_s for event in back.events]
    np.testing.assert_allclose(found, expected, atol=2e-5)
