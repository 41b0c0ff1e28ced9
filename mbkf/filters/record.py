"""The record of a frame: one declaration from which a trial's arrays, the live log's rows and live frames follow.

A record is a row of a structured array. The answer to a frame is filled by :meth:`FrameRecorder.row`; what costs as
much again and is not waited for, by :meth:`FrameRecorder.spread` and :meth:`FrameRecorder.innovation`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrorRoots, BodyErrors
from mbkf.filters.estimate import Posterior
from mbkf.filters.spread import ASKED, Spread
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.io.dimensions import shape_of
from mbkf.io.estimates import TrackEstimates
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.quantities import quantities

UNASKED = -9
"""Contact of the feet as it stands in a record of a filter that does not decide it."""

AT_ONCE = 1000
"""Blank records that are copied at once."""


@dataclass(frozen=True, kw_only=True)
class Track(TrackEstimates):
    """A followed trial: its frames' records as arrays; frames before the first fitted pose are NaN.

    Attributes:
        starts: Frames at which the filter was started or restarted.
        smoothed: Later frames corrected more than the uncorrected ones.
        limb_doubts: Stretches in which a limb was in doubt; times in s since the first frame.
    """

    starts: tuple[int, ...]
    smoothed: bool
    limb_doubts: tuple[LimbDoubt, ...] = ()


class Field(NamedTuple):
    """A field of the record: its name, numpy type, and the names of its axes."""

    name: str
    kind: str
    axes: tuple[str, ...] = ()


_KINDS = {np.float64: "<f8", np.int64: "<i8", np.bool_: "?"}

FIELDS = (
    Field("number", "<i8"),
    Field("started", "?"),
    Field("measured_m", "<f8", ("marker", "xyz")),
    Field("latency_s", "<f8"),
    *(Field(one.key, _KINDS[one.dtype], one.axes[1:]) for one in quantities(Track).values() if one.written),
)
"""The declaration: number of the frame, flag of a (re)start of the filter, markers (NaN where missing), time from the
frame's arrival to its answer, and the quantities of a :class:`Track`."""

OFFSETS_HELD_S = 0.1
"""Offsets change with the posture and are worked out once in such a time."""

MOTION = ("q", "v", "a", "wrench")

DEVIATIONS = ("sd_q", "sd_v", "wrench_sd", "level_sd", "torque_sd")
OFFSETS = ("sd_q_offset", "sd_v_offset", "wrench_offset", "level_offset", "torque_offset")
COORDINATES = ("angle_sd", "rate_sd", "angle_offset", "rate_offset")
"""Fields that stand one after the other in a record, since each group is written at once."""

_IN_GROUPS = (*DEVIATIONS, *OFFSETS, *COORDINATES)


def record_dtype(sizes: Mapping[str, int]) -> np.dtype:
    """Type of a record, by the sizes of axes (:data:`mbkf.io.dimensions.AXES`) that differ from trial to trial."""

    def place(one: Field) -> tuple[bool, int]:
        """Flags come last, so that the numbers of a row are aligned."""
        return one.kind == "?", _IN_GROUPS.index(one.name) if one.name in _IN_GROUPS else -1

    return np.dtype([(f.name, f.kind, shape_of(f.axes, sizes)) for f in sorted(FIELDS, key=place)])


def bytes_of(dtype: np.dtype, group: Sequence[str]) -> slice:
    """Bytes of a record in which a group of fields stands."""
    assert dtype.fields is not None
    last, begin = dtype.fields[group[-1]], dtype.fields[group[0]][1]
    return slice(begin, last[1] + last[0].itemsize)


def blank(dtype: np.dtype, rows: int) -> NDArray:
    """Records without an estimate: numbers NaN, flags off."""
    one = np.zeros(1, dtype=dtype)
    for name in dtype.names or ():
        if one[name].dtype.kind == "f":
            one[name] = np.nan
    one["footing"] = UNASKED
    empty = np.empty(rows, dtype=dtype)
    for begin in range(
        0, rows, AT_ONCE
    ):  # hours of frames are gigabytes, and a signal waits for a copy's end
        empty[begin : begin + AT_ONCE] = one
    return empty


class Stretches:
    """Frames that share the errors by the body of the first one."""

    def __init__(self, dt_s: float) -> None:
        """Args: the time between frames."""
        self._frames = max(1, round(OFFSETS_HELD_S / dt_s))
        self._first, self._due = 0, -1

    def begins(self, number: int, started: bool) -> bool:
        """True for the first frame of a stretch; frames come in order, and ``started`` marks starts of the filter."""
        if started or self._due < 0:
            self._first, self._due = number, -1
        before, self._due = self._due, (number - self._first) // self._frames
        return self._due != before


class HeldErrors:
    """Errors by the body along a trial: worked out once in a while, and only when asked for."""

    def __init__(self, body: BodyErrors | None, dt_s: float) -> None:
        """Args: the errors by the body, None where they are not known, and the time between frames."""
        self._body, self._stretches, self._roots = body, Stretches(dt_s), _unknown_body

    def of(self, number: int, posterior: Posterior) -> Callable[[], BodyErrorRoots | None]:
        """Function that computes the roots for a frame: those of the first frame of its stretch since the start.

        Args:
            number: The frame; frames come in order.
            posterior: The filter's estimate.
        """
        if self._stretches.begins(number, posterior.started) and self._body is not None:
            found, body = posterior, self._body
            self._roots = cache(lambda: body.at(found.q, found.v, found.a, found.wrench, found.contact))
        return self._roots


