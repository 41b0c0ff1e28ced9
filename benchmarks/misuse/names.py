"""File names and terminals of all the world: every command works with them, whatever the language and encoding.

Folders of inputs and outputs have names with bytes that are no UTF-8, emoji, line ends, codes for terminals, a leading
dash; they are very long; and the terminal is one of ASCII.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from benchmarks.checks import Check, Context, information
from benchmarks.misuse.calls import Call, Commands, Ending, commands
from benchmarks.misuse.cases import CASES, Case
from benchmarks.misuse.leftovers import leftovers
from benchmarks.misuse.whole import torn_files
from benchmarks.misuse.world import INPUTS, changed, digests, made_world

NAMES: Mapping[str, str] = {
    "plain": "plain",
    "no UTF-8": os.fsdecode(b"M\xfcller \xff"),
    "emoji": "Lauf 🏃🏽‍♀️ Ω",
    "a line end": "walk\n2",
    "codes for terminals": "\x1b[31mred\x1b[0m\x07",
    "a leading dash": "-rf",
    "markup": "[bold]{0} %s $HOME `x` [/]",
    "quotes and blanks": ' it\'s "mine" ',
    "one letter on top of another": "e\u0301",
    "right to left": "\u202eabc",
}
"""Names of folders by what is special about them."""

LONG = "x" * 240
"""A name as long as a file system takes with a suffix."""

PLACES: Mapping[str, Mapping[str, str]] = {
    "UTF-8": {},
    "LC_ALL=C": {"LC_ALL": "C", "LANG": "C", "PYTHONCOERCECLOCALE": "0"},
    "LC_ALL=C, no UTF-8 mode": {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"},
    "ASCII terminal": {"PYTHONIOENCODING": "ascii"},
    "Latin-1 terminal": {"PYTHONIOENCODING": "latin-1", "TERM": "dumb"},
    "narrow": {"COLUMNS": "3", "LINES": "1"},
}
"""Variables of a process by the place that has them."""

QUICK_EVERY = 12
SHOWN = 25


def rows(context: Context) -> list[Check]:
    """All rows of names and terminals."""
    world = made_world(context.out / "laboratory")
    checks = []
    for number, (place, variables) in enumerate(PLACES.items()):
        folder = context.out / f"{number}"
        folder.mkdir()
        tries = [(case, name) for case in _cases() for name in NAMES]
        tries = tries[number :: QUICK_EVERY if context.quick else 3]
        with (
            commands(context.out / "servers", environment={**os.environ, **variables}) as run,
            ThreadPoolExecutor(run.workers) as pool,
        ):
            work = partial(named, run, world=world)
            places = [folder / f"{k}" for k in range(len(tries))]
            ends = list(pool.map(lambda pair, place, work=work: work(*pair, place=place), tries, places))
        lines = [
            f"{case.command}, {name}: {fault}"
            for (case, name), fault in zip(tries, ends, strict=True)
            if fault
        ]
        checks.append(Check(f"{place}: {len(tries)} commands, did not work", len(lines), 0, "<="))
        checks += [information(line, 1.0) for line in lines[:SHOWN]]
    return [*checks, *long_rows(context.out / "long", world)]


def _cases() -> Sequence[Case]:
    """The first case of every command that runs by itself."""
    found: dict[str, Case] = {}
    for case in CASES:
        if case.runs and not case.slow:
            found.setdefault(case.command, case)
    return tuple(found.values())


def named(run: Commands, case: Case, name: str, world: Path, place: Path) -> str:
    """Runs a case in folders of a special name; the reason why it did not work, "" where it did.

    Args:
        run: Runs commands.
        case: The case.
        name: Of :data:`NAMES`.
        world: The laboratory.
        place: Folder of the copies, to be made.
    """
    here = place / NAMES[name]
    here.mkdir(parents=True)
    inputs = copied(case, world, here)
    before = digests(here)
    out = place / f"{NAMES[name]}out" / case.out
    words = case.call({key: str(path) for key, path in inputs.items()}, str(out))
    end = run.run(Call(words, place))
    fault = (end.last_line or f"exit code {end.code}") if end.code != 0 else _fault(end)
    lost, half = changed(before, here), torn_files(out) if case.kind and out.exists() else []
    if not fault:
        fault = f"lost {lost[0]!r}" if lost else half[0] if half else ""
    if not fault:
        shutil.rmtree(place)
    return fault


def _fault(end: Ending) -> str:
    """The reason why the words of a command that worked are not for a terminal; "" where they are."""
    if end.unclean:
        return end.unclean
    return "codes for terminals in its words" if {"\x1b", "\x07"} & set(end.out + end.err) else ""


def copied(case: Case, world: Path, here: Path) -> dict[str, Path]:
    """Copies of a case's inputs in a folder, by their names.

    Args:
        case: The case.
        world: The laboratory.
        here: The folder.
    """
    inputs = {}
    for key in case.inputs:
        source, inputs[key] = world / INPUTS[key], here / INPUTS[key]
        (shutil.copytree if source.is_dir() else shutil.copy)(source, inputs[key])
    for beside in {"list", "listed"} & set(inputs):
        for file in ("trial.c3d", "static.c3d"):
            shutil.copy(world / file, inputs[beside].parent)
    return inputs


def long_rows(folder: Path, world: Path) -> list[Check]:
    """The row of outputs whose names are as long as a file system takes: written, or refused in a sentence.

    Args:
        folder: Where they are written.
        world: The laboratory.
    """
    folder.mkdir()
    cases = [case for case in _cases() if case.kind]
    calls = [Call(case.call({}, str(folder / f"{LONG}{Path(case.out).suffix}")), world) for case in cases]
    with commands(folder / "servers") as run:
        ends = run.run_all(calls)
    wrong = [
        f"{case.command}, a very long name: {end.unclean}"
        for case, end in zip(cases, ends, strict=True)
        if end.unclean
    ]
    wrong += [f"left {name}" for name in leftovers(folder)]
    return [
        Check(f"very long names: {len(cases)} commands, ended without a sentence", len(wrong), 0, "<="),
        *(information(line, 1.0) for line in wrong[:SHOWN]),
    ]
