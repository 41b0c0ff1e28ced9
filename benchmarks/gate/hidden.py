"""Public captures with hidden samples, in which estimates and names were lost while those in full sight were fine."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.dynamic.captures import load
from benchmarks.dynamic.losses import occluded
from benchmarks.dynamic.methods import Method
from benchmarks.gate.metrics import HIGHER, Change, Metric, told
from benchmarks.labelling.rows import Trial, hard, labelled, shuffled
from benchmarks.references import rms
from mbkf.trial.reconstruct import reconstruct

RUN, RUN_SEED, HIDDEN_SHARE = "rajagopal run", 2, 0.27
"""A treadmill's belt takes hidden feet along; whole feet are hidden, and one marker of a foot alone is seen."""

WALK, WALK_SEED = "rajagopal walk", 1
"""A thigh's marker is hidden in the first frames, and its neighbour is taken for it."""

CAPTURES = (RUN, WALK)


def hidden_metrics(data: Path, changed: Change) -> Iterator[Metric]:
    """A run with streaks hidden, and names among ghosts.

    Args:
        data: Folder of the reference captures.
        changed: Changes the settings.
    """
    case = occluded(load(RUN, data, correct=False), HIDDEN_SHARE, RUN_SEED)
    for kind, smooth in (("smoothed", True), ("causal", False)):
        settings = changed(Method("dynamic", smooth=smooth).settings())
        result = reconstruct(case.shown, case.subject, settings=settings)
        order = [result.marker_names.index(name) for name in case.shown.markers.names]
        yield Metric(
            f"{RUN}, streaks hidden, {kind}: hidden markers",
            1e3 * rms(np.linalg.norm(result.predicted_m[:, order] - case.withheld_m, axis=2)[case.hidden]),
            "mm",
        )
        yield from told(f"{RUN}, streaks hidden, {kind}", result, None)
    person = load(WALK, data, correct=False)
    trial = Trial(WALK, person.capture, person.subject)
    found, _ = labelled(trial, shuffled(hard(trial.capture.markers, WALK_SEED), WALK_SEED))
    yield Metric(f"{WALK}, ghosts and gaps: labels right", 100.0 * found.correct_fraction, "%", HIGHER)
    yield Metric(f"{WALK}, ghosts and gaps: labels wrong", 100.0 * found.wrong_fraction, "%")
