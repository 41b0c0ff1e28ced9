"""Markers of OpenSim's files on the reference body: by construction, and against the sets that come with mbkf."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.capture import read_capture
from mbkf.model.body_file import load_body
from mbkf.model.protocol import load_protocol
from mbkf.model.sides import mirrored
from mbkf.trial.protocol.check import BAD, check_set
from mbkf.trial.protocol.from_osim import FIXED_SD_M, FREE_SD_M, import_osim
from tests.osim_files import marker_set, osim_3, osim_4, skeleton

BODY = load_body("human18")


@pytest.fixture
def imported(tmp_path):
    def read(text, name="model.osim"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return import_osim(tmp_path / name)

    return read


def on(found, name):
    (marker,) = (marker for marker in found.protocol.markers if marker.name == name)
    return marker


FORMS = {"3": osim_3, "4": osim_4, "4 turned": lambda joints, markers: osim_4(joints, markers, "0.4 0.5 -1")}


@pytest.mark.parametrize("form", FORMS)
def test_joint_centres_land_on_the_reference_body_s(form, imported):
    """In any form, and at any size of the model: the joints of the limbs are where they are."""
    ends = [("thigh", "femur", "tibia"), ("shank", "tibia", "talus"), ("upper_arm", "humerus", "ulna")]
    for size in (0.7, 1.0, 1.3):
        joints = [(p, c, tuple(size * x for x in at)) for p, c, at in skeleton()]
        markers = []
        for segment, body, end in ends:
            (at,) = (at for parent, child, at in joints if (parent, child) == (f"{body}_r", f"{end}_r"))
            markers.append((f"end of {segment}", f"{body}_r", at, True))
        found = imported(FORMS[form](joints, markers))
        for segment, _, end in ends:
            after = {"tibia": "shank", "talus": "foot", "ulna": "forearm"}[end]
            place = on(found, f"end of {segment}")
            assert place.segment == f"right_{segment}"
            assert place.position_m == pytest.approx(BODY.segment(f"right_{after}").origin_m, abs=1e-3)
            assert place.kind == "computed"
        assert found.with_skeleton


def test_axes_and_sides(imported):
    """x forward, y up, z right becomes x forward, y left, z up; the left side mirrors the right one."""
    markers = [
        (f"{side}.{name}", f"{body}_{side}", (x, y, z * (1 if side == "r" else -1)), False)
        for name, body, x, y, z in (
            ("front", "femur", 0.08, -0.2, 0.0), ("outside", "tibia", 0.0, -0.2, 0.06),
            ("wrist", "radius", 0.0, -0.23, 0.06), ("heel", "calcn", -0.02, 0.0, 0.0),
            ("hand", "hand", 0.0, -0.06, 0.03),
        )
        for side in "rl"
    ]  # fmt: skip
    found = imported(osim_4(skeleton(), markers))
    front, outside, heel = (on(found, f"r.{name}").position_m for name in ("front", "outside", "heel"))
    assert front[0] == pytest.approx(0.08 * 0.434 / 0.4, abs=2e-3)
    assert (front[1], front[2]) == pytest.approx((0.0, -0.217), abs=2e-3)
    assert outside[1] == pytest.approx(-0.06 * 0.439 / 0.4, abs=2e-3)
    assert heel[0] < -0.05 and heel[2] < -0.02
    # the palm that faces forward there faces inward here: what is outside of the forearm is in front
    wrist = on(found, "r.wrist").position_m
    assert wrist[0] > 0.04 and abs(wrist[1]) < 0.02
    for name in ("front", "outside", "wrist", "heel", "hand"):
        right, left = on(found, f"r.{name}"), on(found, f"l.{name}")
        assert left.segment == mirrored(right.segment)
        assert left.position_m == pytest.approx(right.position_m * [1, -1, 1], abs=1e-3)


def test_kinds_and_spreads(imported):
    found = imported(
        osim_3(
            skeleton(), [("A", "pelvis", (0.0, 0.03, 0.12), True), ("B", "pelvis", (0.0, 0.03, -0.12), False)]
        )
    )
    assert (on(found, "A").kind, on(found, "A").placement_sd_m) == ("anatomical", FIXED_SD_M)
    assert (on(found, "B").kind, on(found, "B").placement_sd_m) == ("technical", FREE_SD_M)


def test_what_the_bodies_do_not_tell_is_told_by_the_place(imported):
    """A head that the model has not, toes that it has welded, and a marker on the joint between them."""
    markers = [
        ("Top", "torso", (0.0, 0.65, 0.0), False),
        ("C7", "torso", (-0.08, 0.43, 0.0), False),
        ("Tip", "calcn_r", (0.26, 0.0, 0.0), False),
        ("Heel", "calcn_r", (-0.02, 0.0, 0.0), False),
        ("Head5", "toes_l", (-0.01, 0.02, -0.05), False),
    ]
    found = imported(osim_3(skeleton(), markers))
    segments = {marker.name: marker.segment for marker in found.protocol.markers}
    assert segments == {
        "Top": "head",
        "C7": "torso",
        "Tip": "right_toes",
        "Heel": "right_foot",
        "Head5": "left_foot",
    }
    assert set(found.moved) == {"Top", "Tip", "Head5"}
    assert found.moved["Top"] == "torso → head"
    assert on(found, "Tip").probability < 0.9 and on(found, "Tip").alternatives[0][0] == "right_foot"
    with_head = imported(osim_3([*skeleton(), ("torso", "head", (0.0, 0.4, 0.0))], markers[:1]))
    assert with_head.moved == {}


@pytest.mark.parametrize(("origin", "version"), [(0.0, 4), (0.3715, 3), (0.5435, 4)])
def test_a_head_that_nothing_joins_is_on_the_head(origin, version, imported):
    """A marker set does not tell where its head begins; wherever that is, the markers land on the same places."""
    heights = {"Front": 0.60, "Top": 0.68, "Chin": 0.50, "Side": 0.62}
    markers = [(name, "head", (0.05, height - origin, 0.0), True) for name, height in heights.items()]
    found = imported(marker_set([*markers, ("C7", "torso", (-0.08, 0.42, 0.0), True)], version))
    for name, height in heights.items():
        assert on(found, name).segment == "head"
        assert on(found, name).position_m[2] == pytest.approx(0.244 + height - 0.3715 - 0.416, abs=0.02)
    assert on(found, "C7").segment == "torso"


def test_markers_on_unknown_bodies_are_ignored_and_none_on_a_known_one_refused(imported):
    found = imported(
        marker_set([("A", "pelvis", (0.0, 0.0, 0.1), True), ("B", "walker", (0.0, 0.0, 0.0), True)], 4)
    )
    assert list(found.protocol.ignored) == ["B"]
    assert not found.with_skeleton
    with pytest.raises(FileFormatError, match="no marker on a known body; its bodies are walker"):
        imported(marker_set([("B", "walker", (0.0, 0.0, 0.0), True)], 4))
    with pytest.raises(InvalidInput, match="convert the file to metres"):
        imported(marker_set([("A", "pelvis", (10.0, 20.0, 130.0), True)], 4))


DAMAGE = {
    "whole": lambda text: text,
    "a bare ampersand": lambda text: text.replace('name="made"', 'name="R & D"'),
    "ends are lost": lambda text: (
        text.replace("</Marker>", "").replace("</body>", "").replace("</objects>", "")
    ),
    "comments with dashes": lambda text: text.replace("<location>", "<!-- where -- here --><location>"),
    "broken off": lambda text: text.removesuffix("</MarkerSet></Model></OpenSimDocument>"),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_damaged_files_give_the_same_places(kind, imported):
    markers = [("A", "pelvis", (0.0, 0.03, 0.12), True), ("B", "femur_l", (0.05, -0.2, 0.0), False)]
    whole = imported(osim_3(skeleton(), markers)).protocol.markers
    damaged = imported(DAMAGE[kind](osim_3(skeleton(), markers))).protocol.markers
    assert [(m.name, m.segment, m.kind) for m in damaged] == [(m.name, m.segment, m.kind) for m in whole]
    for one, other in zip(damaged, whole, strict=True):
        assert one.position_m == pytest.approx(other.position_m)


REAL = [
    (
        "rajagopal_walk_run/reference_walk/subject_walk_scaled.osim",
        "rajagopal_walk",
        "rajagopal_walk_run/static_walk_1.trc",
    ),
    ("gait2354_walk/reference/subject01_simbody.osim", "gait2354", "gait2354_walk/subject01_static.trc"),
    ("synthetic_exact_truth/subject01_model.osim", "rajagopal_run", "rajagopal_walk_run/static_run.trc"),
    (
        "autolabel_unlabelled_fullbody/MarkerSet.xml",
        "autolabel62",
        "autolabel_unlabelled_fullbody/PronetoRun01_labelled.c3d",
    ),
]


@pytest.mark.parametrize(("file", "name", "capture"), REAL)
def test_public_files_agree_with_the_shipped_sets_and_fit_their_captures(file, name, capture, real_data):
    """Same segments (a joint's centre belongs to two), places within the size of flesh, and a person that fits."""
    found = import_osim(real_data / file).protocol
    match = load_protocol(name).match([marker.name for marker in found.markers])
    pairs = [(marker, match[marker.name]) for marker in found.markers if marker.name in match]
    assert len(pairs) > 0.8 * len(found.markers)
    apart = [
        (a.name, a.segment, b.segment) for a, b in pairs if a.segment != b.segment and b.kind != "computed"
    ]
    assert apart == []
    away = np.array([np.linalg.norm(a.position_m - b.position_m) for a, b in pairs if a.segment == b.segment])
    assert np.median(away) < 0.025
    assert np.sqrt(np.mean(away**2)) < 0.035
    checked = check_set(found, read_capture(real_data / capture))
    assert checked.verdict != BAD
    assert checked.rms_mm < 10.0
