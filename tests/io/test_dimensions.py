"""Axes and units: labels and sizes of an array agree, and a unit is found by its label."""

import numpy as np

from mbkf.io.dimensions import ANGLE, AXES, CONFIGURATION, METRE, WRENCH, labels_of, numbered, shape_of


def test_a_unit_may_differ_by_label():
    assert [ANGLE.of(label) for label in ("pelvis_tx", "pelvis_tilt", "knee_angle_r")] == ["m", "rad", "rad"]
    assert [CONFIGURATION.of(label) for label in ("root_tz", "root_qw", "right_toes_y")] == ["m", "1", "rad"]
    assert [WRENCH.of(label) for label in AXES["wrench"].labels] == ["N"] * 3 + ["N m"] * 3
    assert METRE.of("x") == "m"


def test_labels_and_shape_of_an_array_agree():
    names = {"coordinate": ("hip", "knee", "ankle")}
    labels = list(labels_of(("coordinate", "foot"), names))
    assert len(labels) == np.prod(shape_of(("coordinate", "foot"), {"coordinate": 3})) == 6
    assert labels[1] == {"coordinate": "hip", "foot": "left"}
    assert list(labels_of((), {})) == [{}] and shape_of((), {}) == ()
    assert numbered(2) == ("1", "2")
