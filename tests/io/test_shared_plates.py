"""Plates on which another person of a capture stands."""

import numpy as np
import pytest

from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.io.shared_plates import without_others_plates


def plate(name, centre):
    force = np.tile([0.0, 0.0, 600.0], (100, 1))
    return PlateReadings(
        name, 100.0, 0.0, np.zeros(3), force, np.zeros((100, 3)), np.tile(centre, (100, 1)), 20.0
    )


def person(y):
    places = np.tile([[0.0, y, 0.05], [0.0, y, 1.0]], (100, 1, 1))
    return MarkerTrajectories(("TOE", "SACR"), places, 100.0)


@pytest.mark.parametrize(
    ("mine", "theirs", "left"), [(0.0, 1.0, ["1"]), (1.0, 0.0, ["2"]), (5.0, 6.0, ["1", "2"])]
)
def test_a_plate_below_the_other_person_is_left_out(mine, theirs, left):
    plates = plate("1", [0.1, 0.0, 0.0]), plate("2", [0.1, 1.0, 0.0])
    found = without_others_plates(Capture("a", person(mine), plates, others=person(theirs)))
    assert [one.name for one in found.plates] == left
    assert set(found.plates_left_out) == {"1", "2"} - set(left)
    assert all("another person stands on it" in note for note in found.notes)


def test_a_plate_on_which_both_stand_stays_and_is_reported():
    moving = np.array(person(0.0).positions_m)
    moving[50:, :, 1] = 2.0
    own = MarkerTrajectories(("TOE", "SACR"), moving, 100.0)
    there = MarkerTrajectories(("TOE", "SACR"), moving[::-1], 100.0)
    found = without_others_plates(Capture("a", own, (plate("1", [0.0, 0.0, 0.0]),), others=there))
    assert [one.name for one in found.plates] == ["1"]
    assert "carries another person in 50 % of its loaded time" in found.notes[0]


def test_without_a_choice_plates_stay():
    capture = Capture("a", person(9.0), (plate("1", [0.0, 0.0, 0.0]),))
    assert without_others_plates(capture) is capture
