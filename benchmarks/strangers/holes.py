"""Chains with holes: a segment's markers are withheld, from scaling as well, and stated spreads compared with errors.

Errors are exact for made persons and for those made from OpenSim's bodies; of public captures it is the change against
the result with all markers, whose own variance is taken from the stated one. Coordinates of the joints on both sides of
the segment count, and of the pelvis its own angles. Settings were chosen on :data:`CHOSEN_ON`; rows are of others.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.methods import Mapper, in_parallel, tared
from benchmarks.foreign.truth import FOLDER, foreigners
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.anatomy import true_angles
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.protocol.choice import choose_marker_set
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.innovations import SETTLING_S
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

HOLES = ("pelvis", "right_thigh", "right_shank", "right_upper_arm", "torso")
FILTERS = ("kinematic", "dynamic")
RATIO, COVER = (0.7, 1.4), (88.0, 98.0)
"""Bounds of error over standard deviation, RMS, and of the share of frames inside 95 % intervals, %."""

COVERED_SD = 1.959964
LEAST_SHARE = 0.25
"""Least share of the stated variance that is left after that of the result with all markers."""

UNMARKED_PELVIS = "french_walk_no_pelvis/marche281.c3d"

MOST_FRAMES, STANDING_FRAMES, WALK_S = 300, 100, 3.0


class Public(NamedTuple):
    """A public capture: folder, standing trial, trial, ground reactions, mass in kg."""

    folder: str
    standing: str | None
    trial: str
    forces: str | None
    mass_kg: float


Source = Public | tuple[str, int] | tuple[str, str]
"""A capture, a made person's motion and seed, or a foreign person's name and motion."""

CHOSEN_ON = (
    Public("gaitalytics_walk", None, "overground_fullbody_4plates.c3d", None, 63.6),
    Public("functional_walk", "FunctionalStatic.c3d", "FunctionalWalk.c3d", None, 60.0),
    Public("biomechzoo_walk_turn", "HC032A_Static_HC032A01.c3d", "HC032A_Straight_HC032A03.c3d", None, 60.3),
)
"""Captures on which settings were chosen, besides the foreign adult and the made persons 1 to 3."""

SHOWN_ON = (
    Public("rajagopal_walk_run", "static_walk_1.trc", "motion_capture_walk.trc", "grf_walk.mot", 85.07),
    Public("rajagopal_walk_run", "static_run.trc", "motion_capture_run.trc", "grf_run.mot", 72.84),
    Public("unipd_walk", "Static1.c3d", "Walking1.c3d", None, 70.0),
    Public("rehazenter_walk", "2014001_ST_static.c3d", "2014001_C1_01.c3d", None, 67.0),
    Public("opencap_s6_walk", "s6_static1.trc", "s6_walking1.trc", "s6_walking1_forces.mot", 59.0),
    Public("bmc_walk_run", "run_static.trc", "run.trc", "run_grf.mot", 70.0),
)
MADE = tuple((motion, seed) for seed in (11, 12) for motion in ("walk", "squat"))
FOREIGN_SHOWN = "child"


class Compared(NamedTuple):
    """One coordinate of one trial.

    Attributes:
        hole: Segment without markers.
        filter: The filter.
        exact: True for an error against the truth.
        name: The coordinate, without its side.
        squared: Mean of (error / sd)².
        cover: Share of frames inside the 95 % interval.
        rms_deg, sd_deg: RMS of the error and of the standard deviation.
    """

    hole: str
    filter: str
    exact: bool
    name: str
    squared: float
    cover: float
    rms_deg: float
    sd_deg: float


@dataclass(frozen=True)
class Job:
    """One person's trial with every hole.

    Attributes:
        data: Folder of the reference captures.
        source: A public capture; a made person's motion and seed; or a foreign person's name and motion.
        holes: Segments whose markers are withheld.
        filters: The filters.
    """

    data: Path
    source: Source
    holes: tuple[str, ...] = HOLES
    filters: tuple[str, ...] = FILTERS


def hole_rows(data: Path) -> list[Check]:
    """Rows by hole and filter: error over standard deviation and cover, of exact truth and against all markers.

    Args:
        data: Folder of the reference captures.
    """
    child = next(one for one in foreigners(data / FOLDER) if one.name == FOREIGN_SHOWN)
    sources: list[Source] = [*SHOWN_ON, *MADE, *((child.name, motion) for motion in child.motions)]
    with in_parallel() as mapper:
        found = compared_of([Job(data, one) for one in sources], mapper)
    return [*rows_of(found), *unmarked_pelvis_rows(data)]


def unmarked_pelvis_rows(data: Path) -> Iterator[Check]:
    """A public walk that has no marker on the pelvis, as a laboratory would use it."""
    trial = _shortened(read_capture(data / UNMARKED_PELVIS), MOST_FRAMES)
    subject = scale(None, [trial], mass_kg=69.0, height_m=1.74)
    for filter in FILTERS:
        result = _followed(trial, subject, filter)
        assert result.verdict is not None
        named = {
            one.part for one in result.verdict.reasons if one.found.startswith("the pelvis has no markers")
        }
        name = f"walk without pelvis markers, {filter}"
        yield Check(f"{name}: parts on which the verdict names the pelvis", len(named), 4, ">=")
        for coordinate in ("pelvis_tilt", "lumbar_extension", "hip_flexion_r", "hip_flexion_l"):
            mean = np.degrees(np.nanmean(result.angle(coordinate)))
            yield information(f"{name}: {coordinate}, mean", float(mean), "°")
            sd = np.degrees(np.nanmean(result.angle_sd(coordinate)))
            yield information(f"{name}: {coordinate}, sd", float(sd), "°")


def compared_of(jobs: Sequence[Job], mapper: Mapper) -> list[Compared]:
    """Coordinates of all jobs."""
    return [one for each in mapper(compared, jobs) for one in each]


def rows_of(found: Sequence[Compared]) -> Iterator[Check]:
    """Rows of pooled coordinates, and their figures one by one."""
    for exact, title in ((True, "exact"), (False, "against all markers")):
        for hole in HOLES:
            for filter in FILTERS:
                mine = [one for one in found if (one.exact, one.hole, one.filter) == (exact, hole, filter)]
                if not mine:
                    continue
                name = f"without markers of the {hole.replace('_', ' ')}, {filter}, {title}"
                ratio, cover = _pooled(mine)
                yield Check(f"{name}: error / sd", ratio, RATIO[0], ">=")
                yield Check(f"{name}: error / sd", ratio, RATIO[1], "<=")
                yield Check(f"{name}: 95 % intervals hold", cover, COVER[0], ">=", "%")
                yield Check(f"{name}: 95 % intervals hold", cover, COVER[1], "<=", "%")
                for coordinate in dict.fromkeys(one.name for one in mine):
                    own = [one for one in mine if one.name == coordinate]
                    yield information(f"{name}: {coordinate}, error / sd", _pooled(own)[0])
                    yield information(
                        f"{name}: {coordinate}, RMS error", _rms([one.rms_deg for one in own]), "°"
                    )


def _pooled(found: Sequence[Compared]) -> tuple[float, float]:
    return float(np.sqrt(np.mean([one.squared for one in found]))), 100.0 * float(
        np.mean([one.cover for one in found])
    )


def _rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def compared(job: Job) -> list[Compared]:
    """Coordinates beside every hole of a person's trial."""
    with single_threaded():
        if isinstance(job.source, Public):
            return _of_public(job, job.source)
        first, second = job.source
        if isinstance(second, int):
            return _of_made(job, first, second)
        return _of_foreign(job, first, second)


