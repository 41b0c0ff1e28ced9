"""Markers of the legs at their places in the subject file: small changes are a session's, large ones a person's."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.model.body_file import load_body
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.checks.places import BOUND, place_of_markers_finding, sides

PERSON = synthesise_subject(3)
NAMES = tuple(marker.name for marker in PERSON.markers)


def corrected(times, starts="left_"):
    """The person with the markers of some segments moved by so many of their usual spreads."""
    moved = [
        replace(m, position_m=m.position_m + np.array([0.0, times * m.session_sd_m, 0.0]))
        if m.segment.startswith(starts)
        else m
        for m in PERSON.markers
    ]
    return replace(PERSON, markers=tuple(moved))


@pytest.mark.parametrize(
    ("times", "verdict"), [(0.0, "inside"), (0.9, "inside"), (1.2, "doubtful"), (5.0, "outside")]
)
def test_the_leg_that_moved_more_is_judged(times, verdict):
    found = place_of_markers_finding(PERSON, corrected(times), NAMES)
    assert found.value == pytest.approx(times) and found.verdict == verdict
    assert found.segment == ("left_thigh" if times else "right_thigh")


def test_trunk_and_arms_are_not_judged():
    assert place_of_markers_finding(PERSON, corrected(9.0, "torso"), NAMES).value == pytest.approx(0.0)


def test_one_loose_marker_is_no_other_person():
    loose = tuple(
        replace(m, position_m=m.position_m + np.array([0.1, 0.0, 0.0])) if m.name == "LKNE" else m
        for m in PERSON.markers
    )
    found = place_of_markers_finding(PERSON, replace(PERSON, markers=loose), NAMES)
    assert found.value is not None and found.value < BOUND


def test_without_markers_of_legs_it_is_not_judged():
    assert place_of_markers_finding(PERSON, PERSON, ("C7", "CLAV")).verdict == "not judged"


def test_the_side_is_that_of_the_foot_not_of_a_name():
    body = load_body()
    names = {one.name: f"bone {number}" for number, one in enumerate(body.segments)} | {"world": "world"}
    roles = {key: tuple(names[one] for one in getattr(body.roles, key)) for key in ("feet", "toes", "legs")}
    segments = tuple(replace(one, name=names[one.name], parent=names[one.parent]) for one in body.segments)
    found = sides(replace(body, segments=segments, roles=replace(body.roles, **roles)))
    legs = {*body.roles.legs, *body.roles.feet, *body.roles.toes}
    assert found == {names[one]: one.split("_")[0] for one in legs}
