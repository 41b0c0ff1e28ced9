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


@pytest.mark.parametrize("body", [BODY, LEGS], ids=lambda body: body.name)
def test_good_bodies_pass(body):
    check_body(body)


@pytest.mark.parametrize(
    ("body", "complaint"),
    [
        (with_segment("head", mass_kg=0.0), "segment head: mass_kg must be positive"),
        (with_segment("head", inertia_kg_m2=np.array([1.0, 1.0, 3.0])), "no rigid body"),
        (with_segment("head", parent="torso"), "clinical joint head: head hangs on torso, not on neck"),
        (with_segment("head", joint="free"), "segment head: the root's joint is 'free'"),
        (with_segment("head", origin_m=np.array([0.0, np.nan, 0.0])), "origin_m needs three finite"),
        (with_segment("right_toes", axes="w"), "a hinge joint has 1 axes out of x, y and z, not 'w'"),
        (replace(BODY, reference_mass_kg=70.0), "sum to 81.52 kg, reference_mass_kg is 70.00"),
        (replace(BODY, segments=BODY.segments[::-1]), "the first segment is the root"),
    ],
)
def test_what_is_wrong_is_told(body, complaint):
    with pytest.raises(ValueError, match=complaint):
        check_body(body)


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
