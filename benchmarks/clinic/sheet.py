"""The printed sheet of sessions: pages, heads, warnings, uncut charts and rows in PDF files of Chromium; trend by hand.

The layout was made while HC032A and gaitalytics_walk were looked at; the other captures came after it.
"""

from __future__ import annotations

import re
import shutil
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path

import numpy as np
from scipy import stats

from benchmarks.checks import Check, left_out
from benchmarks.clinic.convention import WALKS, followed
from benchmarks.needs import installed
from mbkf.io.laboratory import Laboratory
from mbkf.io.session import SESSION_FILE, SessionNotes, plain_session, read_session, session_of
from mbkf.io.session_change import change_session
from mbkf.io.visit import Visit
from mbkf.study.session import gather
from mbkf.study.session.norms import norms_of
from mbkf.study.session.records import Session
from mbkf.study.session.trend import trend
from mbkf.trial.gait.convention import BY_CLINIC
from mbkf.viz.sentences import said
from mbkf.viz.session.document import session_page

PAPERS = {"A4": 703, "Letter": 725}
"""Width of the printed area of each paper, CSS pixels: the paper's less 12 mm at both sides."""

SUMMARY_PAGES = 2
PATIENT, DAY = "Patient 0421", "2025-03-31"
LABORATORY = Laboratory("Gait laboratory", "1 Example Road\nExampletown")

LONG = (
    "a long remark on the visit that a careful clinician writes down for the colleagues who read it later; "
    * 9
)

OWN = 'name = "P"\n[visit]\ndate = 2025-03-31 # ours\nward = "B 2"\nbed = 7\n'

_BEYOND = """() => Math.max(...[...document.querySelectorAll(".leaf")].flatMap((leaf) => {
  const end = leaf.getBoundingClientRect();
  return [...leaf.querySelectorAll("*")].map((one) => one.getBoundingClientRect()).filter((box) => box.width)
    .map((box) => Math.max(box.bottom - end.bottom, box.right - end.right));
}))"""
"""Script that returns the largest reach of an element beyond its sheet page, below or on the right, px."""

_MARK = """(all) => {
  let n = 0;
  for (const one of document.querySelectorAll("svg")) {
    const box = one.viewBox.baseVal, top = `beg${n}q`, end = `end${n}q`;
    for (const [text, y] of [[top, 3], [end, box.height - 2]]) {
      const made = document.createElementNS("http://www.w3.org/2000/svg", "text");
      made.setAttribute("x", 3); made.setAttribute("y", y); made.textContent = text; made.style.fontSize = "2px";
      one.append(made);
    }
    n++;
  }
  for (const row of document.querySelectorAll("tr")) {
    const cell = row.firstElementChild; cell.style.position = "relative";
    for (const [name, side] of [["beg", "top"], ["end", "bottom"]]) {
      const made = document.createElement("span");
      made.textContent = `${name}${n}q`;
      made.style.cssText = `position: absolute; left: 0; ${side}: 0; font-size: 2px; line-height: 1`;
      cell.append(made);
    }
    n++;
  }
  const leaf = document.createElement("span");
  leaf.textContent = "qzqzqz"; leaf.style.cssText = "position: absolute; font-size: 2px";
  document.querySelector("#trials h2").append(leaf);
  return n;
}"""
"""Writes a mark at the upper and the lower end of each chart and table row, which moves nothing."""


@dataclass(frozen=True)
class Printed:
    """A printed report.

    Attributes:
        pages: (N,) text of each page.
        marked: How many charts and rows.
        beyond_px: How far content of the sheet reaches beyond the end of its page.
    """

    pages: tuple[str, ...]
    marked: int
    beyond_px: float


def sheet_rows(data: Path, out: Path) -> Iterator[Check]:
    """All rows.

    Args:
        data: Folder of the reference captures.
        out: For a session file.
    """
    yield from _round_trip(out)
    if not (installed("playwright") and installed("pypdf")):
        yield left_out("printed pages", "playwright and pypdf are missing: pip install '.[test]'")
        return
    sessions = {walk.name: _session(walk.name, [followed(walk, data)[1]]) for walk in WALKS}
    norms = norms_of([sessions[name] for name in ("HC044A", "functional", "gaitalytics")], "three walks")
    for name, one in sessions.items():
        for paper in PAPERS:
            yield from _printed_rows(f"{name}, {paper}", one, session_page(one, laboratory=LABORATORY), paper)
    crowded = _crowded(sessions["functional"])
    for language in ("en", "es"):
        page = session_page(crowded, crowded, norms, language, laboratory=LABORATORY)
        yield from _printed_rows(
            f"functional with norms, change and long texts, {language}", crowded, page, "Letter"
        )
    yield from _trend_rows(sessions["gaitalytics"])


def _round_trip(out: Path) -> Iterator[Check]:
    """Own entries and comments of a session file, changed as the page changes it."""
    file = out / SESSION_FILE
    file.write_text(OWN, encoding="utf-8")
    before = read_session(file)
    plain = plain_session(before)
    plain["visit"] = {**before.visit.others, "date": DAY, "side": "left", "notes": LONG}
    change_session(file, before, session_of(plain))
    found, text = read_session(file), file.read_text(encoding="utf-8")
    wanted = Visit(DAY, side="left", notes=LONG, others={"ward": "B 2", "bed": 7})
    lost = (found.visit != wanted) + ("# ours" not in text) + (found.name != "P")
    yield Check("session.toml: entries and comments lost in a change", lost, 0, "<=")


