"""Sessions that the benchmark drops on the page, all synthetic."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.io.c3d_write import write_c3d
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.synth import synthesise

WRONG_KG = 120.0
WALKS, WALK_S = 4, 4.0
FORTY, SHORT_S = 40, 2.5

BAD = "broken.c3d"
"""The file without markers."""


def new_user(folder: Path, seed: int = 0) -> Path:
    """Two statics, four walks, a file without markers, and a wrong mass in the session file; returns the session."""
    session = folder / "Ana"
    session.mkdir(parents=True)
    person = synthesise_subject(seed)
    for k in range(WALKS):
        _, made = synthesise("walk", seconds=WALK_S, seed=seed + k, subject=person)
        write_c3d(_nameless_mass(made.trial), session / f"walk{k + 1}.c3d")
        if k < 2:
            write_c3d(_nameless_mass(made.static), session / f"static{k + 1}.c3d")
    write_c3d(without_markers(made.trial), session / BAD)
    (session / "session.toml").write_text(f"mass_kg = {WRONG_KG}\n", encoding="utf-8")
    return session


def forty(folder: Path, seed: int = 0) -> Path:
    """Forty trials, copies of two walks, with their static; returns the session."""
    session = folder / "Forty"
    session.mkdir(parents=True)
    person = synthesise_subject(seed)
    walks = []
    for k in range(2):
        _, made = synthesise("walk", seconds=SHORT_S, seed=seed + k, subject=person)
        walks.append(session / f"walk{k + 1:02d}.c3d")
        write_c3d(made.trial, walks[k])
    write_c3d(made.static, session / "static.c3d")
    for k in range(2, FORTY):
        shutil.copy(walks[k % 2], session / f"walk{k + 1:02d}.c3d")
    return session


def _nameless_mass(capture: Capture) -> Capture:
    """As most laboratories' files: they do not tell the mass."""
    return replace(capture, subject_mass_kg=None)


def without_markers(capture: Capture) -> Capture:
    """The capture as a file of an instrument alone: no marker, no plate."""
    frames = len(capture.markers.positions_m)
    return replace(
        capture, markers=MarkerTrajectories((), np.zeros((frames, 0, 3)), capture.markers.rate_hz), plates=()
    )
