"""Damaged files of every format, read in processes that may die: only the program's own errors may come of them.

Seeds are new in each run. What a seed damages is always the same, so that what failed can be seen again:
``python -m benchmarks.robustness.child FOLDER DATA FORMAT:SEED``, as the row names it. Then streams go wrong
(:mod:`benchmarks.robustness.stream_faults`); with ``--minutes M`` a live run goes on for so long in place of all that
(:mod:`benchmarks.robustness.soak`).
"""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from benchmarks.checks import Check, Context, information
from benchmarks.robustness.child import FOREIGN, IMPOSSIBLE, READ, REFUSED
from benchmarks.robustness.formats import formats
from benchmarks.robustness.soak import soak_rows
from benchmarks.robustness.stream_faults import stream_rows

MUTANTS, QUICK_MUTANTS = 20_000, 600
CHUNK = 100
"""So many files a process reads before the next takes over."""

WORKERS = 2
HANG_S = 20.0
MOST_CPU_S = 2.0
"""Processor time after which a damaged file should have been refused."""

DIED, HUNG = "died", "hung"


def run(context: Context) -> list[Check]:
    """All rows; those of a long live run alone where its minutes are given."""
    if context.minutes is not None:
        return list(soak_rows(context))
    folder = context.out / "files"
    folder.mkdir(parents=True, exist_ok=True)
    names = sorted(formats(folder, context.data))
    count, first = QUICK_MUTANTS if context.quick else MUTANTS, time.time_ns() % 2**31
    words = [f"{names[k % len(names)]}:{first + k}" for k in range(count)]
    chunks = [words[at : at + CHUNK] for at in range(0, count, CHUNK)]
    found: dict[str, str] = {}
    with ThreadPoolExecutor(WORKERS) as pool:
        for some in pool.map(partial(read_all, folder=folder, data=context.data), chunks):
            found |= some
    return [*rows(found), *stream_rows(context)]


def rows(found: dict[str, str]) -> list[Check]:
    """What became of the files, by their names and seeds."""
    kinds = Counter(outcome.split()[0] for outcome in found.values())
    foreign = Counter(outcome for outcome in found.values() if outcome.startswith(FOREIGN))
    refused = (
        (float(outcome.split()[1]), f" ({word})")
        for word, outcome in found.items()
        if outcome.startswith(f"{REFUSED} ")
    )
    slowest = max(refused, default=(0.0, ""))
    shown = {outcome: word for word, outcome in found.items()}
    return [
        information("damaged files", float(len(found))),
        information("read nevertheless", float(kinds[READ])),
        information("refused", float(kinds[REFUSED])),
        Check(f"slowest refusal{slowest[1]}", slowest[0], MOST_CPU_S, "<=", "s"),
        Check("of which the process died", float(kinds[DIED]), 0.0, "<="),
        Check(f"that took more than {HANG_S:g} s", float(kinds[HUNG]), 0.0, "<=", ""),
        Check("that ended in an error of another kind, or asked for 1 GB", float(kinds[FOREIGN]), 0.0, "<="),
        Check("read with impossible numbers, untold", float(kinds[IMPOSSIBLE]), 0.0, "<="),
        *(information(f"{kind} ({shown[kind]})", float(count)) for kind, count in foreign.most_common(20)),
        *(
            information(f"{word}: {outcome}", 1.0)
            for word, outcome in found.items()
            if outcome in {DIED, HUNG, IMPOSSIBLE}
        ),
    ]


def read_all(words: Sequence[str], folder: Path, data: Path | None) -> dict[str, str]:
    """What becomes of damaged files; a process that dies or hangs of one is replaced for the next.

    Args:
        words: ``FORMAT:SEED`` of each.
        folder: Where the undamaged files are.
        data: Folder of the reference captures.
    """
    found: dict[str, str] = {}
    left = list(words)
    while left:
        begun, hung = _one_process(left, folder, data, found)
        if begun is not None and begun not in found:
            found[begun] = HUNG if hung else DIED
        elif begun is None:
            found[left[0]] = DIED
        left = [word for word in left if word not in found]
    return found


def _one_process(
    words: Sequence[str], folder: Path, data: Path | None, found: dict[str, str]
) -> tuple[str | None, bool]:
    """Reads until the process ends; returns what it began last, and whether it was ended since it hung."""
    command = [sys.executable, "-m", "benchmarks.robustness.child", str(folder), str(data or ""), *words]
    begun, hung = None, False
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:

        def end() -> None:
            nonlocal hung
            hung = True
            process.kill()

        assert process.stdout is not None
        clock = threading.Timer(3.0 * HANG_S, end)  # it has to start first
        clock.start()
        for line in process.stdout:
            clock.cancel()
            what, word, *outcome = line.rstrip("\n").split(" ", 2)
            if what == "begin":
                begun = word
            elif what == "end":
                found[word] = outcome[0]
            clock = threading.Timer(HANG_S, end)
            clock.start()
        clock.cancel()
    return begun, hung
