"""Errors of the trunk's moments by the body: against those of the joint's torque, and against bodies that differ."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.filters.section_errors import PART_SD
from mbkf.model.newton_euler import NewtonEuler
from mbkf.model.trunk_sections import TrunkSections
from mbkf.numerics.rotations import skew
from tests.filters.test_body_errors import case
from tests.motions import assert_near, worst


@pytest.fixture(scope="module")
def one():
    return case("factors", "centres", "places", "skin")


@pytest.fixture(scope="module")
def roots(one):
    return one.at().sections()


def test_at_the_bodys_own_joint_they_are_those_of_its_torque(one, roots):
    torso = one.model.joint("torso").v
    expected = one.at().torque[torso]
    assert_near(roots[0, 0][:, :-4], expected, 1e-4 * worst(expected))
    assert_near(roots[0, 0][:, -4:], 0.0, 1e-12)


def test_bottom_up_the_residuals_error_is_taken_off(one, roots):
    """The ways differ by the residual's moment at the level."""
    by_root = TrunkSections(one.model).by_root(one.q)
    of_residual = one.at().torque[:6, 1:]
    for k in range(3):
        apart = (roots[0, k] - roots[1, k])[:, 1:-4]  # of segment masses, which move no place
        expected = by_root[k] @ of_residual
        assert_near(apart, expected, 1e-6 * worst(expected))


def test_a_level_that_lies_elsewhere_has_the_force_times_the_distance(one, roots):
    sections = TrunkSections(one.model)
    residual = NewtonEuler(one.model).tau(one.q, one.v, one.a, one.wrenches.ravel())[:6]
    carried, moved = np.zeros((3, 6)), 1e-3
    here = sections.moments(one.q, one.v, one.a, carried, residual)
    for axis in range(3):
        elsewhere = TrunkSections(one.model)
        elsewhere.places_m[2, axis] += moved
        elsewhere.transports[2][:, :3] = -skew(elsewhere.places_m[2])
        there = elsewhere.moments(one.q, one.v, one.a, carried, residual)
        slope = (there - here)[:, 2] / moved * one.model.description.levels[2].sd_m[axis]
        for way in range(2):
            assert_near(np.abs(roots[way, 2][:, -4 + axis]), np.abs(slope[way]), 1e-6 * worst(slope))


def test_a_heavier_part_above_the_level_pulls_more(one, roots):
    sections = TrunkSections(one.model)
    data = one.model.pin_model.createData()
    pin.rnea(one.model.pin_model, data, one.q, one.v, one.a)
    pelvis = one.model.joint("pelvis").joint_id
    for k in range(3):
        part = sections.part(k)
        own = part * data.a_gf[pelvis] + data.v[pelvis].cross(part * data.v[pelvis])
        expected = PART_SD * sections.by_root(one.q)[k] @ np.r_[own.linear, own.angular]
        for way in range(2):
            assert_near(roots[way, k][:, -1], expected, 1e-9 * max(worst(expected), 1.0))
