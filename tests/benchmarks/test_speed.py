"""The speed benchmark's structure; how long anything takes is not tested."""

import numpy as np
import pytest

from benchmarks import speed
from benchmarks.checks import Context
from benchmarks.speed import offline
from benchmarks.speed.consumed import consumed
from benchmarks.speed.offline import Taken, repeated
from benchmarks.speed.products import Times, joined
from benchmarks.speed.start import started
from benchmarks.speed.steps import (
    INVERSE_DYNAMICS,
    NIS,
    RECORD,
    SPREADS,
    STEP,
    dynamic_times,
    kinematic_times,
)
from benchmarks.speed.walks import synthetic, with_plates
from mbkf.errors import InvalidInput

FRAMES_LEFT_OUT = 11


@pytest.fixture(scope="module")
def walk():
    return synthetic(speed.QUICK_SECONDS)


def test_a_quick_run_gives_the_bounded_ratios_and_their_parts(tmp_path):
    checks = speed.run(Context(None, tmp_path, quick=True))
    assert [check.name for check in checks if check.bounded] == [
        "frames: synthetic walk: dynamic step",
        "frames: synthetic walk: its 99th percentile over it",
        "frames: synthetic walk: all that a frame costs",
        "frames: synthetic walk: kinematic step and inverse dynamics",
    ]
    assert all(check.value > 0 for check in checks)
    by_name = {check.name.rpartition(": ")[2]: check.value for check in checks}
    assert by_name["all that a frame costs"] > by_name["dynamic step"]


def test_ratios_are_of_medians_of_sums():
    times = Times(np.array([1.0, 2.0, 9.0]), {"a": np.array([1.0, 5.0, 2.0]), "b": np.array([3.0, 0.0, 9.0])})
    assert times.in_products("a") == pytest.approx(1.0)
    assert times.in_products("a", "b") == pytest.approx(2.5)
    assert len(joined([times, times]).product) == 6


def test_all_frames_but_the_warm_up_are_timed(walk):
    times, frames = kinematic_times(walk, least=1), walk.capture.markers.frames
    assert set(times.parts) == {STEP, INVERSE_DYNAMICS}
    for seconds in (times.product, *times.parts.values()):
        assert len(seconds) == frames - FRAMES_LEFT_OUT
        assert (seconds > 0).all()


def test_the_dynamic_filter_is_timed_over_all_rounds(walk):
    once = walk.capture.markers.frames - FRAMES_LEFT_OUT
    times = dynamic_times(walk, least=once + 1)
    assert set(times.parts) == {STEP, NIS, SPREADS, RECORD}
    assert len(times.product) == 2 * once
    assert times.in_products(STEP, percentile=99.0) >= times.in_products(STEP) > 0


@pytest.mark.parametrize("markers", [20, 80])
def test_a_person_wears_as_many_markers_as_asked_and_is_followed(markers):
    walk = synthetic(speed.QUICK_SECONDS, markers)
    tracking, recording, _ = walk.dynamic()
    assert recording.markers_m.shape[1] == len(walk.subject.markers) == markers
    assert tracking.start(recording, 0, None) is not None


def test_further_plates_read_nothing(walk):
    own = len(walk.capture.plates)
    more = with_plates(walk, own + 2)
    assert [plate.name for plate in more.capture.plates[own:]] == ["far 1", "far 2"]
    _, recording, _ = more.dynamic()
    assert recording.plates.shape[1] == own + 2
    assert not recording.plates[:, own:].any()
    assert len(with_plates(walk, 1).capture.plates) == 1


def test_a_long_trial_is_a_short_one_forwards_and_backwards(walk):
    """Plates and markers turn at the same time in every lap."""
    own = walk.capture.markers.positions_m
    last = len(own) - 1
    long = repeated(walk.capture, 3 * last + 1)
    expected = np.concatenate([own, own[-2::-1], own[1:]])
    np.testing.assert_array_equal(long.markers.positions_m, expected)
    plate, again = walk.capture.plates[0], long.plates[0]
    ratio = round(plate.rate_hz / long.markers.rate_hz)
    assert len(again.force_n) == ratio * (3 * last + 1)
    for frame, seen in ((last, last), (2 * last, 0), (2 * last + 7, 7)):
        np.testing.assert_array_equal(again.force_n[ratio * frame], plate.force_n[ratio * seen])


def test_memory_of_an_hour_is_that_of_its_frames(tmp_path, monkeypatch):
    """A frame more costs as much in an hour as between the two lengths."""
    monkeypatch.setattr(offline, "_written", lambda folder, motion, rate_hz, minutes: minutes)
    taken = {
        1.0: Taken(12.0, 100.0, 12_000),
        3.0: Taken(54.0, 340.0, 36_000),
        6.0: Taken(99.0, 700.0, 72_000),
        60.0: Taken(720.0, 599.0, 720_000),
    }
    monkeypatch.setattr(offline, "_reconstructed", lambda trial, option: taken[trial])
    pace, peak, more, hour = offline.rows(tmp_path, 3.0)
    assert pace.value == pytest.approx(1.5) and not pace.passed
    assert (peak.value, more.value) == (340.0, pytest.approx(10.0))
    assert hour.value == pytest.approx(700.0 + 0.01 * (720_000 - 72_000)) and not hour.passed
    pace, _, hour = offline.rows(tmp_path, 60.0)
    assert pace.passed and hour.value == 599.0 and hour.passed
    with pytest.raises(InvalidInput, match="more than 1"):
        offline.rows(tmp_path, 1.0)


def test_peak_memory_of_a_command_leaves_out_that_of_the_benchmark():
    held = np.ones(40_000_000)
    used = consumed("--version")
    assert 0.0 < used.peak_mb < held.nbytes / 1e6 and used.seconds > 0.0


def test_a_command_that_fails_is_named_with_its_message():
    with pytest.raises(InvalidInput, match=r"missing\.c3d: no such file"):
        consumed("info", "missing.c3d")


def test_a_start_is_measured_until_the_line_that_is_waited_for():
    sleeps = "import sys, time\nprint('waiting for it', file=sys.stderr, flush=True)\ntime.sleep(1000.0)"
    taken = started(("-c", sleeps), "waiting for")
    assert min(taken) > 0.0


def test_a_command_that_ends_early_is_named_with_its_message():
    with pytest.raises(InvalidInput, match="ended before 'waiting for': no port"):
        started(("-c", "import sys\nsys.exit('no port')"), "waiting for")
