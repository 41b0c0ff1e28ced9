"""Samples of the plates beside frames: waited for, numbered on the frames' clock, and found again by where they lie."""

import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.io.records import PlateReadings
from mbkf.stream.lsl import plate_stream
from mbkf.stream.lsl.format import PlateLayout
from mbkf.stream.lsl.plate_stream import GIVEN_UP, FoundPlates, PlateStream, from_first_frame
from mbkf.stream.lsl.stamp_numbering import StampNumbering
from mbkf.stream.source import UNCOUNTED, StreamDescription
from tests.captures import made_capture

CAPTURE = made_capture(30)
LOST = type("LostError", (Exception,), {})


class Scripted:
    """Plates whose samples are there up to an index, and after a wait up to a later one; notes the waits."""

    def __init__(self):
        self.there = self.soon = self._given = 0
        self.waits = []
        self.late_s = 0.0

    def pull_chunk(self, timeout, max_samples, min_samples):
        self.waits.append(timeout)
        until = self.there
        if until <= self._given and timeout > 0.0:
            time.sleep(timeout if self.soon <= self._given else 0.0)
            until = self.soon
        index = np.arange(self._given, max(until, self._given))[:max_samples]
        self._given += len(index)
        return np.column_stack([np.zeros((len(index), 6)), index]), index / 1000.0 + self.late_s


def scripted(frames=None, counter=6):
    """A plate stream of a library that only has this one, and its script."""
    plates = Scripted()
    library = SimpleNamespace(
        proc_clocksync=1,
        util=SimpleNamespace(LostError=LOST, TimeoutError=TimeoutError),
        StreamInlet=lambda *_, **__: plates,
    )
    plate = replace(CAPTURE.plates[0], start_time_s=0.0)
    layout = PlateLayout(np.arange(6)[None], counter, np.eye(3))
    found = FoundPlates(SimpleNamespace(name=lambda: "plates"), (plate,), layout)
    stream = StreamDescription("x", ("A",), 100.0, 0.0, (plate,))
    return PlateStream(library, found, stream, frames, lambda *_: None), plates


def test_a_source_that_counts_anew_goes_on_with_its_plates():
    """What was read until then has higher numbers than what follows."""
    stream, plates = scripted()
    stream._newest = 5000
    for number in range(3):
        plates.there = 10 * number + 6
        assert stream.samples(number, time.perf_counter()).index[-1] == 10 * number + 5


def test_late_plates_are_waited_for_given_up_and_waited_for_again(monkeypatch):
    """Four frames in vain are enough; once samples are nearly in time again, they are waited for."""
    monkeypatch.setattr(plate_stream, "LATE_S", 0.02)
    monkeypatch.setattr(plate_stream, "QUIET_S", 60.0)
    stream, plates = scripted()

    def newest(number, there, soon):
        plates.there, plates.soon, before = there, soon, len(plates.waits)
        samples = stream.samples(number, time.perf_counter())
        return samples.index.max(initial=-1), any(wait > 0.0 for wait in plates.waits[before:])

    assert newest(0, 0, 6) == (5, True)
    assert newest(1, 6, 16) == (15, True)
    for number in range(2, 2 + GIVEN_UP):
        assert newest(number, 16, 16) == (-1, True)
    assert newest(6, 16, 66) == (-1, False)
    assert newest(7, 66, 76) == (65, False)
    assert newest(8, 76, 86) == (85, True)


def test_plates_are_not_waited_for_where_a_count_has_jumped():
    stream, plates = scripted()
    plates.there = plates.soon = 6
    assert stream.samples(0, time.perf_counter()).index[-1] == 5
    plates.there = plates.soon = 16
    begin = time.perf_counter()
    for number in (1001, UNCOUNTED, -(10**6)):
        stream.samples(number, begin)
    assert max(plates.waits[1:]) == 0.0
    assert stream._newest == 15


@pytest.mark.parametrize("counter", [np.nan, np.inf, -np.inf, 2.0**60, -(2.0**60)])
def test_a_count_that_cannot_be_read_is_stated_as_such(counter):
    stream, _ = scripted()
    placed = stream._placed(np.array([[0, 0, 0, 0, 0, 0, 7.0], [0, 0, 0, 0, 0, 0, counter]]), np.zeros(2))
    assert placed.index.tolist() == [7, UNCOUNTED]


def settled(late_s=0.0):
    """A numbering of frames that begin at stamp 0."""
    frames = StampNumbering(100.0)
    for n in range(20):
        frames.put(n / 100.0 + late_s, n / 100.0)
    return frames


@pytest.mark.parametrize(("late_s", "first"), [(0.0, 0), (0.050, 50)])
def test_samples_without_a_count_have_the_frames_clock(late_s, first):
    """Sample 0 is that of frame 0: plates that are stamped 50 ms later than the frames begin with sample 50."""
    stream, plates = scripted(settled(), counter=None)
    plates.late_s = late_s
    plates.there = plates.soon = 200
    found = [stream.samples(number, time.perf_counter()) for number in range(20)]
    index = np.concatenate([one.index for one in found])
    assert index[0] == first and (np.diff(index) == 1).all() and len(index) == 200


def test_samples_follow_frames_whose_clock_moved():
    """Frames that were lost unseen move the frames' clock by 30 ms; samples of the plates follow, none comes twice."""
    frames = settled()
    stream, plates = scripted(frames, counter=None)
    plates.there = plates.soon = 200
    before = np.concatenate([stream.samples(n, time.perf_counter()).index for n in range(20)])
    for n in range(20, 420):
        frames.put(n / 100.0 - 0.03, n / 100.0 - 0.03)
    assert frames.origin_s == pytest.approx(-0.03)
    plates.there = plates.soon = 400
    after = np.concatenate([stream.samples(n, time.perf_counter()).index for n in range(20, 37)])
    assert before[-1] == 199 and after[-1] == 399 + 30
    assert (np.diff([*before, *after]) >= 1).all()


def test_plates_of_frames_without_counts_begin_with_frame_0():
    plates: tuple[PlateReadings, ...] = from_first_frame((replace(CAPTURE.plates[0], start_time_s=3.0),))
    assert plates[0].start_time_s == 0.0
