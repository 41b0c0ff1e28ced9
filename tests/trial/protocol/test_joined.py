"""Markers that a shipped set does not know: they join it on their segments, and are reported."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.records import Capture
from mbkf.model.protocol import load_protocol
from mbkf.trial.preparation.coverage import use_by_protocol
from mbkf.trial.protocol.inferred import OBJECT
from mbkf.trial.protocol.joined import with_others
from tests.marker_sets.worn import near, standing

SET = "plug_in_gait"
WAIST = ("RASI", "LASI", "RPSI", "LPSI")


def renamed(worn, names):
    markers = replace(worn.markers, names=tuple(names.get(name, name) for name in worn.markers.names))
    return Capture("static.c3d", markers)


@pytest.fixture(scope="module")
def worn():
    return standing(SET, 1)


@pytest.fixture(scope="module")
def joined(worn):
    """The waist under names without a meaning, a midpoint of the knees, and a box by name."""
    own = worn.markers.names
    middle = worn.markers.positions_m[:, [own.index("LKNE"), own.index("RKNE")]].mean(axis=1)
    box = np.broadcast_to([0.5, 0.6, 0.2], middle.shape)
    positions = np.concatenate([worn.markers.positions_m, middle[:, None], box[:, None]], axis=1)
    more = replace(worn.markers, names=(*own, "Q9", "Box1"), positions_m=positions)
    names = {name: f"Q{k}" for k, name in enumerate(WAIST)}
    capture = renamed(replace(worn, markers=more), names)
    return capture, with_others(load_protocol(SET), capture, [], [SET])


def test_a_set_that_knows_every_marker_stays(worn):
    assert with_others(load_protocol(SET), Capture("", worn.markers), []) is None


def test_unknown_markers_are_on_their_segments(joined, worn):
    _, found = joined
    assert [one.name for one in found.markers] == ["Q0", "Q1", "Q2", "Q3"]
    assert all(near(one.segment, worn.segments[WAIST[k]]) for k, one in enumerate(found.markers))
    own = load_protocol(SET).markers
    assert found.protocol.markers[: len(own)] == own, "those of the set are as they were"


def test_computed_points_and_objects_do_not_join(joined):
    _, found = joined
    assert found.protocol.ignored["Box1"] == OBJECT
    assert found.protocol.ignored["Q9"] == "computed by software: a combination of RKNE, LKNE"


def test_they_are_reported(joined, worn):
    capture, found = joined
    assert found.line.startswith("joined to plug_in_gait by inference: Q0 (pelvis), Q1 (pelvis)")
    assert found.line.endswith("left out: Box1, Q9")
    assert set(found.doubts) == {one.name for one in found.markers if one.probability < 0.9}
    known = len(worn.markers.names) - len(WAIST)
    use = use_by_protocol([capture.markers], found.protocol)
    assert use.summary == (
        f"plug_in_gait knows {known} of {known + 6} markers ({100 * known / (known + 6):.0f} %), 4 more inferred"
    )
    assert use.unknown == ()
    assert use.as_report()["joined"] == ["Q0", "Q1", "Q2", "Q3", "Q9", "Box1"]


def test_a_landmark_that_the_set_uses_is_not_used_again(worn):
    """A second marker beside the knee's is placed where it is, not on the epicondyle."""
    own = worn.markers.names
    beside = worn.markers.positions_m[:, own.index("LKNE")] + [0.0, 0.0, 0.03]
    positions = np.concatenate([worn.markers.positions_m, beside[:, None]], axis=1)
    more = replace(worn.markers, names=(*own, "Q1"), positions_m=positions)
    found = with_others(load_protocol(SET), Capture("", more), [], [SET])
    (marker,) = found.markers
    assert near(marker.segment, "left_thigh")
    assert (marker.kind, marker.landmark) == ("technical", "")
