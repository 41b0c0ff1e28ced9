"""The commands that are killed: what they start from, and what must be there afterwards."""

from __future__ import annotations

import json
import math
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

from mbkf.errors import MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.results_opensim import MARKERS_FILE
from mbkf.io.storage import read_storage
from mbkf.io.subject import read_subject
from mbkf.io.trc import read_trc
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.trial.synth import synthesise, write_folder

RATE_HZ = 100.0
OLD_FRAMES, NEW_FRAMES = 101, 141
OLD_MASS, NEW_MASS = 61.0, 62.0
LIVE_FRAMES, LOST_S = 401, 1.0
"""How much is streamed, and how much before a kill need not be recovered."""

NOTE = "note.txt"
"""A file of the user's in each folder of results; it must stay."""

RESULT, TARGET = "result", "target"


@dataclass(frozen=True)
class Job:
    """A command that is killed.

    Attributes:
        name: Its name.
        arguments: What it is called with in the folder that holds what it writes.
        start: A folder with the old result; each kill begins with a copy.
        state: "old" or "new", told of the folder and of the clock's time when the command ended, or what is wrong.
        again: Whether it is run once more after a kill, and then must leave the new result and nothing else; one that
            lasts as long as its source is killed at times only.
        steps: Steps with files that it takes; 0 where they are not counted.
        span_s: Between which times it is killed.
    """

    name: str
    arguments: Callable[[Path], list[str]]
    start: Path
    state: Callable[[Path, float], str]
    again: bool = True
    steps: int = 0
    span_s: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Kill:
    """A kill.

    Attributes:
        job: The command.
        after_s: After which time from its start.
        step: Before which step instead; 0 for the time.
    """

    job: Job
    after_s: float = 0.0
    step: int = 0

    @property
    def told(self) -> str:
        """The kill in words."""
        when = f"before step {self.step}" if self.step else f"after {self.after_s:.3f} s"
        return f"{self.job.name} {when}"


def outcome(kill: Kill, place: Path) -> str:
    """Kills a command and tells what is there: "old", "new", or what is wrong.

    Args:
        kill: When it is killed.
        place: A folder that does not exist yet; removed where nothing is wrong.
    """
    shutil.copytree(kill.job.start, place)
    process = _started(kill.job, place, kill.step)
    try:
        process.wait(None if kill.step else kill.after_s)
    except subprocess.TimeoutExpired:
        _kill(process)
    found = _state(kill.job, place, time.time())
    again = _again(kill.job, place) if kill.job.again else ""
    if found in {"old", "new"} and not again:
        shutil.rmtree(place)
        _told(place).unlink()
        return found
    return again or found


def _again(job: Job, place: Path) -> str:
    """What is wrong after the command has run once more; empty for nothing."""
    process = _started(job, place, 0)
    process.wait()
    found = _state(job, place, time.time())
    left = [path.name for path in place.rglob(".*")]
    if process.returncode or found != "new" or left:
        return f"run again: exit {process.returncode}, {found}, left over: {left}"
    return ""


def _started(job: Job, place: Path, step: int) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "benchmarks.kills.killed", str(place), str(step), *job.arguments(place)]
    with _told(place).open("w") as told:
        return subprocess.Popen(command, stdout=told, stderr=told, text=True, start_new_session=True)


def _told(place: Path) -> Path:
    """The file of what a command printed."""
    return place.with_name(f"{place.name}.txt")


def _kill(process: subprocess.Popen[str]) -> None:
    """Ends a command and all of its processes at once, as a power cut would."""
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _state(job: Job, place: Path, ended: float) -> str:
    try:
        return job.state(place, ended)
    except (MbkfError, OSError, ValueError, AssertionError) as error:
        return f"{type(error).__name__}: {' '.join(str(error).split())}"


def jobs(folder: Path) -> tuple[Job, ...]:
    """The commands, measured once each.

    Args:
        folder: Where their captures and old results are made.
    """
    shutil.rmtree(folder, ignore_errors=True)
    old, new = _captures(folder / "old", OLD_FRAMES), _captures(folder / "new", NEW_FRAMES)
    long = _captures(folder / "long", LIVE_FRAMES)
    made = [
        _reconstruct(folder, old, new),
        _scale(folder, new),
        _label(folder, old, new),
        _batch(folder, old, new),
        _live(folder, long),
    ]
    return tuple(_measured(job, folder / "measured") for job in made)


def _captures(folder: Path, frames: int) -> Path:
    subject, capture = synthesise("walk", seconds=(frames - 1) / RATE_HZ, rate_hz=RATE_HZ)
    assert capture.trial.markers.frames == frames
    write_folder(subject, capture, folder)
    return folder


def _measured(job: Job, place: Path) -> Job:
    """The job with its steps and the time that it takes."""
    for _ in range(2):  # the first time it is slower
        shutil.copytree(job.start, place)
        begin = time.monotonic()
        process = _started(job, place, 0)
        process.wait()
        seconds = time.monotonic() - begin
        told = _told(place).read_text()
        if process.returncode:
            raise RuntimeError(f"{job.name} itself fails: {told}")
        shutil.rmtree(place)
    steps = int(told.rstrip().rsplit(" ", 1)[1])
    earliest = job.span_s[0]
    return replace(job, steps=steps if job.again else 0, span_s=(earliest, max(seconds, earliest)))


