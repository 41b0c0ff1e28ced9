"""Names that a capture has: kept where they fit, told where they do not, ignored where they mean nothing."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.running import RunningSettings
from mbkf.synthesis.cameras import without_labels
from mbkf.trial.label import label
from mbkf.trial.labelling.body import label_body
from mbkf.trial.labelling.known_names import KnownNames, known_names, no_names, with_claims
from mbkf.trial.labelling.score import score
from tests.stairs import stairs
from tests.walker import walker

pytestmark = pytest.mark.slow


@cache
def case(seed):
    return stairs(seed, seconds=1.0)


def body_of(subject):
    return label_body(subject.markers, subject, RunningSettings())


def known(markers, subject):
    body = body_of(subject)
    return known_names(markers, body.markers, body.sensor), body


def test_right_names_are_trusted():
    made = walker()
    names, body = known(made.trial.markers, made.subject)
    assert names.ignored == ""
    assert np.array_equal(names.trusted, names.claimed)
    there = made.trial.markers.present
    place = np.array([body.names.index(name) for name in made.trial.markers.names])
    assert np.array_equal(names.trusted, np.where(there, place, HIDDEN))


def test_names_without_a_marker_say_nothing():
    made = walker()
    names, _ = known(made.raw.markers, made.subject)
    assert not names.names
    assert np.array_equal(names.trusted, no_names(made.raw.markers).trusted)


def test_names_of_points_shuffled_in_every_frame_are_ignored():
    made = walker()
    shuffled = without_labels(made.trial.markers.positions_m, np.random.default_rng(0))
    names, _ = known(replace(made.trial.markers, positions_m=shuffled), made.subject)
    assert "from frame to frame" in names.ignored
    assert not names.names


def test_names_dealt_out_anew_mean_nothing():
    made = walker()
    markers = made.trial.markers
    dealt = np.random.default_rng(0).permutation(len(markers.names))
    names, _ = known(replace(markers, names=tuple(markers.names[k] for k in dealt)), made.subject)
    assert not names.names
    assert "contradict the body" in names.ignored


def test_a_name_on_another_marker_is_not_trusted_and_the_rest_is():
    made = walker()
    markers = made.trial.markers
    names = list(markers.names)
    wrong, heel = names.index("C7"), names.index("RHEE")
    names[wrong], names[heel] = "RHEE", "*0"
    found, body = known(replace(markers, names=tuple(names)), made.subject)
    assert (found.claimed[:, wrong] == body.names.index("RHEE"))[markers.present[:, wrong]].all()
    assert (found.trusted[:, wrong] == HIDDEN).all()
    others = np.delete(np.arange(len(names)), [wrong])
    assert np.array_equal(found.trusted[:, others], found.claimed[:, others])


def test_a_wrong_name_is_told_with_the_marker_that_it_fits():
    made = walker()
    names = list(made.trial.markers.names)
    wrong, heel = names.index("C7"), names.index("RHEE")
    names[wrong], names[heel] = "RHEE", "*0"
    raw = replace(made.trial, markers=replace(made.trial.markers, names=tuple(names)))
    found = label(raw, made.subject)
    result = score(found.markers, made.trial.markers, made.subject)
    assert result.correct_fraction >= 0.998
    assert any("name RHEE" in line and "was changed to C7" in line for line in found.doubts.warnings())


def test_names_are_claimed_where_nothing_else_has_them():
    claimed, labels = np.array([[0, 1, HIDDEN]]), np.array([[HIDDEN, HIDDEN, 1]])
    names = KnownNames(claimed, np.array([[0, HIDDEN, HIDDEN]]))
    assert with_claims(labels, names).tolist() == [[0, HIDDEN, 1]]
    assert with_claims(labels, replace(names, ignored="why")).tolist() == labels.tolist()


@pytest.mark.parametrize("seed", [0, 1])
def test_half_named_walk_is_labelled_around_its_names(seed):
    made = case(seed)
    found = label(made.raw, made.subject)
    result = score(found.markers, made.truth, made.subject)
    told = np.isin(result.names, found.doubts.labels)
    assert result.correct_fraction >= 0.97
    assert result.wrong[:, ~told].sum() <= 0.01 * result.present
    named = np.isin(result.names, made.named)
    assert not result.wrong[:, named].any()
    assert not result.missed[:, named].any()


def test_names_can_be_ignored():
    made = case(0)
    columns = np.array([k for k, name in enumerate(made.raw.markers.names) if name in made.named])
    names = list(made.raw.markers.names)
    for k, other in zip(columns, np.roll(columns, 1), strict=True):
        names[k] = made.raw.markers.names[other]
    dealt = replace(made.raw, markers=replace(made.raw.markers, names=tuple(names)))
    assert not known(dealt.markers, made.subject)[0].names
    found = label(dealt, made.subject, ignore_names=True)
    assert score(found.markers, made.truth, made.subject).correct_fraction >= 0.97