def _of_made(job: Job, motion: str, seed: int) -> list[Compared]:
    person, made = synthesise(motion, seed=seed, seconds=WALK_S if motion == "walk" else None, varied=True)
    trial = tared(made.trial)
    found: list[Compared] = []
    segments = {marker.name: marker.segment for marker in person.markers}
    for hole, filter in _cases(job, segments):
        gone = [name for name, segment in segments.items() if segment == hole]
        subject = scale(without(made.static, gone), mass_kg=person.mass_kg, protocol=person.protocol)
        result = _followed(without(trial, gone), subject, filter)
        error = true_angles(person, made.truth.q) - result.angles
        found += _compared(hole, filter, True, result, error, result.angles_sd)
    return found


def _of_foreign(job: Job, name: str, motion: str) -> list[Compared]:
    person = next(one for one in foreigners(job.data / FOLDER) if one.name == name)
    static, trial, truth = person.static(), person.trial(motion), person.truth(motion)
    found: list[Compared] = []
    protocol, segments = _marker_set(static, trial)
    for hole, filter in _cases(job, segments):
        gone = [name for name, segment in segments.items() if segment == hole]
        trials = [without(trial, gone)]
        subject = scale(without(static, gone), trials, mass_kg=person.mass_kg, protocol=protocol)
        result = _followed(trials[0], subject, filter)
        alike = [
            name
            for name in result.coordinate_names
            if truth.has(name) and not name.startswith(("pelvis", "pro_sup", "subtalar", "mtp", "wrist"))
        ]
        error = np.full(result.angles.shape, np.nan)
        for k, coordinate in enumerate(result.coordinate_names):
            if coordinate in alike:
                exact = np.interp(result.times_s, truth.times_s, truth.coordinate(coordinate))
                error[:, k] = exact - result.angles[:, k]
        found += _compared(hole, filter, True, result, error, result.angles_sd)
    return found