def _prepared(folder: Path, name: str, arguments: list[str]) -> Path:
    """A folder with an old result and a note in it."""
    place = folder / f"start-{name}"
    (place / RESULT).mkdir(parents=True)
    (place / RESULT / NOTE).write_text(NOTE)
    subprocess.run([sys.executable, "-m", "mbkf", *arguments], check=True, capture_output=True)
    return place


def _reconstruct(folder: Path, old: Path, new: Path) -> Job:
    def arguments(source: Path, place: Path) -> list[str]:
        subject = str(source / "subject.toml")
        return [
            "reconstruct", str(source / "trial.c3d"), "--subject", subject, "--filter", "kinematic",
            "--out", str(place / RESULT),
        ]  # fmt: skip

    start = _prepared(folder, "reconstruct", arguments(old, folder / "start-reconstruct"))
    return Job("reconstruct", partial(arguments, new), start, lambda place, _: result_state(place / RESULT))


def result_state(folder: Path) -> str:
    """Whether a folder of results holds the old or the new one, whole.

    Raises:
        MbkfError: A file cannot be read.
        AssertionError: Files are not of one run, or the user's is gone.
    """
    result, summary = read_reconstruction(folder), read_summary(folder)
    runs = {summary["run_id"]}
    for table in (*folder.glob("*.mot"), *folder.glob("*.sto")):
        runs.add(read_storage(table).header["run"])
    assert len(runs) == 1, f"files of {len(runs)} runs"
    assert (
        result.frames == summary["frames"] == read_trc(folder / MARKERS_FILE, CaptureOptions()).markers.frames
    )
    assert (folder / NOTE).read_text() == NOTE
    return _age(result.frames)


def _age(frames: int) -> str:
    """Which one has so many frames.

    Raises:
        AssertionError: Neither has.
    """
    assert frames in {OLD_FRAMES, NEW_FRAMES}, f"{frames} frames"
    return "old" if frames == OLD_FRAMES else "new"


def _scale(folder: Path, new: Path) -> Job:
    def arguments(mass: float, place: Path) -> list[str]:
        return ["scale", str(new / "static.c3d"), "--mass", str(mass), "--out", str(place / f"{TARGET}.toml")]

    def state(place: Path, _: float) -> str:
        return "old" if read_subject(place / f"{TARGET}.toml").mass_kg == OLD_MASS else "new"

    start = _prepared(folder, "scale", arguments(OLD_MASS, folder / "start-scale"))
    return Job("scale", partial(arguments, NEW_MASS), start, state)


def _label(folder: Path, old: Path, new: Path) -> Job:
    def arguments(source: Path, place: Path) -> list[str]:
        subject = str(source / "subject.toml")
        return ["label", str(source / "raw.c3d"), "--subject", subject, "--out", str(place / f"{TARGET}.c3d")]

    def state(place: Path, _: float) -> str:
        frames = read_capture(place / f"{TARGET}.c3d").markers.frames
        told = place / f"{TARGET}.json"
        if told.exists():  # it may be missing, but never tell of another capture
            assert json.loads(told.read_text())["frames"] == frames
        return _age(frames)

    start = _prepared(folder, "label", arguments(old, folder / "start-label"))
    return Job("label", partial(arguments, new), start, state)


def _batch(folder: Path, old: Path, new: Path) -> Job:
    """Two trials of one person; each of them is old or new."""

    def arguments(study: Path, place: Path) -> list[str]:
        return ["batch", str(study), "--out", str(place / RESULT), "--workers", "1"]

    def study(source: Path, name: str) -> Path:
        person = folder / name / "P"
        person.mkdir(parents=True)
        shutil.copy(old / "static.c3d", person)
        for trial in ("walk1", "walk2"):
            shutil.copy(source / "trial.c3d", person / f"{trial}.c3d")
        return person.parent

    def state(place: Path, _: float) -> str:
        out = place / RESULT
        trials = [out / "P" / name for name in ("walk1", "walk2")]
        words = [result_state(trial) for trial in trials]
        assert len(pq.read_table(out / "summary.parquet")) == len(trials)
        return "new" if words == ["new", "new"] else "old"

    start = folder / "start-batch"
    _prepared(folder, "batch", arguments(study(old, "old-study"), start))
    for trial in (start / RESULT / "P").glob("walk*"):
        (trial / NOTE).write_text(NOTE)
    return Job("batch", partial(arguments, study(new, "new-study")), start, state)


def _live(folder: Path, long: Path) -> Job:
    """A capture is played in real time; what is recovered must reach to within a second of the kill."""

    def arguments(place: Path) -> list[str]:
        trial, subject = str(long / "trial.c3d"), str(long / "subject.toml")
        return ["live", "--from", f"file:{trial}", "--subject", subject, "--out", str(place / RESULT)]

    def state(place: Path, ended: float) -> str:
        result = place / RESULT
        if not (result / LOG_FOLDER).exists():
            return "new" if (result / "motion.h5").exists() else "old"
        begun = _told(place).stat().st_mtime  # when it said that it follows the stream
        recovered = subprocess.run(
            [sys.executable, "-m", "mbkf", "live", "--recover", str(result)],
            check=False,
            capture_output=True,
            text=True,
        )
        due = math.floor((ended - begun - LOST_S) * RATE_HZ)
        if due > 0:
            assert recovered.returncode == 0, recovered.stderr
            found = read_reconstruction(result)
            assert found.frames >= due, f"{found.frames} frames of at least {due} recovered"
            assert np.isfinite(found.q[found.tracked]).all()
        return "new"

    start = folder / "start-live"
    (start / RESULT).mkdir(parents=True)
    return Job("live", arguments, start, state, again=False, span_s=(0.5, 0.0))