def _session(name: str, results: list) -> Session:
    visit = Visit(DAY, "1990-11-02", "barefoot", "left", "Hemiparesis", "Tired.", "Dr. E. Example")
    notes = SessionNotes(name=PATIENT, sex="female", age=34.0, visit=visit)
    return gather.session_of(results, name, notes, BY_CLINIC)


def _crowded(one: Session) -> Session:
    """The session with more reasons, notes and letters than a page holds."""
    remarks = tuple(f"remark {k}: {LONG[:170]}" for k in range(20))
    trials = tuple(replace(trial, name=LONG[:60], verdict="look", remarks=remarks) for trial in one.trials)
    gaits = tuple(replace(gait, trials=tuple(trial.name for trial in trials)) for gait in one.gaits)
    return replace(one, trials=trials, gaits=gaits, visit=replace(one.visit, diagnosis=LONG, notes=LONG))


def _printed_rows(name: str, one: Session, page: str, paper: str) -> Iterator[Check]:
    printed = printed_pages(page, paper)
    texts, count = printed.pages, len(printed.pages)
    first = next((k for k, text in enumerate(texts) if "qzqzqz" in text), 0)
    yield Check(f"{name}: pages of the sheet off two", abs(first - SUMMARY_PAGES), 0, "<=")
    heads = (PATIENT.replace(" ", ""), DAY, "Gaitlaboratory")
    lacking = sum(
        not all(head in text for head in (*heads, f"{k}/{count}")) for k, text in enumerate(texts, start=1)
    )
    yield Check(f"{name}: pages without name, date, laboratory and number", lacking, 0, "<=")
    whole = "".join(texts)
    language = "es" if '<html lang="es"' in page else "en"
    remarks = {said(remark, language) for trial in one.trials for remark in trial.remarks}
    missing = sum(_squeezed(remark) not in whole for remark in remarks)
    yield Check(f"{name}: warnings not printed, of {len(remarks)}", missing, 0, "<=")
    yield Check(f"{name}: reach of content beyond a page of the sheet", printed.beyond_px, 1.0, "<=", "px")
    yield Check(f"{name}: charts and rows cut, of {printed.marked}", _cut(printed), 0, "<=")


def _cut(printed: Printed) -> int:
    """Charts and rows whose ends are not on one page, lost ones included."""
    places = [
        {mark: k for k, text in enumerate(printed.pages) for mark in re.findall(rf"{end}(\d+)q", text)}
        for end in ("beg", "end")
    ]
    return sum(
        str(n) not in places[0] or places[0][str(n)] != places[1].get(str(n)) for n in range(printed.marked)
    )


def printed_pages(page: str, paper: str) -> Printed:
    """A report printed by Chromium, with a mark at both ends of each chart and row.

    Args:
        page: The report.
        paper: "A4" or "Letter".
    """
    from playwright.sync_api import sync_playwright
    from pypdf import PdfReader

    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"))
        tab = browser.new_page()
        tab.set_content(page)
        tab.emulate_media(media="print")
        tab.set_viewport_size({"width": PAPERS[paper], "height": 1000})
        beyond = float(tab.evaluate(_BEYOND))
        marked = int(tab.evaluate(_MARK))
        content = tab.pdf(format=paper)
        browser.close()
    pages = tuple(_squeezed(one.extract_text()) for one in PdfReader(BytesIO(content)).pages)
    return Printed(pages, marked, beyond)


def _squeezed(text: str) -> str:
    """A text without spaces, which printing sets anew, and without ligatures."""
    return "".join(unicodedata.normalize("NFKC", text).split())


def _trend_rows(one: Session) -> Iterator[Check]:
    """Speeds of three visits against SciPy: means, their intervals, and Welch's interval of the change."""
    days, dice = ("2025-01-01", "2025-02-01", "2025-03-01"), np.random.default_rng(1)
    (gait,) = one.gaits
    speeds = [dice.normal(1.1, 0.1, 5 + k) for k in range(3)]
    visits = []
    for day, values in zip(days, speeds, strict=True):
        speed = gait.measure("Speed")
        assert speed is not None
        trials = {side: ("w",) * len(values) for side in "rl"}
        made = replace(speed, values={"r": values, "l": values}, trials=trials)
        visits.append(replace(one, visit=Visit(day), gaits=(replace(gait, measures=(made,)),)))
    found = trend(visits)
    assert found is not None
    line = found.lines[0]
    means = [abs(float(point.mean.mean[0]) - v.mean()) for point, v in zip(line.points, speeds, strict=True)]
    welch = stats.ttest_ind(speeds[2], speeds[0], equal_var=False).confidence_interval()
    ends = [abs(float(line.change.low[0]) - welch.low), abs(float(line.change.high[0]) - welch.high)]
    yield Check("trend: means against those by hand", max(means), 1e-12, "<=", "m/s")
    yield Check("trend: interval of the change against Welch's by SciPy", max(ends), 1e-9, "<=", "m/s")
