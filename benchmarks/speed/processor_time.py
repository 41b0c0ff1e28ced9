"""Processor time of whole commands on generated input: `imu motion`, `info` with unknown names, `label`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.speed.consumed import consumed
from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.io.trc import write_trc
from mbkf.synthesis.person import body_of
from mbkf.trial.synth import synthesise, write_folder

STANDING_S, MOTION_S, LABEL_S, INFO_S = 2.0, 4.0, 2.5, 5.0
MOTION_BOUND_S, LABEL_BOUND_S = 5.0, 15.0
INFO_BOUNDS_S = {72: 3.0, 288: 8.0}
"""Bounds by number of markers."""

PROTOCOL = "reference36"
"""The set of the synthetic persons."""

ON_SKIN_M = 0.03
"""Standard deviation of a generated marker about a true one of its segment."""


def rows(context: Context) -> Iterator[Check]:
    """Each command once, in a process of its own."""
    out = context.out
    person, walked = synthesise("walk", seconds=MOTION_S)
    _, stood = synthesise("stand", seconds=STANDING_S, subject=person)
    for name, capture in (("walked", walked), ("stood", stood)):
        write_folder(person, capture, out / name)
        consumed("imu", "synth", out / name / "truth.h5", "--out", out / f"{name}.csv")
    known = ("--standing", out / "stood.csv", "--subject", out / "walked" / "subject.toml")
    words = ("imu", "motion", out / "walked.csv", *known, "--out", out / "motion")
    yield _row(f"imu motion of {MOTION_S:g} s", MOTION_BOUND_S, *words)
    write_folder(*synthesise("walk", seconds=LABEL_S), out / "bare")
    bare = ("label", out / "bare" / "raw.c3d", "--protocol", PROTOCOL, "--out", out / "labelled.trc")
    yield _row(f"label of {LABEL_S:g} s without a person", LABEL_BOUND_S, *bare)
    for count, bound_s in INFO_BOUNDS_S.items():
        trial = out / f"unknown_{count}.trc"
        write_trc(_unknown(count), trial)
        yield _row(f"info of {count} unknown names", bound_s, "info", trial)


def _row(name: str, bound_s: float, *words: str | Path) -> Check:
    return Check(f"{name}, processor time", consumed(*words).seconds, bound_s, "<=", "s")


def _unknown(count: int) -> MarkerTrajectories:
    """A walk with so many markers about the true ones of their segments, under names without a meaning."""
    person, recorded = synthesise("walk", seconds=INFO_S)
    model, truth, rng = body_of(person), recorded.truth, np.random.default_rng(count)
    like = rng.integers(len(person.markers), size=count)
    positions_m: Array = np.empty((len(truth.q), count, 3))
    chosen = [person.markers[k] for k in like]
    local_m = np.array([one.position_m for one in chosen]) + rng.normal(0.0, ON_SKIN_M, (count, 3))
    for t, q in enumerate(truth.q):
        rotations, places_m = model.placements(q)
        joints = [model.joint(one.segment).joint_id for one in chosen]
        positions_m[t] = places_m[joints] + np.einsum("mij,mj->mi", rotations[joints], local_m)
    names = tuple(f"P{k:03d}" for k in range(1, count + 1))
    return MarkerTrajectories(names, positions_m, recorded.trial.markers.rate_hz)
