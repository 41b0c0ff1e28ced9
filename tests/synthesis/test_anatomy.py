"""Persons drawn from the body file's spreads: how far they differ, and that motion, markers and angles follow them."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import UnknownName
from mbkf.io.subject import read_subject, write_subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import reference_body
from mbkf.model.inertia_spread import CENTRE_SD, MASS_SD, SIDES_ALIKE, WHOLE_SD
from mbkf.model.joint_centres import centre_covariance, centre_names
from mbkf.model.skeleton import joint_origin
from mbkf.scaling.records import ScalingSettings
from mbkf.synthesis import cameras
from mbkf.synthesis.anatomy import HELD_RAD, true_angles
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject

SEEDS = range(300)


@pytest.fixture(scope="module")
def people():
    return [synthesise_subject(seed, varied=True) for seed in SEEDS]


@pytest.fixture(scope="module")
def person(people):
    return people[5]


def test_the_other_numbers_of_a_person_do_not_depend_on_the_variation(person):
    plain = synthesise_subject(5)
    kept = replace(
        person,
        joint_centres_m={},
        angle_zeros_deg={},
        habit_deg={},
        inertia={},
        markers=tuple(
            replace(m, slides_m=p.slides_m, slid=p.slid)
            for m, p in zip(person.markers, plain.markers, strict=True)
        ),
    )
    assert repr(kept) == repr(plain)
    assert repr(synthesise_subject(5, varied=True)) == repr(person)


def test_joint_centres_and_zeros_have_the_stated_spread(people):
    body = reference_body(people[0])
    drawn = np.array([[one.joint_centres_m[name] for name in centre_names(body)] for one in people])
    expected = centre_covariance(body)
    sd = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(np.cov(drawn.T) / np.outer(sd, sd), expected / np.outer(sd, sd), atol=0.25)
    zeros = np.array([list(one.angle_zeros_deg.values()) for one in people])
    assert people[0].angle_zeros_deg.keys() == {"elbow_flex_r", "elbow_flex_l"}
    assert zeros.std() == pytest.approx(4.5, rel=0.1)


def test_segment_masses_and_centres_have_the_stated_spread_at_a_whole_mass_that_is_known(people):
    """A draw ends at 2.5 standard deviations; of the torso the known whole mass leaves less."""
    own = np.array([one.inertia["right_thigh"].mass_factor for one in people])
    other = np.array([one.inertia["left_thigh"].mass_factor for one in people])
    assert own.mean() == pytest.approx(1.0, abs=0.03)
    assert 0.8 < own.std() / MASS_SD < 1.05
    assert np.corrcoef(own, other)[0, 1] == pytest.approx(SIDES_ALIKE, abs=0.05)
    segments = reference_body(people[0]).segments
    whole = [sum(one.inertia[s.name].mass_factor * s.mass_kg for s in segments) for one in people]
    assert np.std(whole) / np.mean(whole) < 1.5 * WHOLE_SD
    thigh = next(s for s in segments if s.name == "right_thigh")
    shifts = np.array([one.inertia["right_thigh"].centre_shift_m for one in people])
    assert shifts.std() == pytest.approx(CENTRE_SD * np.linalg.norm(thigh.com_m), rel=0.15)


def test_skin_moves_by_the_stated_spread_common_to_a_segment_and_own(people):
    skin = reference_body(people[0]).skin["right_thigh"]
    worn = [[m.slides_m for m in one.markers if m.segment == "right_thigh"] for one in people]
    slides = np.array(worn)  # person, marker, flexion, axis
    assert np.sqrt(slides.var(axis=1, ddof=1).mean()) == pytest.approx(skin.own_m, rel=0.1)
    assert slides.std() == pytest.approx(np.hypot(skin.common_m, skin.own_m), rel=0.1)
    assert np.abs(np.corrcoef(slides[:, 0].reshape(len(people), -1).T) - np.eye(6)).max() < 0.25


def test_keypoints_do_not_slide_and_a_segment_with_one_flexion_slides_by_that():
    person = synthesise_subject(1, "coco17", varied=True)
    assert not any(m.slides_m.size for m in person.markers)
    feet = [m for m in synthesise_subject(1, varied=True).markers if m.segment == "right_foot"]
    assert all(m.slides_m[0].all() and not m.slides_m[1:].any() for m in feet)


def test_people_hold_joints_as_scaling_expects_of_those_who_stand(people):
    model = body_of(people[0])
    drawn = {name: np.std([one.habit_deg[name] for one in people]) for name in people[0].habit_deg}
    assert ScalingSettings().standing_sd_rad == HELD_RAD
    assert drawn["torso_y"] == pytest.approx(np.rad2deg(HELD_RAD), rel=0.15)
    stiff = np.rad2deg(model.posture_sd[model.joint("right_shank").v])
    assert drawn["right_shank_x"] == pytest.approx(stiff[0], rel=0.15)
    assert "right_shank_y" not in drawn


def test_joints_are_held_otherwise_in_every_motion(person):
    model = body_of(person)
    plain, held = (
        synthesise_motion(model, "stand", 1.0, 20.0, 5, habit) for habit in (None, {"head_z": 10.0})
    )
    turned = model.joint("head").v.start + 2
    away = [model.difference(a, b)[turned] for a, b in zip(plain.q, held.q, strict=True)]
    assert np.rad2deg(away) == pytest.approx(10.0, abs=0.2)


def test_joints_lie_where_the_person_says(person):
    displaced, proportional = body_of(person), body_of(replace(person, joint_centres_m={}))
    for centre in reference_body(person).joint_centres:
        away = joint_origin(displaced, centre.segment) - joint_origin(proportional, centre.segment)
        stated = [person.joint_centres_m[f"{centre.segment}_centre_{axis}"] for axis in "xyz"]
        np.testing.assert_allclose(away, stated, atol=1e-15)


def test_markers_slide_with_the_flexions_beside_them(person):
    model = body_of(person)
    bent = model.neutral()
    knee = model.joint("right_shank")
    step = np.zeros(model.nv)
    step[knee.v.start + 1] = np.pi / 3.0
    bent = model.integrate(bent, step)
    rotations, origins = model.placements(bent)
    markers = cameras.true_markers(model, person, bent[None])[0]
    for marker, place in zip(person.markers, markers, strict=True):
        joint = model.joint(marker.segment).joint_id
        local = rotations[joint].T @ (place - origins[joint])
        moved = {"right_thigh": 1, "right_shank": 0}.get(marker.segment)
        expected = np.zeros(3) if moved is None else marker.slides_m[moved]
        np.testing.assert_allclose(local - marker.position_m, expected, atol=1e-12)


def test_a_displaced_body_moves_by_newtons_law(person):
    model = body_of(person)
    moved = synthesise_motion(model, "squat", 1.0, 50.0, seed=5)
    for k in range(0, len(moved.q), 10):
        tau = model.inverse_dynamics(moved.q[k], moved.v[k], moved.a[k])
        jacobian = model.spatial_jacobian(moved.q[k])
        for foot, name in enumerate(model.roles.feet):
            moves = model.supports[model.joint(name).joint_id]
            tau -= np.where(moves, moved.foot_wrench[k, foot] @ jacobian, 0.0)
        np.testing.assert_allclose(tau, moved.tau[k], atol=1e-6)
        assert np.abs(tau[:6]).max() < 1e-3


def test_true_angles_are_those_by_the_persons_bones(person):
    model = body_of(person)
    q = model.neutral()[None]
    away = np.rad2deg(true_angles(person, q) - ClinicalAngles(model).angles(q))[0]
    for name, zero in zip(ClinicalAngles(model).names, away, strict=True):
        assert zero == pytest.approx(person.angle_zeros_deg.get(name, 0.0))


def test_the_subject_file_holds_them(person, tmp_path):
    path = tmp_path / "subject.toml"
    write_subject(person, path)
    back = read_subject(path)
    assert back.joint_centres_m == person.joint_centres_m
    assert back.angle_zeros_deg == person.angle_zeros_deg
    assert back.habit_deg == person.habit_deg
    np.testing.assert_array_equal(
        body_of(back).placements(body_of(back).neutral())[1],
        body_of(person).placements(body_of(person).neutral())[1],
    )
    with pytest.raises(UnknownName, match="right_thing_centre_x"):
        body_of(replace(person, joint_centres_m={"right_thing_centre_x": 0.01}))
