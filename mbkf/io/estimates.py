"""Quantities that filters estimate in every frame, declared once for frame records, tracks and results.

A filter's frame record and the :class:`~mbkf.filters.record.Track` of a trial hold all of them. Those of
:class:`Estimates` are part of a result, too: moving a field there takes it to ``motion.h5``, to the page on files and,
where a column or a plot is declared, to OpenSim's tables and to viewers; nothing else is to be written.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.dimensions import (
    ACCELERATION,
    ANGLE,
    CONFIGURATION,
    FORCE,
    METRE,
    NEWTON_METRE,
    ONE,
    RATE,
    SECOND,
    WRENCH,
    Unit,
)
from mbkf.io.quantities import LATER, Column, Plot, change, flag, offset, quantity, spread

CONTACT_CODES = {-1: "unmeasured", 0: "air", 1: "own_plate", 2: "shared_plate"}
"""Support of a foot: something without a plate, air, a plate of its own, one plate under both feet."""


@dataclass(frozen=True, kw_only=True)
class Estimates:
    """Quantities that a filter estimates: fields of its frame record, of a trial's track and of the result."""

    q: Array = quantity(
        "time configuration",
        CONFIGURATION,
        "configuration: position of the root, its quaternion, those of the other joints with three angles, hinges",
    )
    v: Array = quantity("time dof", RATE, "velocity in the tangent space")
    a: Array = quantity("time dof", ACCELERATION, "acceleration in the tangent space")
    sd_q: Array = spread("q", axes="time dof", unit=ANGLE)
    sd_v: Array = spread("v")
    sd_q_offset: Array = offset("sd_q")
    sd_v_offset: Array = offset("sd_v")
    foot_contact: Array | None = quantity(
        "time foot",
        ONE,
        "what the foot stands on; absent where the filter does not decide it",
        None,
        codes=CONTACT_CODES,
        key="footing",
        section="two-feet-on-one-plate",
    )
    foot_height_sd: Array = quantity(
        "time foot",
        METRE,
        "standard deviation of the height of the foot; frames in which it is large do not count as valid",
        LATER,
        column=Column("reactions.mot", "ground_height_{side}_sd"),
        plot=Plot("Ground reactions", "Height, standard deviation", "mm", factor=1e3, resolution=1e-5),
        section="valid-frames",
    )
    tracked: BoolArray = flag("time", "enough markers to follow the body")
    rejected: BoolArray = flag("time marker", "marker sample refused by the innovation gate")
    nis: Array = quantity(
        "time",
        ONE,
        "normalised innovation squared, each reading in units of the spread that its innovations had before",
        section="nis",
    )
    nis_readings: Array = quantity("time", ONE, "number of scalar readings in nis", dtype=np.int64)
    nis_by_kind: Array | None = quantity("time kind", ONE, "nis by kind of reading", None)
    nis_readings_by_kind: Array | None = quantity(
        "time kind", ONE, "nis_readings by kind of reading", None, dtype=np.int64
    )
    marker_nis: Array | None = quantity(
        "time marker", ONE, "nis of each marker per coordinate, NaN where it was not used", None
    )
    marker_spread_m: Array | None = quantity(
        "time marker", METRE, "spread that marker_nis is in units of", None
    )
    step_seconds: Array = quantity(
        "time",
        SECOND,
        "computing time of the filter's step",
        plot=Plot("Stream", "Computing time", "ms", factor=1e3, resolution=1e-5),
    )
    covariance: Array | None = quantity(
        "time state state",
        ONE,
        "covariance of configuration and velocity in the tangent space, kept on request",
        None,
        written=False,
    )


@dataclass(frozen=True, kw_only=True)
class TrackEstimates(Estimates):
    """Quantities of a track that its result lacks or derives others from."""

    wrench: Array = quantity(
        "time foot wrench", WRENCH, "estimated wrenches on the feet; NaN where the filter estimates none"
    )
    wrench_sd: Array = spread("wrench")
    wrench_offset: Array = offset("wrench_sd")
    wrench_change: Array = change("wrench_sd", written=False)
    support: Array = quantity(
        "time part wrench",
        WRENCH,
        "wrenches on the parts that may bear load besides the feet (``description.bearings``), 0 on one that bears "
        "nothing; NaN where the filter does not ask",
    )
    support_sd: Array = spread("support")
    angle_sd: Array = quantity(
        "time coordinate", ANGLE, "of the clinical coordinates, the root's in the world's axes"
    )
    angle_offset: Array = offset("angle_sd")
    angle_change: Array = change("angle_sd", written=False)
    rate_sd: Array = quantity("time coordinate", RATE, "of the rates of the clinical coordinates")
    rate_offset: Array = offset("rate_sd")
    rate_change: Array = change("rate_sd", written=False)
    torque_sd: Array = quantity("time dof", FORCE, "of the generalised forces; NaN where not known")
    torque_offset: Array = offset("torque_sd")
    torque_change: Array = change("torque_sd", written=False)
    level_sd: Array | None = quantity(
        "time way level xyz",
        NEWTON_METRE,
        "of the trunk's moments at levels of the spine, axes of the trunk; NaN where not known",
        None,
    )
    level_offset: Array | None = offset("level_sd")
    ball_covariance: Array = quantity(
        "time ball xyz xyz",
        Unit("rad^2"),
        "covariances of the rotations of joints with three angles, in the axes of their distal segments",
    )
    ball_offset: Array = offset("ball_covariance")
    known: BoolArray = flag("time", "there is an estimate")
    uncorrected: BoolArray = flag("time", "later frames were not used, see :mod:`mbkf.filters.plausibility`")
