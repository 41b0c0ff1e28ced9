"""The axes that angles are read in, found on a person: markers where they are worn, landmarks elsewhere."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.trial.results.readings import anatomical_places, angle_reading

ON_LANDMARKS = {
    "ASI": "asis", "PSI": "psis", "KNE": "knee_lateral", "ANK": "ankle_lateral", "HEE": "heel", "TOE": "metatarsal_2",
}  # fmt: skip


@pytest.fixture(scope="module")
def model():
    return HumanModel.scaled({"right_thigh": 1.05, "pelvis_width": 0.95}, 70.0)


def on_landmark(model, name, landmark, moved_m=(0.0, 0.0, 0.0)):
    place = model.description.landmark(landmark)
    scale = model.axis_scale(model.description.segment(place.segment))
    return SubjectMarker(name, place.segment, scale * place.position_m + moved_m, 0.005, 0.005)


def person(markers, protocol="made up"):
    return Subject("human18", 70.0, {}, tuple(markers), protocol)


def worn(model, moved_m=(0.0, 0.0, 0.0)):
    return [
        on_landmark(model, letter + name, f"{side}_{landmark}", moved_m)
        for name, landmark in ON_LANDMARKS.items()
        for letter, side in (("R", "right"), ("L", "left"))
    ]


def angles_of(model, subject, q):
    return ClinicalAngles(model, angle_reading("pig", model, subject, {})).angles(q)


def test_the_models_own_angles_are_asked_for_by_name(model):
    assert not angle_reading("model", model, person([]), {}).joints
    with pytest.raises(UnknownName, match="pig"):
        angle_reading("plug", model, person([]), {})


def test_markers_on_the_landmarks_or_none_make_the_same_angles(model):
    """Fewer markers of the same person keep the angles; so do more of other kinds."""
    rng = np.random.default_rng(0)
    q = np.array([model.integrate(model.neutral(), rng.uniform(-0.3, 0.3, model.nv)) for _ in range(5)])
    everything = worn(model)
    without_back = [m for m in everything if "PSI" not in m.name]
    sacrum = on_landmark(model, "SACR", "sacrum")
    others = SubjectMarker("XYZ", "torso", np.array([0.1, 0.0, 0.2]), 0.005, 0.005)
    expected = angles_of(model, person([*without_back, sacrum]), q)
    for markers in ([], everything[2:3], [*without_back, others], [*without_back, sacrum, others]):
        np.testing.assert_allclose(angles_of(model, person(markers), q), expected, atol=1e-12)


def test_a_marker_goes_before_the_landmark(model):
    moved = np.array([0.01, -0.02, 0.005])
    bare, dressed = anatomical_places(model, person([])), anatomical_places(model, person(worn(model, moved)))
    for name in ("right_asis", "left_knee", "right_heel", "left_toe"):
        np.testing.assert_allclose(dressed[name] - bare[name], moved, atol=1e-12)
    np.testing.assert_array_equal(dressed["right_knee_medial"], bare["right_knee_medial"])


def test_both_psis_stand_for_a_sacrum_that_is_not_worn(model):
    places = anatomical_places(model, person(worn(model)))
    np.testing.assert_allclose(places["sacrum"], 0.5 * (places["right_psis"] + places["left_psis"]))
    sacrum = on_landmark(model, "SACR", "sacrum", (0.0, 0.01, 0.0))
    with_it = anatomical_places(model, person([*worn(model), sacrum]))["sacrum"]
    assert with_it[1] == pytest.approx(places["sacrum"][1] + 0.01)


def test_wands_are_there_only_with_their_markers(model):
    assert not [name for name in anatomical_places(model, person([])) if "wand" in name]
    wand = SubjectMarker("RTHI", "right_thigh", np.array([0.0, -0.1, -0.2]), 0.005, 0.005)
    elsewhere = SubjectMarker("LTHI", "pelvis", np.array([0.0, 0.1, 0.0]), 0.005, 0.005)
    places = anatomical_places(model, person([wand, elsewhere]))
    assert "right_thigh_wand" in places and "left_thigh_wand" not in places


def test_markers_with_other_names_are_known_by_their_sets_landmarks(model):
    """Rajagopal's set calls the right ASIS R.ASIS."""
    moved = np.array([0.0, 0.0, 0.01])
    marker = on_landmark(model, "R.ASIS", "right_asis", moved)
    bare = anatomical_places(model, person([]))["right_asis"]
    known = anatomical_places(model, person([marker], "rajagopal_walk"))["right_asis"]
    np.testing.assert_allclose(known - bare, moved, atol=1e-12)
    np.testing.assert_array_equal(anatomical_places(model, person([marker]))["right_asis"], bare)


def test_the_isbs_axes_are_a_reading_of_their_own(model):
    reading = angle_reading("isb", model, person(worn(model)), {})
    assert reading.name == "isb" and set(reading.joints) == {
        "pelvis", "hip_r", "hip_l", "knee_r", "knee_l", "ankle_r", "ankle_l",
    }  # fmt: skip


def test_a_body_without_the_landmarks_is_refused(model):
    left = {name: place for name, place in model.description.landmarks.items() if "knee_medial" not in name}
    bare = HumanModel(replace(model.description, landmarks=left), model.scale, 70.0)
    with pytest.raises(InvalidInput, match=r"right_knee_medial.*--angles model"):
        angle_reading("pig", bare, person([]), {})
