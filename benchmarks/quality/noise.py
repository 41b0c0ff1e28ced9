"""Innovations of every capture that reconstructs with defaults, and of captures whose markers were spoilt.

The spread's memory and range were set after a look at all captures, so none of these rows is a proof on unseen ones.
Told by: `nis_per_dof` and `nis` of the summary, and remarks in its warnings.
"""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, information
from benchmarks.equality.captures import CAPTURES, Captured, with_static
from mbkf.cli.main import main
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.findings import Finding
from mbkf.io.records import Capture
from mbkf.io.subject import Subject, read_subject
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results import innovations
from mbkf.trial.results.summary import summarise

LOW, HIGH = innovations.BAND
BEFORE_MOST = 4.0
"""Largest innovation squared of Newton's law before correction where plates and body agree: 2 standard deviations."""

SPOILT, SHOWN = ("rajagopal_walk", "biomechzoo_HC044A"), ("biomechzoo_HC032A", "gaitalytics", "synth_squat")
"""Captures that are spoilt: thresholds of remarks were set on the first, the others were only looked at."""

QUICK = ("rajagopal_walk", "biomechzoo_HC044A", "pose2sim_raw")

SLIDES_M, BURST_M = (0.03, 0.05), 0.015
"""How far a marker slides, and standard deviation of cameras that are off for a fifth of a trial. Of a slide by 30 mm
the correction of markers takes half and the pose a part; what is left is what other markers err by."""

MORE = (
    with_static(
        "rehazenter", "rehazenter_walk/2014001_C1_01.c3d", "rehazenter_walk/2014001_ST_static.c3d", 67.0
    ),
    with_static(
        "biobuddy", "biobuddy_functional/functional_right_knee.c3d", "biobuddy_functional/static.c3d", 62.0
    ),
)

PLAIN = ReconstructSettings()
FAST = ReconstructSettings(checks=False, other_contacts=False)
"""For spoilt markers, of which checks and other contacts tell nothing."""


@dataclass(frozen=True)
class Trial:
    """A capture and its person."""

    name: str
    capture: Capture
    subject: Subject


def noise_rows(context: Context) -> list[Check]:
    """Rows of all captures, then of spoilt ones; few with quick."""
    rows: list[Check] = []
    for captured in chosen(context.quick):
        one = prepared(captured, context.require_data(), context.out / "noise" / captured.name)
        rows += capture_rows(one)
        if captured.name in SPOILT + SHOWN:
            rows += spoilt_rows(one, captured.name in SPOILT)
    return rows


def chosen(quick: bool) -> list[Captured]:
    """Each trial once: of encodings of the same one, and of options and settings, only the first is taken."""
    plain = [one for one in CAPTURES if len(one.modes) == 3]
    found = {one.name if "{made}" in one.trial else one.trial: one for one in reversed((*plain, *MORE))}
    return [one for one in reversed(found.values()) if not quick or one.name in QUICK]


def prepared(captured: Captured, data: Path, made: Path) -> Trial:
    """A capture read and its person scaled as its command says, keypoints by the set that is found.

    Args:
        captured: The capture.
        data: Folder of the reference captures.
        made: Folder for what is prepared.
    """
    made.mkdir(parents=True, exist_ok=True)
    for command in captured.prepare:
        words = command
        if captured.name.startswith("pose2sim") and "--protocol" in command:
            at = command.index("--protocol")
            words = (*command[:at], *command[at + 2 :])
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            main([word.format(data=data, made=made) for word in words])
    forces = captured.options[1].format(data=data) if captured.options else None
    trial = Path(captured.trial.format(data=data, made=made))
    return Trial(captured.name, read_capture(trial, forces=forces), read_subject(made / "subject.toml"))


