"""Correction of marker places on the trial itself: shifts are found, and nothing else moves."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import NotConverged, NotObservable
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import STANDING_KEY
from mbkf.model.human import HumanModel, reference_body
from mbkf.model.joint_centres import centre_names
from mbkf.model.protocol import load_protocol
from mbkf.scaling import correction
from mbkf.scaling.correction import correct_markers, rigid_displacements
from mbkf.sensors.flexed_skin import FlexedSkin
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_pose
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.shoulder_girdle import ShoulderGirdle, shoulder_names
from tests.motions import marker_positions, moderate_pose, random_model, subject_of

SHIFTED = ("RTHI", "LTHI", "RTUB")
LOWER = {
    f"{side}_upper_arm_centre_{axis}": moved
    for side in ("right", "left")
    for axis, moved in zip("xyz", (0.0, 0.0, -0.04), strict=True)
}
SHIFT_M = np.array([0.012, -0.008, 0.015])


@pytest.fixture(scope="module")
def model():
    return random_model(np.random.default_rng(1))


@pytest.fixture(scope="module")
def subject(model):
    """The person, with markers that may sit elsewhere by 3 cm where they are shifted and by 5 mm elsewhere."""
    person = subject_of(model)
    return replace(
        person,
        markers=tuple(replace(m, session_sd_m=0.03) if m.name in SHIFTED else m for m in person.markers),
    )


def trial(model, subject, shift_m=0.0, frames=20, lost=()):
    """A moving trial in which the shifted markers sit elsewhere."""
    rng = np.random.default_rng(2)
    kept = [m for m in subject.markers if m.name not in lost]
    places = np.array([m.position_m + (m.name in SHIFTED) * np.asarray(shift_m) for m in kept])
    sensor = MarkerSensor(model, [m.segment for m in kept], places)
    positions = marker_positions(sensor, [moderate_pose(model, rng, spread=0.6) for _ in range(frames)])
    return MarkerTrajectories(tuple(m.name for m in kept), positions, 100.0)


def moved_mm(before, after):
    pairs = zip(before.markers, after.markers, strict=True)
    return {a.name: 1e3 * np.linalg.norm(b.position_m - a.position_m) for a, b in pairs}


def test_shifts_of_markers_are_recovered(model, subject):
    after = correct_markers(subject, trial(model, subject, SHIFT_M))
    for old, new in zip(subject.markers, after.markers, strict=True):
        expected = SHIFT_M if old.name in SHIFTED else np.zeros(3)
        assert np.linalg.norm(new.position_m - old.position_m - expected) < 0.003


def test_markers_in_place_stay_in_place(model, subject):
    moved = moved_mm(subject, correct_markers(subject, trial(model, subject)))
    assert max(moved.values()) < 2.0  # the posture prior draws a little


def test_joint_centres_that_the_person_states_are_those_of_the_correction(model, subject):
    body = reference_body(subject)
    names = centre_names(body)
    stated = dict(zip(names, 0.01 * np.random.default_rng(6).normal(size=len(names)), strict=True))
    person = replace(subject, joint_centres_m=stated)
    moved = moved_mm(person, correct_markers(person, trial(HumanModel.of(person), person)))
    assert max(moved.values()) < 2.0


def test_known_displacements_by_flexion_are_not_taken_for_shifts(model, subject):
    """Skin moves as the subject file states: places in the neutral posture stay; the trial's usual ones are used."""
    rng = np.random.default_rng(4)
    skin = FlexedSkin(model, [m.segment for m in subject.markers])
    slides = rng.normal(0.0, 0.012, (len(subject.markers), skin.flexions, 3))
    known = replace(
        subject, markers=tuple(replace(m, slides_m=c) for m, c in zip(subject.markers, slides, strict=True))
    )
    sensor = MarkerSensor(model, [m.segment for m in known.markers], [m.position_m for m in known.markers])
    positions, shares = [], []
    for _ in range(20):
        q = moderate_pose(model, rng, spread=0.6)
        shares.append(skin.shares(q))
        moved = np.einsum("md,mdi->mi", shares[-1], slides)
        axes = model.placements(q)[0][sensor.joint_ids]
        positions.append(sensor.positions(q) + np.einsum("mij,mj->mi", axes, moved))
    one = MarkerTrajectories(tuple(m.name for m in known.markers), np.array(positions), 100.0)
    away = {}
    for name, person in (("known", known), ("unknown", subject)):
        found = correct_markers(person, one).markers
        away[name] = [
            np.linalg.norm(n.neutral_m - m.position_m) for n, m in zip(found, known.markers, strict=True)
        ]
        for n, m, share in zip(found, person.markers, np.mean(shares, axis=0), strict=True):
            if len(m.slides_m):
                np.testing.assert_allclose(n.slid, share, atol=0.02)
    assert max(away["known"]) < 0.003 < max(away["unknown"])


