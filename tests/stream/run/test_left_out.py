"""Frames that a slow run leaves out: their plates count, so that the run is the reconstruction of its log."""

import numpy as np

from mbkf.stream.receiving.receiver import Receiver
from mbkf.stream.run import session as session_module
from tests.captures import made_capture
from tests.stream.scripted import ScriptedSource, assert_same, follow, frames_of, kinds, offline, with_hidden

BEGIN, BURST, AFTER, LEFT_OUT = 30, 60, 30, 50
"""Frames one by one, at once, and one by one again; and those of the burst that the buffer leaves out."""


class Impatient(ScriptedSource):
    patient = False


class Stepped(Receiver):
    """Frames arrive when the filter takes one: one by one, but for a burst, as if the filter had been slow."""

    def start(self):
        self._numbers = iter([1] * BEGIN + [BURST] + [1] * (AFTER + 1))

    def take(self, timeout_s):
        for _ in range(next(self._numbers) if self._buffer.empty else 0):
            if not self._source.script:
                self._buffer.close()
                break
            self._put(self._source.read(0.0))
        return super().take(0.0)

    def stop(self):
        self._buffer.close()


def test_a_run_that_leaves_frames_out_is_the_reconstruction_of_its_log(subject, tmp_path, monkeypatch):
    monkeypatch.setattr(session_module, "Receiver", Stepped)
    monkeypatch.setattr("tests.stream.scripted.ScriptedSource", Impatient)
    capture = made_capture(BEGIN + BURST + AFTER)
    outcome = follow(tmp_path, *frames_of(capture), subject)
    assert outcome.report["frames_overwritten"] == LEFT_OUT and "overwritten" in kinds(outcome)
    assert_same(tmp_path, offline(with_hidden(capture, range(BEGIN, BEGIN + LEFT_OUT)), subject))


def test_plates_of_as_many_frames_as_are_bridged_are_kept():
    stream, frames = frames_of(made_capture(180))
    receiver = Receiver(Impatient(stream, []), stream, np.arange(5), lambda _: None, lambda *_: None)
    receiver.allow_pause()
    for frame in frames:
        receiver._put(frame)
    (first, *_) = receiver._buffer.left()
    assert first.number == 175 and [number for number, _ in first.left_out] == list(range(75, 175))
    plates = [receiver._alignment._plates.mean(number) for number, _ in first.left_out]
    np.testing.assert_array_equal([known for _, known in first.left_out], plates)
