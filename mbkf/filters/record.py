"""The record of a frame: one declaration from which a trial's arrays, the live log's rows and live frames follow.

A record is a row of a structured array. The answer to a frame is filled by :meth:`FrameRecorder.row`; what costs as
much again and is not waited for, by :meth:`FrameRecorder.spread` and :meth:`FrameRecorder.innovation`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior, TrackingFilter
from mbkf.filters.spread import Spread

UNASKED = -9
"""Contact of the feet as it stands in a record of a filter that does not decide it."""


class Field(NamedTuple):
    """A field of the record: its name, numpy type, and dimensions by letter or number."""

    name: str
    kind: str
    shape: str = ""


FIELDS = (
    Field("number", "<i8"),
    Field("known", "?"),
    Field("started", "?"),
    Field("tracked", "?"),
    Field("readings", "<i8"),
    Field("footing", "<i8", "2"),
    Field("refused", "?", "M"),
    Field("measured_m", "<f8", "M 3"),
    Field("latency_s", "<f8"),
    Field("step_seconds", "<f8"),
    Field("nis", "<f8"),
    Field("q", "<f8", "nq"),
    Field("v", "<f8", "nv"),
    Field("a", "<f8", "nv"),
    Field("wrench", "<f8", "2 6"),
    Field("wrench_sd", "<f8", "2 6"),
    Field("support", "<f8", "B 6"),
    Field("support_sd", "<f8", "B 6"),
    Field("foot_height_sd", "<f8", "2"),
    Field("position_sd", "<f8", "nv"),
    Field("velocity_sd", "<f8", "nv"),
    Field("angle_sd", "<f8", "A"),
    Field("rate_sd", "<f8", "A"),
    Field("ball_covariance", "<f8", "N 3 3"),
    Field("torque_sd", "<f8", "nv"),
)
"""The declaration.

number: of the frame. known: whether there is an estimate. started: whether the filter was (re)started in it. tracked:
whether enough instruments read. readings, nis: numbers in the normalised innovation squared, and its value, NaN at a
start. footing: what right and left foot stand on (:class:`mbkf.sensors.contact.records.Contact`). refused: markers seen
but outside their gate. measured_m: markers, NaN where missing. latency_s, step_seconds: from arrival to answer, and
the computing time of the step. q, v, a: configuration, velocity, acceleration. wrench: of the ground on right and left
foot, about the world's origin. support, support_sd: the same on the B parts that may bear load besides the feet, and
standard deviations; 0 on one that bears none. The others are standard deviations: of the wrenches, of the height of the
feet, of position and velocity in the tangent space, of the A clinical coordinates and their rates, of the generalised
forces.
ball_covariance: of the rotations of the N joints with three angles in their distal segments' axes, rad², for angles
told in other axes than the body file's.
"""

MOTION = ("q", "v", "a", "wrench")
SPREAD_AT_ONCE, SPREAD_LATER = ("position", "velocity", "torque"), ("angle", "rate", "foot_height")


def record_dtype(sizes: Mapping[str, int]) -> np.dtype:
    """Type of a record: M markers, nq and nv of the body, A clinical coordinates, B bearing parts, N ball joints."""

    def length(letter: str) -> int:
        return int(letter) if letter.isdigit() else sizes[letter]

    return np.dtype([(f.name, f.kind, tuple(map(length, f.shape.split()))) for f in FIELDS])


def blank(dtype: np.dtype, rows: int) -> NDArray:
    """Records without an estimate: numbers NaN, flags off."""
    empty = np.zeros(rows, dtype=dtype)
    for name in dtype.names or ():
        if empty[name].dtype.kind == "f":
            empty[name] = np.nan
    empty["footing"] = UNASKED
    return empty


class FrameRecorder:
    """Fills records of a filter's posteriors.

    Attributes:
        filter: The filter.
        dtype: Type of a record.
    """

    def __init__(self, filter: TrackingFilter, markers: int) -> None:
        """Args: the filter, and the number of markers."""
        self.filter = filter
        model = filter.model
        sizes = {"M": markers, "nq": model.nq, "nv": model.nv, "A": len(filter.clinical.names)}
        sizes |= {"B": len(model.description.bearings), "N": len(filter.clinical.ball_turns)}
        self.dtype = record_dtype(sizes)
        self._empty = blank(self.dtype, 1)

    def row(
        self, number: int, measured_m: Array, posterior: Posterior | None, step_seconds: float
    ) -> tuple[NDArray, Spread | None]:
        """(1,) a record with the answer to a frame, and the spread for :meth:`spread`.

        Args:
            number: The frame.
            measured_m: (M, 3) its markers.
            posterior: What the filter made of it; None where it is not started.
            step_seconds: Computing time.
        """
        row = self._empty.copy()
        row["number"], row["measured_m"] = number, measured_m
        if posterior is None:
            return row, None
        self.step(row, posterior, step_seconds)
        return row, self.motion(row, posterior)

    def step(self, row: NDArray, posterior: Posterior, step_seconds: float) -> None:
        """What the filter did in the frame.

        Args:
            row: The record to fill.
            posterior: What the filter made of the frame.
            step_seconds: Computing time.
        """
        row["known"], row["step_seconds"] = True, step_seconds
        row["started"], row["tracked"] = posterior.started, posterior.tracked
        row["refused"] = posterior.refused
        if posterior.contact is not None:
            row["footing"] = posterior.contact

    def motion(self, row: NDArray, posterior: Posterior) -> Spread:
        """The estimate and its standard deviations; it may be a smoothed one."""
        for name in MOTION:
            row[name] = getattr(posterior, name)
        row["wrench_sd"] = self.filter.wrench_sd(posterior)
        row["support"] = np.nan if posterior.support is None else posterior.support
        row["support_sd"] = self.filter.support_sd(posterior)
        spread = self.filter.spread(posterior)
        for name in SPREAD_AT_ONCE:
            row[f"{name}_sd"] = getattr(spread, name)
        return spread

    def innovation(self, row: NDArray, posterior: Posterior) -> None:
        """How well the frame was predicted."""
        row["nis"], row["readings"] = self.filter.innovation(posterior)

    def spread(self, row: NDArray, spread: Spread) -> None:
        """Standard deviations of clinical coordinates, their rates and the height of the feet."""
        for name in SPREAD_LATER:
            row[f"{name}_sd"] = getattr(spread, name)
        row["ball_covariance"] = spread.ball_covariance
