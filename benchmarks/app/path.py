"""A new user's way from `mbkf app` to the report, by the mouse alone; and the same folder through `mbkf batch`."""

from __future__ import annotations

import json
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.app.sessions import BAD, WRONG_KG, new_user
from benchmarks.app.visit import served, visit
from benchmarks.checks import Check
from mbkf.io.results import QUANTITIES
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.session import read_session
from mbkf.study.batch.run import batch

CLICKS, SECONDS = 12, 180.0

OF_A_RUN = ("run_id", "trial", "step_seconds_median", "step_seconds_p99", "realtime_factor")
"""What differs from run to run, or between copies of a capture, in summary.json."""


def path_rows(made: Any, out: Path, seed: int = 0) -> list[Check]:
    """Rows of the way and of its results.

    Args:
        made: The browser.
        out: An empty folder.
        seed: Of the person and the walks.
    """
    source, lab = new_user(out / "disk", seed), out / "lab"
    lab.mkdir()
    begin = perf_counter()
    with served(lab) as server:
        user = visit(made, server.url)
        user.choose_folder(source)
        user.wait("table")
        told_bad = user.page.locator("tr", has_text=BAD).locator(".problems li").count() > 0
        told_mass = user.page.locator(".problems", has_text=f"{WRONG_KG:.1f} kg").count() > 0
        user.click(".offer button")
        user.page.wait_for_timeout(300)
        user.click("button.main")
        user.wait("text=/Done in|Ended after/")
        user.click("#session-report")
        user.page.frame_locator("dialog iframe").locator("#gait-walk svg").first.wait_for()
        seconds = perf_counter() - begin
        clicks, troubles = user.clicks, len(user.troubles)
        stated = read_session(lab / source.name / "session.toml").mass_kg
    return [
        Check("new user: clicks to the report", clicks, CLICKS, "<="),
        Check("new user: time to the report", seconds, SECONDS, "<=", "s"),
        Check("new user: the bad file is told", float(told_bad), 1.0, ">="),
        Check("new user: the wrong mass is told", float(told_mass), 1.0, ">="),
        Check(
            "new user: the plates' mass was taken", float(stated is not None and stated < 100.0), 1.0, ">="
        ),
        Check("new user: errors in the page", troubles, 0.0, "<="),
        Check("through mbkf batch: results that differ", differing(lab, out / "batch"), 0.0, "<="),
    ]


def differing(lab: Path, out: Path) -> float:
    """How many results of a page's folder differ from a batch's of the same captures; missing ones count.

    Args:
        lab: The page's folder.
        out: An empty folder for the batch.
    """
    results = lab / "results"
    kept = sorted(results.rglob("summary.json"))
    batch(_captures(lab, out / "captures"), out / "results")
    again = sorted((out / "results").rglob("summary.json"))
    names, others = ([path.parent.name for path in found] for found in (kept, again))
    if names != others or not kept:
        return float(abs(len(kept) - len(again)) or 1)
    return float(sum(not same(one.parent, other.parent) for one, other in zip(kept, again, strict=True)))


def same(one: Path, other: Path) -> bool:
    """Whether two results agree to the last digit, times of computing left out."""
    first, second = read_reconstruction(one), read_reconstruction(other)
    for name, quantity in QUANTITIES.items():
        a, b = getattr(first, name), getattr(second, name)
        if name == "step_seconds" or quantity.is_text:
            continue
        if (a is None) != (b is None) or (a is not None and not np.array_equal(a, b, equal_nan=True)):
            return False
    told = [{k: v for k, v in read_summary(path).items() if k not in OF_A_RUN} for path in (one, other)]
    return json.dumps(told[0], sort_keys=True) == json.dumps(told[1], sort_keys=True)


def _captures(lab: Path, copy: Path) -> Path:
    """The captures and session files alone, as a batch finds them."""
    for path in lab.rglob("*"):
        if path.is_file() and "results" not in path.relative_to(lab).parts:
            target = copy / path.relative_to(lab)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(path.read_bytes())
    return copy
