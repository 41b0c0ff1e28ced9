"""The verdict on a marker set: right sets pass, changed ones are found out."""

from dataclasses import replace

import pytest

from mbkf.model.protocol import load_protocol
from mbkf.trial.protocol.check import BAD, DOUBTFUL, OK, check_set
from tests.captures import made_capture

PROTOCOL = load_protocol("reference36")
STANDING = made_capture(20, 0.0)


def exchanged(protocol, one, other):
    """The set with the names of two markers exchanged."""
    names = {one: other, other: one}
    return replace(
        protocol, markers=tuple(replace(m, name=names.get(m.name, m.name)) for m in protocol.markers)
    )


@pytest.mark.parametrize("amplitude", [0.0, 0.3])
def test_the_right_set_is_right(amplitude):
    found = check_set(PROTOCOL, made_capture(40, amplitude))
    assert (found.verdict, found.reasons, found.trouble) == (OK, (), "")
    assert found.rms_mm is not None and found.rms_mm < 5.0
    assert found.absent == ()
    assert len(found.markers) == len(STANDING.markers.names)
    assert not any(one.far for one in found.markers)


@pytest.mark.parametrize(
    ("one", "other"),
    [("right_knee_lateral", "right_ankle_lateral"), ("right_knee_lateral", "left_knee_lateral")],
)
def test_exchanged_names_are_found_and_named_first(one, other):
    """Also in a standing trial, to whose single posture anything can be fitted."""
    by_landmark = {marker.landmark: marker.name for marker in PROTOCOL.markers}
    pair = {by_landmark[one], by_landmark[other]}
    found = check_set(exchanged(PROTOCOL, *pair), STANDING)
    assert found.verdict == BAD
    if found.rms_mm is not None:
        assert pair & {marker.name for marker in found.markers[:2]}
        assert any(name in reason for reason in found.reasons for name in pair)


def test_unknown_markers_and_bare_segments_are_told():
    without = replace(
        PROTOCOL,
        markers=tuple(m for m in PROTOCOL.markers if "hand" not in m.segment and m.segment != "head"),
    )
    lost = {m.name for m in PROTOCOL.markers} - {m.name for m in without.markers}
    found = check_set(without, STANDING)
    assert set(found.use.unknown) == lost
    assert {"head", "right_hand", "left_hand"} <= set(found.bare)
    assert found.verdict == DOUBTFUL
    assert "not " in found.reasons[0]


def test_a_point_that_the_set_leaves_out_is_no_unknown_one():
    name = PROTOCOL.markers[-1].name
    without = replace(PROTOCOL, markers=PROTOCOL.markers[:-1], ignored={name: "on the treadmill"})
    found = check_set(without, STANDING)
    assert found.use.unknown == ()
    assert found.use.ignored == {name: "on the treadmill"}


def test_absent_markers_are_told():
    names = STANDING.markers.names
    found = check_set(PROTOCOL, replace(STANDING, markers=STANDING.markers.select(names[1:])))
    assert found.absent == (names[0],)
    assert found.verdict == OK


def test_a_set_for_another_capture_is_bad():
    found = check_set(load_protocol("gait2354"), STANDING)
    assert (found.verdict, found.rms_mm, found.markers) == (BAD, None, ())
    assert found.trouble
