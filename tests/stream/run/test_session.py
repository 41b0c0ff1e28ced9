"""A live run writes what `reconstruct` writes, tells how it went, and shows each frame."""

import json
import threading
from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotObservable
from mbkf.filters.inverse_dynamics import support_torques
from mbkf.filters.record import FrameRecorder
from mbkf.io.contacts import Source
from mbkf.io.results_folder import read_reconstruction
from mbkf.stream.receiving.alignment import ReadyFrame
from mbkf.stream.results.frame import LiveFrame
from mbkf.stream.run.events import MOST, EventLog
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.stream.run.frame_maker import FrameMaker
from mbkf.stream.run.report import ROOM_BYTES, ReportFile, latency_summary
from mbkf.stream.run.session import LiveSession
from mbkf.trial.live.filter import live_inputs
from mbkf.trial.live.results import live_results
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.stream.scripted import (
    Collected,
    ScriptedSource,
    assert_same,
    follow,
    frames_of,
    kinds,
    offline,
)

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def subject(scaled):
    """With spreads by the body, as offline."""
    return scaled


FILES = {
    "live.json",
    "summary.json",
    "motion.h5",
    "angles.mot",
    "angles_lab.mot",
    "torques.sto",
    "reactions.mot",
    "markers.trc",
}


IN_PROGRESSION = ("pelvis_tilt", "pelvis_list", "pelvis_rotation")
"""Angles that files tell in the frame of progression, which nobody knows while the stream runs."""


@pytest.mark.parametrize("name", ["dynamic", "kinematic", "torque"])
def test_results_are_the_causal_ones_of_reconstruct(tmp_path, capture, subject, name):
    settings = ReconstructSettings(filter=name, correct_markers=False)
    outcome = follow(tmp_path, *frames_of(capture), subject, settings)
    assert {path.name for path in tmp_path.iterdir()} == FILES
    expected = offline(capture, subject, settings)
    assert_same(tmp_path, expected)
    found = read_reconstruction(tmp_path)
    assert found.later_frames == expected.later_frames == "causal (as live)"
    assert found.settings["smooth"] is False
    report = json.loads((tmp_path / "live.json").read_text())
    assert report == json.loads(json.dumps(outcome.report))
    counts = {key: report[key] for key in ("frames_in", "frames_lost", "frames_processed", "starts")}
    assert counts == {"frames_in": 80, "frames_lost": 0, "frames_processed": 80, "starts": 1}
    assert report["state"] == "finished"
    assert report["events"] == []
    assert found.verdict is not None and expected.verdict is not None
    assert found.verdict.parts == expected.verdict.parts == report["verdict"]["parts"]
    assert [one.name for one in found.checks] == [one.name for one in expected.checks]


def test_lagged_results_are_those_of_reconstruct(tmp_path, capture, subject):
    """Rows, listeners and files hold the lagged frames under their own numbers; the lag is told apart from latency."""
    settings, seen = ReconstructSettings(lag_s=0.06, correct_markers=False), Collected([])
    outcome = follow(tmp_path, *frames_of(capture), subject, settings, sinks=[seen], keep_log=True)
    expected = offline(capture, subject, settings)
    found = read_reconstruction(tmp_path)
    for name, tolerance in (("q", 1e-9), ("v", 1e-9), ("angles", 1e-9), ("tau", 1e-6), ("foot_wrench", 1e-6)):
        np.testing.assert_allclose(
            getattr(found, name), getattr(expected, name), atol=tolerance, err_msg=name
        )
    plain = offline(capture, subject, ReconstructSettings(correct_markers=False))
    np.testing.assert_allclose(found.foot_wrench_sd, plain.foot_wrench_sd, rtol=1e-9)  # never too narrow
    assert outcome.report["lag_ms"] == pytest.approx(60.0)
    assert read_reconstruction(tmp_path).lag_ms == 60.0
    assert [frame.number for frame in seen.frames] == list(range(80))
    np.testing.assert_allclose([frame.q for frame in seen.frames], expected.q, atol=1e-9)
    again = live_results(tmp_path / LOG_FOLDER)
    np.testing.assert_allclose(again.q, expected.q, atol=1e-9)
    assert again.lag_ms == 60.0