def capture_rows(one: Trial) -> Iterator[Check]:
    """NIS per reading of a capture, and by kind."""
    summary = summarise(reconstruct(one.capture, one.subject, settings=PLAIN))
    nis = summary["nis_per_dof"]
    value = math.nan if nis is None else nis
    yield Check(f"{one.name}: NIS per reading", value, LOW, ">=")
    yield Check(f"{one.name}: NIS per reading", value, HIGH, "<=")
    for kind, found in summary["nis"].items():
        yield information(f"{one.name}: NIS of {kind.replace('_', ' ')}", found)
    noise = [value for value in summary["marker_noise_mm_by_name"].values() if value is not None]
    yield information(f"{one.name}: noise of the median marker", float(np.median(noise)), "mm")


def spoilt_rows(one: Trial, bounded: bool) -> Iterator[Check]:
    """Whether faults of markers are told, and nothing where there are none.

    Args:
        one: The capture.
        bounded: Whether thresholds were set on it; else numbers are for information.
    """
    name = next(
        m.name for m in one.subject.markers if "shank" in m.segment and m.name in one.capture.markers.names
    )
    at = one.capture.markers.names.index(name)
    told = remarks(one, lambda places: places)
    yield Check(f"{one.name}: remarks on innovations as it is", float(len(told)), 0.0, "<=")
    for slide in SLIDES_M:
        found = float(any(name in remark for remark in remarks(one, partial(slid, marker=at, by_m=slide))))
        title = f"{one.name}: a marker sliding {1e3 * slide:g} mm, told"
        large = bounded and slide == max(SLIDES_M)
        yield Check(title, found, 1.0, ">=") if large else information(title, found)
    found = float(any("for 0.5 s" in remark for remark in remarks(one, shaken)))
    title = f"{one.name}: cameras off by 15 mm for a fifth of it, told"
    yield Check(title, found, 1.0, ">=") if bounded else information(title, found)


def remarks(one: Trial, spoil: Callable[[Array], Array]) -> tuple[str, ...]:
    """What is told of the innovations of a capture whose markers are spoilt.

    Args:
        one: The capture.
        spoil: Takes and gives (T, M, 3) places.
    """
    markers = one.capture.markers
    capture = replace(one.capture, markers=replace(markers, positions_m=spoil(markers.positions_m)))
    return innovations.remarks(reconstruct(capture, one.subject, settings=FAST))


def slid(places_m: Array, marker: int, by_m: float) -> Array:
    """Marker positions of which one slides down in the middle of the trial.

    Args:
        places_m: (T, M, 3) places.
        marker: Which one.
        by_m: How far, m.
    """
    found, share = places_m.copy(), np.linspace(0.0, 1.0, len(places_m))
    found[:, marker, 2] -= by_m * np.clip((share - 0.3) / 0.4, 0.0, 1.0)
    return found


def shaken(places_m: Array) -> Array:
    """Marker positions with white noise in the trial's third fifth."""
    found, frames = places_m.copy(), len(places_m)
    off = slice(2 * frames // 5, 3 * frames // 5)
    found[off] += BURST_M * np.random.default_rng(0).normal(size=found[off].shape)
    return found


def law_rows(name: str, judged: Callable[[float], tuple[Finding, ...]], bounded: bool) -> Iterator[Check]:
    """Newton's law before correction: inside with the right mass, outside with wrong ones.

    Args:
        name: The capture.
        judged: Findings with the mass times a factor.
        bounded: Whether bounds hold.
    """
    values = {factor: innovations.before_correction(judged(factor)) for factor in (1.0, 0.75, 0.9, 1.1, 1.3)}
    right, light, heavy = values[1.0], values[0.75], values[1.3]
    title = f"{name}: NIS of Newton's law before correction"
    if right is None or light is None or heavy is None:
        return
    limit = BEFORE_MOST
    yield Check(title, right, limit, "<=") if bounded else information(title, right)
    least, worse = f"{title}, mass 25 % less", f"{title}, mass 30 % more"
    for label, value in ((least, light), (worse, heavy)):
        yield Check(label, value, limit, ">=") if bounded else information(label, value)
    for factor in (0.9, 1.1):
        yield information(f"{title}, mass times {factor:g}", values[factor] or math.nan)
