"""Frame by frame the filter takes the very steps it takes on a whole trial, and survives what it cannot digest."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.errors import FileFormatError, NotObservable
from mbkf.filters.kinematic.warm_start import warm_up_frames
from mbkf.filters.record import FrameRecorder, blank
from mbkf.filters.tracking import track, track_of
from mbkf.filters.tracking_loop import TrackingLoop, followed
from mbkf.io.frame_log import FrameLogWriter, read_frame_log
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.subject import write_subject
from mbkf.trial.live.filter import LiveFilter, live_inputs
from mbkf.trial.live.log import (
    FRAMES_FILE,
    SUBJECT_FILE,
    LiveLog,
    LiveStream,
    read_live_log,
)
from mbkf.trial.live.results import live_results
from mbkf.trial.preparation.filters import FILTERS, tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.scale import scale
from tests.captures import MASS_KG, made_capture

SETTINGS = ReconstructSettings(correct_markers=False)
LAG_S = 0.06
CAPTURE = made_capture(70)


@cache
def subject():
    return scale(made_capture(30, 0.0), mass_kg=MASS_KG)


def recorded(positions=None):
    """What a filter is built from and reads."""
    markers = CAPTURE.markers if positions is None else replace(CAPTURE.markers, positions_m=positions)
    return trial_inputs(subject_markers(markers, subject()), CAPTURE.plates, subject(), SETTINGS)


def steps_of(live, recording):
    steps = [live.push(t, recording.frame(t)) for t in range(len(recording))]
    return [step for some in steps for step in some] + live.finish(), [len(some) for some in steps]


@pytest.mark.slow
@pytest.mark.parametrize("name", FILTERS)
def test_steps_are_those_of_a_whole_trial(name):
    """Also through a start in the middle, after the body was lost."""
    positions = np.array(CAPTURE.markers.positions_m)
    positions[:2] = np.nan
    positions[20:45] = np.nan
    inputs, recording = recorded(positions)
    steps, _ = steps_of(LiveFilter(tracking_filter(name, inputs)), recording)
    expected = {
        t: estimate for t, estimate, _ in followed(TrackingLoop(tracking_filter(name, inputs)), recording)
    }
    assert [step.number for step in steps] == list(range(70))
    assert [step.number for step in steps if step.estimate is not None] == sorted(expected)
    assert sum(estimate.started for estimate in expected.values()) == 2
    for step in steps:
        if step.estimate is not None:
            other = expected[step.number]
            for field in ("q", "v", "a", "wrench", "refused"):
                np.testing.assert_array_equal(getattr(step.estimate, field), getattr(other, field))
            assert (step.estimate.started, step.estimate.tracked) == (other.started, other.tracked)


def test_only_a_start_makes_frames_wait():
    inputs, recording = recorded()
    live = LiveFilter(tracking_filter("dynamic", inputs))
    steps, due = steps_of(live, recording)
    ahead = warm_up_frames(0.01)
    assert due == [0] * ahead + [ahead + 1] + [1] * (69 - ahead)
    assert [step.awaited for step in steps] == [True] * (ahead + 1) + [False] * (69 - ahead)
    assert live.latest is steps[-1].estimate


@pytest.mark.slow
@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_lagged_steps_are_those_of_a_whole_trial(name):
    """Also around a loss, whose frames know nothing of what follows the restart."""
    positions = np.array(CAPTURE.markers.positions_m)
    positions[:2] = np.nan
    positions[20:45] = np.nan
    inputs, recording = recorded(positions)
    steps, _ = steps_of(LiveFilter(tracking_filter(name, inputs), LAG_S), recording)
    expected = track(tracking_filter(name, inputs), recording, lag_s=LAG_S)
    assert [step.number for step in steps] == list(range(70))
    assert [step.number for step in steps if step.estimate is None] == [0, 1]
    for step in steps[2:]:
        for field in ("q", "v", "a", "wrench"):
            np.testing.assert_array_equal(
                getattr(step.estimate, field), getattr(expected, field)[step.number]
            )


def test_a_lagged_frame_is_given_as_late_as_the_lag_and_the_filter_knows_nothing_of_it():
    inputs, recording = recorded()
    live, plain = (LiveFilter(tracking_filter("kinematic", inputs), s) for s in (LAG_S, 0.0))
    ahead = warm_up_frames(0.01)
    for t in range(60):
        due = [step.number for step in live.push(t, recording.frame(t))]
        plain.push(t, recording.frame(t))
        if t > ahead:
            assert due == [t - 6]
            np.testing.assert_array_equal(live.latest.q, plain.latest.q)
            assert live.latest.q is live.loop.estimate.q
    assert live.lag_frames == 6 and plain.lag_frames == 0
    assert [step.number for step in live.cut()] == list(range(54, 60))
    assert live.latest is None and live.finish() == []


def test_a_correction_that_cannot_be_computed_leaves_the_filters_answers(monkeypatch):
    inputs, recording = recorded()
    chosen = tracking_filter("kinematic", inputs)
    linear_step, left = chosen.linear_step, [30]

    def failing(before, estimate):
        left[0] -= 1
        if left[0] == 0:
            raise np.linalg.LinAlgError("singular matrix")
        return linear_step(before, estimate)

    monkeypatch.setattr(chosen, "linear_step", failing)
    steps, _ = steps_of(LiveFilter(chosen, LAG_S), recording)
    assert [step.number for step in steps] == list(range(70))
    assert [step.number for step in steps if step.trouble] == [30]
    assert [step.number for step in steps if step.estimate.started] == [0, 31]


def test_what_the_filter_cannot_digest_makes_it_start_anew(monkeypatch):
    inputs, recording = recorded()
    chosen = tracking_filter("kinematic", inputs)
    step, left = chosen.step, [3]

    def failing(before, recording, t, prediction):
        left[0] -= 1
        if left[0] == 0:
            raise np.linalg.LinAlgError("singular matrix")
        return step(before, recording, t, prediction)

    monkeypatch.setattr(chosen, "step", failing)
    steps, _ = steps_of(LiveFilter(chosen), recording)
    assert [step.number for step in steps if step.trouble] == [3]
    assert [step.number for step in steps if step.estimate and step.estimate.started] == [0, 4]


@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_what_was_expected_is_what_the_step_goes_on_from(name, monkeypatch):
    """Asked what it expects before each frame, the filter predicts no second time and finds the very same."""
    inputs, recording = recorded()
    plain, _ = steps_of(LiveFilter(tracking_filter(name, inputs)), recording)
    chosen = tracking_filter(name, inputs)
    asked, calls = LiveFilter(chosen), []
    predict = chosen.kalman.plant.predict
    monkeypatch.setattr(chosen.kalman.plant, "predict", lambda *a: calls.append(1) or predict(*a))
    found = []
    for t in range(len(recording)):
        expected, before = asked.predict(), len(calls)
        assert (expected is None) == (asked.latest is None)
        assert asked.predict() is expected
        found += asked.push(t, recording.frame(t))
        assert expected is None or len(calls) == before
    for one, other in zip(found, plain, strict=False):
        np.testing.assert_array_equal(one.estimate.q, other.estimate.q)


def test_after_a_cut_nothing_is_known():
    inputs, recording = recorded()
    live = LiveFilter(tracking_filter("kinematic", inputs))
    for t in range(40):
        live.push(t, recording.frame(t))
    assert live.latest is not None
    assert live.cut() == []
    assert live.latest is None
    for t in range(40, 50):
        assert live.push(t, recording.frame(t)) == []
    assert [step.number for step in live.cut()] == list(range(40, 50))


def test_columns_lead_to_the_subjects_markers():
    names = ("unknown", *CAPTURE.markers.names[::-1])
    live = live_inputs(names, 100.0, CAPTURE.plates, subject(), SETTINGS)
    assert tuple(names[k] for k in live.columns) == live.names
    assert set(live.names) == {marker.name for marker in subject().markers}
    whole, _ = recorded()
    np.testing.assert_array_equal(live.inputs.unobservable, whole.unobservable)
    with pytest.raises(NotObservable):
        live_inputs(("a", "b"), 100.0, (), subject(), SETTINGS)


@pytest.fixture
def log(tmp_path):
    """A log of frames 3 to 60, two of them missing, and what made its rows."""
    live = live_inputs(CAPTURE.markers.names, 100.0, CAPTURE.plates, subject(), SETTINGS)
    chosen = tracking_filter("dynamic", live.inputs)
    rows = FrameRecorder(chosen, len(live.names))
    plates = tuple(
        replace(p, force_n=p.force_n[:0], moment_nm=p.moment_nm[:0], centre_of_pressure_m=p.force_n[:0])
        for p in CAPTURE.plates
    )
    made = LiveLog(
        tmp_path, LiveStream("walk", 100.0, 0.5, plates), rows.dtype, {"filter": "dynamic"}, list(live.names)
    )
    write_subject(subject(), tmp_path / SUBJECT_FILE)
    _, recording = recorded()
    filter_ = LiveFilter(chosen)
    for t in range(3, 61):
        for step in filter_.push(t, recording.frame(t)):
            if step.number not in (30, 31):
                markers = recording.markers_m[step.number]
                row, spread = rows.row(step.number, markers, step.estimate, step.seconds)
                if step.estimate is not None:
                    rows.spread(row, spread)
                    rows.innovation(row, step.estimate)
                made.frames.append(row)
    samples = np.zeros(500, dtype=made.plates.dtype)
    samples["index"] = np.arange(30, 530)
    values = [np.hstack([p.force_n, p.moment_nm]) for p in CAPTURE.plates]
    samples["wrench"] = np.stack(values, axis=1)[30:530]
    made.plates.append(samples)
    made.close()
    return tmp_path


def test_a_log_gives_back_its_frames_and_blanks_for_lost_ones(log):
    found = read_live_log(log)
    assert (found.first, len(found.rows), found.stream.trial) == (3, 58, "walk")
    assert found.rows["number"].tolist() == list(range(3, 61))
    assert np.flatnonzero(~found.rows["known"]).tolist() == [27, 28]
    plate = found.stream.plates[1]
    assert plate.start_time_s == pytest.approx(0.03)
    np.testing.assert_array_equal(plate.force_n, CAPTURE.plates[1].force_n[30:530])
    track = track_of(found.rows)
    assert track.starts == (0,)
    assert np.isnan(track.q[27:29]).all()
    assert not track.tracked[27:29].any()
    assert track.foot_contact.shape == (58, 2)


def test_results_are_made_from_a_log_alone(log):
    found = live_results(log, ("a note",))
    assert (found.trial, found.filter, found.frames) == ("walk", "dynamic", 58)
    assert found.times_s[0] == pytest.approx(0.53)
    assert "a note" in found.warnings
    assert np.isfinite(found.tau[found.tracked]).all()
    assert found.settings == {"filter": "dynamic"}


def test_a_log_without_frames_or_without_a_body_gives_no_results(log):
    live = read_live_log(log)
    nobody = blank(live.rows.dtype, 5)
    nobody["number"] = np.arange(5)
    header = read_frame_log(log / FRAMES_FILE).header
    with FrameLogWriter(log / FRAMES_FILE, nobody.dtype, header) as writer:
        writer.append(nobody)
    with pytest.raises(NotObservable, match="no frame of the stream"):
        live_results(log)
    FrameLogWriter(log / FRAMES_FILE, nobody.dtype, header).close()
    with pytest.raises(FileFormatError, match="no frame was written"):
        live_results(log)


def test_doubts_about_limbs_have_the_time_of_the_stream():
    """Frames that a gap keeps from the filter count."""
    inputs, recording = recorded()
    live = LiveFilter(tracking_filter("kinematic", inputs))
    doubt = LimbDoubt("left_thigh", "turned over", 0.2, 0.25, mended=True, right_from_s=0.26)
    for t in range(30):
        live.push(t, recording.frame(t))
    live.loop.watch.doubts.append(doubt)
    assert live.limb_doubts() == (doubt,) and live.limb_doubts_ended == 1
    live.cut()
    for t in range(40, 70):
        live.push(50 + t, recording.frame(t))
    live.loop.watch.doubts.append(doubt)
    first, second = live.limb_doubts()
    assert (
        first == doubt and second.from_s == pytest.approx(0.8) and second.right_from_s == pytest.approx(0.86)
    )
