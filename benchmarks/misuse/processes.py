"""Signals at every stage of a command, closed and full outputs, and two processes that write to the same place.

Each command runs as a process of its own over its earlier output and gets a signal after a random time. It has to end;
inputs stay, what is written stays whole, and the same command finds nothing in its way afterwards.
"""

from __future__ import annotations

import os
import random
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from benchmarks.checks import Check, Context, information
from benchmarks.misuse.calls import WORKERS, Call, Commands, Ending, commands
from benchmarks.misuse.cases import CASES, Case
from benchmarks.misuse.leftovers import leftovers
from benchmarks.misuse.whole import torn_files
from benchmarks.misuse.world import changed, digests, made_world

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)
SIGNALLED, QUICK_SIGNALLED = 160, 8
SPREAD = 1.1
"""Signals come from the command's beginning to a little after its own time."""

BEGUN = """
import os, sys
from mbkf.__main__ import main
os.write(2, b"begun\\n")
sys.exit(main())
"""
"""The command, which says when Python has begun: before, an interruption is Python's own affair."""

ENDS_S = 10.0
"""After so long a signalled command hangs. That a run of a session ends within 2 s is measured by its own part."""

SHOWN = 25


@dataclass(frozen=True)
class Signalled:
    """A command that got a signal, and the reason why it did not end as it must; "" where it did."""

    case: Case
    signal: signal.Signals
    after_s: float
    wrong: str

    @property
    def title(self) -> str:
        """The command and the signal in words."""
        return f"{self.case.command}, {self.signal.name} after {self.after_s:.2f} s: {self.wrong}"


