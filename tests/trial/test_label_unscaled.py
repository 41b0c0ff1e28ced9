"""Labels and a scaled person from shuffled points and a protocol, without a subject."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.trial.label_unscaled import label_unscaled
from mbkf.trial.labelling.score import score
from mbkf.trial.scale import scale
from tests.walker import walker

pytestmark = pytest.mark.slow

HEIGHT_M = 1.86
OFF = ("RMID", "LTUB", "RHA5")
"""Markers that the walker does not wear here."""


def worn():
    """The walk's markers but for those taken off."""
    every = walker().trial.markers
    return every.select(tuple(name for name in every.names if name not in OFF))


def shuffled():
    """The walk's points without names, those of the markers taken off left out."""
    raw, gone = walker().raw, walker().trial.markers.select(OFF).positions_m
    points = raw.markers.positions_m.copy()
    points[(points[:, :, None] == gone[:, None]).all(axis=3).any(axis=2)] = np.nan
    return replace(raw, markers=replace(raw.markers, positions_m=points))


@pytest.fixture(scope="module")
def found():
    """Labels, subject and the stages that were reported."""
    stages = []
    labelling, subject = label_unscaled(
        shuffled(),
        "reference36",
        mass_kg=walker().subject.mass_kg,
        height_m=HEIGHT_M,
        progress=lambda stage, *_: stages.append(stage),
    )
    return labelling, subject, stages


def test_shuffled_points_of_a_stranger_are_named(found):
    labelling, subject, _ = found
    result = score(labelling.markers, worn(), subject)
    assert result.correct_fraction >= 0.995
    assert result.wrong_fraction <= 0.001


def test_the_person_is_scaled_on_the_way(found):
    _, subject, stages = found
    named = replace(walker().trial, markers=worn())
    expected = scale(None, [named], mass_kg=subject.mass_kg, height_m=HEIGHT_M)
    for factor, value in subject.scale_factors.items():
        assert value == pytest.approx(expected.scale_factors[factor], abs=0.03), factor
    assert subject.report["marker_rms_mm"] < 10.0
    assert subject.protocol == "reference36"
    assert "Searching any attitude" in stages
    assert "Judging names" in stages


def test_markers_that_are_not_worn_are_not_named(found):
    """Their names go to no point, and no neighbour takes another's."""
    labelling, subject, _ = found
    assert not set(OFF) & set(subject.report["markers"])
    assert labelling.doubts is not None
    assert set(OFF) == set(labelling.doubts.unused)


def test_points_that_are_nobody_are_refused():
    made = walker()
    rng = np.random.default_rng(0)
    wandering = rng.uniform(-1.0, 1.0, (40, 3)) + np.cumsum(rng.normal(0.0, 0.004, (60, 40, 3)), axis=0)
    names = tuple(f"*{k}" for k in range(40))
    nobody = replace(made.raw, markers=replace(made.raw.markers, names=names, positions_m=wandering))
    with pytest.raises(NotObservable, match="reference36"):
        label_unscaled(nobody, "reference36", mass_kg=70.0, height_m=1.8)


def test_mass_and_protocol_must_be_known():
    made = walker()
    with pytest.raises(InvalidInput, match="--mass"):
        label_unscaled(replace(made.raw, subject_mass_kg=None), "reference36")
    with pytest.raises(UnknownName):
        label_unscaled(made.raw, "nosuch", mass_kg=70.0)
