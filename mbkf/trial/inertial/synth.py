"""Virtual sensors on a motion that was reconstructed (``motion.h5``), made (``truth.h5``) or is of AMASS (``.npz``)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.imu.placement import EIGHT, typical_mounts
from mbkf.imu.virtual import ImuErrors, virtual_imus
from mbkf.io.amass import read_amass
from mbkf.io.imu.mount import ImuMount
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.results_h5 import read_h5
from mbkf.io.subject import Subject, read_subject
from mbkf.io.truth import read_truth
from mbkf.model.human import HumanModel
from mbkf.synthesis.smpl import motion_of_smpl


@dataclass(frozen=True)
class BodyMotion:
    """A motion of a scaled body: (T,) times s, (T, nq) configurations, (T, nv) velocities and accelerations."""

    model: HumanModel
    times_s: Array
    q: Array
    v: Array
    a: Array


def read_motion(path: str | Path, subject: str | Path | None = None) -> BodyMotion:
    """Reads a motion: a reconstruction brings its subject, a truth file has it beside it or named.

    Raises:
        FileFormatError: The file is missing or neither kind.
        InvalidInput: No frame was tracked.
    """
    path = Path(path)
    if path.is_dir():
        path = next(
            (path / name for name in ("motion.h5", "truth.h5") if (path / name).is_file()), path / "motion.h5"
        )
    if path.name == "truth.h5" or subject is not None:
        truth = read_truth(path)
        person = read_subject(subject or path.with_name("subject.toml"))
        return BodyMotion(_body(person), truth.times_s, truth.q, truth.v, truth.a)
    made = read_h5(path)
    there = np.all(np.isfinite(np.hstack([made.q, made.a])), axis=1)
    if not there.any():
        raise InvalidInput(f"{path}: no frame was tracked")
    first, last = int(np.argmax(there)), len(there) - int(np.argmax(there[::-1]))
    if not there[first:last].all():
        raise InvalidInput(f"{path}: frames in the middle were not tracked; virtual sensors need them all")
    part = slice(first, last)
    return BodyMotion(_body(made.subject), made.times_s[part], made.q[part], made.v[part], made.a[part])


def read_amass_motion(path: str | Path, person: Subject, up: str = "z") -> BodyMotion:
    """Reads a motion of AMASS onto the body of a person (:func:`mbkf.synthesis.smpl.motion_of_smpl`).

    Args:
        path: The file, ``.npz``.
        person: The person, whose segments have lengths of their own.
        up: Axis of the file's world that points up, "z" (AMASS) or "y".

    Raises:
        FileFormatError: The file is missing, damaged or holds no motion.
        InvalidInput: Fewer than six frames.
        UnknownName: Another axis.
    """
    model = _body(person)
    moved = motion_of_smpl(model, read_amass(path), up)
    return BodyMotion(model, moved.times_s, moved.q, moved.v, moved.a)


def _body(person: Subject) -> HumanModel:
    return HumanModel.of(person)


def synthesise_imus(
    motion: BodyMotion,
    *,
    segments: Sequence[str] = EIGHT,
    mounts: Sequence[ImuMount] = (),
    errors: ImuErrors | None = None,
    rate_hz: float | None = None,
    seed: int = 0,
    careless: bool = True,
) -> tuple[tuple[ImuMount, ...], tuple[ImuReadings, ...]]:
    """Mounts and readings of sensors on a motion.

    Args:
        motion: The motion.
        segments: Segments that carry one sensor each, at its usual place.
        mounts: Sensors placed anywhere instead.
        errors: Their errors; None: a consumer unit's.
        rate_hz: Sample rate; None: the motion's.
        seed: Chooses errors and how carelessly sensors were put on.
        careless: Whether they were.

    Raises:
        InvalidInput: A segment has no usual place, or the motion is too short.
        UnknownName: A mount's segment does not exist.
    """
    if rate_hz is not None and not 5.0 <= rate_hz <= 5000.0:
        raise InvalidInput(f"a sensor's rate lies between 5 and 5000 Hz, got {rate_hz:g} Hz")
    placed = tuple(mounts) or typical_mounts(motion.model, tuple(segments), seed if careless else None)
    readings = virtual_imus(
        motion.model,
        motion.times_s,
        motion.q,
        motion.v,
        motion.a,
        placed,
        errors=errors,
        seed=seed,
        rate_hz=rate_hz,
    )
    return placed, readings
