"""Calls of commands, and how they end: exit code, words, time, memory."""

from __future__ import annotations

import json
import queue
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

USER_ERROR = 2
WORKERS = 2
SECONDS = 60.0
"""After so long a command hangs. Ordinary ones end within two or three."""

MEMORY_MB = 1500.0
"""Address space that a command may take beyond the loaded libraries."""

CRY_FOR_HELP = ("Traceback", "unexpected ", "unforeseen ", "This is a bug")


@dataclass(frozen=True)
class Call:
    """A command as it is called.

    Attributes:
        words: What follows ``mbkf``.
        folder: Where it is called.
        environment: Variables that it gets besides.
        seconds: After which it is killed.
        memory_mb: Address space that it may take; 0 for any.
        unprivileged: Whether it obeys the modes of files also where root runs it.
        fault: Writes that fail, as :meth:`benchmarks.misuse.failing_writes.FailingWrites.fault` states them.
        serves: It serves the laboratory's page, which is asked for its sessions; then it is ended with SIGTERM.
    """

    words: Sequence[str]
    folder: Path
    environment: Mapping[str, str] = field(default_factory=dict)
    seconds: float = SECONDS
    memory_mb: float = 0.0
    unprivileged: bool = False
    fault: Mapping[str, Any] = field(default_factory=dict)
    serves: bool = False

    @property
    def line(self) -> str:
        """The command as a person would write it."""
        return " ".join(("mbkf", *self.words))


@dataclass(frozen=True)
class Ending:
    """The end of a command.

    Attributes:
        code: Exit code; negative for a signal, None where it was killed since it hung.
        out: Its standard output.
        err: Its standard error.
        seconds: Wall time, s.
        memory_mb: Memory that it took beyond the loaded libraries.
        writes: Its writes to the folder of the call's fault.
        unanswered: The question that its page did not answer; "" without.
    """

    code: int | None
    out: str
    err: str
    seconds: float
    memory_mb: float
    writes: int = 0
    unanswered: str = ""

    @property
    def unclean(self) -> str:
        """The fault in how a command ended; empty after success or a refusal in one sentence."""
        if self.code is None:
            return f"hung for {self.seconds:.0f} s"
        if any(word in self.err for word in CRY_FOR_HELP):
            return self.last_line
        if self.unanswered:
            return self.unanswered
        if self.code == 0:
            return ""
        if self.code != USER_ERROR:
            return f"exit code {self.code}: {self.last_line}"
        return "" if "error: " in self.last_line else f"exit code 2 without a sentence: {self.last_line!r}"

    @property
    def refused(self) -> bool:
        """True for a refusal in one sentence."""
        return self.code == USER_ERROR and not self.unclean

    @property
    def last_line(self) -> str:
        """The last line of standard error."""
        lines = self.err.strip().splitlines()
        return lines[-1][:300] if lines else ""


class Commands:
    """Runs calls in processes whose libraries are loaded."""

    def __init__(self, servers: Sequence[subprocess.Popen[str]], scratch: Path) -> None:
        self._free: queue.SimpleQueue[tuple[subprocess.Popen[str], Path]] = queue.SimpleQueue()
        for number, server in enumerate(servers):
            place = scratch / f"server-{number}"
            place.mkdir(parents=True, exist_ok=True)
            self._free.put((server, place))
        self.workers = len(servers)

    def run(self, call: Call) -> Ending:
        """Runs one call."""
        server, place = self._free.get()
        try:
            said = {**asdict(call), "folder": str(call.folder), "scratch": str(place)}
            assert server.stdin is not None
            assert server.stdout is not None
            server.stdin.write(json.dumps(said) + "\n")
            server.stdin.flush()
            return Ending(**json.loads(server.stdout.readline()))
        finally:
            self._free.put((server, place))

    def run_all(self, calls: Iterable[Call]) -> list[Ending]:
        """Runs calls side by side; their ends in the calls' order."""
        with ThreadPoolExecutor(self.workers) as pool:
            return list(pool.map(self.run, calls))


@contextmanager
def commands(
    scratch: Path, workers: int = WORKERS, environment: Mapping[str, str] | None = None
) -> Iterator[Commands]:
    """Servers of commands, ended with the block.

    Args:
        scratch: Folder of what commands print.
        workers: How many run side by side.
        environment: All variables of the servers; those of this process by default.
    """
    with ExitStack() as stack:
        words = [sys.executable, "-m", "benchmarks.misuse.server"]
        variables = None if environment is None else dict(environment)
        servers = [
            stack.enter_context(
                subprocess.Popen(
                    words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=variables
                )
            )
            for _ in range(workers)
        ]
        yield Commands(servers, scratch)
