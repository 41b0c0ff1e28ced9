"""The live page as a sink: takes frames without waiting, tells the page what it needs, draws the newest."""

import json
from dataclasses import replace

import numpy as np
import pytest
from websockets.sync.client import connect

from mbkf.errors import InvalidInput
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.verdict import Reason, Verdict
from mbkf.stream.results.judgement import Judgement
from mbkf.viz.live.page import LivePage
from tests.motions import assert_near
from tests.recordings import PLATE, walk, walker
from tests.viz.streams import feeding, frame
from tests.waiting import PATIENCE_S


@pytest.fixture
def live():
    made = LivePage(walker()[1], walk().marker_names, PLATE[None], title="a walk")
    yield made
    made.close()


def socket_of(live):
    return connect("ws" + live.url[4:] + "frames")


def rows_of(socket, count):
    return [np.frombuffer(socket.recv(PATIENCE_S), "<f4") for _ in range(count)]


def test_the_greeting_describes_the_rows_that_follow(live):
    live.take(frame(7))
    with socket_of(live) as socket:
        scene = json.loads(socket.recv(PATIENCE_S))
        (row,) = rows_of(socket, 1)
    assert scene["title"] == "a walk" and scene["plates"] == [PLATE.tolist()]
    assert len(row) == scene["width"]
    knee = next(q for q in scene["quantities"] if q["id"] == "angle:knee_angle_r")
    assert row[knee["column"]] * knee["factor"] == pytest.approx(
        np.rad2deg(walk().angle("knee_angle_r")[7]), 1e-5
    )
    status = dict(zip(scene["status"], row, strict=False))
    assert (status["number"], status["lost"], status["tracked"]) == (7, 0, 1)
    assert status["latency_ms"] == pytest.approx(1.5)


def test_rows_follow_the_stream_and_leave_frames_out(live):
    with feeding(live, 0.002), socket_of(live) as socket:
        socket.recv(PATIENCE_S)
        numbers = [row[1] for row in rows_of(socket, 8)]
    assert (np.diff(numbers) > 1).any() and (np.diff(numbers) > 0).all()


def test_nothing_is_computed_while_nobody_looks(live):
    made = []
    rows = live._rows.row
    live._rows.row = lambda f: (made.append(f.number), rows(f))[1]
    for k in range(300):
        live.take(frame(k))
    assert made == []
    with socket_of(live) as socket:
        socket.recv(PATIENCE_S)
        socket.recv(PATIENCE_S)
    assert made == [299]


def test_pages_share_one_row(live):
    live.take(frame(3))
    with socket_of(live) as one, socket_of(live) as two:
        for socket in (one, two):
            socket.recv(PATIENCE_S)
        assert_near(rows_of(one, 1)[0], rows_of(two, 1)[0], 0.0)


def test_an_address_that_is_not_ours_is_refused():
    with pytest.raises(InvalidInput, match=r"192\.0\.2\.1"):
        LivePage(walker()[1], walk().marker_names, address="192.0.2.1")


def test_the_judgement_of_the_run_is_sent_when_it_changes(live):
    verdict = Verdict.of([Reason("left_leg", "look", "9 mm off", "it may be loose", "look at it")])
    doubt = LimbDoubt("left_thigh", "turned over", 0.4, 0.5, mended=True, right_from_s=0.5)
    judgement = Judgement(verdict, 1.5, (doubt,))
    live.take(replace(frame(3), judgement=judgement))
    with socket_of(live) as socket:
        socket.recv(PATIENCE_S)
        told = json.loads(socket.recv(PATIENCE_S))["judgement"]
        assert told["line"] == verdict.line and told["limb_doubts"][0]["sentence"] == doubt.sentence
        assert isinstance(socket.recv(PATIENCE_S), bytes)
        live.take(replace(frame(4), judgement=judgement))
        assert isinstance(socket.recv(PATIENCE_S), bytes)
        live.take(replace(frame(5), judgement=Judgement(Verdict(), 2.5)))
        assert json.loads(socket.recv(PATIENCE_S))["judgement"]["overall"] == "use"
