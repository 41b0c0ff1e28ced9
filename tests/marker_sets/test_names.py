"""Names of markers tell their place: shipped protocols, public sets, and the symmetries that a reading must have."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mbkf.marker_sets.names import KINDS, NameReading, read_names
from mbkf.marker_sets.spelling import load_dictionary
from mbkf.model.body_file import load_body
from mbkf.model.protocol import load_protocol, protocol_names
from mbkf.model.sides import mirrored
from tests.marker_sets.held_out_sets import HELD_OUT, HELD_OUT_LAST, HELD_OUT_LATER
from tests.marker_sets.known_sets import BUILT_ON, markers

SURE = 0.8
ALL_SETS = BUILT_ON | HELD_OUT | HELD_OUT_LATER | HELD_OUT_LAST
ANOTHER_PLACE = {"RFT3", "LFT3", "RTOE", "LTOE", "RMEP", "LMEP", "backneck", "RHGT", "LHGT", "LV1"}
"""Names of the sets whose likelier meaning is another one: finger tip or foot, toe, epicondyle of elbow or knee, back
of the shoulder or tubercle of the arm, first lumbar vertebra."""
KEYPOINTS = ("Hip", "Knee", "Ankle", "BigToe", "Heel", "Shoulder", "Elbow", "Wrist")
CORES = sorted(
    spelling
    for spelling, group in load_dictionary().spellings.places.items()
    if len(spelling) >= 3 and group.places and not group.middle and group.kind == "marker"
)


def segments(reading: NameReading) -> dict[str, float]:
    """Probability by segment."""
    odds: dict[str, float] = {}
    for place in reading.places:
        odds[place.segment] = odds.get(place.segment, 0.0) + place.probability
    return odds


def likeliest(reading: NameReading) -> tuple[str, float]:
    odds = segments(reading)
    return max(odds.items(), key=lambda item: item[1])


def reading_landmarks(reading: NameReading) -> set[str]:
    return {place.landmark for place in reading.places} - {""}


def segments_meet(one: str, other: str) -> bool:
    """Whether two segments are joined: the centre of a joint is a point of both."""
    parents = {segment.name: segment.parent for segment in load_body().segments}
    return one == other or parents[one] == other or parents[other] == one


def mirror_image(reading: NameReading) -> dict[tuple[str, str], float]:
    return {(mirrored(p.segment), mirrored(p.landmark)): p.probability for p in reading.places}


def as_read(reading: NameReading) -> dict[tuple[str, str], float]:
    return {(p.segment, p.landmark): p.probability for p in reading.places}


@pytest.mark.parametrize("name", protocol_names())
def test_names_of_shipped_protocols_are_read_on_their_segments(name):
    protocol = load_protocol(name)
    readings = read_names([marker.name for marker in protocol.markers])
    for marker in protocol.markers:
        reading = readings[marker.name]
        assert reading.places, f"{marker.name} is not read"
        segment, probability = likeliest(reading)
        if marker.kind == "keypoint" and marker.landmark not in ("", *reading_landmarks(reading)):
            assert segments_meet(segment, marker.segment), marker.name
        elif segment != marker.segment:
            assert marker.name in ANOTHER_PLACE or marker.kind == "keypoint", marker.name
            assert probability <= SURE or segments_meet(segment, marker.segment), marker.name


@pytest.mark.parametrize("name", protocol_names())
def test_landmarks_of_shipped_protocols_are_named_or_left_open(name):
    """A reading with a landmark names the protocol's; only the heel's height is not told by its name."""
    protocol = load_protocol(name)
    readings = read_names([marker.name for marker in protocol.markers])
    for marker in protocol.markers:
        named = {place.landmark for place in readings[marker.name].places} - {""}
        if marker.landmark and named and not marker.landmark.endswith("_heel_low"):
            assert marker.landmark in named, marker.name


@pytest.mark.parametrize("name", ALL_SETS)
def test_names_of_public_sets_are_read_on_their_segments(name):
    truth = markers(ALL_SETS[name])
    readings = read_names(list(truth))
    body = [marker for marker, segment in truth.items() if segment]
    for marker in body:
        assert readings[marker].places, f"{marker} is not read"
        segment, probability = likeliest(readings[marker])
        if segment != truth[marker]:
            assert marker in ANOTHER_PLACE, f"{marker}: {segment} instead of {truth[marker]}"
            assert probability <= SURE
            assert segments(readings[marker])[truth[marker]] > 0.05, "its place is among the possible ones"
    for marker in set(truth) - set(body):
        assert not readings[marker].places, f"{marker} is no marker of the body"


def test_probabilities_are_honest_over_the_public_sets():
    """Readings that are given a probability are right about as often: the mean of both over all sets is close."""
    told, right = [], []
    for groups in ALL_SETS.values():
        truth = markers(groups)
        for marker, reading in read_names(list(truth)).items():
            if truth[marker] and reading.places:
                segment, probability = likeliest(reading)
                told.append(probability)
                right.append(segment == truth[marker])
    assert np.mean(right) >= np.mean(told), "the dictionary does not boast"


@given(st.lists(st.sampled_from(CORES), min_size=2, max_size=12, unique=True), st.sampled_from("._- "))
@settings(max_examples=60, deadline=None)
def test_swapping_sides_mirrors_every_reading(cores, separator):
    names = [f"{letter}{separator}{core}" for core, letter in zip(cores, "RLLRRLRLLRLR", strict=False)]
    swapped = [("L" if name[0] == "R" else "R") + name[1:] for name in names]
    there, back = read_names(names), read_names(swapped)
    for name, other in zip(names, swapped, strict=True):
        image, read = mirror_image(there[name]), as_read(back[other])
        for place in image.keys() | read.keys():
            assert image.get(place, 0.0) == pytest.approx(read.get(place, 0.0), abs=0.15), (name, place)
        assert there[name].kind == back[other].kind


@given(
    st.lists(st.sampled_from(CORES), min_size=3, max_size=10, unique=True),
    st.sampled_from(["{}{}", "{1}{0}"]),
)
@settings(max_examples=60, deadline=None)
def test_both_sides_of_a_set_are_read_alike(cores, form):
    form = form.replace("{}{}", "{0}{1}")
    names = {side: [form.format(side, core) for core in cores] for side in "RL"}
    assume(len({*names["R"], *names["L"]}) == 2 * len(cores))
    assume(not {core[0] for core in cores} & {"r", "l"} and not {core[-1] for core in cores} & {"r", "l"})
    readings = read_names([*names["R"], *names["L"]])
    for right, left in zip(names["R"], names["L"], strict=True):
        image, read = mirror_image(readings[right]), as_read(readings[left])
        for place in image.keys() | read.keys():
            assert image.get(place, 0.0) == pytest.approx(read.get(place, 0.0), abs=0.2), (right, place)


@given(st.sampled_from(sorted(ALL_SETS)))
@settings(max_examples=20, deadline=None)
def test_probabilities_add_up_to_one_at_most_and_fall(name):
    body = load_body("human18")
    known = {segment.name for segment in body.segments}
    for reading in read_names(list(markers(ALL_SETS[name]))).values():
        odds = [place.probability for place in reading.places]
        assert sum(odds) <= 1 + 1e-9
        assert odds == sorted(odds, reverse=True)
        assert reading.kind in KINDS
        for place in reading.places:
            assert place.segment in known
            assert not place.landmark or body.landmark(place.landmark).segment == place.segment


FORMS = ("Subject01:{}", "S07_{}", "Skeleton 1:{}", "Q_{}", "{}_study", "AB12_2024_{}")
FORMS_OF_PROTOCOLS = [
    (name, FORMS[(k + shift) % len(FORMS)]) for k, name in enumerate(protocol_names()) for shift in (0, 3)
]
"""Each protocol in two forms, each form in a third of the protocols."""


@pytest.mark.parametrize(("name", "form"), FORMS_OF_PROTOCOLS)
def test_what_all_names_carry_changes_nothing(name, form):
    names = [marker.name for marker in load_protocol(name).markers]
    plain, dressed = read_names(names), read_names([form.format(one) for one in names])
    for one in names:
        other = dressed[form.format(one)]
        assert (plain[one].places, plain[one].kind, plain[one].side) == (other.places, other.kind, other.side)


@pytest.mark.parametrize("name", protocol_names())
def test_case_and_separators_change_no_place(name):
    names = [marker.name for marker in load_protocol(name).markers]
    plain = read_names(names)
    for change in (
        str.upper,
        str.lower,
        lambda one: one.replace(".", "_"),
        lambda one: one.replace(".", " "),
    ):
        changed = read_names([change(one) for one in names])
        for one in names:
            assert likeliest(changed[change(one)])[0] == likeliest(plain[one])[0], change(one)


def test_the_order_of_names_changes_nothing():
    names = list(markers(BUILT_ON["pyomeca"]))
    assert read_names(names) == read_names(names[::-1])


@pytest.mark.parametrize(
    "names",
    [
        [f"M{i:02d}" for i in range(1, 40)],
        [f"marker_{i}" for i in range(12)],
        [f"*{i}" for i in range(75)],
        [f"U{i}" for i in range(30, 40)],
        [f"Unlabeled {i}" for i in range(1040, 1050)],
        [f"C_{i}" for i in range(1000, 1010)],
        [f"{letter}{i}" for letter in "LR" for i in range(1, 6)],
        [f"S{i}" for i in range(1, 20)],
        [f"T{i}" for i in range(1, 5)],
        ["", " ", "?", "___", "αβγ", "x" * 200],
    ],
    ids=lambda names: names[0] or "signs",
)
def test_numbers_and_signs_tell_no_place(names):
    for reading in read_names(names).values():
        assert reading.places == ()
        assert reading.kind == "unknown"


@pytest.mark.parametrize(
    ("names", "place"),
    [
        ({"LFC", "MFC", "LM", "MM"}, {"LFC": "knee_lateral", "MFC": "knee_medial", "LM": "ankle_lateral"}),
        ({"RLFC", "LLFC", "RMFC", "LMFC"}, {"LLFC": "left_knee_lateral", "LMFC": "left_knee_medial"}),
        ({"LKNE", "MKNE"}, {"LKNE": "knee_lateral", "MKNE": "knee_medial"}),
        ({"LKNE", "RKNE", "LKNM", "RKNM"}, {"LKNE": "left_knee_lateral", "LKNM": "left_knee_medial"}),
        ({"KNEER", "KNEEL", "ANKR", "ANKL"}, {"KNEEL": "left_knee_lateral", "ANKR": "right_ankle_lateral"}),
        ({"KNEL", "KNEM", "HEEL"}, {"KNEL": "knee_lateral", "HEEL": "heel"}),
    ],
)
def test_an_l_is_left_or_lateral_by_its_company(names, place):
    readings = read_names(sorted(names))
    for name, landmark in place.items():
        named = [one.landmark for one in readings[name].places]
        sided = landmark.startswith(("left", "right"))
        assert (named[0] == landmark) if sided else {f"left_{landmark}", f"right_{landmark}"} <= set(named)
        assert bool(readings[name].side) == sided


def test_a_name_without_a_side_is_on_either():
    reading = read_names(["KNEE", "ANKLE", "HEEL"])["KNEE"]
    assert segments(reading)["right_thigh"] == pytest.approx(segments(reading)["left_thigh"])
    assert reading.side == ""


def test_vertebrae_and_clusters_of_the_same_name():
    spine = read_names(["C7", "T1", "T2", "T10", "L4"])
    assert {likeliest(spine[name])[0] for name in ("C7", "T1", "T2", "T10")} == {"torso"}
    assert likeliest(spine["L4"])[0] == "pelvis"
    assert spine["T2"].side == "middle"
    legs = read_names(["RT1", "LT1", "RT2", "LT2", "RT3", "LT3"])
    assert set(segments(legs["RT1"])) == {"right_thigh", "right_shank"}
    assert likeliest(legs["RT1"])[1] <= 0.5


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ("genou_lat_D genou_lat_G", "thigh"),
        ("cheville_D cheville_G", "shank"),
        ("talon_D talon_G", "foot"),
        ("Knie_aussen_re Knie_aussen_li", "thigh"),
        ("Knöchel_re Knöchel_li", "shank"),
        ("Fuß_rechts Fuß_links", "foot"),
        ("ginocchio_dx ginocchio_sx", "thigh"),
        ("rodilla_der rodilla_izq", "thigh"),
        ("joelho_direito joelho_esquerdo", "thigh"),
    ],
)
def test_words_of_other_languages(names, words):
    right, left = (reading for reading in read_names(names.split()).values())
    assert likeliest(right)[0] == f"right_{words}"
    assert likeliest(left)[0] == f"left_{words}"


def test_points_of_a_markerless_system_are_centres_of_joints():
    points = ["Nose", "Neck", "Head", *(f"{side}{point}" for point in KEYPOINTS for side in "RL")]
    augmented = ["r_knee_study", "L_knee_study", "r_ankle_study", "L_ankle_study", "C7_study", "r.ASIS_study"]
    readings = read_names([*points, *augmented])
    assert {readings[name].kind for name in points} == {"keypoint"}
    assert readings["LKnee"].places[0].landmark == "left_knee_centre"
    assert readings["RHip"].places[0].landmark == "right_hip_centre"
    assert {readings[name].kind for name in augmented} == {"marker"}
    assert readings["L_knee_study"].places[0].landmark == "left_knee_lateral"


@pytest.mark.parametrize(
    ("name", "landmark"),
    [
        ("RHJC", "right_hip_centre"),
        ("L.KneeJoint", "left_knee_centre"),
        ("Right_Ankle_Joint_Center", "right_ankle_centre"),
        ("RKneeGround", ""),
        ("Mid_ASIS", ""),
        ("PELO", None),
        ("CentreOfMass", None),
        ("LHipAngles", None),
        ("RKNEv", "right_knee_lateral"),
    ],
)
def test_points_that_software_made(name, landmark):
    reading = read_names(["RASI", "LASI", "RKNE", "LKNE", "RANK", "LANK", name])[name]
    assert reading.kind == "computed"
    assert [place.landmark for place in reading.places][:1] == ([] if landmark is None else [landmark])


@pytest.mark.parametrize(
    "name",
    [
        "Box1",
        "BoxTopLeft",
        "Club3",
        "bat_tip",
        "Chair_back_L",
        "racket_top",
        "crutch_L_tip",
        "FP1_corner1",
        "Wand2",
    ],
)
def test_things_that_are_no_part_of_the_body(name):
    reading = read_names(["RASI", "LASI", "RKNE", "LKNE", name])[name]
    assert (reading.kind, reading.places) == ("object", ())


def test_axes_of_segments_are_points_of_software():
    axes = [f"{side}TI{end}" for side in "RL" for end in "OALP"]
    readings = read_names(["RTIB", "LTIB", *axes])
    assert {readings[name].kind for name in axes} == {"computed"}
    assert readings["RTIB"].kind == "marker"


def test_long_names_are_left_without_a_long_search():
    names = ["thigh" * 20, "lm" * 40, "tib" * 30, "up" * 30 + "knee", "latmedinout" * 20 + "knee"]
    assert all(not reading.places for reading in read_names(names).values())


def test_a_wand_on_a_segment_is_a_marker():
    reading = read_names(["RThighWand", "LThighWand"])["RThighWand"]
    assert (reading.kind, likeliest(reading)[0]) == ("marker", "right_thigh")


@pytest.mark.parametrize(
    "name",
    ["AXIS1", "AXIS_X", "ORIGIN", "RHJC", "LKJC2", "PelvisCOM", "LKneeMoment", "LAnkleForce", "LKneeAngles"],
)
def test_outputs_of_software_are_no_markers(name):
    assert read_names((name, "RASI", "LASI", "RKNE", "LKNE"))[name].kind == "computed"


@pytest.mark.parametrize("name", ["ScapLocTip1", "Wheelchair_R_Handle", "R_Handle"])
def test_tools_and_wheelchairs_are_objects(name):
    assert read_names((name, "RASI", "LASI", "RKNE", "LKNE"))[name].kind == "object"


def test_frames_of_segments_are_read_by_their_names():
    """An origin and the tips of two axes each; one tip alone is a name that means nothing."""
    bodies = {"RULE": "right_thigh", "LLLE": "left_shank", "RFOO": "right_foot", "LLAR": "left_forearm"}
    whole = [*bodies, "LULE", "LFOO", "RLLE", "RLAR"]
    found = read_names([f"{name}{axis}" for name in whole for axis in ("", "Y", "Z")])
    for name, segment in bodies.items():
        for axis in ("", "Y", "Z"):
            assert found[f"{name}{axis}"].kind == "marker"
            assert likeliest(found[f"{name}{axis}"])[0] == segment
    assert read_names(["RASI", "LASI", "RULEY", "RULE"])["RULEY"].places == ()
