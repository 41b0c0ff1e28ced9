"""A person weighed by plates: the true mass whatever was provisional, from the capture that tells it best."""

from dataclasses import replace

import pytest

from mbkf.errors import InvalidInput
from mbkf.trial.weighing import MASS_KEY, PROVISIONAL_KG, weighed
from tests.checked import body, recorded
from tests.dynamics import trial


def person(mass_kg=PROVISIONAL_KG):
    return replace(trial("squat").subject, mass_kg=mass_kg)


@pytest.mark.parametrize("mass_kg", [PROVISIONAL_KG, 130.0])
def test_the_mass_is_the_true_one(mass_kg):
    capture = replace(recorded("squat"), path="folder/squat.c3d")
    found = weighed(person(mass_kg), [capture])
    assert found.mass_kg == pytest.approx(body("squat").mass_kg, rel=0.01)
    assert found.report[MASS_KEY]["capture"] == "squat.c3d"
    assert found.report[MASS_KEY]["kg"] == found.mass_kg
    assert found.scale_factors == person().scale_factors


def test_captures_that_tell_nothing_do_not_count():
    squat = recorded("squat")
    bare = replace(squat, plates=(), path="bare.c3d")
    elsewhere = tuple(replace(plate, start_time_s=100.0) for plate in squat.plates)
    late = replace(squat, plates=elsewhere, path="late.c3d")
    found = weighed(person(), [bare, late, replace(squat, path="good.c3d")])
    assert found.report[MASS_KEY]["capture"] == "good.c3d"


def test_no_plates_tell_no_mass():
    bare = replace(recorded("squat"), plates=(), subject_mass_kg=None)
    with pytest.raises(InvalidInput, match=r"no capture has plates\); give --mass KG"):
        weighed(person(), [bare])
    with pytest.raises(InvalidInput, match=r"; 66\.0 kg, which a capture states, .*; give --mass KG"):
        weighed(person(), [bare, replace(bare, subject_mass_kg=66.0)])
