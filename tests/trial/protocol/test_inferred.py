"""Marker sets made for captures that no shipped one explains: what is told of them, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotObservable
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.model.body_file import load_body
from mbkf.trial.protocol.inferred import (
    COMPUTED,
    DOUBTFUL_NOISE,
    NAME,
    OBJECT,
    OFF_BODY,
    infer_marker_set,
    worn_markers,
)
from tests.marker_sets.worn import box_at, near, standing, walking

BODY = load_body()
SET = "plug_in_gait"


def capture_of(worn, **changes):
    return Capture("static.c3d", replace(worn.markers, **changes))


@pytest.fixture(scope="module")
def worn():
    return standing(SET, 1)


@pytest.fixture(scope="module")
def hidden():
    """Person and box without names, standing and walking."""
    static, moving = (one.beside(box_at(0.8, 1.2, 0.0)) for one in walking(SET, 1))
    names = {name: f"M{k:02d}" for k, name in enumerate(static.markers.names)}
    captures = [capture_of(one, names=tuple(names[n] for n in one.markers.names)) for one in (static, moving)]
    truth = {names[name]: segment for name, segment in static.segments.items()}
    return infer_marker_set(captures[0], captures[1:], leave_out=[SET]), truth


def test_it_is_a_protocol_of_the_body(hidden):
    found, truth = hidden
    assert found.protocol.name == NAME
    on_body = {name for name, segment in truth.items() if segment}
    assert {marker.name for marker in found.protocol.markers} == on_body
    assert np.mean([near(one.segment, truth[one.name]) for one in found.protocol.markers]) >= 0.95
    for marker in found.protocol.markers:
        BODY.segment(marker.segment)
        if marker.landmark:
            np.testing.assert_array_equal(marker.position_m, BODY.landmark(marker.landmark).position_m)
            assert BODY.landmark(marker.landmark).segment == marker.segment
    assert found.rms_m < 0.02


def test_points_of_a_box_are_left_out_and_told(hidden):
    found, truth = hidden
    box = {name for name, segment in truth.items() if not segment}
    assert found.protocol.ignored == dict.fromkeys(box, OFF_BODY)
    assert all(name in found.line for name in box)


def test_a_landmark_carries_one_marker(hidden):
    taken = [marker.landmark for marker in hidden[0].protocol.markers if marker.landmark]
    assert len(set(taken)) == len(taken)


def test_the_line_counts_what_was_found(hidden):
    found, _ = hidden
    segments = len({marker.segment for marker in found.protocol.markers})
    assert f"{len(found.protocol.markers)} markers on {segments} segments (the whole body)" in found.line
    assert f"{len(found.doubtful)} doubtful" in found.line
    assert set(found.doubts) == set(found.doubtful)


def test_doubtful_markers_follow_loosely(hidden):
    """Their noise is so many times that of their place; none of the sure ones has more than the places have."""
    markers = hidden[0].protocol.markers
    sure = [one.noise_m for one in markers if one.probability >= 0.9]
    assert max(sure) <= 0.015
    for one in markers:
        if one.probability < 0.9:
            assert one.noise_m >= DOUBTFUL_NOISE * min(sure)


def test_names_of_objects_and_computed_points_are_left_out_by_their_names(worn):
    more = worn.beside(np.array([[0.4, -0.3, 0.9], [0.4, -0.3, 1.0]]))
    names = (*worn.markers.names, "Box1", "CentreOfMass")
    found = infer_marker_set(capture_of(more, names=names), leave_out=[SET])
    assert found.protocol.ignored["Box1"] == OBJECT
    assert found.protocol.ignored["CentreOfMass"] == COMPUTED


def test_with_names_every_marker_is_right(worn):
    found = infer_marker_set(capture_of(worn), leave_out=[SET])
    assert all(near(one.segment, worn.segments[one.name]) for one in found.protocol.markers)
    assert len(found.protocol.markers) == len(worn.segments)


def test_without_captures_nothing_is_inferred():
    with pytest.raises(InvalidInput, match="a static trial, moving trials, or both"):
        infer_marker_set(None)


def test_eleven_markers_are_refused(worn):
    few = Capture("", worn.markers.select(worn.markers.names[-11:]))
    with pytest.raises(NotObservable, match=r"11 markers of a body .* fewer than 12 do not show"):
        infer_marker_set(few)


def test_markers_of_one_segment_are_refused(worn):
    """A dozen markers about one thigh are no person, wherever they would fit best."""
    rng = np.random.default_rng(3)
    angle, height = rng.uniform(0, 2 * np.pi, 14), rng.uniform(0.55, 0.85, 14)
    points = np.column_stack([0.07 * np.cos(angle), 0.07 * np.sin(angle), height])
    markers = MarkerTrajectories(tuple(f"M{k}" for k in range(14)), np.tile(points, (5, 1, 1)), 100.0)
    with pytest.raises(NotObservable, match="no upright body"):
        infer_marker_set(Capture("", markers))


def test_points_without_a_person_are_refused():
    rng = np.random.default_rng(1)
    points = rng.uniform([-0.3, -0.3, 0.0], [0.3, 0.3, 1.7], (30, 3))
    markers = MarkerTrajectories(tuple(f"M{k}" for k in range(30)), np.tile(points, (5, 1, 1)), 100.0)
    with pytest.raises(NotObservable, match=r"no upright body is found .*--up.*static trial.*--protocol"):
        infer_marker_set(Capture("", markers))


def test_a_person_who_lies_is_put_up_or_refused(worn):
    """Without names he may as well stand in a laboratory whose axes are others: but no wrong set may come of it."""
    names = tuple(f"M{k}" for k in range(len(worn.segments)))
    lying = worn.moved(lambda points: points @ np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]))
    try:
        found = infer_marker_set(capture_of(lying, names=names), leave_out=[SET])
    except NotObservable as error:
        assert "--up" in str(error)
        return
    truth = dict(zip(names, worn.segments.values(), strict=True))
    assert np.mean([near(one.segment, truth[one.name]) for one in found.protocol.markers]) >= 0.95
    assert "axes put right" in found.captures[0].notes[-1]


def test_a_cluster_at_the_heel_is_behind_and_below_the_ankle(worn):
    """Four markers at each heel and none on the forefoot; soles are level in standing."""
    own = [name for name, segment in worn.segments.items() if not segment.endswith("foot")]
    ankles = {s: worn.markers.positions_m[:, worn.markers.names.index(f"{s}ANK")] for s in "RL"}
    cluster = np.array(
        [[-0.05, 0.0, -0.03], [-0.06, 0.02, -0.06], [-0.06, -0.02, -0.05], [-0.07, 0.0, -0.04]]
    )
    kept = worn.markers.select(own)
    points, names = [kept.positions_m], [*own]
    for side, inwards in (("R", 0.04), ("L", -0.04)):
        points.append(ankles[side][:, None] + cluster + [0.0, inwards, 0.0])
        names += [f"{side}_foot_{k}" for k in range(4)]
    markers = MarkerTrajectories(tuple(names), np.concatenate(points, axis=1), 100.0)
    found = infer_marker_set(Capture("", markers), leave_out=[SET])
    feet = [one for one in found.protocol.markers if "_foot_" in one.name]
    assert len(feet) == 8
    for one in feet:
        assert one.segment == ("right_foot" if one.name.startswith("R") else "left_foot")
        assert -0.11 < one.position_m[0] < -0.02
        assert -0.08 < one.position_m[2] < 0.0


def test_heels_of_a_public_runner(real_data):
    found = infer_marker_set(read_capture(real_data / "strangers3" / "clusters_heel_only.trc"))
    for side in ("right", "left"):
        own = [one.position_m for one in found.protocol.markers if one.segment == f"{side}_foot"]
        assert len(own) == 4
        np.testing.assert_allclose(np.mean(own, axis=0)[[0, 2]], [-0.06, -0.04], atol=0.02)


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (
            [f"R{f}{j}" for f in ("THUMB", "INDEX", "PINKY") for j in ("MCP", "PIP", "DIP", "TIP")],
            "right hand",
        ),
        ([f"JAW{k}" for k in range(8)], "head"),
    ],
)
def test_parts_of_a_body_are_named(names, words):
    rng = np.random.default_rng(2)
    points = rng.uniform([-0.1, -0.1, 1.0], [0.1, 0.1, 1.1], (len(names), 3))
    markers = MarkerTrajectories(tuple(names), np.tile(points, (5, 1, 1)), 100.0)
    with pytest.raises(NotObservable, match=f"mean {words}; no marker is on .*trunk.*legs") as refused:
        infer_marker_set(Capture("", markers))
    assert "--unit" not in str(refused.value)


def test_a_capture_that_hardly_shows_a_marker_does_not_place_it(worn):
    """A ghost of one frame in standing, and the marker itself in the other trial."""
    first = replace(worn.markers, positions_m=np.tile(worn.markers.positions_m, (10, 1, 1)))
    ghost = first.positions_m.copy()
    ghost[1:, 0] = np.nan
    static, trial = (Capture("", replace(first, positions_m=points)) for points in (ghost, first.positions_m))
    shown, other = worn_markers([static, trial], ())
    assert shown.names == first.names[1:]
    assert other.names == first.names
    assert worn_markers([static], ())[0].names == first.names, "no other capture shows it"


def test_points_without_names_are_to_be_named():
    markers = MarkerTrajectories(tuple(f"*{k}" for k in range(30)), np.zeros((5, 30, 3)), 100.0)
    with pytest.raises(NotObservable, match="no marker that is seen has a name; name them with 'mbkf label'"):
        infer_marker_set(None, [Capture("", markers)])