def test_keypoints_whose_skin_is_not_modelled_are_corrected(model, subject):
    keypoints = tuple(replace(m, correlated_m=0.5 * m.noise_m, correlation_s=0.5) for m in subject.markers)
    after = correct_markers(replace(subject, markers=keypoints), trial(model, subject, SHIFT_M))
    assert min(moved_mm(subject, after)[name] for name in SHIFTED) > 15.0
    assert all(m.slides_m.shape == (0, 3) for m in after.markers)


def test_markers_not_in_the_trial_keep_their_place(model, subject):
    after = correct_markers(subject, trial(model, subject, SHIFT_M, lost=("RTHI", "C7")))
    moved = moved_mm(subject, after)
    assert moved["RTHI"] == moved["C7"] == 0.0
    assert moved["LTHI"] > 15.0


def test_only_places_change(model, subject):
    after = correct_markers(subject, trial(model, subject, SHIFT_M))
    assert after.scale_factors == subject.scale_factors
    assert (after.mass_kg, after.body, after.protocol) == (subject.mass_kg, subject.body, subject.protocol)
    for old, new in zip(subject.markers, after.markers, strict=True):
        (mine, *rest), (theirs, *other) = (
            [replace(m, position_m=(), slides_m=(), slid=()), m.slides_m] for m in (new, old)
        )
        assert mine == theirs and not rest[0].any() and not other[0].any()


def test_a_tight_marker_moves_less_than_a_loose_one(model, subject):
    tight = replace(subject, markers=tuple(replace(m, session_sd_m=0.002) for m in subject.markers))
    one = trial(model, subject, SHIFT_M)
    loose_moved, tight_moved = (moved_mm(s, correct_markers(s, one)) for s in (subject, tight))
    for name in SHIFTED:
        assert tight_moved[name] < 0.7 * loose_moved[name]


def test_shoulders_that_hang_lower_in_the_trial_leave_the_pelvis_where_it_is():
    """Shoulders 4 cm lower, as after a static trial with raised arms: found, and the pelvis does not tilt for it.

    With shoulders that stay on the trunk it tilts by some degrees.
    """
    rng = np.random.default_rng(7)
    person = subject_of(random_model(rng))
    raised = HumanModel.of(person).neutral()
    raised[HumanModel.of(person).joint("left_upper_arm").q] = [np.sin(0.5), 0.0, 0.0, np.cos(0.5)]
    person = replace(person, report={**person.report, STANDING_KEY: raised.tolist()})
    body = reference_body(person)
    truth = HumanModel.of(replace(person, joint_centres_m=LOWER))
    segments = [m.segment for m in person.markers]
    girdle = ShoulderGirdle(truth, segments, np.array([m.position_m for m in person.markers]))
    places = np.array([m.position_m for m in person.markers])
    places += girdle.on_trunk @ np.array([LOWER[name] for name in shoulder_names(body)]).reshape(-1, 3)
    poses = np.array([moderate_pose(truth, rng, spread=0.3) for _ in range(20)])
    shown = marker_positions(MarkerSensor(truth, segments, places), list(poses))
    found = correct_markers(person, MarkerTrajectories(tuple(m.name for m in person.markers), shown, 100.0))
    assert tilted_deg(found, shown, poses) < 1.0
    for name, moved in LOWER.items():
        assert abs(found.joint_centres_m[name] - moved) < 0.015
    fixed = replace(found, joint_centres_m={}, markers=person.markers)
    assert tilted_deg(fixed, shown, poses) > 2.0


