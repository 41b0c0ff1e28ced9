"""Results over WebSocket: names first, then the newest frame; strangers are refused."""

import json
import socket
import time
from dataclasses import replace

import numpy as np
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from mbkf.errors import InvalidInput
from mbkf.io.verdict import Reason, Verdict
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.stream.results import values as values_module
from mbkf.stream.results.frame import LiveFrame
from mbkf.stream.results.judgement import Judgement
from mbkf.stream.results.values import ResultValues
from mbkf.stream.results.websocket import WebSocketResults, parse_address
from tests.waiting import PATIENCE_S

MODEL = HumanModel.scaled(mass_kg=75.0)


def shown_frame(model, number=0, followed=True):
    rng = np.random.default_rng(number)
    nv = model.nv
    q = model.integrate(model.neutral(), rng.normal(0.0, 0.2, nv))
    return LiveFrame(
        number=number,
        time_s=number / 100.0,
        q=q if followed else np.full(model.nq, np.nan),
        v=rng.normal(size=nv),
        torques=rng.normal(size=nv),
        torques_sd=rng.uniform(1.0, 2.0, nv),
        wrench=rng.normal(size=(2, 6)),
        wrench_sd=np.full((2, 6), np.nan),
        plates=np.zeros((1, 6)),
        measured_m=np.zeros((3, 3)),
        predicted_m=np.zeros((3, 3)),
        unlabelled_m=np.zeros((0, 3)),
        angle_sd=rng.uniform(0.01, 0.02, nv),
        angle_offset=rng.uniform(0.0, 0.01, nv),
        torques_offset=rng.uniform(0.0, 1.0, nv),
        wrench_offset=rng.uniform(0.0, 1.0, (2, 6)),
        latency_s=0.002,
        lost=0,
        rate_hz=100.0,
        tracked=followed,
        started=False,
    )


@pytest.fixture
def served():
    results = WebSocketResults(ResultValues(MODEL), "127.0.0.1", 0)
    yield results
    results.close()


def next_frame(client, results, frame):
    """The next message after the frame was taken, given again until it is there."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        results.take(frame)
        try:
            return json.loads(client.recv(timeout=0.2))
        except TimeoutError:
            continue
    raise AssertionError("nothing came")


def test_values_are_clinical_and_carry_their_spread():
    values, clinical = ResultValues(MODEL), ClinicalAngles(MODEL)
    frame = shown_frame(MODEL)
    row = dict(zip(values.names, values.row(frame), strict=True))
    angles = clinical.angles(frame.q[None])
    moments = clinical.moments(frame.q[None], frame.torques[None], angles)[0]
    k = clinical.names.index("knee_angle_r")
    assert row["knee_angle_r"] == angles[0, k]
    assert row["knee_angle_r_moment"] == moments[k]
    assert row["knee_angle_r_sd"] == frame.angle_sd[k]
    assert row["reaction_r_fz"] == frame.wrench[0, 2]
    assert row["reaction_l_mx"] == frame.wrench[1, 3]
    assert np.isnan(row["reaction_l_mx_sd"])
    # m = Bᵀ τ is linear, so the spread of moments follows from unit torques.
    B = np.array([clinical.moments(frame.q[None], unit[None], angles)[0] for unit in np.eye(MODEL.nv)])
    expected = np.sqrt(B.T**2 @ frame.torques_sd**2)
    found = [row[f"{name}_moment_sd"] for name in clinical.names]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    assert row["knee_angle_r_sd_offset"] == frame.angle_offset[k]
    assert row["reaction_l_mx_sd_offset"] == frame.wrench_offset[1, 3]
    found = [row[f"{name}_moment_sd_offset"] for name in clinical.names]
    np.testing.assert_allclose(found, np.sqrt(B.T**2 @ frame.torques_offset**2), atol=1e-12)
    assert len(values.units) == len(values.names) == len(set(values.names))


def test_receivers_that_share_the_values_compute_each_row_once(monkeypatch):
    values, computed, once = ResultValues(MODEL), [], ResultValues._computed
    monkeypatch.setattr(ResultValues, "_computed", lambda *both: computed.append(both[1]) or once(*both))
    frames = [shown_frame(MODEL, k) for k in range(values_module.HELD + 1)]
    rows = [values.row(frame) for frame in frames]
    assert values.row(frames[-1]) is rows[-1] and values.row(frames[1]) is rows[1]  # a receiver that lags
    assert len(computed) == len(frames)
    assert values.row(frames[0]) is not rows[0]  # one that lags too far
    np.testing.assert_array_equal(values.row(frames[0]), rows[0])


def test_where_nobody_is_followed_there_are_no_angles():
    row = ResultValues(MODEL).row(shown_frame(MODEL, followed=False))
    assert np.isnan(row[: 4 * MODEL.nv]).all()
    assert np.isfinite(row[4 * MODEL.nv : 4 * MODEL.nv + 12]).all()
    values = ResultValues(MODEL)
    named = dict(zip(values.names, row, strict=True))
    offsets = {name for name in values.names if name.endswith("_sd_offset")}
    for name in offsets:
        assert np.isfinite(named[name]) == name.startswith("reaction_")


def test_declared_estimates_stand_last_and_are_unknown_where_a_frame_lacks_them():
    values = ResultValues(MODEL)
    plain = values.row(shown_frame(MODEL))
    frame = replace(shown_frame(MODEL), plotted={"step_seconds": np.array(0.002)})
    row = dict(zip(values.names, values.row(frame), strict=True))
    assert row["step_seconds"] == 0.002
    assert values.units[values.names.index("step_seconds")] == "s"
    last = values.names.index("step_seconds")
    assert not any(name.startswith("reaction_") for name in values.names[last:])
    assert np.isnan(plain[last])


def test_a_client_gets_names_and_then_frames(served):
    with connect(served.url) as client:
        greeting = json.loads(client.recv(timeout=PATIENCE_S))
        assert greeting["names"][0] == "pelvis_tilt"
        assert len(greeting["units"]) == len(greeting["names"])
        message = next_frame(client, served, shown_frame(MODEL, 7))
    expected = ResultValues(MODEL).row(shown_frame(MODEL, 7))
    assert (message["frame"], message["tracked"]) == (7, True)
    found = np.array(message["values"], dtype=float)
    np.testing.assert_array_equal(found, expected)


def test_a_client_may_leave_and_come_back(served):
    for number in range(2):
        with connect(served.url) as client:
            client.recv(timeout=PATIENCE_S)
            assert next_frame(client, served, shown_frame(MODEL, number))["frame"] in (0, number)


def test_a_page_of_another_site_may_not_listen(served):
    with pytest.raises(InvalidStatus, match="403"):
        connect(served.url, origin="https://example.org")
    with pytest.raises(InvalidStatus, match="403"):
        connect(served.url, origin="null")
    with connect(served.url, origin="http://localhost:8000") as client:
        assert client.recv(timeout=PATIENCE_S)


def test_a_name_that_is_not_this_computers_is_refused(served):
    """A page may have given its own name this computer's address; its browser then asks for that name."""
    port = served.url.split(":")[2].strip("/")
    for host in (f"evil.example:{port}", "[", ""):
        with socket.create_connection(("127.0.0.1", int(port)), timeout=PATIENCE_S) as one:
            asked = f"GET / HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            one.sendall(
                f"{asked}Sec-WebSocket-Key: {16 * 'A'}==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
            )
            assert one.recv(100).startswith(b"HTTP/1.1 403")