def test_points_without_names_are_named_in_the_loop(tmp_path, capture, subject):
    outcome = follow(tmp_path, *frames_of(capture, unlabelled=True), subject)
    assert outcome.report["frames_lost"] == 0
    found, expected = read_reconstruction(tmp_path), offline(capture, subject)
    columns = [expected.marker_names.index(name) for name in found.marker_names]
    shown = found.present
    assert shown.mean() > 0.99
    np.testing.assert_allclose(found.measured_m[shown], expected.measured_m[:, columns][shown], atol=1e-12)


def test_every_frame_is_shown_with_what_the_results_say_of_it(tmp_path, capture, subject):
    seen = Collected([])
    outcome = follow(tmp_path, *frames_of(capture), subject, sinks=[seen])
    assert seen.closed
    found = read_reconstruction(tmp_path)
    assert [frame.number for frame in seen.frames] == list(range(80))
    assert [frame.started for frame in seen.frames] == [True] + 79 * [False]
    told_alike = [k for k, name in enumerate(found.coordinate_names) if name not in IN_PROGRESSION]
    for name, array in (
        ("q", found.q),
        ("v", found.v),
        ("torques", found.tau),
        ("wrench", found.foot_wrench),
        ("measured_m", found.measured_m),
        ("torques_sd", found.sd_tau),
        ("predicted_m", found.predicted_m),
    ):
        shown = np.array([getattr(frame, name) for frame in seen.frames])
        np.testing.assert_allclose(shown, array, rtol=1e-9, atol=1e-9, err_msg=name)
    shown = np.array([frame.angle_sd for frame in seen.frames])[:, told_alike]
    np.testing.assert_allclose(shown, found.angles_sd[:, told_alike], rtol=1e-9, atol=1e-9)
    latest = seen.frames[-1]
    assert isinstance(latest, LiveFrame)
    assert latest.time_s == pytest.approx(0.79)
    assert latest.rate_hz == pytest.approx(100.0)
    assert latest.plates.shape == (2, 6)
    assert outcome.report["rate_hz"] == pytest.approx(100.0)


def test_a_filter_without_wrenches_shows_the_measured_ones(tmp_path, capture, subject):
    seen = Collected([])
    follow(
        tmp_path,
        *frames_of(capture),
        subject,
        ReconstructSettings(filter="kinematic", correct_markers=False),
        sinks=[seen],
    )
    vertical = np.array([frame.wrench[:, 2] for frame in seen.frames])
    plates = np.array([frame.plates[:, 2] for frame in seen.frames])
    np.testing.assert_allclose(vertical.sum(axis=1), plates.sum(axis=1))


def test_the_rate_is_that_of_the_last_second(capture, subject):
    stream, _ = frames_of(capture)
    live = live_inputs(stream.marker_names, stream.rate_hz, stream.plates, subject, ReconstructSettings())
    maker = FrameMaker(live, stream.rate_hz)
    for arrival_s in (0.0, 5.0, 5.5, 6.0):
        maker.arrived(arrival_s)
    rows = FrameRecorder(tracking_filter("dynamic", live.inputs), len(live.names))
    unseen = np.full((len(live.names), 3), np.nan)
    ready = ReadyFrame(7, 6.0, unseen, np.zeros((0, 3)), np.zeros((2, 6)))
    shown = maker.frame(ready, rows.row(7, unseen, None, 0.0)[0], 0.001, 3)
    assert shown.rate_hz == pytest.approx(2.0)
    assert (shown.number, shown.lost, shown.tracked) == (0, 3, False)
    assert np.isnan(shown.q).all()


