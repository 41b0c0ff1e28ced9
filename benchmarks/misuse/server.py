"""A process that runs mbkf's commands, each in a fork of itself, so that libraries are loaded once.

    python -m benchmarks.misuse.server

It reads one call as JSON per line of standard input (:class:`benchmarks.misuse.calls.Call`) and answers with the end of
the command as JSON. A command that takes too long is killed; one that asks for more memory than it may gets none.
"""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import json
import os
import resource
import signal
import sys
import time
import traceback
from pathlib import Path
from typing import Any

from benchmarks.misuse.asking import unanswered as unanswered_by

LOADED = (
    "mbkf.cli.main", "mbkf.trial.reconstruct", "mbkf.trial.scale", "mbkf.trial.label", "mbkf.trial.export",
    "mbkf.io.results_folder", "mbkf.trial.results.summary", "mbkf.viz.report.document", "rich.table", "pyarrow.parquet",
    "mbkf.study.batch.curves",
)  # fmt: skip
"""Modules that most commands load."""

POLL_S = 0.005
TRACEBACK_CODE = 70
"""Exit code of a command whose error nothing caught."""

CAPABILITY_VERSION, PASS_OVER_MODES = 0x20080522, 0b110
"""Linux's version of capabilities, and those two with which root reads and writes what modes forbid."""


def serve() -> None:
    """Answers calls until standard input ends."""
    for name in LOADED:
        importlib.import_module(name)
    for line in sys.stdin:
        print(json.dumps(ended(json.loads(line))), flush=True)


def ended(call: dict[str, Any]) -> dict[str, Any]:
    """Runs a call in a fork and returns its end."""
    out, err = Path(call["scratch"]) / "stdout", Path(call["scratch"]) / "stderr"
    writes = Path(call["scratch"]) / "writes"
    for left in (out, writes):  # of the call before
        left.unlink(missing_ok=True)
    begun = time.monotonic()
    child = os.fork()
    if child == 0:
        _be_the_command(call, out, err, writes)
    late, unanswered, asked = False, "", not call["serves"]
    while True:
        pid, status, used = os.wait4(child, os.WNOHANG)
        if pid:
            break
        if not late and time.monotonic() - begun > call["seconds"]:
            late = True
            os.killpg(child, signal.SIGKILL)
        if not asked and (address := _address(out)):
            asked, unanswered = True, unanswered_by(address)
            os.kill(child, signal.SIGTERM)
        time.sleep(POLL_S)
    with contextlib.suppress(ProcessLookupError):  # workers that the command left behind
        os.killpg(child, signal.SIGKILL)
    shared = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {
        "code": None if late else os.waitstatus_to_exitcode(status),
        "out": out.read_text("utf-8", "surrogateescape"),
        "err": err.read_text("utf-8", "surrogateescape"),
        "seconds": time.monotonic() - begun,
        "unanswered": unanswered,
        "writes": int(writes.read_text("ascii")) if writes.exists() else 0,
        "memory_mb": max(0, used.ru_maxrss - shared) / 1024.0,
    }


def _address(out: Path) -> str:
    """The address that a command has printed as its first line; "" before that."""
    first, end, _ = out.read_text("utf-8", "replace").partition("\n") if out.exists() else ("", "", "")
    return first if end and first.startswith("http") else ""


def _be_the_command(call: dict[str, Any], out: Path, err: Path, writes: Path) -> None:
    """Turns this process into the command and ends it."""
    code, shim = TRACEBACK_CODE, None
    try:
        os.setsid()
        with contextlib.suppress(OSError):
            os.close(0)
        os.open(os.devnull, os.O_RDONLY)
        for path, number in ((out, 1), (err, 2)):
            made = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(made, number)
            os.close(made)
        os.chdir(_as_given(call["folder"]))
        os.environ.update({name: _as_given(text) for name, text in call["environment"].items()})
        if call["unprivileged"]:
            _obey_modes()
        if call["memory_mb"]:
            _limit(call["memory_mb"])
        if call["fault"]:
            shim = ctypes.CDLL(call["fault"]["library"])
            folder = os.fsencode(call["fault"]["folder"])
            shim.misuse_arm(folder, call["fault"]["at"], int(call["fault"]["lasting"]))
        from mbkf.cli.main import main

        try:
            code = main([_as_given(word) for word in call["words"]])
        except SystemExit as end:
            code = int(end.code or 0)
        sys.stdout.flush()
        sys.stderr.flush()
        if shim is not None:
            writes.write_text(str(shim.misuse_disarm()), "ascii")
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


def _as_given(text: str) -> str:
    """A word as a process gets it whose system has another encoding of names."""
    return os.fsdecode(text.encode("utf-8", "surrogateescape"))


def _obey_modes() -> None:
    """Gives up root's right to read and write what modes forbid, where the system is Linux."""
    if not sys.platform.startswith("linux"):
        return
    header = (ctypes.c_uint32 * 2)(CAPABILITY_VERSION, 0)
    sets = (ctypes.c_uint32 * 6)()  # effective, permitted, inheritable, twice 32 of each
    system = ctypes.CDLL(None)
    system.capget(header, sets)
    sets[0], sets[1] = sets[0] & ~PASS_OVER_MODES, sets[1] & ~PASS_OVER_MODES
    system.capset(header, sets)


def _limit(memory_mb: float) -> None:
    """Grants so much address space beyond that in use, where the system states it."""
    with contextlib.suppress(OSError, ValueError):
        pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
        most = pages * resource.getpagesize() + int(memory_mb * 2**20)
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


if __name__ == "__main__":
    serve()
