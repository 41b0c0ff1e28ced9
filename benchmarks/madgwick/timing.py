"""Time per sample of both filters in like implementations: both in Python, step by step, and both in compiled C."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from benchmarks.kernel import using
from benchmarks.madgwick.plain_ekf import PlainSettings, plain_ekf
from benchmarks.madgwick.scenes import THIGH, WALKING, scene, truth_of
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.io.imu.readings import ImuReadings
from mbkf.kernel.loading import COMPILED, REFERENCE, library

REPEATS = 3
MANY = 20_000
"""Samples in C, of which fewer take too little time to be measured."""


@dataclass(frozen=True)
class Times:
    """Microseconds per sample of one sensor with magnetometer; NaN in C where the kernel is not compiled."""

    madgwick_python: float
    plain_python: float
    ekf_python: float
    madgwick_c: float
    ekf_c: float


def measure_times() -> Times:
    """Shortest of three runs of each."""
    one = scene(0, WALKING).sensor(THIGH)
    few, many = _first(one, 300), _repeated(one, MANY)
    with using(REFERENCE):
        python = [_best(_run(few, method), few) for method in ("madgwick", "ekf")]
    settings, start = PlainSettings(0.5), truth_of(few)[0]
    plain = _best(lambda: plain_ekf(few, settings, start), few)
    compiled = [np.nan, np.nan]
    if library() is not None:
        with using(COMPILED):
            compiled = [_best(_run(many, method), many) for method in ("madgwick", "ekf")]
    return Times(python[0], plain, python[1], *compiled)


def _run(one: ImuReadings, method: str) -> Callable[[], object]:
    return lambda: orientations([one], frame="NWU", settings=OrientSettings(method))


def _best(work: Callable[[], object], one: ImuReadings) -> float:
    seconds = []
    for _ in range(REPEATS):
        start = perf_counter()
        work()
        seconds.append(perf_counter() - start)
    return 1e6 * min(seconds) / one.samples


def _first(one: ImuReadings, samples: int) -> ImuReadings:
    return one.at(one.time_s[:samples], lambda values, _: values[:samples])


def _repeated(one: ImuReadings, samples: int) -> ImuReadings:
    times = -(-samples // one.samples)
    long = np.arange(times * one.samples) / one.rate_hz
    return replace(one, orientation=None).at(long, lambda values, _: np.tile(values, (times, 1)))
