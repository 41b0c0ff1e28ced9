"""Shapes: one set for every segment, joined at the joints, mirrored, and scaled to the person."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mbkf.model.body_file import parse_body
from mbkf.model.body_shapes import as_plain, segment_shapes
from mbkf.model.human import HumanModel
from tests.motions import assert_near

LEGS = Path(__file__).resolve().parents[2] / "docs/examples/bodies/legs.toml"


@pytest.fixture(scope="module")
def reference():
    return HumanModel.scaled()


def test_all_eighteen_segments_have_a_shape_of_the_right_size(reference):
    shapes = segment_shapes(reference)
    assert list(shapes) == list(reference.joints) and len(shapes) == 18
    for name, group in shapes.items():
        assert group, name
        for shape in group:
            sizes = {"limb": 8, "ellipsoid": 6}
            if shape.kind in sizes:
                assert len(shape.numbers) == sizes[shape.kind]
            else:
                assert shape.kind in ("tube", "outline")
                assert len(shape.numbers) % (4 if shape.kind == "tube" else 2) == 0


def test_limbs_end_at_the_next_joint(reference):
    for name, child in (("right_thigh", "right_shank"), ("left_forearm", "left_hand"), ("neck", "head")):
        (limb,) = segment_shapes(reference)[name]
        assert_near(limb.numbers[3:6], reference.description.segment(child).origin_m, 1e-12)


def test_left_mirrors_right(reference):
    shapes = segment_shapes(reference)
    (right,), (left,) = shapes["right_foot"], shapes["left_foot"]
    assert_near(left.numbers[:2], -right.numbers[1::-1], 1e-12)
    assert_near(left.numbers[2:], right.numbers[2:], 1e-12)
    (right,), (left,) = shapes["right_hand"], shapes["left_hand"]
    assert_near(left.numbers, right.numbers * [1, -1, 1, 1, 1, 1], 1e-12)


def test_a_person_twice_as_long_and_eight_times_as_heavy_is_twice_as_broad(reference):
    factors = dict.fromkeys(reference.description.scale_factors, 2.0)
    giant = HumanModel.scaled(factors, 8.0 * reference.description.reference_mass_kg)
    for name, group in segment_shapes(giant).items():
        for mine, theirs in zip(group, segment_shapes(reference)[name], strict=True):
            assert_near(mine.numbers, 2.0 * theirs.numbers, 1e-9)


def test_soles_lie_under_the_feet(reference):
    (foot,) = segment_shapes(reference)["right_foot"]
    assert foot.numbers[3::2].min() == pytest.approx(reference.description.sole.height_m)


def test_plain_shapes_are_json(reference):
    plain = as_plain(segment_shapes(reference))
    assert json.loads(json.dumps(plain)) == plain
    assert [entry["name"] for entry in plain] == list(reference.joints)
    assert np.isfinite([n for entry in plain for s in entry["shapes"] for n in s["numbers"]]).all()


def test_segments_without_a_shape_are_drawn_as_plain_limbs(reference):
    bare = HumanModel.scaled(body=replace(reference.description, shapes={}))
    shapes = segment_shapes(bare)
    assert {shape.kind for group in shapes.values() for shape in group} == {"limb"}
    thigh, torso = shapes["right_thigh"], shapes["torso"]
    assert_near(thigh[0].numbers[3:6], reference.description.segment("right_shank").origin_m, 1e-12)
    assert len(torso) == 3, "to the neck and both arms"
    assert_near(shapes["head"][0].numbers[3:6], 2.0 * reference.description.segment("head").com_m, 1e-12)


def test_a_foot_without_toes_reaches_to_the_tip_of_its_sole():
    text = LEGS.read_text(encoding="utf-8")
    for start in (
        '[[segment]]\nname = "right_toes"',
        '[[segment]]\nname = "left_toes"',
        '[[clinical_joint]]\nname = "mtp_r"',
        '[[shape]]\nsegment = "right_toes"',
        '[[landmark]]\nname = "hallux"',
        '[[landmark]]\nname = "toe_tip"',
    ):
        first = text.index(start)
        end = text.find("\n\n", first)
        text = text[:first] + (text[end:] if end > 0 else "")
    text = (
        text.replace('toes = ["right_toes", "left_toes"]\n', "")
        .replace('"right_toes", ', "")
        .replace(', "left_toes"', "")
    )
    text = text.replace("mass_kg = 1.093", "mass_kg = 1.182")
    model = HumanModel.scaled(body=parse_body(text, "no toes"))
    assert model.roles.toes == () and model.nv == 24
    (foot,) = segment_shapes(model)["left_foot"]
    assert foot.kind == "outline"
    assert foot.numbers[2::2].max() == pytest.approx(model.roles.soles[1].toe_x_m)
