"""Disturbed streams, followed by live runs in processes of their own: none may die, and every frame is accounted for.

What a seed disturbs is always the same, so that what failed can be seen again:
``python -m benchmarks.robustness.stream_child FOLDER PROTOCOL FAULT:SEED``, as the row names it.
"""

from __future__ import annotations

import json
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from benchmarks.checks import Check, Context, information
from benchmarks.robustness.stream_kinds import KINDS, LSL, NATNET
from mbkf.trial.synth import synthesise, write_folder

TIMES = 3
"""Each fault is played so often, with a seed of its own each time."""

SECONDS = 2.6
CHUNK = 12
"""So many runs a process follows before the next takes over."""

WORKERS = 2
HANG_S = 40.0
Told = dict[str, object]

CHILD = "benchmarks.robustness.stream_child"
"""The process that follows runs."""


def stream_rows(context: Context) -> Iterator[Check]:
    """The rows of disturbed streams: each fault three times over each protocol of it; once over one when quick."""
    folder = context.out / "streams"
    subject, walk = synthesise("walk", seconds=SECONDS, rate_hz=100.0)
    write_folder(subject, walk, folder)
    first = time.time_ns() % 2**31
    jobs = chunks(1 if context.quick else TIMES, context.quick, first)
    with ThreadPoolExecutor(WORKERS) as pool:
        found = {
            word: told
            for some in pool.map(partial(follow, folder=folder), jobs)
            for word, told in some.items()
        }
    yield from rows(found)


def chunks(times: int, alternate: bool, first: int) -> list[tuple[str, list[str]]]:
    """Protocols and what is followed over each, ``FAULT:SEED``, in jobs.

    Args:
        times: How often each fault is played.
        alternate: Whether a fault of both protocols is played over one of them only.
        first: The first seed.
    """
    words: dict[str, list[str]] = {LSL: [], NATNET: []}
    for k, (name, kind) in enumerate(KINDS.items()):
        chosen = kind.protocols[k % len(kind.protocols) :][:1] if alternate else kind.protocols
        for j, protocol in enumerate(chosen):
            words[protocol] += [f"{name}:{first + 10 * (2 * k + j) + time}" for time in range(times)]
    return [
        (protocol, some[at : at + CHUNK])
        for protocol, some in words.items()
        for at in range(0, len(some), CHUNK)
    ]


def rows(found: dict[str, Told], over: str = "LSL and NatNet") -> Iterator[Check]:
    """Ends of the runs, by protocol, fault and seed; ``over`` names the protocols."""
    kinds = len({word.split(" ", 1)[1].rsplit(":", 1)[0] for word in found})
    name = f"{kinds} stream faults × {TIMES if len(found) >= TIMES * kinds else 1} over {over}"
    died = {word: told["died"] for word, told in found.items() if told.get("died")}
    wrong = {word: told["unaccounted"] for word, told in found.items() if told.get("unaccounted")}
    without = {word: told["problem"] for word, told in found.items() if told.get("problem")}
    astray = [word for word, told in found.items() if not told.get("died") and not told.get("tracked")]
    yield information("disturbed runs", float(len(found)))
    yield Check(f"{name}: threads died", float(len(died)), 0.0, "<=")
    yield Check(
        f"{name}: frames not accounted for", float(sum(int(str(n)) for n in wrong.values())), 0.0, "<="
    )
    yield Check(f"{name}: runs without results", float(len(without)), 0.0, "<=")
    yield Check(f"{name}: runs not tracked at their end", float(len(astray)), 0.0, "<=")
    for listed in (died, wrong, without, {word: "not tracked at its end" for word in astray}):
        yield from (information(f"{word}: {what}"[:200], 1.0) for word, what in listed.items())


def follow(job: tuple[str, Sequence[str]], folder: Path, module: str = CHILD) -> dict[str, Told]:
    """What becomes of runs; a process that dies or hangs is replaced for the next.

    Args:
        job: The protocol, and ``FAULT:SEED`` of each run.
        folder: Where capture and subject are.
        module: The process that follows them.
    """
    protocol, words = job
    found: dict[str, Told] = {}
    left = list(words)
    while left:
        begun = _one_process(protocol, left, folder, found, module)
        if begun not in found:
            found[begun or left[0]] = {"died": ["the process died or hung"]}
        left = [word for word in left if word not in found]
    return {f"{protocol} {word}": told for word, told in found.items()}


def _one_process(
    protocol: str, words: Sequence[str], folder: Path, found: dict[str, Told], module: str
) -> str | None:
    """Follows runs until the process ends; returns the one that it began last."""
    command = [sys.executable, "-m", module, str(folder), protocol, *words]
    begun: str | None = None
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        clock = threading.Timer(HANG_S, process.kill)
        clock.start()
        for line in process.stdout:
            clock.cancel()
            told = json.loads(line)
            begun = told.get("begin", begun)
            if "end" in told:
                found[told["end"]] = told
            clock = threading.Timer(HANG_S, process.kill)
            clock.start()
        clock.cancel()
    return begun
