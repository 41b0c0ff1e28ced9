"""The benchmark's own cases: combinations that are made, names that are withheld, messages that are read."""

import numpy as np
import pytest

from benchmarks.any_capture.marked import Known
from benchmarks.strangers import marker_sets
from benchmarks.strangers.marker_sets import FINGERS, Joining, with_combinations, withheld
from mbkf.errors import NotObservable
from mbkf.io.records import Capture
from mbkf.model.protocol import load_protocol
from tests.marker_sets.worn import standing


@pytest.fixture(scope="module")
def worn():
    return standing("plug_in_gait", 1)


def test_made_points_are_means_of_markers(worn):
    markers, made = with_combinations(worn.markers)
    assert made == {f"V{k}" for k in range(6)}
    assert markers.names[: len(worn.markers.names)] == worn.markers.names
    for name in made:
        point = markers.positions_m[:, markers.names.index(name)]
        away = np.linalg.norm(worn.markers.positions_m - point[:, None], axis=2).min(axis=1)
        assert 0.0 < away.max() < 0.5


def test_markers_of_a_segment_are_judged_with_their_names_withheld(worn, monkeypatch):
    capture = Capture("", worn.markers)
    one = Known("made", capture, capture, load_protocol("plug_in_gait"), ("plug_in_gait",))
    count = sum(segment == "pelvis" for segment in worn.segments.values())
    assert list(withheld(one, ("pelvis",))) == [Joining(count, count, 0)]

    def refuse(*_):
        raise NotObservable("no body")

    monkeypatch.setattr(marker_sets, "with_others", refuse)
    assert list(withheld(one, ("pelvis",))) == [Joining(count, 0, 0)], (
        "markers that do not join are not right"
    )


def test_the_message_on_a_hand_is_read():
    assert "right hand" in marker_sets._refusal(FINGERS)
