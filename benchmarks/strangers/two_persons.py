"""Two persons in one file, made from pairs of public captures: both found, each chosen, and followed as if alone.

The bounds of :mod:`mbkf.io.bodies` were set while single captures and other pairs, drawn from those of
:data:`LOOKED_AT`, were looked at. Cases of :data:`SHOWN` hold captures that were in no such pair.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np

from benchmarks.checks import Check
from mbkf.conventions import Array
from mbkf.errors import MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.trc import write_trc
from mbkf.trial.persons import persons_in
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

LASTING_S, MASS_KG = 2.0, 70.0
"""Length of a case, and the mass of everybody: angles hardly depend on it."""

TOUCH_M, PASSING_M_S = 0.05, 1.0
"""Nearest distance of markers of two who touch, and speed of a second person who passes by."""

MOST_MM, MOST_DEG = 1.0, 1.0
"""Bounds of the issue: RMS difference from the file of the person alone."""

Way = Literal["beside", "passing", "touching"]
Style = Callable[[Sequence[str], Sequence[str]], tuple[list[str], list[str]]]

FILES: Mapping[str, str] = {
    "plug_in_gait": "strangers3/one_person_pig.trc",
    "zoo adult": "biomechzoo_walk_turn/HC032A_Straight_HC032A03.c3d",
    "zoo child": "biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d",
    "bmc run": "bmc_walk_run/run.trc",
    "cgm24": "cgm24_lowerlimb_walk/CGM24_Walking01.c3d",
    "basketball": "cmu_basketball/cmu_dribble_shoot_basketball.c3d",
    "flywheel": "flywheel_squat/S1_FlywheelSquat.c3d",
    "functional": "functional_walk/FunctionalWalk.c3d",
    "gait2354": "gait2354_walk/subject01_walk1.trc",
    "gaitalytics": "gaitalytics_walk/overground_fullbody_4plates.c3d",
    "grand challenge": "grand_challenge_knee/ss1.trc",
    "opencap": "opencap_s6_walk/s6_walking1.trc",
    "rajagopal walk": "rajagopal_walk_run/motion_capture_walk.trc",
    "rehazenter": "rehazenter_walk/2014001_C1_01.c3d",
    "stoop": "stoop_lift_box/stoop1_t169_f620f800.c3d",
    "unipd": "unipd_walk/Walking1.c3d",
    "biobuddy": "biobuddy_functional/functional_right_knee.c3d",
    "foreign adult": "foreign_truth/adult/walk/trial.trc",
    "foreign child": "foreign_truth/child/run/trial.trc",
    "jam": "jam_walk/static1.trc",
    "opencap standing": "opencap_s6_walk/s6_static1.trc",
    "ric": "ric_run/20140515T133244_run.c3d",
    "treadmill": "start_off_treadmill/markers.trc",
    "gappy": "opensim_gappy_walk/walking2.c3d",
}

UP = {"ric": "y"}
"""Axes that point up where the file does not say and the movement does not show it."""

LOOKED_AT = tuple(FILES)[:16]
"""Captures from which the pairs were made that settings were chosen on."""

SHOWN = tuple(FILES)[16:]
"""Captures that were looked at alone, in no pair."""


@dataclass(frozen=True)
class Pair:
    """A file of two persons.

    Attributes:
        first, second: Their captures.
        apart_m, turned_deg: Distance of the second one's middle from the first one's, and turn about the vertical.
        style: Spelling of their names.
        way: The second one stays beside the first, passes by or touches.
    """

    first: str
    second: str
    apart_m: float
    turned_deg: float
    style: str
    way: Way = "beside"


def _both(one: str, other: str) -> Style:
    return lambda first, second: (
        [one.format(name) for name in first],
        [other.format(name) for name in second],
    )


STYLES: Mapping[str, Style] = {
    "prefix": _both("A:{}", "B:{}"),
    "word before": _both("P1_{}", "P2_{}"),
    "suffix": _both("{}_A", "{}_B"),
    "second suffixed": _both("{}", "{}-b"),
    "as they are": _both("{}", "{}"),
    "numbered": lambda first, second: (list(first), [f"M{k:03d}" for k in range(len(second))]),
}

PAIRS = (
    Pair("plug_in_gait", "plug_in_gait", 1.2, 90.0, "as they are"),
    Pair("zoo adult", "zoo child", 0.9, 0.0, "as they are"),
    Pair("zoo child", "basketball", 1.6, 180.0, "suffix"),
    Pair("cgm24", "functional", 1.1, 45.0, "prefix"),
    Pair("gait2354", "rajagopal walk", 1.4, 270.0, "numbered"),
    Pair("rajagopal walk", "stoop", 0.8, 30.0, "word before"),
    Pair("rehazenter", "unipd", 2.0, 120.0, "as they are"),
    Pair("opencap", "grand challenge", 1.0, 200.0, "as they are", "passing"),
    Pair("unipd", "zoo adult", 1.0, 10.0, "numbered", "touching"),
    Pair("bmc run", "flywheel", 0.7, 300.0, "second suffixed"),
    Pair("biobuddy", "ric", 1.2, 60.0, "as they are"),
    Pair("biobuddy", "jam", 0.8, 90.0, "numbered"),
    Pair("foreign adult", "foreign adult", 1.5, 150.0, "as they are"),
    Pair("foreign adult", "foreign child", 0.6, 20.0, "suffix"),
    Pair("foreign child", "treadmill", 1.7, 250.0, "second suffixed"),
    Pair("ric", "foreign adult", 1.0, 75.0, "word before", "passing"),
    Pair("ric", "biobuddy", 1.3, 33.0, "numbered"),
    Pair("gappy", "foreign child", 1.1, 310.0, "as they are", "touching"),
    Pair("gappy", "opencap standing", 0.9, 5.0, "prefix"),
    Pair("foreign child", "gappy", 1.9, 222.0, "numbered", "passing"),
    Pair("treadmill", "gappy", 1.4, 100.0, "as they are"),
    Pair("jam", "foreign child", 0.7, 140.0, "numbered", "touching"),
)


def two_persons_rows(data: Path) -> list[Check]:
    """Rows of pairs that are found, chosen and followed, and of single persons taken for two.

    Args:
        data: Folder of the reference captures.
    """
    with tempfile.TemporaryDirectory() as folder:
        outcomes = [_outcome(pair, data, Path(folder) / f"{k}.trc") for k, pair in enumerate(PAIRS)]
    shown = [out for pair, out in zip(PAIRS, outcomes, strict=True) if {pair.first, pair.second} <= {*SHOWN}]
    rows = [
        Check(f"{len(PAIRS)} pairs of persons: not found", sum(not out.found for out in outcomes), 0, "<="),
        Check(
            "two persons: markers of a chosen one",
            _most([out.rms_mm for out in outcomes]),
            MOST_MM,
            "<=",
            "mm",
        ),
        Check(
            "two persons: angles of a chosen one",
            _most([out.rms_deg for out in outcomes]),
            MOST_DEG,
            "<=",
            "°",
        ),
        Check(
            f"two persons: of captures in no pair while bounds were set ({len(shown)}), not right",
            sum(not out.right for out in shown),
            0,
            "<=",
        ),
        Check(
            "two persons: touches that are not reported",
            sum(
                pair.way == "touching" and not out.contact for pair, out in zip(PAIRS, outcomes, strict=True)
            ),
            0,
            "<=",
        ),
    ]
    singles = list(_singles(data))
    accused = sum(len(persons_in(one)) > 0 for one in singles)
    return [*rows, Check(f"one person taken for two ({len(singles)} captures)", accused, 0, "<=")]


@dataclass(frozen=True)
class _Outcome:
    """Outcome of a pair: both found, a contact reported, and differences of the first from the file alone."""

    found: bool
    contact: bool
    rms_mm: float
    rms_deg: float

    @property
    def right(self) -> bool:
        return self.found and self.rms_mm <= MOST_MM and self.rms_deg <= MOST_DEG


def _outcome(pair: Pair, data: Path, path: Path) -> _Outcome:
    first, second = _alone(pair.first, data), _alone(pair.second, data)
    write_trc(_together(pair, first, second), path)
    try:
        found = len(persons_in(read_capture(path))) == 2
        one, other = (read_capture(path, person=number) for number in ("1", "2"))
        contact = any("possible contact" in note for note in one.notes)
        same = _most(
            [_rms_mm(one.markers, first), _rms_mm(other.markers, _placed(pair, first, second), names=False)]
        )
        if not np.isfinite(same):
            return _Outcome(found, contact, np.inf, np.inf)
        chosen = _followed(one, _subject(pair.first, data))
        angles = chosen.angles - _result(pair.first, data).angles
        rms_deg = float(np.degrees(np.sqrt(np.nanmean(angles**2))))
        return _Outcome(found, contact, same, rms_deg)
    except MbkfError:
        return _Outcome(False, False, np.inf, np.inf)


def _most(values: Sequence[float]) -> float:
    """The largest; NaN where one is."""
    return float(np.max(values))


def _rms_mm(read: MarkerTrajectories, truth: MarkerTrajectories, names: bool = True) -> float:
    """RMS distance of markers from the truth; infinite where they are others."""
    alike = read.names == truth.names if names else len(read.names) == len(truth.names)
    if not alike:
        return np.inf
    return float(1e3 * np.sqrt(np.nanmean(((read.positions_m - truth.positions_m) ** 2).sum(axis=2))))


@cache
def _alone(name: str, data: Path) -> MarkerTrajectories:
    """The first seconds of a capture, markers with names that are seen."""
    markers = read_capture(data / FILES[name], up=UP.get(name)).markers
    frames = min(markers.frames, round(LASTING_S * markers.rate_hz))
    first = (markers.frames - frames) // 2
    places = markers.positions_m[first : first + frames]
    kept = [
        m
        for m, own in enumerate(markers.names)
        if not own.startswith("*") and np.isfinite(places[:, m, 0]).mean() > 0.3
    ]
    return MarkerTrajectories(tuple(markers.names[m] for m in kept), places[:, kept], markers.rate_hz)


def _placed(pair: Pair, first: MarkerTrajectories, second: MarkerTrajectories) -> MarkerTrajectories:
    """The second person at the first one's rate, turned, beside the first."""
    rows = first.times_s * second.rate_hz
    period = max(2 * (second.frames - 1), 1)
    rows = np.abs((rows + second.frames - 1) % period - (second.frames - 1))  # forth and back
    below = np.minimum(rows.astype(int), max(second.frames - 2, 0))
    share = (rows - below)[:, None, None]
    after = second.positions_m[np.minimum(below + 1, second.frames - 1)]
    places = (1.0 - share) * second.positions_m[below] + share * after
    turn = np.radians(pair.turned_deg)
    rotation = np.array(
        [[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]]
    )
    level = np.array([1.0, 1.0, 0.0])
    places = (places - level * np.nanmedian(places, axis=(0, 1))) @ rotation.T
    places = places + level * np.nanmedian(first.positions_m, axis=(0, 1)) + [0.0, pair.apart_m, 0.0]
    if pair.way == "passing":
        places = places + (first.times_s - 0.5 * LASTING_S)[:, None, None] * [PASSING_M_S, 0.0, 0.0]
    if pair.way == "touching":
        places = places + np.array([0.0, _until_touch(first.positions_m, places), 0.0])
    return MarkerTrajectories(second.names, places, first.rate_hz)


