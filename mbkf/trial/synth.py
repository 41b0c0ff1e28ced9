"""A synthetic capture with exact truth, written to a folder as a laboratory stores its captures."""

from __future__ import annotations

from pathlib import Path

from mbkf.conventions import StageCallback
from mbkf.io.atomic_folder import replacing_folder
from mbkf.io.c3d_write import write_c3d
from mbkf.io.subject import Subject, write_subject
from mbkf.io.truth import write_truth
from mbkf.synthesis.capture import CaptureSettings, SyntheticCapture, synthesise_capture
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.motions import registered_motion
from mbkf.synthesis.person import body_of, synthesise_subject

FILES = ("trial.c3d", "raw.c3d", "static.c3d", "subject.toml", "truth.h5")


def synthesise(
    motion: str,
    *,
    seconds: float | None = None,
    seed: int = 0,
    rate_hz: float = 100.0,
    settings: CaptureSettings | None = None,
    subject: Subject | None = None,
    varied: bool = False,
    progress: StageCallback | None = None,
) -> tuple[Subject, SyntheticCapture]:
    """A subject performing a motion, and the capture of it.

    Args:
        motion: Name of a registered motion, see :mod:`mbkf.synthesis.motions`.
        seconds: Duration; the motion's usual one when None.
        seed: Chooses motion and noise, and the subject where none is given.
        rate_hz: Camera rate.
        settings: Errors of the instruments.
        subject: The person who moves; a random one when None.
        varied: True for a random person whose joint centres, posture and skin differ as people's do
            (:mod:`mbkf.synthesis.anatomy`).
        progress: Called with the stage, items done and items in all.

    Raises:
        UnknownName: The motion does not exist.
        InvalidInput: Duration or rate is impossible.
        NotConverged: This person cannot perform the motion; use another seed.
    """
    report = progress or (lambda *_: None)
    subject = subject or synthesise_subject(seed, varied=varied)
    report("Moving", 0, 2)
    duration = registered_motion(motion).seconds if seconds is None else seconds
    true_motion = synthesise_motion(body_of(subject), motion, duration, rate_hz, seed, subject.habit_deg)
    report("Moving", 1, 2)
    capture = synthesise_capture(subject, true_motion, settings, seed)
    report("Moving", 2, 2)
    return subject, capture


def write_folder(subject: Subject, capture: SyntheticCapture, folder: str | Path) -> tuple[Path, ...]:
    """Writes trial.c3d, raw.c3d, static.c3d, subject.toml and truth.h5, each whole or not at all.

    Args:
        subject: The person.
        capture: The synthetic capture and its truth.
        folder: Folder to write; it is made where it does not exist.

    Raises:
        FileFormatError: The folder is a file.
        OSError: The folder cannot be written.
    """
    with replacing_folder(folder, last=FILES[-1]) as partial:
        paths = [partial / name for name in FILES]
        for recorded, path in zip((capture.trial, capture.raw, capture.static), paths[:3], strict=True):
            write_c3d(recorded, path)
        write_subject(subject, paths[3])
        write_truth(capture.truth, paths[4])
    return tuple(Path(folder).absolute() / name for name in FILES)
