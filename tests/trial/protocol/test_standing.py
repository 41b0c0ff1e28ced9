"""A body beside a capture: the person where the set explains it, the reference body on the points where it does not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.io.records import MarkerTrajectories
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol, load_protocol
from mbkf.trial.protocol.standing import (
    Standing,
    faced_forward,
    neutral_on_floor,
    scale_nominally,
    stand_beside,
    stands_still,
)
from tests.captures import MASS_KG, made_capture

PROTOCOL = load_protocol("reference36")
AWAY_M = np.array([3.0, -2.0, 0.0])


@pytest.fixture(scope="module")
def standing():
    return stand_beside(made_capture(20, 0.0), PROTOCOL)


def test_the_person_stands_at_the_markers(standing):
    assert standing.trouble == ""
    assert standing.subject is not None
    places = {marker.name: (marker.segment, marker.position_m) for marker in standing.subject.markers}
    for name, point in zip(standing.names, standing.points_m, strict=True):
        segment, own = places[name]
        rotations, origins = standing.model.placements(standing.q)
        joint = standing.model.joint(segment).joint_id
        assert origins[joint] + rotations[joint] @ own == pytest.approx(point, abs=5e-3)


def test_to_the_reference_body_and_back(standing):
    point = np.array([0.1, -0.2, 0.9])
    for segment in standing.model.joints:
        assert standing.to_world(segment, standing.to_reference(segment, point)) == pytest.approx(point)


def test_a_made_person_s_markers_come_back_to_their_places_in_the_set(standing):
    for name, point in zip(standing.names, standing.points_m, strict=True):
        marker = PROTOCOL.match([name])[name]
        assert standing.to_reference(marker.segment, point) == pytest.approx(marker.position_m, abs=0.012)


@pytest.mark.parametrize("yaw", [0.0, 1.0, 2.5, -3.0])
def test_faced_forward(standing, yaw):
    """However the person stood in the laboratory, and without moving the markers on the body."""
    turn = Rotation.from_euler("z", yaw)
    q = standing.q.copy()
    root = q[standing.model.root.q]
    root[:3] = turn.apply(root[:3]) + AWAY_M
    root[3:7] = (turn * Rotation.from_quat(root[3:7])).as_quat()
    away = replace(standing, q=q, points_m=turn.apply(standing.points_m) + AWAY_M)
    faced = faced_forward(away)
    rotations, origins = faced.model.placements(faced.q)
    forward = rotations[faced.model.root.joint_id][:, 0]
    assert np.arctan2(forward[1], forward[0]) == pytest.approx(0.0, abs=1e-9)
    assert origins[faced.model.root.joint_id][:2] == pytest.approx([0.0, 0.0], abs=1e-9)
    for point, before in zip(faced.points_m, standing.points_m, strict=True):
        own = faced.to_reference("right_shank", point)
        assert own == pytest.approx(standing.to_reference("right_shank", before), abs=1e-9)


def test_without_any_known_marker_the_reference_body_stands_among_the_points():
    capture = made_capture(5, 0.0)
    empty = Protocol("none", "None", PROTOCOL.body, ())
    found = stand_beside(capture, empty)
    assert found.subject is None and found.trouble
    assert set(found.names) == set(capture.markers.names)
    truth = {m.name: found.to_world(m.segment, m.position_m) for m in PROTOCOL.markers}
    away = [np.linalg.norm(truth[n] - p) for n, p in zip(found.names, found.points_m, strict=True)]
    assert np.median(away) < 0.10


def test_a_capture_without_a_marker_is_borne():
    capture = made_capture(5, 0.0)
    nothing = replace(
        capture, markers=replace(capture.markers, positions_m=np.nan * capture.markers.positions_m)
    )
    found = stand_beside(nothing, PROTOCOL)
    assert (found.names, found.points_m.shape, found.subject) == ((), (0, 3), None)


def test_a_marker_that_is_not_seen_then_is_where_it_was_seen_nearest():
    capture = made_capture(10, 0.0)
    positions = capture.markers.positions_m.copy()
    positions[:, 0] = np.nan
    positions[7, 0] = [1.0, 2.0, 3.0]
    positions[7, 1:4] = np.nan
    names = ("*7", *capture.markers.names[1:])
    found = stand_beside(replace(capture, markers=replace(capture.markers, positions_m=positions)), PROTOCOL)
    assert found.names == capture.markers.names
    found = stand_beside(
        replace(capture, markers=replace(capture.markers, names=names, positions_m=positions)), PROTOCOL
    )
    assert found.names == capture.markers.names[1:]


def test_standing_and_moving_are_told_apart():
    assert stands_still(made_capture(20, 0.0).markers)
    assert not stands_still(made_capture(80, 0.6).markers)
    assert not stands_still(MarkerTrajectories(("A",), np.full((3, 1, 3), np.nan), 100.0))


@pytest.mark.parametrize("amplitude", [0.0, 0.4])
def test_a_stated_mass_is_taken_and_a_nominal_one_otherwise(amplitude):
    capture = made_capture(40, amplitude)
    assert scale_nominally(capture, PROTOCOL).mass_kg == MASS_KG
    assert scale_nominally(replace(capture, subject_mass_kg=None), PROTOCOL).mass_kg == 70.0


def test_the_soles_are_on_the_floor():
    model = HumanModel.scaled({"right_shank": 1.1, "left_shank": 1.1})
    alone = Standing((), np.empty((0, 3)), model, neutral_on_floor(model), None)
    lowest = [
        alone.to_world(sole.segment, np.array([0.0, 0.0, sole.height_m]))[2] for sole in model.roles.soles
    ]
    assert lowest == pytest.approx([0.0, 0.0], abs=1e-9)