def roots_again(body: BodyErrors, row: np.void) -> BodyErrorRoots:
    """Roots of the errors by the body at the estimate that a record holds."""
    footing = row["footing"]
    contact = None if footing[0] == UNASKED else (int(footing[0]), int(footing[1]))
    return body.at(row["q"], row["v"], row["a"], row["wrench"], contact)


def _unknown_body() -> BodyErrorRoots | None:
    return None


class _Held(NamedTuple):
    """Offsets of a frame, caused by the person's body; ``sd`` as bytes."""

    body: BodyErrorRoots | None
    levels: bool
    variance: Array
    sd: NDArray[np.uint8]


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
        levels: bool = False,
    ) -> None:
        """Makes it.

        Args:
            filter: The filter.
            markers: Number of markers.
            body: What estimates err by because the person's body is not known exactly; None where that is not known.
            asked: Which of the standard deviations :data:`mbkf.filters.spread.ASKED` are stated; others are NaN.
            levels: With torques, state those of the trunk's moments at the body's levels, too.
        """
        self.filter, self._body = filter, HeldErrors(body, filter.dt_s)
        self._asks_torques, self._asks_angles = (name in asked for name in ASKED)
        self._asks_levels = levels and self._asks_torques
        model = filter.model
        sizes = {"marker": markers, "configuration": model.nq, "dof": model.nv}
        sizes |= {"coordinate": len(filter.clinical.names), "ball": len(filter.clinical.ball_turns)}
        sizes["part"] = len(model.description.bearings)
        sizes["level"] = len(model.description.levels)
        self.dtype = record_dtype(sizes)
        self._deviations, self._offsets, self._coordinates = (
            bytes_of(self.dtype, group) for group in (DEVIATIONS, OFFSETS, COORDINATES)
        )
        self._no_torques = np.full(model.nv, np.nan)
        self._no_levels = np.full(math.prod(shape_of(("way", "level", "xyz"), sizes)), np.nan)
        self._held: _Held | None = None
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
        """The filter's step in the frame.

        Args:
            row: The record to fill.
            posterior: The filter's estimate of the frame.
            step_seconds: Computing time.
        """
        row["known"], row["step_seconds"] = True, step_seconds
        row["started"], row["tracked"] = posterior.started, posterior.tracked
        row["rejected"] = posterior.refused
        if posterior.contact is not None:
            row["footing"] = posterior.contact

    def motion(self, row: NDArray, posterior: Posterior) -> Spread:
        """The estimate and its standard deviations; it may be a smoothed one."""
        row["uncorrected"] = posterior.uncorrected
        for name in MOTION:
            row[name] = getattr(posterior, name)
        row["support"] = np.nan if posterior.support is None else posterior.support
        row["support_sd"] = self.filter.support_sd(posterior)
        body = self._body.of(int(row["number"][0]), posterior)()
        spread = self.filter.spread(posterior, self._asks_torques, self._asks_levels, body)
        torque = spread.torque_variance if self._asks_torques else self._no_torques
        level = self._no_levels if spread.level_variance is None else spread.level_variance.ravel()
        offset = self._offset(body, spread.level_variance is not None)
        total = np.concatenate(
            (spread.position_variance, spread.velocity_variance, spread.wrench_variance, level, torque)
        )
        np.maximum(total, 0.0, out=total)
        total += offset.variance
        numbers = row.view(np.uint8)
        numbers[self._deviations] = np.sqrt(total, out=total).view(np.uint8)
        numbers[self._offsets] = offset.sd
        return spread

    def _offset(self, body: BodyErrorRoots | None, levels: bool) -> _Held:
        """Variances of the offsets, in the order of :data:`DEVIATIONS`; they are those of the frame before in most."""
        if self._held is None or self._held.body is not body or self._held.levels != levels:
            nv, asked = self.filter.model.nv, self._asks_torques
            level = np.zeros(len(self._no_levels)) if levels else self._no_levels
            parts = [np.zeros(2 * nv + 12), level, np.zeros(nv) if asked else self._no_torques]
            if body is not None:
                motion = body.position_variance, body.velocity_variance, body.wrench_variance.ravel()
                parts[0] = np.concatenate(motion)
                if levels and body.level_variance is not None:
                    parts[1] = level + body.level_variance.ravel()
                parts[2] = parts[2] + body.torque_variance
            variance = np.concatenate(parts)
            self._held = _Held(body, levels, variance, np.sqrt(variance).view(np.uint8))
        return self._held

    def innovation(self, row: NDArray, posterior: Posterior) -> None:
        """Innovations of the frame."""
        found = self.filter.innovations(posterior)
        if found is None:
            return
        row["nis_by_kind"], row["nis_readings_by_kind"] = found.squared, found.readings
        row["nis"], row["nis_readings"] = found.squared.sum(), found.readings.sum()
        row["marker_nis"], row["marker_spread_m"] = found.markers, found.marker_spread_m

    def spread(self, row: NDArray, spread: Spread) -> None:
        """Standard deviations of clinical coordinates, their rates and the height of the feet."""
        row["foot_height_sd"] = spread.foot_height
        if not self._asks_angles:
            return
        row.view(np.uint8)[self._coordinates] = spread.coordinates.ravel().view(np.uint8)
        row["ball_covariance"], row["ball_offset"] = spread.balls
