"""Captures that the simulators play: a walk on a belt over two plates, with 36 or 80 markers, or without names.

Plates of a capture that was written as a file hold their last samples until its last frame's end, which a whole trial
shows, and a stream does not yet; so a run ends two frames before the capture.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.live.runs import Trial
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.trial.synth import synthesise, write_folder

MOTION = "split_belt_walk"

LEFT_FRAMES = 2
"""Frames of the capture's end that are not asked for."""

MANY = 80
"""Markers of a full laboratory set."""

BESIDE_M = np.array([0.02, 0.02, 0.02])
"""A marker that the body does not wear stands so far from one that it does."""


def belt_walk(
    out: Path, seconds: float, rate_hz: float, *, markers: int | None = None, named: bool = True
) -> Trial:
    """A capture, written once.

    Args:
        out: Folder to write.
        seconds: Its duration, s.
        rate_hz: Frame rate.
        markers: Number of its markers, of which the subject wears the usual ones; None for these alone.
        named: Whether its points have names.
    """
    folder = out / f"belt-{seconds:g}s-{rate_hz:g}Hz"
    if not (folder / "truth.h5").is_file():
        subject, made = synthesise(MOTION, seconds=seconds, rate_hz=rate_hz)
        write_folder(subject, made, folder)
    path = folder / "trial.c3d"
    if markers is not None:
        path = _with_more(path, markers)
    frames = round(seconds * rate_hz) + 1 - LEFT_FRAMES
    kind = "" if markers is None else f", {markers} markers"
    name = f"belt {seconds:g} s, {rate_hz:g} Hz{kind}{'' if named else ', points without names'}"
    return Trial(name, path, None, folder / "subject.toml", frames / rate_hz, not named)


def _with_more(path: Path, markers: int) -> Path:
    """The capture with markers beside its own."""
    to = path.with_name(f"trial-{markers}.c3d")
    if not to.is_file():
        capture = read_capture(path, tare=False)
        own = capture.markers
        copies = np.arange(markers - len(own.names)) % len(own.names)
        positions = np.concatenate([own.positions_m, own.positions_m[:, copies] + BESIDE_M], axis=1)
        names = (*own.names, *(f"EXTRA{k + 1}" for k in range(len(copies))))
        write_c3d(replace(capture, markers=replace(own, names=names, positions_m=positions)), to)
    return to
