"""The laboratory that is misused: a folder with a file of every kind that commands read, all synthetic."""

from __future__ import annotations

import hashlib
import os
import shutil
from pathlib import Path

import numpy as np

from benchmarks.commands import mbkf
from benchmarks.robustness.samples import make_samples
from mbkf.io.session import SESSION_FILE

INPUTS = {
    "trial": "trial.c3d", "trc": "trial.trc", "raw": "raw.c3d", "static": "static.c3d", "subject": "subject.toml",
    "forces": "forces.mot", "preset": "own.toml", "protocol": "set.toml", "body": "body.toml", "imus": "imus.csv",
    "mounts": "imus.toml", "truth": "truth.h5", "result": "result", "study": "lab", "list": "list.csv",
    "listed": "list.toml", "norms": "norms.toml", "labels": "labels.json", "session": "results", "osim": "model.osim",
    "model": "person.osim", "emg": "emg.csv", "bands": "bands.csv", "visit": "visit.toml",
    "laboratory": "laboratory.toml", "earlier": "results/P2",
    "qualisys": "qualisys.tsv", "motive": "motive.csv", "still": "still.csv",
}  # fmt: skip
"""Files and folders of the laboratory by the names that cases give them."""

PERSONS, GAIT_S = ("P1", "P2"), 3.0
STATED = 'sex = "female"\nage = 30.0\n'
"""Statements without which a person belongs into no norms."""

LABORATORY = 'name = "Gait laboratory"\n'

REST = '[[subject]]\nname = "P"\nstatic = "static.c3d"\ntrials = ["trial.c3d"]\n'


def made_world(folder: Path) -> Path:
    """Makes the laboratory in a folder, which it returns."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    make_samples(folder)
    shutil.copy(folder / "result" / "reactions.mot", folder / "forces.mot")
    (folder / "result" / "curves.parquet").unlink()
    (folder / "list.toml").write_text(REST, "utf-8")
    (folder / "list.csv").write_text("subject,trial,static\nP,trial.c3d,static.c3d\n", "utf-8")
    (folder / "visit.toml").write_text(STATED + _visit("2026-05-04"), "utf-8")
    (folder / "laboratory.toml").write_text(LABORATORY, "utf-8")
    (folder / "emg.csv").write_text(_emg_table(), "utf-8")
    mbkf("norms", "export", folder / "norms.toml", "--out", folder / "bands.csv")
    mbkf("imu", "synth", folder / "truth.h5", "--out", folder / "imus.csv")
    mbkf("export", folder / "subject.toml", "--to", "osim", "--out", folder / "person.osim")
    for person in PERSONS:
        own = folder / "lab" / person
        own.mkdir(parents=True)
        for name in ("static.c3d", "trial.c3d"):
            shutil.copy(folder / name, own)
    made = folder / "made"
    mbkf("synth", "--motion", "squat", "--seconds", "3", "--out", made)
    mbkf("imu", "synth", made / "truth.h5", "--out", folder / "still.csv")
    mbkf("synth", "--motion", "walk", "--seconds", str(GAIT_S), "--out", made)
    for person in PERSONS:
        (folder / "gait" / person).mkdir(parents=True)
        for name in ("static.c3d", "trial.c3d"):
            shutil.copy(made / name, folder / "gait" / person)
    mbkf("batch", folder / "gait", "--workers", "1", "--filter", "kinematic", "--out", folder / "results")
    for person in PERSONS:
        (folder / "results" / person / SESSION_FILE).write_text(STATED + _visit("2026-02-03"), "utf-8")
    for name in ("made", "gait"):
        shutil.rmtree(folder / name)
    return folder


def digests(folder: Path) -> dict[str, str]:
    """Sums over the content of all files below a folder, by their paths; links count as what they lead to."""
    found = {}
    for place, _, names in os.walk(folder):
        for name in names:
            path = Path(place, name)
            found[str(path.relative_to(folder))] = digest(path)
    return found


def digest(path: Path) -> str:
    """The sum over a file's content, or a word for what is no file."""
    if not path.exists():
        return "missing"
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "no file"


def changed(before: dict[str, str], folder: Path) -> list[str]:
    """Files of an earlier :func:`digests` that have another content now, or are gone."""
    return [name for name, was in before.items() if digest(folder / name) != was]


def _visit(date: str) -> str:
    return f'[visit]\nname = "A. Person"\ndate = {date}\n'


def _emg_table() -> str:
    """Two seconds of one muscle at 1 kHz."""
    signal_v = 1e-4 * np.random.default_rng(0).normal(size=2000)
    rows = (f"{number / 1000:.3f},{value:.3e}" for number, value in enumerate(signal_v))
    return "\n".join(["Time [s],L TIBIALIS ANTERIOR [V]", *rows, ""])
