"""Senders are the same from the same seed; what became of their frames is judged by what was sent."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.misuse import senders
from benchmarks.misuse.senders.judging import (
    SentFrame,
    first_live_s,
    frames_in,
    unaccounted,
    wrong_loads,
    wrong_numbers,
)
from benchmarks.misuse.senders.kinds import KINDS, scheduled
from benchmarks.misuse.senders.wires import ReorderedLslWire, ReorderedNatNetWire, reversed_plates
from benchmarks.robustness.stream_kinds import LSL, NATNET
from benchmarks.robustness.stream_schedule import Act, Sent
from mbkf.stream.played import played
from tests.captures import made_capture

WALK = played(made_capture(260))
SENT = [SentFrame(n, n, n / 100.0) for n in range(5)]
FINE = dict.fromkeys(("frames_late", "frames_overwritten", "frames_not_written", "frames_unanswered"), 0)


def items(name, seed):
    return scheduled(name, WALK, seed).items()


def plain(item):
    return (item.at_s, item.frame, item.number, item.stamp_s) if isinstance(item, Sent) else (item.at_s, item)


@pytest.mark.parametrize("name", KINDS)
def test_a_kind_sends_the_same_from_the_same_seed_in_the_order_of_time(name):
    one, again = [[plain(item) for item in items(name, 3)] for _ in range(2)]
    assert repr(one) == repr(again)  # NaN equals itself as text
    times = [item.at_s for item in items(name, 3)]
    assert times == sorted(times) and len(times) > 150


@pytest.mark.parametrize("name", KINDS)
def test_what_becomes_of_a_connection_is_an_act_of_its_wire(name):
    wire = ReorderedLslWire if KINDS[name].protocol == LSL else ReorderedNatNetWire
    for item in items(name, 0):
        assert not isinstance(item, Act) or callable(getattr(wire, item.what))


def test_there_are_thirty_kinds_of_both_protocols():
    assert len(KINDS) == 30 and {kind.protocol for kind in KINDS.values()} == {LSL, NATNET}
    words = [word for _, some in senders.chunks(3, 0) for word in some]
    assert len(words) == len(set(words)) == 90


def test_frames_are_known_by_their_markers():
    rows = np.concatenate(
        [WALK.markers_m[[4, 2]], WALK.markers_m[:1] + 1.0, np.full_like(WALK.markers_m[:1], np.nan)]
    )
    rows[0, 3] = np.nan
    assert frames_in(rows, WALK.markers_m).tolist() == [4, 2, -2, -1]
    assert frames_in(WALK.markers_m[3:4, ::-1], WALK.markers_m).tolist() == [-2]


@pytest.mark.parametrize(
    ("numbers", "frames", "wrong"),
    [
        ([7, 8, 9, 10, 11], [0, 1, 2, 3, 4], 0),
        ([7, 8, 10, 11, 12], [0, 1, 2, 3, 4], 3),
        ([7, 8, 9, 10, 11], [0, 1, -1, 3, 4], 0),
        ([7, 8, 9, 10, 11], [0, 1, -2, 3, 4], 1),
    ],
)
def test_numbers_are_compared_with_those_that_were_due(numbers, frames, wrong):
    assert wrong_numbers(np.array(numbers), np.array(frames), SENT, 0) == wrong
    assert wrong_numbers(np.array(numbers), np.array(frames), SENT, 1) == (np.array(frames) == -2).sum()


def test_a_frame_that_was_sent_is_written_or_counted():
    frames = np.array([0, 1, 2, 4])
    assert unaccounted({**FINE, "frames_lost_on_the_way": 1}, frames, SENT, whole=True) == 1
    assert unaccounted({**FINE, "frames_lost_on_the_way": 1}, frames, SENT, whole=False) == 0
    assert unaccounted({**FINE, "frames_late": 1, "frames_lost_on_the_way": 0}, frames, SENT, whole=True) == 0
    assert unaccounted({**FINE, "frames_lost_on_the_way": 0}, frames, SENT, whole=False) == 1


def test_readings_are_compared_where_both_are_there():
    found = WALK.wrench[:50].copy()
    found[3:5] = np.nan
    assert wrong_loads(found, WALK.wrench) == 0
    assert wrong_loads(np.roll(found, 1, axis=2), WALK.wrench) == 48


def test_the_first_live_answer_is_the_first_that_comes_soon_after_its_frame():
    answers = [(0.5, 0), (0.52, 1), (0.56, 2), (0.57, 3)]
    sent = [replace(one, at_s=0.4 + one.at_s * 10.0) for one in SENT]  # 0.4, 0.5, 0.6 …
    assert first_live_s(answers, sent, 0.4) == pytest.approx(0.12)
    assert first_live_s([(2.0, 0)], sent, 0.4) == float("inf")


def test_rows_name_what_failed():
    fine = {
        "died": [],
        "unaccounted": 0,
        "wrong numbers": 0,
        "wrong loads": 0,
        "unreported": 0,
        "first live answer": 0.5,
    }
    checks = list(senders.judged({"lsl a:1": fine, "lsl b:2": {**fine, "wrong loads": 3}}))
    assert [check.value for check in checks if check.bounded] == [0.0, 0.0, 0.0, 3.0, 0.0, 0.5]
    assert any("lsl b:2: 3 wrong loads" in check.name for check in checks)
    late = list(senders.judged({"lsl a:1": {"died": ["hung"]}}))
    assert late[0].value == 1.0 and late[5].value == float("inf")


def test_reversed_plates_keep_the_names_of_their_places():
    plates = WALK.stream.plates
    assert [plate.name for plate in reversed_plates(plates)] == [plate.name for plate in plates]
    np.testing.assert_array_equal(reversed_plates(plates)[0].origin_m, plates[-1].origin_m)
