"""Through Lab Streaming Layer on this computer: what is sent arrives to the last digit, and lost streams come back."""

import threading
import uuid
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.records import MarkerTrajectories
from mbkf.io.verdict import Reason, Verdict
from mbkf.model.human import HumanModel
from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.format import plates_info, plates_name, read_marker_info, read_plates_info
from mbkf.stream.lsl.player import LslPlayer
from mbkf.stream.lsl.results import VERDICT_SUFFIX, LslResults
from mbkf.stream.lsl.source import Arrived, LslSource
from mbkf.stream.played import played
from mbkf.stream.replay import ReplaySettings, replay
from mbkf.stream.results.judgement import Judgement
from mbkf.stream.results.values import ResultValues
from mbkf.stream.source import UNCOUNTED, StreamDescription
from tests.captures import made_capture
from tests.stream.reading import connected, events, read
from tests.stream.results.test_websocket import shown_frame
from tests.waiting import PATIENCE_S, until

CAPTURE = made_capture(30)
PYLSL = lsl()


@pytest.fixture
def name():
    """A stream of its own for each test: others may be on this network."""
    return f"mbkf-test-{uuid.uuid4().hex[:8]}"


def play(player, made, speed=2.0):
    thread = threading.Thread(
        target=replay, args=(made, player, ReplaySettings(speed, wait_s=PATIENCE_S), threading.Event())
    )
    thread.start()
    return thread


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


@pytest.mark.slow
def test_plates_that_return_as_others_are_refused(name):
    made = played(CAPTURE)
    player, source = LslPlayer(made, name), LslSource(name)
    connected(source)
    assert source.read(0.1) is None
    player._plates = None
    other = replace(made.stream, plates=made.stream.plates[:1])
    outlet = PYLSL.StreamOutlet(plates_info(PYLSL, other, name))
    thread, news = play(player, made, 1.0), []

    def refused():
        source.read(0.05)
        news.extend(kind for kind, _ in source.news())
        return "plates refused" in news

    until(refused, lambda: news)
    thread.join()
    assert news == ["plates gone", "plates refused"]
    source.close()
    del outlet


@pytest.mark.slow
def test_plates_and_markers_that_return_in_reverse_order_are_mapped(name):
    """Plates that are named by their number have the same names in the new order: geometry says which is which."""
    made = played(CAPTURE)
    made = replace(made, wrench=made.wrench * np.array([1.0, 3.0])[:, None])
    player, source = LslPlayer(made, name), LslSource(name)
    connected(source)
    thread = play(player, made, 4.0)
    assert len(read(source, 30)) == 30
    thread.join()
    player.close()
    names = [plate.name for plate in made.stream.plates]
    plates = [replace(plate, name=own) for plate, own in zip(made.stream.plates[::-1], names, strict=True)]
    stream = replace(made.stream, plates=tuple(plates), marker_names=made.stream.marker_names[::-1])
    turned = replace(made, stream=stream, markers_m=made.markers_m[:, ::-1], wrench=made.wrench[:, ::-1])
    again = LslPlayer(turned, name)
    back = events(source, "markers back", "plates back")
    thread = play(again, turned, 4.0)
    frames = read(source, 30)
    thread.join()
    again.close()
    source.close()
    assert "in another order" in dict(back)["plates back"]
    np.testing.assert_array_equal([frame.markers_m for frame in frames], made.markers_m)
    found = np.concatenate([frame.plates.wrench for frame in frames])
    index = np.concatenate([frame.plates.index for frame in frames])
    passed = frames[0].number  # it counts from zero, and time here numbers its frames
    np.testing.assert_array_equal(found, made.wrench[index - 10 * passed])


@pytest.mark.parametrize("counter", [np.nan, np.inf, -np.inf, 2.0**60, -(2.0**60)])
def test_a_count_that_cannot_be_read_is_stated_as_such(name, counter):
    source = LslSource(name)
    source._layout, source._ahead = SimpleNamespace(counter=3), 50
    assert source._count(np.array([0.0, 0.0, 0.0, counter])) == UNCOUNTED
    assert source._count(np.array([0.0, 0.0, 0.0, 41.0])) == 91


@pytest.mark.parametrize(("restarted", "count", "number"), [(True, 5, 200), (True, 190, 190), (False, 5, 5)])
def test_the_count_of_a_sender_that_was_started_anew_goes_on_by_time(name, restarted, count, number):
    """The frame before had number 100, one second ago."""
    source = LslSource(name)
    source._layout, source._restarted = SimpleNamespace(counter=0), restarted
    source._stream = StreamDescription("x", ("A",), 100.0)
    source._counted = Arrived(10.0, 0.0, np.zeros(1), 100)
    for k in range(3):
        source._take_counted(Arrived(11.0 + k / 100.0, 0.0, np.array([count + k])))
    assert [one.number for one in source._ready] == [number, number + 1, number + 2]
    assert [kind for kind, _ in source.news()] == ["clock"] * (number == 200)


def test_frames_that_come_twice_have_their_number_twice(name):
    info = foreign(name, "MoCap", positions("A"))
    outlet, source = PYLSL.StreamOutlet(info), LslSource(name)
    connected(source)
    assert source.read(0.1) is None
    until(outlet.have_consumers)
    begin = PYLSL.local_clock()
    for number in (0, 1, 1, 2, 3, 3):
        outlet.push_sample([float(number), 0.0, 0.0], begin + number / 100.0)
    assert [frame.number for frame in read(source, 6)] == [0, 1, 1, 2, 3, 3]
    source.close()
    del outlet


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("", 1.0), ("Millimeters", 1e-3)])
def test_markers_are_in_their_unit(name, unit, metres):
    layout = read_marker_info(foreign(name, "MoCap", positions("A", unit)))[1]
    np.testing.assert_allclose(
        layout.points(np.array([1.0, 2.0, 3.0]))[0], [[metres, 2 * metres, 3 * metres]]
    )


def test_channels_in_several_units_are_refused(name):
    with pytest.raises(InvalidInput, match="'meters', 'millimeters'"):
        read_marker_info(foreign(name, "MoCap", [*positions("A"), *positions("B", "meters")]))


def loads(plate, force="newtons", moment="newtonmeters"):
    return [
        {"label": f"{plate}{kind}{axis}", "type": f"{kind}{axis}", "unit": unit, "plate": plate}
        for kind, unit in (("Force", force), ("Moment", moment))
        for axis in "XYZ"
    ]


def plates_of(name, channels, *described):
    info = foreign(plates_name(name), "ForcePlate", channels, 1000.0)
    listed = info.desc().append_child("plates")
    for k, plate in enumerate(described):
        entry = listed.append_child("plate")
        entry.append_child_value("name", plate)
        entry.append_child_value("origin_m", f"{k} 0 0")
    return read_plates_info(info)


def test_channels_belong_to_the_plate_that_they_name(name):
    plates, layout = plates_of(name, [*loads("B"), *loads("A")], "A", "B")
    assert [plate.name for plate in plates] == ["A", "B"]
    np.testing.assert_array_equal(layout.wrenches(np.arange(12.0)[None])[0, 0], np.arange(6, 12))
    with pytest.raises(InvalidInput, match="channels of plates B, C and describes A, B"):
        plates_of(name, [*loads("B"), *loads("C")], "A", "B")


def test_plates_are_in_their_units(name):
    _, layout = plates_of(name, loads("A", "kN", "N mm"), "A")
    np.testing.assert_allclose(layout.wrenches(np.ones((1, 6)))[0, 0], [1e3, 1e3, 1e3, 1e-3, 1e-3, 1e-3])
    with pytest.raises(InvalidInput, match="moments in 'pound feet'"):
        plates_of(name, loads("A", "N", "pound feet"), "A")


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
    assert source.read(0.3) is None
    again = LslPlayer(made, name)
    thread = play(again, made, 4.0)
    numbers = np.array([frame.number for frame in read(source, 30)])
    assert numbers[0] > 29 and (numbers - numbers[0]).tolist() == list(range(30))
    thread.join()
    again.close()
    source.close()
    assert {"markers gone", "markers back"} <= {kind for kind, _ in source.news()}


def test_a_stream_that_returns_with_other_markers_is_refused(name):
    made = played(replace(CAPTURE, plates=()))
    player, source = LslPlayer(made, name), LslSource(name)
    connected(source)
    assert source.read(0.1) is None
    player.close()
    other = MarkerTrajectories(("A", "B"), np.zeros((5, 2, 3)), 100.0)
    again = LslPlayer(played(replace(CAPTURE, markers=other, plates=())), name)
    news = events(source, "refused")
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
    assert source.read(0.1) is None  # nothing is received before
    until(outlet.have_consumers)
    begin = PYLSL.local_clock()
    for number in (0, 1, 2, 5, 6):
        outlet.push_sample([0.0, 1000.0, 0.0, 0.0, 0.0, 500.0 + number], begin + number / 100.0)
    frames = read(source, 5)
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
    results = LslResults(ResultValues(model), name, 100.0)
    (info,) = until(lambda: PYLSL.resolve_byprop("name", name, 1, 5.0))
    inlet = PYLSL.StreamInlet(info, as_numpy=True)
    inlet.open_stream(PATIENCE_S)
    entry = inlet.info(PATIENCE_S).desc().child("channels").child("channel")
    assert (entry.child_value("label"), entry.child_value("unit")) == ("pelvis_tilt", "rad")
    verdict = Verdict.of([Reason("pelvis", "look", "9 mm off", "it may be loose", "look at it")])
    frame = replace(shown_frame(model), judgement=Judgement(verdict, 1.5))
    (told,) = until(lambda: PYLSL.resolve_byprop("name", name + VERDICT_SUFFIX, 1, 5.0))
    words = PYLSL.StreamInlet(told)
    words.open_stream(PATIENCE_S)
    until(lambda: results._outlet.have_consumers() and results._verdicts.have_consumers())
    results.take(frame)
    sample, _ = inlet.pull_sample(PATIENCE_S)
    assert words.pull_sample(PATIENCE_S)[0] == [verdict.line]
    results.close()
    np.testing.assert_array_equal(sample[:-3], ResultValues(model).row(frame))
    np.testing.assert_array_equal(sample[-3:], [frame.number, 1.0, frame.latency_s])


def test_a_stream_chosen_among_several_is_reported(monkeypatch):
    def found(*names):
        infos = [SimpleNamespace(name=lambda n=n: n, hostname=lambda n=n: f"pc-{n}") for n in names]
        monkeypatch.setattr("mbkf.stream.lsl.source.streams_of", lambda *_: infos)
        monkeypatch.setattr(LslSource, "_connected", lambda self, info: info.name())
        source = LslSource(None, None)
        return source.connect(0.1), source.news()

    assert found("a") == ("a", [])
    chosen, ((kind, sentence),) = found("a", "b")
    assert (chosen, kind) == ("a", "chosen")
    assert sentence.startswith("2 marker streams were found: 'a' from pc-a is followed, not 'b' from pc-b")