def test_a_listener_gets_loads_on_all_parts_and_torques_that_count_them(capture, subject):
    stream, _ = frames_of(capture)
    live = live_inputs(stream.marker_names, stream.rate_hz, stream.plates, subject, ReconstructSettings())
    model = live.inputs.sensor.model
    maker = FrameMaker(live, stream.rate_hz)
    rows = FrameRecorder(tracking_filter("dynamic", live.inputs), len(live.names))
    unseen = np.full((len(live.names), 3), np.nan)
    ready = ReadyFrame(0, 0.0, unseen, np.zeros((0, 3)), np.zeros((2, 6)))
    row, _ = rows.row(0, unseen, None, 0.0)
    row["known"], row["q"], row["footing"] = True, model.neutral(), [-1, 1]
    row["v"] = row["a"] = row["wrench"] = row["support"] = 0.0
    alone = maker.frame(ready, row, 0.0, 0)
    row["support"] = np.random.default_rng(0).normal(size=row["support"].shape)
    row["support_sd"] = 2.0
    shown = maker.frame(ready, row, 0.0, 0)
    change = shown.torques - alone.torques
    np.testing.assert_allclose(
        change, -support_torques(model, model.neutral(), row["support"][0]), atol=1e-10
    )
    assert shown.foot_source.tolist() == [Source.ESTIMATED, Source.MEASURED]
    np.testing.assert_array_equal(shown.support, row["support"][0])
    assert (shown.support_sd == 2.0).all()


def test_a_listener_that_fails_is_dropped(tmp_path, capture, subject):
    class Broken(Collected):
        def take(self, frame):
            super().take(frame)
            raise RuntimeError("out of paper")

    broken = Broken([])
    outcome = follow(tmp_path, *frames_of(capture), subject, sinks=[broken])
    assert len(broken.frames) == 1
    assert kinds(outcome) == {"viewer"}
    assert outcome.problem is None


def test_it_ends_when_the_time_is_over(tmp_path, capture, subject):
    outcome = follow(tmp_path, *frames_of(capture), subject, seconds=0.4)
    assert outcome.report["ended_by"] == "the time was over"
    assert outcome.report["frames_processed"] == outcome.report["frames_in"] == 40
    assert read_reconstruction(tmp_path).frames == 40


def test_it_ends_when_it_is_stopped(tmp_path, capture, subject):
    stream, frames = frames_of(capture)
    stop = threading.Event()

    class Stopping(Collected):
        def take(self, frame):
            stop.set()

    session = LiveSession(
        ScriptedSource(stream, frames),
        subject,
        ReconstructSettings(correct_markers=False),
        tmp_path,
        "script",
    )
    session.connect(stop, 1.0)
    outcome = session.run(stop, [Stopping([])])
    assert outcome.report["ended_by"] == "it was stopped"
    assert 0 < read_reconstruction(tmp_path).frames < 80


def test_the_log_can_be_kept_and_holds_all(tmp_path, capture, subject):
    follow(tmp_path, *frames_of(capture), subject, keep_log=True)
    assert_same(tmp_path, live_results(tmp_path / LOG_FOLDER))


def test_a_stream_that_never_appears_ends_in_one_line(tmp_path, capture, subject):
    class Absent(ScriptedSource):
        def connect(self, timeout_s):
            return None

    session = LiveSession(Absent(None, []), subject, ReconstructSettings(), tmp_path, "lsl")
    with pytest.raises(InvalidInput, match="no lsl stream appeared"):
        session.connect(threading.Event(), 0.0)
    stopped = threading.Event()
    stopped.set()
    assert not session.connect(stopped, None)
    assert list(tmp_path.iterdir()) == []


