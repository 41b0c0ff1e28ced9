"""Through Lab Streaming Layer on this computer: what is sent arrives to the last digit, and lost streams come back."""

import threading
import time
import uuid
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.records import MarkerTrajectories
from mbkf.model.human import HumanModel
from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.format import PlateLayout, plates_info, plates_name, read_marker_info, read_plates_info
from mbkf.stream.lsl.player import LslPlayer
from mbkf.stream.lsl.results import LslResults
from mbkf.stream.lsl.source import GIVEN_UP, LslSource
from mbkf.stream.played import played
from mbkf.stream.replay import ReplaySettings, replay
from mbkf.stream.results.values import ResultValues
from mbkf.stream.source import UNCOUNTED, StreamDescription
from tests.captures import made_capture
from tests.stream.results.test_websocket import shown_frame

CAPTURE = made_capture(30)
PYLSL = lsl()


@pytest.fixture
def name():
    """A stream of its own for each test: others may be on this network."""
    return f"mbkf-test-{uuid.uuid4().hex[:8]}"


def play(player, made, speed=2.0):
    thread = threading.Thread(
        target=replay, args=(made, player, ReplaySettings(speed, wait_s=10.0), threading.Event())
    )
    thread.start()
    return thread


def connected(source):
    until = time.monotonic() + 10.0
    while time.monotonic() < until:
        stream = source.connect(0.5)
        if stream is not None:
            return stream
    raise AssertionError("no stream")


def read(source, count, seconds=5.0):
    frames, until = [], time.monotonic() + seconds
    while len(frames) < count and time.monotonic() < until:
        frame = source.read(0.1)
        if frame is not None:
            frames.append(frame)
    return frames


def test_what_is_sent_arrives_to_the_last_digit(name):
    hidden = np.array(CAPTURE.markers.positions_m)
    hidden[5:9, 2] = np.nan
    markers = replace(CAPTURE.markers, positions_m=hidden, start_time_s=0.05)
    made = played(replace(CAPTURE, markers=markers, path="walk.c3d"))
    player, source = LslPlayer(made, name, 2.0), LslSource(name)
    stream = connected(source)
    assert (stream.trial, stream.marker_names) == ("walk", CAPTURE.markers.names)
    assert (stream.rate_hz, stream.start_time_s, stream.plate_rate_hz) == (100.0, 0.05, 1000.0)
    for plate, original in zip(stream.plates, CAPTURE.plates, strict=True):
        assert (plate.name, plate.threshold_n, plate.start_time_s) == (original.name, 20.0, 0.0)
        np.testing.assert_array_equal(plate.corners_m, original.corners_m)
        np.testing.assert_array_equal(plate.origin_m, original.origin_m)
    thread = play(player, made)
    frames = read(source, 30)
    thread.join()
    source.close()
    player.close()
    assert [frame.number for frame in frames] == list(range(30))
    np.testing.assert_array_equal([frame.markers_m for frame in frames], hidden)
    index = np.concatenate([frame.plates.index for frame in frames])
    wrench = np.concatenate([frame.plates.wrench for frame in frames])
    np.testing.assert_array_equal(np.diff(index), 1)
    np.testing.assert_array_equal(wrench, made.wrench[index])
    known = index[np.cumsum([len(frame.plates.index) for frame in frames]) - 1]
    assert (known >= np.minimum(50 + 10 * (np.arange(30) + 0.5), 299)).all()


class Scripted:
    """Plates whose samples are there up to an index, and after a wait up to a later one; notes the waits."""

    def __init__(self):
        self.there = self.soon = self._given = 0
        self.waits = []

    def pull_chunk(self, timeout, max_samples, min_samples):
        self.waits.append(timeout)
        until = self.there
        if until <= self._given and timeout > 0.0:
            time.sleep(timeout if self.soon <= self._given else 0.0)
            until = self.soon
        index = np.arange(self._given, max(until, self._given))[:max_samples]
        self._given += len(index)
        return np.column_stack([np.zeros((len(index), 6)), index]), 0.0 * index


def scripted(name):
    source, plates = LslSource(name), Scripted()
    plate = replace(CAPTURE.plates[0], start_time_s=0.0)
    source._stream = StreamDescription("x", ("A",), 100.0, 0.0, (plate,))
    source._plates, source._counted = plates, True
    source._plate_layout = PlateLayout(np.arange(6)[None], 6, np.eye(3))
    return source, plates