def _until_touch(first_m: Array, second_m: Array) -> float:
    """The shift along y, from 2 m on, at which the nearest markers touch in the middle of the time."""
    middle = np.arange(2 * len(first_m) // 5, 3 * len(first_m) // 5, max(1, len(first_m) // 50))
    for shift in np.arange(2.0, -2.0, -0.02):
        moved = second_m[middle] + [0.0, shift, 0.0]
        apart = np.linalg.norm(first_m[middle][:, :, None] - moved[:, None], axis=3)
        if np.nanmin(np.nanmedian(apart, axis=0)) < TOUCH_M:
            return float(shift)
    return 0.0


def _together(pair: Pair, first: MarkerTrajectories, second: MarkerTrajectories) -> MarkerTrajectories:
    """Both in one file, with names of the pair's style."""
    placed = _placed(pair, first, second)
    one, other = STYLES[pair.style](first.names, second.names)
    places = np.concatenate([first.positions_m, placed.positions_m], axis=1)
    return MarkerTrajectories((*one, *other), places, first.rate_hz)


def _capture(name: str, data: Path) -> Capture:
    return Capture(name, _alone(name, data))


@cache
def _subject(name: str, data: Path) -> Subject:
    return scale(trials=[_capture(name, data)], mass_kg=MASS_KG)


@cache
def _result(name: str, data: Path) -> Reconstruction:
    return _followed(_capture(name, data), _subject(name, data))


def _followed(capture: Capture, subject: Subject) -> Reconstruction:
    return reconstruct(capture, subject, settings=ReconstructSettings(filter="kinematic", checks=False))


def _singles(data: Path) -> Iterator[Capture]:
    """Every readable capture of one person below the data folder."""
    for path in sorted(data.rglob("*")):
        if path.suffix.lower() not in {".c3d", ".trc"} or "two_persons" in str(path.relative_to(data)):
            continue
        try:
            yield read_capture(path)
        except MbkfError:
            continue
