"""The laboratory of the pictures: made persons, visits, conditions, electromyograms and a film beside a trial."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.app.sessions import BAD, without_markers
from benchmarks.dynamic.methods import tared
from benchmarks.session.change import MOTIONS, register_bent_walk
from mbkf.cli.main import main as mbkf_command
from mbkf.conventions import Array
from mbkf.io.c3d_write import write_c3d
from mbkf.io.laboratory import Laboratory, write_laboratory
from mbkf.io.records import AnalogChannel, Capture
from mbkf.io.subject import Subject
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.synth import synthesise

VISITS = {"Ana/1 before": "2025-02-03", "Ana/2 after": "2025-05-12", "Ana/3 later": "2025-08-25"}
"""Day of each visit; she walks with bent knees in the first one."""

OTHERS = {"Ben": 5, "Cleo": 7, "Dan": 15}
"""Persons of the norms, by the seeds of their bodies."""

WAITING = "Eva"
"""A session that is not calculated yet."""

FILMED = ("Ana/3 later", "walk1")
"""The trial with a film."""

ORTHOSIS = "orthosis"

SEED, SECONDS = 4, 4.0
TRIALS = 3
EMG_HZ, EMG_SEED = 1000.0, 5
SWINGING_M_S, BEFORE_S = 0.5, 0.2

_VISIT = """name = "Ana"
sex = "female"
age = 34

[visit]
date = {day}
birth_date = 1990-11-02
condition = "barefoot"
side = "both"
diagnosis = "Crouch gait"
notes = "Walks at her own speed."
clinician = "Dr. E. Example"
"""

_OTHER = """sex = "{sex}"
age = {age}
"""


def laboratory(folder: Path) -> Path:
    """Writes captures and statements of all sessions.

    Args:
        folder: An empty folder.

    Returns:
        The folder.
    """
    register_bent_walk()
    folder.mkdir(parents=True, exist_ok=True)
    ana = synthesise_subject(SEED)
    for number, (name, day) in enumerate(VISITS.items()):
        _visit(folder / name, day, ana, MOTIONS[number < 1], number)
    for k, (name, seed) in enumerate(OTHERS.items()):
        _walks(folder / name, synthesise_subject(seed), MOTIONS[0], {"walk1": 100 + k})
        text = _OTHER.format(sex=("male", "female")[k % 2], age=31 + 4 * k)
        (folder / name / "session.toml").write_text(text, encoding="utf-8")
    write_laboratory(Laboratory("Gait laboratory", "1 Example Road\nExampletown"), folder)
    _walks(folder / WAITING, synthesise_subject(6), MOTIONS[0], {"walk1": 200, "walk2": 201})
    return folder


def film(folder: Path) -> None:
    """Makes a film of a result and puts it beside the capture, where it stands for a camera's.

    Args:
        folder: The laboratory's, with results.
    """
    session, trial = FILMED
    file = folder / session / f"{trial}.mp4"
    assert (
        mbkf_command(["export", str(folder / "results" / session / trial), "--to", "mp4", "--out", str(file)])
        == 0
    )


def _visit(folder: Path, day: str, who: Subject, motion: str, number: int) -> None:
    """A visit: barefoot, and with orthoses that keep the knees bent; a file without markers in the second."""
    seeds = {f"walk{k + 1}": 10 * number + k for k in range(TRIALS)}
    trial = _walks(folder, who, motion, seeds)
    text = _VISIT.format(day=day)
    if number == 1:
        braced = {f"{ORTHOSIS}{k + 1}": 50 + k for k in range(TRIALS)}
        _walks(folder, who, MOTIONS[1], braced)
        text += "".join(f'\n[trial.{name}]\ncondition = "{ORTHOSIS}"\n' for name in braced)
        write_c3d(without_markers(trial), folder / BAD)
    (folder / "session.toml").write_text(text, encoding="utf-8")


def _walks(folder: Path, who: Subject, motion: str, seeds: dict[str, int]) -> Capture:
    """Walks of a person by name, and the standing trial; returns the last walk."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, seed in seeds.items():
        _, made = synthesise(motion, seconds=SECONDS, seed=seed, subject=who)
        write_c3d(with_muscles(tared(made.trial), seed), folder / f"{name}.c3d")
    write_c3d(tared(made.static), folder / "static.c3d")
    return made.trial


def with_muscles(capture: Capture, seed: int) -> Capture:
    """The capture with two muscles of each shank: one active while the foot swings, one before that.

    Args:
        capture: A walk with the heels' markers.
        seed: Of the noise.
    """
    rng = np.random.default_rng([EMG_SEED, seed])
    rate_hz = capture.markers.rate_hz
    per_frame = round(EMG_HZ / rate_hz)
    channels = []
    for side in "RL":
        heel = capture.markers.positions_m[:, capture.markers.names.index(f"{side}HEE")]
        heel = np.where(np.isnan(heel), np.nanmean(heel, axis=0), heel)
        swings = np.linalg.norm(np.gradient(heel, 1.0 / rate_hz, axis=0), axis=1) > SWINGING_M_S
        soon = np.roll(swings, -round(BEFORE_S * rate_hz))
        for muscle, active in (("Tibialis Anterior", swings), ("Gastrocnemius", soon & ~swings)):
            volts = 1e-4 * _noise(rng, np.repeat(active, per_frame))
            channels.append(AnalogChannel(f"{side} {muscle}", volts, "V", rate_hz * per_frame))
    return replace(capture, analog=(*capture.analog, *channels))


def _noise(rng: np.random.Generator, active: Array) -> Array:
    """White noise that is ten times as large while a muscle is active, (S,)."""
    return (0.1 + active) * rng.standard_normal(len(active))
