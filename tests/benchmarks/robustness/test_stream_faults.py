"""Faults of streams are the same from the same seed, and what becomes of a run is told in bounded rows."""

import pickle

import pytest

from benchmarks.robustness import stream_faults
from benchmarks.robustness.stream_kinds import KINDS, LSL, NATNET
from benchmarks.robustness.stream_schedule import Schedule, Sent
from benchmarks.robustness.stream_wire import LslWire, NatNetWire
from mbkf.stream.played import played
from tests.captures import made_capture

WALK = played(made_capture(260))


def disturbed(name, seed):
    schedule = Schedule(WALK, seed)
    KINDS[name].fault(schedule)
    return schedule


def plain(schedule):
    return pickle.dumps(schedule.items()), schedule.counted, schedule.whole


UNDISTURBED = plain(Schedule(WALK, 3))


def test_there_are_thirty_of_each_protocol():
    assert all(sum(protocol in kind.protocols for kind in KINDS.values()) >= 30 for protocol in (LSL, NATNET))


@pytest.mark.parametrize("name", KINDS)
def test_a_seed_disturbs_always_alike_and_differs_from_an_undisturbed_stream(name):
    once, again = disturbed(name, 3), disturbed(name, 3)
    assert plain(once) == plain(again) != UNDISTURBED
    items = once.items()
    assert items == sorted(items, key=lambda item: item.at_s)
    for item in once.others:
        what = getattr(item, "what", "packet")
        assert any(hasattr(wire, what) for wire in (LslWire, NatNetWire))
    first = items[0]
    assert isinstance(first, Sent) and first.frame in (0, 9), "the beginning is undisturbed"


def test_each_fault_is_played_so_often_over_each_of_its_protocols():
    jobs = stream_faults.chunks(3, False, 0)
    words = [f"{protocol} {word}" for protocol, some in jobs for word in some]
    assert len(words) == len(set(words)) == 3 * sum(len(kind.protocols) for kind in KINDS.values())
    assert max(len(some) for _, some in jobs) <= stream_faults.CHUNK
    seeds = [word.rsplit(":", 1)[1] for word in words]
    assert len(set(seeds)) == len(seeds)
    once = stream_faults.chunks(1, True, 0)
    assert sum(len(some) for _, some in once) == len(KINDS)


def test_what_failed_is_counted_and_named():
    fine = {"died": [], "unaccounted": 0, "problem": None, "tracked": True}
    found = {
        "lsl a:1": fine,
        "lsl b:2": fine | {"died": ["mbkf-reader"]},
        "natnet b:3": fine | {"unaccounted": 7},
        "natnet c:4": fine | {"problem": "none", "tracked": False},
    }
    checks = {check.name: check for check in stream_faults.rows(found)}
    values = {name.split(": ")[1]: check.value for name, check in checks.items() if check.bounded}
    assert values == {
        "threads died": 1,
        "frames not accounted for": 7,
        "runs without results": 1,
        "runs not tracked at their end": 1,
    }
    assert not any(check.passed for check in checks.values() if check.bounded)
    assert any(name.startswith("lsl b:2: ") for name in checks)


DYING = """
import json, os, sys
done, dies = sys.argv[3:5]
for told in ({"begin": done}, {"end": done, "died": []}, {"begin": dies}):
    print(json.dumps(told), flush=True)
os._exit(1)
"""


def test_a_process_that_dies_is_replaced_for_the_next(tmp_path, monkeypatch):
    """Each follows its first run, and dies of its second."""
    (tmp_path / "dying.py").write_text(DYING)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    words = [f"count negative:{seed}" for seed in range(4)]
    found = stream_faults.follow((NATNET, words), tmp_path, "dying")
    dead = ["the process died or hung"]
    assert [found[f"natnet {word}"]["died"] for word in words] == [[], dead, [], dead]
