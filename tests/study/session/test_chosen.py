"""Measured and estimated cycles are never averaged together."""

from dataclasses import replace

import numpy as np

from mbkf.io.contacts import Source
from mbkf.study.session.chosen import chosen_curves
from mbkf.study.session.cycles import Key
from mbkf.study.session.gather import session_of
from tests.study.session.sessions import estimated, session, walks

TORQUE, ANGLE = Key("torque", "knee_angle"), Key("angle", "knee_angle")


def side_of(results):
    return session_of(results, "x").gaits[0].sides[0]


def test_all_angles_count():
    side = side_of([walks()[0], estimated(walks()[1])])
    found = chosen_curves(side, ANGLE)
    assert found.mean.count == len(side.cycles) and not found.estimated and len(found.others) == 0
    np.testing.assert_allclose(found.mean.mean, side.curves[ANGLE].values.mean(axis=0))


def test_measured_loads_count_and_estimated_ones_stand_beside():
    side = side_of([walks()[0], estimated(walks()[1])])
    measured = np.array([one.measured for one in side.cycles])
    found = chosen_curves(side, TORQUE)
    assert measured.any() and not measured.all() and not found.estimated
    np.testing.assert_array_equal(found.counted, side.curves[TORQUE].values[measured])
    np.testing.assert_array_equal(found.others, side.curves[TORQUE].values[~measured])
    np.testing.assert_allclose(found.mean.mean, found.counted.mean(axis=0))


def test_estimated_loads_stand_in_where_nothing_is_measured():
    side = side_of([estimated(r) for r in walks()])
    found = chosen_curves(side, TORQUE)
    assert found.estimated and found.mean.count == len(side.cycles) and len(found.others) == 0


def test_loads_that_are_not_known_count_nowhere():
    side = side_of([replace(estimated(r), valid=np.zeros(r.frames, bool)) for r in walks()])
    found = chosen_curves(side, TORQUE)
    assert found.mean is None and not found.estimated and np.isnan(found.off_percent)
    assert chosen_curves(side, ANGLE).mean is not None


def test_a_leg_counts_by_its_own_foot_and_the_trunk_by_both():
    r = walks()[0]
    source = r.foot_source.copy()
    source[:, 1] = np.where(source[:, 1] != Source.NONE, Source.SHARED, Source.NONE)
    one = replace(r, foot_source=source, measured=np.zeros(r.frames, bool))
    right, left = session_of([one], "x").gaits[0].sides
    trunk = Key("torque", "lumbar_extension")
    assert not chosen_curves(right, TORQUE).estimated and chosen_curves(left, TORQUE).estimated
    assert right.curves[trunk].midline and chosen_curves(right, trunk).estimated


def test_toe_off_is_that_of_the_cycles_that_count():
    side = session().gaits[0].sides[1]
    found = chosen_curves(side, TORQUE)
    np.testing.assert_allclose(found.off_percent, np.mean([one.cycle.off_percent for one in side.cycles]))
