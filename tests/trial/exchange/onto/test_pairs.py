"""Bodies of an OpenSim model and our segments: names, places by markers, and bodies that move with another one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import InvalidInput
from mbkf.io.osim import OsimMarker, OsimModel
from mbkf.io.osim_functions import polynomial
from mbkf.io.osim_joints import OsimAxis, OsimCoordinate, OsimJoint
from mbkf.io.subject import SubjectMarker
from mbkf.model.osim_kinematics import OsimKinematics
from mbkf.trial.exchange.onto.pairs import pairs, replaced, shared_markers
from tests.recordings import walker

TURN, PLACE = Rotation.from_euler("xyz", [0.2, -0.4, 0.3]).as_matrix(), np.array([0.02, -0.01, 0.05])
POINTS = np.array([[0.1, 0.0, 0.0], [0.0, -0.2, 0.05], [0.0, 0.1, 0.1], [-0.05, -0.1, 0.0]])


def coordinate(name):
    return OsimCoordinate(name, 0.0, -1.0, 1.0, False, False, False, True)


def hinge(parent, child, name="", y=0.0):
    """A joint about z, or a fixed one."""
    frame = np.eye(4)
    frame[1, 3] = y
    turns = (OsimAxis(np.array([0.0, 0.0, 1.0]), polynomial(0.0, 1.0), name),) if name else ()
    return OsimJoint(parent, child, frame, np.eye(4), turns, (), (coordinate(name),) if name else (), child)


JOINTS = (
    hinge("ground", "pelvis", "tilt"),
    hinge("pelvis", "femur_r", "hip"),
    hinge("femur_r", "tibia_r", "knee", -0.4),
    hinge("tibia_r", "talus_r", "ankle", -0.4),
    hinge("talus_r", "calcn_r", "", -0.03),
)


def marked(names, segment="right_foot"):
    return [
        SubjectMarker(name, segment, TURN @ point + PLACE, 0.005, 0.01)
        for name, point in zip(names, POINTS, strict=False)
    ]


def found(model, markers):
    return {one.segment: one for one in pairs(OsimKinematics(model), walker()[1], markers)}


@pytest.fixture
def model():
    on_foot = tuple(OsimMarker(f"F.{k}", "calcn_r", point, True) for k, point in enumerate(POINTS))
    return OsimModel("made", JOINTS, on_foot, {})


def test_names_agree_but_for_points_and_capitals(model):
    own = [*marked(["f0", "X"]), replace(marked(["other"])[0], aliases=("F_2",))]
    assert {key: one.name for key, one in shared_markers(model, own).items()} == {"f0": "F.0", "other": "F.2"}


def test_markers_place_a_body(model):
    pair = found(model, marked(["F.0", "F.1", "F.2", "F.3"]))["right_foot"]
    assert pair.body == "calcn_r" and len(pair.markers) == 4
    assert pair.rotation == pytest.approx(TURN) and pair.origin_m == pytest.approx(PLACE)
    assert pair.centre_m == pytest.approx(POINTS.mean(axis=0))
    assert replaced(pair, np.ones((4, 3))) is pair


@pytest.mark.parametrize("markers", [marked(["F.0", "F.1"]), marked(["F.0", "F.1", "F.2"], "right_toes"), []])
def test_joints_place_a_body_without_markers(model, markers):
    """The calcaneus hangs on the talus, the foot's first body, whose joint is our ankle."""
    pair = found(model, markers)["right_foot"]
    assert pair.markers == ()
    assert pair.origin_m == pytest.approx([0.0, 0.0, -0.03])
    assert pair.rotation == pytest.approx(np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]))
    assert replaced(pair, np.array([[1.0, 0, 0], [3.0, 0, 0]])).origin_m == pytest.approx([2.0, 0.0, 0.0])


def test_markers_in_a_line_place_no_body(model):
    line = tuple(
        replace(one, position_m=np.array([0.1 * k, 0.0, 0.0])) for k, one in enumerate(model.markers)
    )
    assert found(replace(model, markers=line), marked(["F.0", "F.1", "F.2"]))["right_foot"].markers == ()


def test_unknown_bodies_are_refused():
    with pytest.raises(InvalidInput, match=r"pelvis, femur_r.*its bodies are box"):
        found(OsimModel("made", (hinge("ground", "box", "tilt"),), (), {}), [])
