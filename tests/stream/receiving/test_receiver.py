"""The receiving side of a run: frames come out in order, and every lost one is counted by its cause."""

import threading

import numpy as np

from mbkf.stream.receiving.receiver import Receiver
from tests.captures import made_capture
from tests.stream.scripted import ScriptedSource, frames_of
from tests.waiting import PATIENCE_S


def received(script, stream):
    notes, samples = [], []
    source = ScriptedSource(stream, script)
    receiver = Receiver(source, stream, np.arange(5), samples.append, lambda *note: notes.append(note))
    receiver.start()
    numbers = []
    while not receiver.ended:
        frame = receiver.take(1.0)
        if frame is not None:
            numbers.append(frame.number)
    receiver.stop()
    return receiver, numbers, notes, samples


def test_all_frames_come_in_order():
    stream, frames = frames_of(made_capture(30))
    receiver, numbers, notes, samples = received(frames, stream)
    assert numbers == list(range(30))
    assert receiver.counts() == (30, 0, 0, 0, 0)
    assert (notes, receiver.empty, len(samples)) == ([], True, 30)


def test_frames_lost_on_the_way_are_counted_and_bridged():
    stream, frames = frames_of(made_capture(30))
    receiver, numbers, notes, _ = received(frames[:10] + frames[13:], stream)
    assert numbers == list(range(30))
    assert receiver.lost == receiver.counts().lost_on_the_way == 3
    assert [kind for kind, *_ in notes] == ["lost", "plates lost"]


def test_frames_that_are_not_taken_in_time_are_overwritten():
    class Impatient(ScriptedSource):
        patient = False

    stream, frames = frames_of(made_capture(30))
    receiver = Receiver(Impatient(stream, frames), stream, np.arange(5), lambda _: None, lambda *_: None)
    receiver.allow_pause()
    receiver.start()
    for thread in threading.enumerate():
        if thread.name == "mbkf-reader":
            thread.join(PATIENCE_S)
    counts = receiver.counts()
    assert counts.overwritten > 0
    assert (counts.received, counts.overwritten + counts.queued) == (30, 30)
    beyond = receiver.counts(until=27)
    assert (beyond.received, counts.queued - beyond.queued) == (28, 2)
    receiver.stop()


def test_the_receiver_goes_on_after_a_failure_and_ends_with_the_source(monkeypatch):
    monkeypatch.setattr("mbkf.stream.receiving.reader.PAUSE_S", 0.001)
    stream, frames = frames_of(made_capture(30))
    script = [*frames[:10], RuntimeError("broken"), None, *frames[10:]]
    receiver, numbers, notes, samples = received(script, stream)
    assert numbers == list(range(30))
    assert notes == [("source", "the source failed (RuntimeError: broken)", None, 1)]
    assert sum(len(one.index) for one in samples) >= 295
    assert receiver.counts().overwritten == 0


def test_an_error_of_its_own_ends_the_thread_and_is_reported():
    stream, frames = frames_of(made_capture(30))
    errors = []

    def fail(_samples):
        raise ArithmeticError("no samples today")

    source = ScriptedSource(stream, frames)
    receiver = Receiver(source, stream, np.arange(5), fail, lambda *_: None, failed=errors.append)
    receiver.start()
    while not receiver.ended:
        receiver.take(1.0)
    assert [str(error) for error in errors] == ["no samples today"]