def _of_public(job: Job, source: Public) -> list[Compared]:
    folder = job.data / source.folder
    found: list[Compared] = []
    static = (
        None
        if source.standing is None
        else _shortened(read_capture(folder / source.standing), STANDING_FRAMES)
    )
    forces = None if source.forces is None else folder / source.forces
    trial = _shortened(read_capture(folder / source.trial, forces=forces), MOST_FRAMES)
    protocol, segments = _marker_set(static, trial)

    def followed(gone: Sequence[str], filter: str) -> Reconstruction:
        standing = None if static is None else without(static, gone)
        moving = without(trial, gone)
        subject = scale(standing, [moving], mass_kg=source.mass_kg, protocol=protocol)
        return _followed(moving, subject, filter)

    whole = {filter: followed((), filter) for filter in job.filters}
    for hole, filter in _cases(job, segments):
        result, full = (
            followed([n for n, segment in segments.items() if segment == hole], filter),
            whole[filter],
        )
        error = np.where(full.tracked[:, None], full.angles - result.angles, np.nan)
        left = np.maximum(result.angles_sd**2 - full.angles_sd**2, LEAST_SHARE * result.angles_sd**2)
        found += _compared(hole, filter, False, result, error, np.sqrt(left))
    return found


def _cases(job: Job, segments: dict[str, str]) -> Iterator[tuple[str, str]]:
    for hole in job.holes:
        if hole in segments.values():
            yield from ((hole, filter) for filter in job.filters)


def _marker_set(static: Capture | None, trial: Capture) -> tuple[Protocol, dict[str, str]]:
    """The marker set of captures, and the segment of each of its names in them."""
    chosen = choose_marker_set(static, [trial], None).protocol
    names = (*trial.markers.names, *(() if static is None else static.markers.names))
    return chosen, {name: marker.segment for name, marker in chosen.match(names).items()}


def without(capture: Capture, names: Sequence[str]) -> Capture:
    """The capture without some markers."""
    markers = capture.markers
    return replace(
        capture, markers=markers.select(tuple(name for name in markers.names if name not in names))
    )


def _shortened(capture: Capture, frames: int) -> Capture:
    """The stretch of so many frames in which most markers are seen."""
    markers = capture.markers
    if markers.frames <= frames:
        return capture
    seen = np.convolve(markers.present.mean(axis=1), np.ones(frames), "valid")
    first = int(np.argmax(seen))
    part = replace(
        markers,
        positions_m=markers.positions_m[first : first + frames],
        start_time_s=markers.start_time_s + first / markers.rate_hz,
    )
    return replace(capture, markers=part)


def _followed(trial: Capture, subject: Subject, filter: str) -> Reconstruction:
    return reconstruct(trial, subject, settings=ReconstructSettings(filter=filter, checks=False))


def _compared(
    hole: str, filter: str, exact: bool, result: Reconstruction, error: Array, sd: Array
) -> Iterator[Compared]:
    """Coordinates beside a hole that both have and that some marker moves; errors are taken around the circle."""
    clinical = ClinicalAngles(HumanModel.of(result.subject))
    body = clinical.model.description
    settled = result.tracked & (result.times_s >= result.times_s[0] + SETTLING_S)
    unshown = {name.rsplit("_", 1)[0] for name in result.unobserved_dofs}
    for joint in body.clinical_joints:
        if hole not in (joint.proximal, joint.distal) or {joint.proximal, joint.distal} & unshown:
            continue
        for angle in joint.angles:
            k = result.coordinate_names.index(angle.name)
            away, own = np.angle(np.exp(1j * error[settled, k])), sd[settled, k]
            known = np.isfinite(away) & np.isfinite(own)
            if known.any():
                away, own = away[known], own[known]
                yield Compared(
                    hole,
                    filter,
                    exact,
                    angle.name.removesuffix("_r").removesuffix("_l"),
                    float(np.mean((away / own) ** 2)),
                    float(np.mean(np.abs(away) <= COVERED_SD * own)),
                    float(np.degrees(_rms(away))),
                    float(np.degrees(_rms(own))),
                )
