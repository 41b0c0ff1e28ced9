"""Senders as laboratories have them: jittering, restarting, reordering, over LSL and NatNet, followed by live runs.

Every frame that was sent is in the log under its number, or counted under the reason why it is not; readings of plates
are those of the plate where they belong; the first live answer comes within a second. What a seed sends is always the
same: ``python -m benchmarks.misuse.senders.child FOLDER PROTOCOL KIND:SEED``, as the row names it.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

from benchmarks.checks import Check, Context, information
from benchmarks.misuse.senders.judging import WITHIN_S
from benchmarks.misuse.senders.kinds import KINDS
from benchmarks.robustness.stream_faults import CHUNK, WORKERS, follow
from benchmarks.robustness.stream_kinds import LSL, NATNET
from mbkf.trial.synth import synthesise, write_folder

TIMES = 3
"""Each kind sends so often, with a seed of its own each time."""

SECONDS, RATE_HZ = 4.0, 100.0
FAULTS = ("unaccounted", "wrong numbers", "wrong loads", "unreported")


def rows(context: Context) -> Iterator[Check]:
    """The rows of all senders: each three times, once when quick."""
    folder = context.out / "streams"
    subject, walk = synthesise("walk", seconds=SECONDS, rate_hz=RATE_HZ)
    write_folder(subject, walk, folder)
    jobs = chunks(1 if context.quick else TIMES, context.seed)
    one = partial(follow, folder=folder, module=f"{__name__}.child")
    with ThreadPoolExecutor(WORKERS) as pool:
        found = {word: outcome for some in pool.map(one, jobs) for word, outcome in some.items()}
    yield from judged(found)


def chunks(times: int, first: int) -> list[tuple[str, list[str]]]:
    """Protocols and the senders of each, ``KIND:SEED``, in jobs.

    Args:
        times: How often each kind sends.
        first: The first seed.
    """
    words: dict[str, list[str]] = {LSL: [], NATNET: []}
    for k, (name, kind) in enumerate(KINDS.items()):
        words[kind.protocol] += [f"{name}:{first + 10 * k + time}" for time in range(times)]
    return [
        (protocol, some[at : at + CHUNK])
        for protocol, some in words.items()
        for at in range(0, len(some), CHUNK)
    ]


def judged(found: dict[str, dict[str, Any]]) -> Iterator[Check]:
    """Rows of what became of the senders' frames.

    Args:
        found: Outcomes by protocol, kind and seed.
    """
    name = f"{len(KINDS)} kinds of senders × {round(len(found) / len(KINDS))}"
    died = {word: told["died"] for word, told in found.items() if told.get("died")}
    yield Check(f"{name}: runs that ended in a failure", float(len(died)), 0.0, "<=")
    labels = {
        "unaccounted": "frames sent that are neither written nor counted with a reason",
        "wrong numbers": "frames under another number, or with markers under other names",
        "wrong loads": "samples of plates that are not those sent",
        "unreported": "changes of the sender that are not reported",
    }
    for fault in FAULTS:
        total = sum(int(told.get(fault, 0)) for told in found.values())
        yield Check(f"{name}: {labels[fault]}", float(total), 0.0, "<=")
    first = [float(told.get("first live answer", float("inf"))) for told in found.values()]
    yield Check(f"{name}: first live answer, latest", max(first, default=float("inf")), WITHIN_S, "<=", "s")
    for word, told in found.items():
        wrong = [f"{told[fault]} {fault}" for fault in FAULTS if told.get(fault)]
        late = float(told.get("first live answer", float("inf")))
        wrong += [f"first live answer after {late:.2f} s"] if late > WITHIN_S else []
        if wrong or told.get("died"):
            yield information(f"{word}: {', '.join([*map(str, told.get('died', ())), *wrong])}"[:200], 1.0)
