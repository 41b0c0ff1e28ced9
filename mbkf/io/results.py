"""The result of a reconstruction: motion, torques and reactions, each with its standard deviation.

A standard deviation has two independent parts: what varies within a trial (noise, skin), and the offset that repeats
whenever the posture is the same, because the person's body is not known exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Literal, get_args

import numpy as np

from mbkf.conventions import Array, BoolArray, read_only
from mbkf.errors import ShapeError, UnknownName
from mbkf.io.contacts import FEET, ContactInterval, Loads, Source, bearing
from mbkf.io.findings import Finding
from mbkf.io.subject import Subject

NAMES = (
    "dof_names", "coordinate_names", "marker_names", "unobserved_dofs", "warnings", "support_names",
)  # fmt: skip
"""Fields that are lists of names or remarks."""

SHAPES: dict[str, str] = {
    "times_s": "T", "q": "T nq", "v": "T nv", "a": "T nv", "tau": "T nv",
    "sd_q": "T nv", "sd_v": "T nv", "sd_tau": "T nv",
    "angles": "T A", "angle_rates": "T A", "moments": "T A",
    "angles_sd": "T A", "angle_rates_sd": "T A", "moments_sd": "T A", "singular": "T A",
    "measured_m": "T M 3", "predicted_m": "T M 3", "hidden": "T M", "rejected": "T M",
    "foot_wrench": "T 2 6", "foot_cop_m": "T 2 3", "foot_free_moment_nm": "T 2",
    "residual_force_n": "T 3", "residual_moment_nm": "T 3", "tracked": "T", "measured": "T", "valid": "T",
    "nis": "T", "nis_readings": "T", "nis_by_kind": "T 4", "nis_readings_by_kind": "T 4",
    "marker_nis": "T M", "marker_spread_m": "T M", "step_seconds": "T", "plate_change": "T P 6",
    "foot_wrench_sd": "T 2 6", "foot_contact": "T 2", "covariance": "T 2nv 2nv", "plate_corners_m": "P 4 3",
    "heading_rad": "T", "angles_lab": "T A", "foot_source": "T 2",
    "support_wrench": "T B 6", "support_wrench_sd": "T B 6", "support_point_m": "T B 3",
}  # fmt: skip
"""Dimensions of every array: T frames, nv dofs, A coordinates, M markers, P plates, B parts that may bear load."""

OFFSETS = {
    f"{name}_offset": name
    for name in ("sd_q", "sd_v", "sd_tau", "angles_sd", "angle_rates_sd", "moments_sd", "foot_wrench_sd")
}
"""Arrays of the offset's part of standard deviations, and the arrays of the totals."""

SHAPES |= {name: SHAPES[total] for name, total in OFFSETS.items()}

SdPart = Literal["total", "offset", "varying"]
"""What of a standard deviation is asked for: all of it, the offset that repeats, or what varies within the trial."""

_FLAGS = ("singular", "hidden", "rejected", "tracked", "valid", "measured")
DTYPES: dict[str, type] = {name: np.bool_ for name in _FLAGS}
DTYPES |= {name: np.int64 for name in ("nis_readings", "nis_readings_by_kind", "foot_contact", "foot_source")}
"""Arrays that are not floating-point."""

LAG_KEY = "lag_ms"
"""The fixed lag among the settings of a result."""

SMOOTHED, CAUSAL = "smoothed (all later frames known)", "causal (as live)"
"""How results without a lag are told."""


