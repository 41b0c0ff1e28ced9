"""Choices of a person on a marker set: what they change and what they leave."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.model.protocol import load_protocol
from mbkf.trial.protocol.editing import Choice, edited, starting_set
from mbkf.trial.protocol.standing import stand_beside
from tests.captures import made_capture

PROTOCOL = load_protocol("reference36")
FIRST = PROTOCOL.markers[0].name


@pytest.fixture(scope="module")
def standing():
    return stand_beside(made_capture(10, 0.0), PROTOCOL)


def named(protocol):
    return {marker.name: marker for marker in protocol.markers}


def test_no_choice_changes_nothing_but_the_name(standing):
    found = edited(PROTOCOL, standing, {}, "mine")
    assert found.name == "mine"
    assert found.markers == PROTOCOL.markers
    assert dict(found.ignored) == {}
    assert "by hand" in found.source
    assert edited(found, standing, {}, "mine").source == found.source


def test_a_marker_is_moved_to_a_segment_at_the_place_where_it_is(standing):
    found = named(edited(PROTOCOL, standing, {FIRST: Choice(segment="left_hand")}, "mine"))[FIRST]
    point = standing.points_m[standing.names.index(FIRST)]
    assert (found.segment, found.kind, found.landmark) == ("left_hand", "technical", "")
    assert found.position_m == pytest.approx(standing.to_reference("left_hand", point), abs=1e-4)
    assert found.noise_m == named(PROTOCOL)[FIRST].noise_m


def test_a_marker_is_moved_to_a_landmark(standing):
    found = named(edited(PROTOCOL, standing, {FIRST: Choice(landmark="left_knee_medial")}, "mine"))[FIRST]
    landmark = PROTOCOL.body.landmark("left_knee_medial")
    assert (found.segment, found.kind, found.landmark) == ("left_thigh", "anatomical", "left_knee_medial")
    assert np.array_equal(found.position_m, landmark.position_m)


def test_a_marker_is_left_out_and_taken_in_again(standing):
    out = edited(PROTOCOL, standing, {FIRST: Choice(ignored="loose")}, "mine")
    assert FIRST not in named(out)
    assert dict(out.ignored) == {FIRST: "loose"}
    again = edited(out, standing, {FIRST: Choice(segment="torso")}, "mine")
    assert named(again)[FIRST].segment == "torso"
    assert dict(again.ignored) == {}


def test_confirming_takes_the_doubt(standing):
    doubtful = replace(PROTOCOL.markers[0], probability=0.6, alternatives=(("head", 0.4),))
    before = replace(PROTOCOL, markers=(doubtful, *PROTOCOL.markers[1:]))
    found = named(edited(before, standing, {FIRST: Choice()}, "mine"))[FIRST]
    assert found == PROTOCOL.markers[0]


def test_a_marker_is_known_by_the_capture_s_name_for_it(standing):
    other = replace(PROTOCOL.markers[0], name="another", aliases=(FIRST,))
    before = replace(PROTOCOL, markers=(other, *PROTOCOL.markers[1:]))
    found = edited(before, standing, {FIRST: Choice(segment="head")}, "mine")
    assert named(found)["another"].segment == "head"
    assert named(found)["another"].aliases == (FIRST,)
    out = edited(before, standing, {FIRST: Choice(ignored="loose")}, "mine")
    assert "another" not in named(out) and dict(out.ignored) == {FIRST: "loose"}


@pytest.mark.parametrize(
    ("name", "choice", "error"),
    [
        ("nobody", Choice(segment="head"), UnknownName),
        (FIRST, Choice(segment="tail"), UnknownName),
        (FIRST, Choice(landmark="tip_of_tail"), UnknownName),
        ("unseen", Choice(segment="head"), InvalidInput),
    ],
)
def test_what_cannot_be_is_refused(name, choice, error, standing):
    unseen = replace(PROTOCOL.markers[0], name="unseen")
    before = replace(PROTOCOL, markers=(*PROTOCOL.markers, unseen))
    with pytest.raises(error):
        edited(before, standing, {name: choice}, "mine")


def renamed(markers):
    return replace(markers, names=tuple(f"m{k}" for k in range(len(markers.names))))


def test_where_a_set_begins(tmp_path):
    capture = made_capture(2, 0.0)
    found, same = starting_set(capture, None)
    assert found.name == "reference36" and same is capture
    assert starting_set(capture, "gait2354")[0].name == "gait2354"
    few = replace(capture, markers=renamed(capture.markers.select(capture.markers.names[:4])))
    found, same = starting_set(few, None)
    assert found.markers == () and same is few
    with pytest.raises(FileFormatError):
        starting_set(capture, str(tmp_path / "none.toml"))


@pytest.mark.parametrize("amplitude", [0.0, 0.4])
def test_markers_whose_names_tell_nothing_are_inferred(amplitude):
    capture = made_capture(40, amplitude)
    found, _ = starting_set(replace(capture, markers=renamed(capture.markers)), None)
    truth = {f"m{k}": PROTOCOL.match([name])[name].segment for k, name in enumerate(capture.markers.names)}
    right = [marker.name for marker in found.markers if truth[marker.name] == marker.segment]
    assert len(right) > 0.7 * len(truth)
