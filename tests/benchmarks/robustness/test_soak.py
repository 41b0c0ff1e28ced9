"""A long run's laps go on counting, its memory is watched from when it is warm, and its rows are bounded."""

import io
import json
import os
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import robustness
from benchmarks.checks import Context
from benchmarks.robustness import soak
from benchmarks.robustness.stream_child import ACCOUNTS
from mbkf.errors import InvalidInput
from mbkf.stream.played import played
from tests.captures import made_capture
from tests.waiting import until


class Wire:
    """Keeps what is sent."""

    def __init__(self):
        self.sent, self.acts = [], []

    def listening(self):
        return True

    def send(self, one):
        self.sent.append(one)
        return True

    def __getattr__(self, name):
        return lambda: self.acts.append(name)


def test_laps_go_on_counting(monkeypatch):
    monkeypatch.setattr(soak.time, "sleep", lambda _: None)
    walk, wire = played(made_capture(260)), Wire()
    laps = soak.Laps(walk, wire, 0)
    laps._names = ["markers infinite"]
    for lap in range(3):
        laps._lap(lap)
    assert [one.number for one in wire.sent] == list(range(3 * 260))
    assert {one.plates_ahead for one in wire.sent} == {0.0, 2600.0, 5200.0}
    assert (laps.sent, laps.faults) == (780, {"markers infinite": 2})
    assert np.isinf(wire.sent[350].markers_m).any() and not np.isinf(wire.sent[90].markers_m).any()
    again = soak.Laps(walk, wire, 0)
    assert len(again._names) >= 30 and not soak.FINAL & set(again._names)


def test_memory_is_compared_with_that_of_a_warm_run(monkeypatch):
    monkeypatch.setattr(soak, "WARM_SHARE", 0.0)
    memory = soak.Memory(os.getpid(), 1.0)
    until(lambda: memory.bytes)
    memory.end()
    assert memory.bytes[0] > 2**20
    memory.bytes = [100, 104, 97]
    assert memory.growth == pytest.approx(0.04)
    memory.bytes = []
    assert np.isnan(memory.growth)


def test_frames_that_are_in_no_count_break_the_bound(tmp_path, monkeypatch):
    rows = np.zeros(5, dtype=[("latency_s", float)])
    rows["latency_s"][4] = np.nan
    monkeypatch.setattr(soak, "read_live_log", lambda _: SimpleNamespace(rows=rows))
    report = dict.fromkeys(ACCOUNTS, 0) | {"frames_written": 4, "frames_late": 2, "frames_in": 6}
    report |= {"frames_lost_on_the_way": 1, "starts": 1}
    laps = SimpleNamespace(faults={"a": 2}, sent=6)
    memory, readers = SimpleNamespace(growth=0.01, bytes=[2**20]), SimpleNamespace(messages=9, lines=[])

    def told(**change):
        (tmp_path / "live.json").write_text(json.dumps(report | change))
        checks = soak._rows(tmp_path, 0, laps, memory, readers, 1.0)
        return {check.name.split(": ")[1]: check for check in checks}

    assert all(check.passed for check in told().values())
    assert told(frames_late=1)["frames not accounted for"].value == 1
    assert told(frames_written=3, frames_late=3)["frames not accounted for"].value == 1
    assert told(frames_in=8, frames_late=4)["frames not accounted for"].value == 2


def test_readers_take_addresses_from_what_is_said():
    readers = soak.Readers(io.StringIO("waiting\npage: http://127.0.0.1:1/\nresults: ws://127.0.0.1:1/\n"))
    until(lambda: len(readers.lines) >= 3)
    assert readers.messages == 0


@pytest.mark.parametrize("minutes", [0.0, -1.0, float("nan")])
def test_a_time_that_is_none_is_refused(tmp_path, minutes):
    with pytest.raises(InvalidInput, match="--minutes"):
        robustness.run(Context(None, tmp_path, minutes=minutes))
