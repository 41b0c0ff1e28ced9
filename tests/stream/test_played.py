"""A played capture holds every frame and every sample once, complete when it is due, and is sent in time."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import InvalidInput
from mbkf.io.records import MarkerTrajectories
from mbkf.stream.file_source import FileSource
from mbkf.stream.played import played
from mbkf.stream.receiving.plate_buffer import PlateBuffer
from mbkf.stream.replay import ReplaySettings, replay
from tests.captures import made_capture

CAPTURE = made_capture(30)


@given(first=st.integers(0, 60), rate_hz=st.sampled_from([100.0, 240.0, 1000.0]))
def test_each_sample_is_sent_once_and_before_its_frame_is_due(first, rate_hz):
    plates = tuple(
        replace(plate, rate_hz=rate_hz, start_time_s=plate.start_time_s - first / rate_hz)
        for plate in CAPTURE.plates
    )
    made = played(replace(CAPTURE, plates=plates))
    buffer, sent = PlateBuffer(made.stream), []
    for frame in made.frames():
        sent.extend(frame.plates.index)
        buffer.put(frame.plates)
        position = first + (frame.number + 0.5) * rate_hz / 100.0
        assert buffer.newest >= min(position, len(made.wrench) - 1) - 1e-6
    assert sent == list(range(sent[0], sent[-1] + 1))
    assert sent[0] <= max(0.0, first - 0.5 * rate_hz / 100.0)


def test_points_without_names_are_the_same_points_shuffled():
    made = played(CAPTURE, unlabelled=True)
    assert made.stream.marker_names == ()
    starred = tuple(f"*{k}" for k in range(len(CAPTURE.markers.names)))
    raw = replace(CAPTURE, markers=replace(CAPTURE.markers, names=starred))
    np.testing.assert_array_equal(played(raw).markers_m, made.markers_m)
    assert played(raw).stream.marker_names == ()
    for frame, original in zip(made.frames(), CAPTURE.markers.positions_m, strict=True):
        assert not np.array_equal(frame.markers_m, original)
        np.testing.assert_array_equal(sorted(frame.markers_m.tolist()), sorted(original.tolist()))


def test_what_cannot_be_one_stream_is_refused():
    slower = replace(CAPTURE.plates[1], rate_hz=500.0)
    with pytest.raises(InvalidInput, match="different rates"):
        played(replace(CAPTURE, plates=(CAPTURE.plates[0], slower)))
    with pytest.raises(InvalidInput, match="no frames"):
        played(replace(CAPTURE, markers=MarkerTrajectories(("A",), np.zeros((0, 1, 3)), 100.0)))


class Recorder:
    def __init__(self, listeners=True):
        self.sent, self.listeners = [], listeners

    def listening(self):
        return self.listeners

    def send(self, frame, age_s):
        self.sent.append((time.perf_counter(), frame.number, age_s))

    def close(self):
        pass


def test_frames_are_sent_at_their_rate_and_never_early():
    recorder = Recorder()
    made = played(CAPTURE)
    before = time.perf_counter()
    done = replay(made, recorder, ReplaySettings(speed=2.0), threading.Event())
    assert (done.sent, done.dropped) == (30, 0)
    times, numbers, ages = map(np.array, zip(*recorder.sent, strict=True))
    assert numbers.tolist() == list(range(30))
    assert (times - before >= numbers / 200.0).all()
    assert set(ages) == {made.due_after_s / 2.0}


def test_loss_and_jitter_are_as_asked():
    recorder = Recorder()
    settings = ReplaySettings(speed=4.0, jitter_s=0.002, loss=0.3, seed=1)
    done = replay(played(CAPTURE), recorder, settings, threading.Event())
    assert done.sent + done.dropped == 30
    assert 0 < done.dropped < 20
    ages = [age for _, _, age in recorder.sent]
    assert 0.0 < max(ages) - min(ages) <= 0.002
    assert replay(played(CAPTURE), recorder, ReplaySettings(speed=9.0, loss=1.0), threading.Event()).sent == 0


def test_it_plays_all_the_same_when_nobody_listens_and_stops_when_told():
    recorder = Recorder(listeners=False)
    assert (
        replay(played(CAPTURE), recorder, ReplaySettings(speed=9.0, wait_s=0.0), threading.Event()).sent == 30
    )
    stopped = threading.Event()
    stopped.set()
    assert replay(played(CAPTURE), recorder, ReplaySettings(), stopped).sent == 0


@pytest.mark.parametrize("speed", [0.0, 3.0])
def test_a_file_gives_every_frame_and_ends(speed):
    made = played(CAPTURE)
    source = FileSource(made, speed)
    assert source.connect(1.0) is made.stream
    begin, numbers = time.perf_counter(), []
    with pytest.raises(EOFError):
        while True:
            frame = source.read(0.004)
            if frame is not None:
                numbers.append(frame.number)
    assert numbers == list(range(30))
    if speed:
        assert time.perf_counter() - begin >= 29 / 300.0
    assert source.news() == []
    source.close()
