"""Findings of pieces put together."""

from dataclasses import replace

import pytest

from mbkf.io.contacts import ContactInterval
from mbkf.io.findings import judged, not_judged
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.trial.long.merging import Remarks, joined_contacts, joined_loads, unusual_checks, usual_checks

LOAD = UnexplainedLoad(1.0, 2.0, (0.0, 0.0, 200.0), 5.0, 0.3)
FOOT = ContactInterval("right_foot", 0.0, 0.99, 700.0, 2.0, "measured")


def check(value, name="mass"):
    return judged(name, value, 1.0, "%", 5.0, f"{value}")


def test_the_usual_finding_counts_and_others_are_said():
    pieces = [(check(v),) for v in (0.5, -9.0, 1.0, 3.0, 1.5)]
    (found,) = usual_checks(pieces)
    assert (found.value, found.verdict) == (1.5, "inside")
    (told,) = unusual_checks(pieces)
    assert told == "mass: outside its bound of 5 % in 1 of 5 parts of the trial, up to 9 %; -9.0"


def test_a_check_that_is_mostly_outside_is_outside_and_said_once():
    pieces = [(check(v),) for v in (0.5, -9.0, 8.0)]
    assert usual_checks(pieces)[0].value == 8.0
    assert unusual_checks(pieces) == ()


def test_pieces_that_cannot_judge_do_not_count():
    nothing = not_judged("mass", "%", 5.0, "too short")
    assert usual_checks([(nothing,), (nothing,), (check(1.0),)])[0].value == 1.0
    assert usual_checks([(nothing,), (nothing,)]) == (nothing,)


def test_a_load_across_a_border_is_one_with_the_force_of_its_longer_part():
    later = replace(LOAD, from_s=1.9, to_s=4.0, vector_n=(0.0, 0.0, 230.0))
    apart = replace(LOAD, from_s=4.5, to_s=5.0)
    downward = replace(LOAD, from_s=1.5, to_s=2.5, vector_n=(0.0, 0.0, -200.0))
    found = joined_loads([later, apart, LOAD, downward], 0.01)
    assert found == (replace(later, from_s=1.0), downward, apart)
    assert joined_loads([LOAD, LOAD], 0.01) == (LOAD,)


def test_a_contact_across_a_border_is_one():
    after = ContactInterval("right_foot", 1.0, 1.49, 900.0, 5.0, "measured")
    left = replace(after, part="left_foot")
    (one, other) = joined_contacts([after, left, FOOT], 0.01)
    assert (one.from_s, one.to_s, one.peak_n) == (0.0, 1.49, 900.0)
    assert one.sd_n == pytest.approx((100 * 2.0 + 50 * 5.0) / 150)
    assert other == left
    assert len(joined_contacts([FOOT, replace(after, how="estimated")], 0.01)) == 2
    assert len(joined_contacts([FOOT, replace(after, from_s=1.2)], 0.01)) == 2


def test_remarks_on_different_names_are_different():
    remarks = Remarks()
    remarks.add(
        ["plate '1': 3 of 9 samples are refused", "names LTHI1 and LTHI2 exchanged in 5 frames"], 0.0, 10.0
    )
    remarks.add(
        ["plate '2': 4 of 9 samples are refused", "names LTHI1 and LTHI3 exchanged in 5 frames"], 10.0, 20.0
    )
    assert len(remarks.texts()) == 4


def test_remarks_of_one_kind_are_one():
    remarks = Remarks()
    remarks.add(["no plates", "3 of 100 frames were lost"], 0.0, 10.0)
    remarks.add(["no plates"], 10.0, 20.0)
    remarks.add(["no plates", "7 of 100 frames were lost", "a thing"], 20.0, 30.0)
    assert remarks.texts() == (
        "no plates",
        "in 2 of 3 parts of the trial, such as 0 to 10 s: 3 of 100 frames were lost",
        "in 1 of 3 parts of the trial, such as 20 to 30 s: a thing",
    )
