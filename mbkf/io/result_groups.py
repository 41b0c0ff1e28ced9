"""Quantities of a result besides those that its filter estimates (:mod:`mbkf.io.estimates`), declared once.

They stand in small records, each filled by the code that computes it: clinical motion, torques, reactions, markers,
quality and provenance.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

from mbkf.conventions import Array, BoolArray
from mbkf.io.contacts import Source
from mbkf.io.dimensions import (
    ANGLE,
    FORCE,
    METRE,
    NEWTON,
    NEWTON_METRE,
    ONE,
    PLATE_WRENCH,
    RADIAN,
    RATE,
    SECOND,
    VOLT,
    WRENCH,
)
from mbkf.io.estimates import Estimates
from mbkf.io.findings import Finding
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.muscle_bursts import MuscleBurst, bursts_of_text
from mbkf.io.quantities import LATER, Column, Plot, attribute, change, flag, offset, quantity, spread, texts
from mbkf.io.subject import Subject
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.io.verdict import Verdict, verdict_of_text

SOURCE_CODES = {one.value: one.name.lower() for one in Source}


@dataclass(frozen=True, kw_only=True)
class Measurements:
    """Markers as measured and on the reconstructed body, and the plates of the capture."""

    marker_names: tuple[str, ...] = texts("markers followed", axis="marker")
    measured_m: Array = quantity(
        "time marker xyz", METRE, "measured positions, NaN where not seen; hidden samples are kept"
    )
    predicted_m: Array = quantity(
        "time marker xyz",
        METRE,
        "markers of the reconstructed body; where one was not seen, with the offset that its skin had around the gap",
    )
    hidden: BoolArray = flag("time marker", "marker sample hidden from the filter on purpose")
    unobserved_dofs: tuple[str, ...] = texts(
        "degrees of freedom that no marker of the capture moves with", key="held_dofs"
    )
    plate_names: tuple[str, ...] = texts("force plates of the capture", (), axis="plate")
    plate_corners_m: Array | None = quantity(
        "plate corner xyz", METRE, "corners of the plates, NaN where the file has no geometry", None
    )


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(json.loads(text))


@dataclass(frozen=True, kw_only=True)
class Motion:
    """Clinical coordinates and their rates, and names of what the filter estimates."""

    dof_names: tuple[str, ...] = texts(
        "degrees of freedom of the tangent space, e.g. right_thigh_x", axis="dof"
    )
    configuration_names: tuple[str, ...] = texts("numbers of the configuration", (), axis="configuration")
    coordinate_names: tuple[str, ...] = texts(
        "clinical coordinates, with OpenSim's names where it has them", axis="coordinate"
    )
    angles: Array = quantity(
        "time coordinate",
        ANGLE,
        "clinical coordinates; the root's angles in the frame of progression",
        column=Column("angles.mot", "{coordinate}"),
    )
    angles_sd: Array = spread("angles")
    angles_sd_offset: Array = offset("angles_sd")
    angles_sd_change: Array = change("angles_sd")
    angle_rates: Array = quantity("time coordinate", RATE, "rates of angles")
    angle_rates_sd: Array = spread("angle_rates")
    angle_rates_sd_offset: Array = offset("angle_rates_sd")
    angle_rates_sd_change: Array = change("angle_rates_sd")
    angles_lab: Array | None = quantity(
        "time coordinate",
        ANGLE,
        "angles with the root's in the laboratory's axes",
        None,
        column=Column("angles_lab.mot", "{coordinate}", instead="angles"),
    )
    singular: BoolArray = flag("time coordinate", "within 10° of the angles' singularity")
    heading_rad: Array | None = quantity(
        "time",
        RADIAN,
        "heading of the frame of the pelvis's angles, about the vertical from the laboratory's x axis",
        None,
        section="frame-of-progression",
    )
    direction: str = attribute(
        "what the frame of the pelvis's angles follows: progression, heading or laboratory", "laboratory"
    )
    angles_read: str = attribute("axes that angles are read in: model, isb or pig", "model")
    opensim_origin_m: tuple[float, ...] = attribute(
        "place of OpenSim's origin of the root in the root's frame, m; empty where it is the root's own",
        (),
        read=_numbers,
    )
    opensim_zeros_rad: dict[str, float] = attribute(
        "value of OpenSim's coordinate where the one of that name is 0; 0 for others",
        read=json.loads,
        factory=dict,
    )
    positive_senses: dict[str, str] = attribute(
        "movement that a positive value of a coordinate means, by name; _r stands for the right side, _l for the left",
        read=json.loads,
        factory=dict,
    )
    angles_zero: str = attribute(
        "zero of the joints' angles: axes, or static for the static trial's posture", "axes"
    )


@dataclass(frozen=True, kw_only=True)
class Torques:
    """Generalised forces, and the residual that the measured plates leave."""

    tau: Array = quantity(
        "time dof", FORCE, "generalised forces; the first six are the residual at the pelvis in its axes"
    )
    sd_tau: Array = spread("tau")
    sd_tau_offset: Array = offset("sd_tau")
    residual_force_n: Array = quantity(
        "time xyz", NEWTON, "force that the measured plates leave at the pelvis, world axes"
    )
    residual_moment_nm: Array = quantity(
        "time xyz",
        NEWTON_METRE,
        "moment about the pelvis's origin that the measured plates leave, world axes",
    )


@dataclass(frozen=True, kw_only=True)
class Moments:
    """Moments conjugate to the clinical coordinates."""

    moments: Array = quantity(
        "time coordinate",
        FORCE,
        "internal moments of the joints, conjugate to the coordinates: positive turns towards positive angles; about "
        "the body's own axes; the pelvis's are the residual",
        column=Column("torques.sto", "{coordinate}_{load}"),
    )
    moments_sd: Array = spread("moments")
    moments_sd_offset: Array = offset("moments_sd")
    moments_sd_change: Array = change("moments_sd")


@dataclass(frozen=True, kw_only=True)
class Reactions:
    """Loads on the feet."""

    foot_wrench: Array = quantity(
        "time foot wrench",
        WRENCH,
        "force and moment of the ground on the foot; as measured for the kinematic filter, else as estimated",
    )
    foot_wrench_sd: Array | None = spread("foot_wrench", None)
    foot_wrench_sd_offset: Array | None = offset("foot_wrench_sd")
    foot_wrench_sd_change: Array | None = change("foot_wrench_sd")
    foot_cop_m: Array = quantity("time foot xyz", METRE, "centre of pressure, NaN where not loaded")
    foot_free_moment_nm: Array = quantity(
        "time foot",
        NEWTON_METRE,
        "moment about the vertical through the centre of pressure, NaN where not loaded",
    )
    foot_source: Array = quantity("time foot", ONE, "how the wrench on the foot is known", codes=SOURCE_CODES)
    read_plate_names: tuple[str, ...] = texts("force plates that the filter reads", (), axis="read_plate")
    plate_change: Array | None = quantity(
        "time read_plate wrench",
        PLATE_WRENCH,
        "estimated minus measured wrench about the plate's origin, NaN where not compared",
        None,
    )


@dataclass(frozen=True, kw_only=True)
class SupportLoads:
    """Loads on other parts of the body than the feet; no parts (B = 0) where the filter does not ask."""

    support_names: tuple[str, ...] = texts(
        "parts that may bear load besides the feet; empty where the filter does not ask", axis="part"
    )
    support_wrench: Array = quantity(
        "time part wrench", WRENCH, "estimated force and moment on the part; 0 where it bears nothing"
    )
    support_wrench_sd: Array = spread("support_wrench")
    support_point_m: Array = quantity(
        "time part xyz",
        METRE,
        "where the force acts: on its line nearest to the part's middle, and from there back to the part's surface; "
        "NaN below 20 N",
    )


@dataclass(frozen=True, kw_only=True)
class TrunkMoments:
    """Net moments of the trunk at levels of the spine; no levels (L = 0) of a body without them."""

    level_names: tuple[str, ...] = texts("levels of the spine, from the highest one down", (), axis="level")
    level_columns: tuple[str, ...] = texts(
        "beginning of the levels' columns in tables; that of a level at which OpenSim has a joint is OpenSim's",
        (),
    )
    trunk_moments: Array | None = quantity(
        "time way level turn",
        NEWTON_METRE,
        "net moment of the part below the level on the part above it, about its middle, conjugate to the trunk's "
        "coordinates; bottom-up NaN where a load on the part below is not measured",
        None,
        section="trunk-levels",
    )
    trunk_moments_sd: Array | None = spread("trunk_moments", None)
    trunk_moments_sd_offset: Array | None = offset("trunk_moments_sd")


@dataclass(frozen=True, kw_only=True)
class Muscles:
    """Electromyograms; no muscles (E = 0) of a capture without them."""

    muscle_names: tuple[str, ...] = texts(
        "muscles whose electromyogram the capture holds; _r and _l end those of a named side",
        (),
        axis="muscle",
    )
    emg_envelope: Array | None = quantity(
        "time muscle",
        VOLT,
        "envelope of the electromyogram: band-passed, rectified and low-passed by the settings emg of the run",
        None,
        section="electromyograms",
    )
    muscle_bursts: tuple[MuscleBurst, ...] = attribute(
        "stretches in which a muscle is active", (), read=bursts_of_text
    )
    emg_rate_hz: float = attribute("sample rate of the electromyograms, Hz; 0 without", 0.0, read=float)


def _unexplained(text: str) -> tuple[UnexplainedLoad, ...]:
    return tuple(UnexplainedLoad(**{**one, "vector_n": tuple(one["vector_n"])}) for one in json.loads(text))


def _limb_doubts(text: str) -> tuple[LimbDoubt, ...]:
    found = json.loads(text)
    return tuple(LimbDoubt(**{**one, "exchanged": tuple(map(tuple, one["exchanged"]))}) for one in found)


@dataclass(frozen=True, kw_only=True)
class Quality:
    """Frames that count."""

    measured: BoolArray = flag("time", "plates measure every load", section="valid-frames")
    valid: BoolArray = flag(
        "time",
        "every load is measured, or estimated so well that the torques which it changes are known, no unexplained "
        "force acts, and the verdict leaves loads",
        section="valid-frames",
    )
    unexplained_force_n: Array = quantity(
        "time xyz",
        NEWTON,
        "force that acts besides weight and contacts, mean over 0.5 s; NaN where no plate reads a foot's load",
        LATER,
        plot=Plot("Ground reactions", "Unexplained force", "N", factor=1.0, resolution=0.2),
        section="unexplained-loads",
    )
    unexplained: tuple[UnexplainedLoad, ...] = attribute(
        "stretches in which such a force acts; their frames are not valid", (), read=_unexplained
    )
    limb_doubts: tuple[LimbDoubt, ...] = attribute(
        "stretches in which a limb fits its markers badly or lies beyond its ranges, mended or not",
        (),
        read=_limb_doubts,
    )
    verdict: Verdict | None = attribute(
        "parts that may be used, and the reasons; absent in older files", None, read=verdict_of_text
    )


def _exchanged(text: str) -> tuple[tuple[str, str, int], ...]:
    return tuple((a, b, int(frames)) for a, b, frames in json.loads(text))


def _findings(text: str) -> tuple[Finding, ...]:
    return tuple(Finding(**one) for one in json.loads(text))


@dataclass(frozen=True, kw_only=True)
class Provenance:
    """Trial, person, filter and settings that a result was made from, and remarks."""

    trial: str = attribute("name of the trial")
    protocol: str = attribute("marker protocol")
    filter: str = attribute("kinematic, torque or dynamic")
    version: str = attribute("version of mbkf")
    rate_hz: float = attribute("frame rate, Hz", read=float)
    times_s: Array = quantity(
        "time",
        SECOND,
        "times of the frames by the clock of the capture: the first frame of a C3D file is at 0",
    )
    smoothed: bool = attribute("all later frames that matter correct a frame", read=bool)
    uncorrected: int = attribute(
        "number of frames that smoothing or a lag left as the filter had them", 0, read=int
    )
    subject: Subject
    settings: dict[str, object] = attribute("settings of the run", read=json.loads, factory=dict)
    processing: dict[str, float] = attribute(
        "measurements of the person that the capture states, by the names of its PROCESSING group",
        read=json.loads,
        factory=dict,
    )
    file_axes: str = attribute("axes of the capture's file that became x, y and z", "x,y,z")
    file_axes_source: str = attribute("how these axes are known; empty in older files", "")
    markers_ignored: dict[str, str] = attribute(
        "reason by name of each marker of the capture that was not used", read=json.loads, factory=dict
    )
    markers_explained: float = attribute(
        "share of the capture's named markers that the protocol knows, used or not", 1.0, read=float
    )
    names_exchanged: tuple[tuple[str, str, int], ...] = attribute(
        "pairs of markers whose names the capture exchanges, and the number of frames", (), read=_exchanged
    )
    checks: tuple[Finding, ...] = attribute("checks independent of the filter", (), read=_findings)
    warnings: tuple[str, ...] = texts("remarks for the reader", ())


GROUPS = (
    Provenance,
    Measurements,
    Estimates,
    Motion,
    Torques,
    Moments,
    Reactions,
    SupportLoads,
    TrunkMoments,
    Muscles,
    Quality,
)
"""The records that make a result, in the order of the page on files."""
