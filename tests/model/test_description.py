"""The reference body as data: what it states."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.model.body_file import load_body
from mbkf.model.description import JOINT_DOF
from mbkf.model.human import HumanModel
from mbkf.model.sides import mirrored

BODY = load_body()


def test_a_body_is_read_once_and_cannot_be_changed():
    assert load_body() is BODY
    for segment in BODY.segments:
        for name in (
            "origin_m",
            "com_m",
            "inertia_kg_m2",
            "scale_matrix",
            "posture_sd_rad",
            "acceleration_sd",
        ):
            assert not getattr(segment, name).flags.writeable
    assert all(not landmark.position_m.flags.writeable for landmark in BODY.landmarks.values())


def test_segments_come_depth_first_from_one_root():
    """Each segment's parent is the one before it or an ancestor of that one, so every subtree is contiguous."""
    open_chain = []
    for segment in BODY.segments:
        while open_chain and open_chain[-1] != segment.parent:
            open_chain.pop()
        assert (segment.parent == "world") == (not open_chain)
        open_chain.append(segment.name)
    assert [segment.parent for segment in BODY.segments].count("world") == 1


def test_a_body_out_of_depth_first_order_is_refused():
    """Left and right leg listed turn by turn, which Pinocchio's subtrees do not allow."""
    body = BODY
    legs = [s for s in body.segments if s.name.split("_")[-1] in ("thigh", "shank", "foot", "toes")]
    turns = sorted(legs, key=lambda s: [leg.name for leg in legs].index(s.name) % (len(legs) // 2))
    others = [s for s in body.segments if s not in legs]
    mixed = replace(body, segments=(others[0], *turns, *others[1:]))
    with pytest.raises(InvalidInput, match="depth-first"):
        HumanModel(mixed, np.ones(len(body.scale_factors)), 70.0)


def test_each_segment_has_values_for_each_dof_of_its_joint():
    for segment in BODY.segments:
        assert segment.posture_sd_rad.shape == segment.acceleration_sd.shape == (JOINT_DOF[segment.joint],)
        assert (segment.acceleration_sd > 0).all()
        assert ((segment.posture_sd_rad > 0) == (segment.joint != "free")).all()


def test_posture_spreads_are_read_in_degrees():
    np.testing.assert_allclose(
        BODY.segment("right_shank").posture_sd_rad, np.array([5, 60, 10]) * np.pi / 180
    )


def test_every_axis_is_an_average_of_factors():
    for segment in BODY.segments:
        assert (segment.scale_matrix >= 0).all()
        np.testing.assert_array_equal(segment.scale_matrix.sum(axis=1), 1.0)
        assert segment.scale_matrix[:, segment.length_index].any()


def test_the_reference_body_is_as_tall_as_it_says():
    """Sole to vertex: the neutral joints' heights add up to the stated stature within a head's roundness."""
    down = (
        sum(BODY.segment(s).origin_m[2] for s in ("right_thigh", "right_shank", "right_foot"))
        + BODY.sole.height_m
    )
    up = sum(BODY.segment(s).origin_m[2] for s in ("torso", "neck", "head"))
    top = max(m.position_m[2] for m in BODY.landmarks.values() if m.segment == "head")
    assert up + top - down == pytest.approx(BODY.reference_height_m, abs=0.05)


def test_paired_landmarks_have_two_sides_and_midline_ones_one():
    paired = {name.removeprefix("right_") for name in BODY.landmarks if name.startswith("right_")}
    assert paired == {name.removeprefix("left_") for name in BODY.landmarks if name.startswith("left_")}
    for name, landmark in BODY.landmarks.items():
        assert landmark.name == name
        if mirrored(name) == name:
            assert landmark.position_m[1] == 0.0
    sided = [
        m for m in BODY.landmarks.values() if m.segment in ("pelvis", "torso", "head") and m.position_m[1]
    ]
    assert sided
    assert all((m.position_m[1] < 0) == m.name.startswith("right_") for m in sided)


def test_the_sole_spans_the_foot_to_the_tip_of_the_toes():
    sole, foot = BODY.sole, BODY.segment("right_toes").origin_m
    toe_tip = foot + BODY.landmark("right_toe_tip").position_m
    assert sole.heel_x_m < 0 < foot[0] < sole.toe_x_m
    assert sole.toe_x_m == pytest.approx(toe_tip[0], abs=0.015)
    assert sole.outer_y_m < 0 < sole.inner_y_m
    assert sole.height_m < foot[2]


def test_unknown_names_are_refused_with_the_nearest():
    with pytest.raises(UnknownName, match="did you mean right_thigh"):
        BODY.segment("right_thigs")
    with pytest.raises(UnknownName, match="did you mean sacrum"):
        BODY.landmark("sacrm")
