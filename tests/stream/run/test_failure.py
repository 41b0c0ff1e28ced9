"""A run whose threads die ends with what was found until then, and says what failed."""

import json
import threading
from dataclasses import replace

import numpy as np
import pytest

from mbkf.cli.following import report_outcome
from mbkf.io.results_folder import read_reconstruction
from mbkf.stream.receiving.alignment import FrameAlignment
from mbkf.stream.results.sending import SendingThread
from mbkf.stream.run.failure import Failure
from mbkf.stream.run.log_writer import LogWriter
from mbkf.stream.run.session import LiveSession
from mbkf.stream.source import UNCOUNTED, PlateSamples
from tests.stream.scripted import SETTINGS, Collected, ScriptedSource, follow, frames_of, kinds
from tests.waiting import PATIENCE_S, until

pytestmark = pytest.mark.slow


def accounted(report):
    """Whether each frame received was written or is counted under one reason why it was not."""
    gone = ("frames_not_written", "frames_unanswered", "frames_late", "frames_overwritten")
    return report["frames_in"] == report["frames_written"] + sum(report[key] for key in gone)


def test_the_first_error_is_kept():
    failure = Failure()
    assert failure.cause is None
    failure.of("reading", ValueError("a"))
    failure.of("writing", ValueError("b"))
    assert failure.cause == "reading failed: an unforeseen ValueError: a"


def test_a_reading_thread_that_dies_ends_the_run_with_what_was_found(tmp_path, capture, subject, monkeypatch):
    stream, frames = frames_of(capture)
    accept = FrameAlignment.accept

    def dying(self, frame):
        if frame.number == 50:
            raise ZeroDivisionError("in the reader")
        return accept(self, frame)

    monkeypatch.setattr(FrameAlignment, "accept", dying)
    outcome = follow(tmp_path, stream, frames, subject)
    assert outcome.failure == "reading the stream failed: an unforeseen ZeroDivisionError: in the reader"
    report = json.loads((tmp_path / "live.json").read_text())
    assert (report["state"], report["ended_by"]) == ("failed", outcome.failure)
    assert "failed" in kinds(outcome)
    assert accounted(report)
    assert report["frames_written"] == read_reconstruction(tmp_path).frames == 50


def test_a_writing_thread_that_dies_ends_the_run_and_its_rows_are_written_at_the_end(
    tmp_path, capture, subject, monkeypatch
):
    stream, frames = frames_of(capture)
    flush, calls = LogWriter._flush, []

    def dying(self, log):
        calls.append(threading.current_thread().name)
        if calls[-1] == "mbkf-log":
            raise MemoryError("in the writer")
        return flush(self, log)

    monkeypatch.setattr(LogWriter, "_flush", dying)
    outcome = follow(tmp_path, stream, frames, subject)
    assert "writing the log failed: an unforeseen MemoryError" in outcome.failure
    report = outcome.report
    assert accounted(report)
    assert report["frames_not_written"] == 0
    assert report["frames_written"] == read_reconstruction(tmp_path).frames > 0


def test_a_filter_that_fails_is_told(tmp_path, capture, subject, monkeypatch):
    stream, frames = frames_of(capture)

    class Failing(Collected):
        """A listener fails in its own way; only what the filter raises ends a run."""

    session = LiveSession(ScriptedSource(stream, frames), subject, SETTINGS, tmp_path, "script")
    session.connect(threading.Event(), 1.0)
    push, count = session.setup.filter.push, []

    def failing(number, frame):
        count.append(number)
        if len(count) == 60:
            raise KeyError("no such thing")
        return push(number, frame)

    monkeypatch.setattr(session.setup.filter, "push", failing)
    outcome = session.run(threading.Event(), [Failing([])])
    assert outcome.failure.startswith("the filter failed: an unforeseen KeyError")
    assert outcome.problem is None
    assert accounted(outcome.report)
    assert outcome.report["frames_written"] == read_reconstruction(tmp_path).frames == 59
    assert report_outcome(outcome, tmp_path) == 1


