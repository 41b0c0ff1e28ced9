"""Right answers on the shared captures, as the readme file of each states them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial

import numpy as np

from benchmarks.checks import Check, within
from benchmarks.commands import typed
from benchmarks.strangers.trial import Trial
from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.capture import read_capture
from mbkf.io.results import Reconstruction

STATIC_N = (287.0, 309.0)
"""Vertical loads of the plates under the feet of `functional_walk`."""

HIP_NM_PER_KG = 3.0
STANDING_MOMENT_NM = (-25.0, -15.0)
MIDDLE_MM = 80.0
"""Distance within half a foot's length in which a standing person's centre of pressure lies; at the origin's torques it
was 276 mm off."""

PULL = 0.64
"""Pull of the flywheel over body weight."""

KNOWN_ANKLE_DEG = 6.0
"""Standard deviation of an ankle with forefoot markers; without them it is 9°."""


def _yes(name: str, value: bool) -> Check:
    return Check(name, float(value), 1.0, ">=")


def _no_other_support(trial: Trial) -> Iterator[Check]:
    count = len(trial.supports()) if trial.result is not None else np.nan
    yield Check("supports besides the feet", count, 0, "<=")


def _functional_walk(trial: Trial) -> Iterator[Check]:
    plates = read_capture(trial.data / "FunctionalStatic.c3d").plates
    standing = [float(plate.force_n[:, 2].mean()) for plate in plates]
    both = standing[: len(STATIC_N)]
    off = np.abs(np.subtract(both, STATIC_N)).max() if len(both) == len(STATIC_N) else np.nan
    yield Check("standing, plates against 287 and 309 N", off, 2.0, "<=", "N")
    peaks = (
        [] if trial.summary is None else [trial.summary["torque_peak_nm_per_kg"][f"hip_{s}"] for s in "rl"]
    )
    largest = max((abs(one) for one in peaks if one is not None), default=np.nan)
    yield Check("largest hip moment", largest, HIP_NM_PER_KG, "<=", "N m/kg")


def _fukuchi_run(trial: Trial) -> Iterator[Check]:
    yield from _no_other_support(trial)
    said = trial.said("reconstruct")
    yield _yes("60.3 kg: no remark on the mass", bool(said) and "mass against plates:" not in said)
    heavier = Trial(trial.data, trial.out / "65kg")
    heavier.out.mkdir(exist_ok=True)
    subject, result = heavier.out / "subject.toml", heavier.out / "result"
    typed("scale", trial.data / "RBDS001static.c3d", "--mass", "65", "--out", subject)
    said = typed("reconstruct", trial.data / "RBDS001runT35.c3d", "--subject", subject, "--out", result).text
    yield _yes("65 kg: the mass is reported", "mass against plates:" in said)
    for row in _no_other_support(heavier):
        yield Check(f"65 kg: {row.name}", row.value, row.bound, row.relation, row.unit)


def _start_off_treadmill(trial: Trial) -> Iterator[Check]:
    forces = trial.data / "grf.mot"
    said = " ".join(typed("info", trial.data / "markers.trc", "--forces", forces).text.split())
    yield _yes(
        "reported: torques are moved to the centre of pressure", "centre of pressure, about which" in said
    )
    moment = off_mm = np.nan
    if trial.result is not None:
        result = trial.result
        standing = np.flatnonzero(result.loads.source[:, :2].all(axis=1))[: round(result.rate_hz)]
        moment = float(np.nanmean(result.moment("ankle_angle_l")[standing]))
        off_mm = 1e3 * float(np.nanmedian(_from_foot(result)[standing]))
    yield from within(
        "left ankle moment in the first second on both feet", moment, *STANDING_MOMENT_NM, "N m"
    )
    yield Check("centre of pressure from the left foot's markers, across", off_mm, MIDDLE_MM, "<=", "mm")


def _from_foot(result: Reconstruction) -> Array:
    """(T,) distance on the floor of the left foot's centre of pressure from the middle of heel and toe markers, m."""
    columns = [result.marker_names.index(name) for name in ("LHEE", "LTOE", "LMT5")]
    middle = np.nanmean(result.predicted_m[:, columns], axis=1)
    return np.asarray(np.linalg.norm((result.foot_cop_m[:, 1] - middle)[:, :2], axis=1))


def _french_walk(trial: Trial) -> Iterator[Check]:
    """The part ``holes`` holds the spreads against exact truth."""
    yield _yes(
        "reported: the pelvis has no markers", "the pelvis has no markers" in trial.said("reconstruct")
    )
    for part in ("trunk", "right_leg", "left_leg"):
        yield _yes(f"the verdict on the {part} is not 'use'", trial.word(part) in ("look", "do not use"))


def _used(names: Iterable[str], trial: Trial) -> Iterator[Check]:
    ignored = None if trial.summary is None else trial.summary["markers_ignored"]
    count = np.nan if ignored is None else sum(name in ignored for name in names)
    yield Check(f"{' '.join(names)}: left out", count, 0, "<=")


def _unipd_walk(trial: Trial) -> Iterator[Check]:
    yield from _used(("RVMH", "RIMH", "RIIT", "LVMH", "LIMH", "LIIT"), trial)
    for side in "rl":
        yield Check(
            f"ankle_angle_{side}, sd", trial.sd_deg(f"ankle_angle_{side}"), KNOWN_ANKLE_DEG, "<=", "°"
        )


def _flywheel_squat(trial: Trial) -> Iterator[Check]:
    summary = trial.summary
    if summary is None:
        yield Check("unexplained force", np.nan, 0.0, ">=")
        return
    weight_n = summary["mass_kg"] * GRAVITY_M_S2
    largest = max((one["force_n"] for one in summary["unexplained"]), default=0.0)
    yield from within("unexplained force over body weight", largest / weight_n, 0.85 * PULL, 1.15 * PULL)
    yield _yes(
        "loads of both legs are not to be used",
        all(trial.word(f"{side}_leg_loads") == "do not use" for side in ("right", "left")),
    )


def _two_persons(trial: Trial) -> Iterator[Check]:
    said = typed("info", trial.data / "ART-Human_2persons_integer.c3d").text
    yield _yes("both are named", "Human1" in said and "Human2" in said)
    markers = () if trial.result is None else trial.result.marker_names
    yield _yes("the chosen one is followed", bool(markers) and not any("Human2" in name for name in markers))


def _nothing_else(trial: Trial) -> Iterator[Check]:
    yield _yes("read", trial.result is not None)


ANSWERS: Mapping[str, Callable[[Trial], Iterator[Check]]] = {
    "ric_run": _no_other_support,
    "functional_walk": _functional_walk,
    "fukuchi_run": _fukuchi_run,
    "start_off_treadmill": _start_off_treadmill,
    "landings": _no_other_support,
    "french_walk_no_pelvis": _french_walk,
    "unipd_walk": _unipd_walk,
    "flywheel_squat": _flywheel_squat,
    "cmu_basketball": partial(_used, ("LFWT", "RFWT", "LBWT", "RBWT")),
    "jam_walk": _nothing_else,
    "two_persons_art": _two_persons,
}
"""Rows of a reconstructed capture's right answers, by its folder."""
