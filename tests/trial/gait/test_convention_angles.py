"""Angles in a convention: those of the reading, spreads by its Jacobian, feet and trunk where the person goes."""

from dataclasses import replace

import numpy as np

from mbkf.model.angle_reading import AngleReading
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.trial.gait.convention import BY_CLINIC, BY_ISB, BY_MODEL, TRUNK
from mbkf.trial.gait.convention_angles import convention_angles
from mbkf.trial.gait.curves import side_views
from mbkf.trial.results.progression import progression_of
from mbkf.trial.results.readings import anatomical_places, angle_reading
from tests.recordings import walk

STEP = 1e-6


def test_the_bodys_own_are_the_results():
    r = walk()
    found = convention_angles(r, BY_MODEL)
    assert found.names == r.coordinate_names and found.axes == "model"
    np.testing.assert_array_equal(found.values, r.angles)
    np.testing.assert_array_equal(found.of("knee_angle_l")[1][0], r.angle_sd("knee_angle_l"))


def test_angles_are_those_of_the_reading():
    r = walk()
    model = HumanModel.of(r.subject)
    heading = progression_of(model, r.q, r.times_s).heading_rad
    for convention, axes, sign in ((BY_CLINIC, "pig", -1.0), (BY_ISB, "isb", 1.0)):
        reading = ClinicalAngles(model, angle_reading(axes, model, r.subject, {}))
        expected = reading.angles(reading.against(heading, r.q))
        found = convention_angles(r, convention)
        for name in ("hip_rotation_r", "ankle_angle_l", "arm_flex_r"):
            np.testing.assert_allclose(found.of(name)[0], expected[:, reading.names.index(name)], atol=1e-12)
        np.testing.assert_allclose(
            found.of("pelvis_tilt")[0], sign * expected[:, reading.names.index("pelvis_tilt")], atol=1e-12
        )


def test_spreads_follow_the_derivative():
    """One frame: the three angles of the right hip are moved one by one, and the reading is taken anew."""
    r = walk()
    model = HumanModel.of(r.subject)
    own, pig = ClinicalAngles(model), ClinicalAngles(model, angle_reading("pig", model, r.subject, {}))
    names = ("hip_flexion_r", "hip_adduction_r", "hip_rotation_r")
    at, q = [own.names.index(name) for name in names], r.q[60:61]
    sds = np.array([0.01, 0.02, 0.05])
    spread = r.angles_sd.copy()
    spread[:, at] = sds
    found = convention_angles(replace(r, angles_sd=spread), BY_CLINIC)
    E = own.rate_matrix(q[0])[at]
    moved = []
    for k in range(3):
        dv = np.linalg.pinv(E) @ (STEP * np.eye(3)[k])
        ahead, behind = (pig.angles(model.integrate(q[0], s * dv)[None])[0, at] for s in (1.0, -1.0))
        moved.append((ahead - behind) / (2 * STEP))
    expected = np.sqrt((np.array(moved).T ** 2) @ sds**2)
    np.testing.assert_allclose([found.of(name)[1][0, 60] for name in names], expected, rtol=1e-6)
    assert not np.allclose(expected, sds, rtol=1e-3), "the axes differ"


def test_feet_and_trunk_are_read_where_the_person_goes():
    """A capture turned about the vertical has the same curves; a foot turned in has a larger one on either side."""
    r = walk()
    model = HumanModel.of(r.subject)
    turned = ClinicalAngles(model).against(np.full(r.frames, -1.0), r.q)
    c, s = np.cos(1.0), np.sin(1.0)
    turned[:, :2] = r.q[:, :2] @ np.array([[c, s], [-s, c]])
    first, second = (convention_angles(one, BY_CLINIC) for one in (r, replace(r, q=turned)))
    for name in ("foot_progression_r", "foot_progression_l", *TRUNK):
        np.testing.assert_allclose(first.of(name)[0], second.of(name)[0], atol=1e-9)
    for side, name, sense in ((0, "right_foot", 1.0), (1, "left_foot", -1.0)):
        dv = np.zeros(model.nv)
        dv[model.joint(name).v.stop - 1] = 0.1 * sense
        inward = np.array([model.integrate(q, dv) for q in r.q])
        after = convention_angles(replace(r, q=inward), BY_CLINIC)
        key = f"foot_progression_{'rl'[side]}"
        change = after.of(key)[0] - first.of(key)[0]
        assert 0.05 < np.median(change) < 0.12


def test_the_trunk_is_that_of_plug_in_gaits_thorax():
    """The line between the thorax's pairs of landmarks, seen from the side of a person who goes straight on."""
    r = walk()
    model = HumanModel.of(r.subject)
    places = anatomical_places(model, r.subject)
    up = places["c7"] + places["jugular_notch"] - places["t10"] - places["xiphoid"]
    torso = model.joint("torso").joint_id
    lines = np.array([model.placements(q)[0][torso] @ up for q in r.q])
    heading = progression_of(model, r.q, r.times_s).heading_rad
    ahead = lines[:, 0] * np.cos(heading) + lines[:, 1] * np.sin(heading)
    found = convention_angles(r, BY_CLINIC).of("trunk_tilt")[0]
    np.testing.assert_allclose(found, np.arctan2(ahead, lines[:, 2]), atol=1e-9)


def test_the_left_sees_the_midline_mirrored():
    r = walk()
    right, left = (
        {c.name: c for c in side_views(r, k, BY_CLINIC) if c.quantity == "angle"} for k in range(2)
    )
    for name, sign in (("trunk_tilt", 1), ("trunk_obliquity", -1), ("pelvis_list", -1), ("pelvis_tilt", 1)):
        np.testing.assert_allclose(left[name].value, sign * right[name].value)


def test_a_body_without_the_landmarks_keeps_its_axes(monkeypatch):
    monkeypatch.setattr("mbkf.trial.gait.convention_angles.angle_reading", _lacking)
    found = convention_angles(walk(), BY_CLINIC)
    assert found.axes == "model" and "foot_progression_r" not in found.names
    np.testing.assert_allclose(found.of("pelvis_tilt")[0], -walk().angle("pelvis_tilt"))


def _lacking(asked, *_):
    from mbkf.errors import InvalidInput

    if asked != "model":
        raise InvalidInput("no landmark")
    return AngleReading()
