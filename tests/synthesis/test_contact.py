"""The split of the ground's wrench between two feet on surfaces of their own heights."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.synthesis.contact import Load, split

numbers = st.floats(-1.0, 1.0)
rows = st.lists(numbers, min_size=2, max_size=2)


def one(share, pressure, surface):
    """The load of a single moment."""
    return Load(np.array([share]), np.array([pressure]), np.array([True]), np.array([surface]))


@given(
    share=st.sampled_from([0.0, 1.0]) | st.floats(0.01, 0.99),
    pressure=st.lists(rows, min_size=2, max_size=2),
    surface=st.lists(st.floats(-0.3, 0.3), min_size=2, max_size=2),
    force=rows,
    moment=st.lists(numbers, min_size=3, max_size=3),
)
def test_both_feet_together_give_the_whole_wrench_from_points_of_their_surfaces(
    share, pressure, surface, force, moment
):
    whole = np.array([[150 * force[0], 150 * force[1], 700.0, *(300 * np.array(moment))]])
    load = one(share, 0.5 * np.array(pressure), surface)
    wrenches, centres = split(whole, load, np.array([0.95]))
    assert np.abs(wrenches.sum(axis=1) - whole).max() < 1e-9
    for foot, part in enumerate(load.shares[0]):
        own, at = wrenches[0, foot], centres[0, foot]
        assert own[2] == pytest.approx(700.0 * part)
        if part == 0.0:
            assert not own.any()
            assert np.isnan(at).all()
            continue
        assert at[2] == surface[foot]
        free = own[3:] - np.cross(at, own[:3])
        assert np.abs(free[:2]).max() < 1e-9


@given(
    share=st.floats(0.01, 0.99),
    pressure=st.lists(rows, min_size=2, max_size=2),
    surface=st.lists(st.floats(-0.3, 0.3), min_size=2, max_size=2),
    force=rows,
)
def test_the_point_of_zero_moment_of_a_load_gives_its_pressure(share, pressure, surface, force):
    height, load = np.array([0.95]), one(share, 0.5 * np.array(pressure), surface)
    x, y = load.zero_moment(height)[0]
    pull = np.array([100 * force[0], 100 * force[1], 700.0])
    whole = np.r_[pull, np.cross([x, y, load.mean_surface[0]], pull)][None]
    _, centres = split(whole, load, height)
    assert np.abs(centres[0, :, :2] - load.pressure[0]).max() < 1e-9


def test_on_one_level_the_mean_pressure_is_the_point_of_zero_moment():
    load = one(0.3, [[0.1, -0.1], [0.0, 0.2]], [0.2, 0.2])
    assert np.array_equal(load.zero_moment(np.array([1.0])), load.total_pressure)
    assert load.mean_surface[0] == pytest.approx(0.2)


def test_without_surfaces_the_feet_stand_on_the_floor():
    load = Load(np.array([0.5]), np.zeros((1, 2, 2)), np.array([True]))
    assert not load.surfaces.any()