def test_a_source_that_counts_anew_goes_on_with_its_plates(name):
    """What was read until then has higher numbers than what follows."""
    source, plates = scripted(name)
    source._newest_sample = 5000
    for number in range(3):
        plates.there = 10 * number + 6
        samples = source._samples(number, time.perf_counter())
        assert samples.index[-1] == 10 * number + 5


def test_late_plates_are_waited_for_given_up_and_waited_for_again(name, monkeypatch):
    """Four frames in vain are enough; once samples are nearly in time again, they are waited for."""
    monkeypatch.setattr("mbkf.stream.lsl.source.LATE_S", 0.02)
    monkeypatch.setattr("mbkf.stream.lsl.source.QUIET_S", 60.0)
    source, plates = scripted(name)

    def newest(number, there, soon):
        plates.there, plates.soon, before = there, soon, len(plates.waits)
        samples = source._samples(number, time.perf_counter())
        return samples.index.max(initial=-1), any(wait > 0.0 for wait in plates.waits[before:])

    assert newest(0, 0, 6) == (5, True)
    assert newest(1, 6, 16) == (15, True)
    for number in range(2, 2 + GIVEN_UP):
        assert newest(number, 16, 16) == (-1, True)
    assert newest(6, 16, 66) == (-1, False)
    assert newest(7, 66, 76) == (65, False)
    assert newest(8, 76, 86) == (85, True)


def test_plates_are_not_waited_for_where_a_count_has_jumped(name):
    source, plates = scripted(name)
    plates.there = plates.soon = 6
    assert source._samples(0, time.perf_counter()).index[-1] == 5
    plates.there = plates.soon = 16
    begin = time.perf_counter()
    for number in (1001, UNCOUNTED, -(10**6)):
        source._samples(number, begin)
    assert max(plates.waits[1:]) == 0.0
    assert source._newest_sample == 15


@pytest.mark.parametrize("counter", [np.nan, np.inf, -np.inf, 2.0**60, -(2.0**60)])
def test_a_count_that_is_none_is_told_as_such(name, counter):
    source, _ = scripted(name)
    source._layout = SimpleNamespace(counter=3)
    assert source._number(np.array([0.0, 0.0, 0.0, counter]), 0.0) == UNCOUNTED
    assert source._number(np.array([0.0, 0.0, 0.0, 41.0]), 0.0) == 41
    placed = source._placed(np.array([[0, 0, 0, 0, 0, 0, 7.0], [0, 0, 0, 0, 0, 0, counter]]), np.zeros(2))
    assert placed.index.tolist() == [7, UNCOUNTED]
    source._counted = False
    assert source._number(np.zeros(4), np.nan) == UNCOUNTED


@pytest.mark.slow
def test_plates_that_return_as_others_are_refused(name):
    made = played(CAPTURE)
    player, source = LslPlayer(made, name), LslSource(name)
    connected(source)
    player._plates = None
    other = replace(made.stream, plates=made.stream.plates[:1])
    outlet = PYLSL.StreamOutlet(plates_info(PYLSL, other, name))
    thread, news = play(player, made, 1.0), []
    until = time.monotonic() + 10.0
    while "plates refused" not in news and time.monotonic() < until:
        source.read(0.05)
        news += [kind for kind, _ in source.news()]
    thread.join()
    assert news == ["plates gone", "plates refused"]
    source.close()
    del outlet


def test_points_without_names_arrive(name):
    made = played(replace(CAPTURE, plates=()), unlabelled=True)
    player, source = LslPlayer(made, name), LslSource(name)
    stream = connected(source)
    assert (stream.marker_names, stream.plates) == ((), ())
    thread = play(player, made, 4.0)
    frames = read(source, 30)
    thread.join()
    player.close()
    np.testing.assert_array_equal([frame.unlabelled_m for frame in frames], made.markers_m)


@pytest.mark.slow
def test_a_stream_that_dies_and_returns_is_taken_up_again(name):
    made = played(CAPTURE)
    player, source = LslPlayer(made, name), LslSource(name)
    connected(source)
    thread = play(player, made, 4.0)
    assert len(read(source, 30)) == 30
    thread.join()
    player.close()
    assert read(source, 1, 0.3) == []
    again = LslPlayer(made, name)
    thread = play(again, made, 4.0)
    assert [frame.number for frame in read(source, 30, 10.0)][-1:] == [29]
    thread.join()
    again.close()
    source.close()
    assert {"markers gone", "markers back"} <= {kind for kind, _ in source.news()}


