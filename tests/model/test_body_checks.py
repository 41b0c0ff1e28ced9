"""What cannot be a body is refused: every complaint names the place and what would be right."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.model.body_checks import check_body
from mbkf.model.body_file import load_body
from mbkf.model.human import HumanModel

BODY = load_body()
LEGS = load_body(Path(__file__).resolve().parents[2] / "docs/examples/bodies/legs.toml")


def with_segment(name, **changes):
    segments = [replace(s, **changes) if s.name == name else s for s in BODY.segments]
    return replace(BODY, segments=tuple(segments))


def with_sole(**changes):
    soles = tuple(replace(sole, **changes) for sole in BODY.roles.soles)
    return replace(BODY, roles=replace(BODY.roles, soles=soles))


def with_shape(name, **changes):
    return replace(BODY, shapes=BODY.shapes | {name: replace(BODY.shapes[name], **changes)})


@pytest.mark.parametrize("body", [BODY, LEGS], ids=lambda body: body.name)
def test_good_bodies_pass(body):
    check_body(body)


@pytest.mark.parametrize(
    ("body", "complaint"),
    [
        (with_segment("head", mass_kg=0.0), "segment head: mass_kg must be positive"),
        (with_segment("head", inertia_kg_m2=np.array([1.0, 1.0, 3.0])), "a rigid body cannot have"),
        (with_segment("head", parent="torso"), "clinical joint head: the parent of head is torso, not neck"),
        (
            with_segment("head", joint="free"),
            "segment head: the root, and no other segment, has a 'free' joint",
        ),
        (with_segment("head", origin_m=np.array([0.0, np.nan, 0.0])), "origin_m needs three finite"),
        (with_segment("right_toes", axes="w"), "a hinge joint has 1 axes out of x, y and z, not 'w'"),
        (replace(BODY, reference_mass_kg=70.0), "sum to 81.52 kg, but reference_mass_kg is 70.00"),
        (with_segment("neck", axes="xx"), "a universal joint has 2 axes out of x, y and z, not 'xx'"),
        (
            with_segment("head", movement_sd=np.array([1.0, -1.0, 1.0])),
            "movement_sd needs 3 numbers, 0 or more",
        ),
        (with_segment("head", posture_sd_rad=np.ones(2)), "posture_sd_deg needs 3 numbers"),
        (
            with_segment("head", limits_rad=np.array([[-1.0, 1.0], [1.0, -1.0], [0.0, 1.0]])),
            "limits_deg needs 3",
        ),
        (replace(BODY, reference_height_m=0.0), "reference_height_m must be positive"),
        (with_sole(heel_x_m=0.5), "must grow"),
        (with_sole(outer_y_m=0.5), "outer_y_m must lie to the right"),
        (with_shape("head", kind="cube"), "shape of head: kind 'cube' is not one of"),
        (with_shape("head", kind="ellipsoid", numbers=np.ones(4)), "ellipsoid needs 6 numbers, not 4"),
        (with_shape("head", kind="tube", numbers=np.ones(4)), "tube needs 4 n numbers, not 4"),
        (with_shape("head", kind="limb", numbers=np.ones(2), to="tail"), "named by 'to', not 'tail'"),
        (with_shape("head", kind="foot", numbers=np.ones(0)), "only a segment of the role feet"),
        (replace(BODY, segments=BODY.segments[::-1]), "the first segment, and no other"),
    ],
)
def test_what_is_wrong_is_told(body, complaint):
    with pytest.raises(ValueError, match=complaint):
        check_body(body)


@pytest.mark.parametrize("sense", [-1.0, 1.0])
def test_masses_sum_to_the_reference_mass_within_a_hundredth(sense):
    total = sum(segment.mass_kg for segment in BODY.segments)
    check_body(replace(BODY, reference_mass_kg=total / (1.0 + sense * 0.0095)))
    with pytest.raises(ValueError, match="masses sum to"):
        check_body(replace(BODY, reference_mass_kg=total / (1.0 + sense * 0.0105)))


def test_the_largest_principal_moment_is_at_most_the_sum_of_the_others():
    check_body(with_segment("head", inertia_kg_m2=np.array([0.3, 0.1, 0.2])))
    for moments in ([0.301, 0.1, 0.2], [0.0, 0.1, 0.1]):
        with pytest.raises(ValueError, match="a rigid body cannot have"):
            check_body(with_segment("head", inertia_kg_m2=np.array(moments)))


def test_a_body_of_legs_carries_the_whole_weight():
    """Trunk, head and arms are part of its pelvis, so standing still needs the weight of the person."""
    model = HumanModel.scaled(mass_kg=70.0, body=LEGS)
    whole = HumanModel.scaled(mass_kg=70.0)
    lifting = model.gravity_torques(model.neutral())[:6]
    assert lifting[2] == pytest.approx(70.0 * GRAVITY_M_S2)
    np.testing.assert_allclose(lifting, whole.gravity_torques(whole.neutral())[:6], atol=0.05)


def test_hinges_about_any_axis():
    sideways = with_segment("right_toes", axes="x")
    hinge = next(j for j in BODY.clinical_joints if j.distal == "right_toes")
    turned = replace(hinge, order="x", angles=(replace(hinge.angles[0], axis="x"),))
    joints = tuple(turned if j is hinge else j for j in BODY.clinical_joints)
    body = replace(sideways, clinical_joints=joints)
    check_body(body)
    model = HumanModel.scaled(body=body)
    step = np.zeros(model.nv)
    joint = model.joint("right_toes")
    step[joint.v] = 0.3
    rotations, _ = model.placements(model.integrate(model.neutral(), step))
    np.testing.assert_allclose(rotations[joint.joint_id][:, 0], [1.0, 0.0, 0.0], atol=1e-12)
    assert rotations[joint.joint_id][2, 1] == pytest.approx(np.sin(0.3))


@pytest.mark.parametrize("axis", [[0.6, 0.8, 0.1], [0.8, 0.6, 0.0], [0.0, -1.0, 0.0], [0.8, 0.6]])
def test_an_oblique_axis_is_a_unit_vector_nearest_to_its_letter(axis):
    check_body(with_segment("right_toes", axis=np.array([0.6, 0.8, 0.0])))
    with pytest.raises(
        ValueError, match=r"right_toes: axis .* of a hinge joint is not the unit vector .* \+y"
    ):
        check_body(with_segment("right_toes", axis=np.array(axis)))
    with pytest.raises(ValueError, match=r"axis .* is not the unit vector of a hinge"):
        check_body(with_segment("neck", axis=np.array([0.6, 0.8, 0.0])))
