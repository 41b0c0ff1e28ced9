"""Metrics of short synthetic trials with known truth, and of public captures as they are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.dynamic.captures import load
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.sensors.block import Frame
from mbkf.trial.label import label
from mbkf.trial.labelling.score import score
from mbkf.trial.live.filter import LiveFilter, live_inputs
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.settings import Hidden, ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise
from mbkf.trial.results.truth import truth_beside
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise, write_folder

LOWER, HIGHER, NEAR_ONE = "lower", "higher", "near one"
"""Which way a number is better; the last is of consistency, told as its distance from one."""

TRIALS = {"walk": 4.0, "squat": 3.0}
"""Synthetic motions and their length, s."""

REAL = ("rajagopal walk", "gait2354")


@dataclass(frozen=True)
class Metric:
    """A number that the gate holds.

    Attributes:
        name: What it is of.
        value: The number; NaN is a regression.
        unit: Its unit.
        better: Which way it is better.
        is_time: Whether it is a ratio of times, which no two computers share.
    """

    name: str
    value: float
    unit: str = ""
    better: str = LOWER
    is_time: bool = False


Change = Callable[[ReconstructSettings], ReconstructSettings]
"""What a test worsens."""


def synthetic_metrics(motion: str, seconds: float, folder: Path, changed: Change) -> Iterator[Metric]:
    """A motion from its points without names to its result, by both filters, causal and smoothed.

    Args:
        motion: The motion.
        seconds: Its length.
        folder: For files.
        changed: Changes the settings.
    """
    person, made = synthesise(motion, seconds=seconds, varied=True)
    write_folder(person, made, folder)
    subject = scale(read_capture(folder / "static.c3d"), mass_kg=person.mass_kg)
    yield Metric(f"{motion}: scaling's marker RMS", _number(subject.report["marker_rms_mm"]), "mm")
    capture = read_capture(folder / "trial.c3d")
    named = label(read_capture(folder / "raw.c3d"), subject)
    found = score(named.markers, capture.markers, subject)
    yield Metric(f"{motion}: labels right", 100.0 * found.correct_fraction, "%", HIGHER)
    yield Metric(f"{motion}: labels wrong", 100.0 * found.wrong_fraction, "%")
    truth = truth_beside(folder / "trial.c3d")
    for name, settings in variants(capture, seconds).items():
        result = reconstruct(capture, subject, settings=changed(settings))
        yield from told(f"{motion}, {name}", result, truth)
    streamed = live_marker_rms_mm(folder, subject, changed)
    yield Metric(f"{motion}, live: marker RMS", streamed, "mm")


def variants(capture: Capture, seconds: float) -> Mapping[str, ReconstructSettings]:
    """The settings by which a synthetic capture is reconstructed, by name.

    Args:
        capture: The capture.
        seconds: Its length.
    """
    plain = ReconstructSettings(keep_covariance=True)
    plates = tuple(plate.name for plate in capture.plates)
    hidden = (Hidden(capture.markers.names[::4], 0.4 * seconds, 0.4 * seconds + 0.3),)
    return {
        "smoothed": plain,
        "causal": replace(plain, smooth=False),
        "kinematic": replace(plain, filter="kinematic"),
        "without plates": replace(plain, without_plates=plates),
        "hidden": replace(plain, hide=hidden),
    }


def real_metrics(name: str, data: Path, changed: Change) -> Iterator[Metric]:
    """A public capture, smoothed and causal.

    Args:
        name: Among :data:`benchmarks.dynamic.captures.SOURCES`.
        data: Folder of the reference captures.
        changed: Changes the settings.
    """
    person = load(name, data, correct=False)
    for kind, smooth in (("smoothed", True), ("causal", False)):
        settings = changed(ReconstructSettings(smooth=smooth))
        result = reconstruct(person.capture, person.subject, settings=settings)
        yield from told(f"{name}, {kind}", result, None)


def told(name: str, result: Reconstruction, truth: object) -> Iterator[Metric]:
    """What a result's summary tells of its quality.

    Args:
        name: Beginning of the metrics' names.
        result: The result.
        truth: What is known of the motion; None where nothing is.
    """
    summary = summarise(result, truth)  # type: ignore[arg-type]
    yield Metric(f"{name}: marker RMS", _number(summary["marker_rms_mm"]), "mm")
    yield Metric(f"{name}: valid frames", 100.0 * summary["valid_frames"] / summary["frames"], "%", HIGHER)
    if summary["nis_per_dof"] is not None:
        yield Metric(f"{name}: NIS", _number(summary["nis_per_dof"]), "", NEAR_ONE)
    if summary["hidden_marker_rms_mm"] is not None:
        yield Metric(f"{name}: hidden markers", _number(summary["hidden_marker_rms_mm"]), "mm")
    if summary["residual_force_rms_n"] is not None:
        yield Metric(f"{name}: residual force", _number(summary["residual_force_rms_n"]), "N")
    for key, value in (summary["truth"] or {}).items():
        quantity, unit = ERRORS.get(key, (key, ""))
        if value is not None:
            yield Metric(f"{name}: {quantity}", float(value), unit, NEAR_ONE if "nees" in key else LOWER)


ERRORS: Mapping[str, tuple[str, str]] = {
    "angle_rms_deg": ("angle RMS", "°"),
    "velocity_rms_rad_s": ("velocity RMS", "rad/s"),
    "torque_rms_nm": ("torque RMS", "N m"),
    "reaction_rms_n": ("reaction RMS", "N"),
    "nees_per_dof": ("NEES", ""),
}
"""Errors against the truth: what the gate calls them, and their units."""


def live_marker_rms_mm(folder: Path, subject: Subject, changed: Change) -> float:
    """Distance of the markers from the body that the live filter follows frame by frame, mm.

    Args:
        folder: With the trial.
        subject: The person.
        changed: Changes the settings.
    """
    capture = read_capture(folder / "trial.c3d")
    settings = changed(ReconstructSettings(smooth=False, correct_markers=False))
    live = live_inputs(capture.markers.names, capture.markers.rate_hz, (), subject, settings)
    filter = LiveFilter(tracking_filter("kinematic", live.inputs))
    apart = []
    for number, markers in enumerate(capture.markers.positions_m[:, live.columns]):
        for step in filter.push(number, Frame(markers, np.zeros((0, 6)))):
            if step.estimate is not None:
                shown = capture.markers.positions_m[step.number, live.columns]
                apart.append(live.inputs.sensor.positions(step.estimate.q) - shown)
    return 1e3 * float(np.sqrt(np.nanmean(np.sum(np.square(apart), axis=-1))))


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else float("nan")
