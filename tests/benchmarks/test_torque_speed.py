"""Rows of the torque filters' speed; how long anything takes is not tested."""

import numpy as np
import pytest

from benchmarks import torque_speed
from benchmarks.full_body.speed import PARTS, Speed, Timing
from benchmarks.kernel import Apart
from benchmarks.live.runs import Run
from benchmarks.torque_speed import COMPLETE, equality_rows, live_rows, methods, speed_rows


def speed(**steps_ms):
    """Made times of a step."""
    seconds = {name: np.full((2, 5, len(PARTS)), 1e-3 * ms) for name, ms in steps_ms.items()}
    return Speed({name: Timing(one, 0.01) for name, one in seconds.items()}, 1.5e-4, 2)


def test_only_the_sensitivity_tells_the_two_light_filters_apart():
    settings = {name: one.extra["torque"] for name, one in methods().items()}
    assert [one.scheme.complete for one in settings.values()] == [False, True, True]
    assert settings["FDMC"].scheme.propagation == settings[COMPLETE].scheme.propagation == "second"


def test_a_filter_that_is_too_slow_breaks_its_row_alone():
    found = {one.name: one for one in speed_rows(speed(FDMC=0.8, FD=2.0, **{COMPLETE: 1.0})) if one.bounded}
    factors = [f"{name}: capture time over computing time" for name in ("FDMC", "FD")]
    assert [found[name].value for name in factors] == pytest.approx([12.5, 5.0])
    assert [found[name].passed for name in factors] == [True, False]
    ratio = found["simplified over complete F, time of a step"]
    assert ratio.value == pytest.approx(0.8) and ratio.passed
    slower = speed_rows(speed(FDMC=0.9, FD=1.0, **{COMPLETE: 1.0}))
    assert [one.passed for one in slower if one.bounded] == [True, True, False]


@pytest.mark.parametrize(("lost", "late_ms", "passed"), [(0, 7.9, True), (1, 7.9, False), (0, 8.1, False)])
def test_live_it_loses_no_frame_and_answers_in_time(monkeypatch, tmp_path, lost, late_ms, passed):
    report = {"frames_in": 500, "frames_lost": lost, "frames_at_start": 30, "latency_ms_median": 1.0}

    def play(trial, protocol, folder, *, filter_words):
        assert (protocol, filter_words) == ("lsl", ("torque", "--preset", "FDMC"))
        return Run(report | {"latency_ms_p99": late_ms}, folder, np.zeros(3))

    monkeypatch.setattr(torque_speed, "synthetic", lambda *_: None)
    monkeypatch.setattr(torque_speed, "play", play)
    assert all(one.passed for one in live_rows(tmp_path, 5.0)) is passed


def test_kernels_are_compared_with_either_preset(monkeypatch):
    asked = []

    def apart(motion, seed, settings):
        asked.append((motion, settings.torque.scheme.integrator))
        exact = settings.torque.scheme.integrator == "TN"
        return Apart(1.0, 1.9 if exact else 2.1, 2e-9 if exact else 0.0)

    monkeypatch.setattr(torque_speed, "apart", apart)
    found = [one.passed for one in equality_rows(("squat", "walk"))]
    assert found == [True, True, False, False, False, False, True, True]
    assert asked == [("squat", "FE"), ("walk", "FE"), ("squat", "TN"), ("walk", "TN")]
