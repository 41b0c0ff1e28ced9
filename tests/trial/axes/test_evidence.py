"""What markers tell about a body's up, handedness and size, whatever axes they are seen in."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import UnknownName
from mbkf.io.records import MarkerTrajectories
from mbkf.model.body_file import load_body
from mbkf.model.protocol import load_protocol
from mbkf.trial.axes.evidence import body_attitude, marker_places
from tests.captures import LEGS, made_markers, only

MARKERS = made_markers(20)
PROTOCOL = load_protocol("reference36")
TURNS = [np.eye(3), np.eye(3)[[1, 2, 0]], np.diag([-1.0, -1.0, 1.0]), np.diag([1.0, -1.0, -1.0])]
MIRRORS = [np.diag([1.0, -1.0, 1.0]), np.eye(3)[[1, 0, 2]], -np.eye(3)]


def places(markers: MarkerTrajectories):
    return marker_places(markers.names, PROTOCOL.match(markers.names), PROTOCOL.body)


def seen(turn: np.ndarray, markers: MarkerTrajectories = MARKERS):
    turned = replace(markers, positions_m=markers.positions_m @ turn.T)
    found = body_attitude(turned, places(markers))
    assert found is not None
    return found


@pytest.mark.parametrize("turn", [*TURNS, *MIRRORS])
def test_evidence_turns_with_the_markers(turn):
    plain, turned = seen(np.eye(3)), seen(turn)
    np.testing.assert_allclose(turned.up, plain.up @ turn.T, atol=1e-9)
    np.testing.assert_allclose(turned.feet, plain.feet @ turn.T, atol=1e-9)
    np.testing.assert_allclose(turned.handedness, np.linalg.det(turn) * plain.handedness, atol=1e-9)
    np.testing.assert_allclose(turned.stretch, plain.stretch)
    assert turned.size == pytest.approx(plain.size)


def test_a_standing_person_is_upright_right_handed_and_of_the_reference_size():
    found = seen(np.eye(3), made_markers(20, 0.0))
    np.testing.assert_allclose(found.up, np.tile([0.0, 0.0, 1.0], (20, 1)), atol=0.06)
    np.testing.assert_allclose(found.feet[:, :, 0], 1.0, atol=0.02)
    np.testing.assert_allclose(found.handedness, 1.0, atol=0.01)
    np.testing.assert_allclose(found.stretch, 1.0, atol=0.01)
    assert found.size == pytest.approx(1.0, abs=0.01)
    assert (found.explained > 0.99).all()


def test_legs_alone_tell_all_of_it():
    found = seen(np.diag([1.0, -1.0, 1.0]), only(MARKERS, LEGS))
    assert (found.handedness < -0.8).all()
    assert (found.up[:, 2] > 0.95).all()


def test_size_is_that_of_the_markers_distances():
    found = seen(0.6 * np.eye(3))
    assert found.size == pytest.approx(0.6, abs=0.01)
    assert found.scatter < 0.1


def test_names_in_a_wrong_order_scatter():
    swapped = replace(MARKERS, positions_m=MARKERS.positions_m[:, ::-1])
    assert seen(np.eye(3), swapped).scatter > 0.5


def test_what_is_not_seen_is_not_told():
    thighs = only(MARKERS, ("thigh", "shank", "pelvis"))
    found = body_attitude(thighs, places(thighs))
    assert found is not None
    assert np.isnan(found.feet).all()
    flat = replace(places(MARKERS), neutral_m=places(MARKERS).neutral_m * [0.0, 1.0, 1.0])
    without_depth = body_attitude(MARKERS, flat)
    assert without_depth is not None
    assert np.isnan(without_depth.handedness).all()
    few = MARKERS.select(MARKERS.names[:5])
    assert body_attitude(few, places(few)) is None


def test_frames_without_markers_are_left_out():
    positions = MARKERS.positions_m.copy()
    positions[3:] = np.nan
    found = body_attitude(replace(MARKERS, positions_m=positions), places(MARKERS))
    assert found is not None
    assert len(found.up) == 3


def test_a_segment_that_the_body_does_not_have_is_refused():
    body = load_body("human18")
    tail = replace(PROTOCOL.markers[0], segment="tail")
    with pytest.raises(UnknownName, match="segment 'tail'"):
        marker_places([tail.name], {tail.name: tail}, body)


def test_names_of_any_shipped_protocol_have_a_place():
    """R.PSIS belongs to one protocol, RASI to others: both are known to somebody who wears none of them."""
    found = marker_places(("R.PSIS", "RASI", "nobody knows this"), {}, load_body("human18"))
    np.testing.assert_array_equal(found.columns, [0, 1])
    assert set(found.segments) == {"pelvis"}
    assert found.neutral_m[0, 0] < found.neutral_m[1, 0], "behind and in front"
    assert (found.neutral_m[:, 1] < 0.0).all(), "on the right"