def test_a_stream_of_other_markers_is_refused(tmp_path, capture, subject):
    names = tuple(f"M{k}" for k in range(len(capture.markers.names)))
    stream, frames = frames_of(capture)
    strange = type(stream)(stream.trial, names, stream.rate_hz)
    session = LiveSession(ScriptedSource(strange, frames), subject, ReconstructSettings(), tmp_path, "script")
    with pytest.raises(NotObservable, match="0 of the subject's markers"):
        session.connect(threading.Event(), 1.0)


def test_no_frames_mean_no_results(tmp_path, capture, subject):
    stream, _ = frames_of(capture)
    outcome = follow(tmp_path, stream, [], subject)
    assert outcome.summary is None
    assert "no frame" in outcome.problem
    assert {path.name for path in tmp_path.iterdir()} == {"live.json"}


def test_latencies_at_a_start_are_told_apart():
    summary = latency_summary([0.001, 0.002, 0.003], [0.3, 0.2])
    assert summary["latency_ms_median"] == pytest.approx(2.0)
    assert summary["latency_ms_max"] == pytest.approx(3.0)
    assert (summary["latency_ms_max_at_start"], summary["frames_at_start"]) == (pytest.approx(300.0), 2)
    assert latency_summary([], [0.3, 0.2])["latency_ms_median"] == pytest.approx(250.0)
    assert set(latency_summary([], []).values()) == {None, 0}


def test_the_report_has_its_room_from_the_start(tmp_path):
    path = tmp_path / "new" / "live.json"
    report = ReportFile(path)
    assert path.stat().st_size == ROOM_BYTES
    report.write({"rate_hz": float("nan"), "events": [1.5, "x"]})
    assert path.stat().st_size == ROOM_BYTES
    assert json.loads(path.read_text()) == {"rate_hz": None, "events": [1.5, "x"]}
    report.write({"done": True}, last=True)
    assert json.loads(path.read_text()) == {"done": True}
    assert path.stat().st_size < 100


def test_the_same_thing_again_is_one_event():
    times_s = iter([5.0, 5.0, 6.0, 7.5, 15.0])
    events = EventLog(lambda: next(times_s, 15.0))
    for _ in range(4):
        events.note("lost", "frames were lost", 7, count=2)
    first, second = events.plain()
    assert (first["count"], first["first_s"], first["last_s"]) == (6, 0.0, 2.5)
    assert second["count"] == 2
    for k in range(MOST):
        events.note(f"kind {k}", "x")
    assert events.plain()[-1]["kind"] == "unlisted"


def test_a_limb_whose_names_are_exchanged_is_reported_as_offline(tmp_path, capture, subject):
    """With its time, the names and the same verdict, also of the log alone."""
    positions, names = np.array(capture.markers.positions_m), capture.markers.names
    for part in ("KNE", "ANK", "TIB", "TUB", "HEE", "TOE"):
        pair = [names.index(side + part) for side in "LR" if side + part in names]
        if len(pair) == 2:
            positions[40:, pair] = positions[40:, pair[::-1]]
    faulty = replace(capture, markers=replace(capture.markers, positions_m=positions))
    outcome = follow(tmp_path, *frames_of(faulty), subject, keep_log=True)
    expected = offline_as_live(faulty, subject)
    found = read_reconstruction(tmp_path)
    assert expected.limb_doubts and found.limb_doubts == expected.limb_doubts
    assert found.names_exchanged == expected.names_exchanged
    assert found.verdict.parts == expected.verdict.parts
    assert live_results(tmp_path / LOG_FOLDER).limb_doubts == expected.limb_doubts
    (first, *_) = outcome.report["limb_doubts"]
    assert first["from_s"] == pytest.approx(expected.limb_doubts[0].from_s)
    assert first["sentence"] == expected.limb_doubts[0].sentence
    assert "limb" in kinds(outcome)


def offline_as_live(capture, subject):
    """The causal result without names that the whole trial's geometry puts right."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("mbkf.trial.order.names_put_right", lambda markers, _: (markers, ()))
        return offline(capture, subject)
