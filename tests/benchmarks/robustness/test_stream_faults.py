"""Faults are thirty and more, the same from the same seed, and leave the frames before and after as they are."""

import numpy as np
import pytest

from benchmarks.robustness import stream_faults
from benchmarks.robustness.cameras import CAMERAS
from benchmarks.robustness.faults import FAULTS, Send
from benchmarks.robustness.stream_faults import BEGINS, DEAD, ENDS, HELD, HUNG, LOST, steps, told
from mbkf.io.capture import read_capture
from mbkf.pipelines.synth import synthesise, write_folder
from mbkf.stream.played import played


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("streams")
    write_folder(*synthesise("walk", seconds=stream_faults.SECONDS), folder / "walk")
    return folder


@pytest.fixture(scope="module")
def capture(walk):
    return played(read_capture(walk / "walk" / "trial.c3d"))


def test_there_are_thirty_besides_none():
    assert len(FAULTS) >= 31 and set(CAMERAS) == {"lsl", "natnet"}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_in_the_middle_and_the_same_from_the_same_seed(capture, name):
    first, again = (list(steps(capture, FAULTS[name], 3)) for _ in range(2))
    assert [type(step) for step in first] == [type(step) for step in again]
    for one, other in zip(first, again, strict=True):
        if isinstance(one, Send):
            np.testing.assert_array_equal(one.frame.markers_m, other.frame.markers_m)
            assert one.number == other.number or np.isnan(one.number)
    before, after = first[:BEGINS], first[-(len(capture) - ENDS) :]
    for part, numbers in ((before, range(BEGINS)), (after, range(ENDS, len(capture)))):
        assert [step.number for step in part] == list(numbers)
    middle = first[BEGINS : len(first) - len(after)]
    frames = list(capture.frames())[BEGINS:ENDS]
    unchanged = len(middle) == len(frames) and all(
        isinstance(step, Send)
        and step.number == frame.number
        and np.array_equal(step.frame.markers_m, frame.markers_m, equal_nan=True)
        and np.array_equal(step.frame.plates.wrench, frame.plates.wrench, equal_nan=True)
        and np.array_equal(step.frame.plates.index, frame.plates.index)
        for step, frame in zip(middle, frames, strict=True)
    )
    assert unchanged == (name == "nothing")


@pytest.mark.slow
@pytest.mark.parametrize("protocol", CAMERAS)
def test_a_run_holds_and_one_that_does_not_is_told(walk, protocol, monkeypatch, capsys):
    if protocol == "lsl":
        pytest.importorskip("pylsl")
    stream_faults.main([str(walk), f"{protocol}:count far:5"])
    assert capsys.readouterr().out == f"end {protocol}:count far:5 = {HELD}\n"
    monkeypatch.setattr(stream_faults, "PLACES", ("written",))
    stream_faults.main([str(walk), f"{protocol}:count stands:5"])
    assert f" = {LOST}: " in capsys.readouterr().out


def test_every_failure_breaks_its_bound():
    checks = told({"a": HELD, "b": f"{DEAD}: x", "c": f"{LOST}: y", "d": HUNG})
    assert [check.value for check in checks[:4]] == [4.0, 1.0, 1.0, 1.0]
    assert [check.passed for check in checks[:4]] == [True, False, False, False]
    assert len(checks) == 7
