"""Sensors worn otherwise: groups and pairs that are looked at, and what is told of the least misfit."""

import numpy as np

from mbkf.trial.inertial.mounted_reversed import SensorPlacement, groups, likely, mounted_reversed
from tests.worn import worn

SEGMENTS = ("pelvis", "right_thigh", "left_thigh", "right_shank", "left_foot", "torso")


def test_pairs_are_sides_and_neighbours_that_carry_sensors():
    found = list(likely(worn().model, ("pelvis", "right_thigh", "left_thigh", "right_shank")))
    assert set(found) == {("right_thigh", "left_thigh"), ("right_thigh", "right_shank")}


def test_groups_are_worn_alike_and_hold_every_sensor_once():
    found = list(groups(worn().model, SEGMENTS))
    assert sorted(name for group in found for name in group) == sorted(SEGMENTS)
    assert frozenset({"right_thigh", "left_thigh", "right_shank"}) in found


def judged(best_turned, best_names, seen=None):
    """A misfit that is least for one way of wearing sensors."""

    def judge(turned, names, beyond):
        if seen is not None:
            seen.append((turned, dict(names)))
        wrong = len(turned ^ best_turned) + len(set(names.items()) ^ set(best_names.items()))
        assert beyond > 0.0
        return np.inf if 1.0 + wrong > beyond else 1.0 + wrong  # as a misfit that is left off early

    return judge


def test_what_is_turned_is_found_group_by_group_and_then_exchanges():
    legs = frozenset({"right_thigh", "left_thigh", "right_shank"})
    names = {"right_thigh": "left_thigh", "left_thigh": "right_thigh"}
    found = mounted_reversed(worn().model, SEGMENTS, 1.0 + 4 + 2, judged(legs | {"pelvis"}, names))
    assert found.turned == legs | {"pelvis"}
    assert found.exchange is not None and set(found.exchange.segments) == set(names)
    assert len(found.remarks) == 2 and "exchanged" in found.remarks[0] and "pelvis" in found.remarks[1]


def test_sensors_worn_as_usual_are_not_accused():
    assert mounted_reversed(worn().model, SEGMENTS, 1.0, judged(frozenset(), {})) == SensorPlacement()
    assert mounted_reversed(worn().model, SEGMENTS, np.inf, lambda *_: 0.0) == SensorPlacement()
    assert SensorPlacement().remarks == ()
