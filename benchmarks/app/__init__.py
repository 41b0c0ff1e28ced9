"""The laboratory's page in a real browser: a new user's way, forty trials, faults, accessibility, scripts in names."""

from __future__ import annotations

import shutil
from pathlib import Path

from benchmarks.app.accessible import accessible_rows, start_row
from benchmarks.app.forty import forty_rows
from benchmarks.app.names import evil_session, injection_rows
from benchmarks.app.path import path_rows
from benchmarks.app.visit import Visit, browser, served, visit
from benchmarks.checks import Check, Context


def run(context: Context) -> list[Check]:
    """All rows; without the forty trials when quick."""
    with browser() as made:
        rows = path_rows(made, _fresh(context.out / "path"), context.seed)
        with served(_fresh(context.out / "empty")) as server:
            first = visit(made, server.url)
            first.wait(".drop")
            rows.append(start_row(first))
        evil = _fresh(context.out / "evil")
        evil_session(evil / "lab", context.seed)
        with served(evil / "lab") as server:
            user = visit(made, server.url)
            user.wait("table")
            run_session(user)
            rows += accessible_rows(user)
            rows += injection_rows(user)
        if not context.quick:
            rows += forty_rows(made, _fresh(context.out / "forty"), context.seed)
    return rows


def run_session(user: Visit) -> None:
    """Runs the session that a visit shows, and waits until it is done."""
    user.click("button.main")
    user.wait("text=/Done in|Ended after/")


def _fresh(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder
