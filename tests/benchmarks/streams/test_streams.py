"""Disturbed streams are the same from the same seed; rows of latency subtract an idle process's delay."""

import numpy as np
import pytest

from benchmarks import streams
from benchmarks.checks import Context
from benchmarks.live.runs import Run, wire_of
from benchmarks.robustness.stream_schedule import Schedule
from benchmarks.streams import xsens
from benchmarks.streams.clients import ROWS, VARIABLE, client_rows
from benchmarks.streams.faults import FAULTS
from benchmarks.streams.results_out import START_FRAMES, _of_json, _of_osc, latencies_ms
from benchmarks.streams.scenes import MOTION, belt_walk
from benchmarks.streams.wires import WIRES
from mbkf.io.capture import read_capture
from mbkf.stream.played import played
from mbkf.stream.results.osc import OscBundles
from mbkf.stream.results.values import ResultValues
from mbkf.trial.synth import synthesise, write_folder
from tests.captures import made_capture
from tests.stream.reading import connected, read
from tests.stream.results.test_websocket import MODEL, shown_frame
from tests.waiting import until

WALK = played(made_capture(140))


@pytest.mark.parametrize("protocol", FAULTS)
def test_there_are_twenty_faults_and_each_disturbs_alike_from_one_seed(protocol):
    assert len(FAULTS[protocol]) >= 20
    plain = [(one.at_s, one.frame, one.number) for one in Schedule(WALK, 5).frames]
    for fault in FAULTS[protocol].values():
        once, again = Schedule(WALK, 5), Schedule(WALK, 5)
        fault(once)
        fault(again)
        assert len(once.items()) == len(again.items())
        sent = [(one.at_s, one.frame, one.number) for one in once.frames]
        values = [np.nansum(one.markers_m) for one in once.frames] != [
            np.nansum(one.markers_m) for one in Schedule(WALK, 5).frames
        ]
        loads = any(one.load is not None or not one.plates for one in once.frames)
        assert sent != plain or once.others or values or loads


@pytest.mark.parametrize("protocol", FAULTS)
def test_a_wire_and_its_source_know_each_other(protocol):
    wire = WIRES[protocol](WALK)
    source = wire.source()
    wire.listening()
    stream = connected(source)
    assert not wire.listening()
    until(lambda: source.read(0.01) or wire.listening())
    assert wire.send(Schedule(WALK, 0).frames[7])
    (frame,) = read(source, 1)
    assert frame.number == 7 and len(frame.markers_m) == len(stream.marker_names)
    wire.half()
    wire.packet(b"\0" * 10, stranger=False)
    wire.packet(b"\0" * 10, stranger=True)
    wire.close()
    assert not wire.send(Schedule(WALK, 0).frames[8])
    source.close()


@pytest.mark.parametrize("protocol", ROWS)
def test_clients_that_are_not_installed_leave_their_rows_out(protocol, tmp_path, monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    rows = list(client_rows(Context(None, tmp_path, True, None, None, 0, ()), protocol))
    assert [row.name for row in rows] == list(ROWS[protocol]) and all(row.left_out for row in rows)


def test_an_idle_process_is_subtracted(tmp_path):
    run = Run({"latency_ms_median": 1.5, "latency_ms_p99": 4.0}, tmp_path, np.array([0.2] * 98 + [2.0] * 2))
    rows = [row for row in streams.latency("x", run) if row.bounded]
    np.testing.assert_allclose([row.value for row in rows], [1.3, 2.0])
    assert [row.passed for row in rows] == [False, True]


def test_a_run_has_caught_up_with_its_first_soon_answer():
    times_s = 4.0 + 0.01 * np.arange(4)
    assert streams.caught_up_s(times_s, np.array([0.3, np.nan, 0.04, 0.002])) == pytest.approx(0.06)
    assert streams.caught_up_s(times_s, np.full(4, 0.3)) == np.inf


def test_each_protocol_has_a_receiver_and_a_sender():
    for protocol in ("lsl", "natnet", *FAULTS):
        wire = wire_of(protocol)
        assert wire.receive[1].startswith(protocol) and protocol in " ".join([*wire.send, *wire.send_options])


def test_results_are_matched_with_the_frames_that_were_sent():
    late = START_FRAMES
    sent, found = {late - 1: 0.0, late: 1.0, late + 1: 2.0}, {late - 1: 5.0, late: 1.004, late + 2: 9.0}
    np.testing.assert_allclose(latencies_ms(sent, found), [4.0])
    frame = shown_frame(MODEL, 7)
    values = ResultValues(MODEL)
    assert _of_osc(OscBundles(values.names).bundle(frame, values.row(frame))) == 7
    assert _of_osc(b"#bundle") is None and _of_json(b'{"names": []}') is None


def test_more_markers_stand_beside_those_of_the_body(tmp_path):
    subject, made = synthesise(MOTION, seconds=1.5, rate_hz=50.0)
    write_folder(subject, made, tmp_path / "belt-1.5s-50Hz")
    trial = belt_walk(tmp_path, 1.5, 50.0, markers=80)
    found = read_capture(trial.path)
    assert len(found.markers.names) == 80 and len(found.plates) == 2
    assert found.markers.names[:36] == made.trial.markers.names
    assert trial.seconds == pytest.approx(74 / 50) and not trial.unlabelled


def test_a_suit_followed_through_a_fault_of_its_datagrams(tmp_path):
    subject = xsens.synthesise_subject(xsens.SEED)
    model = xsens.body_of(subject)
    q = xsens.turning(model, 100.0)[:270]
    found = xsens.follow(subject, model, q, 100.0, tmp_path, xsens.FAULTS["lost samples"])
    assert not found.failure and found.report["frames_lost"] == 1 and found.tracked[-5:].all()
    assert xsens.worst_deg(model, found.q, q) < xsens.ANGLE_DEG
