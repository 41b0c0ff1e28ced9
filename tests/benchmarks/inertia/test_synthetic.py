"""Persons off the table: by as much as told, left and right alike, with the same whole mass."""

import numpy as np
import pytest

from benchmarks.full_body.persons import subject_of
from benchmarks.inertia.synthetic import OFF, Errors, off_the_table
from mbkf.synthesis.person import body_of


def test_segments_are_off_by_a_tenth():
    table = subject_of(2)
    person = off_the_table(table, 2)
    for own in person.inertia.values():
        assert abs(own.mass_factor - 1.0) == pytest.approx(OFF)
    assert person.inertia["right_thigh"].mass_factor == person.inertia["left_thigh"].mass_factor
    bodies = body_of(person), body_of(table)
    levers = [np.array(b.pin_model.inertias[b.joint("left_shank").joint_id].lever) for b in bodies]
    assert np.linalg.norm(levers[0] - levers[1]) == pytest.approx(OFF * np.linalg.norm(levers[1]))
    assert sum(i.mass for i in bodies[0].pin_model.inertias) == pytest.approx(table.mass_kg)


def test_the_ratio_is_with_over_without():
    assert Errors(2.0, 1.0).ratio == 0.5
