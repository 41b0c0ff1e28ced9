"""The marker set of captures: the shipped one that knows enough of the names, else an inferred one."""

from dataclasses import replace

import pytest

from mbkf.errors import NotObservable
from mbkf.io.records import Capture
from mbkf.trial.preparation.coverage import LEAST_SHARE
from mbkf.trial.protocol.choice import choose_marker_set, inferred_choice, shipped_protocol
from mbkf.trial.protocol.inferred import NAME
from tests.marker_sets.worn import standing


@pytest.fixture(scope="module")
def capture():
    return Capture("", standing("plug_in_gait", 1).markers)


def with_strangers(capture, share):
    """So large a share of the markers has names that no protocol knows."""
    names = capture.markers.names
    count = round(share * len(names))
    changed = (*(f"M{k}" for k in range(count)), *names[count:])
    return replace(capture, markers=replace(capture.markers, names=changed))


def test_a_shipped_protocol_is_chosen_by_the_names(capture):
    chosen = choose_marker_set(capture, [])
    assert chosen.protocol.name == "plug_in_gait"
    assert chosen.inferred is None
    assert chosen.captures == (capture,)


def test_without_known_names_the_set_is_inferred(capture):
    strange = with_strangers(capture, 1.0)
    assert shipped_protocol([strange]) is None
    chosen = choose_marker_set(strange, [])
    assert chosen.inferred is not None
    assert chosen.protocol is chosen.inferred.protocol
    assert chosen.protocol.name == NAME


def test_a_protocol_that_knows_too_few_is_not_chosen(capture):
    assert shipped_protocol([with_strangers(capture, 1.0 - LEAST_SHARE - 0.1)]) is not None
    assert shipped_protocol([with_strangers(capture, 1.0 - LEAST_SHARE + 0.1)]) is None


def test_a_set_may_be_inferred_whatever_the_names(capture):
    chosen = inferred_choice(capture, [])
    assert chosen.protocol.name == NAME
    assert {m.name for m in chosen.protocol.markers} == set(capture.markers.names)


def test_strangers_that_are_no_person_are_refused(capture):
    few = with_strangers(replace(capture, markers=capture.markers.select(capture.markers.names[:8])), 1.0)
    with pytest.raises(NotObservable, match="fewer than 12"):
        choose_marker_set(few, [])
