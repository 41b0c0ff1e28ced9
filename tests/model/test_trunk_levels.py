"""Levels of the spine in body files: where they lie, and tables that cannot be."""

import numpy as np
import pytest

from mbkf.conventions import data_folder
from mbkf.errors import FileFormatError, UnknownName
from mbkf.model.body_file import load_body, parse_body

TEXT = (data_folder("models") / "human18.toml").read_text(encoding="utf-8")


def test_places_are_those_of_their_sources():
    """L5/S1 after Reed in widths of the pelvis, OpenSim's joint after Rajagopal in distances of the hips."""
    body = load_body()
    hip = body.segment("right_thigh").origin_m * [1.0, 0.0, 1.0]
    joint, opensim, lumbosacral = body.levels
    assert [one.name for one in body.levels] == ["T12/L1", "L3/L4", "L5/S1"]
    assert joint.position_m is None and joint.part_mass_kg == 0.0
    width, apart = 0.224, 2 * body.segment("left_thigh").origin_m[1]
    np.testing.assert_allclose(lumbosacral.position_m, hip + width * np.array([-0.056, 0, 0.404]), atol=1e-3)
    np.testing.assert_allclose(opensim.position_m, hip + apart * np.array([-0.287, 0, 1.035]), atol=2e-3)


def test_the_pelvis_below_has_the_mass_of_its_source():
    """Dumas 2007: 14.2 % of the whole; the part above the higher level is a shorter piece of the same cylinder."""
    body = load_body()
    _, opensim, lumbosacral = body.levels
    below = body.segment("pelvis").mass_kg - lumbosacral.part_mass_kg
    assert below / body.reference_mass_kg == pytest.approx(0.142, abs=1e-3)
    heights = opensim.position_m[2] / lumbosacral.position_m[2]
    assert opensim.part_mass_kg / lumbosacral.part_mass_kg == pytest.approx(heights, abs=0.005)
    for one in (opensim, lumbosacral):
        m, h = one.part_mass_kg, one.position_m[2]
        np.testing.assert_allclose(one.part_com_m, [0.0, 0.0, h / 2], atol=1e-3)
        a, b = 0.10, 0.14
        cylinder = m * np.array([b**2 / 4 + h**2 / 12, a**2 / 4 + h**2 / 12, (a**2 + b**2) / 4])
        np.testing.assert_allclose(one.part_inertia_kg_m2, cylinder, atol=2e-4)


def test_columns_bear_opensims_name_only_where_opensim_has_its_joint():
    assert [one.column for one in load_body().levels] == ["t12_l1", "lumbar", "l5_s1"]
    lumbar = [angle.opensim for joint in load_body().clinical_joints for angle in joint.angles]
    assert {"lumbar_extension", "lumbar_bending", "lumbar_rotation"} <= set(lumbar)


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('name = "L3/L4"', 'name = "L5/S1"', "two levels are named L5/S1"),
        ("part_mass_kg = 2.62", "part_mass_kg = 14.2", "part of the 14.2 kg of pelvis, not 14.2 kg"),
        ("part_mass_kg = 2.62", "part_mass_kg = -1", "not -1 kg"),
        ("position_m = [-0.001, 0, -0.184]", "position_m = [0, 0]", "position_m needs three finite numbers"),
        ('above = "torso"', 'above = "neck"', "spherical joint on the root pelvis, not neck"),
    ],
)
def test_a_level_that_cannot_be_is_refused(before, after, said):
    assert before in TEXT
    with pytest.raises(FileFormatError, match=said):
        parse_body(TEXT.replace(before, after, 1), "own.toml")


def test_an_unknown_segment_is_named():
    with pytest.raises(UnknownName, match="chest"):
        parse_body(TEXT.replace('above = "torso"', 'above = "chest"', 1), "own.toml")


def test_a_body_without_levels_has_none():
    assert parse_body(TEXT.split("[[level]]")[0], "own.toml").levels == ()
