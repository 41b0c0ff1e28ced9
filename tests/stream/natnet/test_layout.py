"""What a frame's markers, points and plates become, against a marker by marker reading."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import InvalidInput
from mbkf.io.axes import rotation_to_world
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.descriptions import Descriptions, MarkerSet
from mbkf.stream.natnet.frames import Frame, read_frame
from mbkf.stream.natnet.layout import StreamLayout
from mbkf.stream.natnet.packets import ForcePlate
from mbkf.stream.natnet.player import axes_of
from tests.stream.natnet import layouts

ROTATION = rotation_to_world("y")
CORNERS = np.array([[0.6, 0.0, 0.4], [0.0, 0.0, 0.4], [0.0, 0.0, 0.0], [0.6, 0.0, 0.0]])
SETS = (MarkerSet("All", ("A", "B", "C", "D")), MarkerSet("one", ("A", "B")), MarkerSet("two", ("C", "D")))


def plate(number, corners=CORNERS, **changes):
    known = ForcePlate(number, f"s{number}", np.array([0.01, 0.02, 0.03]), corners)
    return replace(known, **changes)


def frames(rate_hz=100.0, count=3, **content):
    return [
        read_frame(layouts.frame((4, 1), k, k / rate_hz, **content), (4, 1)) for k in range(10, 10 + count)
    ]


def layout(plates=(), first=None, sets=SETS):
    return StreamLayout(Descriptions(tuple(sets), tuple(plates)), first or frames(), ROTATION)


def one_by_one(described, frame):
    """Named markers by a loop: those at nought, at an occluded one, or in a set of another size are missing."""
    filled = [m["position"].tolist() for m in frame.labelled if m["flags"] & packets.OCCLUDED]
    rows = []
    for one in described:
        found = frame.sets.get(one.name, np.zeros((0, 3))).tolist()
        found = found if len(found) == len(one.markers) else []
        found = [[math.nan] * 3 if row in filled or row == [0.0, 0.0, 0.0] else row for row in found]
        rows += found + [[math.nan] * 3] * (len(one.markers) - len(found))
    return np.array(rows).reshape(-1, 3) @ ROTATION.T


def test_residuals_are_those_of_the_labelled_markers_at_the_places():
    a, b, c, d, bare = np.arange(1.0, 16.0).reshape(5, 3)
    markers = [
        (1, b, 0, 0.25),
        (2, a, 0, 0.5),
        (3, c, packets.OCCLUDED, 0.75),
        (4, bare, packets.UNLABELLED, 0.125),
    ]
    markers.append((5, d, 0, -1.0))
    (frame,) = frames(
        count=1, sets=[("one", [a, b]), ("two", [c, d])], points=[bare, bare + 1.0], markers=markers
    )
    one = layout()
    found = one.frame(frame, 1.5).residuals_m
    np.testing.assert_array_equal(found, [0.5, 0.25, math.nan, math.nan, 0.125, math.nan])
    one.describe(Descriptions((MarkerSet("one", ("B", "A")), MarkerSet("two", ("C", "D"))), ()))
    np.testing.assert_array_equal(one.frame(frame, 1.5).residuals_m, found[[1, 0, 2, 3, 4, 5]])
    in_order = [
        (k, at, 0, residual)
        for k, (at, residual) in enumerate(zip((a, b, c, d), (1.0, 2.0, -1.0, 4.0), strict=True))
    ]
    (rule,) = frames(count=1, sets=[("one", [a, b]), ("two", [c, d])], markers=in_order)
    np.testing.assert_array_equal(layout().frame(rule, 1.5).residuals_m, [1.0, 2.0, math.nan, 4.0])
    (without,) = frames(count=1, sets=[("one", [a, b]), ("two", [c, d])])
    assert one.frame(without, 1.5).residuals_m is None


VALUES = st.sampled_from([0.0, -0.0, 1.0, 2.0, 0.5, math.nan])
POINT = st.tuples(VALUES, VALUES, VALUES)


@given(
    sent=st.lists(st.tuples(st.sampled_from(["all", "one", "two"]), st.lists(POINT, max_size=4)), max_size=3),
    labelled=st.lists(st.tuples(POINT, st.sampled_from([0, 1, 2, 3, 0x12, 0x13])), max_size=5),
    points=st.lists(POINT, max_size=2),
)
def test_markers_are_those_of_a_loop(sent, labelled, points):
    markers = [(k, np.array(at), flags) for k, (at, flags) in enumerate(labelled)]
    sets = [(name, np.reshape(at, (-1, 3))) for name, at in sent]
    frame = read_frame(layouts.frame((4, 0), sets=sets, markers=markers, points=points), (4, 0))
    found = layout().frame(frame, 0.0)
    np.testing.assert_array_equal(found.markers_m, one_by_one(SETS[1:], frame))
    unnamed = points or [at for at, flags in labelled if flags & packets.UNLABELLED]
    np.testing.assert_array_equal(found.unlabelled_m, np.reshape(unnamed, (-1, 3)) @ ROTATION.T)


def test_the_set_of_all_markers_is_left_out():
    described = layout().stream
    assert (described.trial, described.marker_names) == ("one", ("A", "B", "C", "D"))
    assert layout(sets=()).stream.marker_names == ()
    frame = layout(sets=()).frame(frames(points=[np.ones(3)])[0], 1.5)
    assert (frame.markers_m.shape, frame.unlabelled_m.shape, frame.arrival_s) == ((0, 3), (1, 3), 1.5)


def test_plates_are_turned_about_their_own_axes():
    rng = np.random.default_rng(0)
    tilted = CORNERS @ np.linalg.qr(rng.normal(size=(3, 3)))[0].T
    samples = rng.normal(size=(2, 8, 4))
    plates = [(1, samples[0]), (7, samples[1])]
    made = layout([plate(7, tilted), plate(1)], frames(plates=plates))
    assert made.stream.plate_rate_hz == 400.0
    found = made.frame(frames(plates=plates)[0], 0.0).plates
    assert found.index.tolist() == [40, 41, 42, 43]
    for k, (corners, sent) in enumerate(((tilted, samples[1]), (CORNERS, samples[0]))):
        axes = axes_of(corners @ ROTATION.T)
        for j, channel in enumerate(sent.astype(np.float32).T.astype(float)):
            np.testing.assert_allclose(found.wrench[j, k, :3], axes @ channel[:3], atol=1e-12)
            np.testing.assert_allclose(found.wrench[j, k, 3:], axes @ channel[3:6], atol=1e-12)
        np.testing.assert_allclose(
            made.stream.plates[k].origin_m,
            (corners @ ROTATION.T).mean(axis=0) + axes @ [0.01, 0.02, 0.03],
        )


def test_a_plate_without_its_usual_samples_is_not_read():
    usual, other = [(1, np.ones((6, 4))), (2, np.ones((6, 4)))], [(1, np.ones((6, 3))), (2, np.ones((6, 4)))]
    made = layout([plate(1), plate(2)], frames(plates=usual))
    found = made.frame(frames(plates=other)[0], 0.0).plates.wrench
    assert np.isnan(found[:, 0]).all() and not np.isnan(found[:, 1]).any()
    assert len(made.frame(frames()[0], 0.0).plates.index) == 0


@pytest.mark.parametrize("changes", [{"raw": True}, {"channels": ("a", "b")}])
def test_raw_voltages_are_refused(changes):
    with pytest.raises(InvalidInput, match="raw voltages"):
        layout([plate(1, **changes)])


@pytest.mark.parametrize(
    ("sent", "stated"), [(100.05, 100.0), (119.88, 120.0), (99.4, 99.4), (1000.0, 1000.0)]
)
def test_the_rate_follows_from_the_time_stamps(sent, stated):
    assert layout(first=frames(sent, 10)).stream.rate_hz == pytest.approx(stated, rel=1e-9)


@pytest.mark.parametrize("last", [(1, 1.0), (0, 2.0), (2, 1.0), (2, 0.5), (2, math.nan), (2, math.inf)])
def test_time_stamps_without_a_rate_are_refused(last):
    first = frames()[0]
    stamped = [Frame(number, time_s, *first[2:]) for number, time_s in ((1, 1.0), last)]
    with pytest.raises(InvalidInput, match="no rate"):
        layout(first=stamped)


def test_numbers_that_are_none_pass_quietly():
    """Signalling NaN and infinities of a damaged packet neither warn nor stop the stream."""
    wild = np.array([0x7FA00000, 0x7F800000, 0xFF800000] * 2, dtype="<u4").view("<f4")
    content = {"sets": [("one", wild.reshape(2, 3))], "plates": [(1, np.tile(wild[:, None], 2))]}
    made = layout([plate(1, np.full((4, 3), np.inf))], frames(plates=[(1, np.ones((6, 2)))]))
    frame = made.frame(frames(**content)[0], 0.0)
    assert not np.isfinite(frame.markers_m).any()
    assert not np.isfinite(frame.plates.wrench).any()


def sent_as(sets, positions):
    """A frame of sets whose markers stand at the positions of their names."""
    return frames(sets=[(one.name, [positions[name] for name in one.markers]) for one in sets])[0]


POSITIONS = {name: np.full(3, 1.0 + k) for k, name in enumerate("ABCDE")}


@pytest.mark.parametrize(
    "sets",
    [
        (MarkerSet("one", ("B", "A")), MarkerSet("two", ("C", "D"))),
        (MarkerSet("two", ("D", "E", "C")), MarkerSet("one", ("A", "B"))),
        (MarkerSet("all", ("E",)), MarkerSet("new", ("D", "C", "B", "A"))),
    ],
)
def test_markers_that_are_described_in_another_order_keep_their_columns(sets):
    made = layout()
    expected = made.frame(sent_as(SETS, POSITIONS), 0.0).markers_m
    assert made.describe(Descriptions(sets, ())) == []
    assert made.stream.marker_names == ("A", "B", "C", "D")
    np.testing.assert_array_equal(made.frame(sent_as(sets, POSITIONS), 0.0).markers_m, expected)


def test_markers_that_are_described_no_more_are_missing():
    made, sets = layout(), (MarkerSet("one", ("B",)), MarkerSet("two", ("C", "D")))
    ((kind, sentence),) = made.describe(Descriptions(sets, ()))
    assert kind == "markers" and sentence.startswith("1 of 4 markers")
    found = made.frame(sent_as(sets, POSITIONS), 0.0).markers_m
    assert np.isnan(found).all(axis=1).tolist() == [True, False, False, False]
    np.testing.assert_array_equal(found[1:] @ ROTATION, [POSITIONS[name] for name in "BCD"])


def test_a_set_of_another_size_has_no_names_until_it_is_described():
    made, sets = layout(), (MarkerSet("one", ("B",)), MarkerSet("two", ("C", "D")))
    assert np.isnan(made.frame(sent_as(sets, POSITIONS), 0.0).markers_m[:2]).all()
    assert made.outdated
    made.describe(Descriptions(sets, ()))
    assert not made.outdated
    assert not np.isnan(made.frame(sent_as(sets, POSITIONS), 0.0).markers_m[1]).any() and not made.outdated


def test_a_description_of_other_markers_is_refused():
    made = layout()
    expected = made.frame(sent_as(SETS, POSITIONS), 0.0).markers_m
    assert made.describe(Descriptions((MarkerSet("x", ("P", "Q")),), ()))[0][0] == "refused"
    np.testing.assert_array_equal(made.frame(sent_as(SETS, POSITIONS), 0.0).markers_m, expected)


def test_plates_that_are_described_in_another_order_are_found_by_where_they_lie():
    """Their numbers follow the new order; a plate that moved is not read any more."""
    usual = [(1, np.ones((6, 4))), (2, 2.0 * np.ones((6, 4)))]
    swapped = [(1, 2.0 * np.ones((6, 4))), (2, np.ones((6, 4)))]
    here, there = plate(1), plate(2, CORNERS + np.array([0.7, 0.0, 0.0]))
    made = layout([here, there], frames(plates=usual))
    expected = made.frame(frames(plates=usual)[0], 0.0).plates.wrench
    assert made.describe(Descriptions(SETS, (replace(there, number=1), replace(here, number=2)))) == []
    np.testing.assert_array_equal(made.frame(frames(plates=swapped)[0], 0.0).plates.wrench, expected)
    moved = replace(there, corners_m=there.corners_m + np.array([0.1, 0.0, 0.0]))
    ((kind, sentence),) = made.describe(Descriptions(SETS, (here, moved)))
    assert kind == "plates refused" and "'s2' lies 100 mm from where it was" in sentence
    found = made.frame(frames(plates=usual)[0], 0.0).plates.wrench
    np.testing.assert_array_equal(found[:, 0], expected[:, 0])
    assert np.isnan(found[:, 1]).all()
