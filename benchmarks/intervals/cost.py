"""What it costs to count the body: errors by the body beside a filter's step, and learning beside scaling."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from unittest.mock import patch

import numpy as np

from benchmarks.checks import Check
from benchmarks.dynamic.methods import tared
from mbkf.filters.record import OFFSETS_HELD_S
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.scaling import fit
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

REPEATS = 40


def cost_rows() -> list[Check]:
    """Ratios of median times within this run."""
    with single_threaded():
        person, made = synthesise("walk", seed=1)
        trial = tared(made.trial)

        def scaled() -> Subject:
            return scale(made.static, [trial], mass_kg=person.mass_kg, protocol=person.protocol)

        subject, learning = scaled(), _usual_s(scaled, 3)
        with patch.object(fit, "learnt_prior", lambda problem, *_: problem.prior):
            plain = _usual_s(scaled, 3)
        settings = ReconstructSettings(smooth=False, checks=False)
        found = reconstruct(trial, subject, settings=settings)
        inputs, _ = trial_inputs(subject_markers(trial.markers, subject), trial.plates, subject, settings)
        body, t = inputs.body, found.frames // 2
        assert body is not None
        at = found.q[t], found.v[t], found.a[t], found.foot_wrench[t], None
        once = _usual_s(lambda: body.at(*at), REPEATS)
    frames = max(1, round(OFFSETS_HELD_S * found.rate_hz))
    step = float(np.median(found.step_seconds[20:]))
    return [
        Check("errors by the body, per frame / a step", once / frames / step, 0.1, "<="),
        Check("scaling with learnt spreads / without", learning / plain, 2.0, "<="),
    ]


def _usual_s(call: Callable[[], object], repeats: int) -> float:
    """Median time of a call, s."""
    times = []
    for _ in range(repeats):
        begin = perf_counter()
        call()
        times.append(perf_counter() - begin)
    return float(np.median(times))