def test_a_stream_that_returns_with_other_markers_is_refused(name):
    made = played(replace(CAPTURE, plates=()))
    player, source = LslPlayer(made, name), LslSource(name)
    connected(source)
    player.close()
    other = MarkerTrajectories(("A", "B"), np.zeros((5, 2, 3)), 100.0)
    again = LslPlayer(played(replace(CAPTURE, markers=other, plates=())), name)
    until, news = time.monotonic() + 10.0, []
    while "refused" not in {kind for kind, _ in news} and time.monotonic() < until:
        assert source.read(0.1) is None
        news += source.news()
    again.close()
    source.close()
    assert any("other markers" in what for _, what in news)


def test_a_plate_stream_that_is_missing_is_told_of(name, monkeypatch):
    monkeypatch.setattr("mbkf.stream.lsl.source.PLATES_S", 0.2)
    made = played(CAPTURE)
    player, source = LslPlayer(made, name), LslSource(name)
    player._plates = None
    stream = connected(source)
    assert stream.plates == ()
    assert "is missing" in source.news()[0][1]
    source.close()
    player.close()


def foreign(name, kind, channels, rate_hz=100.0, **described):
    """A stream as other programs make it: no counter, their own units."""
    info = PYLSL.StreamInfo(name, kind, len(channels), rate_hz, PYLSL.cf_float32, name)
    for key, value in described.items():
        info.desc().append_child_value(key, value)
    entries = info.desc().append_child("channels")
    for channel in channels:
        entry = entries.append_child("channel")
        for key, value in channel.items():
            entry.append_child_value(key, value)
    return info


def positions(marker, unit="millimeters"):
    return [{"label": f"{marker}{a}", "marker": marker, "type": f"Position{a}", "unit": unit} for a in "XYZ"]


def test_another_programs_stream_is_numbered_by_its_stamps(name):
    info = foreign(name, "MoCap", [*positions("A"), *positions("B")], up="y")
    outlet, source = PYLSL.StreamOutlet(info), LslSource(name)
    stream = connected(source)
    assert stream.marker_names == ("A", "B")
    begin = PYLSL.local_clock()
    for number in (0, 1, 2, 5, 6):
        outlet.push_sample([0.0, 1000.0, 0.0, 0.0, 0.0, 500.0 + number], begin + number / 100.0)
    frames = read(source, 5, 10.0)
    source.close()
    assert [frame.number for frame in frames] == [0, 1, 2, 5, 6]
    np.testing.assert_allclose(frames[3].markers_m, [[0.0, 0.0, 1.0], [0.0, -0.505, 0.0]], atol=1e-6)


def test_streams_that_cannot_be_used_are_refused(name):
    with pytest.raises(InvalidInput, match="no rate"):
        read_marker_info(foreign(name, "MoCap", positions("A"), 0.0))
    with pytest.raises(InvalidInput, match="no channels of type PositionX"):
        read_marker_info(foreign(name, "MoCap", [{"label": "x"}]))
    with pytest.raises(InvalidInput, match="'inches'"):
        read_marker_info(foreign(name, "MoCap", positions("A", "inches")))
    loads = [{"label": k, "type": f"{k}{a}"} for k in ("Force", "Moment") for a in "XYZ"]
    with pytest.raises(InvalidInput, match="of 1 plates and describes 0"):
        read_plates_info(foreign(plates_name(name), "ForcePlate", loads))


def test_results_are_published_with_names_and_units(name):
    model = HumanModel.scaled(mass_kg=75.0)
    results = LslResults(model, name, 100.0)
    (info,) = PYLSL.resolve_byprop("name", name, 1, 5.0)
    inlet = PYLSL.StreamInlet(info, as_numpy=True)
    inlet.open_stream(5.0)
    entry = inlet.info(5.0).desc().child("channels").child("channel")
    assert (entry.child_value("label"), entry.child_value("unit")) == ("pelvis_tilt", "rad")
    frame = shown_frame(model)
    until = time.monotonic() + 5.0
    sample = None
    while sample is None and time.monotonic() < until:
        results.take(frame)
        sample, _ = inlet.pull_sample(0.1)
    results.close()
    np.testing.assert_array_equal(sample[:-3], ResultValues(model).row(frame))
    np.testing.assert_array_equal(sample[-3:], [frame.number, 1.0, frame.latency_s])
