"""Kills: `reconstruct`, `scale`, `label`, `batch` and `live` end at any instant; the old or the new is there whole.

Half of the kills come after a random time. The others come right before a random one of the files' steps that the
command takes (:mod:`benchmarks.kills.killed`), and some before each of the last steps of `reconstruct`, in which the
new result takes the place of the old one. After each kill the same command runs once more and must find nothing in its
way, nor leave anything of the killed one.
"""

from __future__ import annotations

import random
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

from benchmarks.checks import Check, Context, information
from benchmarks.kills.jobs import Job, Kill, jobs, outcome

RANDOM, QUICK_RANDOM = 200, 20
CHOSEN = 12
WORKERS = 2


def run(context: Context) -> list[Check]:
    """All rows; new instants in each run."""
    seed = time.time_ns() % 2**31
    draw = random.Random(seed)
    known = jobs(context.out / "made")
    count = QUICK_RANDOM if context.quick else RANDOM
    kills = [random_kill(known[k % len(known)], draw) for k in range(count)]
    last = known[0].steps
    kills += [Kill(known[0], step=last - k) for k in range(CHOSEN)]
    with ThreadPoolExecutor(WORKERS) as pool:
        found = list(
            pool.map(lambda pair: outcome(pair[1], context.out / f"kill-{pair[0]}"), enumerate(kills))
        )
    return [information("seed of the instants", float(seed)), *rows(kills, found)]


def random_kill(job: Job, draw: random.Random) -> Kill:
    """A kill after a random time, or before a random step.

    Args:
        job: What is killed.
        draw: The source of chance.
    """
    if job.steps == 0 or draw.random() < 0.5:
        return Kill(job, after_s=draw.uniform(*job.span_s))
    return Kill(job, step=draw.randint(1, job.steps))


def rows(kills: Sequence[Kill], found: Sequence[str]) -> list[Check]:
    """What was found after the kills, a word for each.

    Args:
        kills: The kills.
        found: "old", "new", or what is wrong.
    """
    checks = []
    for name in dict.fromkeys(kill.job.name for kill in kills):
        words = [word for kill, word in zip(kills, found, strict=True) if kill.job.name == name]
        wrong = len(words) - words.count("old") - words.count("new")
        checks.append(
            Check(f"{name}: {len(words)} kills, neither the old nor the new whole", float(wrong), 0, "<=")
        )
        checks.append(information(f"{name}: the new", float(words.count("new"))))
    checks += [
        information(f"{kill.told}: {word}", 1.0)
        for kill, word in zip(kills, found, strict=True)
        if word not in {"old", "new"}
    ]
    return checks
