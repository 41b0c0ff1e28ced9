"""Six sessions that the page has not seen, and one that is not ready: clicks from their folder to the printed reports.

The walks are those of the reference captures with a standing trial of the same person, as they lie there.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.app.visit import Visit, browser, served, until, visit
from benchmarks.checks import Check, left_out
from benchmarks.clinic.norms import wide_table
from benchmarks.clinic.sheet import SUMMARY_PAGES, printed_pages
from benchmarks.needs import installed

SESSIONS: Mapping[str, Mapping[str, str]] = {
    "P1": {
        "static.c3d": "biomechzoo_walk_turn/HC032A_Static_HC032A01.c3d",
        "walk.c3d": "biomechzoo_walk_turn/HC032A_Straight_HC032A03.c3d",
    },
    "P2": {
        "static.c3d": "biomechzoo_walk_turn/HC044A_Static_HC044A01.c3d",
        "walk.c3d": "biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d",
    },
    "P3": {
        "static.c3d": "rehazenter_walk/2014001_ST_static.c3d",
        "walk.c3d": "rehazenter_walk/2014001_C1_01.c3d",
    },
    "P4": {
        "static.c3d": "functional_walk/FunctionalStatic.c3d",
        "walk.c3d": "functional_walk/FunctionalWalk.c3d",
    },
    "P5": {
        "static.trc": "rajagopal_walk_run/static_walk_1.trc",
        "walk.trc": "rajagopal_walk_run/motion_capture_walk.trc",
        "walk_grf.mot": "rajagopal_walk_run/grf_walk.mot",
    },
    "P6": {
        "static.trc": "gait2354_walk/subject01_static.trc",
        "walk.trc": "gait2354_walk/subject01_walk1.trc",
        "walk_grf.mot": "gait2354_walk/subject01_walk1_grf.mot",
    },
}
"""Files of each session, and the captures that they are copies of."""

STANDING = {"P7": {"static.c3d": "unipd_walk/Static1.c3d"}}
"""A session without a moving trial, which is not ready."""

FACTS = {
    "convention": "clinical",
    "source": "Example laboratory 2019",
    "persons": "30",
    "ages": "20-40",
    "speeds": "1.1-1.4",
}
"""Facts about norms that their file does not state."""

CLICKS = 6
"""Most clicks from the folder to a report that can be signed."""

PATIENCE_S = 1800.0

REPORT = "dialog iframe"


def sessions_rows(data: Path, out: Path) -> Iterator[Check]:
    """All rows.

    Args:
        data: Folder of the reference captures.
        out: Folder for the files.
    """
    if not (installed("playwright") and installed("pypdf")):
        yield left_out("six sessions", "playwright and pypdf are missing: pip install '.[test]'")
        return
    study = out / "study"
    for name, files in {**SESSIONS, **STANDING}.items():
        (study / name).mkdir(parents=True)
        for file, source in files.items():
            shutil.copy(data / source, study / name / file)
    with browser() as made, served(out / "lab") as server:
        user = visit(made, server.url)
        user.wait(".drop")
        user.choose_folder(study)
        user.wait(f"[data-key='session study/{max(STANDING)}']")
        user.click(".run-all button")
        order, bars = _watched(user)
        names = [f"study/{name}" for name in SESSIONS]
        yield Check("sessions that ran out of the order of the list", float(order != names), 0, "<=")
        yield Check("sessions whose progress was seen", len(bars & set(names)), len(names), ">=")
        yield from _left_out(user)
        user.click("#session-report")
        pages = [_report(user)]
        yield Check("clicks from the folder to a report", user.clicks, CLICKS, "<=")
        for name in names[1:]:
            user.click(f"dialog button:has-text('Next: {name}')")
            user.page.locator(f"dialog[aria-label='{name}']").wait_for()
            pages.append(_report(user))
        most = CLICKS + len(names) - 1
        yield Check(f"clicks from the folder to all {len(names)} reports", user.clicks, most, "<=")
        yield from _foreign_norms(user, out / "adults.csv")
        yield Check("errors in the page", len(user.troubles), 0, "<=")
    yield from _printed(pages)
    yield from _stopped(study, out / "stopped")


def _watched(user: Visit) -> tuple[list[str], set[str]]:
    """Sessions in the order in which they ran, and those whose progress moved, until all have ended."""
    order: list[str] = []
    bars: set[str] = set()
    script = """() => [...document.querySelectorAll('#sessions li')].map((one) => [
      one.querySelector('button').dataset.key.slice(8), Boolean(one.querySelector('.status.running')),
      Boolean(one.querySelector('.status.waiting')), one.querySelector('progress')?.value ?? 0])"""

    def ended() -> bool:
        rows: list[tuple[str, bool, bool, float]] = user.page.evaluate(script)
        order.extend(name for name, runs, _, _ in rows if runs and name not in order)
        bars.update(name for name, _, _, share in rows if 0.0 < share < 1.0)
        return bool(order) and not any(runs or waits for _, runs, waits, _ in rows)

    until(ended, PATIENCE_S)
    return order, bars


def _left_out(user: Visit) -> Iterator[Check]:
    """The session that is not ready is named with the reason, and has no green mark."""
    (name,) = STANDING
    entry = user.page.locator("#sessions li", has=user.page.locator(f"[data-key='session study/{name}']"))
    reason = "no moving trial" in entry.inner_text()
    green = entry.locator(".status.done, .status.verdict-use").count()
    yield Check("session that is not ready: named with its reason", float(reason), 1, ">=")
    yield Check("session that is not ready: looks green", green, 0, "<=")


def _report(user: Visit) -> str:
    """The report in view, as a document."""
    frame: Any = user.page.frame_locator(REPORT)
    frame.locator(".signature").first.wait_for()
    return str(
        user.page.evaluate(f"document.querySelector('{REPORT}').contentDocument.documentElement.outerHTML")
    )


def _foreign_norms(user: Visit, file: Path) -> Iterator[Check]:
    """A table of norms without a word on them, taken in the report: each fact is asked for, then they are shown."""
    percent = np.linspace(0.0, 100.0, 101)
    knee = 30.0 - 25.0 * np.cos(2.0 * np.pi * percent / 100.0)
    file.write_text(wide_table("knee flexion (deg)", knee, np.full(101, 5.0)), encoding="utf-8")
    user.page.locator("[data-key='import norms']").click()
    form = user.page.locator("form.norms")
    form.locator("input[type=file]").set_input_files(file)
    form.locator("[aria-invalid=true]").first.wait_for()
    asked = {one.get_attribute("name") or "" for one in form.locator("[aria-invalid=true]").all()}
    yield Check("norms of a file: missing facts asked for", len(asked & set(FACTS)), len(FACTS), ">=")
    for name, value in FACTS.items():
        if name == "convention":
            form.locator(f"[name={name}]").select_option(value)
        else:
            form.locator(f"[name={name}]").fill(value)
    form.locator("button.main").click()
    form.locator("[role=status]").wait_for()
    form.locator("button.main").click()
    report = user.page.frame_locator(REPORT).locator("body")
    report.filter(has_text=FACTS["source"]).wait_for()
    shown = all(word in report.inner_text() for word in (FACTS["source"], "30 persons", "20 to 40 years"))
    yield Check("norms of a file: in the report with their source, persons and ages", float(shown), 1, ">=")


def _printed(pages: list[str]) -> Iterator[Check]:
    """Two pages before the list of trials in each report, and a line to sign on."""
    printed = [printed_pages(page, "A4").pages for page in pages]
    first = [next((k for k, text in enumerate(one) if "qzqzqz" in text), 0) for one in printed]
    off = sum(one != SUMMARY_PAGES for one in first)
    yield Check(f"reports of {len(pages)} whose summary has not two pages", off, 0, "<=")
    unsigned = sum("Signature" not in "".join(one[:SUMMARY_PAGES]) for one in printed)
    yield Check(f"reports of {len(pages)} without a line to sign on", unsigned, 0, "<=")
    alike = len(pages) - len(set(pages))
    yield Check("reports that show another session", alike, 0, "<=")


def _stopped(study: Path, lab: Path) -> Iterator[Check]:
    """All runs are stopped inside the first trial: nothing goes on, and nothing looks done."""
    with browser() as made, served(lab) as server:
        user = visit(made, server.url)
        user.wait(".drop")
        user.choose_folder(study)
        user.wait(f"[data-key='session study/{max(STANDING)}']")
        user.click(".run-all button")
        user.wait(".under-way progress")
        user.page.get_by_role("button", name="Stop all").click()
        user.page.locator("[data-key='session study/P6'] .status", has_text="stopped").wait_for()
        busy = user.page.locator("#sessions .status.running, #sessions .status.waiting").count()
        yield Check("stopped: sessions that go on", busy, 0, "<=")
        green = user.page.locator("#sessions .status.done, #sessions .status.verdict-use").count()
        yield Check("stopped: sessions that look green", green, 0, "<=")
