"""Checks of a live run while it goes on: plates, clocks, mass, markers and person, in a process of their own.

The first check is asked for after a second and a half of frames, each further one after twice the time of the one
before, up to the minute that is checked at the end of the run, too. Where the filter starts anew, the person may have
changed: the markers from there on are compared with the subject's segment lengths.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from queue import SimpleQueue

from mbkf.io.findings import Finding
from mbkf.stream.receiving.alignment import Note
from mbkf.study.batch.worker_process import ONE_THREAD
from mbkf.trial.live.check_process import Answer, answer_of
from mbkf.trial.live.results import CHECKED_S

BEGIN_S = 1.0
"""Time of frames after which the process is started; shorter runs are checked at their end."""

FIRST_S, LONGER = 1.5, 2.0
"""Time of frames of the first check, and by what factor that of each further one is longer."""

PERSON_S = 2.0
"""So long after the filter has started anew, the markers since then are compared with the subject."""

MOSTLY = 0.5
"""Names that are exchanged in more than this share of the frames are reported."""

PROGRAM = "from mbkf.trial.live.check_process import main; main()"


class LiveChecks:
    """The checks of one run.

    Attributes:
        findings: The newest findings; none before the first answer.
    """

    def __init__(self, folder: Path, rate_hz: float, note: Note) -> None:
        """No process yet.

        Args:
            folder: The run's log.
            rate_hz: Frame rate.
            note: Called where the checks fail.
        """
        self.findings: Sequence[Finding] = ()
        self._folder, self._rate_hz, self._note = folder, rate_hz, note
        self._asked: SimpleQueue[str] = SimpleQueue()  # empty at the end
        self._due_s = FIRST_S
        self._restarted: int | None = None
        self._exchanged: tuple[tuple[str, str], ...] = ()
        self._thread: threading.Thread | None = None
        self._process: subprocess.Popen[str] | None = None
        self._closed = False

    def reached(self, frames: int) -> None:
        """So many frames are answered; returns at once."""
        seconds = frames / self._rate_hz
        if self._thread is None and seconds >= BEGIN_S:
            self._thread = threading.Thread(target=self._run, name="mbkf-checks", daemon=True)
            self._thread.start()
        while self._due_s <= seconds and self._due_s < LONGER * CHECKED_S:
            self._due_s *= LONGER
            self._asked.put("check")
        if self._restarted is not None and frames >= self._restarted + PERSON_S * self._rate_hz:
            self._asked.put(f"person {self._restarted}")
            self._restarted = None

    def restarted(self, frame: int) -> None:
        """The filter started anew in a frame: the markers from there on may be another person's."""
        self._restarted = frame

    def close(self) -> None:
        """Ends the process; what it still works on is dropped."""
        self._closed = True
        self._asked.put("")
        process = self._process
        if process is not None:
            process.kill()
        if self._thread is not None:
            self._thread.join()

    def _run(self) -> None:
        try:
            self._process = _started(self._folder)
        except OSError as error:
            self._failed("cannot start", error)
            return
        with self._process as process:
            if self._closed:
                process.kill()
            try:
                self._answered(process)
            except (OSError, ValueError, TypeError, KeyError) as error:
                if not self._closed:
                    self._failed("ended", error)
            process.kill()

    def _failed(self, why: str, error: Exception) -> None:
        sentence = f"plates and markers are checked at the end of the run only: the process {why} ({error})"
        self._note("checks", sentence, None, 1)

    def _answered(self, process: subprocess.Popen[str]) -> None:
        """Passes on what is asked, and takes the answers."""
        assert process.stdin is not None and process.stdout is not None
        while asked := self._asked.get():
            process.stdin.write(f"{asked}\n")
            process.stdin.flush()
            answer = answer_of(process.stdout.readline())
            if asked == "check":
                self._take(answer)
            else:
                self._take_person(int(asked.split()[1]), answer)

    def _take_person(self, frame: int, answer: Answer) -> None:
        """Reports another person than the subject since a frame."""
        for one in answer.findings:
            if one.verdict == "outside":
                self._note(
                    "person", f"from {frame / self._rate_hz:.1f} s on, {one.name}: {one.hint}", frame, 1
                )

    def _take(self, answer: Answer) -> None:
        """Keeps the findings, and reports names that are exchanged most of the time."""
        pairs = tuple((a, b) for a, b, share in answer.exchanged if share > MOSTLY)
        if pairs and pairs != self._exchanged:
            names = ", ".join(f"{a} and {b}" for a, b in pairs)
            self._note(
                "names",
                f"the names of {names} are exchanged: rename them in the camera system; 'mbkf reconstruct' puts them "
                "right in a recording",
                None,
                1,
            )
        self._exchanged = pairs
        self.findings = answer.findings


def _started(folder: Path) -> subprocess.Popen[str]:
    """The process.

    Raises:
        OSError: It cannot be started.
    """
    paths = os.pathsep.join(path or str(Path.cwd()) for path in sys.path)
    return subprocess.Popen(
        # -P: a file in the current folder that has a library's name is not imported for it
        [sys.executable, "-P", "-c", PROGRAM, str(folder)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        encoding="utf-8",
        env=os.environ | ONE_THREAD | {"PYTHONPATH": paths},
        start_new_session=True,  # a Ctrl-C in the terminal is for the run, which then ends it
    )
