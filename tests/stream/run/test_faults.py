"""Whatever happens to the stream, a live run goes on, says so, and keeps what it found."""

import errno
import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.io.c3d_write import write_c3d
from mbkf.io.frame_log import read_frame_log
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.subject import write_subject
from mbkf.stream.run import log_writer
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.stream.run.log_writer import LogWriter
from mbkf.stream.source import FARTHEST_M, PlateSamples, SourceFrame
from mbkf.trial.live.log import FRAMES_FILE, LiveLog, LiveStream, blank
from mbkf.trial.live.recording import open_recording
from tests.dynamics import plate
from tests.stream.scripted import (
    Collected,
    assert_same,
    follow,
    frames_of,
    kinds,
    offline,
    with_hidden,
    without_plates,
)
from tests.waiting import until

pytestmark = pytest.mark.slow


def later(frames, seconds):
    return [replace(frame, arrival_s=frame.arrival_s + seconds) for frame in frames]


def test_a_third_of_the_frames_is_dropped(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    kept = np.random.default_rng(0).uniform(size=len(frames)) >= 0.3
    kept[[0, -1]] = True
    samples, script = PlateSamples.none(2), []
    for frame, here in zip(frames, kept, strict=True):
        index, wrench = (
            np.concatenate([getattr(samples, name), getattr(frame.plates, name)])
            for name in ("index", "wrench")
        )
        samples = PlateSamples(index, wrench)
        if here:
            script.append(replace(frame, plates=samples))
            samples = PlateSamples.none(2)
    outcome = follow(tmp_path, stream, script, subject)
    dropped = np.flatnonzero(~kept)
    assert outcome.report["frames_lost"] == len(dropped) > 15
    assert outcome.report["frames_processed"] == len(script)
    assert kinds(outcome) == {"lost"}
    assert_same(tmp_path, offline(with_hidden(capture, dropped), subject))


def test_plates_lost_with_their_frames_are_not_read(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    outcome = follow(tmp_path, stream, frames[:40] + frames[43:], subject)
    assert kinds(outcome) == {"lost", "plates lost"}
    found = read_reconstruction(tmp_path)
    assert np.flatnonzero(~found.tracked).tolist() == [40, 41, 42]
    assert np.isfinite(found.tau).all()
    assert not found.valid[40:43].any()


def test_frames_out_of_order_are_left_out_and_told(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    frames[50], frames[51] = frames[51], frames[50]
    frames.insert(60, frames[59])
    outcome = follow(tmp_path, stream, frames, subject)
    assert outcome.report["frames_in"] == 81
    assert outcome.report["frames_lost"] == 1
    assert "late" in kinds(outcome)
    found, expected = read_reconstruction(tmp_path), offline(with_hidden(capture, [50]), subject)
    np.testing.assert_allclose(found.q[:50], expected.q[:50], atol=1e-9)
    assert np.isnan(found.measured_m[50]).all()
    assert np.flatnonzero(~found.tracked).tolist() == [50]


def test_time_that_goes_backwards_changes_nothing(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    again = [
        replace(f, number=f.number - 70, plates=replace(f.plates, index=f.plates.index - 700))
        for f in frames[50:]
    ]
    outcome = follow(tmp_path, stream, frames[:50] + again, subject)
    (event,) = outcome.report["events"]
    assert event["kind"] == "clock"
    assert "back" in event["what"]
    assert outcome.report["frames_lost"] == 0
    assert outcome.report["frames_processed"] == 80
    assert_same(tmp_path, offline(capture, subject))


def test_a_count_that_leaps_ahead_is_not_believed(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    leaping = [replace(f, number=f.number + 2**31, plates=PlateSamples.none(2)) for f in frames[50:]]
    outcome = follow(tmp_path, stream, frames[:50] + leaping, subject)
    assert "clock" in kinds(outcome)
    assert outcome.report["frames_lost"] == 0
    assert read_reconstruction(tmp_path).frames == 80


@pytest.mark.parametrize("nonsense", [[np.nan], [1e6, -np.inf]])
def test_points_that_cannot_be_are_left_out(tmp_path, capture, subject, nonsense):
    stream, frames = frames_of(capture)
    hidden = np.array(capture.markers.positions_m)
    for number in range(30, 60):
        markers = np.array(frames[number].markers_m)
        markers[number % 5 :: 5, number % 3] = nonsense[number % len(nonsense)]
        hidden[number, number % 5 :: 5] = np.nan
        frames[number] = replace(frames[number], markers_m=markers)
    outcome = follow(tmp_path, stream, frames, subject)
    assert kinds(outcome) == (set() if np.isnan(nonsense).all() else {"nonsense"})
    shown = replace(capture, markers=replace(capture.markers, positions_m=hidden))
    assert_same(tmp_path, offline(shown, subject))


def test_plate_readings_that_cannot_be_are_refused(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    for number in range(30, 60, 7):
        wrench = np.array(frames[number].plates.wrench)
        wrench[number % 5, number % 2, number % 3] = (1e9, -1e9, np.nan)[number % 3]
        frames[number] = replace(frames[number], plates=replace(frames[number].plates, wrench=wrench))
    outcome = follow(tmp_path, stream, frames, subject)
    assert kinds(outcome) == {"plates refused"}
    assert_same(tmp_path, offline(capture, subject))
    assert any("refused" in warning for warning in read_reconstruction(tmp_path).warnings)


def test_points_at_the_edge_of_what_can_be_do_not_end_it(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    for number in range(40, 50):
        frames[number] = replace(frames[number], markers_m=np.full_like(frames[number].markers_m, FARTHEST_M))
    outcome = follow(tmp_path, stream, frames, subject)
    assert outcome.problem is None
    assert outcome.report["frames_processed"] == 80
    assert read_reconstruction(tmp_path).tracked[-5:].all()


def test_plates_that_never_speak(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    outcome = follow(tmp_path, stream, [without_plates(frame) for frame in frames], subject)
    assert outcome.problem is None
    found = read_reconstruction(tmp_path)
    assert found.tracked.all()
    assert not found.measured.any()
    assert (found.foot_contact == -1).any()


def test_plates_that_fall_silent_are_told_of(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    slow = [replace(f, arrival_s=frames[0].arrival_s + 0.04 * f.number) for f in frames]
    script = slow[:30] + [without_plates(frame) for frame in slow[30:]]
    outcome = follow(tmp_path, stream, script, subject)
    assert "plates" in kinds(outcome)
    assert np.isfinite(read_reconstruction(tmp_path).tau).all()


def test_a_source_that_fails_and_returns_is_taken_up_again(tmp_path, capture, subject, monkeypatch):
    monkeypatch.setattr("mbkf.stream.receiving.reader.PAUSE_S", 0.01)
    stream, frames = frames_of(capture)
    gone = OSError(errno.ENETUNREACH, "network is unreachable")
    outcome = follow(tmp_path, stream, [*frames[:40], gone, gone, *frames[45:]], subject)
    assert {"source", "lost"} <= kinds(outcome)
    assert outcome.report["frames_lost"] == 5
    found = read_reconstruction(tmp_path)
    assert found.frames == 80
    assert found.tracked[-20:].all()


def test_after_a_long_silence_the_filter_starts_anew(tmp_path, capture, subject):
    stream, frames = frames_of(replace(capture, plates=()))
    again = [replace(f, number=f.number + 200) for f in later(frames, 2.0)]
    seen = Collected([])
    outcome = follow(tmp_path, stream, frames + again, subject, sinks=[seen])
    assert {"lost", "cut", "start"} <= kinds(outcome)
    assert outcome.report["starts"] == 2
    found = read_reconstruction(tmp_path)
    assert found.frames == 280
    assert np.isnan(found.q[80:200]).all()
    np.testing.assert_allclose(found.q[200:], found.q[:80], atol=1e-9)
    assert [frame.number for frame in seen.frames] == [*range(80), *range(200, 280)]


def rows_of(log):
    return read_frame_log(log.folder / FRAMES_FILE)[1]["number"].tolist()


ROWS = np.dtype([("number", "<i8"), ("latency_s", "<f8"), ("footing", "<i8", (2,)), ("q", "<f8", (5,))])


@pytest.fixture
def log(tmp_path):
    return LiveLog(tmp_path / "log", LiveStream("x", 100.0, 0.0, ()), ROWS, {}, [])


def row(log, number):
    made = blank(log.frames.dtype, 1)
    made["number"], made["latency_s"] = number, 0.001
    return made


def test_a_disk_that_was_full_gets_the_rows_later(log, monkeypatch):
    monkeypatch.setattr(log_writer, "AGAIN_S", 0.01)
    monkeypatch.setattr(log_writer, "EVERY_S", 0.01)
    write, refusals, failures = log.frames._write, [3], []

    def full(data):
        if refusals[0]:
            refusals[0] -= 1
            write(data[: len(data) - 3])
            raise OSError(errno.ENOSPC, "no space left on device")
        write(data)

    monkeypatch.setattr(log.frames, "_write", full)
    writer = LogWriter(log, failures.append)
    for number in range(20):
        writer.put_row(row(log, number))
    until(lambda: len(failures) >= 3)
    assert writer.close() == (20, 0)
    assert len(failures) == 3
    assert rows_of(log) == list(range(20))


def test_rows_written_before_the_disk_is_full_stay(log, monkeypatch):
    monkeypatch.setattr(log_writer, "MOST_HELD_BYTES", 4 * log.frames.dtype.itemsize)
    failures = []
    log.frames.append(np.concatenate([row(log, number) for number in range(5)]))

    def full(data):
        raise OSError(errno.ENOSPC, "no space left on device")

    monkeypatch.setattr(log.frames, "_write", full)
    writer = LogWriter(log, failures.append)
    for number in range(5, 12):
        writer.put_row(row(log, number))
    assert writer.close() == (0, 7)
    assert failures
    assert rows_of(log) == list(range(5))


def test_frames_that_are_missing_in_the_recording_are_counted(tmp_path, monkeypatch):
    files = open_recording(tmp_path, LiveStream("x", 100.0, 0.0, ()), tmp_path / "x.c3d")
    log = LiveLog(tmp_path / "log", LiveStream("x", 100.0, 0.0, ()), ROWS, {}, [], files)

    def full(data):
        raise OSError(errno.ENOSPC, "no space left on device")

    monkeypatch.setattr(files.markers, "_write", full)
    writer = LogWriter(log, [].append)
    none = np.zeros((0, 3))
    for number in range(3):
        writer.record(
            number, SourceFrame(number, 0.0, none, none, PlateSamples.none(0)), PlateSamples.none(0)
        )
    assert writer.close() == (0, 0)
    assert writer.unrecorded == 3


def recording_writer(tmp_path, plates=0, died=None):
    """A writer of a run that is recorded; its thread writes nothing before the log is closed."""
    stream = LiveStream("x", 100.0, 0.0, (plate(0.0, 0.0),) * plates)
    files = open_recording(tmp_path, stream, tmp_path / "x.c3d")
    log = LiveLog(tmp_path / "log", stream, ROWS, {}, [], files)
    return LogWriter(log, [].append, died=died), log, files


def bare_frame(number):
    none = np.zeros((0, 3))
    return number, SourceFrame(number, 0.0, none, none, PlateSamples.none(0)), PlateSamples.none(0)


def test_frames_that_wait_for_the_log_s_thread_stay_few_and_in_order(tmp_path, monkeypatch):
    """Beyond the limit a frame costs its caller one frame's rows, not those of all that wait."""
    monkeypatch.setattr(log_writer, "EVERY_S", 60.0)
    monkeypatch.setattr(log_writer, "MOST_LATER", 3)
    writer, _, files = recording_writer(tmp_path)
    waiting = []
    for number in range(10):
        writer.record(*bare_frame(number))
        waiting.append(len(writer._later))
    assert waiting == [1, 2, *[3] * 8]
    assert writer.close() == (0, 0)
    assert read_frame_log(files.markers.path).rows["number"].tolist() == list(range(10))


def test_frames_reach_the_log_after_their_samples_and_after_the_recording(tmp_path, monkeypatch):
    """A frame that is answered while the log is written waits for the next round, as its samples do."""
    monkeypatch.setattr(log_writer, "EVERY_S", 60.0)
    writer, log, files = recording_writer(tmp_path, plates=1)
    append_frames, append_samples, found = log.frames.append, log.plates.append, []

    def answer(number):
        writer.record(*bare_frame(number))
        writer.put_samples(PlateSamples(np.arange(10 * number, 10 * number + 10), np.ones((10, 1, 6))))
        writer.put_row(row(log, number))

    def samples(rows):
        if not found:
            answer(1)
        append_samples(rows)

    def frames(rows):
        append_frames(rows)
        found.append((log.frames.rows, log.plates.rows, files.markers.rows))

    monkeypatch.setattr(log.plates, "append", samples)
    monkeypatch.setattr(log.frames, "append", frames)
    answer(0)
    assert writer.close() == (2, 0)
    assert found == [(1, 10, 1), (2, 20, 2)]


def test_a_frame_that_cannot_be_recorded_ends_the_run_and_costs_no_other_frame(tmp_path, monkeypatch):
    monkeypatch.setattr(log_writer, "EVERY_S", 60.0)
    errors = []
    writer, _, files = recording_writer(tmp_path, died=errors.append)
    for number in range(6):
        wrong = {1: "?", 3: "!"}.get(number, number)
        writer.record(wrong, *bare_frame(number)[1:])
    writer.close()
    assert len(errors) == 1 and isinstance(errors[0], ValueError)
    assert read_frame_log(files.markers.path).rows["number"].tolist() == [0, 2, 4, 5]


def test_a_full_disk_ends_in_one_line_and_the_log_is_recovered(tmp_path, capture, subject):
    """Files may grow to 200 kB: half of the log."""
    write_c3d(capture, tmp_path / "trial.c3d")
    write_subject(subject, tmp_path / "s.toml")
    out = tmp_path / "out"
    limited = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000));"
        "from mbkf.cli.main import main; sys.exit(main(sys.argv[1:]))"
    )
    words = ["live", "--from", f"file:{tmp_path / 'trial.c3d'}", "--subject", tmp_path / "s.toml"]
    done = subprocess.run(
        [sys.executable, "-c", limited, *map(str, words), "--speed", "0", "--out", str(out)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("mbkf: error: the results could not be written")
    report = json.loads((out / "live.json").read_text())
    logged, unlogged = report["frames_written"], report["frames_not_written"]
    assert logged + unlogged == report["frames_in"] == 80
    assert f"{unlogged} frames were never logged and cannot be recovered" in done.stderr.splitlines()[-1]
    assert done.stderr.splitlines()[-1].endswith(f"makes results of the {logged} frames in its log")
    assert report["state"] == "results missing"
    assert report["frames_processed"] == 80
    assert "disk" in {event["kind"] for event in report["events"]}
    written = len(read_frame_log(out / LOG_FOLDER / FRAMES_FILE)[1])
    assert 0 < written == logged
    assert main(["live", "--recover", str(out)]) == 0
    found, expected = read_reconstruction(out), offline(capture, subject)
    assert found.frames == written
    np.testing.assert_allclose(found.q, expected.q[:written], atol=1e-6)
