"""Moments beside forces and points of application: the point and unit that explain them, or a doubt in words."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.moment_reference import reference_at_point, reference_of_moments
from tests.io.test_force_table import TRUE, read, table
from tests.io.true_capture import check_plates


def loaded(plate, about=None):
    """Force, point and torque of the loaded samples of a plate, at the point or about another."""
    some = plate.force_n[:, 2] > 20.0
    torque = np.outer(plate.torque_nm, [0.0, 0.0, 1.0])
    if about is not None:
        torque = torque + np.cross(plate.point_m - about, plate.force_n)
    return plate.force_n[some], plate.point_m[some], torque[some]


@pytest.mark.parametrize("about", [None, [0.0, 0.0, 0.0], [0.4, -0.3, -0.05]])
@pytest.mark.parametrize("stated", [1.0, None])
def test_moments_about_a_point_that_is_not_stated(about, stated):
    for plate in TRUE.plates:
        found = reference_of_moments(*loaded(plate, about), stated)
        assert found.newton_metres == 1.0
        if about is None:
            assert found.origin_m is None
        else:
            np.testing.assert_allclose(found.origin_m, about, atol=1e-9)


def test_moments_that_no_point_explains_have_no_reference():
    force, point, torque = loaded(TRUE.plates[0])
    torque = torque + 0.3 * force[:, 2:] * np.sin(np.arange(len(force)))[:, None]
    assert reference_of_moments(force, point, torque, 1.0) is None
    assert "horizontal" in reference_at_point(force, point, torque).doubt


@pytest.mark.parametrize("unit", [1.0, 1e3])
@pytest.mark.parametrize("about", [[0.35, 0.2, -0.04], [3.0, -1.0, 0.9]])
def test_torques_about_any_fixed_point_that_should_act_at_the_point_are_moved_there(about, unit):
    """A plate's middle below its surface, or a place in the laboratory; in N m or N mm."""
    notes = []
    check_plates(TRUE, read(table(about=about, moment=unit, newton_metres=None), notes=notes))
    place = ", ".join(f"{value:.3f}" for value in about)
    assert len([note for note in notes if f"moments refer to ({place}) m" in note]) == 2
    assert len([note for note in notes if "taken as N mm" in note]) == (2 if unit > 1.0 else 0)


def test_free_torques_in_newton_millimetres_are_recognised():
    notes = []
    check_plates(TRUE, read(table(moment=1e3, newton_metres=None), notes=notes))
    assert len([note for note in notes if "taken as N mm" in note]) == 2


def test_torques_that_neither_a_point_nor_a_unit_explains_are_kept_and_reported():
    one, notes = table(), []
    values = np.array(one.values)
    values[:, 6] += 0.3 * values[:, 2] * np.sin(np.arange(len(values)))
    (plate, _) = read(replace(one, values=values), notes=notes)
    assert [note for note in notes if "set '1': torques at the points of application are" in note]
    lever = plate.moment_nm - np.cross(TRUE.plates[0].point_m - plate.origin_m, plate.force_n)
    np.testing.assert_allclose(lever[:, 0], values[:, 6], atol=1e-9)


@pytest.mark.parametrize("unit", [1.0, 1e3])
def test_torques_at_a_fixed_point_are_a_wrench_there(unit):
    """Some laboratories state plates' wrenches at fixed points; 100 m from their force, they are in N mm."""
    one, notes = table(), []
    values = np.array(one.values)
    for k, plate in enumerate(TRUE.plates):
        middle = plate.point_m.mean(axis=0) + np.array([0.1, 0.2, 0.0])
        values[:, 9 * k + 3 : 9 * k + 6] = middle
        values[:, 9 * k + 6 : 9 * k + 9] += np.cross(plate.point_m - middle, plate.force_n)
        values[:, 9 * k + 6 : 9 * k + 9] *= unit
    for truth, plate in zip(TRUE.plates, read(replace(one, values=values), notes=notes), strict=True):
        about_origin = plate.moment_nm + np.cross(plate.origin_m, plate.force_n)
        np.testing.assert_allclose(about_origin, truth.wrench[:, 3:], atol=1e-6)
    assert len(notes) == (2 if unit > 1.0 else 0)
