"""The thesis's settings: each asked for by preset file and by command, wrong ones refused, and their combinations run.

The pendulum runs every combination of integrator, propagation, covariance, F, reading of the noise and part of the
plates; so does the body on the first frames of a synthetic squat (quick: a design that shows every pair of choices).
Beside the rows, ``settings.csv`` lists each setting with its place in the thesis and the commands that reach it.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.checks import Check, Context, information
from benchmarks.settings import body, pendulum
from benchmarks.settings.design import Choices
from benchmarks.settings.inventory import ASKED, COMMANDS, Reach, reached, refused, shipped_in_order


def run(context: Context) -> list[Check]:
    """All rows."""
    found = reached(context.out)
    _write(context.out / "settings.csv", found)
    wrong, right = refused(context.out), shipped_in_order()
    rows = [
        _all("thesis's settings reachable by preset", [one.by_preset for one in found]),
        _all("thesis's settings reachable by command", [one.by_command for one in found]),
        _all("presets that come with mbkf, with note and source", right),
        _all("wrong settings refused in one line, exit 2", wrong),
    ]
    return [*rows, *_runs("pendulum", pendulum.runs(context.quick)), *_runs("body", body.runs(context.quick))]


def _runs(where: str, found: Mapping[Choices, float]) -> list[Check]:
    """Rows of the combinations that ran on a body."""
    module = pendulum if where == "pendulum" else body
    good = [value <= module.MOST for value in found.values()]
    return [
        _all(f"{where}: combinations run", good),
        _all(f"{where}: settings that change the result", module.acting()),
        information(f"{where}: largest error of a combination", max(found.values()), module.UNIT),
    ]


def _all(name: str, parts: Sequence[bool]) -> Check:
    """A row that is kept where every part is."""
    return Check(f"{name}, of {len(parts)}", float(sum(parts)), float(len(parts)), ">=")


def _write(path: Path, found: Sequence[Reach]) -> None:
    """The table of settings."""
    with path.open("w", newline="", encoding="utf-8") as file:
        sheet = csv.writer(file)
        sheet.writerow(["setting", "values", "filter", "thesis", "by preset", *COMMANDS])
        for asked, one in zip(ASKED, found, strict=True):
            values = ", ".join(map(str, asked.values))
            sheet.writerow(
                [
                    asked.name,
                    values,
                    asked.filter,
                    asked.place,
                    one.by_preset,
                    *([one.by_command] * len(COMMANDS)),
                ]
            )
