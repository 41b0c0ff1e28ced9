"""Frames come out of the alignment in order, filled, cleaned, and with their plates."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.sensors.contact.plates import plate_wrenches
from mbkf.stream.receiving.alignment import BRIDGED_S, FrameAlignment
from mbkf.stream.source import UNCOUNTED, PlateSamples, SourceFrame
from tests.captures import made_capture
from tests.stream.scripted import frames_of


def intake_of(capture, unlabelled=False):
    stream, frames = frames_of(capture, unlabelled)
    notes = []
    columns = None if unlabelled else np.arange(3, 20)[::-1]
    alignment = FrameAlignment(
        stream, columns, lambda kind, what, frame, count: notes.append((kind, frame, count))
    )
    return alignment, frames, notes


def test_markers_are_the_wanted_ones_and_plates_the_frames_means(capture):
    alignment, frames, notes = intake_of(capture)
    ready = [one for frame in frames for one in alignment.accept(frame)[0]]
    expected = plate_wrenches(capture.plates, capture.markers.times_s, 100.0)
    np.testing.assert_array_equal([one.plates for one in ready], expected)
    wanted = capture.markers.positions_m[:, np.arange(3, 20)[::-1]]
    np.testing.assert_array_equal([one.markers_m for one in ready], wanted)
    assert (alignment.frames_in, alignment.lost, notes) == (80, 0, [])


@pytest.mark.parametrize("counted_from", [0, 5_000_000])
def test_plates_that_began_before_the_frames_are_read_at_the_frames_own_times(capture, counted_from):
    """Also where the plates' count is their device's own, and the first frames' samples tell where it stands."""
    late = replace(capture, markers=replace(capture.markers, start_time_s=0.05))
    alignment, frames, _ = intake_of(late)
    shifted = [
        replace(one, plates=replace(one.plates, index=one.plates.index + counted_from)) for one in frames
    ]
    found = [one.plates for frame in shifted for one in alignment.accept(frame)[0]]
    times = late.markers.times_s
    within = times < capture.plates[0].times_s[-1] - 0.01
    expected = plate_wrenches(capture.plates, times, 100.0)
    np.testing.assert_allclose(np.array(found)[within], expected[within], rtol=1e-12, atol=1e-9)


def test_readings_that_the_person_cannot_make_are_refused_and_told(capture):
    stream, frames = frames_of(capture)
    wrench = np.array(frames[5].plates.wrench)
    wrench[3, 0, 2], wrench[4, 1] = 1e9, np.nan
    frames[5] = replace(frames[5], plates=replace(frames[5].plates, wrench=wrench))
    notes = []
    alignment = FrameAlignment(stream, np.arange(36), lambda *note: notes.append(note), 75.0)
    accepted = [alignment.accept(frame) for frame in frames]
    expected = plate_wrenches(capture.plates, capture.markers.times_s, 100.0)
    found = [one.plates for ready, _ in accepted for one in ready]
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-9)
    logged = accepted[5][1].wrench
    assert np.isnan(logged[3, 0]).all()
    assert np.isnan(logged[4, 1]).all()
    assert np.isnan(logged).any(axis=2).sum() == 2
    ((kind, _, frame, count),) = notes
    assert (kind, frame, count) == ("plates refused", 5, 2)


def test_points_without_names_are_handed_on_without_holes(capture):
    alignment, frames, _ = intake_of(capture, unlabelled=True)
    points = np.array(frames[0].unlabelled_m)
    points[4] = np.nan
    ((ready,), _) = alignment.accept(replace(frames[0], unlabelled_m=points))
    assert ready.markers_m is None
    np.testing.assert_array_equal(ready.unlabelled_m, np.delete(points, 4, axis=0))


def test_short_gaps_are_filled_and_long_ones_are_not(capture):
    alignment, frames, notes = intake_of(capture)
    alignment.accept(frames[0])
    ready, _ = alignment.accept(frames[5])
    assert [one.number for one in ready] == [1, 2, 3, 4, 5]
    assert [one.lost for one in ready] == [True] * 4 + [False]
    assert all(np.isnan(one.markers_m).all() for one in ready[:4])
    far = int(BRIDGED_S * 100.0) + 10
    jumped = replace(frames[6], number=far, arrival_s=frames[0].arrival_s + far / 100.0)
    ready, _ = alignment.accept(jumped)
    assert [one.number for one in ready] == [far]
    assert alignment.lost == 4 + far - 6
    assert [kind for kind, _, _ in notes].count("lost") == 2


@pytest.mark.parametrize("restarted", [True, False])
def test_plates_follow_a_count_that_was_set_back(capture, restarted):
    """Whether their own count was set back with the frames' or not."""
    alignment, frames, notes = intake_of(capture)
    expected = plate_wrenches(capture.plates, capture.markers.times_s, 100.0)
    shift = 700 if restarted else 0
    again = [
        replace(f, number=f.number - 70, plates=PlateSamples(f.plates.index - shift, f.plates.wrench))
        for f in frames[60:]
    ]
    ready = [one for frame in frames[:60] + again for one in alignment.accept(frame)[0]]
    assert [one.number for one in ready] == list(range(80))
    found = np.array([one.plates for one in ready])
    np.testing.assert_array_equal(np.isnan(found).any(axis=(1, 2))[61:], False)
    np.testing.assert_allclose(found[61:], expected[61:])
    assert [kind for kind, _, _ in notes] == ["clock"]


COUNTS = st.one_of(st.integers(0, 120), st.integers(-(2**63), 2**63 - 1), st.just(UNCOUNTED))
VALUES = st.sampled_from([0.0, 1.0, 500.0, np.nan, np.inf, -np.inf, 1e30])


@given(
    st.lists(
        st.tuples(COUNTS, st.floats(0.0, 3.0), st.lists(COUNTS, max_size=12), VALUES, VALUES),
        min_size=1,
        max_size=25,
    )
)
def test_nothing_that_a_source_says_ends_the_reading(script):
    """Whatever counts, readings and pauses: numbers rise, shapes hold, and each frame is placed or counted as late."""
    stream, frames = frames_of(made_capture(2))
    alignment = FrameAlignment(stream, np.arange(5), lambda *_: None, 75.0, live=True)
    arrival_s, ready, taken = 0.0, [], []
    for number, passed_s, index, coordinate, load in script:
        arrival_s += passed_s
        samples = PlateSamples(np.array(index, dtype=np.int64), np.full((len(index), 2, 6), load))
        markers = np.full_like(frames[0].markers_m, coordinate)
        more, plates = alignment.accept(SourceFrame(number, arrival_s, markers, np.zeros((0, 3)), samples))
        ready += more
        taken += plates.index.tolist()
        assert plates.wrench.shape == (len(plates.index), 2, 6)
    assert all(b.number > a.number for a, b in pairwise(ready))
    assert all(b > a for a, b in pairwise(taken))
    assert sum(not one.lost for one in ready) + alignment.late == len(script)
    assert all(one.plates.shape == (2, 6) for one in ready)
