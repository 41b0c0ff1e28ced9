"""The reference that a trial belongs to: by places of markers, else by lengths of bones."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.scaling.records import ScalingSettings
from mbkf.study.scaling.owner import MOST_FRAMES, Bones, Reference, bones, few_frames, owner_of
from mbkf.trial.scale import scale
from tests.bending import MASS_KG, posed, squat, stander, standing, walk

TALL = 1.1


@cache
def references():
    tall = posed({}, factor=TALL)
    body = scale(tall, mass_kg=MASS_KG, protocol="reference36", settings=ScalingSettings(frames_per_trial=5))
    return Reference("small.c3d", stander(), standing()), Reference("tall.c3d", body, tall)


@pytest.mark.parametrize("movement", [walk, squat])
def test_of_two_persons_the_one_with_these_markers_is_found(movement):
    for number, factor in enumerate((1.0, TALL)):
        owner = owner_of(movement(factor=factor), references())
        assert (owner.number, owner.found) == (number, "")


def test_a_trial_of_another_person_belongs_to_nobody_and_the_lengths_that_differ_are_named():
    small, _ = references()
    owner = owner_of(walk(factor=TALL), [small])
    assert owner.number is None
    assert "mm from those in small.c3d" in owner.found and "longer): another person" in owner.found


def test_markers_that_were_put_on_anew_belong_to_the_person_whose_bones_agree():
    anew = walk(moved_m=0.01)
    owner = owner_of(anew, references())
    assert owner.number == 0 and owner.found.endswith("lengths of bones agree")
    assert [bones(anew, one) for one in references()] == [Bones.AGREE, Bones.DIFFER]
    assert owner_of(anew, references(), places_alone=True).number is None


def test_a_trial_with_few_of_the_names_cannot_be_compared():
    own = walk()
    assert owner_of(replace(own, markers=own.markers.select(("LASI", "RASI"))), references()) is None
    assert owner_of(own, []) is None
    own = replace(own, markers=own.markers.select(("LASI", "RASI")))
    assert bones(own, references()[0]) == Bones.OPEN


def test_few_frames_are_spread_over_the_capture_in_its_time():
    long = posed({}, frames=3 * MOST_FRAMES)
    few = few_frames(long).markers
    assert few.frames == MOST_FRAMES
    np.testing.assert_allclose(few.frames / few.rate_hz, long.markers.frames / long.markers.rate_hz)
    np.testing.assert_array_equal(few.positions_m[-1], long.markers.positions_m[-1])
    assert few_frames(walk()).markers.frames == walk().markers.frames


def test_key_points_are_compared_by_bones_alone():
    markers = tuple(replace(one, correlated_m=0.01, correlation_s=0.1) for one in stander().markers)
    keypoints = Reference("small.c3d", replace(stander(), markers=markers), standing())
    assert keypoints.places(walk()) is None
    for alone in (False, True):
        assert owner_of(walk(moved_m=0.01), [keypoints], places_alone=alone).number == 0
    owner = owner_of(walk(factor=TALL), [keypoints])
    assert owner.number is None and "longer than in small.c3d: another person" in owner.found
