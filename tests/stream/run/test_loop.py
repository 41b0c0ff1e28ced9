"""The parts of a run put together by hand: every frame is answered once, logged and shown, in order."""

import threading
from dataclasses import replace

import numpy as np

from mbkf.stream.receiving.receiver import Receiver
from mbkf.stream.run.events import EventLog
from mbkf.stream.run.failure import Failure
from mbkf.stream.run.loop import FilterLoop
from mbkf.stream.run.output import RunOutput
from mbkf.stream.run.setup import prepare
from mbkf.stream.run.statistics import RunStatistics
from mbkf.stream.run.unexplained import LoadWatch
from mbkf.stream.run.verdict import VerdictWatch
from tests.captures import made_capture
from tests.stream.scripted import SETTINGS, Collected, ScriptedSource, frames_of


class Failing(Collected):
    def take(self, frame):
        super().take(frame)
        raise RuntimeError("out of paper")


def test_every_frame_is_answered_once(subject):
    stream, frames = frames_of(made_capture(40))
    events, statistics, rows = EventLog(), RunStatistics(), []
    setup = prepare(stream, subject, SETTINGS, patient=True, note=events.note)
    assert setup.labels is None
    assert setup.plate_corners_m.shape == (len(stream.plates), 4, 3)
    assert len(setup.columns) == len(setup.names)
    source = ScriptedSource(stream, frames[:20] + frames[22:])
    receiver = Receiver(source, stream, setup.columns, lambda _: None, events.note)
    kept, failing = Collected([]), Failing([])
    loads = LoadWatch(setup.live, stream.rate_hz, events.note)
    output = RunOutput(
        setup,
        [kept, failing],
        rows.append,
        statistics,
        events.note,
        loads,
        VerdictWatch(setup, subject, loads, events.note),
    )
    loop = FilterLoop(setup, receiver, output, statistics, events.note, Failure())
    receiver.start()
    assert loop.run(threading.Event(), None) == "the source ended"
    receiver.stop()
    output.close()
    assert [int(row["number"][0]) for row in rows] == list(range(40))
    assert [frame.number for frame in kept.frames] == list(range(40))
    assert (len(failing.frames), kept.closed, failing.closed) == (1, True, True)
    assert (statistics.processed, statistics.starts) == (38, 1)
    assert {event["kind"] for event in events.plain()} == {"lost", "plates lost", "viewer"}


def test_latency_counts_from_the_arrival_of_the_last_frame_that_an_answer_knows(subject, monkeypatch):
    """Frames 10 ms apart with a lag of 60 ms; listeners are told all of it, live.json what comes besides."""
    stream, frames = frames_of(made_capture(50))
    events, statistics, rows, counted = EventLog(), RunStatistics(), [], []
    monkeypatch.setattr(statistics, "answered", lambda latency_s, at_start: counted.append(latency_s))
    settings = replace(SETTINGS, filter="kinematic", lag_s=0.06)
    setup = prepare(stream, subject, settings, patient=True, note=events.note)
    receiver = Receiver(ScriptedSource(stream, frames), stream, setup.columns, lambda _: None, events.note)
    kept = Collected([])
    loads = LoadWatch(setup.live, stream.rate_hz, events.note)
    output = RunOutput(
        setup,
        [kept],
        rows.append,
        statistics,
        events.note,
        loads,
        VerdictWatch(setup, subject, loads, events.note),
    )
    receiver.start()
    assert FilterLoop(setup, receiver, output, statistics, events.note, Failure()).run(
        threading.Event(), None
    )
    receiver.stop()
    output.close()
    assert [frame.number for frame in kept.frames] == list(range(50))
    whole = np.array([float(row["latency_s"][0]) for row in rows])
    np.testing.assert_array_equal([frame.latency_s for frame in kept.frames], whole)
    # The frames between are those that arrived meanwhile; the last ones are answered at the end, with what there is.
    lag = np.minimum(0.06, 0.01 * (49 - np.arange(50)))
    np.testing.assert_allclose(whole - counted, lag, atol=1e-9)
