"""Outputs over inputs, through every kind of path, and over files that mbkf did not write: refused, and nothing lost.

The acts are made from the cases of all commands (:mod:`benchmarks.misuse.cases`).
"""

from __future__ import annotations

import random
import shutil
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from benchmarks.checks import Check, Context, information
from benchmarks.misuse.acts import Act, acts_of
from benchmarks.misuse.calls import Call, Commands, Ending, commands
from benchmarks.misuse.cases import CASES, Case, uncovered, without_overwrite
from benchmarks.misuse.leftovers import leftovers
from benchmarks.misuse.world import changed, digests, made_world

QUICK = 60
"""Acts of a quick run, drawn with the seed."""

SHOWN = 25
SLOW_S, SERVING_S = 120.0, 15.0
"""After so long a command has done what it should have refused, or begun to serve."""


@dataclass(frozen=True)
class Found:
    """An act and how it ended.

    Attributes:
        act: The act.
        line: The command.
        lost: Inputs and foreign files that it changed or removed.
        left: Unfinished files that it left behind.
        fault: The reason why it did not end as it must; "" where it did.
    """

    act: Act
    line: str
    lost: tuple[str, ...]
    left: tuple[str, ...]
    fault: str


def rows(context: Context) -> list[Check]:
    """All rows of outputs over inputs, over foreign files and over mbkf's own."""
    world = made_world(context.out / "laboratory")
    with commands(context.out / "servers") as run:
        outputs, broken = first_outputs(run, world, context.out / "first")
        acts = [act for case in CASES for act in acts_of(case, world, outputs.get(case, case.writes))]
        if context.quick:
            acts = random.Random(context.seed).sample(acts, QUICK)
        found = tried(run, acts, world, context.out / "acts")
    return [*coverage_rows(broken), *act_rows(found)]


def coverage_rows(broken: Sequence[str]) -> list[Check]:
    """Rows of commands that no case calls, of cases that do not run, and of commands without ``--overwrite``."""
    missing, bare = uncovered(), without_overwrite()
    return [
        Check("commands, options and formats without a case", len(missing), 0, "<="),
        Check("cases that fail with nothing in their way", len(broken), 0, "<="),
        Check("commands that write and have no --overwrite", len(bare), 0, "<="),
        *(information(words, 1.0) for words in (*missing, *broken)),
        *((information(f"no --overwrite: {', '.join(bare)}", 1.0),) if bare else ()),
    ]


def act_rows(found: Sequence[Found]) -> list[Check]:
    """Rows of acts: counts, and the acts that went wrong by name."""
    checks = [Check("inputs and foreign files changed or lost", sum(len(one.lost) for one in found), 0, "<=")]
    checks.append(Check("unfinished files left behind", sum(len(one.left) for one in found), 0, "<="))
    for kind, count in Counter(one.act.kind for one in found).items():
        wrong = sum(1 for one in found if one.act.kind == kind and one.fault)
        checks.append(Check(f"{kind}: {count} acts, ended otherwise than they must", wrong, 0, "<="))
    bad = [one for one in found if one.lost or one.left or one.fault]
    for one in bad[:SHOWN]:
        lost = f" lost {', '.join(one.lost)};" if one.lost else ""
        checks.append(information(f"{one.act.title}:{lost} {one.fault} [{one.line}]", 1.0))
    return checks


def first_outputs(run: Commands, world: Path, folder: Path) -> tuple[dict[Case, tuple[str, ...]], list[str]]:
    """Files that each case writes with nothing in its way, and the cases that fail.

    Args:
        run: Runs commands.
        world: The laboratory.
        folder: Where they write.
    """
    cases = [case for case in CASES if case.runs and not case.slow]
    calls = [Call(case.call({}, str(folder / f"{k}" / case.out)), world) for k, case in enumerate(cases)]
    for k in range(len(cases)):
        (folder / f"{k}").mkdir(parents=True)
    outputs, broken = {}, []
    for k, (case, end) in enumerate(zip(cases, run.run_all(calls), strict=True)):
        if end.code != 0:
            broken.append(f"{case.name}: {end.unclean or end.last_line}")
        outputs[case] = tuple(sorted(digests(folder / f"{k}" / case.out))) if case.kind == "folder" else ()
    return outputs, broken


def tried(run: Commands, acts: Sequence[Act], world: Path, folder: Path) -> list[Found]:
    """Does all acts, each in a folder of its own.

    Args:
        run: Runs commands.
        acts: The acts.
        world: The laboratory.
        folder: Where the folders are made.
    """
    with ThreadPoolExecutor(run.workers) as pool:
        return list(pool.map(lambda pair: done(run, pair[1], world, folder / f"{pair[0]}"), enumerate(acts)))


def done(run: Commands, act: Act, world: Path, place: Path) -> Found:
    """Does one act and looks at the files afterwards; its folder is removed if all went well.

    Args:
        run: Runs commands.
        act: The act.
        world: The laboratory.
        place: The act's folder, to be made.
    """
    place.mkdir(parents=True)
    words = act.prepare(world, place)
    patience = SLOW_S if act.case.runs else SERVING_S
    for earlier in act.earlier:
        run.run(Call([*words, *earlier], place, seconds=patience))
    before = {name: was for name, was in digests(place).items() if act.must_stay(place, name)}
    end = run.run(Call([*words, *act.more], place, seconds=patience))
    lost = tuple(changed(before, place))
    found = Found(act, Call([*words, *act.more], place).line, lost, tuple(leftovers(place)), _fault(act, end))
    if not (found.lost or found.left or found.fault):
        shutil.rmtree(place)
    return found


def _fault(act: Act, end: Ending) -> str:
    partial = act.case.command == "batch" and end.code == 1 and "Traceback" not in end.err
    if act.must == "refused" and partial:  # that trial alone is refused, and the others are done
        return ""
    if act.must == "refused":
        return "" if end.refused else end.unclean or "not refused"
    if act.must == "done":
        return "" if end.code == 0 else end.unclean or end.last_line
    return end.unclean
