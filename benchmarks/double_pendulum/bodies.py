"""The pendulum twice, and its derivatives: natural coordinates and CasADi against Pinocchio and finite differences."""

from __future__ import annotations

import numpy as np

from benchmarks.double_pendulum.motions import MOTIONS, pendulum_motion
from benchmarks.double_pendulum.pendulum import DoublePendulum, PendulumShape
from benchmarks.double_pendulum.pinocchio_pendulum import PinocchioPendulum
from benchmarks.double_pendulum.thesis import ANNEX, STUDY
from benchmarks.thesis_report.contents import OPEN, Band, Findings
from mbkf.conventions import Array
from mbkf.filters.torque.plant import Scheme, TorquePlant

STATES = 200
STEP = 1e-3
"""Of the finite differences, which are extrapolated to fourth order."""


def body_findings() -> Findings:
    """The first row of the table."""
    differences, bodies = zip(*(_compared(shape) for shape in (STUDY, ANNEX)), strict=True)
    efforts = max(_efforts(shape) for shape in (STUDY, ANNEX))
    row = "bodies"
    return Findings(
        bands=[
            Band(row, "F against finite differences", max(differences), -OPEN, 1e-7, "", False),
            Band(row, "T_e against Pinocchio's RNEA", efforts, -OPEN, 1e-9, "", False),
            Band(row, "z̈ and its derivatives against Pinocchio's ABA", max(bodies), -OPEN, 1e-9, "", False),
        ]
    )


def _compared(shape: PendulumShape) -> tuple[float, float]:
    """Worst difference of F from finite differences, and of the acceleration's parts from Pinocchio's; relative."""
    rng = np.random.default_rng(0)
    body, other = DoublePendulum(shape), PinocchioPendulum(shape)
    plant = TorquePlant(body, 0.01, lambda _: np.zeros(()), Scheme())
    slopes, parts = [], []
    for _ in range(STATES):
        q, v, u = rng.normal(size=4), 3.0 * rng.normal(size=4), 300.0 * rng.normal(size=body.nu)
        mine, theirs = body.linearise(q, v, u), other.linearise(q, v, u)
        F = plant.sensitivity(v, mine)
        slopes.append(_relative(F, _finite_differences(body, np.concatenate([q, v, u]))))
        for name in ("a", "by_q", "by_v", "by_u"):
            parts.append(_relative(getattr(mine, name), getattr(theirs, name)))
    return max(slopes), max(parts)


def _finite_differences(body: DoublePendulum, x: Array) -> Array:
    """(n, n) derivative of ẋ = [ż, z̈, 0] by x = [z, ż, T_e], central and Richardson-extrapolated."""

    def rate(at: Array) -> Array:
        return np.concatenate([at[4:8], body.acceleration(at[:4], at[4:8], at[8:]), np.zeros(body.nu)])

    # Efforts act in proportion, so that a larger step costs nothing and keeps rounding away.
    steps = STEP * np.where(np.arange(len(x)) < 8, 1.0, 1e3)
    columns = []
    for e in np.diag(steps):
        near, far = (rate(x + s * e) - rate(x - s * e) for s in (1.0, 2.0))
        columns.append((8.0 * near - far) / (12.0 * e.sum()))
    return np.stack(columns, axis=1)


def _efforts(shape: PendulumShape) -> float:
    """Worst relative difference of T_e between the two bodies, over both motions."""
    worst = 0.0
    other = PinocchioPendulum(shape, residual=False)
    for name in MOTIONS:
        motion = pendulum_motion(name, shape)
        theirs = [other.efforts(*frame) for frame in zip(motion.q, motion.v, motion.a, strict=True)]
        worst = max(worst, _relative(motion.efforts, np.stack(theirs)))
    return worst


def _relative(mine: Array, theirs: Array) -> float:
    return float(np.abs(mine - theirs).max() / np.abs(theirs).max())