def tilted_deg(person, shown, poses):
    """Mean tilt of the pelvis away from the true poses, degrees, by the best fit of all markers."""
    model = HumanModel.of(person)
    sensor = MarkerSensor(model, [m.segment for m in person.markers], [m.position_m for m in person.markers])
    noise_m = np.array([m.noise_m for m in person.markers])
    posture = PostureSensor(model)
    fits = [fit_pose(sensor, posture, one, noise_m, q).q for one, q in zip(shown, poses, strict=True)]
    turns = [model.difference(q, fit)[4] for q, fit in zip(poses, fits, strict=True)]
    return abs(np.degrees(np.mean(turns)))


def test_too_few_markers_are_refused(model, subject):
    names = [m.name for m in load_protocol("reference36").markers][5:]
    with pytest.raises(NotObservable, match="5 markers"):
        correct_markers(subject, trial(model, subject, lost=names))


def test_wrong_points_do_not_move_a_marker(model, subject):
    """A wrong point under the name of a knee marker in a fifth of the frames, half a metre off."""
    clean = trial(model, subject)
    positions = clean.positions_m.copy()
    positions[::5, clean.names.index("RKNE")] += [0.4, 0.3, 0.0]
    wrong = replace(clean, positions_m=positions)
    found, expected = correct_markers(subject, wrong), correct_markers(subject, clean)
    assert max(moved_mm(expected, found).values()) < 1.0


def test_a_wrong_unit_is_refused(model, subject):
    """Millimetres taken for metres."""
    large = trial(model, subject)
    with pytest.raises(NotConverged, match="--unit"):
        correct_markers(subject, replace(large, positions_m=1e3 * large.positions_m))


@pytest.mark.parametrize("segment", ["right_shank", "pelvis"])
def test_a_steady_segment_is_held_under_all_its_markers(model, subject, segment, monkeypatch):
    """The same shift of all of them is taken for posture, more than if each were on its own."""
    own = [m.name for m in subject.markers if m.segment == segment]
    loose = replace(
        subject,
        markers=tuple(replace(m, session_sd_m=0.03) if m.name in own else m for m in subject.markers),
    )
    rng, shift = np.random.default_rng(3), np.array([0.012, 0.0, 0.0])
    places = np.array([m.position_m + (m.name in own) * shift for m in loose.markers])
    sensor = MarkerSensor(model, [m.segment for m in loose.markers], places)
    seen = marker_positions(sensor, [moderate_pose(model, rng, spread=0.6) for _ in range(20)])
    shifted = MarkerTrajectories(tuple(m.name for m in loose.markers), seen, 100.0)

    def common_mm():
        pairs = zip(loose.markers, correct_markers(loose, shifted).markers, strict=True)
        moved = [b.position_m - a.position_m for a, b in pairs if a.name in own]
        return 1e3 * np.linalg.norm(np.mean(moved, axis=0))

    held = common_mm()
    monkeypatch.setattr(correction, "COMMON_SD_M", 10.0)
    assert held < 0.7 * common_mm()


@pytest.mark.parametrize(("points", "directions"), [(1, 3), (2, 5), (3, 6), (5, 6)])
def test_rigid_displacements_are_what_small_motions_do(points, directions):
    rng = np.random.default_rng(points)
    places, turn, shift = rng.normal(size=(points, 3)), rng.normal(size=3), rng.normal(size=3)
    basis = rigid_displacements(places)
    assert basis.shape == (3 * points, directions)
    np.testing.assert_allclose(basis.T @ basis, np.eye(directions), atol=1e-12)
    moved = (shift + np.cross(turn, places)).ravel()
    np.testing.assert_allclose(basis @ (basis.T @ moved), moved, atol=1e-12)
