"""A live run as a process of its own, so that the page's server does not disturb the filter's timing.

The process is ``mbkf live`` with its own options. It watches its standard input, which is held open here: closed, it
ends the run as Ctrl-C does, but on every system and at any moment, and also where this server was killed.
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
"""How ``mbkf live`` tells where its page is."""

ERROR = "mbkf: error: "

LONGEST_LINE = 2000
END_S = 60.0
"""Results are written within it, or never."""


@dataclass(frozen=True)
class LiveState:
    """How far a live run is.

    Attributes:
        state: "starting" (no word came yet), "running", "ending", "ended" or "failed".
        session: Whose it is.
        name: The recording's.
        said: What it said last, e.g. to the person who is to stand still.
        port: Of its page, at this computer's own address; None before there is one.
        reason: Why it failed; empty where it did not.
        seconds: How long it has run.
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
        """Whether its process has not ended."""
        return self.state in {STARTING, RUNNING, ENDING}


class LiveRun:
    """The live run of a page's server; one at a time."""

    def __init__(self, program: Sequence[str] = (sys.executable, "-m", "mbkf")) -> None:
        """Args: how mbkf is called."""
        self._program = tuple(program)
        self._lock = threading.Lock()
        self._process: subprocess.Popen[str] | None = None
        self._reader: threading.Thread | None = None
        self._state: LiveState | None = None
        self._begin_s, self._port = 0.0, 0

    def state(self) -> LiveState | None:
        """How far the newest run is; None before the first one."""
        with self._lock:
            return self._state

    def start(self, session: str, options: Sequence[str], folder: Path) -> None:
        """Begins a run.

        Args:
            session: Whose it is.
            options: Of ``mbkf live``: the stream and the body.
            folder: Where its results go.

        Raises:
            InvalidInput: Another one goes on.
            OSError: The process cannot be started.
        """
        with self._lock:
            if self._state is not None and self._state.goes_on:
                raise InvalidInput(
                    f"a live run goes on already, of session '{self._state.session}'; stop it first"
                )
            # A page at the address of the one before finds the plots and targets that the browser keeps for it.
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
        """Asks the run to end and to write its results; nothing where none goes on."""
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
        """Listens to what the run says until it ends, then notes how; what a crash left in its log becomes results."""
        assert process.stderr is not None
        last = ""
        while line := process.stderr.readline(LONGEST_LINE):
            last = line.strip() or last
            self._heard(line.strip())
        code = process.wait()
        _close(process.stdin)
        _close(process.stderr)
        why = "" if code == 0 else last.removeprefix(ERROR) or f"it ended with status {code} and said nothing"
        if why and self._recovered(folder):
            why += "; what it had recorded until then is kept"
        with self._lock:
            assert self._state is not None
            seconds = time.monotonic() - self._begin_s
            self._state = replace(self._state, state=FAILED if why else ENDED, reason=why, seconds=seconds)

    def _recovered(self, folder: Path) -> bool:
        """Whether results could be made of the log that a run left without any."""
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

    def _heard(self, line: str) -> None:
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
    """A port if nothing listens there now, else 0 for any that is free."""
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