def rows(context: Context) -> list[Check]:
    """All rows of signals, outputs that are closed or full, and two processes at once."""
    world = made_world(context.out / "laboratory")
    before = digests(world)
    cases = [case for case in CASES if case.kind and case.runs and not case.slow]
    draw = random.Random(context.seed or time.time_ns())
    count = QUICK_SIGNALLED if context.quick else SIGNALLED
    with commands(context.out / "servers") as run:
        chosen = cases[:: max(1, len(cases) // QUICK_SIGNALLED)] if context.quick else cases
        clashes = twice(run, chosen, world, context.out / "twice")
        known = olds(run, cases, world, context.out / "old")
    plan = [
        (draw.choice(cases), SIGNALS[k % len(SIGNALS)], draw.random(), context.out / f"{k}")
        for k in range(count)
    ]
    with ThreadPoolExecutor(WORKERS) as pool:
        found = list(pool.map(lambda some: signalled(*some, world=world, old=known[some[0]]), plan))
    wrong = [one.title for one in found if one.wrong]
    streams = [line for case in _printing() for line in closed(case, world, context.out / "closed")]
    lost = changed(before, world)
    return [
        Check("inputs changed or lost", len(lost), 0, "<="),
        Check(f"signals: {count} commands, half or other results, hung, tracebacks", len(wrong), 0, "<="),
        Check(f"two at once: {len(chosen)} commands, half results or no sentence", len(clashes), 0, "<="),
        Check("closed or full outputs: tracebacks, hung, silent", len(streams), 0, "<="),
        *(information(line, 1.0) for line in [*wrong[:SHOWN], *clashes[:SHOWN], *streams[:SHOWN]]),
    ]


@dataclass(frozen=True)
class Old:
    """An earlier output of a case, and the time that it took, s."""

    folder: Path
    seconds: float


def olds(run: Commands, cases: Sequence[Case], world: Path, folder: Path) -> dict[Case, Old]:
    """Earlier outputs of cases.

    Args:
        run: Runs commands.
        cases: The cases.
        world: The laboratory.
        folder: Where they are written.
    """
    places = [folder / f"{k}" for k in range(len(cases))]
    for place in places:
        place.mkdir(parents=True)
    ends = run.run_all(
        Call(case.call({}, str(place / case.out)), world) for case, place in zip(cases, places, strict=True)
    )
    return {case: Old(place, end.seconds) for case, place, end in zip(cases, places, ends, strict=True)}


def signalled(
    case: Case, name: signal.Signals, share: float, place: Path, *, world: Path, old: Old
) -> Signalled:
    """Runs a case as a process over its earlier output, and signals it.

    Args:
        case: The case.
        name: The signal.
        share: When it comes, as a share of the command's time.
        place: Folder of the output, to be made.
        world: The laboratory.
        old: The earlier output.
    """
    shutil.copytree(old.folder, place)
    was = digests(place)
    words = [sys.executable, "-c", BEGUN, *case.call({}, str(place / case.out))]
    after = share * SPREAD * old.seconds
    result = partial(Signalled, case, name, after)
    with subprocess.Popen(
        words, cwd=world, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        assert process.stderr is not None
        process.stderr.readline()
        time.sleep(after)
        process.send_signal(name)
        try:
            _, err = process.communicate(timeout=ENDS_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return result("hung")
    if "Traceback" in err or "unexpected " in err:
        return result(err.strip().splitlines()[-1][:200])
    if half := torn_files(place):
        return result(f"half: {half[0]}")
    left = list(leftovers(place))
    if left and name is not signal.SIGKILL:
        return result(f"left {left[0]}")
    if case.kind == "file" and process.returncode != 0 and not case.sides and changed(was, place):
        return result("ended with a fault and another result")
    again = subprocess.run(words, cwd=world, capture_output=True, text=True, check=False)
    if again.returncode or list(leftovers(place)):
        return result(f"run again: {again.stderr.strip()[-200:] or 'unfinished files stay'}")
    shutil.rmtree(place)
    return result("")


def twice(run: Commands, cases: Sequence[Case], world: Path, folder: Path) -> list[str]:
    """Runs each case twice at the same time with one output; what went wrong.

    Args:
        run: Runs commands.
        cases: The cases.
        world: The laboratory.
        folder: Where they are written.
    """
    wrong = []
    for number, case in enumerate(cases):
        place = folder / f"{number}"
        place.mkdir(parents=True)
        call = Call(case.call({}, str(place / case.out)), world)
        ends = run.run_all([call, call])
        wrong += [f"{case.command} twice at once: {fault}" for fault in _clash(ends, place)]
    return wrong


def _clash(ends: Sequence[Ending], place: Path) -> list[str]:
    faults = [end.unclean for end in ends if end.unclean]
    if all(end.code for end in ends):
        faults.append("none was written")
    return [*faults, *torn_files(place), *(f"left {name}" for name in leftovers(place))]


def _printing() -> list[Case]:
    names = ("info", "protocol list", "observability", "scale", "reconstruct", "export")
    return [next(case for case in CASES if case.command == name) for name in names]


def closed(case: Case, world: Path, place: Path) -> list[str]:
    """Runs a case whose standard output is closed, full, or read by a program that has left; what went wrong.

    Args:
        case: The case.
        world: The laboratory.
        place: Folder of the outputs.
    """
    place.mkdir(exist_ok=True)
    line = shlex.join([sys.executable, "-m", "mbkf", *case.call({}, str(place / case.out))])
    wrong = []
    for shell in (f"{line} >&-", f"{line} 2>&-", f"{line} <&-", f"{line} | head -c 1", f"{line} > /dev/full"):
        try:
            done = subprocess.run(
                ["bash", "-c", f"set -o pipefail; {shell}"],
                cwd=world, capture_output=True, text=True, errors="replace", timeout=60, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            wrong.append(f"{shell}: hung")
            continue
        if "Traceback" in done.stderr or "unexpected " in done.stderr or "Exception ignored" in done.stderr:
            wrong.append(f"{case.command} {shell[len(line) :]}: {done.stderr.strip().splitlines()[-1][:200]}")
        elif shell.endswith("/dev/full") and done.returncode == 0 and done.stderr == "":
            wrong.append(f"{case.command} > /dev/full: silent, exit code 0")
    return wrong
