"""The row: parts lie side by side, and every quantity points at its own numbers."""

import numpy as np
import pytest

from mbkf.io.dimensions import labels_of
from mbkf.io.results import PLOTTED
from mbkf.model.body_file import load_body
from mbkf.viz.scene.channels import (
    GROUPS,
    REFUSED,
    SEEN,
    STATUS,
    UNSEEN,
    Layout,
    marker_states,
    quantities,
)

NAMES = ("pelvis_tilt", "pelvis_ty", "knee_angle_r", "knee_angle_l")


def test_parts_cover_the_row_without_overlap():
    layout = Layout(18, 36, len(NAMES), unlabelled=5)
    taken = np.zeros(layout.width, int)
    for first, width in layout.parts.values():
        taken[first : first + width] += 1
    assert (taken == 1).all()
    assert layout.parts["unlabelled"][1] == 15
    assert layout.parts["status"] == (0, len(STATUS))


def test_every_load_has_its_place():
    layout = Layout(2, 3, 4, supports=("pelvis", "left_hand"))
    assert layout.loads == ("right_foot", "left_foot", "pelvis", "left_hand")
    found = {q.id: q for q in quantities(layout, (), [], streamed=False)}
    rows = layout.blank(1)
    layout.put(rows, "force", np.arange(12.0))
    layout.put(rows, "force_sd", np.arange(12.0) + 100.0)
    hand = found["load:vertical_left_hand"]
    assert (rows[0, hand.column], rows[0, hand.sd_column]) == (11.0, 111.0)
    assert (hand.group, hand.side, hand.positive) == ("Other loads", "l", "upward")
    assert rows[0, found["reaction:y_l"].column] == 4.0


def test_what_is_put_in_a_part_is_found_there():
    layout = Layout(2, 3, 4)
    rows = layout.blank(5)
    values = np.arange(45.0).reshape(5, 3, 3)
    layout.put(rows, "measured", values)
    first, width = layout.parts["measured"]
    np.testing.assert_array_equal(rows[:, first : first + width], values.reshape(5, 9))
    assert np.isnan(np.delete(rows, np.s_[first : first + width], axis=1)).all()


def test_quantities_point_at_their_numbers():
    layout = Layout(18, 36, len(NAMES))
    found = {q.id: q for q in quantities(layout, NAMES, load_body().clinical_joints, streamed=False)}
    rows = layout.blank(1)
    layout.put(rows, "angles", np.deg2rad([[1.0, 0.0, 20.0, 30.0]]))
    layout.put(rows, "moments_sd", np.array([[1.0, 2.0, 3.0, 4.0]]))
    layout.put(rows, "force", np.array([[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]]))
    knee = found["angle:knee_angle_r"]
    assert np.isclose(rows[0, knee.column] * knee.factor, 20.0)
    assert (knee.unit, knee.side, knee.title) == ("°", "r", "Knee flexion, right")
    torque = found["torque:knee_angle_l"]
    assert rows[0, torque.sd_column] == 4.0
    assert (torque.title, torque.unit) == ("Knee flexion torque, left", "N m")
    assert rows[0, found["reaction:vertical_l"].column] == 6.0
    assert found["torque:pelvis_ty"].group == "Residuals at the pelvis"
    assert found["torque:pelvis_ty"].unit == "N"


def test_every_quantity_is_listed_once_under_a_known_heading():
    layout = Layout(18, 36, len(NAMES))
    recorded, live = (
        quantities(layout, NAMES, load_body().clinical_joints, streamed) for streamed in (False, True)
    )
    assert len({q.id for q in live}) == len(live) == len(recorded) + 3
    groups = [GROUPS.index(q.group) for q in live]
    assert groups == sorted(groups)


@pytest.mark.parametrize("name", PLOTTED)
def test_a_declared_quantity_has_a_curve_for_each_of_its_labels(name):
    layout, declared = Layout(18, 36, len(NAMES)), PLOTTED[name]
    joints = load_body().clinical_joints
    found = [q for q in quantities(layout, NAMES, joints, streamed=False) if q.id.partition(":")[0] == name]
    labels = list(labels_of(declared.axes[1:], {"coordinate": NAMES}))
    assert [q.id for q in found] == [":".join([name, *of.values()]) for of in labels]
    first, width = layout.parts[name]
    assert sorted(q.column for q in found) == list(range(first, first + width))
    assert {(q.unit, q.factor) for q in found} == {(declared.plot.unit, declared.plot.factor)}
    assert layout.resolution()[first] == declared.plot.resolution


def test_marker_states():
    measured = np.zeros((4, 3))
    measured[1, 2] = np.nan
    hidden = np.array([False, False, True, False])
    refused = np.array([False, True, True, True])
    assert marker_states(measured, hidden, refused).tolist() == [SEEN, UNSEEN, UNSEEN, REFUSED]


def test_moments_of_the_trunk_have_a_curve_by_level_turn_and_way_with_its_band():
    layout = Layout(2, 3, 4, levels=("T12/L1", "L5/S1"))
    found = {q.id: q for q in quantities(layout, (), [], streamed=False) if q.id.startswith("trunk:")}
    assert len(found) == 12 and layout.parts["trunk"][1] == 12
    moments = np.arange(12.0).reshape(1, 2, 2, 3)
    rows = layout.blank(1)
    layout.put(rows, "trunk", moments)
    layout.put(rows, "trunk_sd", moments + 100.0)
    one = found["trunk:L5/S1:bending:bottom_up"]
    assert (one.title, one.group) == ("Trunk bending torque, L5/S1, bottom-up", "Torques")
    assert (rows[0, one.column], rows[0, one.sd_column]) == (moments[0, 1, 1, 1], moments[0, 1, 1, 1] + 100.0)
    assert Layout(2, 3, 4).parts["trunk"][1] == 0


def test_the_torque_of_the_bodys_own_joint_says_its_level():
    names = ("lumbar_extension", "knee_angle_r")
    layout = Layout(18, 36, len(names))
    joints = load_body().clinical_joints
    found = {q.id: q for q in quantities(layout, names, joints, False, {"lumbar": "T12/L1"})}
    assert found["torque:lumbar_extension"].title == "Trunk extension torque, T12/L1"
    assert found["angle:lumbar_extension"].title == "Trunk extension"
    assert "T12" not in found["torque:knee_angle_r"].title
