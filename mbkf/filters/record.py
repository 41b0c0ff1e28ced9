"""The record of a frame: one declaration from which a trial's arrays, the live log's rows and live frames follow.

A record is a row of a structured array. The answer to a frame is filled by :meth:`FrameRecorder.row`; what costs as
much again and is not waited for, by :meth:`FrameRecorder.spread` and :meth:`FrameRecorder.innovation`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrorRoots, BodyErrors
from mbkf.filters.estimate import Posterior, TrackingFilter
from mbkf.filters.spread import ASKED, Spread

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
    Field("uncorrected", "?"),
    Field("readings", "<i8"),
    Field("footing", "<i8", "2"),
    Field("refused", "?", "M"),
    Field("measured_m", "<f8", "M 3"),
    Field("latency_s", "<f8"),
    Field("step_seconds", "<f8"),
    Field("nis", "<f8"),
    Field("nis_by_kind", "<f8", "4"),
    Field("readings_by_kind", "<i8", "4"),
    Field("marker_nis", "<f8", "M"),
    Field("marker_spread_m", "<f8", "M"),
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
    Field("position_offset", "<f8", "nv"),
    Field("velocity_offset", "<f8", "nv"),
    Field("torque_offset", "<f8", "nv"),
    Field("angle_offset", "<f8", "A"),
    Field("rate_offset", "<f8", "A"),
    Field("ball_offset", "<f8", "N 3 3"),
    Field("wrench_offset", "<f8", "2 6"),
)
"""The declaration.

number: of the frame. known: whether there is an estimate. started: whether the filter was (re)started in it. tracked:
whether enough instruments read. uncorrected: whether it is the filter's own since later frames made no person of it
(:mod:`mbkf.filters.person`). readings, nis: numbers in the normalised innovation squared, and its value, NaN at a
start; readings_by_kind, nis_by_kind: the same by :data:`mbkf.conventions.READING_KINDS`; marker_nis, marker_spread_m:
of each marker per coordinate, and the spread it is in units of (:mod:`mbkf.filters.innovations`). footing: what right
and left foot stand on (:class:`mbkf.sensors.contact.records.Contact`). refused: markers seen but outside their gate.
measured_m: markers, NaN where missing. latency_s, step_seconds: from arrival to answer, and the computing time of the
step. q, v, a: configuration, velocity, acceleration. wrench: of the ground on right and left foot, about the world's
origin. support, support_sd: the same on the B parts that may bear load besides the feet, and standard deviations; 0 on
one that bears none. The others are standard deviations: of the wrenches, of the height of the feet, of position and
velocity in the tangent space, of the A clinical coordinates and their rates, of the generalised forces.
ball_covariance: of the rotations of the N joints with three angles in their distal segments' axes, rad², for angles
told in other axes than the body file's. …_offset: the part of a standard deviation (covariance) that repeats in the
same posture, since the person's body is not known exactly (:mod:`mbkf.filters.body_errors`).
"""

OFFSETS_HELD_S = 0.1
"""Offsets change with the posture and are worked out once in such a time."""

MOTION = ("q", "v", "a", "wrench")
SPREAD_AT_ONCE = ("position", "velocity", "torque")


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


class HeldErrors:
    """Errors by the body along a trial: worked out once in a while, and only when asked for."""

    def __init__(self, body: BodyErrors | None, dt_s: float) -> None:
        """Args: the errors by the body, None where they are not told, and the time between frames."""
        self._body, self._held = body, max(1, round(OFFSETS_HELD_S / dt_s))
        self._first, self._due, self._roots = 0, -1, _untold

    def of(self, number: int, posterior: Posterior) -> Callable[[], BodyErrorRoots | None]:
        """What works out the roots for a frame: those of the first frame of its stretch of time since the start.

        Args:
            number: The frame; frames come in order.
            posterior: The filter's estimate.
        """
        if posterior.started or self._due < 0:
            self._first, self._due = number, -1
        due = (number - self._first) // self._held
        if self._body is not None and self._due != due:
            found, body = posterior, self._body
            self._due = due
            self._roots = cache(lambda: body.at(found.q, found.v, found.a, found.wrench, found.contact))
        return self._roots


def _untold() -> BodyErrorRoots | None:
    return None


class FrameRecorder:
    """Fills records of a filter's posteriors.

    Attributes:
        filter: The filter.
        dtype: Type of a record.
    """

    def __init__(
        self,
        filter: TrackingFilter,
        markers: int,
        body: BodyErrors | None = None,
        asked: Collection[str] = ASKED,
    ) -> None:
        """Makes it.

        Args:
            filter: The filter.
            markers: Number of markers.
            body: What estimates err by because the person's body is not known exactly; None where that is not told.
            asked: Which of the standard deviations :data:`mbkf.filters.spread.ASKED` are told; others are NaN.
        """
        self.filter, self._body = filter, HeldErrors(body, filter.dt_s)
        self._asks_torques, self._asks_angles = (name in asked for name in ASKED)
        model = filter.model
        sizes = {"M": markers, "nq": model.nq, "nv": model.nv, "A": len(filter.clinical.names)}
        sizes |= {"B": len(model.description.bearings), "N": len(filter.clinical.ball_turns)}
        self.dtype = record_dtype(sizes)
        self._empty = blank(self.dtype, 1).view(
            np.uint8
        )  # numpy copies records field by field, bytes at once

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
        row = self._empty.copy().view(self.dtype)
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
        row["uncorrected"] = posterior.uncorrected
        for name in MOTION:
            row[name] = getattr(posterior, name)
        row["support"] = np.nan if posterior.support is None else posterior.support
        row["support_sd"] = self.filter.support_sd(posterior)
        by_body = self._body.of(int(row["number"][0]), posterior)
        spread = replace(self.filter.spread(posterior, self._asks_torques), body=by_body())
        for name in SPREAD_AT_ONCE if self._asks_torques else ("position", "velocity"):
            row[f"{name}_sd"] = getattr(spread, name)
            row[f"{name}_offset"] = getattr(spread, f"{name}_offset")
        offset = spread.wrench_offset
        row["wrench_offset"], row["wrench_sd"] = offset, np.hypot(self.filter.wrench_sd(posterior), offset)
        return spread

    def innovation(self, row: NDArray, posterior: Posterior) -> None:
        """How well the frame was predicted."""
        found = self.filter.innovations(posterior)
        if found is None:
            return
        row["nis_by_kind"], row["readings_by_kind"] = found.squared, found.readings
        row["nis"], row["readings"] = found.squared.sum(), found.readings.sum()
        row["marker_nis"], row["marker_spread_m"] = found.markers, found.marker_spread_m

    def spread(self, row: NDArray, spread: Spread) -> None:
        """Standard deviations of clinical coordinates, their rates and the height of the feet."""
        row["foot_height_sd"] = spread.foot_height
        if not self._asks_angles:
            return
        for name in ("angle", "rate"):
            row[f"{name}_sd"] = getattr(spread, name)
            row[f"{name}_offset"] = getattr(spread, f"{name}_offset")
        row["ball_covariance"], row["ball_offset"] = spread.ball_covariance, spread.ball_offset