@dataclass(frozen=True, kw_only=True)
class Reconstruction:
    """Result of a filter on one trial. Arrays are read-only; world axes are x forward, y left, z up.

    Attributes:
        trial: Name of the trial.
        protocol: Marker protocol.
        filter: "kinematic", "torque" or "dynamic".
        smoothed: Whether all later frames that matter were used, too; see ``lag_ms`` for those of a fixed lag.
        uncorrected: Number of frames that stand as the filter alone had them, since what later frames made of them was
            no person.
        version: Version of mbkf.
        subject: The scaled person.
        rate_hz: Frame rate.
        times_s: (T,) times of the frames.
        dof_names: (nv,) tangent dofs, e.g. ``"right_thigh_x"`` (see ``mbkf.model.clinical.dof_names``).
        q: (T, nq) configurations.
        v, a: (T, nv) tangent velocities and accelerations.
        tau: (T, nv) generalised forces; the first six are the residual at the pelvis in its axes.
        sd_q, sd_v, sd_tau: (T, nv) standard deviations in the tangent space, NaN where not known. They are totals,
            like all others here; see ``sd_q_offset``.
        coordinate_names: (A,) clinical coordinates, OpenSim's names where it has them.
        angles, angle_rates, moments: (T, A) coordinates, their rates and conjugate moments: rad, rad/s, N m;
            the pelvis's translations m, m/s, N.
        angles_sd, angle_rates_sd, moments_sd: (T, A) their standard deviations, NaN where not known.
        singular: (T, A) within 10° of the angles' singularity.
        marker_names: (M,) markers followed.
        measured_m: (T, M, 3) measured world positions, NaN where not seen; hidden samples are kept here.
        predicted_m: (T, M, 3) where the reconstructed body has them; where a marker was not seen, with the offset
            from the body that its skin had around the gap.
        hidden: (T, M) taken away on purpose.
        rejected: (T, M) refused by the innovation gate.
        foot_wrench: (T, 2, 6) ground on right and left foot: force N, moment N m about the world's origin; as
            measured for the kinematic filter, else as estimated.
        foot_cop_m: (T, 2, 3) centres of pressure, NaN where not loaded.
        foot_free_moment_nm: (T, 2) moment about the vertical through the centre of pressure, NaN where not
            loaded.
        residual_force_n, residual_moment_nm: (T, 3) residual at the pelvis from measured plates, world axes,
            moment about the pelvis's origin.
        tracked: (T,) enough markers to follow the body.
        measured: (T,) every contact that bears load stands on a measured plate, of its own or shared: frames in which
            the residual from measured plates means something.
        valid: (T,) every contact that bears load is measured, or estimated so that the torques it loads are known well
            enough (:mod:`mbkf.trial.results.validity`).
        foot_source: (T, 2) how the wrench of right and left foot is known (:class:`mbkf.io.contacts.Source`): 0 no
            load, 1 measured, 2 its share of one plate under both feet, 3 estimated.
        support_names: (B,) parts that may bear load besides the feet, e.g. "pelvis", "right_hand"; empty where the
            filter does not ask.
        support_wrench: (T, B, 6) estimated wrench on each: force N, moment N m about the world's origin; 0 where it
            bears nothing.
        support_wrench_sd: (T, B, 6) standard deviations.
        support_point_m: (T, B, 3) where the force acts on the part's surface, NaN where it bears nothing.
        unobserved_dofs: Names of dofs that no marker of the capture moves with.
        nis: (T,) normalised innovation squared, each reading in units of the spread that its innovations had before.
        nis_readings: (T,) number of scalar readings in it.
        nis_by_kind, nis_readings_by_kind: (T, 4) the same by kind (:data:`mbkf.conventions.READING_KINDS`); None
            in older files.
        marker_nis: (T, M) of each marker per coordinate, NaN where it was not used; None in older files.
        marker_spread_m: (T, M) the spread it is in units of, m; None in older files.
        step_seconds: (T,) computing time of a frame.
        warnings: Remarks for the reader.
        settings: Settings of the run, as plain data.
        plate_change: (T, P, 6) estimated minus measured plate wrench (N, N m), NaN where a plate is not
            compared; None without plates.
        foot_wrench_sd: (T, 2, 6) standard deviations of ``foot_wrench``; None where the filter does not estimate it.
        foot_contact: (T, 2) what right and left foot stand on: -1 something without a reading, 0 air, 1 a plate of its
            own, 2 a plate both share; None where the filter does not ask.
        covariance: (T, 2nv, 2nv) of (q, v) in the tangent space; only kept on request and never written.
        plate_corners_m: (P, 4, 3) world corners of the capture's plates, NaN where their file has no geometry; None
            without plates.
        file_axes: Axes of the capture's file that became x, y and z, as ``"x,-z,y"``.
        file_axes_source: Where that is known from (:class:`mbkf.io.records.AxesSource`), "" in older files.
        direction: What the frame follows in which the root's angles are told: "progression" (its path), "heading" (of
            pelvis and feet) or "laboratory". Positions and forces are in the laboratory's axes whatever it is.
        heading_rad: (T,) angle of that frame's forward axis about the vertical from the laboratory's x; None is 0.
        angles_lab: (T, A) ``angles`` with the root's in the laboratory's axes; None where they are so themselves.
        angles_read: The axes that angles and their rates are read in: "model" for the body's own, else the
            convention's name. Moments are about the body's own axes whatever it is.
        angles_zero: What is zero in them: "axes", or "static" for the posture of the static trial.
        markers_ignored: Why a marker of the capture was not used, by its name there.
        markers_explained: Share of the capture's named markers that the protocol knows, used or not, 0 to 1.
        names_exchanged: Two markers whose names were exchanged and are put right, and in how many frames.
        checks: What checks found that stand apart from the filter: mass, plates, clocks, floor, markers.
        sd_q_offset, sd_v_offset, sd_tau_offset, angles_sd_offset, angle_rates_sd_offset, moments_sd_offset,
            foot_wrench_sd_offset: The part of each standard deviation that repeats whenever the posture is the same,
            because the body is not known exactly (:mod:`mbkf.filters.body_errors`); 0 where the subject file has no
            covariance, and in older files. What varies within the trial is √(total² − offset²).
    """

    trial: str
    protocol: str
    filter: str
    smoothed: bool
    version: str
    subject: Subject
    rate_hz: float
    times_s: Array
    dof_names: tuple[str, ...]
    q: Array
    v: Array
    a: Array
    tau: Array
    sd_q: Array
    sd_v: Array
    sd_tau: Array
    coordinate_names: tuple[str, ...]
    angles: Array
    angle_rates: Array
    moments: Array
    angles_sd: Array
    angle_rates_sd: Array
    moments_sd: Array
    singular: BoolArray
    marker_names: tuple[str, ...]
    measured_m: Array
    predicted_m: Array
    hidden: BoolArray
    rejected: BoolArray
    foot_wrench: Array
    foot_cop_m: Array
    foot_free_moment_nm: Array
    residual_force_n: Array
    residual_moment_nm: Array
    tracked: BoolArray
    measured: BoolArray
    valid: BoolArray
    foot_source: Array
    support_names: tuple[str, ...]
    support_wrench: Array
    support_wrench_sd: Array
    support_point_m: Array
    unobserved_dofs: tuple[str, ...]
    nis: Array
    nis_readings: Array
    step_seconds: Array
    warnings: tuple[str, ...] = ()
    settings: dict[str, object] = field(default_factory=dict)
    plate_change: Array | None = None
    foot_wrench_sd: Array | None = None
    foot_contact: Array | None = None
    covariance: Array | None = field(default=None, repr=False)
    plate_corners_m: Array | None = None
    file_axes: str = "x,y,z"
    file_axes_source: str = ""
    direction: str = "laboratory"
    heading_rad: Array | None = None
    nis_by_kind: Array | None = None
    nis_readings_by_kind: Array | None = None
    marker_nis: Array | None = None
    marker_spread_m: Array | None = None
    angles_lab: Array | None = None
    angles_read: str = "model"
    angles_zero: str = "axes"
    markers_ignored: dict[str, str] = field(default_factory=dict)
    markers_explained: float = 1.0
    names_exchanged: tuple[tuple[str, str, int], ...] = ()
    uncorrected: int = 0
    checks: tuple[Finding, ...] = ()
    sd_q_offset: Array | None = None
    sd_v_offset: Array | None = None
    sd_tau_offset: Array | None = None
    angles_sd_offset: Array | None = None
    angle_rates_sd_offset: Array | None = None
    moments_sd_offset: Array | None = None
    foot_wrench_sd_offset: Array | None = None

    def __post_init__(self) -> None:
        for name in NAMES:
            object.__setattr__(self, name, tuple(getattr(self, name)))
        sizes = {
            "B": len(self.support_names),
            "T": np.shape(self.times_s)[0],
            "nv": len(self.dof_names),
            "2nv": 2 * len(self.dof_names),
            "A": len(self.coordinate_names),
            "M": len(self.marker_names),
        }
        for name, dimensions in SHAPES.items():
            value = getattr(self, name)
            if value is None and name in OFFSETS:
                total = getattr(self, OFFSETS[name])
                value = None if total is None else np.where(np.isnan(total), np.nan, 0.0)
            if value is None:
                continue
            array = read_only(value, dtype=DTYPES.get(name, np.float64))
            wanted = [sizes.get(d) if not d.isdigit() else int(d) for d in dimensions.split()]
            if len(wanted) != array.ndim or any(
                n not in (None, m) for n, m in zip(wanted, array.shape, strict=True)
            ):
                known = ", ".join(
                    str(n) if n is not None else d for n, d in zip(wanted, dimensions.split(), strict=True)
                )
                raise ShapeError(name, f"({known})", array.shape)
            object.__setattr__(self, name, array)

    @property
    def frames(self) -> int:
        """Number of frames T."""
        return len(self.times_s)

    @property
    def lag_ms(self) -> float:
        """How far later readings could correct a frame, ms; 0 without a fixed lag."""
        lag = self.settings.get(LAG_KEY, 0.0)
        return float(lag) if isinstance(lag, int | float) else 0.0

    @property
    def later_frames(self) -> str:
        """Which later frames an estimate knows, in words: all, none, or those of a fixed lag; and how many do not."""
        if not (self.smoothed or self.lag_ms):
            return CAUSAL
        told = SMOOTHED if self.smoothed else f"fixed lag {self.lag_ms:g} ms"
        return f"{told}, but {self.uncorrected} of {self.frames} frames causal" if self.uncorrected else told

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
            UnknownName: There is no such coordinate.
        """
        return self.angles[:, self._coordinate(name)]

    def angle_sd(self, name: str, part: SdPart = "total") -> Array:
        """(T,) its standard deviation or a part of it, NaN where not known.

        Raises:
            UnknownName: There is no such coordinate or part.
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

        Of m ω with independent errors: √(m² σ_ω² + ω² σ_m² + σ_m² σ_ω²) (L. A. Goodman, J. Am. Stat. Assoc. 55 (1960)
        708-713).
        """
        m, rate = self.moment(name), self.angle_rate(name)

        def spread(m_sd: Array, rate_sd: Array) -> Array:
            return np.sqrt((m * rate_sd) ** 2 + (rate * m_sd) ** 2 + (m_sd * rate_sd) ** 2)

        total = spread(self.moment_sd(name), self.angle_rate_sd(name))
        if part == "total":
            return np.asarray(total)
        offset = spread(self.moment_sd(name, "offset"), self.angle_rate_sd(name, "offset"))
        if part == "offset":
            return np.asarray(offset)
        if part not in get_args(SdPart):
            raise UnknownName("part of a standard deviation", part, get_args(SdPart))
        return varying_sd(total, offset)

    torque = moment
    torque_sd = moment_sd

    def marker(self, name: str) -> Array:
        """(T, 3) a marker's reconstructed world position, m.

        Raises:
            UnknownName: There is no such marker.
        """
        if name not in self.marker_names:
            raise UnknownName("marker", name, self.marker_names)
        return self.predicted_m[:, self.marker_names.index(name)]

    def _sd(self, array: str, name: str, part: SdPart) -> Array:
        if part not in get_args(SdPart):
            raise UnknownName("part of a standard deviation", part, get_args(SdPart))
        at = self._coordinate(name)
        total, offset = getattr(self, array)[:, at], getattr(self, f"{array}_offset")[:, at]
        found = {"total": total, "offset": offset}
        return found[part] if part in found else varying_sd(total, offset)

    def _coordinate(self, name: str) -> int:
        if name not in self.coordinate_names:
            raise UnknownName("coordinate", name, self.coordinate_names)
        return self.coordinate_names.index(name)


def varying_sd(total: Array, offset: Array) -> Array:
    """What of standard deviations varies within the trial, the offset being independent of it: √(total² − offset²)."""
    return np.asarray(np.sqrt(np.maximum(total**2 - offset**2, 0.0)))


ARRAYS = tuple(f.name for f in fields(Reconstruction) if f.name in SHAPES)
"""Names of the array fields, in the record's order."""
