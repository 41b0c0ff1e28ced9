"""A live run as a process of its own, so that the page's server does not disturb the filter's timing.

The process is ``mbkf live``. It watches its standard input, which this server holds open: closed, it ends the run as
Ctrl-C does, but on every system, at any moment, and also if this server is killed.
"""

from __future__ import annotations

import contextlib
import os
import re
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO

from mbkf.errors import InvalidInput
from mbkf.io.results_folder import SUMMARY_FILE
from mbkf.stream.loopback import LOOPBACK
from mbkf.stream.run.folder import LOG_FOLDER

STARTING, RUNNING, ENDING, ENDED, FAILED = "starting", "running", "ending", "ended", "failed"

PAGE = re.compile(rf"page: http://{re.escape(LOOPBACK)}:(\d+)/")
"""The line in which ``mbkf live`` prints its page's address."""

ERROR = "mbkf: error: "

LONGEST_LINE = 2000
END_S = 60.0
"""Longest time for writing results."""


@dataclass(frozen=True)
class LiveState:
    """The state of a live run.

    Attributes:
        state: "starting" (before its first output), "running", "ending", "ended" or "failed".
        session: Name of its session.
        name: Name of the recording.
        said: Its last line, e.g. a prompt to the person to stand still.
        port: Port of its page, at this computer's own address; None before there is one.
        reason: Cause of a failure; empty without.
        seconds: Time that it ran.
    """

    state: str
    session: str
    name: str
    said: str = ""
    port: int | None = None
    reason: str = ""
    seconds: float = 0.0

    @property
    def goes_on(self) -> bool:
        """True until its process has ended."""
        return self.state in {STARTING, RUNNING, ENDING}


class LiveRun:
    """The live run of a page's server; one at a time.

    Args:
        program: Command that starts mbkf.
    """

    def __init__(self, program: Sequence[str] = (sys.executable, "-m", "mbkf")) -> None:
        self._program = tuple(program)
        self._lock = threading.Lock()
        self._process: subprocess.Popen[str] | None = None
        self._reader: threading.Thread | None = None
        self._state: LiveState | None = None
        self._begin_s, self._port = 0.0, 0

    def state(self) -> LiveState | None:
        """The state of the newest run; None before the first one."""
        with self._lock:
            return self._state

    def start(self, session: str, options: Sequence[str], folder: Path) -> None:
        """Begins a run.

        Args:
            session: Name of its session.
            options: Of ``mbkf live``: the stream and the body.
            folder: Folder of its results.

        Raises:
            InvalidInput: Another run has not ended.
            OSError: The process cannot be started.
        """
        with self._lock:
            if self._state is not None and self._state.goes_on:
                raise InvalidInput(
                    f"a live run of session '{self._state.session}' goes on already; stop it first"
                )
            # the browser keeps plots and targets by address, so the page gets the port of the run before
            words = [
                *options,
                "--view",
                f"--view-port={_free(self._port)}",
                f"--out={folder}",
                "--end-with-input",
            ]
            self._process = subprocess.Popen(
                [*self._program, "live", *words],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                encoding="utf-8",
                errors="replace",
                env=os.environ | {"PYTHONIOENCODING": "utf-8"},
                creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
                start_new_session=True,  # a Ctrl-C in the terminal is for this server, which then ends it once
            )
            self._begin_s = time.monotonic()
            self._state = LiveState(STARTING, session, folder.name)
            self._reader = threading.Thread(
                target=self._follow, args=(self._process, folder), name="mbkf-live", daemon=True
            )
            self._reader.start()

    def stop(self) -> None:
        """Asks the run to end and to write its results, if there is one."""
        with self._lock:
            if self._state is None or self._process is None or self._state.state not in {STARTING, RUNNING}:
                return
            self._state = replace(self._state, state=ENDING)
            _close(self._process.stdin)

    def close(self) -> None:
        """Ends the run, and waits until its results are written."""
        self.stop()
        if self._process is None or self._reader is None:
            return
        self._reader.join(END_S)
        if self._reader.is_alive():
            self._process.kill()
            self._reader.join()

    def _follow(self, process: subprocess.Popen[str], folder: Path) -> None:
        """Reads the run's output until it ends, then its exit code; makes results of the log that a crash left."""
        assert process.stderr is not None
        last = ""
        while line := process.stderr.readline(LONGEST_LINE):
            last = line.strip() or last
            self._read(line.strip())
        code = process.wait()
        _close(process.stdin)
        _close(process.stderr)
        why = (
            ""
            if code == 0
            else last.removeprefix(ERROR) or f"it ended with status {code} and without a message"
        )
        if why and self._recovered(folder):
            why += "; the frames recorded until then are kept"
        with self._lock:
            assert self._state is not None
            seconds = time.monotonic() - self._begin_s
            self._state = replace(self._state, state=FAILED if why else ENDED, reason=why, seconds=seconds)

    def _recovered(self, folder: Path) -> bool:
        """Makes results of the log of a run that left none; False if that fails."""
        if not (folder / LOG_FOLDER).is_dir() or (folder / SUMMARY_FILE).is_file():
            return False
        words = [*self._program, "live", f"--recover={folder}"]
        try:
            done = subprocess.run(
                words,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                timeout=END_S,
                check=False,
            )
        except (OSError, subprocess.TimeoutExpired):
            return False
        return done.returncode == 0

    def _read(self, line: str) -> None:
        page = PAGE.search(line)
        with self._lock:
            assert self._state is not None
            state = RUNNING if self._state.state == STARTING else self._state.state
            if page is not None:
                self._port = int(page[1])
                self._state = replace(self._state, state=state, port=self._port)
            elif line:
                self._state = replace(self._state, state=state, said=line)


def _free(port: int) -> int:
    """The port if it is free, else 0 for any free one."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((LOOPBACK, port))
        except OSError:
            return 0
    return port


def _close(stream: IO[str] | None) -> None:
    if stream is not None:
        with contextlib.suppress(OSError):
            stream.close()
