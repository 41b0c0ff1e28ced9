"""A look at spread frames is decided as the whole trial is, and hides samples by its own times."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.order import needs_motion, ready, searches_contacts
from mbkf.trial.preparation.settings import Hidden, ReconstructSettings
from mbkf.trial.synth import synthesise


@pytest.fixture(scope="module")
def walk():
    return synthesise("walk", seconds=1.0)


def test_a_look_is_decided_as_the_whole_and_hides_by_its_times(walk):
    person, made = walk
    settings = ReconstructSettings(hide=(Hidden(("RKNE",), 0.4, 0.6),))
    capture = made.trial
    markers = capture.markers
    times_s, looked = markers.times_s[::3], markers.positions_m[::3]
    look = replace(capture, markers=replace(markers, positions_m=looked), plates=())
    whole, spread = ready(capture, person, settings), ready(look, person, settings, times_s)
    np.testing.assert_array_equal(spread.hidden, whole.hidden[::3])
    assert spread.hidden.sum() == ((times_s >= 0.4) & (times_s <= 0.6)).sum() > 0
    np.testing.assert_array_equal(spread.shown.present, spread.measured.present & ~spread.hidden)
    assert spread.measured.names == whole.measured.names == whole.inputs.names
    assert spread.use.used == whole.use.used and spread.before is whole.before is person


def test_markers_alone_are_followed_where_something_asks_for_their_motion(walk):
    person, made = walk
    quiet = ReconstructSettings(checks=False, other_contacts=False)
    inputs = ready(made.trial, person, quiet).inputs
    assert not needs_motion(quiet, inputs) and needs_motion(replace(quiet, checks=True), inputs)
    searching = replace(quiet, other_contacts=True)
    assert searches_contacts(searching) and needs_motion(searching, inputs)
    assert not searches_contacts(replace(searching, filter="kinematic"))
