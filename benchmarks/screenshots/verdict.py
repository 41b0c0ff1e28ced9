"""The picture of "May I use this?": the first lines of three reports, one of each word."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.app.visit import browser
from benchmarks.dynamic.methods import tared
from benchmarks.screenshots.picture import Taken, Taking, stacked
from benchmarks.verdict.faults import KINDS
from benchmarks.verdict.recorded import Recorded, cut, named
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise
from mbkf.trial.synth import synthesise
from mbkf.viz.report.document import report_page

FAULTS = ("", "box", "plates turned")
"""Kinds of faults whose reports say "use", "look" and "do not use"."""

WIDTH, GAP = 1100, 12


def verdict_picture(scratch: Path) -> Taking:
    """Takes it.

    Args:
        scratch: An empty folder.
    """
    subject, made = synthesise("walk", seed=20)
    right = cut(named(made.static, tared(made.trial), subject))
    pictures = []
    with browser() as opened:
        page = opened.new_page(viewport={"width": WIDTH, "height": 900}, color_scheme="light")
        for kind in FAULTS:
            path = scratch / f"{kind or 'right'}.html"
            path.write_text(_report(right, kind), encoding="utf-8")
            page.goto(path.absolute().as_uri())
            pictures.append(page.locator("#verdict").screenshot())
    yield Taken("screenshot_verdict", stacked(pictures, GAP))


def _report(right: Recorded, kind: str) -> str:
    """The report of the walk with a kind of fault, as a page."""
    recorded = right
    if kind:
        recorded, _ = KINDS[kind](right, np.random.default_rng(1))
    found = reconstruct(recorded.capture, recorded.subject)
    return report_page(found, summarise(found))