def test_another_address_needs_a_token():
    results = WebSocketResults(ResultValues(MODEL), "0.0.0.0", 0)
    try:
        address, _, token = results.url.partition("?token=")
        assert len(token) > 16
        with pytest.raises(InvalidStatus, match="403"):
            connect(address)
        with pytest.raises(InvalidStatus, match="403"):
            connect(f"{address}?token=wrong")
        with connect(results.url) as client:
            assert client.recv(timeout=PATIENCE_S)
    finally:
        results.close()


def test_a_port_that_is_taken_is_refused(served):
    port = int(served.url.split(":")[2].strip("/"))
    with pytest.raises(InvalidInput, match="cannot listen"):
        WebSocketResults(ResultValues(MODEL), "127.0.0.1", port)


def test_addresses_are_read():
    assert parse_address("8765") == ("127.0.0.1", 8765)
    assert parse_address("0.0.0.0:80") == ("0.0.0.0", 80)
    for bad in ("", "x", "1:2:x", "99999"):
        with pytest.raises(InvalidInput, match="--websocket"):
            parse_address(bad)


def judged(word, number=0):
    reason = Reason("pelvis", word, "9 mm off", "it may be loose", "look at it")
    return replace(
        shown_frame(MODEL, number), valid=word == "use", judgement=Judgement(Verdict.of([reason]), 1.5)
    )


def test_the_running_verdict_stands_beside_the_values_as_numbers():
    values = ResultValues(MODEL)
    before, after = (
        dict(zip(values.names, values.row(one), strict=True)) for one in (shown_frame(MODEL), judged("look"))
    )
    assert np.isnan([before["verdict"], before["verdict_pelvis"]]).all() and before["valid"] == 0.0
    assert (after["verdict"], after["verdict_pelvis"], after["verdict_left_leg_loads"]) == (1.0, 1.0, 0.0)


def test_each_client_gets_a_judgement_once_and_its_word_with_every_frame(served):
    found = judged("look")
    for _ in range(2):
        with connect(served.url) as client:
            client.recv(timeout=PATIENCE_S)
            first = next_frame(client, served, found)
            assert (first["verdict"], first["valid"]) == ("look", False)
            assert (
                first["judgement"]["line"].startswith("look: pelvis") and first["judgement"]["time_s"] == 1.5
            )
            assert "judgement" not in next_frame(client, served, found)
            changed = next_frame(client, served, judged("do not use"))
            while changed["verdict"] == "look":  # frames given again
                changed = json.loads(client.recv(timeout=PATIENCE_S))
            assert changed["judgement"]["parts"]["pelvis"] == "do not use"
            assert next_frame(client, served, found)["frame"] == 0
