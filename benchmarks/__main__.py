"""Runs benchmarks, prints each value beside its bound, and exits with 1 when a bound is broken.

Exit code 2: wrong usage, an unknown name, or reference captures that are missing or cannot be read.
"""

from __future__ import annotations

import argparse
import ast
import importlib
import json
import math
import os
import pkgutil
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from time import perf_counter

from rich.console import Console
from rich.markup import escape
from rich.table import Table

import benchmarks
from benchmarks.checks import Check, Context
from benchmarks.needs import Lacking, require
from mbkf.errors import InvalidInput, MbkfError, MissingDependency, UnknownName

DATA_VARIABLE, OLD_VARIABLE = "MBKF_DATA", "MBKF_OLD_TREE"
_PIPED_WIDTH = 120
ENTRY_POINT = "run"
"""A module or package at the top of this package that defines a function of this name is a benchmark."""


def names() -> tuple[str, ...]:
    """Names of all benchmarks, in alphabetical order; read from the sources, so that none has to be imported."""
    return tuple(sorted(name for folder in benchmarks.__path__ for name in _found_in(Path(folder))))


def _found_in(folder: Path) -> Iterator[str]:
    for module in pkgutil.iter_modules([str(folder)]):
        source = folder / module.name / "__init__.py" if module.ispkg else folder / f"{module.name}.py"
        tree = ast.parse(source.read_text(encoding="utf-8"), str(source))
        if any(isinstance(node, ast.FunctionDef) and node.name == ENTRY_POINT for node in tree.body):
            yield module.name


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmarks named on the command line, or all of them.

    Args:
        arguments: What follows ``python -m benchmarks``; taken from ``sys.argv`` when None.

    Returns:
        0 when every bound is kept, 1 when one is broken, 2 on bad input.
    """
    args = _parser().parse_args(arguments)
    try:
        if args.gate or args.update_baseline is not None:
            return _gate(args)
        checks = _run(args)
    except (MbkfError, OSError) as error:
        print(f"benchmarks: error: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    return 0 if all(check.passed for check in checks) else 1


def _gate(args: argparse.Namespace) -> int:
    """Holds quick metrics against the committed baseline, or makes a new one."""
    from benchmarks.gate.command import gate, update

    _check_folders(args)
    out = (args.out / "gate").resolve()
    if args.update_baseline is not None:
        update(_console(), out, args.data, args.update_baseline)
        return 0
    return 0 if gate(_console(), out, args.data) else 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=f"Measure mbkf against its bounds. Known benchmarks: {', '.join(names())}.",
        epilog="example:\n  python -m benchmarks main_job --quick",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="benchmarks to run (default: all)")
    parser.add_argument("--quick", action="store_true", help="shorter runs, for a first look")
    parser.add_argument(
        "--minutes",
        type=float,
        metavar="M",
        help="robustness: a live run of so many minutes in place of its rows; speed: a trial of so many minutes",
    )
    parser.add_argument(
        "--seed", type=int, default=0, metavar="N", help="app: another person, other walks (%(default)s)"
    )
    parser.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="PART",
        help="bridges, misuse, strangers: this part alone; repeatable",
    )
    parser.add_argument(
        "--gate",
        action="store_true",
        help="instead of benchmarks: quick metrics from end to end against the committed baseline",
    )
    parser.add_argument(
        "--update-baseline", metavar="REASON", help="make a new baseline, and say why it changes"
    )
    parser.add_argument(
        "--data",
        type=Path,
        metavar="DIR",
        default=os.environ.get(DATA_VARIABLE) or None,
        help=f"folder of the reference captures (default: ${DATA_VARIABLE})",
    )
    parser.add_argument(
        "--old",
        type=Path,
        metavar="TREE",
        default=os.environ.get(OLD_VARIABLE) or None,
        help=f"another source tree, with which the time of a step is compared (default: ${OLD_VARIABLE})",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        default=Path("results"),
        help="where checks.json and the benchmarks' own files go (default: %(default)s)",
    )
    return parser


def _run(args: argparse.Namespace) -> list[Check]:
    """Runs the benchmarks, prints their tables and writes ``checks.json``."""
    known = names()
    for name in args.names:
        if name not in known:
            raise UnknownName("benchmark", name, known)
    _check_folders(args)
    console = _console()
    results: dict[str, list[Check]] = {}
    for name in args.names or known:
        out, start = args.out / name, perf_counter()
        try:
            _say(console, "" if args.only else require(name, args.data, quick=args.quick))
            out.mkdir(parents=True, exist_ok=True)
            module = importlib.import_module(f"benchmarks.{name}")
            results[name] = getattr(module, ENTRY_POINT)(context_of(args, out))
        except (Lacking, MissingDependency) as missing:
            if args.names:
                raise
            _say(console, f"{name} is left out: {missing}")
            continue
        console.print(_table(name, results[name], perf_counter() - start))
    _write(args.out / "checks.json", results, args.quick)
    return [check for checks in results.values() for check in checks]


def _say(console: Console, line: str) -> None:
    if line:
        console.print(line, markup=False, soft_wrap=True)


def _check_folders(args: argparse.Namespace) -> None:
    if args.data is not None and not args.data.is_dir():
        raise InvalidInput(f"{args.data}: no such folder; give the reference captures with --data DIR")
    if args.old is not None and not args.old.is_dir():
        raise InvalidInput(f"{args.old}: no such folder; give a checked-out source tree with --old TREE")


def _console() -> Console:
    console = Console()
    return console if console.is_terminal else Console(width=_PIPED_WIDTH)


def context_of(args: argparse.Namespace, out: Path) -> Context:
    """A benchmark's input from the command line, with its folder."""
    return Context(args.data, out.resolve(), args.quick, args.old, args.minutes, args.seed, tuple(args.only))


def _table(name: str, checks: Sequence[Check], seconds: float) -> Table:
    table = Table("check", title=f"{name} ({seconds:.1f} s)", title_justify="left")
    table.add_column("value", justify="right")
    table.add_column("bound", justify="right")
    table.add_column("unit")
    table.add_column("")
    for check in checks:
        verdict = "[green]pass[/green]" if check.passed else "[bold red]FAIL[/bold red]"
        value, bound = f"{check.value:.4g}", f"{check.relation} {check.bound:.4g}"
        if not check.bounded:
            verdict, bound = "", "for information"
        if check.left_out:
            value, bound, verdict = "–", "", f"left out: {escape(check.note)}"
        table.add_row(check.name, value, bound, check.unit, verdict)
    return table


def _write(path: Path, results: dict[str, list[Check]], quick: bool) -> None:
    rows = [
        {
            "benchmark": name,
            **asdict(check),
            "value": float(check.value) if math.isfinite(check.value) else None,
            "bound": float(check.bound) if check.bounded else None,
            "passed": None if check.left_out else check.passed,
        }
        for name, checks in results.items()
        for check in checks
    ]
    path.write_text(json.dumps({"quick": quick, "checks": rows}, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
