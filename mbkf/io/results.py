"""The result of a reconstruction: motion, torques and reactions, each with its standard deviation.

A standard deviation joins two independent errors: that of the filter (noise, skin), and the offset that repeats
whenever the posture is the same, because the person's body is not known exactly. Where the posture changes, the offset
changes. That change belongs to the part that varies within the trial.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, Literal, get_args

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import UnknownName
from mbkf.io.contacts import FEET, ContactInterval, Loads, Source, bearing
from mbkf.io.dimensions import AXES
from mbkf.io.estimates import Estimates
from mbkf.io.quantities import TIME, check, quantities
from mbkf.io.result_groups import (
    GROUPS,
    Measurements,
    Moments,
    Motion,
    Muscles,
    Provenance,
    Quality,
    Reactions,
    SupportLoads,
    Torques,
    TrunkMoments,
)

Part = (
    Provenance
    | Measurements
    | Estimates
    | Motion
    | Torques
    | Moments
    | Reactions
    | SupportLoads
    | TrunkMoments
    | Muscles
    | Quality
)

SdPart = Literal["total", "offset", "change", "varying"]
"""Part of a standard deviation.

"total": of the error. "offset": of its part that repeats in the same posture. "change": of the change of the offset
with the posture, about its mean over the trial. "varying": of the error less its mean over the trial. With the filter's
variance F, total² = F + offset² and varying² = F + change². The squares of offset and varying part do not add up to the
total's, since both hold the change.
"""

LAG_KEY = "lag_ms"
"""The fixed lag among the settings of a result."""

SMOOTHED, CAUSAL = "smoothed (all later frames known)", "causal (as live)"
"""Descriptions of results without a lag."""


@dataclass(frozen=True, kw_only=True)
class Reconstruction(
    Quality,
    Muscles,
    TrunkMoments,
    SupportLoads,
    Reactions,
    Moments,
    Torques,
    Motion,
    Estimates,
    Measurements,
    Provenance,
):
    """Result of a filter on one trial: the quantities of its parts (:mod:`mbkf.io.result_groups`).

    Arrays are read-only; world axes are x forward, y left, z up.
    """

    def __post_init__(self) -> None:
        """Checks the arrays.

        Raises:
            ShapeError: The sizes of two arrays differ.
        """
        check(self)

    @classmethod
    def of(cls, *parts: Part) -> Reconstruction:
        """The result that these parts make together; of a track its estimates are taken."""
        values: dict[str, Any] = {}
        for part in parts:
            (kind,) = (group for group in GROUPS if isinstance(part, group))
            values |= {one.name: getattr(part, one.name) for one in fields(kind)}
        return cls(**values)

    @property
    def frames(self) -> int:
        """Number of frames T."""
        return len(self.times_s)

    def part(self, frames: slice) -> Reconstruction:
        """These frames of the result; attributes and remarks stay those of the whole."""
        arrays = {
            name: getattr(self, name)[frames]
            for name, one in quantities(Reconstruction).items()
            if not one.is_text and one.axes[0] == TIME and getattr(self, name) is not None
        }
        return replace(self, **arrays)

    @property
    def lag_ms(self) -> float:
        """Time over which later readings could correct a frame, ms; 0 without a fixed lag."""
        lag = self.settings.get(LAG_KEY, 0.0)
        return float(lag) if isinstance(lag, int | float) else 0.0

    @property
    def later_frames(self) -> str:
        """Which later frames an estimate knows, in words: all, none, or those of a fixed lag; and how many do not."""
        if not (self.smoothed or self.lag_ms):
            return CAUSAL
        kind = SMOOTHED if self.smoothed else f"fixed lag {self.lag_ms:g} ms"
        return f"{kind}, but {self.uncorrected} of {self.frames} frames causal" if self.uncorrected else kind

    @property
    def present(self) -> BoolArray:
        """(T, M) markers that were seen and not taken away on purpose."""
        return ~np.isnan(self.measured_m).any(axis=2) & ~self.hidden

    @property
    def loads(self) -> Loads:
        """The loads on the body: on the feet, then on the parts ``support_names``; none where it is not tracked."""
        feet_sd = (
            np.full_like(self.foot_wrench, np.nan) if self.foot_wrench_sd is None else self.foot_wrench_sd
        )
        parts = np.where(bearing(self.support_wrench), Source.ESTIMATED, Source.NONE)
        source = np.where(self.tracked[:, None], np.hstack([self.foot_source, parts]), Source.NONE)
        return Loads(
            (*FEET, *self.support_names),
            source,
            np.concatenate([self.foot_wrench, self.support_wrench], axis=1),
            np.concatenate([feet_sd, self.support_wrench_sd], axis=1),
            np.concatenate([self.foot_cop_m, self.support_point_m], axis=1),
        )

    @property
    def contacts(self) -> tuple[ContactInterval, ...]:
        """The stretches in which feet and other parts bore load while the body was tracked, in order of time."""
        return self.loads.intervals(self.times_s, self.rate_hz)

    def angle(self, name: str) -> Array:
        """(T,) a clinical coordinate by its name: rad, m for the pelvis's translations.

        Raises:
            UnknownName: The coordinate does not exist.
        """
        return self.angles[:, self._coordinate(name)]

    def angle_sd(self, name: str, part: SdPart = "total") -> Array:
        """(T,) its standard deviation or a part of it, NaN where not known.

        Raises:
            UnknownName: The coordinate or part does not exist.
        """
        return self._sd("angles_sd", name, part)

    def angle_rate(self, name: str) -> Array:
        """(T,) a coordinate's rate: rad/s, m/s for translations."""
        return self.angle_rates[:, self._coordinate(name)]

    def angle_rate_sd(self, name: str, part: SdPart = "total") -> Array:
        """(T,) its standard deviation or a part of it, as :meth:`angle_sd`."""
        return self._sd("angle_rates_sd", name, part)

    def moment(self, name: str) -> Array:
        """(T,) the moment conjugate to a coordinate: N m, N for translations (the pelvis's are residuals)."""
        return self.moments[:, self._coordinate(name)]

    def moment_sd(self, name: str, part: SdPart = "total") -> Array:
        """(T,) its standard deviation or a part of it, as :meth:`angle_sd`."""
        return self._sd("moments_sd", name, part)

    def power(self, name: str) -> Array:
        """(T,) power at a coordinate, W: its moment times its rate; those of a joint add up to the joint's."""
        return self.moment(name) * self.angle_rate(name)

    def power_sd(self, name: str, part: SdPart = "total") -> Array:
        """(T,) its standard deviation or a part of it, as :meth:`angle_sd`; moment and rate err independently.

        The offset of a power changes with moment and rate: all of it counts as change, and the total as varying.

        Of m ω with independent errors: √(m² σ_ω² + ω² σ_m² + σ_m² σ_ω²) (L. A. Goodman, J. Am. Stat. Assoc. 55 (1960)
        708-713).
        """
        m, rate = self.moment(name), self.angle_rate(name)

        def spread(m_sd: Array, rate_sd: Array) -> Array:
            return np.sqrt((m * rate_sd) ** 2 + (rate * m_sd) ** 2 + (m_sd * rate_sd) ** 2)

        same: dict[SdPart, SdPart] = {"change": "offset", "varying": "total"}
        known = same.get(part, part)
        return np.asarray(spread(self.moment_sd(name, known), self.angle_rate_sd(name, known)))

    def trunk_moment(self, level: str, turn: str = "extension", way: str = "top_down") -> Array:
        """(T,) net moment of the trunk at a level of the spine, N m; NaN in results that lack it.

        Args:
            level: The level, e.g. "L5/S1" (``level_names``).
            turn: "extension", "bending" or "rotation": the axis of the trunk's coordinate of that name.
            way: "top_down", from the motion of the part above the level and the loads on it, or "bottom_up", from those
                of the part below.

        Raises:
            UnknownName: The level, turn or way does not exist.
        """
        return self._at_level("trunk_moments", level, turn, way)

    def trunk_moment_sd(self, level: str, turn: str = "extension", way: str = "top_down") -> Array:
        """(T,) standard deviation of :meth:`trunk_moment`, NaN where not known.

        Args:
            level: The level.
            turn: The axis.
            way: The way.
        """
        return self._at_level("trunk_moments_sd", level, turn, way)

    torque = moment
    torque_sd = moment_sd

    def marker(self, name: str) -> Array:
        """(T, 3) a marker's reconstructed world position, m.

        Raises:
            UnknownName: The marker does not exist.
        """
        if name not in self.marker_names:
            raise UnknownName("marker", name, self.marker_names)
        return self.predicted_m[:, self.marker_names.index(name)]

    def _sd(self, array: str, name: str, part: SdPart) -> Array:
        if part not in get_args(SdPart):
            raise UnknownName("part of a standard deviation", part, get_args(SdPart))
        at = self._coordinate(name)
        total, offset, change = (
            getattr(self, name)[:, at] for name in (array, f"{array}_offset", f"{array}_change")
        )
        found = {"total": total, "offset": offset, "change": change}
        return found[part] if part in found else varying_sd(total, offset, change)

    def _at_level(self, array: str, level: str, turn: str, way: str) -> Array:
        place = []
        for kind, label, known in (
            ("way", way, AXES["way"].labels), ("level", level, self.level_names), ("turn", turn, AXES["turn"].labels),
        ):  # fmt: skip
            if label not in known:
                raise UnknownName(kind, label, known)
            place.append(known.index(label))
        values: Array | None = getattr(self, array)
        return np.full(self.frames, np.nan) if values is None else values[:, place[0], place[1], place[2]]

    def _coordinate(self, name: str) -> int:
        if name not in self.coordinate_names:
            raise UnknownName("coordinate", name, self.coordinate_names)
        return self.coordinate_names.index(name)


def varying_sd(total: Array, offset: Array, change: Array) -> Array:
    """Standard deviations of errors less their mean over the trial: √(total² − offset² + change²).

    Args:
        total: Of the errors.
        offset: Of their part that repeats in the same posture.
        change: Of the change of that part with the posture, about its mean over the trial.
    """
    return np.asarray(np.sqrt(np.maximum(total**2 - offset**2, 0.0) + change**2))


QUANTITIES = quantities(Reconstruction)
"""Arrays and lists of a result by name."""

ARRAYS = tuple(name for name, one in QUANTITIES.items() if not one.is_text)
"""Names of the arrays."""

PLOTTED = {name: one for name, one in QUANTITIES.items() if one.plot is not None}
"""Arrays with a curve of their own in viewers."""
