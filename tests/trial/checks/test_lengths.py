"""Scale factors of right and left: the limb that differs most, by its own spread."""

from dataclasses import replace

import pytest

from mbkf.trial.checks.lengths import length_finding
from tests.dynamics import trial


def person(**factors):
    subject = trial("squat").subject
    same = {name: 1.0 for name in subject.scale_factors}
    assert set(factors) <= set(same)
    return replace(subject, scale_factors=same | factors)


def test_equal_sides_are_inside():
    found = length_finding(person())
    assert (found.value, found.verdict) == (0.0, "inside")


def test_the_limb_that_differs_is_named():
    found = length_finding(person(right_thigh=1.1, left_shank=1.01))
    assert found.value == pytest.approx(10.0)
    assert found.verdict == "outside"
    assert "right thigh is scaled 10.0 % longer" in found.hint


def test_a_factor_that_is_not_well_known_is_not_accused():
    found = person(right_forearm=1.1)
    assert length_finding(found).verdict == "outside"
    table = {"right_forearm": {"standard_error": 0.06}}
    assert length_finding(replace(found, report={"factors": table})).verdict == "inside"


def test_a_body_without_sides_is_not_judged():
    assert length_finding(replace(person(), scale_factors={"head": 1.0})).verdict == "not judged"
