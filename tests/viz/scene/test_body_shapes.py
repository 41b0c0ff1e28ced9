"""Shapes: one set for every segment, joined at the joints, mirrored, and scaled to the person."""

import json

import numpy as np
import pytest

from mbkf.model.human import HumanModel
from mbkf.viz.scene.body_shapes import as_plain, segment_shapes
from tests.motions import assert_near


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
