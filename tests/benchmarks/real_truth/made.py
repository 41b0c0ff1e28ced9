"""Trials beside references, made of numbers."""

import numpy as np

from benchmarks.foreign.errors import Series
from benchmarks.real_truth.followed import Compared


def series(name, offset, wave=1.0, *, person="A", trial="walk", sd=2.0, varying_sd=1.0, group="angle"):
    """A difference with a mean and a wave of an amplitude about it."""
    error = offset + wave * np.sin(np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False))
    return Series(person, trial, group, name, error, np.full(100, sd), np.full(100, varying_sd))


def compared(person="A", trial="walk", *, hips=(1.0, 2.0), moments=(), tilt=0.0, line=0.0, kind="OpenSim"):
    """A trial with hip flexions of these mean differences."""
    angles = tuple(
        series(f"hip_flexion_{side}", hip, person=person, trial=trial)
        for side, hip in zip("rl", hips, strict=True)
    )
    r = {("angle", one.name): 0.99 for one in angles} | {("moment", one.name): 0.9 for one in moments}
    return Compared(
        person, kind, trial, 4.0, angles, tuple(moments), r, tilt, line, (40.0, 50.0), {"r": (14.0, 8.0)}
    )
