"""What the gate measures: short synthetic trials with known truth, real captures where they are, and ratios of times.

Every number but those of time is arithmetic on the same input, so that it changes only when mbkf does.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.gate.hidden import CAPTURES, hidden_metrics
from benchmarks.gate.metrics import REAL, TRIALS, Change, Metric, real_metrics, synthetic_metrics
from benchmarks.kernel import using
from benchmarks.speed.steps import STEP, dynamic_times
from benchmarks.speed.walks import synthetic
from mbkf.kernel.loading import COMPILED, REFERENCE, library

STEPS = 300

TIME = "dynamic step, kernel with vectors of its own, over numpy's"
"""The ratio of times: of one arithmetic, since others take longer. Most of a step is the interpreter's, so that it
is told in steps of the reference kernel: a dense product's time differs more from processor to processor."""


def measured(folder: Path, data: Path | None, change: Change | None = None) -> Iterator[Metric]:
    """All metrics.

    Args:
        folder: For files.
        data: Folder of the reference captures; None leaves those out.
        change: Changes the settings of every reconstruction.
    """
    changed = change or (lambda settings: settings)
    for motion, seconds in TRIALS.items():
        yield from synthetic_metrics(motion, seconds, folder / motion, changed)
    for name in REAL if data is not None else ():
        assert data is not None
        yield from real_metrics(name, data, changed)
    if data is not None:
        yield from hidden_metrics(data, changed)
    kernel = library()
    if kernel is not None and kernel.vector_bits():
        yield Metric(TIME, _step_seconds(COMPILED) / _step_seconds(REFERENCE), "", is_time=True)


def _step_seconds(kernel: str) -> float:
    """Median time of a step of the dynamic filter."""
    with using(kernel):
        return float(np.median(dynamic_times(synthetic(2.0), STEPS).parts[STEP]))


def left_out(name: str, data: Path | None) -> bool:
    """Whether a metric of the baseline is not measured here: real captures, or times of another arithmetic.

    Args:
        name: The metric.
        data: Folder of the reference captures; None for none.
    """
    kernel = library()
    if name == TIME:
        return kernel is None or not kernel.vector_bits()
    return data is None and name.startswith((*REAL, *CAPTURES))