def test_a_source_that_fails_when_it_is_closed_leaves_the_results(tmp_path, capture, subject):
    stream, frames = frames_of(capture)

    class Stuck(ScriptedSource):
        def close(self):
            raise OSError("stuck")

    class Torn(Collected):
        def close(self):
            raise RuntimeError("torn")

    session = LiveSession(Stuck(stream, frames), subject, SETTINGS, tmp_path, "script")
    session.connect(threading.Event(), 1.0)
    outcome = session.run(threading.Event(), [Torn([])])
    assert outcome.problem is None
    assert kinds(outcome) == {"source", "viewer"}


def test_frames_that_wait_when_a_run_is_stopped_are_lost_and_counted(tmp_path, capture, subject):
    """The filter is behind, and Ctrl-C comes: those of a camera are gone, those of a file are still in it."""
    stream, frames = frames_of(capture)
    for patient in (False, True):

        class Source(ScriptedSource):
            pass

        Source.patient = patient
        stop = threading.Event()

        class Stopping(Collected):
            def take(self, frame, stop=stop):
                super().take(frame)
                if len(self.frames) == 30:
                    if not Source.patient:  # all frames have come
                        until(lambda: "mbkf-reader" not in {one.name for one in threading.enumerate()})
                    stop.set()

        session = LiveSession(Source(stream, frames), subject, SETTINGS, tmp_path, "script")
        session.connect(stop, 1.0)
        report = session.run(stop, [Stopping([])]).report
        assert accounted(report)
        assert report["frames_written"] == read_reconstruction(tmp_path).frames
        if patient:
            assert (report["frames_unanswered"], report["frames_lost"]) == (0, 0)
        else:
            assert report["frames_in"] == 80
            assert report["frames_lost"] == 80 - report["frames_written"] > 0


@pytest.mark.parametrize("strange", [2**60, -(2**60), UNCOUNTED, -5000, 10**6])
@pytest.mark.parametrize("lasting", [False, True])
def test_absurd_counts_of_frames_and_samples_are_one_event(tmp_path, capture, subject, strange, lasting):
    stream, frames = frames_of(capture)
    frames = [
        replace(
            frame,
            number=frame.number + strange if abs(strange) < 2**50 else strange,
            plates=PlateSamples(np.full_like(frame.plates.index, strange), frame.plates.wrench),
        )
        if frame.number == 40 or (lasting and frame.number >= 40)
        else frame
        for frame in frames
    ]
    outcome = follow(tmp_path, stream, frames, subject)
    report = outcome.report
    assert (outcome.failure, outcome.problem) == (None, None)
    assert (report["frames_in"], report["frames_written"], report["frames_lost"]) == (80, 80, 0)
    assert [event["kind"] for event in report["events"]].count("clock") == 1
    assert read_reconstruction(tmp_path).tracked.all()


def test_frames_at_another_rate_are_told_once(tmp_path, capture, subject):
    class Live(ScriptedSource):
        patient = False

    stream, frames = frames_of(capture)
    slow = [replace(frame, arrival_s=frames[0].arrival_s + frame.number / 30.0) for frame in frames]
    session = LiveSession(Live(stream, slow), subject, SETTINGS, tmp_path, "script")
    session.connect(threading.Event(), 1.0)
    outcome = session.run(threading.Event())
    (event,) = [event for event in outcome.report["events"] if event["kind"] == "rate"]
    assert event["count"] == 1
    assert "30 Hz where the stream states 100 Hz" in event["what"]
    assert any("30 Hz" in warning for warning in read_reconstruction(tmp_path).warnings)


def test_a_sending_thread_that_dies_raises_at_the_next_frame():
    done = threading.Event()

    def send(frame):
        done.set()
        raise OSError("cable")

    sending = SendingThread(send, "x")
    sending.take(None)
    sending._buffer.put("frame")
    assert done.wait(PATIENCE_S)
    sending._thread.join(PATIENCE_S)
    with pytest.raises(OSError, match="cable"):
        sending.take("frame")
    sending.close()
