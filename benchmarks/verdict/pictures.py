"""Takes the picture of "May I use this?": the first lines of three reports, one of each word.

Run ``python -m benchmarks.verdict.pictures FOLDER``.
"""

from __future__ import annotations

import io
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.dynamic.methods import tared
from benchmarks.screenshots import FLAGS, keep
from benchmarks.verdict.faults import KINDS
from benchmarks.verdict.recorded import Recorded, cut, named
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise
from mbkf.trial.synth import synthesise
from mbkf.viz.report.document import report_page

FAULTS = ("", "box", "plates turned")
"""Kinds of faults whose reports say "use", "look" and "do not use"."""

WIDTH, GAP = 1100, 12


def take(scratch: Path, target: Path) -> None:
    """Reconstructs a synthetic walk without and with faults, and takes the picture.

    Args:
        scratch: A folder for the reports.
        target: Where ``screenshot_verdict.png`` goes.
    """
    from PIL import Image
    from playwright.sync_api import sync_playwright

    subject, made = synthesise("walk", seed=20)
    right = cut(named(made.static, tared(made.trial), subject))
    pictures = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=list(FLAGS))
        page = browser.new_page(viewport={"width": WIDTH, "height": 900}, color_scheme="light")
        for kind in FAULTS:
            path = scratch / f"{kind or 'right'}.html"
            path.write_text(_report(right, kind), encoding="utf-8")
            page.goto(path.absolute().as_uri())
            pictures.append(Image.open(io.BytesIO(page.locator("#verdict").screenshot())))
        browser.close()
    whole = Image.new(
        "RGB",
        (
            max(one.width for one in pictures),
            sum(one.height for one in pictures) + GAP * (len(pictures) - 1),
        ),
        "white",
    )
    top = 0
    for one in pictures:
        whole.paste(one, (0, top))
        top += one.height + GAP
    held = io.BytesIO()
    whole.save(held, "PNG")
    keep(held.getvalue(), target / "screenshot_verdict.png")


def _report(right: Recorded, kind: str) -> str:
    """The report of the walk with a kind of fault, as a page."""
    recorded = right
    if kind:
        recorded, _ = KINDS[kind](right, np.random.default_rng(1))
    found = reconstruct(recorded.capture, recorded.subject)
    return report_page(found, summarise(found))


if __name__ == "__main__":
    folder = Path(tempfile.mkdtemp(prefix="mbkf-"))
    take(folder, Path(sys.argv[1]))
    shutil.rmtree(folder)
