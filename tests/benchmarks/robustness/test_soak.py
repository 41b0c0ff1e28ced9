"""What a long run counts is judged exactly, and its frames go on for ever."""

from itertools import islice

import numpy as np
import pytest

from benchmarks.robustness.faults import Send
from benchmarks.robustness.soak import FAULT_EVERY, LOOK_S, WARM_S, endless, memory_mb, steps, told
from mbkf.pipelines.synth import synthesise
from mbkf.stream.played import played


@pytest.fixture(scope="module")
def capture():
    return played(synthesise("squat", seconds=1.0)[1].trial)


def test_frames_and_samples_are_counted_on(capture):
    found = list(islice(endless(capture), 200))
    assert [frame.number for frame in found] == list(range(200))
    index = np.concatenate([frame.plates.index for frame in found])
    np.testing.assert_array_equal(index, np.arange(len(index)))
    np.testing.assert_array_equal(found[0].markers_m, capture.markers_m[1])


def test_a_fault_comes_every_while_and_frames_go_on(capture):
    found = list(islice(steps(capture, np.random.default_rng(0)), 3 * FAULT_EVERY))
    frames = [step.frame.number for step in found if isinstance(step, Send)]
    assert frames[: FAULT_EVERY // 2] == list(range(FAULT_EVERY // 2))
    assert max(frames) > FAULT_EVERY


def report(**more):
    counts = {"written": 90, "not_written": 0, "overwritten": 4, "late": 5, "unanswered": 1}
    return {"frames_in": 100, "frames_lost": 7, **{f"frames_{k}": v for k, v in counts.items()}, **more}


@pytest.mark.parametrize(
    ("changes", "sent", "last_mb", "code", "broken"),
    [
        ({}, 100, 205.0, 0, set()),
        ({"frames_in": 101}, 101, 205.0, 0, {"live: frames not accounted for"}),
        ({}, 99, 205.0, 0, {"live: frames not accounted for"}),
        ({}, 100, 220.0, 0, {"live: memory at the end over that when warm, at most"}),
        ({}, 100, 180.0, 0, {"live: memory at the end over that when warm, at least"}),
        ({}, 100, 200.0, 1, {"live: exit code"}),
    ],
)
def test_what_is_lost_or_grows_breaks_its_bound(changes, sent, last_mb, code, broken):
    memory = [100.0] * round(WARM_S / LOOK_S) + [200.0, last_mb]
    checks = told(report(**changes), sent, memory, code)
    assert {check.name for check in checks if not check.passed} == broken


def test_a_process_has_memory(capture):
    import os

    assert len(capture) and (np.isnan(memory_mb(2**30)) and memory_mb(os.getpid()) > 10.0)
