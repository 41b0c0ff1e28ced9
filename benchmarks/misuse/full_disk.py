"""A disk that becomes full at every write of every command: the old output stays whole, inputs stay, words are said.

Each command writes over its own earlier output. Its writes are counted first; then it runs once for each (or for some,
spread evenly) with that write and all later ones failing, and once more for each with that write failing alone. Then
the output goes to a small disk in memory of growing size.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, information
from benchmarks.misuse.calls import USER_ERROR, Call, Commands, Ending, commands
from benchmarks.misuse.cases import CASES, Case
from benchmarks.misuse.failing_writes import FailingWrites, NotHere, failing_writes, small_disk
from benchmarks.misuse.leftovers import NAMED, leftovers
from benchmarks.misuse.whole import torn_files
from benchmarks.misuse.world import changed, digests, made_world

MOST_WRITES, QUICK_WRITES = 24, 2
SIZES_KB, QUICK_SIZES_KB = (4, 16, 64, 256, 640), (16,)
SHOWN = 3
"""So many faults of each case are shown."""


@dataclass(frozen=True)
class Fault:
    """A command whose disk becomes full.

    Attributes:
        case: The command.
        when: The write that fails, or the size of the disk, in words.
        wrong: The reason why it did not end as it must; "" where it did.
        refused: Whether it met the fault and said so.
    """

    case: Case
    when: str
    wrong: str
    refused: bool = False


def rows(context: Context) -> list[Check]:
    """All rows of full disks."""
    world = made_world(context.out / "laboratory")
    before = digests(world)
    cases = [case for case in CASES if case.kind and case.runs and not case.slow]
    checks: list[Check] = []
    try:
        made = failing_writes(context.out)
    except NotHere as missing:
        checks.append(information(f"writes that fail one by one: left out, {missing}", 0.0))
    else:
        with commands(context.out / "servers", environment=made.environment) as run, _pool(run) as pool:
            most = QUICK_WRITES if context.quick else MOST_WRITES
            each = pool.map(
                lambda case: list(failed(run, made, case, world, context.out / case_folder(case), most)),
                cases,
            )
            checks += fault_rows("a failing write", [one for some in each for one in some])
    try:
        with commands(context.out / "servers", 1) as run:
            sizes = QUICK_SIZES_KB if context.quick else SIZES_KB
            full = [filled(run, case, world, context.out / "disk", size) for case in cases for size in sizes]
        checks += fault_rows("a small disk", full)
    except NotHere as missing:
        checks.append(information(f"a small disk: left out, {missing}", 0.0))
    lost = changed(before, world)
    return [Check("inputs changed or lost", len(lost), 0, "<="), *checks]


def _pool(run: Commands) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(run.workers)


def case_folder(case: Case) -> str:
    """A name for the folder of a case."""
    return f"case-{CASES.index(case)}"


def fault_rows(kind: str, found: Sequence[Fault]) -> list[Check]:
    """The rows of one kind of full disk.

    Args:
        kind: The kind, in words.
        found: Commands whose disk became full.
    """
    bad = [one for one in found if one.wrong]
    return [
        Check(f"{kind}: {len(found)} runs, half results, lost ones or no sentence", len(bad), 0, "<="),
        information(f"{kind}: refused in a sentence", sum(one.refused for one in found)),
        *(
            information(f"{case.name}, {one.when}: {one.wrong}", len(own))
            for case in CASES
            for own in [[one for one in bad if one.case == case]]
            for one in own[:SHOWN]
        ),
    ]


def failed(
    run: Commands, made: FailingWrites, case: Case, world: Path, place: Path, most: int
) -> Iterator[Fault]:
    """Runs a case with writes that fail, one run for each.

    Args:
        run: Runs commands, with the library in front of their calls.
        made: The library.
        case: The case.
        world: The laboratory.
        place: Folder of the outputs, to be made.
        most: At most so many writes of it fail for good, and so many alone.
    """
    old = place / "old"
    old.mkdir(parents=True)
    run.run(Call(case.call({}, str(old / case.out)), world))
    out = place / "now"
    words = case.call({}, str(out / case.out))
    shutil.copytree(old, out)
    counted = run.run(Call(words, world, fault=made.fault(place, 0)))
    if counted.code != 0 or counted.writes == 0:
        yield Fault(case, "nothing failing", counted.unclean or counted.last_line or "no write was seen")
        return
    for lasting in (True, False):
        for at in np.unique(np.linspace(1, counted.writes, most).round().astype(int)):
            shutil.rmtree(out)
            shutil.copytree(old, out)
            end = run.run(Call(words, world, fault=made.fault(place, int(at), lasting)))
            when = f"write {at} of {counted.writes} {'and all later ones' if lasting else 'alone'}"
            yield Fault(case, when, wrong_end(end, old, out, case.running), end.refused)
    shutil.rmtree(place)


def filled(run: Commands, case: Case, world: Path, place: Path, kilobytes: int) -> Fault:
    """Runs a case whose output goes to a small disk.

    Args:
        run: Runs commands.
        case: The case.
        world: The laboratory.
        place: Where the disk is mounted.
        kilobytes: Its size.
    """
    with small_disk(place, kilobytes) as disk:
        out = disk / "now"
        out.mkdir()
        end = run.run(Call(case.call({}, str(out / case.out)), world, {"TMPDIR": str(disk)}))
        empty = place.with_name("nothing")
        empty.mkdir(exist_ok=True)
        return Fault(case, f"{kilobytes} KB", wrong_end(end, empty, out), end.refused)


def wrong_end(end: Ending, old: Path, now: Path, running: Sequence[str] = ()) -> str:
    """The reason why a command on a full disk did not end as it must; "" where it did.

    A run that ends well has written whole files. One that fails says so in a sentence, and all is as it was.

    Args:
        end: Its end.
        old: A copy of what was there before.
        now: What is there.
        running: Names of files that tell of the newest run, also where it fails.
    """
    left, half = list(leftovers(now)), torn_files(now)
    if end.unclean and not (end.code == 1 and "Traceback" not in end.err and _partial(end)):
        return end.unclean
    if end.refused and (str(now.parent) not in end.last_line or NAMED.search(end.last_line)):
        return f"a sentence without the file: {end.last_line}"
    if left:
        return f"left {left[0]}"
    if half:
        return f"half: {half[0]}"
    if end.code == USER_ERROR:
        kept = {name: was for name, was in digests(old).items() if Path(name).name not in running}
        lost = changed(kept, now)
        return f"refused, but {lost[0]} is another" if lost else ""
    return ""


def _partial(end: Ending) -> bool:
    """True for a batch of which some trials failed, which it says."""
    return "failed" in (end.out + end.err)
